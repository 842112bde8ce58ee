#include "build/scene.h"

#include "base/memory.h"
#include "build/animation.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gw_scene_destroy(gw_scene **scene_address) {
    if (!scene_address || !*scene_address)
        return;
    gw_scene *scene = *scene_address;
    for (uint32_t i = 0; scene->textures && i < scene->texture_count; i++)
        gw_image_finish(&scene->textures[i].image);
    for (uint32_t i = 0; scene->paths && i < scene->path_count; i++)
        free(scene->paths[i].keys);
    for (size_t i = 0; i < scene->note_count; i++)
        free(scene->notes[i]);
    free(scene->path);
    free(scene->positions);
    free(scene->normals);
    free(scene->texcoords);
    free(scene->second_texcoords);
    free(scene->tangents);
    free(scene->colors);
    free(scene->welded);
    free(scene->triangles);
    free(scene->material_of);
    free(scene->materials);
    free(scene->textures);
    free(scene->extensions);
    free(scene->lights);
    gw_image_finish(&scene->environment.rgbe);
    free(scene->viewpoints);
    free(scene->paths);
    free(scene->notes);
    gw_animation_destroy(&scene->animation);
    free(scene);
    *scene_address = NULL;
}

double gw_light_area(const gw_light *light) {
    const float *u = light->sides[0], *v = light->sides[1];
    double cross[3];
    for (int i = 0; i < 3; i++) {
        const int a = (i + 1) % 3, b = (i + 2) % 3;
        cross[i] = (double)u[a] * (double)v[b] - (double)u[b] * (double)v[a];
    }
    return sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
}

gw_code gw_scene_note(gw_scene *scene, gw_error *error, const char *format, ...) {
    char *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    if (length < 0)
        return gw_fail(error, GW_MACHINE, "out of memory for a note on the scene");
    char **notes = realloc(scene->notes, (scene->note_count + 1) * sizeof *notes);
    if (!notes) {
        free(text);
        return gw_fail(error, GW_MACHINE, "out of memory for a note on the scene");
    }
    scene->notes = notes;
    notes[scene->note_count++] = text;
    return GW_OK;
}

const gw_dropped_row gw_dropped_rows[] = {
#define GW_DROPPED_ROW(field, text) {#field, text, offsetof(gw_dropped, field)},
    GW_DROPPED_TABLE(GW_DROPPED_ROW)
#undef GW_DROPPED_ROW
};
const size_t gw_dropped_row_count = sizeof gw_dropped_rows / sizeof *gw_dropped_rows;

uint64_t gw_dropped_by(const gw_dropped *dropped, const gw_dropped_row *row) {
    uint64_t count;
    memcpy(&count, (const char *)dropped + row->offset, sizeof count);
    return count;
}

uint64_t gw_dropped_total(const gw_dropped *dropped) {
    uint64_t total = 0;
    for (size_t i = 0; i < gw_dropped_row_count; i++)
        total += gw_dropped_by(dropped, &gw_dropped_rows[i]);
    return total;
}

void gw_dropped_add(gw_dropped *sum, const gw_dropped *part) {
#define GW_DROPPED_ADD(field, words) sum->field += part->field;
    GW_DROPPED_TABLE(GW_DROPPED_ADD)
#undef GW_DROPPED_ADD
}

static gw_hash hash_appearance(gw_hash hash, const gw_scene *scene) {
    for (uint32_t i = 0; i < scene->material_count;
         i++) { /* everything after the name, which reaches no pixel */
        const char *begin = (const char *)scene->materials[i].base_color;
        const char *end = (const char *)(&scene->materials[i] + 1);
        hash = gw_hash_bytes(hash, begin, (size_t)(end - begin));
    }
    if (scene->extensions)
        hash = gw_hash_bytes(hash, scene->extensions, scene->material_count * sizeof(gw_material_extension));
    for (uint32_t i = 0; i < scene->texture_count; i++) {
        const gw_texture *texture = &scene->textures[i];
        const uint32_t words[5] = {texture->image.width, texture->image.height, (uint32_t)texture->wrap_u,
                                   (uint32_t)texture->wrap_v, (uint32_t)texture->nearest};
        hash = gw_hash_bytes(hash, words, sizeof words);
        hash = gw_hash_bytes(hash, texture->image.rgba, (size_t)words[0] * words[1] * 4);
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const gw_light *light = &scene->lights[i];
        const uint32_t kind = (uint32_t)light->kind;
        hash = gw_hash_bytes(hash, &kind, sizeof kind);
        hash = gw_hash_bytes(hash, light->vector, sizeof light->vector);
        hash = gw_hash_bytes(hash, light->color, sizeof light->color);
        if (light->kind != GW_LIGHT_DIRECTIONAL || light->extent > 0.0f) {
            const float shape[] = {light->axis[0], light->axis[1], light->axis[2], light->cone[0],
                                   light->cone[1], light->range,   light->extent};
            hash = gw_hash_bytes(hash, shape, sizeof shape);
            hash = gw_hash_bytes(hash, light->sides, sizeof light->sides);
        }
    }
    if (scene->environment.rgbe.rgba) {
        const gw_image *rgbe = &scene->environment.rgbe;
        const float place[2] = {scene->environment.scale, scene->environment.rotation};
        hash = gw_hash_bytes(hash, place, sizeof place);
        hash = gw_hash_bytes(hash, rgbe->rgba, (size_t)rgbe->width * rgbe->height * 4);
    }
    hash = gw_hash_bytes(hash, scene->ambient, sizeof scene->ambient);
    return gw_hash_bytes(hash, scene->background, sizeof scene->background);
}

static gw_hash hash_views(gw_hash hash, const gw_scene *scene) {
    for (uint32_t i = 0; i < scene->viewpoint_count; i++) {
        const gw_viewpoint *view = &scene->viewpoints[i];
        hash = gw_hash_bytes(hash, view->eye, sizeof view->eye);
        hash = gw_hash_bytes(hash, view->look_at, sizeof view->look_at);
        hash = gw_hash_bytes(hash, view->up, sizeof view->up);
        hash = gw_hash_bytes(hash, &view->fov, sizeof view->fov);
    }
    for (uint32_t i = 0; i < scene->path_count; i++) {
        const gw_camera_path *path = &scene->paths[i];
        hash = gw_hash_bytes(hash, &path->fov, sizeof path->fov);
        hash = gw_hash_bytes(hash, path->keys, path->key_count * sizeof(gw_camera_key));
    }
    const uint32_t kind = (uint32_t)scene->placement.kind;
    hash = gw_hash_bytes(hash, &kind, sizeof kind);
    hash = gw_hash_bytes(hash, &scene->placement.scale, sizeof scene->placement.scale);
    hash = gw_hash_bytes(hash, scene->placement.matrix, sizeof scene->placement.matrix);
    hash = gw_hash_bytes(hash, scene->centre, sizeof scene->centre);
    hash = gw_hash_bytes(hash, &scene->exponent, sizeof scene->exponent);
    return gw_hash_bytes(hash, scene->bounds, sizeof scene->bounds);
}

void gw_scene_rehash(gw_scene *scene) {
    const uint32_t counts[9] = {scene->vertex_count,    scene->triangle_count, scene->welded_count,
                                scene->material_count,  scene->texture_count,  scene->light_count,
                                scene->viewpoint_count, scene->path_count,     scene->colors != NULL};
    const size_t vertices = scene->vertex_count, triangles = scene->triangle_count;
    gw_hash hash = gw_hash_bytes((gw_hash){0, 0}, counts, sizeof counts);
    hash = gw_hash_bytes(hash, scene->positions, vertices * 3 * sizeof(float));
    hash = gw_hash_bytes(hash, scene->normals, vertices * 3 * sizeof(float));
    hash = gw_hash_bytes(hash, scene->texcoords, vertices * 2 * sizeof(float));
    if (scene->second_texcoords)
        hash = gw_hash_bytes(hash, scene->second_texcoords, vertices * 2 * sizeof(float));
    if (scene->tangents)
        hash = gw_hash_bytes(hash, scene->tangents, vertices * sizeof *scene->tangents);
    if (scene->colors)
        hash = gw_hash_bytes(hash, scene->colors, vertices * 4);
    hash = gw_hash_bytes(hash, scene->triangles, triangles * 3 * sizeof(uint32_t));
    hash = gw_hash_bytes(hash, scene->material_of, triangles * sizeof(uint32_t));
    if (scene->animation)
        hash = gw_animation_hash(hash, scene->animation);
    scene->hash = hash_views(hash_appearance(hash, scene), scene);
}
