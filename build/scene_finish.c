/* From what a file said to a checked scene: checks, drops, rebasing, merging, canonical order, hash. */
#include "build/scene.h"

#include "base/memory.h"
#include "build/animation.h"
#include "build/exact.h"
#include "build/scene_duplicates.h"
#include "build/scene_motion.h"
#include "build/scene_order.h"
#include "build/scene_outliers.h"
#include "build/scene_pose.h"
#include "build/weld.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t unused = UINT32_MAX;
static const double least_half_side = 1e-290, greatest_half_side = 1e290; /* m */
static const uint32_t maximum_triangles = 0x7fffffff; /* a reference keeps one bit for itself */

/* Scratch of one gw_scene_finish; every row of `rows` is a vertex that some triangle uses. */
typedef struct finish {
    gw_scene *scene;
    const double *world;
    gw_scene_motion motion; /* empty unless the scene is animated */
    uint32_t *vertex_of;    /* [row_count] file vertex of a row; NULL unless the scene is animated */
    uint32_t *row_of;       /* [file vertices] row, or `unused` */
    uint32_t *rows;         /* [row_count][GW_VERTEX_WORDS] */
    uint32_t row_count;
    uint64_t bad_normals, bad_texcoords;
} finish;

static int all_finite(const float *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return 0;
    return 1;
}

static gw_code check_materials(const gw_scene *scene, gw_error *error) {
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const gw_material *material = &scene->materials[i];
        if (!all_finite(material->base_color, 4) || !all_finite(material->emissive, 3) ||
            !all_finite(&material->metalness, 1) || !all_finite(&material->roughness, 1) ||
            !all_finite(&material->alpha_cutoff, 1))
            return gw_fail(error, GW_BAD_INPUT, "material %u ('%s') has a value that is not a finite number",
                           i, material->name);
        if (material->base_color_texture < -1 ||
            material->base_color_texture >= (int64_t)scene->texture_count)
            return gw_fail(error, GW_BAD_INPUT,
                           "material %u ('%s') names texture %d, but there are %u textures", i,
                           material->name, material->base_color_texture, scene->texture_count);
        const char *fault = scene->extensions ? gw_material_extension_fault(scene, i) : NULL;
        if (fault)
            return gw_fail(error, GW_BAD_INPUT, "material %u ('%s') has %s", i, material->name, fault);
    }
    return GW_OK;
}

static gw_code check_counts(const gw_scene *scene, gw_error *error) {
    if (scene->triangle_count > maximum_triangles)
        return gw_fail(error, GW_BAD_INPUT, "%u triangles are more than the %u that a scene can hold",
                       scene->triangle_count, maximum_triangles);
    return check_materials(scene, error);
}

typedef enum fate { KEEP, BAD_INDEX, NON_FINITE, REPEATED_VERTEX, ZERO_AREA } fate;

static int same_point(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static fate judge(const finish *self, const uint32_t corners[3], uint32_t material) {
    if (material >= self->scene->material_count)
        return BAD_INDEX;
    for (int i = 0; i < 3; i++)
        if (corners[i] >= self->scene->vertex_count)
            return BAD_INDEX;
    const double *p[3];
    for (int i = 0; i < 3; i++) {
        p[i] = self->world + (size_t)corners[i] * 3;
        if (!isfinite(p[i][0]) || !isfinite(p[i][1]) || !isfinite(p[i][2]))
            return NON_FINITE;
        if (self->scene->animation) /* no area now may be some at another time: the shape at rest decides */
            p[i] = self->scene->animation->bind_positions + (size_t)corners[i] * 3;
    }
    if (same_point(p[0], p[1]) || same_point(p[1], p[2]) || same_point(p[2], p[0]))
        return REPEATED_VERTEX;
    return gw_collinear(p[0], p[1], p[2]) ? ZERO_AREA : KEEP;
}

static void keep_triangle(gw_scene *scene, uint32_t to, uint32_t from) {
    memmove(scene->triangles[to], scene->triangles[from], sizeof *scene->triangles);
    scene->material_of[to] = scene->material_of[from];
}

static void drop_bad_triangles(finish *self) {
    gw_scene *scene = self->scene;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < scene->triangle_count; i++) {
        switch (judge(self, scene->triangles[i], scene->material_of[i])) {
        case KEEP:
            keep_triangle(scene, kept++, i);
            break;
        case BAD_INDEX:
            scene->dropped.bad_index++;
            break;
        case NON_FINITE:
            scene->dropped.non_finite++;
            break;
        case REPEATED_VERTEX:
            scene->dropped.repeated_vertex++;
            break;
        case ZERO_AREA:
            scene->dropped.zero_area++;
            break;
        }
    }
    scene->triangle_count = kept;
}

static gw_code fail_if_nothing_left(const gw_scene *scene, gw_error *error) {
    char list[400] = "it has no triangles at all";
    int length = 0;
    if (scene->triangle_count > 0)
        return GW_OK;
    for (size_t i = 0; i < gw_dropped_row_count; i++) {
        const uint64_t count = gw_dropped_by(&scene->dropped, &gw_dropped_rows[i]);
        if (count)
            length +=
                snprintf(list + length, sizeof list - (size_t)length, "%s%llu %s",
                         length ? ", " : "dropped: ", (unsigned long long)count, gw_dropped_rows[i].words);
    }
    return gw_fail(error, GW_BAD_INPUT, "nothing is left to draw (%s)", list);
}

/* Numbers the vertices that kept triangles use. */
static gw_code mark_rows(finish *self, gw_error *error) {
    const gw_scene *scene = self->scene;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, scene->vertex_count, sizeof(uint32_t), "vertex rows", error);
    if (code != GW_OK)
        return code;
    self->row_of = memory;
    memset(self->row_of, 0xff, scene->vertex_count * sizeof(uint32_t));
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            if (self->row_of[scene->triangles[i][k]] == unused)
                self->row_of[scene->triangles[i][k]] = self->row_count++;
    if (scene->animation) {
        code =
            gw_allocate((void **)&self->vertex_of, self->row_count, sizeof(uint32_t), "vertex rows", error);
        for (uint32_t v = 0; code == GW_OK && v < scene->vertex_count; v++)
            if (self->row_of[v] != unused)
                self->vertex_of[self->row_of[v]] = v;
        if (code != GW_OK)
            return code;
    }
    code = gw_allocate(&memory, self->row_count, GW_VERTEX_WORDS * sizeof(uint32_t), "vertices", error);
    if (code == GW_OK)
        self->rows = memory;
    return code;
}

static void measure_bounds(finish *self) {
    gw_scene *scene = self->scene;
    for (int axis = 0; axis < 3; axis++) {
        scene->bounds[0][axis] = DBL_MAX;
        scene->bounds[1][axis] = -DBL_MAX;
    }
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        if (self->row_of[v] == unused)
            continue;
        for (int axis = 0; axis < 3; axis++) {
            double value = self->world[(size_t)v * 3 + (size_t)axis] + 0.0; /* +0.0: no negative zero */
            scene->bounds[0][axis] = value < scene->bounds[0][axis] ? value : scene->bounds[0][axis];
            scene->bounds[1][axis] = value > scene->bounds[1][axis] ? value : scene->bounds[1][axis];
        }
    }
}

/* Bounds, centre and exponent. Halves are taken before differences so that nothing overflows. */
static gw_code measure(finish *self, gw_error *error) {
    gw_scene *scene = self->scene;
    if (scene->animation) {
        gw_code code = gw_scene_motion_measure(scene, self->row_of, &self->motion, error);
        if (code != GW_OK)
            return code;
        memcpy(scene->bounds, self->motion.bounds, sizeof scene->bounds);
    } else {
        measure_bounds(self);
    }
    double half_side = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double low = scene->bounds[0][axis], high = scene->bounds[1][axis];
        scene->centre[axis] = 0.5 * low + 0.5 * high;
        half_side = fmax(half_side, 0.5 * high - 0.5 * low);
    }
    if (half_side < least_half_side || half_side > greatest_half_side)
        return gw_fail(error, GW_BAD_INPUT,
                       "the scene is %.3g m across, beyond what numbers can hold: check its units",
                       2.0 * half_side);
    scene->exponent = ilogb(half_side) + 1;
    return GW_OK;
}

static uint32_t float_word(float value) {
    uint32_t word;
    value += 0.0f; /* -0 becomes +0 */
    memcpy(&word, &value, sizeof word);
    return word;
}

static void clean_normal(finish *self, const float *normal, uint32_t words[3]) {
    float clean[3];
    const int given = normal[0] != 0.0f || normal[1] != 0.0f || normal[2] != 0.0f;
    if (!gw_scene_clean_normal(normal, clean) && given)
        self->bad_normals++;
    memcpy(words, clean, sizeof clean);
}

static void fill_texcoord(finish *self, const float *texcoords, size_t vertex, uint32_t words[2]) {
    if (!texcoords)
        return;
    const int usable = all_finite(texcoords + vertex * 2, 2);
    self->bad_texcoords += !usable;
    for (size_t i = 0; i < 2; i++)
        words[i] = usable ? float_word(texcoords[vertex * 2 + i]) : 0;
}

static void fill_row(finish *self, uint32_t vertex, uint32_t *row) {
    const gw_scene *scene = self->scene;
    const size_t v = vertex;
    float position[3];
    /* Far from the origin the rounding of the centre alone can lead outside [-1,1]: held there. */
    gw_scene_rebase_point(scene, self->world + v * 3, position);
    memcpy(row, position, sizeof position);
    if (scene->normals)
        clean_normal(self, scene->normals + v * 3, row + 3);
    fill_texcoord(self, scene->texcoords, v, row + 6);
    fill_texcoord(self, scene->second_texcoords, v, row + 10);
    if (scene->colors)
        memcpy(row + 8, scene->colors + v * 4, 4);
    if (scene->tangents)
        row[12] = scene->tangents[v];
    if (scene->animation)
        row[9] = self->motion.content_of[v];
}

static void rebase(finish *self) {
    gw_scene *scene = self->scene;
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        if (self->row_of[v] != unused)
            fill_row(self, v, self->rows + (size_t)self->row_of[v] * GW_VERTEX_WORDS);
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            scene->triangles[i][k] = self->row_of[scene->triangles[i][k]];
}

/* Whether a triangle of rows has a corner that moves. */
static int moves(const finish *self, const uint32_t rows[3]) {
    const gw_animation *animation = self->scene->animation;
    for (int k = 0; animation && k < 3; k++)
        if (animation->bindings[animation->binding_of[self->vertex_of[rows[k]]]].count > 0)
            return 1;
    return 0;
}

static void drop_collapsed(finish *self) {
    gw_scene *scene = self->scene;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < scene->triangle_count; i++) {
        double p[3][3];
        if (moves(self, scene->triangles[i])) {
            keep_triangle(scene, kept++, i);
            continue;
        }
        for (int k = 0; k < 3; k++) {
            float position[3];
            memcpy(position, self->rows + (size_t)scene->triangles[i][k] * GW_VERTEX_WORDS, sizeof position);
            for (int axis = 0; axis < 3; axis++)
                p[k][axis] = position[axis];
        }
        if (gw_collinear(p[0], p[1], p[2]))
            scene->dropped.collapsed++;
        else
            keep_triangle(scene, kept++, i);
    }
    scene->triangle_count = kept;
}

/* Vertices that are equal in every word become one row; triangles follow. */
static gw_code merge_rows(finish *self, gw_error *error) {
    gw_scene *scene = self->scene;
    uint32_t *ids = self->row_of; /* no longer needed, and at least as long as the rows */
    uint32_t unique = 0;
    gw_code code = gw_weld(self->rows, self->row_count, GW_VERTEX_WORDS, ids, &unique, error);
    if (code != GW_OK)
        return code;
    for (uint32_t row = 0; row < self->row_count;
         row++) { /* ids never exceed their row: moving down is safe */
        memmove(self->rows + (size_t)ids[row] * GW_VERTEX_WORDS, self->rows + (size_t)row * GW_VERTEX_WORDS,
                GW_VERTEX_WORDS * sizeof(uint32_t));
        if (self->vertex_of)
            self->vertex_of[ids[row]] = self->vertex_of[row];
    }
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            scene->triangles[i][k] = ids[scene->triangles[i][k]];
    self->row_count = unique;
    return GW_OK;
}

/* Numbers rows in order of first use by the sorted triangles; returns how many are used. */
static uint32_t number_by_first_use(finish *self) {
    gw_scene *scene = self->scene;
    uint32_t *number = self->row_of, next = 0;
    memset(number, 0xff, self->row_count * sizeof *number);
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t *corner = &scene->triangles[i][k];
            if (number[*corner] == unused)
                number[*corner] = next++;
            *corner = number[*corner];
        }
    return next;
}

typedef struct vertex_arrays {
    float *positions, *normals, *texcoords, *second_texcoords;
    uint8_t *colors;
    uint32_t *tangents, *welded;
} vertex_arrays;

static gw_code allocate_arrays(vertex_arrays *arrays, const gw_scene *scene, size_t count, gw_error *error) {
    gw_code code =
        gw_allocate((void **)&arrays->positions, count, 3 * sizeof(float), "vertex positions", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&arrays->normals, count, 3 * sizeof(float), "vertex normals", error);
    if (code == GW_OK)
        code =
            gw_allocate((void **)&arrays->texcoords, count, 2 * sizeof(float), "texture coordinates", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&arrays->welded, count, sizeof(uint32_t), "welded vertices", error);
    if (code == GW_OK && scene->second_texcoords)
        code = gw_allocate((void **)&arrays->second_texcoords, count, 2 * sizeof(float),
                           "texture coordinates", error);
    if (code == GW_OK && scene->tangents)
        code = gw_allocate((void **)&arrays->tangents, count, sizeof *arrays->tangents, "tangents", error);
    if (code == GW_OK && scene->colors)
        code = gw_allocate((void **)&arrays->colors, count, 4, "vertex colours", error);
    return code;
}

static void adopt_arrays(gw_scene *scene, const vertex_arrays *arrays) {
    free(scene->positions);
    free(scene->normals);
    free(scene->texcoords);
    free(scene->second_texcoords);
    free(scene->tangents);
    free(scene->colors);
    free(scene->welded);
    scene->positions = arrays->positions;
    scene->normals = arrays->normals;
    scene->texcoords = arrays->texcoords;
    scene->second_texcoords = arrays->second_texcoords;
    scene->tangents = arrays->tangents;
    scene->colors = arrays->colors;
    scene->welded = arrays->welded;
}

/* In an animated scene those vertices are one that stay together, and the animation takes the order of the
 * vertices. */
static gw_code weld_motions(finish *self, uint32_t count, gw_error *error) {
    enum { WORDS = GW_POSITION_WORDS + 1 };
    gw_scene *scene = self->scene;
    uint32_t *source_of = NULL, *words = NULL;
    gw_code code = gw_allocate((void **)&source_of, count, sizeof *source_of, "animated vertices", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&words, count, WORDS * sizeof *words, "animated vertices", error);
    for (uint32_t row = 0; code == GW_OK && row < self->row_count; row++) {
        const size_t v = self->row_of[row];
        if (self->row_of[row] == unused)
            continue;
        source_of[v] = self->vertex_of[row];
        memcpy(words + v * WORDS, scene->positions + v * 3, GW_POSITION_WORDS * sizeof *words);
        words[v * WORDS + GW_POSITION_WORDS] =
            self->motion.motion_of[self->rows[(size_t)row * GW_VERTEX_WORDS + 9]];
    }
    if (code == GW_OK)
        code = gw_weld(words, count, WORDS, scene->welded, &scene->welded_count, error);
    if (code == GW_OK)
        code = gw_scene_motion_select(scene, source_of, count, error);
    free(source_of);
    free(words);
    return code;
}

static gw_code write_vertices(finish *self, gw_error *error) {
    gw_scene *scene = self->scene;
    const uint32_t count = number_by_first_use(self);
    vertex_arrays arrays = {0};
    gw_code code = allocate_arrays(&arrays, scene, count, error);
    adopt_arrays(scene, &arrays); /* also after a failure: the scene stays destroyable */
    scene->vertex_count = code == GW_OK ? count : 0;
    if (code != GW_OK)
        return code;
    for (uint32_t row = 0; row < self->row_count; row++) {
        const uint32_t *words = self->rows + (size_t)row * GW_VERTEX_WORDS;
        const size_t v = self->row_of[row];
        if (self->row_of[row] == unused)
            continue;
        memcpy(scene->positions + v * 3, words, 3 * sizeof(float));
        memcpy(scene->normals + v * 3, words + 3, 3 * sizeof(float));
        memcpy(scene->texcoords + v * 2, words + 6, 2 * sizeof(float));
        if (scene->second_texcoords)
            memcpy(scene->second_texcoords + v * 2, words + 10, 2 * sizeof(float));
        if (scene->tangents)
            scene->tangents[v] = words[12];
        if (scene->colors)
            memcpy(scene->colors + v * 4, words + 8, 4);
    }
    return scene->animation ? weld_motions(self, count, error)
                            : gw_weld((const uint32_t *)(const void *)scene->positions, count,
                                      GW_POSITION_WORDS, scene->welded, &scene->welded_count, error);
}

static gw_code note_repairs(const finish *self, gw_error *error) {
    gw_code code = GW_OK;
    if (self->bad_normals)
        code = gw_scene_note(self->scene, error,
                             "%llu normals were zero-length or not finite: the triangle's own is used there",
                             (unsigned long long)self->bad_normals);
    if (code == GW_OK && self->bad_texcoords)
        code = gw_scene_note(self->scene, error, "%llu texture coordinates were not finite: 0 is used there",
                             (unsigned long long)self->bad_texcoords);
    return code;
}

static gw_code order(const finish *self, gw_error *error) {
    uint8_t *marked = NULL;
    gw_code code = gw_allocate((void **)&marked, self->scene->triangle_count, 1, "duplicates", error);
    if (code == GW_OK)
        code = gw_scene_order(self->scene, self->rows, marked, error);
    if (code == GW_OK)
        code = gw_scene_drop_duplicates(self->scene, self->rows, self->row_count, marked, error);
    free(marked);
    return code;
}

gw_code gw_scene_finish(gw_scene *scene, const double *world, gw_error *error) {
    finish self = {.scene = scene, .world = world};
    gw_code code = check_counts(scene, error);
    if (code == GW_OK && scene->animation)
        code = gw_scene_motion_init(scene, &self.motion, error);
    if (code != GW_OK)
        return code;
    if (scene->animation)
        self.world = self.motion.world;
    drop_bad_triangles(&self);
    code = fail_if_nothing_left(scene, error);
    if (code == GW_OK)
        code = gw_scene_drop_outliers(scene, self.world, error);
    if (code == GW_OK)
        code = mark_rows(&self, error);
    if (code == GW_OK)
        code = measure(&self, error);
    if (code != GW_OK)
        goto cleanup;
    rebase(&self);
    drop_collapsed(&self);
    code = fail_if_nothing_left(scene, error);
    if (code == GW_OK)
        code = merge_rows(&self, error);
    if (code == GW_OK)
        code = order(&self, error);
    if (code == GW_OK)
        code = write_vertices(&self, error);
    if (code == GW_OK)
        code = note_repairs(&self, error);
    if (code == GW_OK)
        gw_scene_rehash(scene);
cleanup:
    gw_scene_motion_finish(&self.motion);
    free(self.vertex_of);
    free(self.row_of);
    free(self.rows);
    return code;
}
