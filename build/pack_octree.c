#include "build/pack_octree.h"

#include "build/block.h"

#include <inttypes.h>
#include <string.h>

enum { STATISTICS = 16, LEVELS = GW_OCTREE_MAXIMUM_DEPTH + 2 };
typedef enum section { NODES, PAYLOADS, REFERENCES, EMISSIONS, BOXES, SECTION_COUNT } section;
_Static_assert((int)SECTION_COUNT == (int)GW_OCTREE_SECTIONS, "the header states the number of sections");

typedef struct header {
    gw_block_head head;
    gw_hash hash;
    uint32_t depth, node_count, reference_count;
    uint32_t level_begin[LEVELS];
    uint64_t statistics[STATISTICS];
    gw_block_span sections[SECTION_COUNT];
} header;
_Static_assert(offsetof(header, level_begin) == 52 && offsetof(header, statistics) == 120 &&
                   offsetof(header, sections) == 248,
               "the header's table of bytes");

static const gw_block_head kind = {.magic = {'G', 'W', 'O', 'C', 'T', 'R', 'E', 'E'},
                                   .version = GW_OCTREE_BLOCK_VERSION,
                                   .section_count = SECTION_COUNT};
static const char what[] = "the octree";

static void put_statistics(const gw_octree_statistics *s, uint64_t out[STATISTICS]) {
    const uint64_t values[] = {
        s->pairs,         s->overlap_tests, s->inner,         s->leaves,           s->single_leaves,
        s->stopped_small, s->stopped_fan,   s->stopped_depth, s->refined_isolated, s->longest_list,
        s->deepest,       s->parts,         s->dense_leaves,  s->stopped_budget,   s->least_gain};
    memcpy(out, values, sizeof values);
}

static void get_statistics(const uint64_t in[STATISTICS], gw_octree_statistics *s) {
    uint64_t *wide[] = {&s->pairs,       &s->overlap_tests, &s->inner,
                        &s->leaves,      &s->single_leaves, &s->stopped_small,
                        &s->stopped_fan, &s->stopped_depth, &s->refined_isolated};
    enum { WIDE = sizeof wide / sizeof *wide };
    for (size_t i = 0; i < WIDE; ++i)
        *wide[i] = in[i];
    s->longest_list = (uint32_t)in[WIDE];
    s->deepest = (uint32_t)in[WIDE + 1];
    s->parts = (uint32_t)in[WIDE + 2];
    s->dense_leaves = in[WIDE + 3];
    s->stopped_budget = in[WIDE + 4];
    s->least_gain = in[WIDE + 5];
}

static void make_header(const gw_octree *octree, header *head) {
    memset(head, 0, sizeof *head);
    head->head = kind;
    head->hash = octree->hash;
    head->depth = octree->depth;
    head->node_count = octree->node_count;
    head->reference_count = octree->reference_count;
    memcpy(head->level_begin, octree->level_begin, sizeof head->level_begin);
    put_statistics(&octree->statistics, head->statistics);
    const uint64_t sizes[SECTION_COUNT] = {[NODES] = gw_octree_node_bytes(octree),
                                           [PAYLOADS] = gw_octree_payload_bytes(octree),
                                           [REFERENCES] = gw_octree_reference_bytes(octree),
                                           [EMISSIONS] = gw_octree_emission_bytes(octree),
                                           [BOXES] = gw_octree_box_bytes(octree)};
    head->head.size = gw_block_place(sizeof *head, sizes, head->sections, SECTION_COUNT);
}

size_t gw_pack_octree_size(const gw_octree *octree) {
    header head;
    make_header(octree, &head);
    return (size_t)head.head.size;
}

void gw_pack_octree(const gw_octree *octree, void *block) {
    header head;
    make_header(octree, &head);
    const void *arrays[SECTION_COUNT] = {[NODES] = octree->nodes,
                                         [PAYLOADS] = octree->payloads,
                                         [REFERENCES] = octree->references,
                                         [EMISSIONS] = octree->emissions,
                                         [BOXES] = octree->boxes};
    memset(block, 0, (size_t)head.head.size);
    memcpy(block, &head, sizeof head);
    for (int i = 0; i < SECTION_COUNT; i++)
        gw_block_put(block, &head.sections[i], arrays[i]);
}

static gw_code damaged(gw_error *error, const char *why) {
    return gw_fail(error, GW_BAD_INPUT, "%s is damaged (%s); start again", what, why);
}

static gw_code check_levels(const header *head, gw_error *error) {
    uint32_t depth = head->depth;
    int sound = depth >= 1 && depth <= GW_OCTREE_MAXIMUM_DEPTH && head->node_count > 0 &&
                head->reference_count > 0 && head->level_begin[0] == 0;
    for (uint32_t l = 0; sound && l + 1 < LEVELS; ++l)
        sound = head->level_begin[l] <= head->level_begin[l + 1];
    sound = sound && head->level_begin[depth + 1] == head->node_count &&
            head->level_begin[LEVELS - 1] == head->node_count;
    return sound ? GW_OK : damaged(error, "its counts contradict each other");
}

static gw_code check_sections(const header *head, size_t size, gw_error *error) {
    const uint64_t nodes = head->node_count;
    const uint64_t sizes[SECTION_COUNT] = {
        [NODES] = nodes * sizeof(gw_node),
        [PAYLOADS] = nodes * sizeof(gw_payload),
        [REFERENCES] = (uint64_t)head->reference_count * sizeof(uint32_t),
        [EMISSIONS] = head->sections[EMISSIONS].size ? nodes * sizeof(uint32_t) : 0,
        [BOXES] = head->sections[BOXES].size / sizeof(gw_box) * sizeof(gw_box)};
    return gw_block_check_spans(head->sections, sizes, SECTION_COUNT, size, what, error);
}

gw_code gw_unpack_octree(const void *block, size_t size, gw_octree *out, gw_error *error) {
    header head;
    memset(out, 0, sizeof *out);
    gw_code code = gw_block_check_head(block, size, &kind, what, error);
    if (!code && size < sizeof head)
        code = damaged(error, "it is cut");
    if (code)
        return code;
    memcpy(&head, block, sizeof head);
    code = check_levels(&head, error);
    if (!code)
        code = check_sections(&head, size, error);
    if (code)
        return code;
    /* gw_octree has no const pointers because its maker fills it; nobody writes through these. */
    uint8_t *bytes = (uint8_t *)(uintptr_t)block;
    out->depth = head.depth;
    out->node_count = head.node_count;
    out->reference_count = head.reference_count;
    memcpy(out->level_begin, head.level_begin, sizeof out->level_begin);
    out->nodes = (void *)(bytes + head.sections[NODES].offset);
    out->payloads = (void *)(bytes + head.sections[PAYLOADS].offset);
    out->references = (void *)(bytes + head.sections[REFERENCES].offset);
    out->emissions = head.sections[EMISSIONS].size ? (void *)(bytes + head.sections[EMISSIONS].offset) : NULL;
    out->box_count = (uint32_t)(head.sections[BOXES].size / sizeof(gw_box));
    out->boxes = out->box_count ? (void *)(bytes + head.sections[BOXES].offset) : NULL;
    out->hash = head.hash;
    out->borrowed = 1;
    get_statistics(head.statistics, &out->statistics);
    return out->statistics.deepest <= out->depth ? GW_OK : damaged(error, "its counts contradict each other");
}

/* Every box leads on to a later one, or to references of the octree; the last one leads nowhere. */
static gw_code check_boxes(const gw_octree *octree, gw_error *error) {
    for (uint32_t i = 0; i < octree->box_count; ++i) {
        const gw_box *box = &octree->boxes[i];
        uint32_t triangles = GW_BOX_TRIANGLES(box->triangles);
        int end = i + 1 == octree->box_count;
        int sound = triangles > 0
                        ? triangles <= GW_BOX_MOST_TRIANGLES && box->link > 0 &&
                              box->link + (uint64_t)triangles <= octree->reference_count &&
                              (!end || (box->triangles & GW_BOX_LAST))
                        : !end && (box->link == 0 || box->link > i) && box->link < octree->box_count;
        if (!sound)
            return gw_fail(error, GW_BAD_INPUT, "its box %" PRIu32 " points outside its arrays", i);
    }
    return GW_OK;
}

gw_code gw_octree_check_links(const gw_octree *octree, uint32_t triangle_count, gw_error *error) {
    const uint32_t *references = octree->references;
    uint32_t count = octree->reference_count;
    if (!(references[count - 1] & GW_REFERENCE_LAST))
        return gw_fail(error, GW_BAD_INPUT, "its last list has no end");
    for (uint32_t i = 1; i < count; ++i)
        if ((references[i] & GW_REFERENCE_ID) >= triangle_count)
            return gw_fail(error, GW_BAD_INPUT, "its reference %" PRIu32 " names no triangle of the scene",
                           i);
    for (uint32_t i = 0; i < octree->node_count; ++i) {
        gw_node node = octree->nodes[i];
        uint32_t children = (uint32_t)__builtin_popcount(GW_NODE_VALID(node.bits));
        uint32_t node_kind = GW_NODE_KIND(node.bits);
        int sound = node_kind == GW_KIND_INNER
                        ? children > 0 && node.link > i && node.link <= octree->node_count - children
                    : node_kind == GW_LEAF_LIST   ? node.link > 0 && node.link < count
                    : node_kind == GW_LEAF_SINGLE ? node.link < triangle_count
                    : node_kind == GW_LEAF_DENSE  ? node.link < octree->box_count
                                                  : 0;
        if (!sound || (i == 0 && node_kind != GW_KIND_INNER))
            return gw_fail(error, GW_BAD_INPUT, "its node %" PRIu32 " points outside its arrays", i);
    }
    return check_boxes(octree, error);
}
