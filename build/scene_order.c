#include "build/scene_order.h"

#include "base/memory.h"
#include "build/radix_sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MORTON_BITS = 21 };

typedef struct order {
    const gw_scene *scene;
    const uint32_t *vertices;
    uint32_t *material_rank; /* materials of equal content have equal ranks */
} order;

static int compare_words(const uint32_t *a, const uint32_t *b, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

/* Corners of a triangle differ in position, so the least one is unique; in an animated scene they may meet at
 * time 0, and differ in what they are then. */
static void rotate_triangle(uint32_t triangle[3], const uint32_t *vertices) {
    uint32_t first = 0;
    for (uint32_t i = 1; i < 3; i++)
        if (compare_words(vertices + (size_t)triangle[i] * GW_VERTEX_WORDS,
                          vertices + (size_t)triangle[first] * GW_VERTEX_WORDS, GW_VERTEX_WORDS) < 0)
            first = i;
    const uint32_t corners[3] = {triangle[0], triangle[1], triangle[2]};
    for (uint32_t i = 0; i < 3; i++)
        triangle[i] = corners[(first + i) % 3];
}

/* Two zero bits before each of the low 21 bits. */
static uint64_t spread_bits(uint64_t value) {
    value &= 0x1fffff;
    value = (value | value << 32) & 0x1f00000000ffffu;
    value = (value | value << 16) & 0x1f0000ff0000ffu;
    value = (value | value << 8) & 0x100f00f00f00f00fu;
    value = (value | value << 4) & 0x10c30c30c30c30c3u;
    return (value | value << 2) & 0x1249249249249249u;
}

/* The centroid in integers: a sum of floats would depend on the order of the corners. */
static uint64_t centroid_code(const uint32_t triangle[3], const uint32_t *vertices) {
    uint64_t code = 0;
    for (int axis = 0; axis < 3; axis++) {
        int64_t sum = 0;
        for (int i = 0; i < 3; i++) {
            float coordinate;
            memcpy(&coordinate, vertices + (size_t)triangle[i] * GW_VERTEX_WORDS + axis, sizeof coordinate);
            sum += (int64_t)floor(((double)coordinate + 1.0) * 0x1p30); /* [-1,1] to [0, 2^31] */
        }
        int64_t cell = sum / 3 >> (31 - MORTON_BITS);
        if (cell > (1 << MORTON_BITS) - 1)
            cell = (1 << MORTON_BITS) - 1;
        code |= spread_bits((uint64_t)cell) << axis;
    }
    return code;
}

/* Order of content alone; equal for triangles that no ray can tell apart. */
static int compare_content(const order *self, uint32_t a, uint32_t b) {
    const uint32_t *corners_a = self->scene->triangles[a], *corners_b = self->scene->triangles[b];
    for (int part = 0; part < 2; part++) { /* all positions first, then all attributes */
        size_t begin = part ? GW_POSITION_WORDS : 0;
        size_t count = part ? GW_VERTEX_WORDS - GW_POSITION_WORDS : GW_POSITION_WORDS;
        for (int i = 0; i < 3; i++) {
            int result =
                compare_words(self->vertices + (size_t)corners_a[i] * GW_VERTEX_WORDS + begin,
                              self->vertices + (size_t)corners_b[i] * GW_VERTEX_WORDS + begin, count);
            if (result)
                return result;
        }
    }
    return compare_words(&self->material_rank[self->scene->material_of[a]],
                         &self->material_rank[self->scene->material_of[b]], 1);
}

static int compare_triangles(const void *a_entry, const void *b_entry, void *context) {
    const order *self = context;
    const uint32_t a = ((const gw_keyed *)a_entry)->value, b = ((const gw_keyed *)b_entry)->value;
    const int result = compare_content(self, a, b);
    return result ? result : compare_words(&self->scene->material_of[a], &self->scene->material_of[b], 1);
}

static int compare_materials(const void *a_index, const void *b_index, void *context) {
    const gw_scene *scene = context;
    const gw_material *a = &scene->materials[*(const uint32_t *)a_index];
    const gw_material *b = &scene->materials[*(const uint32_t *)b_index];
    size_t size = (size_t)((const char *)(a + 1) - (const char *)a->base_color);
    const int result = memcmp(a->base_color, b->base_color, size);
    if (result || !scene->extensions)
        return result;
    return memcmp(&scene->extensions[a - scene->materials], &scene->extensions[b - scene->materials],
                  sizeof *scene->extensions);
}

static gw_code rank_materials(order *self, gw_error *error) {
    const uint32_t count = self->scene->material_count;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, count, 2 * sizeof(uint32_t), "material ranks", error);
    if (code != GW_OK)
        return code;
    uint32_t *rank = memory, *sorted = rank + count;
    for (uint32_t i = 0; i < count; i++)
        sorted[i] = i;
    qsort_r(sorted, count, sizeof *sorted, compare_materials, (void *)(uintptr_t)self->scene);
    for (uint32_t i = 0; i < count; i++)
        rank[sorted[i]] =
            i && compare_materials(&sorted[i - 1], &sorted[i], (void *)(uintptr_t)self->scene) == 0
                ? rank[sorted[i - 1]]
                : i;
    self->material_rank = rank;
    return GW_OK;
}

/* The Morton order is done: equal codes are put into the order of their content. */
static void sort_equal_codes(gw_keyed *entries, size_t count, order *self) {
    for (size_t begin = 0; begin < count;) {
        size_t end = begin + 1;
        while (end < count && entries[end].key == entries[begin].key)
            end++;
        if (end - begin > 1)
            qsort_r(entries + begin, end - begin, sizeof *entries, compare_triangles, self);
        begin = end;
    }
}

/* Of surfaces through which one sees, two show more than one. */
static int lets_through(const gw_scene *scene, uint32_t material) {
    return scene->materials[material].alpha_mode == GW_ALPHA_BLEND ||
           (scene->extensions && scene->extensions[material].transmission > 0.0f);
}

/* Marks what equals the triangle before it. */
static void mark_duplicates(const order *self, const gw_keyed *entries, size_t count, uint8_t *marked) {
    for (size_t i = 1; i < count; i++)
        marked[i] = entries[i - 1].key == entries[i].key &&
                    compare_content(self, entries[i - 1].value, entries[i].value) == 0 &&
                    !lets_through(self->scene, self->scene->material_of[entries[i].value]);
}

/* Moves the scene's rows into the order of the entries. */
static gw_code permute(gw_scene *scene, const gw_keyed *entries, gw_error *error) {
    const size_t count = scene->triangle_count;
    void *triangles = NULL, *material_of = NULL;
    gw_code code = gw_allocate(&triangles, count, sizeof *scene->triangles, "sorted triangles", error);
    if (code == GW_OK)
        code =
            gw_allocate(&material_of, count, sizeof *scene->material_of, "sorted triangle materials", error);
    if (code != GW_OK) {
        free(triangles);
        return code;
    }
    for (size_t i = 0; i < count; i++) {
        memcpy((uint32_t(*)[3])triangles + i, scene->triangles[entries[i].value], sizeof *scene->triangles);
        ((uint32_t *)material_of)[i] = scene->material_of[entries[i].value];
    }
    free(scene->triangles);
    free(scene->material_of);
    scene->triangles = triangles;
    scene->material_of = material_of;
    return GW_OK;
}

gw_code gw_scene_order(gw_scene *scene, const uint32_t *vertices, uint8_t *marked, gw_error *error) {
    const size_t count = scene->triangle_count;
    order self = {.scene = scene, .vertices = vertices};
    gw_keyed *entries = NULL;
    gw_code code = rank_materials(&self, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&entries, count, sizeof *entries, "triangle order", error);
    for (size_t i = 0; code == GW_OK && i < count; i++) {
        rotate_triangle(scene->triangles[i], vertices);
        entries[i] = (gw_keyed){centroid_code(scene->triangles[i], vertices), (uint32_t)i};
    }
    if (code == GW_OK)
        code = gw_radix_sort(entries, count, error);
    if (code == GW_OK) {
        sort_equal_codes(entries, count, &self);
        mark_duplicates(&self, entries, count, marked);
        code = permute(scene, entries, error);
    }
    free(self.material_rank);
    free(entries);
    return code;
}
