/* Poses of an animation: keys to nodes, nodes to joints, joints to vertices. Double precision, fixed order of
 * operations. */
#include "build/animation.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "build/matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Above this cosine two rotations are too close for a quotient of sines. */
static const double nearly_equal = 1.0 - 1e-9;

gw_code gw_pose_init(const gw_animation *animation, gw_pose *pose, gw_error *error) {
    *pose = (gw_pose){0};
    gw_code code = gw_allocate((void **)&pose->nodes, animation->node_count, sizeof *pose->nodes,
                               "animated nodes", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&pose->joints, animation->joint_count, sizeof *pose->joints, "joints",
                           error);
    if (code != GW_OK)
        gw_pose_finish(pose);
    return code;
}

void gw_pose_finish(gw_pose *pose) {
    free(pose->nodes);
    free(pose->joints);
    *pose = (gw_pose){0};
}

/* --- keys --- */

static uint32_t width_of(const gw_motion_channel *channel) {
    return channel->path == GW_MOVE_ROTATION ? 4 : 3;
}

/* The last key at or before the time; the first key for any time before it. */
static uint32_t find_key(const float *times, uint32_t count, double time) {
    uint32_t low = 0, high = count;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if ((double)times[middle] <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void normalize_rotation(double q[4]) {
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++)
        q[i] = length > 0.0 ? q[i] / length : (i == 3 ? 1.0 : 0.0);
}

/* Along the shorter arc at constant speed (glTF 2.0, appendix C.4). */
static void turn_between(const float *a, const float *b, double fraction, double out[4]) {
    double p[4], q[4];
    for (int i = 0; i < 4; i++) {
        p[i] = (double)a[i];
        q[i] = (double)b[i];
    }
    normalize_rotation(p);
    normalize_rotation(q);
    double cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    const double side = cosine < 0.0 ? -1.0 : 1.0;
    double first = 1.0 - fraction, second = fraction;
    cosine *= side;
    if (cosine < nearly_equal) {
        const double angle = gw_acos(cosine), sine = gw_sin(angle);
        first = gw_sin(first * angle) / sine;
        second = gw_sin(second * angle) / sine;
    }
    for (int i = 0; i < 4; i++)
        out[i] = first * p[i] + side * second * q[i];
}

/* Hermite curve of key k to k + 1 (glTF 2.0, appendix C.5); keys hold tangent in, value, tangent out. */
static void curve_between(const float *key, uint32_t width, double fraction, double length, double out[4]) {
    const double t = fraction, t2 = t * t, t3 = t2 * t;
    for (uint32_t i = 0; i < width; i++) {
        const double value = (double)key[width + i], leaving = (double)key[2 * width + i],
                     arriving = (double)key[3 * width + i], next = (double)key[4 * width + i];
        out[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * value + length * (t3 - 2.0 * t2 + t) * leaving +
                 (-2.0 * t3 + 3.0 * t2) * next + length * (t3 - t2) * arriving;
    }
}

static void evaluate(const gw_animation *animation, const gw_motion_channel *channel, double time,
                     double out[4]) {
    const float *times = animation->times + channel->key_first;
    const float *values = animation->values + channel->value_first;
    const uint32_t width = width_of(channel), cubic = channel->curve == GW_CURVE_CUBIC;
    const uint32_t stride = cubic ? 3 * width : width, key = find_key(times, channel->key_count, time);
    const float *at = values + (size_t)key * stride;
    const int between = key + 1 < channel->key_count && time > (double)times[key];
    if (!between || channel->curve == GW_CURVE_STEP) {
        for (uint32_t i = 0; i < width; i++)
            out[i] = (double)at[(cubic ? width : 0) + i];
        return;
    }
    const double length = (double)times[key + 1] - (double)times[key];
    const double fraction = (time - (double)times[key]) / length; /* find_key: the next time is later */
    if (cubic)
        curve_between(at, width, fraction, length, out);
    else if (channel->path == GW_MOVE_ROTATION)
        turn_between(at, at + stride, fraction, out);
    else
        for (uint32_t i = 0; i < width; i++)
            out[i] = (1.0 - fraction) * (double)at[i] + fraction * (double)at[stride + i];
}

/* --- matrices --- */

typedef struct placement {
    double translation[3], rotation[4], scale[3];
} placement;

/* Translation * rotation * scale. */
static void compose(const placement *from, double out[3][4]) {
    double q[4] = {from->rotation[0], from->rotation[1], from->rotation[2], from->rotation[3]};
    normalize_rotation(q);
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turn[3][3] = {{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)},
                               {2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)},
                               {2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            out[i][k] = turn[i][k] * from->scale[k];
        out[i][3] = from->translation[i];
    }
}

/* What clips are asked for: a time, or a part of their length. */
typedef struct moment {
    int64_t time; /* ns */
    double phase; /* 0..1; below 0: the time holds */
} moment;

/* Seconds into the clip. */
static double clip_time(const gw_motion_clip *clip, const moment *when) {
    if (when->phase >= 0.0)
        return when->phase * clip->duration;
    int64_t length = (int64_t)floor(clip->duration * 1e9 + 0.5);
    length = length > 0 ? length : 1;
    int64_t rest = when->time % length;
    rest += rest < 0 ? length : 0;
    return (double)rest * 1e-9;
}

/* The transform of a node against its parent's. The channels of a node stand together, in the order of nodes:
 * *channel runs through them. */
static void place_node(const gw_animation *animation, uint32_t index, const moment *when, uint32_t *channel,
                       double out[3][4]) {
    const gw_motion_node *node = &animation->nodes[index];
    placement now;
    memcpy(now.translation, node->translation, sizeof now.translation);
    memcpy(now.rotation, node->rotation, sizeof now.rotation);
    memcpy(now.scale, node->scale, sizeof now.scale);
    for (; *channel < animation->channel_count && animation->channels[*channel].node == index; ++*channel) {
        const gw_motion_channel *c = &animation->channels[*channel];
        double *to = c->path == GW_MOVE_TRANSLATION ? now.translation
                     : c->path == GW_MOVE_ROTATION  ? now.rotation
                                                    : now.scale;
        evaluate(animation, c, clip_time(&animation->clips[c->clip], when), to);
    }
    if (node->moves)
        compose(&now, out);
    else
        memcpy(out, node->matrix, sizeof node->matrix);
}

static void fill_pose(const gw_animation *animation, const moment *when, gw_pose *pose) {
    uint32_t channel = 0;
    for (uint32_t i = 0; i < animation->node_count; i++) {
        double local[3][4];
        const int32_t parent = animation->nodes[i].parent;
        place_node(animation, i, when, &channel, local);
        if (parent >= 0)
            gw_matrix_multiply((const double(*)[4])pose->nodes[parent], (const double(*)[4])local,
                               pose->nodes[i]);
        else
            memcpy(pose->nodes[i], local, sizeof local);
    }
    for (uint32_t i = 0; i < animation->joint_count; i++)
        gw_matrix_multiply((const double(*)[4])pose->nodes[animation->joints[i].node],
                           (const double(*)[4])animation->joints[i].inverse_bind, pose->joints[i]);
}

void gw_pose_at_time(const gw_animation *animation, int64_t time, gw_pose *pose) {
    fill_pose(animation, &(moment){.time = time, .phase = -1.0}, pose);
}

void gw_pose_at_phase(const gw_animation *animation, double phase, gw_pose *pose) {
    fill_pose(animation, &(moment){.phase = phase}, pose);
}

/* --- vertices --- */

static void blend_joints(const gw_binding *binding, const gw_pose *pose, double out[3][4]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) {
            out[i][k] = 0.0;
            for (uint32_t j = 0; j < binding->count; j++)
                out[i][k] += (double)binding->weights[j] * pose->joints[binding->joints[j]][i][k];
        }
}

void gw_pose_vertices(const gw_animation *animation, const gw_pose *pose, double *positions, float *normals) {
    uint32_t last = UINT32_MAX;
    double matrix[3][4], cofactors[3][3];
    for (size_t v = 0; v < animation->vertex_count; v++) {
        const double *bind_position = animation->bind_positions + v * 3;
        const float *bind_normal = animation->bind_normals + v * 3;
        const uint32_t index = animation->binding_of[v];
        const int stays = animation->bindings[index].count == 0;
        if (!stays && index != last) { /* neighbours often hang on the same joints */
            blend_joints(&animation->bindings[index], pose, matrix);
            gw_matrix_cofactors((const double(*)[4])matrix, cofactors);
            last = index;
        }
        if (positions && stays)
            memcpy(positions + v * 3, bind_position, 3 * sizeof *positions);
        else if (positions)
            gw_matrix_point((const double(*)[4])matrix, bind_position, positions + v * 3);
        if (normals && stays)
            memcpy(normals + v * 3, bind_normal, 3 * sizeof *normals);
        else if (normals)
            gw_matrix_normal((const double(*)[3])cofactors, bind_normal, normals + v * 3);
    }
}
