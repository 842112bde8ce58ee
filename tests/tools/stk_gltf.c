#include "tests/tools/stk_gltf.h"

#include "base/file.h"
#include "base/memory.h"
#include "tests/tools/stk_materials.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BYTE = 5121, UNSIGNED = 5125, FLOAT = 5126 };

typedef struct writer {
    const stk_scene *scene;
    stk_gltf_counts *counts;
    stk_materials materials;
    FILE *binary;
    uint64_t offset; /* bytes in it */
    json_t *views, *accessors, *meshes, *nodes, *lights;
    int32_t *mesh_of;           /* [model_count] -1: nothing of it can be seen */
    uint64_t *visible, *hidden; /* [model_count] triangles */
    gw_error *error;
} writer;

/* One array of a model into the binary file; its view's index, -1 when memory is out. All arrays are of
 * 4-byte words.
 */
static int put_view(writer *self, const void *data, size_t size) {
    fwrite(data, 1, size, self->binary);
    json_array_append_new(self->views, json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset",
                                                 (json_int_t)self->offset, "byteLength", (json_int_t)size));
    self->offset += size;
    return (int)json_array_size(self->views) - 1;
}

static json_t *put_accessor(writer *self, int view, size_t offset, int component, size_t count,
                            const char *type) {
    json_t *accessor =
        json_pack("{s:i, s:I, s:i, s:I, s:s}", "bufferView", view, "byteOffset", (json_int_t)offset,
                  "componentType", component, "count", (json_int_t)count, "type", type);
    json_array_append_new(self->accessors, accessor);
    return accessor;
}

static int last_accessor(const writer *self) {
    return (int)json_array_size(self->accessors) - 1;
}

static void put_bounds(json_t *accessor, float (*positions)[3], uint32_t count) {
    float low[3], high[3];
    memcpy(low, positions[0], sizeof low);
    memcpy(high, positions[0], sizeof high);
    for (uint32_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = positions[i][k] < low[k] ? positions[i][k] : low[k];
            high[k] = positions[i][k] > high[k] ? positions[i][k] : high[k];
        }
    json_object_set_new(accessor, "min", json_pack("[f,f,f]", low[0], low[1], low[2]));
    json_object_set_new(accessor, "max", json_pack("[f,f,f]", high[0], high[1], high[2]));
}

/* Views of a model's arrays. */
typedef struct model_views {
    int positions, normals, texcoords, colors, indices;
} model_views;

static gw_code put_primitive(writer *self, const stk_model *model, const stk_buffer *buffer,
                             const model_views *views, json_t *primitives) {
    const stk_mesh *mesh = &model->mesh;
    uint32_t material = 0;
    gw_code code = stk_materials_find(&self->materials, model->folder, mesh->textures[buffer->material],
                                      &material, self->error);
    if (code != GW_OK)
        return gw_context(self->error, "%s", model->path);
    size_t first = buffer->vertex_first, count = buffer->vertex_count;
    json_t *attributes = json_object();
    put_bounds(put_accessor(self, views->positions, first * 12, FLOAT, count, "VEC3"),
               mesh->positions + first, buffer->vertex_count);
    json_object_set_new(attributes, "POSITION", json_integer(last_accessor(self)));
    put_accessor(self, views->texcoords, first * 8, FLOAT, count, "VEC2");
    json_object_set_new(attributes, "TEXCOORD_0", json_integer(last_accessor(self)));
    if (mesh->has_normals) {
        put_accessor(self, views->normals, first * 12, FLOAT, count, "VEC3");
        json_object_set_new(attributes, "NORMAL", json_integer(last_accessor(self)));
    }
    if (mesh->has_colors) {
        json_object_set_new(put_accessor(self, views->colors, first * 4, BYTE, count, "VEC4"), "normalized",
                            json_true());
        json_object_set_new(attributes, "COLOR_0", json_integer(last_accessor(self)));
    }
    put_accessor(self, views->indices, (size_t)buffer->index_first * 4, UNSIGNED, buffer->index_count,
                 "SCALAR");
    json_t *primitive = json_pack("{s:o, s:i, s:i}", "attributes", attributes, "indices", last_accessor(self),
                                  "material", (int)material);
    return json_array_append_new(primitives, primitive) == 0
               ? GW_OK
               : gw_fail(self->error, GW_MACHINE, "out of memory for a mesh");
}

static gw_code put_model(writer *self, size_t index) {
    const stk_model *model = &self->scene->models[index];
    const stk_mesh *mesh = &model->mesh;
    gw_code code = GW_OK;
    self->mesh_of[index] = -1;
    for (size_t b = 0; b < mesh->buffer_count; b++) {
        int seen = mesh->textures[mesh->buffers[b].material][0] != '\0';
        *(seen ? &self->visible[index] : &self->hidden[index]) += mesh->buffers[b].index_count / 3;
    }
    if (self->visible[index] == 0)
        return GW_OK;
    model_views views = {.positions = put_view(self, mesh->positions, mesh->vertex_count * 12),
                         .texcoords = put_view(self, mesh->texcoords, mesh->vertex_count * 8),
                         .indices = put_view(self, mesh->indices, mesh->index_count * 4)};
    if (mesh->has_normals)
        views.normals = put_view(self, mesh->normals, mesh->vertex_count * 12);
    if (mesh->has_colors)
        views.colors = put_view(self, mesh->colors, mesh->vertex_count * 4);
    json_t *primitives = json_array();
    for (size_t b = 0; b < mesh->buffer_count && code == GW_OK; b++)
        if (mesh->buffers[b].index_count > 0 && mesh->textures[mesh->buffers[b].material][0])
            code = put_primitive(self, model, &mesh->buffers[b], &views, primitives);
    json_array_append_new(
        self->meshes, json_pack("{s:s, s:o}", "name", gw_path_name(model->path), "primitives", primitives));
    self->mesh_of[index] = (int32_t)json_array_size(self->meshes) - 1;
    return code;
}

static void put_instance(writer *self, const stk_instance *instance) {
    json_t *matrix = json_array(); /* by columns */
    self->counts->triangles += self->visible[instance->model];
    self->counts->hidden += self->hidden[instance->model];
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            json_array_append_new(matrix, json_real(r < 3 ? instance->matrix.m[r][c] : (double)(c == 3)));
    json_t *node = json_pack("{s:o}", "matrix", matrix);
    if (self->mesh_of[instance->model] >= 0)
        json_object_set_new(node, "mesh", json_integer(self->mesh_of[instance->model]));
    json_array_append_new(self->nodes, node);
}

static void put_light_node(writer *self, json_t *light, json_t *node) {
    json_array_append_new(self->lights, light);
    json_object_set_new(node, "name", json_sprintf("light %zu", json_array_size(self->lights)));
    json_object_set_new(
        node, "extensions",
        json_pack("{s:{s:i}}", "KHR_lights_punctual", "light", (int)json_array_size(self->lights) - 1));
    json_array_append_new(self->nodes, node);
}

/* A light shines along its node's -z: the shortest turn of (0,0,-1) to a direction. */
static json_t *turn_to(const double direction[3]) {
    double length = direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2];
    double unit[3], q[4];
    length = length > 0.0 ? sqrt(length) : 1.0;
    for (int i = 0; i < 3; i++)
        unit[i] = direction[i] / length;
    q[0] = unit[1];
    q[1] = -unit[0];
    q[2] = 0.0;
    q[3] = 1.0 - unit[2];
    length = sqrt(q[0] * q[0] + q[1] * q[1] + q[3] * q[3]);
    if (!(length > 1e-9))
        return json_pack("[f,f,f,f]", 1.0, 0.0, 0.0, 0.0); /* straight along +z: half a turn about x */
    return json_pack("[f,f,f,f]", q[0] / length, q[1] / length, 0.0, q[3] / length);
}

static void put_lights(writer *self) {
    const stk_scene *scene = self->scene;
    for (size_t i = 0; i < scene->light_count; i++) {
        const stk_light *l = &scene->lights[i];
        put_light_node(
            self,
            json_pack("{s:s, s:[f,f,f], s:f}", "type", "point", "color", l->color[0], l->color[1],
                      l->color[2], "intensity", l->intensity),
            json_pack("{s:[f,f,f]}", "translation", l->position[0], l->position[1], l->position[2]));
    }
    if (scene->sun_color[0] + scene->sun_color[1] + scene->sun_color[2] > 0.0f)
        put_light_node(self,
                       json_pack("{s:s, s:[f,f,f], s:f}", "type", "directional", "color", scene->sun_color[0],
                                 scene->sun_color[1], scene->sun_color[2], "intensity", 3.0),
                       json_pack("{s:o}", "rotation", turn_to(scene->sun_direction)));
}

static json_t *document(writer *self, const char *binary_name) {
    json_t *roots = json_array();
    for (size_t i = 0; i < json_array_size(self->nodes); i++)
        json_array_append_new(roots, json_integer((json_int_t)i));
    return json_pack(
        "{s:{s:s, s:s}, s:[s,s], s:{s:{s:O}}, s:i, s:[{s:o}], s:O, s:O, s:O, s:O, s:O, s:O, s:O, "
        "s:[{s:s, s:I}]}",
        "asset", "version", "2.0", "generator", "convert_supertuxkart", "extensionsUsed",
        "KHR_lights_punctual", "KHR_materials_unlit", "extensions", "KHR_lights_punctual", "lights",
        self->lights, "scene", 0, "scenes", "nodes", roots, "nodes", self->nodes, "meshes", self->meshes,
        "accessors", self->accessors, "bufferViews", self->views, "materials", self->materials.materials,
        "textures", self->materials.textures, "images", self->materials.images, "buffers", "uri", binary_name,
        "byteLength", (json_int_t)self->offset);
}

static gw_code write_document(writer *self, const char *folder, const char *name) {
    char binary_name[256], text_name[256];
    snprintf(binary_name, sizeof binary_name, "%.200s.bin", name);
    snprintf(text_name, sizeof text_name, "%.200s.gltf", name);
    char *path = gw_path_join(folder, text_name);
    json_t *root = document(self, binary_name);
    char *text = root ? json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(17)) : NULL;
    gw_code code = path && text ? gw_file_write(path, text, strlen(text), self->error)
                                : gw_fail(self->error, GW_MACHINE, "out of memory for the glTF text");
    json_decref(root);
    free(text);
    free(path);
    return code;
}

static gw_code write_all(writer *self, const char *folder, const char *name) {
    const stk_scene *scene = self->scene;
    gw_code code = stk_materials_start(scene, folder, &self->materials, self->error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self->mesh_of, scene->model_count, sizeof *self->mesh_of, "meshes",
                           self->error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self->visible, scene->model_count, sizeof *self->visible, "meshes",
                           self->error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self->hidden, scene->model_count, sizeof *self->hidden, "meshes",
                           self->error);
    for (size_t i = 0; i < scene->model_count && code == GW_OK; i++)
        code = put_model(self, i);
    for (size_t i = 0; i < scene->instance_count && code == GW_OK; i++)
        put_instance(self, &scene->instances[i]);
    if (code == GW_OK)
        put_lights(self);
    if (code == GW_OK && (fflush(self->binary) != 0 || ferror(self->binary)))
        code = gw_fail(self->error, GW_NO_OUTPUT, "%s/%s.bin could not be written", folder, name);
    if (code == GW_OK)
        code = write_document(self, folder, name);
    self->counts->materials = (uint32_t)self->materials.count;
    self->counts->textures = self->materials.texture_count;
    self->counts->missing = self->materials.missing;
    return code;
}

gw_code stk_gltf_write(const stk_scene *scene, const char *folder, const char *name, stk_gltf_counts *counts,
                       gw_error *error) {
    *counts = (stk_gltf_counts){0};
    writer self = {.scene = scene,
                   .counts = counts,
                   .views = json_array(),
                   .accessors = json_array(),
                   .meshes = json_array(),
                   .nodes = json_array(),
                   .lights = json_array(),
                   .error = error};
    char binary_name[256];
    snprintf(binary_name, sizeof binary_name, "%.200s.bin", name);
    char *path = gw_path_join(folder, binary_name);
    self.binary = path ? fopen(path, "wb") : NULL;
    gw_code code = self.binary ? write_all(&self, folder, name)
                               : gw_fail(error, GW_NO_OUTPUT, "%s/%s cannot be written", folder, binary_name);
    if (self.binary)
        fclose(self.binary);
    json_t *owned[] = {self.views, self.accessors, self.meshes, self.nodes, self.lights};
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++)
        json_decref(owned[i]);
    stk_materials_finish(&self.materials);
    free(self.mesh_of);
    free(self.visible);
    free(self.hidden);
    free(path);
    return code;
}
