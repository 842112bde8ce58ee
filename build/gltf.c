#include "build/gltf.h"

#include "build/model_path.h"

#include <stdlib.h>
#include <string.h>

enum { GLB_HEADER = 12, GLB_CHUNK_HEADER = 8 };
static const uint32_t glb_magic = 0x46546c67, glb_json = 0x4e4f534a, glb_bin = 0x004e4942;
static const json_int_t largest_size = (json_int_t)1
                                       << 48; /* products of two stay within 64 bits with a component */

static uint32_t read_u32(const uint8_t *data) {
    return (uint32_t)data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16 | (uint32_t)data[3] << 24;
}

/* --- the container --- */

/* Finds the JSON text (and the BIN chunk) of a .glb. */
static gw_code open_container(const uint8_t *data, size_t size, gw_gltf *out, const uint8_t **text,
                              size_t *text_size, gw_error *error) {
    const uint32_t version = read_u32(data + 4);
    const size_t length = read_u32(data + 8);
    if (version != 2)
        return gw_fail(error, GW_BAD_INPUT, "glTF version %u is not supported: export glTF 2.0", version);
    if (length > size)
        return gw_fail(error, GW_BAD_INPUT, "the .glb file is cut: its header promises %zu bytes, it has %zu",
                       length, size);
    size_t at = GLB_HEADER;
    for (int index = 0; at + GLB_CHUNK_HEADER <= length; index++) {
        const size_t chunk = read_u32(data + at);
        const uint32_t kind = read_u32(data + at + 4);
        at += GLB_CHUNK_HEADER;
        if (chunk > length - at)
            return gw_fail(error, GW_BAD_INPUT,
                           "the .glb file is damaged: chunk %d promises %zu bytes, %zu are left", index,
                           chunk, length - at);
        if (index == 0 && kind != glb_json)
            return gw_fail(error, GW_BAD_INPUT, "the .glb file is damaged: its first chunk is not JSON");
        if (index == 0) {
            *text = data + at;
            *text_size = chunk;
        } else if (kind == glb_bin && !out->chunk) {
            out->chunk = data + at;
            out->chunk_size = chunk;
        }
        at += chunk;
    }
    if (!*text)
        return gw_fail(error, GW_BAD_INPUT, "the .glb file is cut: it has no JSON chunk");
    out->binary = 1;
    return GW_OK;
}

/* --- typed access --- */

static const json_t *list(const gw_gltf *gltf, const char *name) {
    return json_object_get(gltf->root, name);
}

static json_int_t list_size(const gw_gltf *gltf, const char *name) {
    return (json_int_t)json_array_size(list(gltf, name));
}

/* A whole number of an object, or `missing` when it is absent. where and index name the object in messages.
 */
static gw_code get_size(const json_t *object, const char *key, const char *where, size_t index,
                        json_int_t missing, json_int_t *out, gw_error *error) {
    const json_t *value = json_object_get(object, key);
    *out = missing;
    if (!value)
        return GW_OK;
    if (!json_is_integer(value) || json_integer_value(value) < 0 || json_integer_value(value) > largest_size)
        return gw_fail(error, GW_BAD_INPUT, "glTF %s %zu: '%s' must be a whole number from 0 to 2^48", where,
                       index, key);
    *out = json_integer_value(value);
    return GW_OK;
}

/* An index into a top-level list; absent is fine. */
static gw_code check_index(const gw_gltf *gltf, const json_t *object, const char *key, const char *target,
                           const char *where, size_t index, gw_error *error) {
    json_int_t value;
    gw_code code = get_size(object, key, where, index, -1, &value, error);
    if (code == GW_OK && value >= list_size(gltf, target))
        code = gw_fail(error, GW_BAD_INPUT, "glTF %s %zu: '%s' is %lld, but the file has %lld %s", where,
                       index, key, (long long)value, (long long)list_size(gltf, target), target);
    return code;
}

static gw_code check_list_kinds(const gw_gltf *gltf, gw_error *error) {
    static const char *const names[] = {"accessors", "bufferViews", "buffers",   "meshes", "nodes",
                                        "scenes",    "materials",   "textures",  "images", "samplers",
                                        "cameras",   "skins",       "animations"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const json_t *value = list(gltf, names[i]);
        if (!value)
            continue;
        if (!json_is_array(value))
            return gw_fail(error, GW_BAD_INPUT, "glTF: '%s' must be a list", names[i]);
        for (size_t k = 0; k < json_array_size(value); k++)
            if (!json_is_object(json_array_get(value, k)))
                return gw_fail(error, GW_BAD_INPUT, "glTF: entry %zu of '%s' must be an object", k, names[i]);
    }
    return GW_OK;
}

/* --- buffers, views, accessors --- */

static gw_code external_size(const char *folder, const char *uri, size_t index, json_int_t *size,
                             gw_error *error) {
    char *path = NULL;
    char *name = strdup(uri);
    if (!name)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    gw_uri_decode(name);
    gw_code code = gw_model_path(folder, name, &path, error);
    FILE *file = code == GW_OK ? fopen(path, "rb") : NULL;
    if (code == GW_OK && (!file || fseeko(file, 0, SEEK_END) != 0))
        code = gw_fail(error, GW_BAD_INPUT, "glTF buffer %zu: the file '%s' is missing or cannot be read",
                       index, path);
    if (code == GW_OK)
        *size = (json_int_t)ftello(file);
    if (file)
        fclose(file);
    free(path);
    free(name);
    return code;
}

static gw_code check_buffer(const gw_gltf *gltf, const char *folder, size_t index, gw_error *error) {
    const json_t *buffer = json_array_get(list(gltf, "buffers"), index);
    const char *uri = json_string_value(json_object_get(buffer, "uri"));
    json_int_t promised, present = -1;
    gw_code code = get_size(buffer, "byteLength", "buffer", index, 0, &promised, error);
    if (code != GW_OK)
        return code;
    if (!uri && gltf->binary && index == 0)
        present = (json_int_t)gltf->chunk_size;
    else if (uri && strncmp(uri, "data:", 5) == 0)
        present = (json_int_t)(strlen(uri) - strcspn(uri, ",")) * 3 / 4;
    else if (uri && folder)
        code = external_size(folder, uri, index, &present, error);
    else if (!uri && promised > 0)
        return gw_fail(error, GW_BAD_INPUT,
                       "glTF buffer %zu names no file and the file has no binary chunk for it", index);
    else
        present = promised;
    if (code == GW_OK && present < promised)
        code = gw_fail(error, GW_BAD_INPUT,
                       "glTF buffer %zu%s%.200s is cut: %lld bytes are promised, %lld are there", index,
                       uri && uri[0] != 'd' ? " " : "", uri && strncmp(uri, "data:", 5) != 0 ? uri : "",
                       (long long)promised, (long long)present);
    return code;
}

static gw_code check_view(const gw_gltf *gltf, size_t index, gw_error *error) {
    const json_t *view = json_array_get(list(gltf, "bufferViews"), index);
    json_int_t offset = 0, length = 0, whole = 0;
    gw_code code = check_index(gltf, view, "buffer", "buffers", "bufferView", index, error);
    if (code == GW_OK && !json_object_get(view, "buffer"))
        code = gw_fail(error, GW_BAD_INPUT, "glTF bufferView %zu names no buffer", index);
    if (code == GW_OK)
        code = get_size(view, "byteOffset", "bufferView", index, 0, &offset, error);
    if (code == GW_OK)
        code = get_size(view, "byteLength", "bufferView", index, 0, &length, error);
    if (code != GW_OK)
        return code;
    const json_int_t buffer = json_integer_value(json_object_get(view, "buffer"));
    code = get_size(json_array_get(list(gltf, "buffers"), (size_t)buffer), "byteLength", "buffer",
                    (size_t)buffer, 0, &whole, error);
    if (code == GW_OK && offset + length > whole)
        code = gw_fail(error, GW_BAD_INPUT, "glTF bufferView %zu ends at byte %lld, but buffer %lld has %lld",
                       index, (long long)(offset + length), (long long)buffer, (long long)whole);
    return code;
}

static json_int_t component_bytes(json_int_t kind) {
    switch (kind) {
    case 5120:
    case 5121:
        return 1;
    case 5122:
    case 5123:
        return 2;
    case 5125:
    case 5126:
        return 4;
    default:
        return 0;
    }
}

static json_int_t element_components(const char *type) {
    static const struct {
        const char *name;
        json_int_t count;
    } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                 {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++)
        if (strcmp(type, types[i].name) == 0)
            return types[i].count;
    return 0;
}

/* count elements of `bytes` each, starting at the object's byteOffset in its bufferView, stay inside the
 * view. */
static gw_code check_extent(const gw_gltf *gltf, const json_t *object, json_int_t count, json_int_t bytes,
                            size_t index, gw_error *error) {
    json_int_t offset = 0, stride = 0, length = 0, view_index = -1;
    gw_code code = check_index(gltf, object, "bufferView", "bufferViews", "accessor", index, error);
    if (code == GW_OK)
        code = get_size(object, "bufferView", "accessor", index, -1, &view_index, error);
    if (code == GW_OK)
        code = get_size(object, "byteOffset", "accessor", index, 0, &offset, error);
    if (code != GW_OK || view_index < 0)
        return code;
    const json_t *view = json_array_get(list(gltf, "bufferViews"), (size_t)view_index);
    code = get_size(view, "byteStride", "bufferView", (size_t)view_index, bytes, &stride, error);
    if (code == GW_OK)
        code = get_size(view, "byteLength", "bufferView", (size_t)view_index, 0, &length, error);
    if (code != GW_OK || count == 0)
        return code;
    if (stride > 65536 || count > largest_size / 65536 || offset + (count - 1) * stride + bytes > length)
        return gw_fail(
            error, GW_BAD_INPUT,
            "glTF accessor %zu needs %lld elements of %lld bytes, more than bufferView %lld holds (%lld "
            "bytes)",
            index, (long long)count, (long long)bytes, (long long)view_index, (long long)length);
    return GW_OK;
}

static gw_code check_accessor(const gw_gltf *gltf, size_t index, gw_error *error) {
    const json_t *accessor = json_array_get(list(gltf, "accessors"), index);
    const json_t *sparse = json_object_get(accessor, "sparse");
    json_int_t kind = 0, count = 0;
    gw_code code = get_size(accessor, "componentType", "accessor", index, 0, &kind, error);
    if (code == GW_OK)
        code = get_size(accessor, "count", "accessor", index, 0, &count, error);
    if (code != GW_OK)
        return code;
    const json_int_t components = element_components(json_string_value(json_object_get(accessor, "type")));
    const json_int_t bytes = component_bytes(kind) * components;
    if (bytes == 0)
        return gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu has an unknown type or componentType", index);
    code = check_extent(gltf, accessor, count, bytes, index, error);
    if (code != GW_OK || !sparse)
        return code;
    const json_t *indices = json_object_get(sparse, "indices"), *values = json_object_get(sparse, "values");
    json_int_t sparse_count = 0, index_kind = 0;
    code = get_size(sparse, "count", "sparse accessor", index, 0, &sparse_count, error);
    if (code == GW_OK)
        code = get_size(indices, "componentType", "sparse accessor", index, 0, &index_kind, error);
    if (code == GW_OK && component_bytes(index_kind) == 0)
        code =
            gw_fail(error, GW_BAD_INPUT, "glTF accessor %zu: its sparse indices have an unknown type", index);
    if (code == GW_OK)
        code = check_extent(gltf, indices, sparse_count, component_bytes(index_kind), index, error);
    if (code == GW_OK)
        code = check_extent(gltf, values, sparse_count, bytes, index, error);
    return code;
}

/* --- what leads to accessors and pictures --- */

static gw_code check_mesh(const gw_gltf *gltf, size_t index, gw_error *error) {
    const json_t *primitives = json_object_get(json_array_get(list(gltf, "meshes"), index), "primitives");
    if (!json_is_array(primitives))
        return gw_fail(error, GW_BAD_INPUT, "glTF mesh %zu has no list of primitives", index);
    for (size_t i = 0; i < json_array_size(primitives); i++) {
        json_t *primitive = json_array_get(primitives, i);
        json_t *attributes = json_object_get(primitive, "attributes");
        const char *name;
        json_t *value;
        if (!json_is_object(attributes))
            return gw_fail(error, GW_BAD_INPUT, "glTF mesh %zu: primitive %zu has no attributes", index, i);
        gw_code code = check_index(gltf, primitive, "indices", "accessors", "mesh", index, error);
        if (code == GW_OK)
            code = check_index(gltf, primitive, "material", "materials", "mesh", index, error);
        json_object_foreach(attributes, name, value) {
            if (code == GW_OK)
                code = check_index(gltf, attributes, name, "accessors", "mesh", index, error);
        }
        if (code != GW_OK)
            return code;
    }
    return GW_OK;
}

/* Children must form trees: assimp follows them without looking for circles. */
static gw_code count_parents(const gw_gltf *gltf, uint8_t *parents, gw_error *error) {
    const json_t *nodes = list(gltf, "nodes");
    for (size_t i = 0; i < json_array_size(nodes); i++) {
        const json_t *children = json_object_get(json_array_get(nodes, i), "children");
        for (size_t k = 0; k < json_array_size(children); k++) {
            const json_t *child = json_array_get(children, k);
            const json_int_t target = json_is_integer(child) ? json_integer_value(child) : -1;
            if (target < 0 || target >= list_size(gltf, "nodes"))
                return gw_fail(error, GW_BAD_INPUT,
                               "glTF node %zu: child %zu is not one of the file's %lld nodes", i, k,
                               (long long)list_size(gltf, "nodes"));
            if (parents[target]++)
                return gw_fail(error, GW_BAD_INPUT, "glTF node %lld has two parents", (long long)target);
        }
    }
    return GW_OK;
}

static gw_code check_nodes(const gw_gltf *gltf, gw_error *error) {
    const size_t count = json_array_size(list(gltf, "nodes"));
    uint8_t *parents = calloc(count + 1, 1);
    if (!parents)
        return gw_fail(error, GW_MACHINE, "out of memory for the node graph");
    gw_code code = count_parents(gltf, parents, error);
    for (size_t i = 0; code == GW_OK && i < count; i++)
        code = check_index(gltf, json_array_get(list(gltf, "nodes"), i), "mesh", "meshes", "node", i, error);
    for (size_t i = 0; code == GW_OK && i < json_array_size(list(gltf, "scenes")); i++) {
        const json_t *roots = json_object_get(json_array_get(list(gltf, "scenes"), i), "nodes");
        for (size_t k = 0; code == GW_OK && k < json_array_size(roots); k++) {
            const json_t *root = json_array_get(roots, k);
            const json_int_t target = json_is_integer(root) ? json_integer_value(root) : -1;
            if (target < 0 || target >= (json_int_t)count)
                code = gw_fail(error, GW_BAD_INPUT, "glTF scene %zu names a node that is not there", i);
            else if (parents[target])
                code = gw_fail(
                    error, GW_BAD_INPUT,
                    "glTF scene %zu starts at node %lld, which is another node's child (or in a circle)", i,
                    (long long)target);
        }
    }
    if (code == GW_OK)
        code = check_index(gltf, gltf->root, "scene", "scenes", "file", 0, error);
    free(parents);
    return code;
}

static gw_code check_pictures(const gw_gltf *gltf, gw_error *error) {
    gw_code code = GW_OK;
    for (size_t i = 0; code == GW_OK && i < json_array_size(list(gltf, "textures")); i++) {
        const json_t *texture = json_array_get(list(gltf, "textures"), i);
        code = check_index(gltf, texture, "source", "images", "texture", i, error);
        if (code == GW_OK)
            code = check_index(gltf, texture, "sampler", "samplers", "texture", i, error);
    }
    for (size_t i = 0; code == GW_OK && i < json_array_size(list(gltf, "images")); i++)
        code = check_index(gltf, json_array_get(list(gltf, "images"), i), "bufferView", "bufferViews",
                           "image", i, error);
    return code;
}

static gw_code check_document(const gw_gltf *gltf, const char *folder, gw_error *error) {
    const char *version = json_string_value(json_object_get(json_object_get(gltf->root, "asset"), "version"));
    if (!version || strncmp(version, "2.", 2) != 0)
        return gw_fail(error, GW_BAD_INPUT, "glTF version '%.20s' is not supported: export glTF 2.0",
                       version ? version : "(none)");
    gw_code code = check_list_kinds(gltf, error);
    for (size_t i = 0; code == GW_OK && i < json_array_size(list(gltf, "buffers")); i++)
        code = check_buffer(gltf, folder, i, error);
    for (size_t i = 0; code == GW_OK && i < json_array_size(list(gltf, "bufferViews")); i++)
        code = check_view(gltf, i, error);
    for (size_t i = 0; code == GW_OK && i < json_array_size(list(gltf, "accessors")); i++)
        code = check_accessor(gltf, i, error);
    for (size_t i = 0; code == GW_OK && i < json_array_size(list(gltf, "meshes")); i++)
        code = check_mesh(gltf, i, error);
    if (code == GW_OK)
        code = check_nodes(gltf, error);
    if (code == GW_OK)
        code = check_pictures(gltf, error);
    return code;
}

gw_code gw_gltf_open(const void *data, size_t size, const char *folder, gw_gltf *out, gw_error *error) {
    *out = (gw_gltf){0};
    const uint8_t *text = data;
    size_t text_size = size;
    gw_code code = GW_OK;
    if (size >= GLB_HEADER && read_u32(data) == glb_magic) {
        text = NULL;
        code = open_container(data, size, out, &text, &text_size, error);
    }
    if (code != GW_OK)
        return code;
    json_error_t problem;
    out->root = json_loadb((const char *)text, text_size, JSON_DISABLE_EOF_CHECK, &problem);
    if (!out->root)
        return gw_fail(error, GW_BAD_INPUT, "the glTF text is broken at line %d, column %d: %s", problem.line,
                       problem.column, problem.text);
    if (!json_is_object(out->root))
        code = gw_fail(error, GW_BAD_INPUT, "the glTF text is not an object");
    if (code == GW_OK)
        code = check_document(out, folder, error);
    if (code != GW_OK)
        gw_gltf_close(out);
    return code;
}

void gw_gltf_close(gw_gltf *gltf) {
    json_decref(gltf->root);
    *gltf = (gw_gltf){0};
}
