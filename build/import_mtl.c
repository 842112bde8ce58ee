/* MTL materials as assimp 5.2.5 gives them, put into our terms (after Alias/Wavefront, Object Files, Appendix
 * B1: MTL format). Runs in the import child. */
#include "build/import_internal.h"

#include <assimp/ObjMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What `illum` stands for; the names of B1 are in docs/materials.md. */
enum {
    CONSTANT = 0,
    DIFFUSE = 1,
    HIGHLIGHT = 2,
    REFLECTION = 3,
    GLASS = 4,
    FRESNEL_MIRROR = 5,
    REFRACTION = 6,
    FRESNEL_REFRACTION = 7,
    MIRROR_UNTRACED = 8,
    GLASS_UNTRACED = 9,
    SHADOWS_ONLY = 10
};

/* assimp says 1 for a material without the line: then its other keys decide, as with 2. */
static int illum_of(const struct aiMaterial *from, const gw_import_files *files) {
    int value = HIGHLIGHT;
    if (files->mtl_illum)
        aiGetMaterialIntegerArray(from, AI_MATKEY_OBJ_ILLUM, &value, NULL);
    return value;
}

static int traces_glass(int illum) {
    return illum == GLASS || illum == REFRACTION || illum == FRESNEL_REFRACTION;
}

static int is_black(const struct aiColor4D *color) {
    return !(color->r > 0 || color->g > 0 || color->b > 0);
}

/* Without a specular colour nothing shines. */
static float roughness_of(const struct aiMaterial *from, int illum) {
    struct aiColor4D specular = {0, 0, 0, 1};
    const float exponent = gw_import_float(from, "$mat.shininess", 0.0f);
    gw_import_color(from, "$clr.specular", &specular);
    const int shines = illum != DIFFUSE && !is_black(&specular);
    return shines && exponent > 0.0f ? gw_roughness_of_exponent((double)exponent) : 1.0f;
}

/* A picture for bump that holds normals is known by its pixels later. */
static gw_code bump(const struct aiScene *read, const struct aiMaterial *from, gw_source_model *model,
                    gw_material_source *source, gw_error *error) {
    gw_code code = gw_import_texture(read, from, aiTextureType_NORMALS, aiTextureType_NONE, model,
                                     &source->maps[GW_MAP_NORMAL], error);
    if (code == GW_OK && source->maps[GW_MAP_NORMAL] < 0) {
        code = gw_import_texture(read, from, aiTextureType_HEIGHT, aiTextureType_NONE, model,
                                 &source->maps[GW_MAP_NORMAL], error);
        source->normal_may_be_height = source->maps[GW_MAP_NORMAL] >= 0;
    }
    return code;
}

/* map_Ks colours what a dielectric reflects; map_Ns only counts where the material shines and has no map_Pr.
 */
static gw_code maps(const struct aiScene *read, const struct aiMaterial *from, int illum,
                    gw_source_model *model, gw_material_source *source, gw_error *error) {
    const struct {
        int type, alpha;
        gw_map map;
    } plain[] = {{aiTextureType_DIFFUSE, aiTextureType_OPACITY, GW_MAP_BASE_COLOR},
                 {aiTextureType_EMISSIVE, aiTextureType_NONE, GW_MAP_EMISSIVE},
                 {aiTextureType_DIFFUSE_ROUGHNESS, aiTextureType_NONE, GW_MAP_ROUGHNESS_ALONE},
                 {aiTextureType_METALNESS, aiTextureType_NONE, GW_MAP_METALNESS_ALONE}};
    const int shines = roughness_of(from, illum) < 1.0f;
    gw_code code = bump(read, from, model, source, error);
    for (size_t i = 0; code == GW_OK && i < sizeof plain / sizeof *plain; i++)
        code = gw_import_texture(read, from, plain[i].type, plain[i].alpha, model,
                                 &source->maps[plain[i].map], error);
    if (code == GW_OK && illum != CONSTANT && illum != DIFFUSE)
        code = gw_import_texture(read, from, aiTextureType_SPECULAR, aiTextureType_NONE, model,
                                 &source->maps[GW_MAP_SPECULAR_COLOR], error);
    if (code == GW_OK && shines && source->maps[GW_MAP_ROUGHNESS_ALONE] < 0) {
        code = gw_import_texture(read, from, aiTextureType_SHININESS, aiTextureType_NONE, model,
                                 &source->maps[GW_MAP_ROUGHNESS_ALONE], error);
        if (source->maps[GW_MAP_ROUGHNESS_ALONE] >= 0)
            source->exponent = fminf(gw_import_float(from, "$mat.shininess", 0.0f), 1e30f);
    }
    return code;
}

static void look(const struct aiMaterial *from, int illum, gw_material *to, gw_material_source *source) {
    struct aiColor4D color = {0.8f, 0.8f, 0.8f, 1};
    gw_import_color(from, "$clr.diffuse", &color);
    if (source->maps[GW_MAP_BASE_COLOR] >= 0 && is_black(&color))
        color = (struct aiColor4D){1, 1, 1,
                                   1}; /* exporters write a black Kd beside map_Kd; it would hide the map */
    gw_import_set_color(to->base_color, &color, 1, 1.0f);
    to->base_color[3] = gw_import_share((double)gw_import_float(from, "$mat.opacity", 1.0f));
    to->alpha_mode = to->base_color[3] < 1.0f ? GW_ALPHA_BLEND : GW_ALPHA_OPAQUE;
    source->alpha_from_texture = to->alpha_mode == GW_ALPHA_OPAQUE;
    to->metalness = gw_import_share((double)gw_import_float(from, "$mat.metallicFactor", 0.0f));
    const float roughness = gw_import_float(from, "$mat.roughnessFactor", -1.0f); /* Pr of the PBR keys */
    to->roughness = gw_import_share((double)(roughness >= 0.0f ? roughness : roughness_of(from, illum)));
    color = (struct aiColor4D){0, 0, 0, 1};
    gw_import_color(from, "$clr.emissive", &color);
    if (source->maps[GW_MAP_EMISSIVE] >= 0 && is_black(&color))
        color = (struct aiColor4D){1, 1, 1, 1}; /* as with map_Kd */
    gw_import_set_color(to->emissive, &color, 1, 1.0f);
    to->two_sided = 1;
}

/* Ni, Pc, Pcr and Ps. An index of 1 is what exporters write who know none. */
static void layers(const struct aiMaterial *from, int illum, gw_material_extension *to) {
    const float ior = gw_import_float(from, "$mat.refracti", 1.0f);
    const float sheen = gw_import_share((double)gw_import_float(from, "$clr.sheen.factor", 0.0f));
    to->ior = ior > 1.0f ? fminf(ior, 1e6f) : to->ior;
    to->unlit = illum == CONSTANT;
    to->clearcoat = gw_import_share((double)gw_import_float(from, "$mat.clearcoat.factor", 0.0f));
    to->clearcoat_roughness =
        gw_import_share((double)gw_import_float(from, "$mat.clearcoat.roughnessFactor", 0.0f));
    for (int i = 0; i < 3; i++)
        to->sheen_color[i] = sheen;
    to->sheen_roughness = sheen > 0.0f ? 0.5f : to->sheen_roughness; /* MTL has no key for it */
}

/* Glass lets 1 - d through, tinted by Tf; the rest is Kd's. Only its surface is known to bend light where the
 * model says so (6, 7): else it is a thin sheet. Tf alone says nothing: exporters write 1 1 1 for what is
 * opaque. */
static void glass(const struct aiMaterial *from, int illum, gw_material *material,
                  gw_material_extension *to) {
    struct aiColor4D filter = {1, 1, 1, 1};
    float tint[3];
    const float opaque = material->base_color[3];
    if (!traces_glass(illum) || opaque >= 1.0f)
        return;
    if (!gw_import_color(from, "$clr.transparent", &filter) || is_black(&filter))
        filter = (struct aiColor4D){1, 1, 1, 1};
    gw_import_set_color(tint, &filter, 0, 1.0f);
    for (int i = 0; i < 3; i++)
        material->base_color[i] = opaque * material->base_color[i] + (1.0f - opaque) * tint[i];
    material->base_color[3] = 1.0f;
    material->alpha_mode = GW_ALPHA_OPAQUE;
    to->transmission = 1.0f - opaque;
    to->thickness = illum == GLASS ? 0.0f : 1.0f;
}

gw_code gw_import_mtl_material(const struct aiScene *read, const struct aiMaterial *from,
                               const gw_import_files *files, gw_source_model *model, uint32_t index,
                               gw_error *error) {
    gw_material *to = &model->scene->materials[index];
    gw_material_source *source = &model->material_sources[index];
    struct aiString name = {0};
    const int illum = illum_of(from, files);
    if (aiGetMaterialString(from, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS)
        snprintf(to->name, sizeof to->name, "%.*s", (int)sizeof to->name - 1, name.data);
    const gw_code code = maps(read, from, illum, model, source, error);
    look(from, illum, to, source);
    layers(from, illum, &model->scene->extensions[index]);
    glass(from, illum, to, &model->scene->extensions[index]);
    return code;
}

/* --- what is not carried --- */

/* Keys that neither assimp nor we know, and options of maps, which assimp passes over. */
static const char *const lost_keys[GW_MTL_LOST_KEYS] = {
    "disp",   "map_disp", "decal",  "refl",    "map_refl", "aniso", "anisor", "sharpness",
    "map_Pc", "map_Pcr",  "map_Ps", "map_aat", "-s",       "-o",    "-t",     "-imfchan"};

static int same_word(const uint8_t *word, size_t length, const char *key) {
    if (strlen(key) != length)
        return 0;
    for (size_t i = 0; i < length; i++)
        if (tolower(word[i]) != tolower((unsigned char)key[i]))
            return 0;
    return 1;
}

/* A key counts at the start of a line, an option in a line of a map. */
static void scan_line(const uint8_t *line, size_t size, gw_import_files *files) {
    int words = 0, is_map = 0;
    for (size_t at = 0; at < size;) {
        size_t length = 0;
        while (at < size && isspace(line[at]))
            at++;
        while (at + length < size && !isspace(line[at + length]))
            length++;
        if (words == 0 && same_word(line + at, length, "illum"))
            files->mtl_illum = 1;
        is_map |= words == 0 && length > 4 && same_word(line + at, 4, "map_");
        for (int k = 0; length > 0 && k < GW_MTL_LOST_KEYS; k++)
            if ((lost_keys[k][0] == '-' ? is_map && words > 0 : words == 0) &&
                same_word(line + at, length, lost_keys[k]))
                files->lost_mtl_keys[k]++;
        words++;
        at += length;
    }
}

void gw_import_mtl_scan(const uint8_t *data, size_t size, gw_import_files *files) {
    for (size_t at = 0; at < size;) {
        size_t length = 0;
        while (at + length < size && data[at + length] != '\n')
            length++;
        scan_line(data + at, length, files);
        at += length + 1;
    }
}

typedef enum loss { MIRRORS, SHADOWS, FILTERS, DULL_MAPS, LOSSES } loss;

static int has_loss(const struct aiMaterial *from, int illum, const gw_material_source *source, loss which) {
    struct aiColor4D filter = {0, 0, 0, 1};
    struct aiString path;
    const int seen_through = gw_import_float(from, "$mat.opacity", 1.0f) < 1.0f;
    switch (which) {
    case MIRRORS:
        return illum == REFLECTION || illum == FRESNEL_MIRROR || illum == MIRROR_UNTRACED;
    case SHADOWS:
        return illum == SHADOWS_ONLY;
    case FILTERS:
        return gw_import_color(from, "$clr.transparent", &filter) && seen_through && !traces_glass(illum) &&
               !is_black(&filter) && !(filter.r >= 1 && filter.g >= 1 && filter.b >= 1);
    case DULL_MAPS:
        return (source->maps[GW_MAP_SPECULAR_COLOR] < 0 &&
                aiGetMaterialString(from, AI_MATKEY_TEXTURE(aiTextureType_SPECULAR, 0), &path) ==
                    aiReturn_SUCCESS) ||
               (source->maps[GW_MAP_ROUGHNESS_ALONE] < 0 &&
                aiGetMaterialString(from, AI_MATKEY_TEXTURE(aiTextureType_SHININESS, 0), &path) ==
                    aiReturn_SUCCESS);
    default:
        return 0;
    }
}

static gw_code note_keys(const gw_import_files *files, gw_scene *scene, gw_error *error) {
    gw_code code = GW_OK;
    for (int k = 0; code == GW_OK && k < GW_MTL_LOST_KEYS; k++)
        if (files->lost_mtl_keys[k] > 0)
            code = gw_scene_note(scene, error, "MTL: %s, %u times in the material files: not carried",
                                 lost_keys[k], files->lost_mtl_keys[k]);
    return code;
}

gw_code gw_import_mtl_notes(const struct aiScene *read, const gw_import_files *files, gw_source_model *model,
                            gw_error *error) {
    static const char *const words[LOSSES] = {
        [MIRRORS] = "illum 3, 5 or 8: reflect as their highlight does, mirrors are no more than metal (Pm)",
        [SHADOWS] = "illum 10: drawn like others",
        [FILTERS] = "Tf, but not illum 4, 6 or 7: what shines through is not tinted",
        [DULL_MAPS] = "map_Ks or map_Ns, but no highlight (illum, Ks, Ns) for it: left out"};
    gw_scene *scene = model->scene;
    uint32_t counts[LOSSES] = {0};
    uint8_t *seen = calloc((size_t)scene->material_count + 1, 1);
    if (!seen)
        return gw_fail(error, GW_MACHINE, "out of memory for materials in use");
    for (uint32_t i = 0; i < scene->triangle_count; i++) {
        const uint32_t m = scene->material_of[i];
        if (m >= scene->material_count || seen[m])
            continue;
        seen[m] = 1;
        const int illum = illum_of(read->mMaterials[m], files);
        for (int k = 0; k < LOSSES; k++)
            counts[k] += (uint32_t)has_loss(read->mMaterials[m], illum, &model->material_sources[m], (loss)k);
    }
    free(seen);
    gw_code code = note_keys(files, scene, error);
    for (int k = 0; code == GW_OK && k < LOSSES; k++)
        if (counts[k] > 0)
            code = gw_scene_note(scene, error, "MTL: %u materials with %s", counts[k], words[k]);
    return code;
}
