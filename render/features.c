/* See features.h. */
#include "render/features.h"

#include "base/suggest.h"
#include "build/gpu_types.h"
#include "render/transmission.h"
#include "shaders/common/frame.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const gw_feature_row gw_feature_rows[] = {
    {GW_FEATURE_TEXTURES, "textures", "TEXTURES", "no material in use has a texture"},
    {GW_FEATURE_VERTEX_COLORS, "vertex-colors", "VERTEX_COLORS", "no vertex has a colour"},
    {GW_FEATURE_SMOOTH_NORMALS, "smooth-normals", "SMOOTH_NORMALS", "no vertex has a shading normal"},
    {GW_FEATURE_EMISSIVE, "emissive", "EMISSIVE", "no material in use emits light"},
    {GW_FEATURE_ALPHA, "alpha", "ALPHA", "no material in use masks or blends"},
    {GW_FEATURE_DIRECTIONAL_LIGHTS, "directional-lights", "DIRECTIONAL_LIGHTS", "the scene has none"},
    {GW_FEATURE_POINT_LIGHTS, "point-lights", "POINT_LIGHTS", "the scene has none"},
    {GW_FEATURE_SPOT_LIGHTS, "spot-lights", "SPOT_LIGHTS", "no light of the scene has a cone or an end"},
    {GW_FEATURE_AREA_LIGHTS, "area-lights", "AREA_LIGHTS", "no light has an extent"},
    {GW_FEATURE_EMISSIVE_LIGHTS, "emissive-lights", "EMISSIVE_LIGHTS",
     "emissive_lights is 0, or no material in use emits as much light as emissive_faintest"},
    {GW_FEATURE_ENVIRONMENT, "environment", "ENVIRONMENT", "the scene has none"},
    {GW_FEATURE_LOD, "lod", "LOD", "tau is 0 wherever it applies, so every ray ends at triangles"},
    {GW_FEATURE_GAZE, "gaze", "GAZE", "no gaze is known, or nothing in the frame depends on it"},
    {GW_FEATURE_WIDE_NODES, "wide-nodes", "WIDE_NODES", "the octree has at most 2^24 nodes"},
    {GW_FEATURE_SPARSE, "sparse-samples", "SPARSE",
     "samples is 1, and no gaze is known or sample_block is 1: a ray per pixel"},
    {GW_FEATURE_DENSE_LEAVES, "dense-leaves", "DENSE_LEAVES", "no leaf has more than dense_leaf triangles"},
    {GW_FEATURE_ACCUMULATE, "accumulation", "ACCUMULATE", "accumulate is 1: every frame stands for itself"},
    {GW_FEATURE_SHADOWS, "shadows", "SHADOWS", "the scene has no light that could cast any"},
    {GW_FEATURE_MIRROR, "mirror", "MIRROR",
     "no material in use is a perfect mirror: metalness 1, roughness at most mirror_roughness"},
    {GW_FEATURE_GLOSSY, "glossy", "GLOSSY",
     "no material in use, nor its clearcoat, is smoother than glossy_roughness (of a map the smoothest "
     "texel counts), or there is no light to reflect"},
    {GW_FEATURE_OCCLUSION, "occlusion", "OCCLUSION",
     "occlusion_cones or bounces is 0, or no light comes from everywhere"},
    {GW_FEATURE_DIFFUSE, "diffuse-bounce", "DIFFUSE",
     "diffuse_bounce is off, occlusion_cones or bounces is 0, or nothing sends light"},
    {GW_FEATURE_TONE, "tone", "TONE", "tone is linear"},
    {GW_FEATURE_EXPOSURE, "exposure", "EXPOSURE", "exposure is 0 stops"},
    {GW_FEATURE_DITHER, "dither", "DITHER", "dither is off"},
    {GW_FEATURE_METERING, "metering", "METERING",
     "exposure is not auto, so nobody asks how bright the picture is"},
    {GW_FEATURE_TRANSMISSION, "transmission", "TRANSMISSION", "no material in use lets light through"},
    {GW_FEATURE_ABSORPTION, "absorption", "ABSORPTION", "no medium in use takes light away"},
    {GW_FEATURE_NORMAL_MAPS, "normal-maps", "NORMAL_MAPS", "no material in use has one"},
    {GW_FEATURE_TANGENTS, "tangents", "TANGENTS", "no normal map in use has tangents in its file"},
    {GW_FEATURE_MATERIAL_MAPS, "material-maps", "MATERIAL_MAPS",
     "no material in use has a map of metalness, roughness or occlusion"},
    {GW_FEATURE_EMISSIVE_MAPS, "emissive-maps", "EMISSIVE_MAPS", "no material in use has one"},
    {GW_FEATURE_CLEARCOAT, "clearcoat", "CLEARCOAT", "no material in use has one"},
    {GW_FEATURE_SHEEN, "sheen", "SHEEN", "no material in use has any"},
    {GW_FEATURE_SPECULAR, "specular", "SPECULAR",
     "every material in use reflects as index 1.5 does, or as a metal"},
    {GW_FEATURE_LAYER_MAPS, "layer-maps", "LAYER_MAPS",
     "no material in use has a map of its clearcoat or sheen"},
    {GW_FEATURE_SPECULAR_MAPS, "specular-maps", "SPECULAR_MAPS", "no material in use has one"},
    {GW_FEATURE_TRANSMISSION_MAPS, "transmission-maps", "TRANSMISSION_MAPS", "no material in use has one"},
    {GW_FEATURE_UNLIT, "unlit", "UNLIT", "every material in use is lit"},
    {GW_FEATURE_MAP_PLACEMENT, "map-placement", "MAP_PLACEMENT",
     "every map lies where the base colour of its material does"},
    {GW_FEATURE_SQUARE_TEXELS, "square-texels", "SQUARE_TEXELS", "every texture is interpolated"},
};
const size_t gw_feature_count = sizeof gw_feature_rows / sizeof gw_feature_rows[0];

gw_code gw_feature_of_name(const char *name, gw_features *bit, gw_error *error) {
    enum { MOST = 64 };
    const char *names[MOST];
    size_t count = gw_feature_count < MOST ? gw_feature_count : MOST;
    for (size_t i = 0; i < count; ++i) {
        names[i] = gw_feature_rows[i].name;
        if (!strcmp(name, names[i])) {
            *bit = gw_feature_rows[i].bit;
            return GW_OK;
        }
    }
    const char *nearest = gw_suggest(name, names, count);
    if (nearest)
        return gw_fail(error, GW_BAD_INPUT, "there is no effect '%s'; did you mean '%s'?", name, nearest);
    return gw_fail(error, GW_BAD_INPUT, "there is no effect '%s'; gazewall inspect lists them all", name);
}

gw_features gw_features_of_material(const gw_material *material, float mirror_roughness) {
    gw_features bits = 0;
    if (material->base_color_texture >= 0)
        bits |= GW_FEATURE_TEXTURES;
    if (material->emissive[0] > 0.0f || material->emissive[1] > 0.0f || material->emissive[2] > 0.0f)
        bits |= GW_FEATURE_EMISSIVE;
    if (material->metalness >= 1.0f && material->roughness <= mirror_roughness)
        bits |= GW_FEATURE_MIRROR;
    if (material->alpha_mode != GW_ALPHA_OPAQUE)
        bits |= GW_FEATURE_ALPHA;
    return bits;
}

static gw_features features_of_use(const gw_scene *scene, const gw_texture_use *use, gw_features map) {
    static const float as_it_is[2][3] = {{1, 0, 0}, {0, 1, 0}};
    if (use->texture < 0)
        return 0;
    if (use->coordinate != 0 || memcmp(use->to_uv, as_it_is, sizeof as_it_is) != 0)
        map |= GW_FEATURE_MAP_PLACEMENT;
    return map | (scene->textures[use->texture].nearest ? GW_FEATURE_SQUARE_TEXELS : 0);
}

static gw_features features_of_layers(const gw_scene *scene, const gw_material_extension *extension) {
    gw_features bits = 0;
    if (extension->clearcoat > 0.0f)
        bits |= GW_FEATURE_CLEARCOAT |
                features_of_use(scene, &extension->clearcoat_map, GW_FEATURE_LAYER_MAPS) |
                features_of_use(scene, &extension->clearcoat_roughness_map, GW_FEATURE_LAYER_MAPS) |
                features_of_use(scene, &extension->clearcoat_normal, GW_FEATURE_LAYER_MAPS);
    if (extension->sheen_color[0] > 0.0f || extension->sheen_color[1] > 0.0f ||
        extension->sheen_color[2] > 0.0f)
        bits |= GW_FEATURE_SHEEN |
                features_of_use(scene, &extension->sheen_color_map, GW_FEATURE_LAYER_MAPS) |
                features_of_use(scene, &extension->sheen_roughness_map, GW_FEATURE_LAYER_MAPS);
    return bits;
}

static gw_features features_of_extension(const gw_scene *scene, const gw_material_extension *extension) {
    const float *emissive = extension->emissive;
    gw_features bits = features_of_use(scene, &extension->normal, GW_FEATURE_NORMAL_MAPS) |
                       features_of_use(scene, &extension->metallic_roughness, GW_FEATURE_MATERIAL_MAPS) |
                       features_of_use(scene, &extension->occlusion, GW_FEATURE_MATERIAL_MAPS);
    if (emissive[0] > 0.0f || emissive[1] > 0.0f || emissive[2] > 0.0f)
        bits |= features_of_use(scene, &extension->emissive_map, GW_FEATURE_EMISSIVE_MAPS);
    const gw_features specular_maps =
        features_of_use(scene, &extension->specular_map, GW_FEATURE_SPECULAR_MAPS) |
        features_of_use(scene, &extension->specular_color_map, GW_FEATURE_SPECULAR_MAPS);
    bits |= features_of_layers(scene, extension) | specular_maps;
    if (specular_maps || extension->ior != 1.5f || extension->specular != 1.0f ||
        extension->specular_color[0] != 1.0f || extension->specular_color[1] != 1.0f ||
        extension->specular_color[2] != 1.0f)
        bits |= GW_FEATURE_SPECULAR;
    if (extension->unlit)
        bits |= GW_FEATURE_UNLIT;
    return bits;
}

static gw_features features_of_light(const gw_light *light) {
    gw_features bits = light->kind == GW_LIGHT_DIRECTIONAL ? GW_FEATURE_DIRECTIONAL_LIGHTS
                       : light->kind == GW_LIGHT_SPOT      ? GW_FEATURE_SPOT_LIGHTS
                                                           : GW_FEATURE_POINT_LIGHTS;
    if (light->range > 0.0f)
        bits |= GW_FEATURE_SPOT_LIGHTS;
    return bits;
}

/* Nothing absorbs whose colour is white or whose surface bounds nothing. */
static gw_features features_of_glass(const gw_scene *scene, uint32_t material) {
    if (!gw_lets_light_through(scene, material))
        return 0;
    const gw_material_extension *e = &scene->extensions[material];
    const float least =
        fminf(e->attenuation_color[0], fminf(e->attenuation_color[1], e->attenuation_color[2]));
    const int absorbs = gw_bounds_medium(scene, material) && e->attenuation_distance > 0.0f && least < 1.0f;
    return GW_FEATURE_TRANSMISSION |
           features_of_use(scene, &e->transmission_map, GW_FEATURE_TRANSMISSION_MAPS) |
           (absorbs ? GW_FEATURE_ABSORPTION : 0);
}

static int has_normal(const gw_scene *scene) {
    for (size_t i = 0; i < (size_t)scene->vertex_count * 3; ++i)
        if (scene->normals[i] != 0.0f)
            return 1;
    return 0;
}

gw_features gw_features_of_scene(const gw_scene *scene, const gw_octree *octree, float mirror_roughness) {
    gw_features bits = 0;
    /* Materials that no triangle uses call for nothing. */
    uint32_t last = UINT32_MAX;
    for (uint32_t i = 0; i < scene->triangle_count; ++i) {
        uint32_t material = scene->material_of[i];
        if (material != last)
            bits |= gw_features_of_material(&scene->materials[material], mirror_roughness) |
                    features_of_glass(scene, material);
        if (material != last && scene->extensions)
            bits |= features_of_extension(scene, &scene->extensions[material]);
        const int32_t texture = scene->materials[material].base_color_texture;
        if (texture >= 0 && scene->textures[texture].nearest)
            bits |= GW_FEATURE_SQUARE_TEXELS;
        last = material;
    }
    if (scene->tangents && bits & (GW_FEATURE_NORMAL_MAPS | GW_FEATURE_LAYER_MAPS))
        bits |= GW_FEATURE_TANGENTS;
    if (scene->environment.rgbe.rgba)
        bits |= GW_FEATURE_ENVIRONMENT;
    if (scene->colors)
        bits |= GW_FEATURE_VERTEX_COLORS;
    if (scene->normals && has_normal(scene))
        bits |= GW_FEATURE_SMOOTH_NORMALS;
    for (uint32_t i = 0; i < scene->light_count; ++i)
        bits |= GW_FEATURE_SHADOWS | features_of_light(&scene->lights[i]);
    if (octree->node_count > 1u << 24)
        bits |= GW_FEATURE_WIDE_NODES;
    if (octree->box_count > 0)
        bits |= GW_FEATURE_DENSE_LEAVES;
    return bits;
}

/* Debug views show numbers as colours, which no curve may touch. */
static gw_features features_of_tone(const gw_frame_state *state) {
    if (state->debug != GW_DEBUG_NONE && state->debug != GW_DEBUG_BOUNDS)
        return 0;
    return (state->tone != GW_TONE_LINEAR ? GW_FEATURE_TONE : 0) |
           (state->exposure != 0.0f || state->metering ? GW_FEATURE_EXPOSURE : 0) |
           (state->dither ? GW_FEATURE_DITHER : 0) | (state->metering ? GW_FEATURE_METERING : 0);
}

/* Cones need voxels, also where everything else ends at triangles. */
static gw_features features_of_cones(const gw_frame_state *state) {
    if (state->cones == 0 || state->bounces == 0)
        return 0;
    return GW_FEATURE_OCCLUSION | (state->diffuse_bounce ? GW_FEATURE_DIFFUSE : 0) |
           (state->geometry != GW_GEOMETRY_TRIANGLES ? GW_FEATURE_LOD : 0);
}

gw_features gw_features_of_frame(const gw_frame_state *state, uint32_t viewers, gw_features scene_features) {
    gw_features bits = features_of_cones(state);
    float coarsest = viewers > 0 && state->tau > state->tau_inside ? state->tau : state->tau_inside;
    if (state->geometry == GW_GEOMETRY_VOXELS || (state->geometry == GW_GEOMETRY_HYBRID && coarsest > 0.0f))
        bits |= GW_FEATURE_LOD;
    int depends = (bits & GW_FEATURE_LOD) || (scene_features & GW_PICTURE_FEATURES) ||
                  state->debug == GW_DEBUG_GAZE || state->debug == GW_DEBUG_ECCENTRICITY ||
                  state->debug == GW_DEBUG_FOOTPRINT;
    if (viewers > 0 && depends)
        bits |= GW_FEATURE_GAZE;
    if ((viewers > 0 && state->sample_block > 0) || state->samples > 0)
        bits |= GW_FEATURE_SPARSE;
    if (state->accumulate > 1 || state->epoch > 0)
        bits |= GW_FEATURE_ACCUMULATE;
    return bits | features_of_tone(state);
}

uint32_t gw_kernel_fragments(const gw_kernel_key *key) {
    return (key->features & GW_FEATURE_LOD) || key->until_coarse ? GW_LOD_FRAGMENTS : 1;
}

typedef struct define_text {
    char *text;
    size_t size, used;
} define_text;

static void append(define_text *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void append(define_text *out, const char *format, ...) {
    if (out->used >= out->size)
        return;
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(out->text + out->used, out->size - out->used, format, arguments);
    va_end(arguments);
    out->used += length > 0 ? (size_t)length : 0;
}

gw_code gw_kernel_defines(const gw_kernel_key *key, char *text, size_t size, gw_error *error) {
    define_text out = {text, size, 0};
    append(&out, "#define OCTREE_DEPTH %u\n", key->depth);
    if (key->root_grid)
        append(&out, "#define ROOT_GRID_LEVEL %u\n", key->root_grid);
    append(&out, "#define LOOP_BUDGET %uu\n", key->loop_budget);
    append(&out, "#define FRAGMENTS %uu\n", gw_kernel_fragments(key));
    append(&out, "#define TEXTURE_CLASSES %u\n", key->texture_classes);
    append(&out, "#define DATA_CLASSES %u\n", key->data_classes);
    append(&out, "#define DEBUG_VIEW %u\n", key->debug);
    for (size_t i = 0; i < gw_feature_count; ++i)
        if (key->features & gw_feature_rows[i].bit)
            append(&out, "#define %s 1\n", gw_feature_rows[i].define);
    if (key->features & GW_SECONDARY_FEATURES)
        append(&out, "#define SECONDARY 1\n");
    if (key->features & GW_CONE_FEATURES)
        append(&out, "#define CONES 1\n");
    if (key->voxels_only)
        append(&out, "#define VOXELS_ONLY 1\n");
    if (key->level_blend)
        append(&out, "#define LEVEL_BLEND 1\n");
    if (key->leaf_blend)
        append(&out, "#define LEAF_BLEND 1\n");
    if (key->voxel_emission)
        append(&out, "#define VOXEL_EMISSION 1\n");
    if (key->double_edges)
        append(&out, "#define DOUBLE_EDGES 1\n");
    if (key->ordered_edges)
        append(&out, "#define ORDERED_EDGES 1\n");
    if (key->check_fetches)
        append(&out, "#define CHECK_FETCHES 1\n");
    if (key->count)
        append(&out, "#define COUNT 1\n");
    if (key->any_hit)
        append(&out, "#define ANY_HIT 1\n");
    if (key->reflected)
        append(&out, "#define REFLECTED 1\n");
    if (key->until_coarse)
        append(&out, "#define UNTIL_COARSE 1\n");
    if (key->gaze_seed)
        append(&out, "#define GAZE_SEED 1\n");
    if (key->guides)
        append(&out, "#define GUIDES 1\n");
    if (key->resume)
        append(&out, "#define RESUME 1\n");
    if (out.used >= out.size)
        return gw_fail(error, GW_MACHINE, "the kernel's defines need more than %zu bytes", size);
    return GW_OK;
}
