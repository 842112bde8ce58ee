#include "build/scene_motion.h"

#include "base/memory.h"
#include "build/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The scene is looked at so many times over each clip's length, fewer where vertices are many; between those
 * it may reach further by a part of its longest side. */
enum { MOST_LOOKS = 128, LEAST_LOOKS = 16, LOOKED_VERTICES = 1 << 25 };
static const double margin = 1.0 / 32.0;

/* A vertex as the words that decide what it is at any time: bind position, binding, bind normal. */
enum { CONTENT_WORDS = 10, MOTION_WORDS = 7, BINDING_WORDS = sizeof(gw_binding) / sizeof(uint32_t) };

void gw_scene_motion_finish(gw_scene_motion *motion) {
    free(motion->world);
    free(motion->content_of);
    free(motion->motion_of);
    *motion = (gw_scene_motion){0};
}

/* --- what moves alike --- */

typedef struct rows {
    const uint32_t *words;
    size_t width;
} rows;

static int compare_rows(const void *a_index, const void *b_index, void *context) {
    const rows *self = context;
    const uint32_t *a = self->words + *(const uint32_t *)a_index * self->width,
                   *b = self->words + *(const uint32_t *)b_index * self->width;
    for (size_t i = 0; i < self->width; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

/* number_of[i]: the place of row i's content among all contents, sorted. *first_of (free it): a row for each.
 */
static gw_code number_rows(const uint32_t *words, uint32_t count, size_t width, uint32_t *number_of,
                           uint32_t **first_of, uint32_t *unique, gw_error *error) {
    rows self = {words, width};
    uint32_t *first = NULL, *place = NULL;
    gw_code code = gw_weld(words, count, width, number_of, unique, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&first, *unique, sizeof *first, "contents of vertices", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&place, count, sizeof *place, "contents of vertices", error);
    if (code != GW_OK) {
        free(first);
        return code;
    }
    for (uint32_t i = count; i-- > 0;)
        first[number_of[i]] = i;
    qsort_r(first, *unique, sizeof *first, compare_rows, &self);
    for (uint32_t i = 0; i < *unique; i++)
        place[number_of[first[i]]] = i; /* gw_weld's number to the sorted one */
    for (uint32_t i = 0; i < count; i++)
        number_of[i] = place[number_of[i]];
    free(place);
    *first_of = first;
    return GW_OK;
}

static void fill_content(const gw_animation *animation, uint32_t vertex, uint32_t *words) {
    const size_t v = vertex;
    for (size_t i = 0; i < 3; i++) {
        const double position = animation->bind_positions[v * 3 + i] + 0.0; /* no negative zero */
        const float normal = animation->bind_normals[v * 3 + i] + 0.0f;
        memcpy(words + i * 2, &position, sizeof position);
        memcpy(words + MOTION_WORDS + i, &normal, sizeof normal);
    }
    words[MOTION_WORDS - 1] = animation->binding_of[v];
}

/* Contents that differ in their last words alone, the normal, move alike and stand side by side. */
static gw_code number_motions(const uint32_t *words, const uint32_t *first_of, gw_scene_motion *motion,
                              gw_error *error) {
    gw_code code = gw_allocate((void **)&motion->motion_of, motion->content_count, sizeof *motion->motion_of,
                               "motions of vertices", error);
    for (uint32_t i = 1; code == GW_OK && i < motion->content_count; i++)
        motion->motion_of[i] =
            motion->motion_of[i - 1] +
            (memcmp(words + (size_t)first_of[i] * CONTENT_WORDS,
                    words + (size_t)first_of[i - 1] * CONTENT_WORDS, MOTION_WORDS * sizeof *words) != 0);
    return code;
}

/* Equal bindings become one, and they stand in an order of content: the one without joints first. */
static gw_code order_bindings(gw_animation *animation, gw_error *error) {
    uint32_t *number_of = NULL, *first_of = NULL, unique = 0;
    gw_binding *sorted = NULL;
    gw_code code =
        gw_allocate((void **)&number_of, animation->binding_count, sizeof *number_of, "bindings", error);
    if (code == GW_OK)
        code = number_rows((const uint32_t *)(const void *)animation->bindings, animation->binding_count,
                           BINDING_WORDS, number_of, &first_of, &unique, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&sorted, unique, sizeof *sorted, "bindings", error);
    for (uint32_t i = 0; code == GW_OK && i < unique; i++)
        sorted[i] = animation->bindings[first_of[i]];
    for (uint32_t v = 0; code == GW_OK && v < animation->vertex_count; v++)
        animation->binding_of[v] = number_of[animation->binding_of[v]];
    if (code == GW_OK) {
        free(animation->bindings);
        animation->bindings = sorted;
        animation->binding_count = unique;
    }
    free(number_of);
    free(first_of);
    return code;
}

static gw_code number_contents(const gw_animation *animation, gw_scene_motion *motion, gw_error *error) {
    uint32_t *words = NULL, *first_of = NULL;
    gw_code code = gw_allocate((void **)&words, animation->vertex_count, CONTENT_WORDS * sizeof *words,
                               "contents of vertices", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&motion->content_of, animation->vertex_count, sizeof *motion->content_of,
                           "contents of vertices", error);
    for (uint32_t v = 0; code == GW_OK && v < animation->vertex_count; v++)
        fill_content(animation, v, words + (size_t)v * CONTENT_WORDS);
    if (code == GW_OK)
        code = number_rows(words, animation->vertex_count, CONTENT_WORDS, motion->content_of, &first_of,
                           &motion->content_count, error);
    if (code == GW_OK)
        code = number_motions(words, first_of, motion, error);
    free(words);
    free(first_of);
    return code;
}

/* --- where it is --- */

static gw_code take_first_pose(gw_scene *scene, gw_scene_motion *motion, gw_error *error) {
    gw_pose pose;
    gw_code code = gw_pose_init(scene->animation, &pose, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&motion->world, scene->vertex_count, 3 * sizeof(double), "posed vertices",
                           error);
    if (code == GW_OK) {
        gw_pose_at_time(scene->animation, 0, &pose);
        gw_pose_vertices(scene->animation, &pose, motion->world, scene->normals);
    }
    gw_pose_finish(&pose);
    return code;
}

gw_code gw_scene_motion_init(gw_scene *scene, gw_scene_motion *motion, gw_error *error) {
    *motion = (gw_scene_motion){0};
    if (scene->animation->vertex_count != scene->vertex_count)
        return gw_fail(error, GW_BAD_INPUT, "the animation is of %u vertices, the scene has %u",
                       scene->animation->vertex_count, scene->vertex_count);
    gw_code code = gw_animation_check(scene->animation, error);
    if (code == GW_OK)
        code = take_first_pose(scene, motion, error);
    if (code == GW_OK)
        code = order_bindings(scene->animation, error);
    if (code == GW_OK)
        code = number_contents(scene->animation, motion, error);
    if (code != GW_OK)
        gw_scene_motion_finish(motion);
    return code;
}

static void widen(double bounds[2][3], const double point[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (isfinite(point[axis])) {
            bounds[0][axis] = fmin(bounds[0][axis], point[axis]);
            bounds[1][axis] = fmax(bounds[1][axis], point[axis]);
        }
}

gw_code gw_scene_motion_measure(const gw_scene *scene, const uint32_t *used, gw_scene_motion *motion,
                                gw_error *error) {
    const gw_animation *animation = scene->animation;
    double *world = NULL;
    gw_pose pose;
    int looks =
        scene->vertex_count > 0 ? LOOKED_VERTICES / (int)fmin(scene->vertex_count, LOOKED_VERTICES) : 0;
    looks = looks < LEAST_LOOKS ? LEAST_LOOKS : looks > MOST_LOOKS ? MOST_LOOKS : looks;
    gw_code code = gw_pose_init(animation, &pose, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&world, scene->vertex_count, 3 * sizeof *world, "posed vertices", error);
    for (int axis = 0; axis < 3; axis++) {
        motion->bounds[0][axis] = HUGE_VAL;
        motion->bounds[1][axis] = -HUGE_VAL;
    }
    for (int look = 0; code == GW_OK && look <= looks; look++) {
        gw_pose_at_phase(animation, (double)look / looks, &pose);
        gw_pose_vertices(animation, &pose, world, NULL);
        for (size_t v = 0; v < scene->vertex_count; v++)
            if (used[v] != UINT32_MAX)
                widen(motion->bounds, world + v * 3);
    }
    double side = 0.0;
    for (int axis = 0; axis < 3; axis++)
        side = fmax(side, motion->bounds[1][axis] - motion->bounds[0][axis]);
    for (int axis = 0; axis < 3; axis++) {
        motion->bounds[0][axis] -= margin * side;
        motion->bounds[1][axis] += margin * side;
    }
    free(world);
    gw_pose_finish(&pose);
    return code;
}

/* --- the finished order --- */

static gw_code select_rows(void *array_address, const uint32_t *source_of, uint32_t count, size_t row,
                           gw_error *error) {
    char **array = array_address, *selected = NULL;
    gw_code code = gw_allocate((void **)&selected, count, row, "animated vertices", error);
    if (code != GW_OK)
        return code;
    for (size_t v = 0; v < count; v++)
        memcpy(selected + v * row, *array + source_of[v] * row, row);
    free(*array);
    *array = selected;
    return GW_OK;
}

gw_code gw_scene_motion_select(gw_scene *scene, const uint32_t *source_of, uint32_t count, gw_error *error) {
    gw_animation *animation = scene->animation;
    gw_code code =
        select_rows(&animation->binding_of, source_of, count, sizeof *animation->binding_of, error);
    if (code == GW_OK)
        code = select_rows(&animation->bind_positions, source_of, count, 3 * sizeof(double), error);
    if (code == GW_OK)
        code = select_rows(&animation->bind_normals, source_of, count, 3 * sizeof(float), error);
    if (code == GW_OK)
        animation->vertex_count = count;
    return code;
}
