/* The embedded demo scene: an orangery seen through the wall as through a window. Large flat textured
 * triangles - floor, arcades, a coffered vault - next to what voxels are for: a golden knot of a hundred and
 * sixty thousand triangles, and trees and ivy with tens of thousands of leaves. Life-size: the viewer
 * stands 1.8 m before a wall 2 m wide, nothing is nearer than the wall's plane. Light comes from the upper
 * left; what a second bounce and shadows would do is in the vertex colours. */
#include "build/demo_scene.h"

#include "base/memory.h"
#include "build/demo_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* (11, -13, -12) / sqrt(434): from the upper left, over the viewer's shoulder. */
const demo_point demo_sun = {0.30135918138635276, -0.2712232632477175, -0.9141228502052701};

static const struct {
    const char *name;
    float color[3];
    float metalness, roughness;
    float emissive[3];
    int two_sided, texture;
} looks[DEMO_MATERIALS] = {
    [DEMO_FLOOR] = {"floor", {0.55f, 0.55f, 0.60f}, 0.0f, 0.35f, {0, 0, 0}, 0, DEMO_TEXTURE_FLOOR},
    [DEMO_SUNLIT] = {"sunlit floor", {1, 1, 1}, 0.0f, 0.35f, {0.03f, 0.02f, 0.005f}, 0, DEMO_TEXTURE_FLOOR},
    [DEMO_ASHLAR] = {"ashlar", {1, 1, 1}, 0.0f, 0.9f, {0, 0, 0}, 0, DEMO_TEXTURE_ASHLAR},
    [DEMO_PLASTER] = {"plaster", {1, 1, 1}, 0.0f, 0.95f, {0, 0, 0}, 0, DEMO_TEXTURE_PLASTER},
    [DEMO_MARBLE] = {"marble", {0.9f, 0.9f, 0.9f}, 0.0f, 0.4f, {0, 0, 0}, 0, DEMO_TEXTURE_MARBLE},
    [DEMO_VAULT] = {"vault", {1, 1, 1}, 0.0f, 0.7f, {0, 0, 0}, 0, DEMO_TEXTURE_VAULT},
    [DEMO_TRIM] = {"gilding", {0.86f, 0.53f, 0.18f}, 0.6f, 0.45f, {0, 0, 0}, 0, -1},
    [DEMO_WOOD] = {"wood", {1, 1, 1}, 0.0f, 0.7f, {0, 0, 0}, 0, DEMO_TEXTURE_WOOD},
    [DEMO_CARPET] = {"carpet", {0.8f, 0.8f, 0.8f}, 0.0f, 1.0f, {0, 0, 0}, 0, DEMO_TEXTURE_CARPET},
    [DEMO_LANDSCAPE] = {"landscape", {1, 1, 1}, 0.0f, 1.0f, {0.2f, 0.22f, 0.26f}, 0, DEMO_TEXTURE_LANDSCAPE},
    [DEMO_STATUE] = {"gold", {1.0f, 0.57f, 0.17f}, 0.6f, 0.3f, {0, 0, 0}, 0, -1},
    [DEMO_PEDESTAL] = {"pedestal", {1, 1, 1}, 0.0f, 0.25f, {0, 0, 0}, 0, DEMO_TEXTURE_PEDESTAL},
    [DEMO_TERRACOTTA] = {"terracotta", {1, 1, 1}, 0.0f, 0.85f, {0, 0, 0}, 0, DEMO_TEXTURE_TERRACOTTA},
    [DEMO_SOIL] = {"soil", {0.05f, 0.035f, 0.025f}, 0.0f, 1.0f, {0, 0, 0}, 0, -1},
    [DEMO_BARK] = {"bark", {0.20f, 0.14f, 0.09f}, 0.0f, 0.9f, {0, 0, 0}, 0, -1},
    [DEMO_LEAF] = {"leaf", {1, 1, 1}, 0.0f, 0.5f, {0, 0, 0}, 1, DEMO_TEXTURE_LEAF},
    [DEMO_IVY] = {"ivy", {0.6f, 0.75f, 0.6f}, 0.0f, 0.5f, {0, 0, 0}, 1, DEMO_TEXTURE_LEAF},
    [DEMO_ORANGE] = {"orange", {0.95f, 0.32f, 0.03f}, 0.0f, 0.45f, {0, 0, 0}, 0, -1},
};

gw_code demo_make_materials(gw_scene *scene, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, DEMO_MATERIALS, sizeof *scene->materials, "demo materials", error);
    if (code != GW_OK)
        return code;
    scene->materials = memory;
    scene->material_count = DEMO_MATERIALS;
    for (int i = 0; i < DEMO_MATERIALS; i++) {
        gw_material *material = &scene->materials[i];
        snprintf(material->name, sizeof material->name, "%s", looks[i].name);
        memcpy(material->base_color, looks[i].color, sizeof looks[i].color);
        material->base_color[3] = 1.0f;
        material->metalness = looks[i].metalness;
        material->roughness = looks[i].roughness;
        memcpy(material->emissive, looks[i].emissive, sizeof material->emissive);
        material->two_sided = looks[i].two_sided;
        material->base_color_texture = looks[i].texture;
    }
    memory = NULL;
    code = gw_allocate(&memory, DEMO_TEXTURES, sizeof *scene->textures, "demo textures", error);
    if (code != GW_OK)
        return code;
    scene->textures = memory;
    for (int i = 0; i < DEMO_TEXTURES && code == GW_OK; i++) {
        code = demo_make_texture(i, &scene->textures[i], error);
        if (code == GW_OK)
            scene->texture_count++;
    }
    return code;
}

static gw_code make_lights_and_views(gw_scene *scene, gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof *scene->lights, "demo light", error);
    if (code != GW_OK)
        return code;
    scene->lights = memory;
    scene->light_count = 1;
    scene->lights[0] = (gw_light){.kind = GW_LIGHT_DIRECTIONAL,
                                  .vector = {demo_sun.x, demo_sun.y, demo_sun.z},
                                  .color = {3.5f, 3.05f, 2.4f}};
    memory = NULL;
    code = gw_allocate(&memory, 2, sizeof *scene->viewpoints, "demo viewpoints", error);
    if (code != GW_OK)
        return code;
    scene->viewpoints = memory;
    scene->viewpoint_count = 2;
    scene->viewpoints[0] =
        (gw_viewpoint){"window", {0.0, 1.5, 0.0}, {0.0, 1.5, -10.0}, {0.0, 1.0, 0.0}, 35.0};
    scene->viewpoints[1] =
        (gw_viewpoint){"statue", {-0.3, 1.7, -3.4}, {-1.12, 1.65, -5.3}, {0.0, 1.0, 0.0}, 45.0};
    const float ambient[3] = {0.95f, 1.0f, 1.15f}, background[3] = {0.62f, 0.75f, 0.93f};
    memcpy(scene->ambient, ambient, sizeof ambient);
    memcpy(scene->background, background, sizeof background);
    scene->placement = (gw_placement){.kind = GW_PLACE_VIEWPOINT, .scale = 1.0};
    return GW_OK;
}

/* From the window to the statue. */
static gw_code make_path(gw_scene *scene, gw_error *error) {
    static const gw_camera_key keys[] = {{0.0, {0.0, 1.5, 0.0}, {0.0, 1.5, -10.0}},
                                         {4.0, {0.25, 1.6, -1.8}, {-0.5, 1.6, -7.0}},
                                         {8.0, {-0.3, 1.7, -3.4}, {-1.12, 1.65, -5.3}}};
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof *scene->paths, "demo path", error);
    if (code != GW_OK)
        return code;
    scene->paths = memory;
    scene->path_count = 1;
    scene->paths[0] = (gw_camera_path){.name = "walk", .fov = 45.0};
    code = gw_allocate(&memory, sizeof keys / sizeof *keys, sizeof *keys, "demo path", error);
    if (code != GW_OK)
        return code;
    scene->paths[0].keys = memory;
    scene->paths[0].key_count = sizeof keys / sizeof *keys;
    memcpy(scene->paths[0].keys, keys, sizeof keys);
    return GW_OK;
}

static void take_mesh(gw_scene *scene, demo_mesh *mesh) {
    scene->vertex_count = (uint32_t)mesh->vertex_count;
    scene->normals = (float *)mesh->normals;
    scene->texcoords = (float *)mesh->texcoords;
    scene->colors = (uint8_t *)mesh->colors;
    scene->triangle_count = (uint32_t)mesh->triangle_count;
    scene->triangles = mesh->triangles;
    scene->material_of = mesh->materials;
}

gw_code gw_demo_scene(gw_scene **out, gw_error *error) {
    *out = NULL;
    void *memory = NULL;
    demo_mesh mesh = {.error = error};
    gw_scene *scene = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof *scene, "demo scene", error);
    if (code != GW_OK)
        return code;
    scene = memory;
    demo_hall(&mesh);
    demo_columns(&mesh);
    demo_statue(&mesh);
    demo_trees(&mesh);
    demo_climbers(&mesh);
    take_mesh(scene, &mesh); /* the scene owns the arrays now, whole or not */
    code = mesh.code;
    if (code == GW_OK)
        code = demo_make_materials(scene, error);
    if (code == GW_OK)
        code = make_lights_and_views(scene, error);
    if (code == GW_OK)
        code = make_path(scene, error);
    if (code == GW_OK) {
        scene->path = gw_copy_text("demo");
        if (scene->path == NULL)
            code = gw_fail(error, GW_MACHINE, "demo scene: out of memory for its name");
    }
    if (code == GW_OK)
        code = gw_scene_finish(scene, (const double *)mesh.positions, error);
    free(mesh.positions);
    if (code == GW_OK)
        *out = scene;
    else
        gw_scene_destroy(&scene);
    return code;
}
