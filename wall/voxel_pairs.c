#include "wall/voxel_pairs.h"

#include "base/memory.h"
#include "build/gpu_types.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void gw_pairs_finish(gw_pairs *pairs) {
    free(pairs->keys);
    *pairs = (gw_pairs){0};
}

static int by_value(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Sorts and drops what occurs twice. */
static void settle(gw_pairs *pairs) {
    size_t kept = 0;
    qsort(pairs->keys, pairs->count, sizeof *pairs->keys, by_value);
    for (size_t i = 0; i < pairs->count; i++)
        if (kept == 0 || pairs->keys[i] != pairs->keys[kept - 1])
            pairs->keys[kept++] = pairs->keys[i];
    pairs->count = kept;
}

gw_code gw_pairs_of_fragments(const gw_voxelised *voxelised, gw_pairs *out, gw_error *error) {
    *out = (gw_pairs){.count = (size_t)voxelised->count};
    gw_code code = gw_allocate((void **)&out->keys, out->count, sizeof *out->keys, "voxel pairs", error);
    for (size_t i = 0; i < out->count && code == GW_OK; i++)
        out->keys[i] = (uint64_t)voxelised->fragments[i].code[0] << 32 | voxelised->fragments[i].triangle;
    if (code == GW_OK)
        settle(out);
    return code;
}

/* Pairs of a leaf; returns how many, and writes them unless keys is NULL. */
static size_t leaf_pairs(const gw_octree *octree, uint32_t node, uint64_t code, uint64_t *keys) {
    uint32_t first = gw_octree_first_reference(octree, &octree->nodes[node]);
    size_t count = 0;
    if (GW_NODE_KIND(octree->nodes[node].bits) == GW_LEAF_SINGLE) {
        if (keys)
            keys[0] = code << 32 | octree->nodes[node].link;
        return 1;
    }
    for (int last = 0; !last; count++) {
        uint32_t reference = octree->references[first + count];
        last = (reference & GW_REFERENCE_LAST) != 0;
        if (keys)
            keys[count] = code << 32 | (reference & GW_REFERENCE_ID);
    }
    return count;
}

gw_code gw_pairs_of_octree(const gw_octree *octree, gw_pairs *out, gw_error *error) {
    uint64_t *codes = NULL; /* of every node's cell, at its own level */
    *out = (gw_pairs){0};
    gw_code code = gw_allocate((void **)&codes, octree->node_count, sizeof *codes, "Morton codes", error);
    if (code != GW_OK)
        return code;
    size_t count = 0;
    for (uint32_t node = 0; node < octree->node_count; node++) { /* parents stand before their children */
        uint32_t bits = octree->nodes[node].bits, child = octree->nodes[node].link;
        if (GW_NODE_KIND(bits) != GW_KIND_INNER) {
            count += leaf_pairs(octree, node, 0, NULL);
            continue;
        }
        for (uint32_t k = 0; k < 8; k++)
            if (GW_NODE_VALID(bits) >> k & 1u)
                codes[child++] = codes[node] << 3 | k;
    }
    code = gw_allocate((void **)&out->keys, count, sizeof *out->keys, "voxel pairs", error);
    for (uint32_t node = 0; node < octree->node_count && code == GW_OK; node++)
        if (GW_NODE_KIND(octree->nodes[node].bits) != GW_KIND_INNER)
            out->count += leaf_pairs(octree, node, codes[node], out->keys + out->count);
    free(codes);
    if (code == GW_OK)
        settle(out);
    return code;
}

/* --- overlap in double precision --- */

/* The triangle's and the box's intervals on an axis through the box's centre. */
static int apart(const double v[3][3], const double axis[3], double half_side) {
    double low = INFINITY, high = -INFINITY;
    double reach = half_side * (fabs(axis[0]) + fabs(axis[1]) + fabs(axis[2]));
    for (int i = 0; i < 3; i++) {
        double at = v[i][0] * axis[0] + v[i][1] * axis[1] + v[i][2] * axis[2];
        low = fmin(low, at);
        high = fmax(high, at);
    }
    return low > reach || high < -reach;
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

int gw_triangle_meets_box(const double triangle[3][3], const double centre[3], double half_side) {
    static const double units[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double v[3][3], edges[3][3], axis[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            v[i][k] = triangle[i][k] - centre[k];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            edges[i][k] = v[(i + 1) % 3][k] - v[i][k];
    for (int i = 0; i < 3; i++)
        if (apart((const double(*)[3])v, units[i], half_side))
            return 0;
    cross(edges[0], edges[1], axis);
    if (apart((const double(*)[3])v, axis, half_side))
        return 0;
    for (int e = 0; e < 3; e++)
        for (int i = 0; i < 3; i++) {
            cross(edges[e], units[i], axis);
            if (apart((const double(*)[3])v, axis, half_side))
                return 0;
        }
    return 1;
}

/* --- differences --- */

/* Refinement inflates its boxes by so much (shaders/build/triangle_box.glsl), in rebased units. */
static const double margin = 0x1p-19;

typedef struct comparison {
    const gw_scene *scene;
    uint32_t resolution;
    double subpixel;   /* in rebased units */
    uint64_t *columns; /* triangle << 32 | column of the rasteriser's pairs, rising */
    size_t column_count;
    gw_pair_differences *out;
} comparison;

/* Every third bit of a Morton code. */
static uint32_t gather(uint64_t code, int from) {
    uint32_t value = 0;
    for (int bit = 0; bit < 10; bit++)
        value |= (uint32_t)(code >> (3 * bit + from) & 1u) << bit;
    return value;
}

static void corners_of(const gw_scene *scene, uint32_t triangle, double out[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[i][k] = scene->positions[3 * (size_t)scene->triangles[triangle][i] + (size_t)k];
}

/* The axis along which the voxeliser draws the triangle: its rule in its precision. */
static int drawn_along(const gw_scene *scene, uint32_t triangle) {
    const float *p[3];
    float e[3], f[3], size[3];
    for (int i = 0; i < 3; i++)
        p[i] = scene->positions + 3 * (size_t)scene->triangles[triangle][i];
    for (int k = 0; k < 3; k++) {
        e[k] = p[1][k] - p[0][k];
        f[k] = p[2][k] - p[0][k];
    }
    for (int k = 0; k < 3; k++)
        size[k] = fabsf(e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3]);
    return size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
}

/* The column of voxels along the triangle's axis that a pair lies in. */
static uint64_t column_of(const comparison *self, uint64_t key) {
    uint32_t triangle = (uint32_t)key;
    int axis = drawn_along(self->scene, triangle);
    return (uint64_t)triangle << 32 | gather(key >> 32, (axis + 1) % 3) << 10 |
           gather(key >> 32, (axis + 2) % 3);
}

/* 1 if the triangle meets the pair's voxel, shrunk by `shrunk` on every side. */
static int meets(const comparison *self, uint64_t key, double shrunk) {
    double corners[3][3], centre[3], side = 2.0 / self->resolution;
    corners_of(self->scene, (uint32_t)key, corners);
    for (int k = 0; k < 3; k++)
        centre[k] = (gather(key >> 32, k) + 0.5) * side - 1.0;
    return gw_triangle_meets_box((const double(*)[3])corners, centre, 0.5 * side - shrunk);
}

static void classify_refined(comparison *self, uint64_t key) {
    uint64_t column = column_of(self, key);
    if (!meets(self, key, margin))
        self->out->touching++;
    else if (bsearch(&column, self->columns, self->column_count, sizeof column, by_value))
        self->out->other_depth++;
    else if (!meets(self, key, self->subpixel))
        self->out->thinner++;
    else
        self->out->no_fragment++;
}

static void classify_rasterised(comparison *self, uint64_t key) {
    if (meets(self, key, 0))
        self->out->unexplained++;
    else
        self->out->beside++;
}

gw_code gw_pairs_compare(const gw_scene *scene, uint32_t resolution, double subpixel, const gw_pairs *refined,
                         const gw_pairs *rasterised, gw_pair_differences *out, gw_error *error) {
    *out = (gw_pair_differences){0};
    comparison self = {.scene = scene,
                       .resolution = resolution,
                       .subpixel = subpixel * 2.0 / resolution,
                       .column_count = rasterised->count,
                       .out = out};
    gw_code code = gw_allocate((void **)&self.columns, self.column_count, sizeof *self.columns,
                               "columns of voxels", error);
    if (code != GW_OK)
        return code;
    for (size_t i = 0; i < self.column_count; i++)
        self.columns[i] = column_of(&self, rasterised->keys[i]);
    qsort(self.columns, self.column_count, sizeof *self.columns, by_value);
    size_t a = 0, b = 0;
    while (a < refined->count || b < rasterised->count) {
        uint64_t x = a < refined->count ? refined->keys[a] : UINT64_MAX;
        uint64_t y = b < rasterised->count ? rasterised->keys[b] : UINT64_MAX;
        if (x < y)
            classify_refined(&self, x);
        else if (y < x)
            classify_rasterised(&self, y);
        else
            out->both++;
        a += x <= y;
        b += y <= x;
    }
    free(self.columns);
    return GW_OK;
}
