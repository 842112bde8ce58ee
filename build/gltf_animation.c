#include "build/gltf_animation.h"

#include "base/memory.h"
#include "build/gltf_motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

gw_code gw_gltf_index(const json_t *object, const char *key, size_t limit, int64_t *out, gw_error *error) {
    const json_t *value = json_object_get(object, key);
    *out = -1;
    if (!value)
        return GW_OK;
    if (!json_is_integer(value) || json_integer_value(value) < 0 ||
        json_integer_value(value) >= (json_int_t)limit)
        return gw_fail(error, GW_BAD_INPUT, "glTF animation: '%s' is not a number below %zu", key, limit);
    *out = json_integer_value(value);
    return GW_OK;
}

static const json_t *list(const gw_gltf_motion *motion, const char *name) {
    return json_object_get(motion->gltf->root, name);
}

/* --- nodes --- */

static void read_numbers(const json_t *object, const char *key, size_t count, double *out) {
    const json_t *values = json_object_get(object, key);
    if (json_array_size(values) != count)
        return;
    for (size_t i = 0; i < count; i++) {
        const double value = json_number_value(json_array_get(values, i));
        out[i] = isfinite(value) ? value : 0.0;
    }
}

static void read_node(const json_t *source, int32_t parent, gw_motion_node *node) {
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    double columns[16];
    memcpy(columns, identity, sizeof columns);
    *node = (gw_motion_node){.parent = parent, .rotation = {0, 0, 0, 1}, .scale = {1, 1, 1}};
    read_numbers(source, "translation", 3, node->translation);
    read_numbers(source, "rotation", 4, node->rotation);
    read_numbers(source, "scale", 3, node->scale);
    read_numbers(source, "matrix", 16, columns);
    node->moves = json_object_get(source, "matrix") == NULL;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            node->matrix[i][k] = columns[k * 4 + i];
}

/* Marks the nodes that are somebody's child; gw_gltf_open has checked the indices. */
static void mark_children(const gw_gltf_motion *motion, uint8_t *is_child) {
    for (size_t i = 0; i < motion->node_count; i++) {
        const json_t *children = json_object_get(json_array_get(list(motion, "nodes"), i), "children");
        for (size_t k = 0; k < json_array_size(children); k++)
            is_child[json_integer_value(json_array_get(children, k))] = 1;
    }
}

/* Parents before children, breadth first from the roots; a node has one parent, so each comes up once. Nodes
 * in a circle never come up. */
static void order_nodes(gw_gltf_motion *motion, const uint8_t *is_child, uint32_t *source_of) {
    gw_animation *animation = motion->animation;
    const json_t *nodes = list(motion, "nodes");
    uint32_t count = 0;
    for (size_t i = 0; i < motion->node_count; i++) {
        motion->place_of[i] = -1;
        if (is_child[i])
            continue;
        read_node(json_array_get(nodes, i), -1, &animation->nodes[count]);
        source_of[count++] = (uint32_t)i;
    }
    for (uint32_t at = 0; at < count; at++) {
        const json_t *children = json_object_get(json_array_get(nodes, source_of[at]), "children");
        motion->place_of[source_of[at]] = (int32_t)at;
        for (size_t k = 0; k < json_array_size(children); k++) {
            const size_t child = (size_t)json_integer_value(json_array_get(children, k));
            read_node(json_array_get(nodes, child), (int32_t)at, &animation->nodes[count]);
            source_of[count++] = (uint32_t)child;
        }
    }
    animation->node_count = count;
}

static gw_code read_nodes(gw_gltf_motion *motion, gw_error *error) {
    uint8_t *is_child = NULL;
    uint32_t *source_of = NULL;
    const size_t count = motion->node_count;
    if (count > INT32_MAX / 2)
        return gw_fail(error, GW_BAD_INPUT, "glTF: %zu nodes are more than can be animated", count);
    gw_code code = gw_allocate((void **)&is_child, count, 1, "glTF nodes", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&source_of, count, sizeof *source_of, "glTF nodes", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&motion->place_of, count, sizeof *motion->place_of, "glTF nodes", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&motion->moving, count, 1, "glTF nodes", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&motion->animation->nodes, count, sizeof *motion->animation->nodes,
                           "animated nodes", error);
    if (code == GW_OK) {
        mark_children(motion, is_child);
        order_nodes(motion, is_child, source_of);
    }
    free(is_child);
    free(source_of);
    return code;
}

/* --- channels --- */

static gw_code choose_curve(const json_t *sampler, uint32_t *out, gw_error *error) {
    static const char *const names[] = {"STEP", "LINEAR", "CUBICSPLINE"};
    const json_t *value = json_object_get(sampler, "interpolation");
    *out = GW_CURVE_LINEAR;
    for (uint32_t i = 0; i < 3; i++)
        if (json_is_string(value) && strcmp(json_string_value(value), names[i]) == 0) {
            *out = i;
            return GW_OK;
        }
    return value ? gw_fail(error, GW_BAD_INPUT, "glTF animation: an interpolation is not known") : GW_OK;
}

static gw_code keep_keys(gw_gltf_motion *motion, const float *times, size_t keys, const float *values,
                         size_t value_count, gw_motion_channel *channel, gw_error *error) {
    gw_animation *a = motion->animation;
    if (a->time_count + (uint64_t)keys > INT32_MAX || a->value_count + (uint64_t)value_count > INT32_MAX)
        return gw_fail(error, GW_BAD_INPUT, "glTF: the animations have more keys than can be kept");
    gw_code code = gw_grow((void **)&a->times, &motion->time_capacity, a->time_count + keys, sizeof *a->times,
                           "animation keys", error);
    if (code == GW_OK)
        code = gw_grow((void **)&a->values, &motion->value_capacity, a->value_count + value_count,
                       sizeof *a->values, "animation keys", error);
    if (code == GW_OK)
        code = gw_grow((void **)&a->channels, &motion->channel_capacity, (size_t)a->channel_count + 1,
                       sizeof *a->channels, "animation channels", error);
    if (code != GW_OK)
        return code;
    channel->key_first = a->time_count;
    channel->key_count = (uint32_t)keys;
    channel->value_first = a->value_count;
    memcpy(a->times + a->time_count, times, keys * sizeof *times);
    memcpy(a->values + a->value_count, values, value_count * sizeof *values);
    a->time_count += (uint32_t)keys;
    a->value_count += (uint32_t)value_count;
    a->channels[a->channel_count++] = *channel;
    return GW_OK;
}

static gw_code check_keys(const float *times, size_t keys, size_t values, uint32_t curve, gw_error *error) {
    const size_t wanted = keys * (curve == GW_CURVE_CUBIC ? 3 : 1);
    for (size_t i = 0; i < keys; i++)
        if (times[i] < 0.0f || times[i] > 1e6f || (i > 0 && times[i] <= times[i - 1]))
            return gw_fail(error, GW_BAD_INPUT,
                           "glTF animation: the times of a sampler do not rise from 0 to 10^6 s");
    if (keys == 0 || values != wanted)
        return gw_fail(error, GW_BAD_INPUT, "glTF animation: a sampler has %zu values, %zu keys need %zu",
                       values, keys, wanted);
    return GW_OK;
}

static gw_code read_sampler(gw_gltf_motion *motion, const json_t *sampler, gw_motion_channel *channel,
                            gw_error *error) {
    const size_t accessors = json_array_size(list(motion, "accessors"));
    const size_t width = channel->path == GW_MOVE_ROTATION ? 4 : 3;
    int64_t input = -1, output = -1;
    float *times = NULL, *values = NULL;
    size_t keys = 0, value_count = 0;
    gw_code code = gw_gltf_index(sampler, "input", accessors, &input, error);
    if (code == GW_OK)
        code = gw_gltf_index(sampler, "output", accessors, &output, error);
    if (code == GW_OK && (input < 0 || output < 0))
        code = gw_fail(error, GW_BAD_INPUT, "glTF animation: a sampler lacks its input or output");
    if (code == GW_OK)
        code = choose_curve(sampler, &channel->curve, error);
    if (code == GW_OK)
        code = gw_gltf_numbers(&motion->data, (size_t)input, 1, "animation times", &times, &keys, error);
    if (code == GW_OK)
        code = gw_gltf_numbers(&motion->data, (size_t)output, width, "animation values", &values,
                               &value_count, error);
    if (code == GW_OK)
        code = check_keys(times, keys, value_count, channel->curve, error);
    if (code == GW_OK)
        code = keep_keys(motion, times, keys, values, value_count * width, channel, error);
    free(times);
    free(values);
    return code;
}

static gw_code read_channel(gw_gltf_motion *motion, const json_t *animation, const json_t *source,
                            gw_error *error) {
    static const char *const paths[] = {"translation", "rotation", "scale"};
    const json_t *target = json_object_get(source, "target"),
                 *samplers = json_object_get(animation, "samplers");
    const char *path = json_string_value(json_object_get(target, "path"));
    gw_motion_channel channel = {.clip = motion->animation->clip_count, .path = 3};
    int64_t node = -1, sampler = -1;
    gw_code code = gw_gltf_index(target, "node", motion->node_count, &node, error);
    if (code == GW_OK)
        code = gw_gltf_index(source, "sampler", json_array_size(samplers), &sampler, error);
    if (code != GW_OK)
        return code;
    for (uint32_t i = 0; path && i < 3; i++)
        if (strcmp(path, paths[i]) == 0)
            channel.path = i;
    motion->morphs += path && strcmp(path, "weights") == 0;
    if (node < 0 || sampler < 0 || channel.path == 3 || motion->place_of[node] < 0)
        return GW_OK; /* the standard lets such channels be; morphs are told */
    channel.node = (uint32_t)motion->place_of[node];
    motion->moving[channel.node] = 1;
    return read_sampler(motion, json_array_get(samplers, (size_t)sampler), &channel, error);
}

/* A clip with its channels; none of either when it moves nothing that is carried. */
static gw_code read_clip(gw_gltf_motion *motion, size_t index, gw_error *error) {
    gw_animation *a = motion->animation;
    const json_t *source = json_array_get(list(motion, "animations"), index);
    const json_t *channels = json_object_get(source, "channels");
    const char *name = json_string_value(json_object_get(source, "name"));
    const uint32_t first = a->channel_count;
    gw_motion_clip *clip = &a->clips[a->clip_count];
    gw_code code = GW_OK;
    for (size_t i = 0; code == GW_OK && i < json_array_size(channels); i++)
        code = read_channel(motion, source, json_array_get(channels, i), error);
    if (code != GW_OK || a->channel_count == first)
        return code;
    for (uint32_t i = first; i < a->channel_count; i++) {
        const gw_motion_channel *channel = &a->channels[i];
        clip->duration = fmax(clip->duration, (double)a->times[channel->key_first + channel->key_count - 1]);
    }
    if (clip->duration <= 0.0)
        clip->duration = 1.0; /* one key at time 0: nothing changes, for however long */
    snprintf(clip->name, sizeof clip->name, "%s", name ? name : "");
    a->clip_count++;
    return gw_scene_note(motion->model->scene, error, "glTF: animation %zu%s%.63s%s plays, %.4g s long",
                         index, name ? " '" : "", name ? name : "", name ? "'" : "", clip->duration);
}

/* In the order of nodes; those of one node keep theirs. */
static gw_code sort_channels(gw_animation *a, gw_error *error) {
    uint32_t *begin = NULL;
    gw_motion_channel *sorted = NULL;
    gw_code code =
        gw_allocate((void **)&begin, (size_t)a->node_count + 1, sizeof *begin, "animation channels", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&sorted, a->channel_count, sizeof *sorted, "animation channels", error);
    if (code != GW_OK) {
        free(begin);
        return code;
    }
    for (uint32_t i = 0; i < a->channel_count; i++)
        begin[a->channels[i].node + 1]++;
    for (uint32_t i = 0; i < a->node_count; i++)
        begin[i + 1] += begin[i];
    for (uint32_t i = 0; i < a->channel_count; i++)
        sorted[begin[a->channels[i].node]++] = a->channels[i];
    free(a->channels);
    free(begin);
    a->channels = sorted;
    return GW_OK;
}

/* A node with channels is placed by its translation, rotation and scale, any other by its matrix; what stands
 * under one that moves moves. */
static void settle_nodes(gw_gltf_motion *motion) {
    gw_animation *a = motion->animation;
    for (uint32_t i = 0; i < a->node_count; i++) {
        gw_motion_node *node = &a->nodes[i];
        node->moves |= motion->moving[i];
        if (node->parent >= 0)
            motion->moving[i] |= motion->moving[node->parent];
    }
}

/* --- the choice --- */

static gw_code find_animation(const gw_gltf_motion *motion, const char *choice, size_t *out,
                              gw_error *error) {
    const json_t *animations = list(motion, "animations");
    const size_t count = json_array_size(animations);
    for (size_t i = 0; i < count; i++) {
        const char *name = json_string_value(json_object_get(json_array_get(animations, i), "name"));
        if (name && strcmp(name, choice) == 0) {
            *out = i;
            return GW_OK;
        }
    }
    char *end = NULL;
    const unsigned long number = strtoul(choice, &end, 10);
    if (end != choice && !*end && number < count) {
        *out = number;
        return GW_OK;
    }
    const char *first = json_string_value(json_object_get(json_array_get(animations, 0), "name"));
    return gw_fail(
        error, GW_BAD_INPUT,
        "it has no animation '%.60s' (it has %zu%s%.60s%s); name one, its number from 0, all or none", choice,
        count, first ? ", the first is '" : "", first ? first : "", first ? "'" : "");
}

static gw_code read_clips(gw_gltf_motion *motion, const char *choice, gw_error *error) {
    const size_t count = json_array_size(list(motion, "animations"));
    size_t first = 0, end = count;
    gw_code code = GW_OK;
    if (count == 0 || (choice && strcmp(choice, "none") == 0))
        return GW_OK;
    if (choice && strcmp(choice, "all") != 0)
        code = find_animation(motion, choice, &first, error);
    if (!choice || strcmp(choice, "all") != 0)
        end = first + 1;
    if (code == GW_OK)
        code = gw_allocate((void **)&motion->animation->clips, end - first, sizeof(gw_motion_clip),
                           "animation clips", error);
    for (size_t i = first; code == GW_OK && i < end; i++)
        code = read_clip(motion, i, error);
    if (code == GW_OK && end - first < count)
        code =
            gw_scene_note(motion->model->scene, error,
                          "glTF: %zu of %zu animations plays; --animation NAME chooses, all plays them all",
                          end - first, count);
    if (code == GW_OK && motion->morphs)
        code = gw_scene_note(motion->model->scene, error,
                             "glTF: %u channels move morph targets: drawn without them", motion->morphs);
    return code == GW_OK ? sort_channels(motion->animation, error) : code;
}

/* Lights and cameras stay where they are at rest. */
static gw_code note_riders(const gw_gltf_motion *motion, gw_error *error) {
    size_t riders = 0;
    for (size_t i = 0; i < motion->node_count; i++) {
        const json_t *node = json_array_get(list(motion, "nodes"), i);
        const int carries =
            json_object_get(node, "camera") != NULL ||
            json_object_get(json_object_get(node, "extensions"), "KHR_lights_punctual") != NULL;
        riders += carries && motion->place_of[i] >= 0 && motion->moving[motion->place_of[i]];
    }
    return riders ? gw_scene_note(
                        motion->model->scene, error,
                        "glTF: %zu nodes that move have a light or a camera: it stays where it is at rest",
                        riders)
                  : GW_OK;
}

/* Nothing moves in time, but skins still have a pose of their own. */
static gw_code pose_once(gw_gltf_motion *motion, gw_error *error) {
    gw_pose pose;
    gw_code code = gw_pose_init(motion->animation, &pose, error);
    if (code != GW_OK)
        return code;
    gw_pose_at_time(motion->animation, 0, &pose);
    gw_pose_vertices(motion->animation, &pose, motion->model->world, motion->model->scene->normals);
    gw_pose_finish(&pose);
    return GW_OK;
}

static gw_code animate(gw_gltf_motion *motion, const char *choice, gw_error *error) {
    gw_source_model *model = motion->model;
    gw_code code = gw_animation_still(model->scene->vertex_count, model->world, model->scene->normals,
                                      &motion->animation, error);
    motion->binding_capacity = 1;
    if (code == GW_OK)
        code = read_nodes(motion, error);
    if (code == GW_OK)
        code = read_clips(motion, choice, error);
    if (code != GW_OK)
        return code;
    settle_nodes(motion);
    code = note_riders(motion, error);
    if (code == GW_OK)
        code = gw_gltf_bind_vertices(motion, error);
    if (code == GW_OK)
        code = gw_animation_check(motion->animation, error);
    if (code != GW_OK || motion->animation->binding_count == 1)
        return code; /* no vertex moves */
    if (motion->animation->channel_count == 0)
        return pose_once(motion, error);
    model->scene->animation = motion->animation;
    motion->animation = NULL;
    return GW_OK;
}

gw_code gw_gltf_animate(const gw_gltf *gltf, const char *folder, const char *choice, gw_source_model *model,
                        gw_error *error) {
    gw_gltf_motion motion = {.gltf = gltf, .model = model};
    if (!gw_gltf_moves(gltf))
        return GW_OK;
    motion.node_count = json_array_size(json_object_get(gltf->root, "nodes"));
    gw_code code = gw_gltf_data_open(gltf, folder, &motion.data, error);
    if (code == GW_OK)
        code = animate(&motion, choice, error);
    gw_gltf_data_close(&motion.data);
    gw_animation_destroy(&motion.animation);
    free(motion.place_of);
    free(motion.moving);
    return code;
}
