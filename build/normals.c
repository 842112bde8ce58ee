/* Smooth shading normals with creases for meshes that bring none. */
#include "build/source_model.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "build/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sums are integers so that they do not depend on the order of triangles. */
static const double sum_scale = 0x1p30;
/* Round a vertex with more corners than this creases are not looked for: the search is quadratic. */
enum { CREASE_CORNERS = 1024 };

typedef struct smoother {
    gw_scene *scene;
    const double *world;
    double least_cosine;
    uint32_t position_count;
    uint32_t *position_of; /* [vertices] welded position */
    size_t *corner_begin;  /* [positions + 1] into corners */
    uint32_t *corners;     /* triangle * 3 + corner, grouped by position */
    float *face_normals;   /* [triangles][3] unit, zero for degenerate ones */
    float *corner_angles;  /* [triangles][3] rad */
    float *corner_normals; /* [triangles][3][3] */
    uint64_t crowded;      /* positions with more than CREASE_CORNERS corners */
} smoother;

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double normalize(double v[3]) {
    double length = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] = length > 0.0 ? v[i] / length : 0.0;
    return length;
}

/* Unit edges keep the products in range whatever the units are. */
static void measure_face(smoother *self, uint32_t triangle) {
    const double *p[3];
    double edges[3][3];
    for (int i = 0; i < 3; i++)
        p[i] = self->world + (size_t)self->scene->triangles[triangle][i] * 3;
    for (int i = 0; i < 3; i++) {
        subtract(p[(i + 1) % 3], p[i], edges[i]);
        if (!(normalize(edges[i]) > 0.0))
            return;
    }
    double normal[3] = {edges[0][1] * edges[1][2] - edges[0][2] * edges[1][1],
                        edges[0][2] * edges[1][0] - edges[0][0] * edges[1][2],
                        edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0]};
    double sine = normalize(normal);
    if (!isfinite(sine) || !(sine > 0.0))
        return;
    for (int i = 0; i < 3; i++) {
        self->face_normals[(size_t)triangle * 3 + (size_t)i] = (float)normal[i];
        self->corner_angles[(size_t)triangle * 3 + (size_t)i] =
            (float)gw_acos(-dot(edges[i], edges[(i + 2) % 3]));
    }
}

static int triangle_usable(const gw_scene *scene, uint32_t triangle) {
    for (int i = 0; i < 3; i++)
        if (scene->triangles[triangle][i] >= scene->vertex_count)
            return 0;
    return 1;
}

static gw_code weld_positions(smoother *self, gw_error *error) {
    const size_t count = self->scene->vertex_count;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, count, 3 * sizeof(double), "positions to weld", error);
    if (code != GW_OK)
        return code;
    double *positions = memory;
    for (size_t i = 0; i < count * 3; i++)
        positions[i] = self->world[i] + 0.0; /* -0 is 0 */
    code = gw_weld((const uint32_t *)memory, count, 6, self->position_of, &self->position_count, error);
    free(memory);
    return code;
}

/* Lists the corners of each position. */
static gw_code group_corners(smoother *self, gw_error *error) {
    const gw_scene *scene = self->scene;
    void *memory = NULL;
    gw_code code =
        gw_allocate(&memory, (size_t)self->position_count + 2, sizeof(size_t), "corner lists", error);
    if (code != GW_OK)
        return code;
    self->corner_begin = memory;
    size_t *next =
        self->corner_begin + 1; /* filled one ahead, so that after the second pass begin[i] is right */
    for (uint32_t t = 0; t < scene->triangle_count; t++)
        for (int i = 0; triangle_usable(scene, t) && i < 3; i++)
            next[self->position_of[scene->triangles[t][i]] + 1]++;
    for (uint32_t i = 0; i < self->position_count; i++)
        next[i + 1] += next[i];
    for (uint32_t t = 0; t < scene->triangle_count; t++)
        for (uint32_t i = 0; triangle_usable(scene, t) && i < 3; i++)
            self->corners[next[self->position_of[scene->triangles[t][i]]]++] = t * 3 + i;
    return GW_OK;
}

static void add_face(const smoother *self, uint32_t corner, int64_t sum[3]) {
    const float *normal = self->face_normals + (size_t)(corner / 3) * 3;
    for (int i = 0; i < 3; i++)
        sum[i] += (int64_t)floor((double)normal[i] * self->corner_angles[corner] * sum_scale + 0.5);
}

static void store_normal(smoother *self, uint32_t corner, const int64_t sum[3]) {
    double normal[3] = {(double)sum[0], (double)sum[1], (double)sum[2]};
    normalize(normal);
    for (int i = 0; i < 3; i++)
        self->corner_normals[(size_t)corner * 3 + (size_t)i] = (float)normal[i];
}

static int faces_meet_smoothly(const smoother *self, uint32_t a, uint32_t b) {
    const float *m = self->face_normals + (size_t)(a / 3) * 3, *n = self->face_normals + (size_t)(b / 3) * 3;
    return (double)m[0] * n[0] + (double)m[1] * n[1] + (double)m[2] * n[2] >= self->least_cosine;
}

static void smooth_position(smoother *self, uint32_t position) {
    const uint32_t *corners = self->corners + self->corner_begin[position];
    const size_t count = self->corner_begin[position + 1] - self->corner_begin[position];
    const int crowded = count > CREASE_CORNERS;
    int64_t all[3] = {0, 0, 0};
    for (size_t i = 0; crowded && i < count; i++)
        add_face(self, corners[i], all);
    self->crowded += (uint64_t)crowded;
    for (size_t i = 0; i < count; i++) {
        int64_t sum[3] = {all[0], all[1], all[2]};
        for (size_t k = 0; !crowded && k < count; k++)
            if (faces_meet_smoothly(self, corners[i], corners[k]))
                add_face(self, corners[k], sum);
        store_normal(self, corners[i], sum);
    }
}

/* The vertex of the corner takes its normal; a vertex that already has another one is split. Splits of one
 * vertex are chained through `sibling`, so that equal normals share one. */
typedef struct split_state {
    uint32_t *origin;  /* [capacity] file vertex that a vertex was copied from */
    uint32_t *sibling; /* [capacity] next copy of the same vertex, or the end mark */
    uint8_t *taken;    /* [capacity] */
    float *normals;    /* [capacity][3] */
    uint32_t count, capacity;
} split_state;

static const uint32_t chain_end = UINT32_MAX;

static uint32_t place_corner(split_state *state, uint32_t vertex, const float normal[3]) {
    uint32_t last = vertex;
    for (uint32_t v = vertex; v != chain_end; v = state->sibling[v]) {
        if (!state->taken[v]) {
            state->taken[v] = 1;
            memcpy(state->normals + (size_t)v * 3, normal, 3 * sizeof *normal);
        }
        if (memcmp(state->normals + (size_t)v * 3, normal, 3 * sizeof *normal) == 0)
            return v;
        last = v;
    }
    uint32_t copy = state->count++;
    state->sibling[last] = copy;
    state->sibling[copy] = chain_end;
    state->origin[copy] = state->origin[vertex];
    state->taken[copy] = 1;
    memcpy(state->normals + (size_t)copy * 3, normal, 3 * sizeof *normal);
    return copy;
}

/* Copies row origin[i] to row i for the split vertices. */
static gw_code extend(void *array_address, const split_state *state, uint32_t old_count, size_t row,
                      gw_error *error) {
    void **array = array_address;
    if (!*array || state->count == old_count)
        return GW_OK;
    void *longer = NULL;
    gw_code code = gw_allocate(&longer, state->count, row, "split vertices", error);
    if (code != GW_OK)
        return code;
    memcpy(longer, *array, old_count * row);
    for (uint32_t v = old_count; v < state->count; v++)
        memcpy((char *)longer + v * row, (char *)*array + state->origin[v] * row, row);
    free(*array);
    *array = longer;
    return GW_OK;
}

static gw_code assign_normals(smoother *self, gw_source_model *model, gw_error *error) {
    gw_scene *scene = self->scene;
    const uint64_t capacity = (uint64_t)scene->vertex_count + (uint64_t)scene->triangle_count * 3;
    split_state state = {.count = scene->vertex_count};
    if (capacity >= UINT32_MAX)
        return gw_fail(error, GW_BAD_INPUT, "the mesh is too large for smooth normals (%u triangles)",
                       scene->triangle_count);
    void *origin = NULL, *sibling = NULL, *taken = NULL, *normals = NULL;
    gw_code code = gw_allocate(&origin, capacity, sizeof(uint32_t), "smooth normals", error);
    if (code == GW_OK)
        code = gw_allocate(&sibling, capacity, sizeof(uint32_t), "smooth normals", error);
    if (code == GW_OK)
        code = gw_allocate(&taken, capacity, 1, "smooth normals", error);
    if (code == GW_OK)
        code = gw_allocate(&normals, capacity, 3 * sizeof(float), "smooth normals", error);
    if (code != GW_OK)
        goto cleanup;
    state = (split_state){origin, sibling, taken, normals, scene->vertex_count, (uint32_t)capacity};
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        state.origin[v] = v;
        state.sibling[v] = chain_end;
    }
    for (uint32_t t = 0; t < scene->triangle_count; t++) {
        const int usable = triangle_usable(scene, t); /* before its corners move to split vertices */
        for (uint32_t i = 0; usable && i < 3; i++)
            scene->triangles[t][i] =
                place_corner(&state, scene->triangles[t][i], self->corner_normals + ((size_t)t * 3 + i) * 3);
    }
    const uint32_t old_count = scene->vertex_count;
    code = extend(&model->world, &state, old_count, 3 * sizeof(double), error);
    if (code == GW_OK)
        code = extend(&scene->texcoords, &state, old_count, 2 * sizeof(float), error);
    if (code == GW_OK)
        code = extend(&scene->second_texcoords, &state, old_count, 2 * sizeof(float), error);
    if (code == GW_OK)
        code = extend(&scene->tangents, &state, old_count, sizeof *scene->tangents, error);
    if (code == GW_OK)
        code = extend(&scene->colors, &state, old_count, 4, error);
    if (code != GW_OK)
        goto cleanup;
    scene->vertex_count = state.count;
    free(scene->normals);
    scene->normals = normals;
    normals = NULL;
cleanup:
    free(origin);
    free(sibling);
    free(taken);
    free(normals);
    return code;
}

static gw_code allocate_smoother(smoother *self, gw_error *error) {
    const size_t vertices = self->scene->vertex_count, triangles = self->scene->triangle_count;
    const struct {
        void *address;
        size_t count, row;
    } arrays[] = {
        {&self->position_of, vertices, sizeof(uint32_t)},
        {&self->corners, triangles, 3 * sizeof(uint32_t)},
        {&self->face_normals, triangles, 3 * sizeof(float)},
        {&self->corner_angles, triangles, 3 * sizeof(float)},
        {&self->corner_normals, triangles, 9 * sizeof(float)},
    };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        gw_code code =
            gw_allocate(arrays[i].address, arrays[i].count, arrays[i].row, "smooth normals", error);
        if (code != GW_OK)
            return code;
    }
    return GW_OK;
}

gw_code gw_source_model_smooth_normals(gw_source_model *model, double crease_degrees, gw_error *error) {
    smoother self = {.scene = model->scene, .world = model->world};
    self.least_cosine = gw_cos(crease_degrees * GW_PI / 180.0);
    if (model->scene->triangle_count > UINT32_MAX / 3)
        return gw_fail(error, GW_BAD_INPUT, "the mesh is too large for smooth normals (%u triangles)",
                       model->scene->triangle_count);
    gw_code code = allocate_smoother(&self, error);
    if (code == GW_OK)
        code = weld_positions(&self, error);
    if (code == GW_OK)
        code = group_corners(&self, error);
    if (code != GW_OK)
        goto cleanup;
    for (uint32_t t = 0; t < model->scene->triangle_count; t++)
        if (triangle_usable(model->scene, t))
            measure_face(&self, t);
    for (uint32_t position = 0; position < self.position_count; position++)
        smooth_position(&self, position);
    code = assign_normals(&self, model, error);
    if (code == GW_OK && self.crowded)
        code = gw_scene_note(
            model->scene, error,
            "%llu vertices have more than %d corners: their normals are smoothed without creases",
            (unsigned long long)self.crowded, CREASE_CORNERS);
cleanup:
    free(self.position_of);
    free(self.corner_begin);
    free(self.corners);
    free(self.face_normals);
    free(self.corner_angles);
    free(self.corner_normals);
    return code;
}
