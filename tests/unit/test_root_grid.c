/* The root grid: every entry says what the walk from the root would find in its cell. */
#include "tests/support/check.h"

#include "render/root_grid.h"

#include <string.h>

enum { DEPTH = 5, MOST_NODES = 1 << 16 };

static gw_node nodes[MOST_NODES], entries[1 << 12];
static uint32_t node_count;

/* Children of a node, breadth first as in octrees; an octant is empty, a leaf or an inner node by its number.
 */
static void grow(void) {
    uint32_t begin = 0, state = 12345;
    nodes[0] = (gw_node){0};
    node_count = 1;
    for (uint32_t level = 0; level < DEPTH; level++) {
        uint32_t end = node_count;
        for (uint32_t i = begin; i < end; i++) {
            if (GW_NODE_KIND(nodes[i].bits) != GW_KIND_INNER)
                continue;
            nodes[i].link = node_count;
            for (uint32_t octant = 0; octant < 8; octant++) {
                state = state * 1664525u + 1013904223u;
                uint32_t drawn = state >> 29;
                if (drawn < 3 && octant != 5)
                    continue;
                int leaf = drawn == 3 || level + 1 == DEPTH;
                nodes[i].bits |= 1u << octant;
                nodes[node_count] =
                    (gw_node){leaf ? state >> 8 : 0, leaf ? (1 + (state >> 20 & 1)) << 16 : 0};
                node_count++;
            }
        }
        begin = end;
    }
}

/* The node or empty cell that holds the cell of the grid's level; returns its level. */
static uint32_t look_up(const uint32_t at[3], uint32_t level, const gw_node **found) {
    const gw_node *node = &nodes[0];
    for (uint32_t l = 0; l < level; l++) {
        if (GW_NODE_KIND(node->bits) != GW_KIND_INNER) {
            *found = node;
            return l;
        }
        uint32_t down = level - 1 - l, octant = 0, before = 0;
        for (int k = 0; k < 3; k++)
            octant |= (at[k] >> down & 1u) << k;
        for (uint32_t i = 0; i < octant; i++)
            before += node->bits >> i & 1u;
        if (!(node->bits >> octant & 1u)) {
            *found = NULL;
            return l + 1;
        }
        node = &nodes[node->link + before];
    }
    *found = node;
    return level;
}

static void entries_are_what_the_octree_holds(void **state) {
    (void)state;
    grow();
    const gw_octree octree = {.depth = DEPTH, .node_count = node_count, .nodes = nodes};
    uint32_t kinds[4] = {0}, coarse = 0;
    for (uint32_t level = 1; level < DEPTH; level++) {
        const uint32_t side = 1u << level;
        gw_root_grid_fill(&octree, level, entries);
        for (uint32_t i = 0; i < side * side * side; i++) {
            const uint32_t at[3] = {i % side, i / side % side, i / side / side};
            const gw_node *found = NULL, *entry = &entries[i];
            uint32_t l = look_up(at, level, &found);
            if (!found) {
                assert_int_equal(GW_NODE_KIND(entry->bits), GW_KIND_INNER);
                assert_int_equal(GW_NODE_VALID(entry->bits), 0);
                assert_int_equal(GW_GRID_ENTRY_SCALE(entry->bits), DEPTH - l + 1);
                kinds[3]++;
                continue;
            }
            assert_int_equal(GW_GRID_ENTRY_SCALE(entry->bits), DEPTH - l);
            assert_int_equal(GW_NODE_KIND(entry->bits), GW_NODE_KIND(found->bits));
            assert_int_equal(GW_NODE_VALID(entry->bits), GW_NODE_VALID(found->bits));
            assert_int_equal(entry->link, found->link);
            kinds[GW_NODE_KIND(found->bits)]++;
            coarse += l < level;
        }
    }
    assert_true(kinds[0] > 0 && kinds[1] > 0 && kinds[2] > 0 && kinds[3] > 0 && coarse > 0);
}

static void small_and_huge_octrees_have_a_coarse_one_or_none(void **state) {
    (void)state;
    assert_int_equal(gw_root_grid_level(&(gw_octree){.depth = 11, .node_count = 1u << 20}), 6);
    assert_int_equal(gw_root_grid_level(&(gw_octree){.depth = 11, .node_count = 1u << 18}), 5);
    assert_int_equal(gw_root_grid_level(&(gw_octree){.depth = 4, .node_count = 1u << 20}), 3);
    assert_int_equal(gw_root_grid_level(&(gw_octree){.depth = 11, .node_count = 9}), 0);
    assert_int_equal(gw_root_grid_level(&(gw_octree){.depth = 11, .node_count = (1u << 24) + 1}), 0);
    assert_int_equal(gw_root_grid_size(0), 0);
    assert_int_equal(gw_root_grid_size(6), 262144);
    /* What buffers are rounded up to must not come between the grid and the end. */
    for (uint32_t count = 100; count < 104; count++) {
        const gw_octree octree = {.node_count = count};
        size_t begin = gw_root_grid_begin(&octree);
        assert_true(begin >= count && begin < count + 2 && begin * sizeof(gw_node) % 16 == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(entries_are_what_the_octree_holds),
        cmocka_unit_test(small_and_huge_octrees_have_a_coarse_one_or_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
