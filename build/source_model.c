#include "build/source_model.h"

#include "base/memory.h"
#include "build/animation.h"
#include "build/matrix.h"
#include "build/tangent.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

gw_code gw_source_model_create(gw_source_model **out, gw_error *error) {
    *out = NULL;
    void *model = NULL, *scene = NULL;
    gw_code code = gw_allocate(&model, 1, sizeof(gw_source_model), "model", error);
    if (code == GW_OK)
        code = gw_allocate(&scene, 1, sizeof(gw_scene), "scene", error);
    if (code != GW_OK) {
        free(model);
        return code;
    }
    ((gw_source_model *)model)->scene = scene;
    *out = model;
    return GW_OK;
}

gw_material_source gw_material_source_none(void) {
    gw_material_source none = {.file_index = -1, .specular = {-1, -1, -1, -1}};
    for (int i = 0; i < GW_MAP_COUNT; i++)
        none.maps[i] = -1;
    return none;
}

float gw_roughness_of_exponent(double exponent) {
    return (float)sqrt(sqrt(2.0 / (fmax(exponent, 0.0) + 2.0)));
}

void gw_source_model_drop_sources(gw_source_model *model) {
    for (uint32_t i = 0; model->sources && i < model->source_count; i++) {
        free(model->sources[i].path);
        free(model->sources[i].alpha_path);
        free(model->sources[i].bytes);
    }
    free(model->sources);
    free(model->material_sources);
    model->sources = NULL;
    model->material_sources = NULL;
    model->source_count = 0;
}

void gw_source_model_destroy(gw_source_model **model_address) {
    if (!model_address || !*model_address)
        return;
    gw_source_model *model = *model_address;
    gw_source_model_drop_sources(model);
    gw_scene_destroy(&model->scene);
    free(model->world);
    free(model->spans);
    free(model);
    *model_address = NULL;
}

static void transform_normals(gw_scene *scene, const double m[3][4]) {
    double cofactors[3][3];
    gw_matrix_cofactors(m, cofactors);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        float *normal = scene->normals + (size_t)v * 3;
        gw_matrix_normal((const double(*)[3])cofactors, normal, normal);
    }
}

static void transform_direction(const double m[3][4], double direction[3]) {
    double turned[3], length = 0.0;
    for (int i = 0; i < 3; i++) {
        turned[i] = m[i][0] * direction[0] + m[i][1] * direction[1] + m[i][2] * direction[2];
        length += turned[i] * turned[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 3 && length > 0.0; i++)
        direction[i] = turned[i] / length;
}

static void transform_vector(const double m[3][4], float vector[3]) {
    const double v[3] = {vector[0], vector[1], vector[2]};
    for (int i = 0; i < 3; i++)
        vector[i] = (float)(m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2]);
}

static void transform_axis(const double m[3][4], float axis[3]) {
    double direction[3] = {axis[0], axis[1], axis[2]};
    transform_direction(m, direction);
    for (int i = 0; i < 3; i++)
        axis[i] = (float)direction[i];
}

/* A point light is an irradiance at one metre: it grows with the square of the scale, so that a model keeps
 * its looks. */
static void transform_lights(gw_scene *scene, const double m[3][4], double scale) {
    for (uint32_t i = 0; i < scene->light_count; i++) {
        gw_light *light = &scene->lights[i];
        if (light->kind == GW_LIGHT_DIRECTIONAL) {
            transform_direction(m, light->vector);
            continue;
        }
        gw_matrix_point(m, light->vector, light->vector);
        for (int k = 0; k < 3; k++)
            light->color[k] = (float)(light->color[k] * scale * scale);
        light->range = (float)(light->range * scale);
        light->extent = (float)(light->extent * scale);
        transform_vector(m, light->sides[0]);
        transform_vector(m, light->sides[1]);
        if (light->kind == GW_LIGHT_SPOT)
            transform_axis(m, light->axis);
    }
}

static void transform_volumes(gw_scene *scene, double scale) {
    for (uint32_t i = 0; scene->extensions && i < scene->material_count; i++) {
        gw_material_extension *e = &scene->extensions[i];
        e->thickness = (float)fmin(e->thickness * scale, 1e30);
        e->attenuation_distance = (float)fmin(e->attenuation_distance * scale, 1e30);
    }
}

gw_code gw_source_model_transform(gw_source_model *model, const double m[3][4], gw_error *error) {
    gw_scene *scene = model->scene;
    const double volume = gw_matrix_determinant(m);
    if (!isfinite(volume) || volume == 0.0)
        return gw_fail(error, GW_BAD_INPUT, "the matrix flattens the model: its determinant is %g", volume);
    if (scene->animation) {
        gw_code code = gw_animation_transform(scene->animation, m, error);
        if (code != GW_OK)
            return code;
    }
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        gw_matrix_point(m, model->world + (size_t)v * 3, model->world + (size_t)v * 3);
    if (scene->normals)
        transform_normals(scene, m);
    for (uint32_t v = 0; scene->tangents && v < scene->vertex_count; v++)
        scene->tangents[v] = gw_tangent_transform(m, scene->tangents[v]);
    if (volume < 0.0)
        for (uint32_t i = 0; i < scene->triangle_count; i++) {
            uint32_t swap = scene->triangles[i][1];
            scene->triangles[i][1] = scene->triangles[i][2];
            scene->triangles[i][2] = swap;
        }
    transform_lights(scene, m, cbrt(fabs(volume)));
    transform_volumes(scene, cbrt(fabs(volume)));
    for (uint32_t i = 0; i < scene->viewpoint_count; i++) {
        gw_matrix_point(m, scene->viewpoints[i].eye, scene->viewpoints[i].eye);
        gw_matrix_point(m, scene->viewpoints[i].look_at, scene->viewpoints[i].look_at);
        transform_direction(m, scene->viewpoints[i].up);
    }
    return GW_OK;
}

/* Makes *target hold first + second rows; either may be NULL with `fill` bytes standing for missing rows. */
static gw_code join(void *target_address, size_t first, void *part, size_t second, size_t row, int fill,
                    gw_error *error) {
    void **target = target_address;
    if (!*target && !part)
        return GW_OK;
    void *joined = NULL;
    gw_code code = gw_allocate(&joined, first + second, row, "merged models", error);
    if (code != GW_OK || first + second == 0)
        return code;
    if (*target)
        memcpy(joined, *target, first * row);
    else
        memset(joined, fill, first * row);
    if (part)
        memcpy((char *)joined + first * row, part, second * row);
    else
        memset((char *)joined + first * row, fill, second * row);
    free(*target);
    *target = joined;
    return GW_OK;
}

/* The arrays alone; the counts are the caller's. Owned pointers inside the rows are copied: one side forgets
 * them. */
static gw_code join_arrays(gw_source_model *target, gw_source_model *part, gw_error *error) {
    gw_scene *a = target->scene, *b = part->scene;
    enum { NOTHING = 0, WHITE = 255 };
    const struct {
        void *target, *part; /* addresses of the array pointers */
        size_t first, second, row;
        int fill;
    } rows[] = {
        {&target->world, &part->world, a->vertex_count, b->vertex_count, 3 * sizeof(double), NOTHING},
        {&a->normals, &b->normals, a->vertex_count, b->vertex_count, 3 * sizeof(float), NOTHING},
        {&a->texcoords, &b->texcoords, a->vertex_count, b->vertex_count, 2 * sizeof(float), NOTHING},
        {&a->second_texcoords, &b->second_texcoords, a->vertex_count, b->vertex_count, 2 * sizeof(float),
         NOTHING},
        {&a->tangents, &b->tangents, a->vertex_count, b->vertex_count, sizeof *a->tangents, NOTHING},
        {&a->colors, &b->colors, a->vertex_count, b->vertex_count, 4, WHITE},
        {&a->triangles, &b->triangles, a->triangle_count, b->triangle_count, sizeof *a->triangles, NOTHING},
        {&a->material_of, &b->material_of, a->triangle_count, b->triangle_count, sizeof *a->material_of,
         NOTHING},
        {&a->materials, &b->materials, a->material_count, b->material_count, sizeof *a->materials, NOTHING},
        {&a->extensions, &b->extensions, a->material_count, b->material_count, sizeof *a->extensions,
         NOTHING},
        {&a->textures, &b->textures, a->texture_count, b->texture_count, sizeof *a->textures, NOTHING},
        {&a->lights, &b->lights, a->light_count, b->light_count, sizeof *a->lights, NOTHING},
        {&a->viewpoints, &b->viewpoints, a->viewpoint_count, b->viewpoint_count, sizeof *a->viewpoints,
         NOTHING},
        {&a->notes, &b->notes, a->note_count, b->note_count, sizeof *a->notes, NOTHING},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        gw_code code = join(rows[i].target, rows[i].first, *(void **)rows[i].part, rows[i].second,
                            rows[i].row, rows[i].fill, error);
        if (code != GW_OK)
            return code;
    }
    return GW_OK;
}

static void shift_indices(gw_scene *scene, uint32_t vertices, uint32_t materials, uint32_t textures) {
    for (uint32_t i = 0; i < scene->triangle_count; i++) {
        for (int k = 0; k < 3; k++) {
            uint32_t *corner = &scene->triangles[i][k]; /* an index out of range must stay out of range */
            *corner = *corner < scene->vertex_count ? *corner + vertices : UINT32_MAX;
        }
        uint32_t *material = &scene->material_of[i];
        *material = *material < scene->material_count ? *material + materials : UINT32_MAX;
    }
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (scene->materials[i].base_color_texture >= 0)
            scene->materials[i].base_color_texture += (int32_t)textures;
    for (uint32_t i = 0; scene->extensions && i < scene->material_count; i++) {
        for (int map = 0; map < GW_MAP_COUNT; map++) {
            gw_texture_use *use = gw_texture_use_of(&scene->extensions[i], (gw_map)map);
            if (use && use->texture >= 0)
                use->texture += (int32_t)textures;
        }
    }
}

/* Beside a model that has extensions the other gets some that change nothing. */
static gw_code extend_both(gw_scene *a, gw_scene *b, gw_error *error) {
    if (!a->extensions && !b->extensions)
        return GW_OK;
    gw_code code = gw_scene_extend_materials(a, error);
    return code == GW_OK ? gw_scene_extend_materials(b, error) : code;
}

/* Beside a model that moves one that stays has an animation, too: of vertices that stay. */
static gw_code append_animation(gw_source_model *target, gw_source_model *part, gw_error *error) {
    gw_source_model *both[2] = {target, part};
    if (!target->scene->animation && !part->scene->animation)
        return GW_OK;
    for (int i = 0; i < 2; i++) {
        gw_scene *scene = both[i]->scene;
        gw_code code = scene->animation ? GW_OK
                                        : gw_animation_still(scene->vertex_count, both[i]->world,
                                                             scene->normals, &scene->animation, error);
        if (code != GW_OK)
            return code;
    }
    return gw_animation_append(target->scene->animation, part->scene->animation, error);
}

gw_code gw_source_model_append(gw_source_model *target, gw_source_model *part, gw_error *error) {
    gw_scene *a = target->scene, *b = part->scene;
    if ((uint64_t)a->vertex_count + b->vertex_count >= UINT32_MAX ||
        (uint64_t)a->triangle_count + b->triangle_count >= UINT32_MAX)
        return gw_fail(error, GW_BAD_INPUT,
                       "the models together have more vertices or triangles than a scene can hold");
    gw_code code = append_animation(target, part, error);
    if (code == GW_OK)
        code = extend_both(a, b, error);
    if (code != GW_OK)
        return code;
    shift_indices(b, a->vertex_count, a->material_count, a->texture_count);
    code = join_arrays(target, part, error);
    if (code != GW_OK)
        return code; /* images and notes are still the part's: the target does not count them */
    a->vertex_count += b->vertex_count;
    a->triangle_count += b->triangle_count;
    a->material_count += b->material_count;
    a->texture_count += b->texture_count;
    a->light_count += b->light_count;
    a->viewpoint_count += b->viewpoint_count;
    a->note_count += b->note_count;
    gw_dropped_add(&a->dropped, &b->dropped);
    b->texture_count = 0; /* now the target's */
    b->note_count = 0;
    b->vertex_count = b->triangle_count = b->material_count = b->light_count = b->viewpoint_count = 0;
    return GW_OK;
}
