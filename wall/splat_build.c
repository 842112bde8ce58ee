#include "wall/splat_build.h"

#include "base/clock.h"
#include "base/memory.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* As shaders/build/splat.glsl has them. */
static const uint32_t flag_inner = 0x80000000u, flag_split = 0x40000000u, no_triangle = 0x3fffffffu;
enum {
    LOCATION_FRAGMENTS = 1,
    LOCATION_DEPTH,
    LOCATION_LEVEL,
    LOCATION_NODE_FIRST,
    LOCATION_NODE_COUNT,
    LOCATION_TRIANGLES,
    LOCATION_PAIRS,
    LOCATION_CAPACITY
};
enum { GROUP = 64, DEEPEST = 10, NODE_BYTES = 8, VOXEL_BYTES = 16 };

typedef struct builder {
    gw_gl *device;
    const gw_voxelised *voxelised;
    uint32_t depth, triangle_count, capacity;
    uint32_t level_first[DEEPEST + 2]; /* first node of each level; the next entry ends it */
    uint32_t pair_entries;
    gw_gl_buffer nodes, counters, pairs, offsets, lists, voxels;
    gw_splat_counts *out;
} builder;

/* A kernel over the fragments (by_node 0) or over a level's nodes. */
static gw_code run(builder *self, const char *name, const char *defines, uint32_t level, int by_node,
                   gw_error *error) {
    GLuint program;
    uint32_t first = self->level_first[level], nodes = self->level_first[level + 1] - first;
    uint64_t items = by_node ? nodes : self->voxelised->count;
    gw_code code = gw_gl_program(self->device, name, defines, &program, error);
    if (code != GW_OK)
        return code;
    glProgramUniform1ui(program, LOCATION_FRAGMENTS, (GLuint)self->voxelised->count);
    glProgramUniform1ui(program, LOCATION_DEPTH, self->depth);
    glProgramUniform1ui(program, LOCATION_LEVEL, level);
    glProgramUniform1ui(program, LOCATION_NODE_FIRST, first);
    glProgramUniform1ui(program, LOCATION_NODE_COUNT, nodes);
    glProgramUniform1ui(program, LOCATION_TRIANGLES, self->triangle_count);
    glProgramUniform1ui(program, LOCATION_PAIRS, self->pair_entries);
    glProgramUniform1ui(program, LOCATION_CAPACITY, self->capacity);
    gw_gl_buffer_bind(&self->voxelised->buffer, 0);
    gw_gl_buffer_bind(&self->nodes, 1);
    gw_gl_buffer_bind(&self->counters, 2);
    gw_gl_buffer_bind(&self->pairs, 3);
    gw_gl_buffer_bind(&self->offsets, 4);
    gw_gl_buffer_bind(&self->lists, 5);
    gw_gl_buffer_bind(&self->voxels, 6);
    return gw_gl_dispatch(self->device, program, (items + GROUP - 1) / GROUP, error);
}

static gw_code prepare(builder *self, gw_error *error) {
    uint64_t limit = (uint64_t)gw_gl_limits_of(self->device)->storage_block_bytes / VOXEL_BYTES;
    /* An inner node holds three fragments at least; eight children each, on every level. */
    uint64_t most = 1 + 8 * (self->voxelised->count / 3 + 1) * self->depth;
    const uint32_t root[2] = {no_triangle, no_triangle}, counters[2] = {1, 0};
    self->capacity = (uint32_t)(most < limit ? most : limit);
    gw_code code = gw_gl_buffer_create(self->device, "nodes", (size_t)self->capacity * NODE_BYTES, NULL, 0,
                                       &self->nodes, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(self->device, "node counters", sizeof counters, counters, 0,
                                   &self->counters, error);
    if (code == GW_OK) /* a fragment is in one pair at most */
        code = gw_gl_buffer_create(self->device, "pairs of triangles", (size_t)self->voxelised->count * 4 + 8,
                                   NULL, 0, &self->pairs, error);
    if (code == GW_OK)
        code = gw_gl_buffer_write(&self->nodes, 0, sizeof root, root, error);
    return code;
}

static gw_code top_down(builder *self, gw_error *error) {
    uint32_t counters[2] = {1, 0};
    gw_code code = GW_OK;
    self->level_first[1] = 1;
    for (uint32_t level = 0; level <= self->depth && code == GW_OK; level++) {
        code = run(self, "build/splat_insert.comp", NULL, level, 0, error);
        if (code == GW_OK)
            code = run(self, "build/splat_split.comp", NULL, level, 1, error);
        if (code == GW_OK)
            code = gw_gl_buffer_read(&self->counters, 0, sizeof counters, counters, error);
        if (code == GW_OK && counters[0] > self->capacity)
            code = gw_fail(error, GW_MACHINE,
                           "the paper's build needs %" PRIu32 " nodes at level %" PRIu32 ", %" PRIu32
                           " fit in one buffer of this driver",
                           counters[0], level, self->capacity);
        if (level < self->depth)
            self->level_first[level + 2] = counters[0];
    }
    self->pair_entries = counters[1];
    return code;
}

/* Reads the finest level's counts and adds them up; *entries is their sum. */
static gw_code sum_counts(builder *self, uint32_t *entries, gw_error *error) {
    uint32_t first = self->level_first[self->depth], count = self->level_first[self->depth + 1] - first;
    uint32_t(*nodes)[2] = NULL, *offsets = NULL;
    *entries = 0;
    gw_code code = gw_allocate((void **)&nodes, count, sizeof *nodes, "nodes", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&offsets, (size_t)count + 1, sizeof *offsets, "offsets of lists", error);
    if (code == GW_OK && count > 0)
        code = gw_gl_buffer_read(&self->nodes, (size_t)first * NODE_BYTES, (size_t)count * NODE_BYTES, nodes,
                                 error);
    for (uint32_t i = 0; i < count && code == GW_OK; i++) {
        offsets[i] = *entries;
        *entries += nodes[i][0] & flag_split ? nodes[i][1] : 0;
        offsets[i + 1] = *entries;
    }
    if (code == GW_OK)
        code = gw_gl_buffer_create(self->device, "offsets of lists", ((size_t)count + 1) * 4, offsets, 0,
                                   &self->offsets, error);
    free(nodes);
    free(offsets);
    return code;
}

static gw_code make_lists(builder *self, gw_error *error) {
    uint32_t entries = 0;
    gw_code code = run(self, "build/splat_list.comp", "#define FILL 0\n", self->depth, 0, error);
    if (code == GW_OK)
        code = sum_counts(self, &entries, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(self->device, "lists of triangles", (size_t)entries * 4, NULL, 0,
                                   &self->lists, error);
    if (code == GW_OK)
        code = run(self, "build/splat_list.comp", "#define FILL 1\n", self->depth, 0, error);
    if (code == GW_OK)
        code = run(self, "build/splat_relink.comp", NULL, self->depth, 1, error);
    self->out->list_entries = entries;
    return code;
}

static gw_code fill_leaves(builder *self, gw_error *error) {
    size_t bytes = (size_t)self->level_first[self->depth + 1] * VOXEL_BYTES;
    gw_code code = gw_gl_buffer_create(self->device, "voxels", bytes, NULL, 0, &self->voxels, error);
    return code == GW_OK ? run(self, "build/splat_leaf.comp", NULL, self->depth, 0, error) : code;
}

static gw_code bottom_up(builder *self, gw_error *error) {
    gw_code code = GW_OK;
    for (uint32_t level = self->depth; level-- > 0 && code == GW_OK;)
        code = run(self, "build/splat_up.comp", NULL, level, 1, error);
    return code;
}

static gw_code count_nodes(builder *self, gw_error *error) {
    uint32_t count = self->level_first[self->depth + 1];
    uint32_t(*nodes)[2] = NULL;
    gw_splat_counts *out = self->out;
    gw_code code = gw_allocate((void **)&nodes, count, sizeof *nodes, "nodes", error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&self->nodes, 0, (size_t)count * NODE_BYTES, nodes, error);
    for (uint32_t i = 0; i < count && code == GW_OK; i++) {
        if (nodes[i][0] & flag_inner)
            out->inner++;
        else if (nodes[i][0] == no_triangle)
            out->empty++;
        else
            out->leaves++;
    }
    out->nodes = count;
    out->pair_entries = self->pair_entries;
    free(nodes);
    return code;
}

gw_code gw_splat_build(gw_gl *device, const gw_voxelised *voxelised, uint32_t depth, uint32_t triangle_count,
                       gw_splat_counts *out, gw_error *error) {
    static gw_code (*const phases[GW_SPLAT_PHASES])(builder *, gw_error *) = {top_down, make_lists,
                                                                              fill_leaves, bottom_up};
    builder self = {.device = device,
                    .voxelised = voxelised,
                    .depth = depth,
                    .triangle_count = triangle_count,
                    .out = out};
    *out = (gw_splat_counts){0};
    if (!voxelised->buffer.id)
        return gw_fail(error, GW_MACHINE,
                       "the paper's build needs all %" PRIu64
                       " fragments in one buffer, which this driver's storage "
                       "blocks do not hold",
                       voxelised->count);
    gw_code code = prepare(&self, error);
    for (int p = 0; p < GW_SPLAT_PHASES && code == GW_OK; p++) {
        int64_t begin = gw_now_ns();
        code = phases[p](&self, error);
        if (code == GW_OK)
            code = gw_gl_finish(device, error);
        out->milliseconds[p] = (double)(gw_now_ns() - begin) * 1e-6;
    }
    if (code == GW_OK)
        code = count_nodes(&self, error);
    gw_gl_buffer *all[] = {&self.nodes,   &self.counters, &self.pairs,
                           &self.offsets, &self.lists,    &self.voxels};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        gw_gl_buffer_finish(all[i]);
    return code;
}
