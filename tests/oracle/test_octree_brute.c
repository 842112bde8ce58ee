/* The octree against brute force in double precision (tests/support/octree_brute.h), on random scenes made of
 * what goes wrong: vertices and faces in cell planes, needles, sizes from the whole scene to a millionth,
 * fans, copies, small things alone. GW_TEST_SEED=N repeats one case. */
#include "build/octree.h"
#include "tests/support/device.h"
#include "tests/support/meshes.h"
#include "tests/support/nasty.h"
#include "tests/support/octree_brute.h"

#include <math.h>

enum { CASES = 24 };

static int whole_between(uint64_t *random, int low, int high) {
    return low + (int)(gw_test_random(random) * (high - low + 1));
}

static gw_scene *random_scene(uint64_t *random) {
    gw_mesh mesh = {0};
    gw_mesh_add_nasty(&mesh, random);
    return gw_mesh_take(&mesh);
}

static gw_settings random_rules(uint64_t *random) {
    gw_settings settings;
    gw_settings_init(&settings);
    settings.octree_depth = whole_between(random, 2, 7);
    settings.leaf_triangles = whole_between(random, 1, 8);
    settings.fan_rule = gw_test_random(random) < 0.7;
    settings.fan_cap = whole_between(random, 3, 40);
    settings.isolation_rule = gw_test_random(random) < 0.7;
    settings.dense_leaf = whole_between(random, 0, 12);
    return settings;
}

static gw_octree *build(const gw_scene *scene, const gw_settings *settings) {
    gw_octree_options options = {.settings = settings};
    gw_octree *octree = NULL;
    check_ok(gw_octree_build(device, scene, &options, &octree, &error));
    return octree;
}

static void check_built(uint64_t seed, const gw_scene *scene, const gw_octree *octree,
                        const gw_settings *settings) {
    gw_error error = {0};
    if (gw_octree_validate(device, scene, octree, &error) != GW_OK ||
        gw_brute_check_octree(scene, octree, settings, &error) != GW_OK)
        fail_msg(
            "GW_TEST_SEED=%llu (%u triangles, depth %d, K %d, fan %d to %d, isolation %d, dense %d, %g MiB): "
            "%s",
            (unsigned long long)seed, scene->triangle_count, settings->octree_depth, settings->leaf_triangles,
            settings->fan_rule, settings->fan_cap, settings->isolation_rule, settings->dense_leaf,
            settings->octree_memory, error.text);
}

static void check_case(uint64_t seed) {
    uint64_t random = seed * 7919;
    gw_scene *scene = random_scene(&random);
    gw_settings settings = random_rules(&random);
    gw_octree *octree = build(scene, &settings);
    check_built(seed, scene, octree, &settings);
    settings.octree_memory = 0.7 * (double)gw_octree_bytes(octree) / 1048576.0;
    gw_octree_destroy(&octree);
    if (seed % 4 == 0) { /* within a budget, where that leaves anything */
        gw_error too_small = {0};
        gw_octree_options options = {.settings = &settings};
        if (gw_octree_build(device, scene, &options, &octree, &too_small) == GW_OK)
            check_built(seed, scene, octree, &settings);
        gw_octree_destroy(&octree);
    }
    gw_scene_destroy(&scene);
}

static void random_scenes_hold(void **state) {
    const char *chosen = getenv("GW_TEST_SEED");
    (void)state;
    if (chosen) {
        check_case(strtoull(chosen, NULL, 10));
        return;
    }
    print_message("seeds 1 to %d\n", CASES);
    for (uint64_t seed = 1; seed <= CASES; seed++)
        check_case(seed);
}

/* --- damage is found
 * -------------------------------------------------------------------------------------------------------- */

typedef struct sample {
    gw_scene *scene;
    gw_octree *octree;
    gw_settings settings;
} sample;

static sample make_sample(void) {
    const double centre[3] = {0.1, 0.2, 0.3};
    gw_mesh mesh = {0};
    sample s = {0};
    gw_settings_init(&s.settings);
    s.settings.octree_depth = 6;
    gw_mesh_add_sphere(&mesh, centre, 0.7, 0.1, 20, 10);
    check_ok(gw_mesh_scene(&mesh, &s.scene, &error));
    gw_mesh_finish(&mesh);
    s.octree = build(s.scene, &s.settings);
    check_ok(gw_brute_check_octree(s.scene, s.octree, &s.settings, &error));
    return s;
}

static void destroy_sample(sample *s) {
    gw_octree_destroy(&s->octree);
    gw_scene_destroy(&s->scene);
}

static void must_fail(const sample *s, const char *part) {
    check_fails(gw_brute_check_octree(s->scene, s->octree, &s->settings, &error), GW_MACHINE, part);
}

static uint32_t first_of_kind(const gw_octree *octree, uint32_t kind) {
    uint32_t i = 1;
    while (GW_NODE_KIND(octree->nodes[i].bits) != kind)
        i++;
    return i;
}

static void altered_links_are_found(void **state) {
    sample s = make_sample();
    const uint32_t kinds[] = {GW_KIND_INNER, GW_LEAF_LIST, GW_LEAF_SINGLE};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        gw_node *node = &s.octree->nodes[first_of_kind(s.octree, kinds[i])];
        const uint32_t link = node->link;
        node->link = (link + 1) % s.scene->triangle_count;
        must_fail(&s, i == 0   ? "children that do not follow"
                      : i == 1 ? "list that does not follow"
                               : "misses a triangle");
        node->link = link;
    }
    s.octree->nodes[first_of_kind(s.octree, GW_LEAF_SINGLE)].link = s.scene->triangle_count;
    must_fail(&s, "does not exist");
    destroy_sample(&s);
}

/* Every single bit of every inner node's two masks matters. */
static void altered_mask_bits_are_found(void **state) {
    sample s = make_sample();
    (void)state;
    for (uint32_t i = 0; i < s.octree->node_count; i += 7) {
        const uint32_t bits = s.octree->nodes[i].bits;
        for (uint32_t bit = 0; GW_NODE_KIND(bits) == GW_KIND_INNER && bit < 16; bit++) {
            s.octree->nodes[i].bits = bits ^ 1u << bit;
            must_fail(&s, "node");
        }
        s.octree->nodes[i].bits = bits;
    }
    /* The same number of children, in another place: all links still fit. */
    for (uint32_t i = 0; i < s.octree->node_count; i++) {
        const uint32_t bits = s.octree->nodes[i].bits, leaves = GW_NODE_LEAVES(bits);
        if (GW_NODE_KIND(bits) != GW_KIND_INNER || GW_NODE_VALID(bits) != leaves || leaves > 0x7f)
            continue;
        s.octree->nodes[i].bits = (bits & ~0xffffu) | leaves << 1 | leaves << 9;
        must_fail(&s, "cell");
        s.octree->nodes[i].bits = bits;
    }
    destroy_sample(&s);
}

/* One reference out of each list in turn, every other byte of the tree in order. */
static void dropped_references_are_found(void **state) {
    sample s = make_sample();
    gw_octree *t = s.octree;
    const uint32_t count = t->reference_count;
    int tried = 0;
    uint32_t *whole = malloc(count * sizeof *whole);
    (void)state;
    assert_non_null(whole);
    memcpy(whole, t->references, count * sizeof *whole);
    for (uint32_t i = 1; i + 2 < count; i++) {
        /* The second of at least three: what remains is still a list in rising order. */
        const int begins = i == 1 || (whole[i - 1] & GW_REFERENCE_LAST);
        if (!begins || ((whole[i] | whole[i + 1]) & GW_REFERENCE_LAST))
            continue;
        memmove(t->references + i + 1, whole + i + 2, (count - i - 2) * sizeof *whole);
        t->reference_count = count - 1;
        for (uint32_t n = 0; n < t->node_count; n++)
            t->nodes[n].link -= GW_NODE_KIND(t->nodes[n].bits) == GW_LEAF_LIST && t->nodes[n].link > i;
        must_fail(&s, "misses a triangle");
        for (uint32_t n = 0; n < t->node_count; n++)
            t->nodes[n].link += GW_NODE_KIND(t->nodes[n].bits) == GW_LEAF_LIST && t->nodes[n].link > i;
        memcpy(t->references, whole, count * sizeof *whole);
        t->reference_count = count;
        i += 7;
        tried++;
    }
    assert_true(tried > 5);
    check_ok(gw_brute_check_octree(s.scene, t, &s.settings, &error));
    free(whole);
    destroy_sample(&s);
}

/* A triangle too many: sound as a list, but it is nowhere near. */
static void strange_references_are_found(void **state) {
    sample s = make_sample();
    gw_octree *t = s.octree;
    const uint32_t last = s.scene->triangle_count - 1;
    uint32_t *entry = &t->references[t->nodes[first_of_kind(t, GW_LEAF_LIST)].link];
    (void)state;
    while (!(*entry & GW_REFERENCE_LAST))
        entry++;
    *entry = (*entry & GW_REFERENCE_ID) == last ? GW_REFERENCE_LAST : last | GW_REFERENCE_LAST;
    must_fail(&s, "cell");
    destroy_sample(&s);
}

/* An octree by other rules is sound, but refined too far or not far enough. */
static void other_rules_are_found(void **state) {
    const struct {
        int leaf_triangles, fan_rule, isolation_rule;
        const char *text;
    } others[] = {{3, 1, 1, "refined without need"},
                  {6, 1, 1, "leaf against the rules"},
                  {4, 0, 1, "refined without need"},
                  {4, 1, 0, "leaf against the rules"}};
    sample s = {0};
    gw_mesh mesh = {0};
    const double far = 0.9, centre[3] = {0.3, 0.3, 0.3};
    (void)state;
    gw_settings_init(&s.settings);
    s.settings.octree_depth = 6;
    gw_mesh_add_sphere(&mesh, (const double[]){-0.4, -0.4, -0.4}, 0.4, 0.1, 16, 8);
    gw_mesh_add_tetrahedron(&mesh, centre, 0.01);
    gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, far, far, far), gw_mesh_point(&mesh, far, far, 0.8),
                     gw_mesh_point(&mesh, 0.8, far, far));
    check_ok(gw_mesh_scene(&mesh, &s.scene, &error));
    gw_mesh_finish(&mesh);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        gw_settings built_with = s.settings;
        built_with.leaf_triangles = others[i].leaf_triangles;
        built_with.fan_rule = others[i].fan_rule;
        built_with.isolation_rule = others[i].isolation_rule;
        s.octree = build(s.scene, &built_with);
        check_ok(gw_brute_check_octree(s.scene, s.octree, &built_with, &error));
        must_fail(&s, others[i].text);
        gw_octree_destroy(&s.octree);
    }
    destroy_sample(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_scenes_hold),           cmocka_unit_test(altered_links_are_found),
        cmocka_unit_test(altered_mask_bits_are_found),  cmocka_unit_test(dropped_references_are_found),
        cmocka_unit_test(strange_references_are_found), cmocka_unit_test(other_rules_are_found),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
