#include "build/mesh_junctions.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

static const double tolerance = 0x1p-21; /* rebased units */

/* The vertices of the edges in slabs of equal number along the scene's longest axis, each slab sorted along
 * the second longest: an edge meets few slabs, and few vertices of each. */
typedef struct search {
    const float (*positions)[3];
    uint32_t *vertices;
    size_t count, slab; /* slab: vertices in one; there are at most as many slabs */
    float (*reach)[2];  /* [slab number] least and greatest place along the longest axis */
    int axes[2];
} search;

typedef struct by_axis {
    const float (*positions)[3];
    int axis;
} by_axis;

static int compare_along(const void *a, const void *b, void *context) {
    const by_axis *by = context;
    const float x = by->positions[*(const uint32_t *)a][by->axis];
    const float y = by->positions[*(const uint32_t *)b][by->axis];
    return (x > y) - (x < y);
}

static int compare_ids(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static gw_code collect_vertices(search *self, const uint64_t *edges, size_t edge_count, gw_error *error) {
    gw_code code = gw_allocate((void **)&self->vertices, 2 * edge_count, sizeof *self->vertices,
                               "boundary vertices", error);
    uint32_t *ids = self->vertices;
    if (code != GW_OK)
        return code;
    for (size_t i = 0; i < edge_count; i++) {
        ids[2 * i] = (uint32_t)(edges[i] >> 32);
        ids[2 * i + 1] = (uint32_t)edges[i];
    }
    qsort(ids, 2 * edge_count, sizeof *ids, compare_ids);
    for (size_t i = 0; i < 2 * edge_count; i++)
        if (i == 0 || ids[i] != ids[self->count - 1])
            ids[self->count++] = ids[i];
    return GW_OK;
}

/* The two axes along which the vertices reach farthest. */
static void choose_axes(search *self) {
    float extent[3];
    int least = 0;
    for (int axis = 0; axis < 3; axis++) {
        float low = 1, high = -1; /* the scene is in [-1,1] */
        for (size_t i = 0; i < self->count; i++) {
            const float p = self->positions[self->vertices[i]][axis];
            low = p < low ? p : low;
            high = p > high ? p : high;
        }
        extent[axis] = high - low;
        least = extent[axis] < extent[least] ? axis : least;
    }
    const int a = (least + 1) % 3, b = (least + 2) % 3;
    self->axes[0] = extent[a] < extent[b] ? b : a;
    self->axes[1] = extent[a] < extent[b] ? a : b;
}

static gw_code sort_slabs(search *self, gw_error *error) {
    choose_axes(self);
    by_axis across = {self->positions, self->axes[0]}, along = {self->positions, self->axes[1]};
    self->slab = (size_t)ceil(sqrt((double)self->count));
    gw_code code =
        gw_allocate((void **)&self->reach, self->slab, sizeof *self->reach, "boundary vertices", error);
    if (code != GW_OK)
        return code;
    qsort_r(self->vertices, self->count, sizeof *self->vertices, compare_along, &across);
    for (size_t begin = 0; begin < self->count; begin += self->slab) {
        const size_t left = self->count - begin, size = left < self->slab ? left : self->slab;
        float *reach = self->reach[begin / self->slab];
        reach[0] = self->positions[self->vertices[begin]][across.axis];
        reach[1] = self->positions[self->vertices[begin + size - 1]][across.axis];
        qsort_r(self->vertices + begin, size, sizeof *self->vertices, compare_along, &along);
    }
    return GW_OK;
}

/* Strictly between a and b and within the tolerance of their line. */
static int lies_inside(const float p[3], const float a[3], const float b[3]) {
    double along = 0, length = 0, apart = 0, edge[3], from[3];
    for (int i = 0; i < 3; i++) {
        edge[i] = (double)b[i] - a[i];
        from[i] = (double)p[i] - a[i];
        along += edge[i] * from[i];
        length += edge[i] * edge[i];
        apart += from[i] * from[i];
    }
    return along > 0 && along < length && apart * length - along * along <= tolerance * tolerance * length;
}

/* The first of vertices [begin, end), sorted along the axis, that is not below value. */
static size_t first_from(const search *self, size_t begin, size_t end, int axis, double value) {
    while (begin < end) {
        const size_t middle = begin + (end - begin) / 2;
        if (self->positions[self->vertices[middle]][axis] < value)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

static int slab_has_junction(const search *self, size_t begin, size_t end, uint32_t a, uint32_t b) {
    const int axis = self->axes[1];
    const float *from = self->positions[a], *to = self->positions[b];
    const double low = fmin(from[axis], to[axis]) - tolerance, high = fmax(from[axis], to[axis]) + tolerance;
    for (size_t i = first_from(self, begin, end, axis, low); i < end; i++) {
        const uint32_t v = self->vertices[i];
        if (self->positions[v][axis] > high)
            return 0;
        if (v != a && v != b && lies_inside(self->positions[v], from, to))
            return 1;
    }
    return 0;
}

/* The first slab that does not end below value. */
static size_t first_slab(const search *self, double value) {
    size_t low = 0, high = (self->count + self->slab - 1) / self->slab;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (self->reach[middle][1] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static int has_junction(const search *self, uint64_t edge) {
    const uint32_t a = (uint32_t)(edge >> 32), b = (uint32_t)edge;
    const double x = self->positions[a][self->axes[0]], y = self->positions[b][self->axes[0]];
    const double low = fmin(x, y) - tolerance, high = fmax(x, y) + tolerance;
    for (size_t slab = first_slab(self, low); slab * self->slab < self->count; slab++) {
        const size_t begin = slab * self->slab, left = self->count - begin;
        if (self->reach[slab][0] > high)
            return 0;
        if (slab_has_junction(self, begin, begin + (left < self->slab ? left : self->slab), a, b))
            return 1;
    }
    return 0;
}

gw_code gw_mesh_junctions(const float (*positions)[3], const uint64_t *edges, size_t edge_count,
                          uint64_t *out, gw_error *error) {
    search self = {.positions = positions};
    *out = 0;
    if (edge_count == 0)
        return GW_OK;
    gw_code code = collect_vertices(&self, edges, edge_count, error);
    if (code == GW_OK)
        code = sort_slabs(&self, error);
    for (size_t i = 0; code == GW_OK && i < edge_count; i++)
        *out += (uint64_t)has_junction(&self, edges[i]);
    free(self.vertices);
    free(self.reach);
    return code;
}
