#include "build/octree_internal.h"

#include "base/memory.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Numbers that shaders/build/refine.glsl declares for the GPU side. */
enum { PAIRS_PER_BLOCK = 512, PAIRS_PER_THREAD = 8, SLOTS_PER_BLOCK = 256, GROUP = 64 };
enum { REASON_SMALL = 1, REASON_FAN, REASON_DEPTH, REASON_ISOLATED, REASON_BUDGET };
/* A pair goes to 2.3 children on average; windows are cut so that three times as many fit. */
enum { EXPECTED_GROWTH = 3 };
/* Bytes of the widest per-cell buffer: eight slots of a uvec4. */
enum { BYTES_PER_CELL = 128 };

enum {
    LOCATION_PAIR_FIRST = 1,
    LOCATION_PAIR_COUNT,
    LOCATION_CELL_FIRST,
    LOCATION_CELL_COUNT,
    LOCATION_LEVEL,
    LOCATION_OUT_COUNT,
    LOCATION_STAGE
};

typedef enum stage {
    STAGE_MASK,
    STAGE_PREFIX,
    STAGE_SCATTER,
    STAGE_CLASSIFY,
    STAGE_EMIT,
    STAGE_MOVE,
    STAGE_COUNT
} stage;
static const char *const stage_names[STAGE_COUNT] = {
    "build/refine_mask.comp",     "build/refine_prefix.comp", "build/refine_scatter.comp",
    "build/refine_classify.comp", "build/refine_emit.comp",   "build/refine_move.comp"};

/* Cells of one level that are to be refined, with their pairs, on the GPU. */
typedef struct part {
    uint32_t level;
    uint32_t cell_count, pair_count;
    gw_gl_buffer cells, pairs;
    uint32_t *node_of;  /* [cell_count] index of the cell's node in its level */
    uint32_t *pairs_of; /* [cell_count] */
} part;

typedef struct window {
    uint32_t cell_first, cell_count, pair_first, pair_count;
} window;

/* Scratch buffers of one window. */
typedef struct scratch {
    gw_gl_buffer masks, thread_bases, block_sums, block_bases, prefixes, pairs_out, classes, slot_bases,
        slot_sums, children, parents, targets, references;
} scratch;

static gw_code refine_part(gw_octree_builder *builder, const part *parent, gw_error *error);

static void finish_part(part *p) {
    gw_gl_buffer_finish(&p->cells);
    gw_gl_buffer_finish(&p->pairs);
    free(p->node_of);
    free(p->pairs_of);
    p->node_of = p->pairs_of = NULL;
}

static void finish_scratch(scratch *s) {
    gw_gl_buffer *all[] = {&s->masks,     &s->thread_bases, &s->block_sums, &s->block_bases, &s->prefixes,
                           &s->pairs_out, &s->classes,      &s->slot_bases, &s->slot_sums,   &s->children,
                           &s->parents,   &s->targets,      &s->references};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        gw_gl_buffer_finish(all[i]);
}

static uint32_t blocks_of(uint32_t count, uint32_t block) {
    return count / block + (count % block != 0);
}

/* Program of a stage with the window's numbers in its uniforms. */
static gw_code stage_program(gw_octree_builder *builder, stage which, uint32_t level, const window *w,
                             uint32_t out_count, GLuint *program, gw_error *error) {
    gw_code code = gw_gl_program(builder->device, stage_names[which], NULL, program, error);
    if (code != GW_OK)
        return code;
    glProgramUniform1ui(*program, LOCATION_PAIR_FIRST, w->pair_first);
    glProgramUniform1ui(*program, LOCATION_PAIR_COUNT, w->pair_count);
    glProgramUniform1ui(*program, LOCATION_CELL_FIRST, w->cell_first);
    glProgramUniform1ui(*program, LOCATION_CELL_COUNT, w->cell_count);
    glProgramUniform1ui(*program, LOCATION_LEVEL, level);
    glProgramUniform1ui(*program, LOCATION_OUT_COUNT, out_count);
    /* All stages declare these locations; setting one that a stage does not use is no error. */
    return GW_OK;
}

/* Counts the children of every pair; totals[k] pairs touch child k. */
static gw_code count_children(gw_octree_builder *builder, const part *p, const window *w, scratch *s,
                              uint64_t totals[8], gw_error *error) {
    GLuint program;
    uint32_t blocks = blocks_of(w->pair_count, PAIRS_PER_BLOCK);
    uint32_t threads = blocks_of(w->pair_count, PAIRS_PER_THREAD);
    uint32_t *sums = NULL, *bases = NULL;
    gw_gl *device = builder->device;
    gw_code code = stage_program(builder, STAGE_MASK, p->level, w, 0, &program, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "child masks", (size_t)threads * 8, NULL, GL_RG32UI, &s->masks,
                                   error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "pair sums", (size_t)threads * 16, NULL, GL_RGBA32UI,
                                   &s->thread_bases, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "block sums", (size_t)blocks * 16, NULL, 0, &s->block_sums, error);
    if (code != GW_OK)
        return code;
    gw_gl_texture_bind(&builder->triangles, 0);
    gw_gl_texture_bind(&p->cells, 1);
    gw_gl_texture_bind(&p->pairs, 3);
    gw_gl_buffer_bind(&s->masks, 2);
    gw_gl_buffer_bind(&s->thread_bases, 3);
    gw_gl_buffer_bind(&s->block_sums, 4);
    code = gw_gl_dispatch(device, program, blocks, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&sums, (size_t)blocks * 4, sizeof *sums, "block sums", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&bases, (size_t)blocks * 8, sizeof *bases, "block bases", error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&s->block_sums, 0, (size_t)blocks * 16, sums, error);
    memset(totals, 0, 8 * sizeof *totals);
    for (uint32_t block = 0; code == GW_OK && block < blocks; ++block)
        for (uint32_t k = 0; k < 8; ++k) {
            uint32_t word = sums[(size_t)block * 4 + k / 2];
            bases[(size_t)block * 8 + k] =
                (uint32_t)totals[k]; /* a total beyond 32 bits is refused by the caller */
            totals[k] += k % 2 ? word >> 16 : word & 0xffffu;
        }
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "block bases", (size_t)blocks * 32, bases, GL_RGBA32UI,
                                   &s->block_bases, error);
    free(sums);
    free(bases);
    return code;
}

/* Builds the lists of all child slots in s->pairs_out. */
static gw_code scatter_pairs(gw_octree_builder *builder, const part *p, const window *w, scratch *s,
                             const uint64_t totals[8], uint32_t out_count, gw_error *error) {
    GLuint program;
    gw_gl *device = builder->device;
    uint32_t blocks = blocks_of(w->pair_count, PAIRS_PER_BLOCK);
    uint32_t last[8];
    gw_code code = gw_gl_buffer_create(device, "cell prefixes", ((size_t)w->cell_count + 1) * 32, NULL,
                                       GL_RGBA32UI, &s->prefixes, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "child pairs", (size_t)out_count * 8, NULL, GL_RG32UI,
                                   &s->pairs_out, error);
    if (code != GW_OK)
        return code;
    for (uint32_t k = 0; k < 8; ++k)
        last[k] = (uint32_t)totals[k];
    code = gw_gl_buffer_write(&s->prefixes, (size_t)w->cell_count * 32, sizeof last, last, error);
    if (code != GW_OK)
        return code;
    gw_gl_texture_bind(&s->masks, 4);
    gw_gl_texture_bind(&s->thread_bases, 5);
    gw_gl_texture_bind(&s->block_bases, 6);
    gw_gl_buffer_bind(&s->prefixes, 5);
    gw_gl_buffer_bind(&s->pairs_out, 6);
    code = stage_program(builder, STAGE_PREFIX, p->level, w, 0, &program, error);
    if (code == GW_OK)
        code = gw_gl_dispatch(device, program, blocks, error);
    gw_gl_texture_bind(&s->prefixes, 2);
    if (code == GW_OK)
        code = stage_program(builder, STAGE_SCATTER, p->level, w, out_count, &program, error);
    if (code == GW_OK)
        code = gw_gl_dispatch(device, program, blocks, error);
    return code;
}

/* Decides what each slot becomes. totals: children, inner cells, their pairs, references. */
static gw_code classify_slots(gw_octree_builder *builder, const part *p, const window *w, scratch *s,
                              uint32_t totals[4], gw_error *error) {
    GLuint program;
    gw_gl *device = builder->device;
    const gw_settings *settings = builder->settings;
    uint32_t slots = w->cell_count * 8;
    uint32_t blocks = blocks_of(slots, SLOTS_PER_BLOCK);
    uint32_t *sums = NULL;
    gw_code code = gw_gl_buffer_create(device, "classes", (size_t)slots * 4, NULL, 0, &s->classes, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "slot bases", (size_t)slots * 16, NULL, 0, &s->slot_bases, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "slot sums", (size_t)blocks * 16, NULL, 0, &s->slot_sums, error);
    if (code == GW_OK)
        code = stage_program(builder, STAGE_CLASSIFY, p->level, w, 0, &program, error);
    if (code != GW_OK)
        return code;
    glProgramUniform1ui(program, LOCATION_STAGE, (GLuint)settings->leaf_triangles);
    glProgramUniform1ui(program, LOCATION_STAGE + 1, settings->fan_rule ? (GLuint)settings->fan_cap : 0);
    glProgramUniform1ui(program, LOCATION_STAGE + 2, (GLuint)settings->isolation_rule);
    glProgramUniform1ui(program, LOCATION_STAGE + 3, p->level + 1 == builder->depth);
    glProgramUniform1ui(program, LOCATION_STAGE + 4,
                        gw_octree_least_pairs(builder->least_gain, p->level + 1));
    gw_gl_texture_bind(&builder->triangles, 0);
    gw_gl_texture_bind(&builder->topology, 1);
    gw_gl_texture_bind(&s->pairs_out, 3);
    gw_gl_buffer_bind(&s->classes, 7);
    gw_gl_buffer_bind(&s->slot_bases, 8);
    gw_gl_buffer_bind(&s->slot_sums, 9);
    code = gw_gl_dispatch(device, program, blocks, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&sums, (size_t)blocks * 4, sizeof *sums, "slot sums", error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&s->slot_sums, 0, (size_t)blocks * 16, sums, error);
    memset(totals, 0, 4 * sizeof *totals);
    for (uint32_t block = 0; code == GW_OK && block < blocks; ++block)
        for (uint32_t k = 0; k < 4; ++k) {
            uint32_t count = sums[(size_t)block * 4 + k];
            sums[(size_t)block * 4 + k] = totals[k];
            totals[k] += count;
        }
    if (code == GW_OK)
        code = gw_gl_buffer_write(&s->slot_sums, 0, (size_t)blocks * 16, sums, error);
    free(sums);
    return code;
}

/* Nodes, next cells, next pairs and references from the classes. */
static gw_code emit_children(gw_octree_builder *builder, const part *p, const window *w, scratch *s,
                             const uint32_t totals[4], uint32_t out_count, part *next, gw_error *error) {
    GLuint program;
    gw_gl *device = builder->device;
    const gw_octree_level *level = &builder->levels[p->level + 1];
    next->level = p->level + 1;
    next->cell_count = totals[1];
    next->pair_count = totals[2];
    gw_code code =
        gw_gl_buffer_create(device, "children", (size_t)totals[0] * 16, NULL, 0, &s->children, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "parents", (size_t)w->cell_count * 8, NULL, 0, &s->parents, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "targets", (size_t)w->cell_count * 128, NULL, GL_RGBA32UI,
                                   &s->targets, error);
    if (code == GW_OK)
        code =
            gw_gl_buffer_create(device, "references", (size_t)totals[3] * 4, NULL, 0, &s->references, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "cells", (size_t)totals[1] * 16, NULL, GL_RGBA32UI, &next->cells,
                                   error);
    if (code == GW_OK)
        code =
            gw_gl_buffer_create(device, "pairs", (size_t)totals[2] * 8, NULL, GL_RG32UI, &next->pairs, error);
    if (code == GW_OK)
        code = stage_program(builder, STAGE_EMIT, p->level, w, out_count, &program, error);
    if (code != GW_OK)
        return code;
    glProgramUniform1ui(program, LOCATION_STAGE, (GLuint)level->reference_count);
    gw_gl_texture_bind(&p->cells, 1);
    gw_gl_buffer_bind(&s->children, 10);
    gw_gl_buffer_bind(&next->cells, 11);
    gw_gl_buffer_bind(&s->parents, 12);
    gw_gl_buffer_bind(&s->targets, 13);
    gw_gl_buffer_bind(&next->pairs, 14);
    gw_gl_buffer_bind(&s->references, 15);
    code = gw_gl_dispatch(device, program, blocks_of(w->cell_count * 8, GROUP), error);
    gw_gl_texture_bind(&s->targets, 4);
    if (code == GW_OK)
        code = stage_program(builder, STAGE_MOVE, p->level, w, out_count, &program, error);
    if (code == GW_OK)
        code = gw_gl_dispatch(device, program, blocks_of(out_count, GROUP), error);
    return code;
}

static void count_node(gw_octree_statistics *statistics, uint32_t class_bits) {
    statistics->inner += (class_bits & 0xfu) == GW_KIND_INNER;
    statistics->leaves += (class_bits & 0xfu) != GW_KIND_INNER;
    statistics->single_leaves += (class_bits & 0xfu) == GW_LEAF_SINGLE;
    switch ((class_bits >> 4) & 0xfu) {
    case REASON_SMALL:
        statistics->stopped_small++;
        break;
    case REASON_FAN:
        statistics->stopped_fan++;
        break;
    case REASON_DEPTH:
        statistics->stopped_depth++;
        break;
    case REASON_ISOLATED:
        statistics->refined_isolated++;
        break;
    case REASON_BUDGET:
        statistics->stopped_budget++;
        break;
    default:
        break;
    }
}

/* Levels that are kept also when the rest is only counted. */
static int is_kept(const gw_octree_builder *builder, uint32_t level) {
    return !builder->counting || level <= builder->split_level;
}

/* Appends the children that `data` holds ([count][4]: link or, of inner ones, pairs; bits; cell) to the level
 * and lists the inner ones in part. */
static gw_code append_nodes(gw_octree_builder *builder, uint32_t at_level, const uint32_t (*data)[4],
                            uint32_t count, part *inner, gw_error *error) {
    gw_octree_level *level = &builder->levels[at_level];
    const int kept = is_kept(builder, at_level);
    size_t needed = kept ? level->node_count + count : 0;
    uint32_t inner_count = 0;
    if (needed > UINT32_MAX / 2)
        return gw_fail(error, GW_MACHINE,
                       "octree level %" PRIu32 " needs %zu nodes, more than 2^31; lower octree_depth",
                       at_level, needed);
    gw_code code = gw_grow((void **)&level->nodes, &level->node_capacity, needed, sizeof *level->nodes,
                           "octree nodes", error);
    if (code == GW_OK)
        code = gw_grow((void **)&level->cells, &level->cell_capacity, needed, sizeof *level->cells,
                       "octree cells", error);
    if (code != GW_OK)
        return code;
    for (uint32_t i = 0; i < count; ++i) {
        size_t at = level->node_count + i;
        uint32_t class_bits = data[i][1] >> 16;
        const int is_inner = (class_bits & 0xfu) == GW_KIND_INNER;
        if (is_inner) {
            inner->pairs_of[inner_count] = data[i][0];
            inner->node_of[inner_count++] = (uint32_t)at;
        }
        if (gw_octree_owns(builder, at_level, &data[i][2]))
            count_node(&builder->statistics, class_bits);
        if (!kept)
            continue;
        level->nodes[at] = (gw_node){is_inner ? 0 : data[i][0], (class_bits & 0xfu) << 16};
        memcpy(level->cells[at], &data[i][2], sizeof level->cells[at]);
    }
    level->node_count = needed;
    return GW_OK;
}

static gw_code append_references(gw_octree_level *level, const gw_gl_buffer *buffer, uint32_t count,
                                 gw_error *error) {
    size_t needed = level->reference_count + count;
    if (needed > UINT32_MAX / 2)
        return gw_fail(error, GW_MACHINE,
                       "the octree needs %zu references on one level, more than 2^31; lower "
                       "octree_depth or raise leaf_triangles",
                       needed);
    gw_code code = gw_grow((void **)&level->references, &level->reference_capacity, needed,
                           sizeof *level->references, "octree references", error);
    if (code == GW_OK && count > 0)
        code = gw_gl_buffer_read(buffer, 0, (size_t)count * 4, level->references + level->reference_count,
                                 error);
    if (code == GW_OK)
        level->reference_count = needed;
    return code;
}

/* From here on the tree is only counted: it does not fit. */
static void stop_keeping(gw_octree_builder *builder) {
    builder->counting = 1;
    for (uint32_t l = builder->split_level + 1; l <= GW_OCTREE_MAXIMUM_DEPTH; ++l) {
        gw_octree_level *level = &builder->levels[l];
        free(level->nodes);
        free(level->cells);
        free(level->references);
        *level = (gw_octree_level){0};
    }
}

static gw_code keep_window(gw_octree_builder *builder, const part *p, const window *w, const scratch *s,
                           const uint32_t totals[4], const uint32_t (*parents)[2], uint32_t first_child,
                           gw_error *error) {
    gw_code code = GW_OK;
    if (is_kept(builder, p->level + 1))
        code = append_references(&builder->levels[p->level + 1], &s->references, totals[3], error);
    for (uint32_t i = 0; code == GW_OK && is_kept(builder, p->level) && i < w->cell_count; ++i) {
        gw_node *node = &builder->levels[p->level].nodes[p->node_of[w->cell_first + i]];
        node->link = first_child + parents[i][0];
        node->bits |= parents[i][1];
    }
    return code;
}

/* Reads a window's results back, links parents to children and notes what they take. */
static gw_code collect(gw_octree_builder *builder, const part *p, const window *w, const scratch *s,
                       const uint32_t totals[4], part *next, gw_error *error) {
    gw_octree_level *below = &builder->levels[p->level + 1];
    const uint32_t first_child = (uint32_t)below->node_count;
    const size_t reference_end = below->reference_count + totals[3];
    uint32_t(*children)[4] = NULL;
    uint32_t(*parents)[2] = NULL;
    gw_code code = gw_allocate((void **)&children, totals[0], sizeof *children, "children", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&parents, w->cell_count, sizeof *parents, "parents", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&next->node_of, next->cell_count, sizeof *next->node_of, "inner nodes",
                           error);
    if (code == GW_OK)
        code = gw_allocate((void **)&next->pairs_of, next->cell_count, sizeof *next->pairs_of, "inner nodes",
                           error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&s->children, 0, (size_t)totals[0] * 16, children, error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&s->parents, 0, (size_t)w->cell_count * 8, parents, error);
    if (code == GW_OK)
        code = append_nodes(builder, p->level + 1, (const uint32_t(*)[4])children, totals[0], next, error);
    if (code == GW_OK)
        code = keep_window(builder, p, w, s, totals, (const uint32_t(*)[2])parents, first_child, error);
    if (code == GW_OK) {
        const gw_octree_refined refined = {
            .level = p->level,
            .cell_count = w->cell_count,
            .child_count = totals[0],
            .pairs = p->pairs_of + w->cell_first,
            .children = (const uint32_t(*)[4])children,
            .parents = (const uint32_t(*)[2])parents,
            .nodes = p->node_of + w->cell_first,
            .reference_end = (uint32_t)reference_end,
        };
        gw_octree_note(builder, &refined);
        const gw_octree_rows rows = gw_octree_budget_rows(&builder->budget, 0);
        if (builder->may_count && !builder->counting && !gw_octree_rows_fit(&rows, &builder->allowance))
            stop_keeping(builder);
    }
    free(children);
    free(parents);
    return code;
}

/* The first pair of a cell, or the part's pair count for the cell after the last. */
static gw_code first_pair(const part *p, uint32_t cell, uint32_t *out, gw_error *error) {
    if (cell >= p->cell_count) {
        *out = p->pair_count;
        return GW_OK;
    }
    return gw_gl_buffer_read(&p->cells, (size_t)cell * 16 + 8, 4, out, error);
}

static gw_code refine_window(gw_octree_builder *builder, const part *p, const window *w, gw_error *error);

static gw_code refine_halves(gw_octree_builder *builder, const part *p, const window *w, gw_error *error) {
    window low = *w, high = *w;
    uint32_t middle = w->cell_first + w->cell_count / 2;
    uint32_t pair = 0;
    gw_code code = first_pair(p, middle, &pair, error);
    if (code != GW_OK)
        return code;
    low.cell_count = middle - w->cell_first;
    low.pair_count = pair - w->pair_first;
    high.cell_first = middle;
    high.cell_count = w->cell_count - low.cell_count;
    high.pair_first = pair;
    high.pair_count = w->pair_count - low.pair_count;
    builder->statistics.parts++;
    code = refine_window(builder, p, &low, error);
    return code == GW_OK ? refine_window(builder, p, &high, error) : code;
}

/* The middle of refine_window: from lists to the next part. */
static gw_code descend(gw_octree_builder *builder, const part *p, const window *w, scratch *s,
                       const uint64_t totals[8], uint32_t out_count, part *next, gw_error *error) {
    uint32_t slot_totals[4];
    gw_code code = scatter_pairs(builder, p, w, s, totals, out_count, error);
    if (code == GW_OK)
        code = classify_slots(builder, p, w, s, slot_totals, error);
    if (code == GW_OK)
        code = emit_children(builder, p, w, s, slot_totals, out_count, next, error);
    if (code == GW_OK)
        code = collect(builder, p, w, s, slot_totals, next, error);
    return code;
}

static gw_code refine_window(gw_octree_builder *builder, const part *p, const window *w, gw_error *error) {
    scratch s = {0};
    part next = {0};
    uint64_t totals[8] = {0}, out_count = 0;
    int divisible = w->cell_count > 1;
    if (divisible && (w->cell_count > builder->cell_limit ||
                      (uint64_t)w->pair_count * EXPECTED_GROWTH > builder->pair_limit))
        return refine_halves(builder, p, w, error);
    gw_code code = count_children(builder, p, w, &s, totals, error);
    for (int k = 0; k < 8; ++k)
        out_count += totals[k];
    if (code == GW_OK && out_count > builder->pair_limit) {
        finish_scratch(&s);
        if (divisible)
            return refine_halves(builder, p, w, error);
        return gw_fail(error, GW_MACHINE,
                       "one octree cell at level %" PRIu32 " passes %" PRIu64
                       " triangle references to its children, %" PRIu64
                       " fit in one buffer of this driver; reduce the model (fewer triangles in one place)",
                       p->level, out_count, builder->pair_limit);
    }
    builder->statistics.overlap_tests += (uint64_t)w->pair_count * 8;
    builder->statistics.pairs += out_count;
    if (code == GW_OK)
        code = descend(builder, p, w, &s, totals, (uint32_t)out_count, &next, error);
    finish_scratch(&s);
    if (code == GW_OK && next.cell_count > 0)
        code = refine_part(builder, &next, error);
    finish_part(&next);
    return code;
}

uint64_t gw_octree_cell_key(const uint32_t cell[2]) {
    const uint32_t axes[3] = {cell[0] & 0xffffu, cell[0] >> 16, cell[1]};
    uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (int bit = 0; bit < GW_OCTREE_MAXIMUM_DEPTH; ++bit)
            key |= (uint64_t)(axes[axis] >> bit & 1u) << (3 * bit + axis);
    return key;
}

int gw_octree_owns(const gw_octree_builder *builder, uint32_t level, const uint32_t cell[2]) {
    if (level > builder->split_level)
        return 1;
    uint64_t key = gw_octree_cell_key(cell) << (3 * (builder->split_level - level));
    return key >= builder->key_first && key < builder->key_last;
}

/* Whether some of the cell's descendants at the split level belong to the builder's part. */
static int concerns(const gw_octree_builder *builder, uint32_t level, const uint32_t cell[2]) {
    if (level > builder->split_level)
        return 1;
    uint32_t shift = 3 * (builder->split_level - level);
    uint64_t key = gw_octree_cell_key(cell);
    return key << shift < builder->key_last && (key + 1) << shift > builder->key_first;
}

/* The cells of p that concern the builder's part, which follow one another because both are in Morton order.
 */
static gw_code own_window(const gw_octree_builder *builder, const part *p, window *out, gw_error *error) {
    const gw_octree_level *level = &builder->levels[p->level];
    uint32_t first = 0, last = p->cell_count, pair_first = 0, pair_last = 0;
    while (first < last && !concerns(builder, p->level, level->cells[p->node_of[first]]))
        first++;
    while (last > first && !concerns(builder, p->level, level->cells[p->node_of[last - 1]]))
        last--;
    gw_code code = first < last ? first_pair(p, first, &pair_first, error) : GW_OK;
    if (code == GW_OK && first < last)
        code = first_pair(p, last, &pair_last, error);
    *out = (window){first, last - first, pair_first, pair_last - pair_first};
    return code;
}

static gw_code refine_part(gw_octree_builder *builder, const part *p, gw_error *error) {
    window own = {0, p->cell_count, 0, p->pair_count};
    gw_log_progress(builder->log, "refining the octree", (double)p->level / builder->depth);
    gw_code code = p->level <= builder->split_level ? own_window(builder, p, &own, error) : GW_OK;
    return code == GW_OK && own.cell_count > 0 ? refine_window(builder, p, &own, error) : code;
}

/* The root cell with every triangle. */
static gw_code make_root(gw_octree_builder *builder, part *root, gw_error *error) {
    uint32_t count = builder->scene->triangle_count;
    uint32_t cell[4] = {0, 0, 0, count};
    uint32_t(*pairs)[2] = NULL;
    uint32_t child[1][4] = {{count, GW_KIND_INNER, 0, 0}};
    root->cell_count = 1;
    root->pair_count = count;
    gw_code code = gw_allocate((void **)&pairs, count, sizeof *pairs, "triangle list", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&root->node_of, 1, sizeof *root->node_of, "root", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&root->pairs_of, 1, sizeof *root->pairs_of, "root", error);
    for (uint32_t i = 0; code == GW_OK && i < count; ++i)
        pairs[i][0] = i;
    if (code == GW_OK)
        code = append_nodes(builder, 0, (const uint32_t(*)[4])child, 1, root, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(builder->device, "root cell", sizeof cell, cell, GL_RGBA32UI, &root->cells,
                                   error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(builder->device, "root pairs", (size_t)count * 8, pairs, GL_RG32UI,
                                   &root->pairs, error);
    free(pairs);
    return code;
}

gw_code gw_octree_refine(gw_octree_builder *builder, gw_error *error) {
    part root = {0};
    gw_code code;
    uint64_t cell_bytes = (uint64_t)gw_gl_limits_of(builder->device)->storage_block_bytes / BYTES_PER_CELL;
    builder->cell_limit = cell_bytes < UINT32_MAX / 16 ? cell_bytes : UINT32_MAX / 16;
    builder->statistics.parts = 1;
    builder->statistics.least_gain = builder->least_gain;
    if (builder->scene->triangle_count > builder->pair_limit)
        return gw_fail(error, GW_MACHINE,
                       "the scene has %" PRIu32 " triangles, this driver's buffers hold %" PRIu64
                       " at a time; reduce the model or use a driver with larger storage blocks",
                       builder->scene->triangle_count, builder->pair_limit);
    code = make_root(builder, &root, error);
    if (code == GW_OK)
        code = refine_part(builder, &root, error);
    finish_part(&root);
    return code;
}
