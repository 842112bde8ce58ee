/* Ties the vertices of a glTF model to the nodes and skins that carry them. */
#include "build/gltf_motion.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is known of one file's nodes and skins while its spans are read. */
typedef struct binder {
    gw_gltf_motion *motion;
    uint32_t *node_binding; /* [animation nodes] of rigid vertices; 0: none yet */
    uint32_t *skin_joint;   /* [skins] first joint + 1; 0: not read yet */
    uint32_t crowded;       /* spans with more than four joints to the vertex */
} binder;

/* A span while it is read: the accessors of its primitive. */
typedef struct span_data {
    const gw_vertex_span *span;
    const json_t *node, *attributes;
    int64_t skin; /* -1: none that can be used */
} span_data;

static const json_t *entry(const binder *self, const char *list, size_t index) {
    return json_array_get(json_object_get(self->motion->gltf->root, list), index);
}

static size_t list_size(const binder *self, const char *list) {
    return json_array_size(json_object_get(self->motion->gltf->root, list));
}

static gw_code add_joint(binder *self, uint32_t node, const float *inverse_bind, gw_error *error) {
    static const double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    gw_animation *a = self->motion->animation;
    gw_code code = gw_grow((void **)&a->joints, &self->motion->joint_capacity, (size_t)a->joint_count + 1,
                           sizeof *a->joints, "joints", error);
    if (code != GW_OK)
        return code;
    gw_motion_joint *joint = &a->joints[a->joint_count++];
    *joint = (gw_motion_joint){.node = node};
    memcpy(joint->inverse_bind, identity, sizeof identity);
    for (int i = 0; inverse_bind && i < 3; i++)
        for (int k = 0; k < 4; k++)
            joint->inverse_bind[i][k] = (double)inverse_bind[k * 4 + i];
    return GW_OK;
}

static gw_code add_binding(binder *self, const gw_binding *binding, gw_error *error) {
    gw_animation *a = self->motion->animation;
    gw_code code = gw_grow((void **)&a->bindings, &self->motion->binding_capacity,
                           (size_t)a->binding_count + 1, sizeof *a->bindings, "bindings", error);
    if (code == GW_OK)
        a->bindings[a->binding_count++] = *binding;
    return code;
}

/* --- skins --- */

static gw_code read_skin(binder *self, size_t index, gw_error *error) {
    const json_t *skin = entry(self, "skins", index), *joints = json_object_get(skin, "joints");
    const size_t count = json_array_size(joints);
    float *matrices = NULL;
    size_t matrix_count = 0;
    int64_t accessor = -1;
    gw_code code = gw_gltf_index(skin, "inverseBindMatrices", list_size(self, "accessors"), &accessor, error);
    if (code == GW_OK && accessor >= 0)
        code = gw_gltf_numbers(&self->motion->data, (size_t)accessor, 16, "inverse bind matrices", &matrices,
                               &matrix_count, error);
    if (code == GW_OK && (count == 0 || (matrices && matrix_count < count)))
        code = gw_fail(error, GW_BAD_INPUT, "glTF skin %zu has %zu joints and %zu inverse bind matrices",
                       index, count, matrix_count);
    self->skin_joint[index] = self->motion->animation->joint_count + 1;
    for (size_t i = 0; code == GW_OK && i < count; i++) {
        const json_t *joint = json_array_get(joints, i);
        const json_int_t node = json_is_integer(joint) ? json_integer_value(joint) : -1;
        if (node < 0 || node >= (json_int_t)self->motion->node_count || self->motion->place_of[node] < 0)
            code =
                gw_fail(error, GW_BAD_INPUT, "glTF skin %zu: joint %zu is not a node of the scene", index, i);
        else
            code = add_joint(self, (uint32_t)self->motion->place_of[node],
                             matrices ? matrices + i * 16 : NULL, error);
    }
    free(matrices);
    return code;
}

/* Joints in rising order, no weight of zero, weights that add up to 1: equal ways of hanging become equal
 * bytes. */
static void clean_binding(const uint32_t joints[4], const float weights[4], uint32_t first, gw_binding *out) {
    double sum = 0.0;
    *out = (gw_binding){0};
    for (int i = 0; i < GW_VERTEX_JOINTS; i++) {
        if (!(weights[i] > 0.0f))
            continue;
        uint32_t at = out->count++;
        for (; at > 0 && out->joints[at - 1] > first + joints[i]; at--) {
            out->joints[at] = out->joints[at - 1];
            out->weights[at] = out->weights[at - 1];
        }
        out->joints[at] = first + joints[i];
        out->weights[at] = weights[i];
    }
    for (uint32_t i = 0; i < out->count; i++)
        sum += (double)out->weights[i];
    for (uint32_t i = 0; i < out->count; i++)
        out->weights[i] = (float)((double)out->weights[i] / sum);
    if (out->count == 0) { /* hangs on nothing: on the first joint, then */
        out->count = 1;
        out->joints[0] = first;
        out->weights[0] = 1.0f;
    }
}

static gw_code bind_to_skin(binder *self, const span_data *part, gw_error *error) {
    gw_animation *a = self->motion->animation;
    const size_t skin = (size_t)part->skin;
    const size_t accessors = list_size(self, "accessors");
    const size_t joint_limit = json_array_size(json_object_get(entry(self, "skins", skin), "joints"));
    int64_t joints_at = -1, weights_at = -1;
    uint32_t *joints = NULL;
    float *weights = NULL;
    size_t joint_rows = 0, weight_rows = 0;
    gw_code code = self->skin_joint[skin] ? GW_OK : read_skin(self, skin, error);
    if (code == GW_OK)
        code = gw_gltf_index(part->attributes, "JOINTS_0", accessors, &joints_at, error);
    if (code == GW_OK)
        code = gw_gltf_index(part->attributes, "WEIGHTS_0", accessors, &weights_at, error);
    if (code == GW_OK)
        code = gw_gltf_integers(&self->motion->data, (size_t)joints_at, 4, "joints", &joints, &joint_rows,
                                error);
    if (code == GW_OK)
        code = gw_gltf_numbers(&self->motion->data, (size_t)weights_at, 4, "weights", &weights, &weight_rows,
                               error);
    if (code == GW_OK && (joint_rows != part->span->count || weight_rows != part->span->count))
        code = gw_fail(error, GW_BAD_INPUT,
                       "glTF mesh %u: %zu joints and %zu weights do not fit its %u vertices",
                       part->span->mesh, joint_rows, weight_rows, part->span->count);
    for (uint32_t v = 0; code == GW_OK && v < part->span->count; v++) {
        gw_binding binding;
        for (int k = 0; k < 4; k++)
            if (joints[(size_t)v * 4 + (size_t)k] >= joint_limit)
                code = gw_fail(error, GW_BAD_INPUT, "glTF mesh %u: vertex %u hangs on joint %u of %zu",
                               part->span->mesh, v, joints[(size_t)v * 4 + (size_t)k], joint_limit);
        if (code != GW_OK)
            break;
        clean_binding(joints + (size_t)v * 4, weights + (size_t)v * 4, self->skin_joint[skin] - 1, &binding);
        code = add_binding(self, &binding, error);
        a->binding_of[part->span->first + v] = a->binding_count - 1;
    }
    self->crowded += json_object_get(part->attributes, "JOINTS_1") != NULL;
    free(joints);
    free(weights);
    return code;
}

/* --- spans --- */

static gw_code bind_to_node(binder *self, const span_data *part, uint32_t node, gw_error *error) {
    gw_animation *a = self->motion->animation;
    gw_code code = GW_OK;
    if (!self->node_binding[node]) {
        const gw_binding binding = {.count = 1, .joints = {a->joint_count}, .weights = {1.0f}};
        code = add_joint(self, node, NULL, error);
        if (code == GW_OK)
            code = add_binding(self, &binding, error);
        self->node_binding[node] = a->binding_count - 1;
    }
    for (uint32_t v = 0; code == GW_OK && v < part->span->count; v++)
        a->binding_of[part->span->first + v] = self->node_binding[node];
    return code;
}

/* Positions and normals as the file has them, before any transform. */
static gw_code read_shape(binder *self, const span_data *part, gw_error *error) {
    gw_animation *a = self->motion->animation;
    const gw_vertex_span *span = part->span;
    const size_t accessors = list_size(self, "accessors");
    int64_t positions_at = -1, normals_at = -1;
    float *positions = NULL, *normals = NULL;
    size_t position_count = 0, normal_count = 0;
    gw_code code = gw_gltf_index(part->attributes, "POSITION", accessors, &positions_at, error);
    if (code == GW_OK)
        code = gw_gltf_index(part->attributes, "NORMAL", accessors, &normals_at, error);
    if (code == GW_OK && positions_at >= 0)
        code = gw_gltf_numbers(&self->motion->data, (size_t)positions_at, 3, "positions", &positions,
                               &position_count, error);
    if (code == GW_OK && normals_at >= 0)
        code = gw_gltf_numbers(&self->motion->data, (size_t)normals_at, 3, "normals", &normals, &normal_count,
                               error);
    if (code == GW_OK && (position_count != span->count || (normals && normal_count != span->count)))
        code = gw_fail(error, GW_BAD_INPUT,
                       "glTF mesh %u, primitive %u has %zu positions and %zu normals, %u vertices were read",
                       span->mesh, span->primitive, position_count, normal_count, span->count);
    for (size_t i = 0; code == GW_OK && i < (size_t)span->count * 3; i++)
        a->bind_positions[(size_t)span->first * 3 + i] = (double)positions[i];
    if (code == GW_OK && normals)
        memcpy(a->bind_normals + (size_t)span->first * 3, normals, (size_t)span->count * 3 * sizeof *normals);
    else if (code == GW_OK)
        memset(a->bind_normals + (size_t)span->first * 3, 0, (size_t)span->count * 3 * sizeof *normals);
    free(positions);
    free(normals);
    return code;
}

static gw_code find_span(const binder *self, const gw_vertex_span *span, span_data *out, gw_error *error) {
    const json_t *primitives = json_object_get(entry(self, "meshes", span->mesh), "primitives");
    *out =
        (span_data){.span = span,
                    .node = entry(self, "nodes", span->node),
                    .attributes = json_object_get(json_array_get(primitives, span->primitive), "attributes"),
                    .skin = -1};
    if (!out->node || !out->attributes)
        return gw_fail(error, GW_BAD_INPUT, "glTF: node %u with mesh %u, primitive %u is not in the file",
                       span->node, span->mesh, span->primitive);
    if (!json_object_get(out->attributes, "JOINTS_0") || !json_object_get(out->attributes, "WEIGHTS_0"))
        return GW_OK;
    return gw_gltf_index(out->node, "skin", list_size(self, "skins"), &out->skin, error);
}

static gw_code bind_span(binder *self, const gw_vertex_span *span, gw_error *error) {
    span_data part;
    gw_code code = find_span(self, span, &part, error);
    if (code != GW_OK || span->count == 0)
        return code;
    const int32_t node = self->motion->place_of[span->node];
    const int moves = node >= 0 && self->motion->moving[node];
    if (part.skin < 0 && !moves)
        return GW_OK;
    code = read_shape(self, &part, error);
    if (code != GW_OK)
        return code;
    return part.skin >= 0 ? bind_to_skin(self, &part, error)
                          : bind_to_node(self, &part, (uint32_t)node, error);
}

gw_code gw_gltf_bind_vertices(gw_gltf_motion *motion, gw_error *error) {
    binder self = {.motion = motion};
    gw_code code = gw_allocate((void **)&self.node_binding, motion->animation->node_count,
                               sizeof *self.node_binding, "bindings", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self.skin_joint, list_size(&self, "skins"), sizeof *self.skin_joint,
                           "skins", error);
    for (uint32_t i = 0; code == GW_OK && i < motion->model->span_count; i++)
        code = bind_span(&self, &motion->model->spans[i], error);
    if (code == GW_OK && self.crowded)
        code = gw_scene_note(
            motion->model->scene, error,
            "glTF: %u meshes hang on more than four joints to the vertex: on the first four here",
            self.crowded);
    free(self.node_binding);
    free(self.skin_joint);
    return code;
}
