#include "build/octree_part.h"

#include "build/block.h"
#include "build/octree_internal.h"

#include "base/clock.h"
#include "base/memory.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = GW_OCTREE_MAXIMUM_DEPTH + 1 };
/* Nodes and cells stand level by level; links of inner nodes count from the part's first node of the level
 * below (at and below the split level; above it they are found when joining), those of lists from the part's
 * first reference of the level. Payloads and emissions begin at the split level. */
typedef enum section { NODES, CELLS, REFERENCES, PAYLOADS, EMISSIONS, SUMS, SECTION_COUNT } section;

typedef struct header {
    gw_block_head head;
    uint32_t depth, split_level, part, part_count;
    uint64_t sum_bytes; /* of one node */
    uint32_t nodes[LEVELS], references[LEVELS];
    gw_octree_statistics statistics;
    gw_octree_budget budget;
    uint32_t counting, unused; /* 1: the part alone does not fit the memory budget; it has no nodes */
    gw_block_span sections[SECTION_COUNT];
} header;

static const gw_block_head kind = {
    .magic = {'G', 'W', 'P', 'A', 'R', 'T', ' ', ' '}, .version = 1, .section_count = SECTION_COUNT};
static const char what[] = "a part of the octree";

/* --- making a part
 * ----------------------------------------------------------------------------------------------- */

/* A part in the making. */
typedef struct maker {
    gw_octree_builder builder;
    gw_octree *octree; /* what the builder found, foreign cells above the split level included */
    void *sums;        /* of all its nodes at the split level */
    header head;
} maker;

static uint32_t list_length(const gw_octree_level *level, const gw_node *node) {
    uint32_t length = 1;
    while (!(level->references[node->link + length - 1] & GW_REFERENCE_LAST))
        length++;
    return length;
}

/* Counts what the part owns, level by level. */
static void count_owned(maker *m) {
    for (uint32_t l = 0; l <= m->builder.depth; ++l) {
        const gw_octree_level *level = &m->builder.levels[l];
        int all = l > m->builder.split_level;
        m->head.nodes[l] = all ? (uint32_t)level->node_count : 0;
        m->head.references[l] = all ? (uint32_t)level->reference_count : 0;
        for (size_t i = 0; !all && i < level->node_count; ++i) {
            if (!gw_octree_owns(&m->builder, l, level->cells[i]))
                continue;
            m->head.nodes[l]++;
            if (GW_NODE_KIND(level->nodes[i].bits) == GW_LEAF_LIST)
                m->head.references[l] += list_length(level, &level->nodes[i]);
        }
    }
}

/* Bytes that each section has by the counts of a head. */
static void section_sizes(const header *head, int has_emissions, uint64_t sizes[SECTION_COUNT]) {
    uint64_t nodes = 0, references = 0, below = 0;
    for (uint32_t l = 0; l < LEVELS; ++l) {
        nodes += head->nodes[l];
        references += head->references[l];
        below += l >= head->split_level ? head->nodes[l] : 0;
    }
    sizes[NODES] = nodes * sizeof(gw_node);
    sizes[CELLS] = nodes * 2 * sizeof(uint32_t);
    sizes[REFERENCES] = references * sizeof(uint32_t);
    sizes[PAYLOADS] = below * sizeof(gw_payload);
    sizes[EMISSIONS] = has_emissions ? below * sizeof(uint32_t) : 0;
    sizes[SUMS] = head->nodes[head->split_level] * head->sum_bytes;
}

/* Where the next bytes of each section go. */
typedef struct cursors {
    uint8_t *at[SECTION_COUNT];
} cursors;

static cursors begin_of(void *block, const header *head) {
    cursors c;
    for (int i = 0; i < SECTION_COUNT; i++)
        c.at[i] = (uint8_t *)block + head->sections[i].offset;
    return c;
}

static void append(cursors *c, section where, const void *data, size_t size) {
    if (size > 0)
        memcpy(c->at[where], data, size);
    c->at[where] += size;
}

/* Copies nodes [first, first + count) of the level with what belongs to them. */
static void append_nodes(const maker *m, cursors *c, uint32_t l, size_t first, size_t count) {
    const gw_octree_level *level = &m->builder.levels[l];
    size_t at = m->octree->level_begin[l] + first;
    append(c, NODES, level->nodes + first, count * sizeof *level->nodes);
    append(c, CELLS, level->cells + first, count * sizeof *level->cells);
    if (l < m->builder.split_level)
        return;
    append(c, PAYLOADS, m->octree->payloads + at, count * sizeof *m->octree->payloads);
    if (m->octree->emissions)
        append(c, EMISSIONS, m->octree->emissions + at, count * sizeof *m->octree->emissions);
    if (l == m->builder.split_level)
        append(c, SUMS, (const uint8_t *)m->sums + first * m->head.sum_bytes, count * m->head.sum_bytes);
}

/* A level in which cells of other parts lie between. */
static void append_owned(maker *m, cursors *c, uint32_t l) {
    gw_octree_level *level = &m->builder.levels[l];
    uint32_t references = 0;
    for (size_t i = 0; i < level->node_count; ++i) {
        if (!gw_octree_owns(&m->builder, l, level->cells[i]))
            continue;
        gw_node *node = &level->nodes[i];
        if (GW_NODE_KIND(node->bits) == GW_LEAF_LIST) {
            uint32_t length = list_length(level, node);
            append(c, REFERENCES, level->references + node->link, length * sizeof *level->references);
            node->link = references;
            references += length;
        }
        append_nodes(m, c, l, i, 1);
    }
}

static gw_code pack(maker *m, gw_octree_part *out, gw_error *error) {
    header *head = &m->head;
    uint64_t sizes[SECTION_COUNT];
    head->head = kind;
    head->depth = m->builder.depth;
    head->split_level = m->builder.split_level;
    head->statistics = m->octree->statistics;
    head->budget = m->builder.budget;
    head->counting = (uint32_t)m->builder.counting;
    if (!head->counting)
        count_owned(m);
    section_sizes(head, m->octree->emissions != NULL, sizes);
    head->head.size = gw_block_place(sizeof *head, sizes, head->sections, SECTION_COUNT);
    gw_code code = gw_allocate(&out->data, (size_t)head->head.size, 1, what, error);
    if (code)
        return code;
    out->size = (size_t)head->head.size;
    memcpy(out->data, head, sizeof *head);
    cursors c = begin_of(out->data, head);
    for (uint32_t l = 0; l <= m->builder.depth && !head->counting; ++l) {
        const gw_octree_level *level = &m->builder.levels[l];
        if (l <= m->builder.split_level) {
            append_owned(m, &c, l);
            continue;
        }
        append_nodes(m, &c, l, 0, level->node_count);
        append(&c, REFERENCES, level->references, level->reference_count * sizeof *level->references);
    }
    return GW_OK;
}

static gw_code run_part(maker *m, gw_octree_part *out, gw_error *error) {
    int64_t start = gw_now_ns();
    size_t sum_bytes = 0;
    gw_code code = gw_octree_upload(&m->builder, error);
    if (!code)
        code = gw_octree_refine(&m->builder, error);
    if (code)
        return code;
    double refine_ms = (double)(gw_now_ns() - start) * 1e-6;
    m->octree->statistics = m->builder.statistics;
    m->head.sum_bytes = 1;
    if (m->builder.counting)
        return pack(m, out, error);
    code = gw_octree_assemble(&m->builder, m->octree, error);
    uint32_t split = m->builder.split_level, deepest = m->octree->statistics.deepest;
    const gw_payload_range range = {.deepest = deepest > split ? deepest : split,
                                    .highest = split,
                                    .sums_above = &m->sums,
                                    .sum_bytes = &sum_bytes};
    if (!code)
        code = gw_octree_payload(&m->builder, &range, m->octree, error);
    m->octree->statistics.milliseconds[0] = refine_ms;
    m->head.sum_bytes = sum_bytes;
    return code ? code : pack(m, out, error);
}

static gw_code build_part(maker *m, gw_octree_part *out, gw_error *error) {
    gw_code code = gw_allocate((void **)&m->octree, 1, sizeof *m->octree, "octree", error);
    if (code)
        return code;
    m->octree->depth = m->builder.depth;
    code = run_part(m, out, error);
    gw_octree_destroy(&m->octree);
    free(m->sums);
    return code;
}

gw_code gw_octree_build_part(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                             const gw_octree_division *division, uint32_t part, gw_octree_part *out,
                             gw_error *error) {
    maker m = {.head = {.part = part, .part_count = division->part_count}};
    *out = (gw_octree_part){0};
    gw_octree_builder_init(&m.builder, device, scene, options);
    m.builder.split_level = division->level;
    m.builder.key_first = division->begin[part];
    m.builder.key_last = division->begin[part + 1];
    gw_code code = build_part(&m, out, error);
    gw_octree_builder_finish(&m.builder);
    return code ? gw_context(error, "cannot build part %" PRIu32 " of %" PRIu32 " of the octree", part + 1,
                             division->part_count)
                : GW_OK;
}

gw_octree_statistics gw_octree_part_statistics(const gw_octree_part *part) {
    header head = {0};
    if (part->size >= sizeof head)
        memcpy(&head, part->data, sizeof head);
    return head.statistics;
}

/* --- joining
 * ----------------------------------------------------------------------------------------------------- */

int gw_octree_parts_fit(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                        const gw_octree_part *parts, uint32_t count) {
    gw_octree_builder builder;
    int counting = 0;
    gw_octree_builder_init(&builder, device, scene, options);
    for (uint32_t p = 0; p < count; ++p) {
        header head;
        if (parts[p].size < sizeof head)
            continue; /* joining says what is wrong with it */
        memcpy(&head, parts[p].data, sizeof head);
        gw_octree_budget_join(&builder.budget, &head.budget);
        counting |= head.counting != 0;
    }
    const gw_octree_rows rows = gw_octree_budget_rows(&builder.budget, 0);
    const int fit = !counting && gw_octree_rows_fit(&rows, &builder.allowance);
    gw_octree_builder_finish(&builder);
    return fit;
}

static gw_code damaged(gw_error *error, const char *why) {
    return gw_fail(error, GW_BAD_INPUT, "%s is damaged (%s); start again", what, why);
}

static gw_code read_head(const gw_octree_part *part, const gw_octree_builder *builder, uint32_t index,
                         uint32_t count, header *head, gw_error *error) {
    uint64_t sizes[SECTION_COUNT];
    gw_code code = gw_block_check_head(part->data, part->size, &kind, what, error);
    if (code)
        return code;
    if (part->size < sizeof *head)
        return damaged(error, "it is cut");
    memcpy(head, part->data, sizeof *head);
    if (head->depth != builder->depth || head->split_level != builder->split_level || head->part != index ||
        head->part_count != count || head->sum_bytes == 0 || head->sum_bytes > 1024)
        return damaged(error, "it was made for another division");
    section_sizes(head, head->sections[EMISSIONS].size > 0, sizes);
    return gw_block_check_spans(head->sections, sizes, SECTION_COUNT, part->size, what, error);
}

static gw_code grow_level(gw_octree_level *level, const header *head, uint32_t l, gw_error *error) {
    size_t nodes = level->node_count + head->nodes[l];
    gw_code code = gw_grow((void **)&level->nodes, &level->node_capacity, nodes, sizeof *level->nodes,
                           "octree nodes", error);
    if (!code)
        code = gw_grow((void **)&level->cells, &level->cell_capacity, nodes, sizeof *level->cells,
                       "octree cells", error);
    if (!code)
        code = gw_grow((void **)&level->references, &level->reference_capacity,
                       level->reference_count + head->references[l], sizeof *level->references,
                       "octree references", error);
    return code;
}

/* Appends one part's nodes, cells and references to the builder's levels. */
static gw_code join_levels(gw_octree_builder *builder, const header *head, const gw_octree_part *part,
                           gw_error *error) {
    cursors from = begin_of(part->data, head);
    for (uint32_t l = 0; l <= builder->depth; ++l) {
        gw_octree_level *level = &builder->levels[l];
        /* Of the level below, this part's nodes have not been appended yet. */
        size_t child_base = l < builder->depth ? builder->levels[l + 1].node_count : 0;
        gw_code code = grow_level(level, head, l, error);
        if (code)
            return code;
        for (uint32_t i = 0; i < head->nodes[l]; ++i) {
            gw_node node;
            memcpy(&node, from.at[NODES] + i * sizeof node, sizeof node);
            uint32_t node_kind = GW_NODE_KIND(node.bits);
            if (node_kind == GW_KIND_INNER)
                node.link += (uint32_t)child_base;
            else if (node_kind == GW_LEAF_LIST)
                node.link += (uint32_t)level->reference_count;
            level->nodes[level->node_count + i] = node;
        }
        if (head->nodes[l] > 0)
            memcpy(level->cells + level->node_count, from.at[CELLS],
                   (size_t)head->nodes[l] * sizeof *level->cells);
        if (head->references[l] > 0)
            memcpy(level->references + level->reference_count, from.at[REFERENCES],
                   (size_t)head->references[l] * sizeof *level->references);
        level->node_count += head->nodes[l];
        level->reference_count += head->references[l];
        from.at[NODES] += (size_t)head->nodes[l] * sizeof *level->nodes;
        from.at[CELLS] += (size_t)head->nodes[l] * sizeof *level->cells;
        from.at[REFERENCES] += (size_t)head->references[l] * sizeof *level->references;
    }
    return GW_OK;
}

/* Above the split level children may be another part's: they follow their elder cousins in Morton order. */
static void link_top(gw_octree_builder *builder) {
    for (uint32_t l = 0; l < builder->split_level; ++l) {
        uint32_t next = 0;
        for (size_t i = 0; i < builder->levels[l].node_count; ++i) {
            gw_node *node = &builder->levels[l].nodes[i];
            if (GW_NODE_KIND(node->bits) != GW_KIND_INNER)
                continue;
            node->link = next;
            next += (uint32_t)__builtin_popcount(GW_NODE_VALID(node->bits));
        }
    }
}

/* Every child is there, every list ends inside its level: the parts fit each other. */
static gw_code check_joined(const gw_octree_builder *builder, gw_error *error) {
    for (uint32_t l = 0; l <= builder->depth; ++l) {
        const gw_octree_level *level = &builder->levels[l];
        size_t children = l < builder->depth ? builder->levels[l + 1].node_count : 0, next = 0;
        for (size_t i = 0; i < level->node_count; ++i) {
            const gw_node *node = &level->nodes[i];
            if (GW_NODE_KIND(node->bits) == GW_KIND_INNER) {
                if (node->link != next)
                    return damaged(error, "its nodes do not follow one another");
                next += (size_t)__builtin_popcount(GW_NODE_VALID(node->bits));
            } else if (GW_NODE_KIND(node->bits) == GW_LEAF_LIST && node->link >= level->reference_count) {
                return damaged(error, "a list lies outside");
            }
        }
        if (next != children)
            return damaged(error, "children are missing");
        if (level->reference_count > 0 &&
            !(level->references[level->reference_count - 1] & GW_REFERENCE_LAST))
            return damaged(error, "a list has no end");
    }
    return builder->levels[0].node_count == 1 ? GW_OK : damaged(error, "it has no root");
}

static void add_statistics(gw_octree_statistics *sum, const gw_octree_statistics *part) {
    sum->pairs += part->pairs;
    sum->overlap_tests += part->overlap_tests;
    sum->inner += part->inner;
    sum->leaves += part->leaves;
    sum->single_leaves += part->single_leaves;
    sum->stopped_small += part->stopped_small;
    sum->stopped_fan += part->stopped_fan;
    sum->stopped_depth += part->stopped_depth;
    sum->stopped_budget += part->stopped_budget;
    sum->refined_isolated += part->refined_isolated;
    sum->parts += part->parts;
    for (int i = 0; i < 3; ++i) /* parts are built side by side: the slowest counts */
        sum->milliseconds[i] =
            part->milliseconds[i] > sum->milliseconds[i] ? part->milliseconds[i] : sum->milliseconds[i];
}

/* Payloads and emissions of the split level and below, part after part within each level. */
static gw_code join_payloads(const gw_octree_builder *builder, const header *heads,
                             const gw_octree_part *parts, uint32_t count, gw_octree *octree,
                             gw_error *error) {
    uint32_t placed[LEVELS] = {0};
    int emits = 0;
    for (uint32_t p = 0; p < count; ++p)
        emits |= heads[p].sections[EMISSIONS].size > 0;
    if (emits) {
        gw_code code = gw_allocate((void **)&octree->emissions, octree->node_count, sizeof *octree->emissions,
                                   "emissions of voxels", error);
        if (code)
            return code;
    }
    for (uint32_t p = 0; p < count; ++p) {
        cursors from = begin_of(parts[p].data, &heads[p]);
        for (uint32_t l = builder->split_level; l <= builder->depth; ++l) {
            size_t at = octree->level_begin[l] + placed[l], nodes = heads[p].nodes[l];
            if (nodes > 0)
                memcpy(octree->payloads + at, from.at[PAYLOADS], nodes * sizeof *octree->payloads);
            from.at[PAYLOADS] += nodes * sizeof *octree->payloads;
            if (nodes > 0 && heads[p].sections[EMISSIONS].size > 0)
                memcpy(octree->emissions + at, from.at[EMISSIONS], nodes * sizeof *octree->emissions);
            from.at[EMISSIONS] += nodes * sizeof *octree->emissions;
            placed[l] += (uint32_t)nodes;
        }
    }
    return GW_OK;
}

static gw_code join_sums(const gw_octree_builder *builder, const header *heads, const gw_octree_part *parts,
                         uint32_t count, void **out, gw_error *error) {
    size_t row = (size_t)heads[0].sum_bytes, placed = 0;
    gw_code code =
        gw_allocate(out, builder->levels[builder->split_level].node_count, row, "sums of voxels", error);
    for (uint32_t p = 0; !code && p < count; ++p) {
        size_t bytes = heads[p].nodes[builder->split_level] * row;
        if (heads[p].sum_bytes != row)
            return damaged(error, "its sums have another size");
        if (bytes > 0)
            memcpy((uint8_t *)*out + placed, (uint8_t *)parts[p].data + heads[p].sections[SUMS].offset,
                   bytes);
        placed += bytes;
    }
    return code;
}

/* Payloads of the levels above the split level, from the parts' sums. */
static gw_code finish_payload(gw_octree_builder *builder, const void *sums, gw_octree *octree,
                              gw_error *error) {
    if (builder->split_level == 0)
        return GW_OK;
    const gw_payload_range range = {.deepest = builder->split_level - 1, .sums_below = sums};
    gw_code code = gw_octree_upload(builder, error);
    return code ? code : gw_octree_payload(builder, &range, octree, error);
}

static gw_code run_join(gw_octree_builder *builder, header *heads, const gw_octree_part *parts,
                        uint32_t count, gw_octree *octree, gw_error *error) {
    gw_code code = GW_OK;
    void *sums = NULL;
    int64_t start = gw_now_ns();
    for (uint32_t p = 0; !code && p < count; ++p) {
        code = read_head(&parts[p], builder, p, count, &heads[p], error);
        if (!code)
            code = join_levels(builder, &heads[p], &parts[p], error);
        if (!code)
            add_statistics(&builder->statistics, &heads[p].statistics);
    }
    if (!code) {
        link_top(builder);
        code = check_joined(builder, error);
    }
    octree->statistics = builder->statistics;
    if (!code)
        code = gw_octree_assemble(builder, octree, error);
    if (!code)
        code = join_payloads(builder, heads, parts, count, octree, error);
    if (!code)
        code = join_sums(builder, heads, parts, count, &sums, error);
    if (!code)
        code = finish_payload(builder, sums, octree, error);
    free(sums);
    octree->statistics.milliseconds[3] = (double)(gw_now_ns() - start) * 1e-6;
    return code ? code : gw_octree_complete(builder, octree, error);
}

gw_code gw_octree_join(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                       const gw_octree_division *division, const gw_octree_part *parts, gw_octree **out,
                       gw_error *error) {
    gw_octree_builder builder;
    header *heads = NULL;
    gw_octree *octree = NULL;
    *out = NULL;
    gw_octree_builder_init(&builder, device, scene, options);
    builder.split_level = division->level;
    gw_code code = gw_allocate((void **)&heads, division->part_count, sizeof *heads, "parts", error);
    if (!code)
        code = gw_allocate((void **)&octree, 1, sizeof *octree, "octree", error);
    if (!code) {
        octree->depth = builder.depth;
        code = run_join(&builder, heads, parts, division->part_count, octree, error);
    }
    gw_octree_builder_finish(&builder);
    free(heads);
    if (code) {
        gw_octree_destroy(&octree);
        return gw_context(error, "cannot join the parts of the octree of '%s'",
                          scene->path ? scene->path : "scene");
    }
    *out = octree;
    return GW_OK;
}
