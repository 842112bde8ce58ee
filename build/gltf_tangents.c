#include "build/gltf_tangents.h"

#include "build/gltf_material.h"

#include <string.h>

typedef enum use { NONE, UNREAD, MOVING, MISSHAPEN, USED, USES } use;

static const json_t *accessor_of(const gw_gltf *gltf, const json_t *attributes, const char *name) {
    const json_t *index = json_object_get(attributes, name);
    return json_is_integer(index)
               ? json_array_get(json_object_get(gltf->root, "accessors"), (size_t)json_integer_value(index))
               : NULL;
}

static json_int_t number(const json_t *accessor, const char *key) {
    return json_integer_value(json_object_get(accessor, key));
}

/* The standard has them ignored where there is no normal. */
static int fits(const gw_gltf *gltf, const json_t *attributes) {
    enum { FLOAT = 5126 };
    const json_t *tangents = accessor_of(gltf, attributes, "TANGENT");
    const char *type = json_string_value(json_object_get(tangents, "type"));
    return type && strcmp(type, "VEC4") == 0 && number(tangents, "componentType") == FLOAT &&
           number(tangents, "count") == number(accessor_of(gltf, attributes, "POSITION"), "count") &&
           json_object_get(attributes, "NORMAL");
}

static use use_of(const gw_gltf *gltf, const json_t *primitive) {
    const json_t *attributes = json_object_get(primitive, "attributes"),
                 *index = json_object_get(primitive, "material");
    const json_t *material = json_is_integer(index) ? json_array_get(json_object_get(gltf->root, "materials"),
                                                                     (size_t)json_integer_value(index))
                                                    : NULL;
    if (!json_object_get(attributes, "TANGENT"))
        return NONE;
    if (!gw_gltf_map(material, GW_MAP_NORMAL) && !gw_gltf_map(material, GW_MAP_CLEARCOAT_NORMAL))
        return UNREAD;
    if (gw_gltf_moves(gltf))
        return MOVING;
    return fits(gltf, attributes) ? USED : MISSHAPEN;
}

/* Counts, and takes out what is not used if asked to. */
static void walk(const gw_gltf *gltf, int strip, size_t counts[USES]) {
    const json_t *meshes = json_object_get(gltf->root, "meshes");
    for (size_t i = 0; i < json_array_size(meshes); i++) {
        const json_t *primitives = json_object_get(json_array_get(meshes, i), "primitives");
        for (size_t k = 0; k < json_array_size(primitives); k++) {
            const json_t *primitive = json_array_get(primitives, k);
            const use found = use_of(gltf, primitive);
            counts[found]++;
            if (strip && found != NONE && found != USED)
                json_object_del(json_object_get(primitive, "attributes"), "TANGENT");
        }
    }
}

void gw_gltf_strip_tangents(gw_gltf *gltf) {
    size_t counts[USES] = {0};
    walk(gltf, 1, counts);
}

gw_code gw_gltf_note_tangents(const gw_gltf *gltf, gw_scene *scene, gw_error *error) {
    static const char *const whose[USES] = {
        [MOVING] = "in a file where something moves",
        [MISSHAPEN] = "that are not a vec4 of floats for each vertex beside its normal"};
    size_t counts[USES] = {0};
    gw_code code = GW_OK;
    walk(gltf, 0, counts);
    for (int i = 0; i < USES && code == GW_OK; i++)
        if (whose[i] && counts[i] > 0)
            code = gw_scene_note(scene, error,
                                 "glTF: %zu primitives with a normal map and tangents %s: those of their "
                                 "texture coordinates are used",
                                 counts[i], whose[i]);
    return code;
}
