#include "build/animation.h"

#include "base/memory.h"
#include "build/matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void gw_animation_destroy(gw_animation **address) {
    if (!address || !*address)
        return;
    gw_animation *animation = *address;
    if (!animation->borrowed) {
        free(animation->clips);
        free(animation->nodes);
        free(animation->channels);
        free(animation->times);
        free(animation->values);
        free(animation->joints);
        free(animation->bindings);
        free(animation->binding_of);
        free(animation->bind_positions);
        free(animation->bind_normals);
    }
    free(animation);
    *address = NULL;
}

gw_code gw_animation_still(uint32_t vertex_count, const double *positions, const float *normals,
                           gw_animation **out, gw_error *error) {
    gw_animation *made = NULL;
    *out = NULL;
    gw_code code = gw_allocate((void **)&made, 1, sizeof *made, "animation", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&made->bindings, 1, sizeof *made->bindings, "bindings", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&made->binding_of, vertex_count, sizeof *made->binding_of, "bindings",
                           error);
    if (code == GW_OK)
        code = gw_allocate((void **)&made->bind_positions, vertex_count, 3 * sizeof(double), "bind positions",
                           error);
    if (code == GW_OK)
        code =
            gw_allocate((void **)&made->bind_normals, vertex_count, 3 * sizeof(float), "bind normals", error);
    if (code != GW_OK) {
        gw_animation_destroy(&made);
        return code;
    }
    made->binding_count = 1;
    made->vertex_count = vertex_count;
    if (vertex_count > 0)
        memcpy(made->bind_positions, positions, (size_t)vertex_count * 3 * sizeof(double));
    if (vertex_count > 0 && normals)
        memcpy(made->bind_normals, normals, (size_t)vertex_count * 3 * sizeof(float));
    *out = made;
    return GW_OK;
}

static void transform_vertex(gw_animation *animation, uint32_t vertex, const double matrix[3][4],
                             const double cofactors[3][3]) {
    double *position = animation->bind_positions + (size_t)vertex * 3;
    float *normal = animation->bind_normals + (size_t)vertex * 3;
    gw_matrix_point(matrix, position, position);
    gw_matrix_normal(cofactors, normal, normal);
}

/* Vertices that stay are moved; the others get a node above all others. */
gw_code gw_animation_transform(gw_animation *animation, const double matrix[3][4], gw_error *error) {
    double cofactors[3][3];
    gw_motion_node *nodes = NULL;
    gw_code code = gw_allocate((void **)&nodes, (size_t)animation->node_count + 1, sizeof *nodes,
                               "animated nodes", error);
    if (code != GW_OK)
        return code;
    nodes[0].parent = -1;
    memcpy(nodes[0].matrix, matrix, sizeof nodes[0].matrix);
    for (uint32_t i = 0; i < animation->node_count; i++) {
        nodes[i + 1] = animation->nodes[i];
        nodes[i + 1].parent++; /* -1 becomes the new node */
    }
    free(animation->nodes);
    animation->nodes = nodes;
    animation->node_count++;
    for (uint32_t i = 0; i < animation->channel_count; i++)
        animation->channels[i].node++;
    for (uint32_t i = 0; i < animation->joint_count; i++)
        animation->joints[i].node++;
    gw_matrix_cofactors(matrix, cofactors);
    for (uint32_t v = 0; v < animation->vertex_count; v++)
        if (animation->bindings[animation->binding_of[v]].count == 0)
            transform_vertex(animation, v, matrix, (const double(*)[3])cofactors);
    return GW_OK;
}

/* Makes *target hold first + second rows. */
static gw_code join(void *target_address, size_t first, const void *part, size_t second, size_t row,
                    gw_error *error) {
    void **target = target_address;
    char *joined = NULL;
    gw_code code = gw_allocate((void **)&joined, first + second, row, "merged animations", error);
    if (code != GW_OK)
        return code;
    if (first > 0)
        memcpy(joined, *target, first * row);
    if (second > 0)
        memcpy(joined + first * row, part, second * row);
    free(*target);
    *target = joined;
    return GW_OK;
}

/* Indices of the part as they will be behind the target's. */
static void shift(gw_animation *part, const gw_animation *target) {
    for (uint32_t i = 0; i < part->node_count; i++)
        if (part->nodes[i].parent >= 0)
            part->nodes[i].parent += (int32_t)target->node_count;
    for (uint32_t i = 0; i < part->channel_count; i++) {
        gw_motion_channel *channel = &part->channels[i];
        channel->clip += target->clip_count;
        channel->node += target->node_count;
        channel->key_first += target->time_count;
        channel->value_first += target->value_count;
    }
    for (uint32_t i = 0; i < part->joint_count; i++)
        part->joints[i].node += target->node_count;
    for (uint32_t i = 0; i < part->binding_count; i++)
        for (uint32_t k = 0; k < part->bindings[i].count; k++)
            part->bindings[i].joints[k] += target->joint_count;
    for (uint32_t v = 0; v < part->vertex_count; v++)
        part->binding_of[v] += target->binding_count;
}

gw_code gw_animation_append(gw_animation *a, gw_animation *b, gw_error *error) {
    const uint64_t limit = INT32_MAX;
    if ((uint64_t)a->node_count + b->node_count > limit || (uint64_t)a->time_count + b->time_count > limit ||
        (uint64_t)a->value_count + b->value_count > limit)
        return gw_fail(error, GW_BAD_INPUT, "the models together have more keys than an animation can hold");
    shift(b, a);
    const struct {
        void *target, *part;
        size_t first, second, row;
    } rows[] = {
        {&a->clips, b->clips, a->clip_count, b->clip_count, sizeof *a->clips},
        {&a->nodes, b->nodes, a->node_count, b->node_count, sizeof *a->nodes},
        {&a->channels, b->channels, a->channel_count, b->channel_count, sizeof *a->channels},
        {&a->times, b->times, a->time_count, b->time_count, sizeof *a->times},
        {&a->values, b->values, a->value_count, b->value_count, sizeof *a->values},
        {&a->joints, b->joints, a->joint_count, b->joint_count, sizeof *a->joints},
        {&a->bindings, b->bindings, a->binding_count, b->binding_count, sizeof *a->bindings},
        {&a->binding_of, b->binding_of, a->vertex_count, b->vertex_count, sizeof *a->binding_of},
        {&a->bind_positions, b->bind_positions, a->vertex_count, b->vertex_count, 3 * sizeof(double)},
        {&a->bind_normals, b->bind_normals, a->vertex_count, b->vertex_count, 3 * sizeof(float)},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        gw_code code = join(rows[i].target, rows[i].first, rows[i].part, rows[i].second, rows[i].row, error);
        if (code != GW_OK)
            return code;
    }
    a->clip_count += b->clip_count;
    a->node_count += b->node_count;
    a->channel_count += b->channel_count;
    a->time_count += b->time_count;
    a->value_count += b->value_count;
    a->joint_count += b->joint_count;
    a->binding_count += b->binding_count;
    a->vertex_count += b->vertex_count;
    return GW_OK;
}

gw_hash gw_animation_hash(gw_hash hash, const gw_animation *a) {
    const struct {
        const void *rows;
        size_t count, row;
    } parts[] = {
        {a->nodes, a->node_count, sizeof *a->nodes},
        {a->channels, a->channel_count, sizeof *a->channels},
        {a->times, a->time_count, sizeof *a->times},
        {a->values, a->value_count, sizeof *a->values},
        {a->joints, a->joint_count, sizeof *a->joints},
        {a->bindings, a->binding_count, sizeof *a->bindings},
        {a->binding_of, a->vertex_count, sizeof *a->binding_of},
        {a->bind_positions, a->vertex_count, 3 * sizeof(double)},
        {a->bind_normals, a->vertex_count, 3 * sizeof(float)},
    };
    for (uint32_t i = 0; i < a->clip_count; i++) /* the name reaches no pixel */
        hash = gw_hash_bytes(hash, &a->clips[i].duration, sizeof a->clips[i].duration);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        hash = gw_hash_bytes(hash, parts[i].rows, parts[i].count * parts[i].row);
    return hash;
}

/* --- checks --- */

static int all_finite(const double *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return 0;
    return 1;
}

static int node_is_good(const gw_animation *a, uint32_t index) {
    const gw_motion_node *node = &a->nodes[index];
    return node->parent >= -1 && node->parent < (int32_t)index && all_finite(node->translation, 3) &&
           all_finite(node->rotation, 4) && all_finite(node->scale, 3) && all_finite(node->matrix[0], 12);
}

static int channel_is_good(const gw_animation *a, const gw_motion_channel *c) {
    const uint64_t width = (c->path == GW_MOVE_ROTATION ? 4u : 3u) * (c->curve == GW_CURVE_CUBIC ? 3u : 1u);
    if (c->clip >= a->clip_count || c->node >= a->node_count || !a->nodes[c->node].moves ||
        c->path > GW_MOVE_SCALE || c->curve > GW_CURVE_CUBIC || c->key_count < 1 ||
        (uint64_t)c->key_first + c->key_count > a->time_count ||
        c->value_first + width * c->key_count > a->value_count)
        return 0;
    const float *times = a->times + c->key_first;
    for (uint32_t i = 0; i < c->key_count; i++)
        if (!isfinite(times[i]) || (i > 0 && times[i] < times[i - 1]))
            return 0;
    return 1;
}

static int binding_is_good(const gw_animation *a, const gw_binding *binding) {
    if (binding->count > GW_VERTEX_JOINTS)
        return 0;
    for (uint32_t k = 0; k < binding->count; k++)
        if (binding->joints[k] >= a->joint_count ||
            !(binding->weights[k] >= 0.0f && binding->weights[k] <= 1.0f))
            return 0;
    return 1;
}

static const char *find_fault(const gw_animation *a) {
    for (uint32_t i = 0; i < a->clip_count; i++)
        if (!(a->clips[i].duration > 0.0 && a->clips[i].duration <= 1e9) ||
            !memchr(a->clips[i].name, 0, sizeof a->clips[i].name))
            return "a clip's length or name";
    for (uint32_t i = 0; i < a->node_count; i++)
        if (!node_is_good(a, i))
            return "a node";
    for (uint32_t i = 0; i < a->channel_count; i++)
        if (!channel_is_good(a, &a->channels[i]) || (i > 0 && a->channels[i].node < a->channels[i - 1].node))
            return "a channel";
    for (uint32_t i = 0; i < a->value_count; i++)
        if (!isfinite(a->values[i]))
            return "a key's value";
    for (uint32_t i = 0; i < a->joint_count; i++)
        if (a->joints[i].node >= a->node_count || !all_finite(a->joints[i].inverse_bind[0], 12))
            return "a joint";
    for (uint32_t i = 0; i < a->binding_count; i++)
        if (!binding_is_good(a, &a->bindings[i]))
            return "a vertex's joints or weights";
    for (uint32_t v = 0; v < a->vertex_count; v++)
        if (a->binding_of[v] >= a->binding_count)
            return "a vertex's binding";
    return a->binding_count < 1 || a->bindings[0].count != 0 ? "the first binding" : NULL;
}

gw_code gw_animation_check(const gw_animation *animation, gw_error *error) {
    const char *fault = find_fault(animation);
    return fault ? gw_fail(error, GW_BAD_INPUT, "the animation is damaged: %s is out of range", fault)
                 : GW_OK;
}
