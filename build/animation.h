/* What moves in a scene, and where it is at a time: a hierarchy of nodes, keys in time, and for every vertex
 * the joints that carry it (glTF 2.0, sections 3.7.3 skins and 3.11 animations).
 *
 * A scene has none (NULL) when nothing moves. Vertices that stay carry no joint. The pose is computed in
 * double precision with base/portable_math.h, so that every rank and machine has the same bits. The structure
 * is owned by its scene, or its arrays stand in somebody else's block (`borrowed`); read-only once the scene
 * is finished. Any thread. */
#ifndef GW_BUILD_ANIMATION_H
#define GW_BUILD_ANIMATION_H

#include "base/hash.h"
#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_VERTEX_JOINTS = 4 };

typedef enum gw_motion_path { GW_MOVE_TRANSLATION, GW_MOVE_ROTATION, GW_MOVE_SCALE } gw_motion_path;
typedef enum gw_motion_curve { GW_CURVE_STEP, GW_CURVE_LINEAR, GW_CURVE_CUBIC } gw_motion_curve;

/* A clip is what plays as one: its channels share a length and start again together. */
typedef struct gw_motion_clip {
    char name[64];
    double duration; /* s, > 0 */
} gw_motion_clip;

typedef struct gw_motion_node {
    int32_t parent; /* a lower index; -1: the scene */
    uint32_t
        moves; /* 1: translation, rotation and scale hold, and channels change them; 0: the matrix holds */
    double translation[3], rotation[4], scale[3]; /* rotation: quaternion x, y, z, w */
    double matrix[3][4];
} gw_motion_node;

/* Keys of one property of one node. A key has `width` values, three times as many on a cubic curve: tangent
 * in, value, tangent out. Before the first key and after the last their values hold. */
typedef struct gw_motion_channel {
    uint32_t clip, node;
    uint32_t path, curve; /* gw_motion_path, gw_motion_curve */
    uint32_t key_first, key_count;
    uint32_t value_first;
} gw_motion_channel;

typedef struct gw_motion_joint {
    uint32_t node;
    uint32_t reserved;
    double inverse_bind[3][4]; /* from the vertex's space to the joint's */
} gw_motion_joint;

/* How a vertex hangs on joints: by weights that add up to 1; without joints it stays where it is. */
typedef struct gw_binding {
    uint32_t count; /* 0..GW_VERTEX_JOINTS */
    uint32_t joints[GW_VERTEX_JOINTS];
    float weights[GW_VERTEX_JOINTS];
} gw_binding;

typedef struct gw_animation {
    uint32_t clip_count, node_count, channel_count, time_count, value_count, joint_count, binding_count,
        vertex_count;
    gw_motion_clip *clips;
    gw_motion_node *nodes;
    gw_motion_channel *channels; /* in the order of their nodes */
    float *times;                /* s, not falling within a channel */
    float *values;               /* all finite */
    gw_motion_joint *joints;
    gw_binding *bindings;   /* 0: stays */
    uint32_t *binding_of;   /* [vertex_count] */
    double *bind_positions; /* [vertex_count][3] of vertices that stay: scene metres */
    float *bind_normals;    /* [vertex_count][3] unit or zero */
    int borrowed;
} gw_animation;

void gw_animation_destroy(gw_animation **animation);

/* An animation of vertices that stay: room for a model that does not move beside one that does. normals may
 * be NULL. */
gw_code gw_animation_still(uint32_t vertex_count, const double *positions, const float *normals,
                           gw_animation **out, gw_error *error);

/* Puts everything through a transform of scene space. */
gw_code gw_animation_transform(gw_animation *animation, const double matrix[3][4], gw_error *error);

/* Adds everything of `part` behind that of `target`; the part's own indices are shifted and of no use after.
 */
gw_code gw_animation_append(gw_animation *target, gw_animation *part, gw_error *error);

gw_hash gw_animation_hash(gw_hash hash, const gw_animation *animation);

/* GW_BAD_INPUT when an index, count or number is not what the comments above promise. */
gw_code gw_animation_check(const gw_animation *animation, gw_error *error);

/* --- poses --- */

/* Matrices of one moment; made once, filled for every time. */
typedef struct gw_pose {
    double (*nodes)[3][4];  /* [node_count] to scene space */
    double (*joints)[3][4]; /* [joint_count] from the vertex's space to scene space */
} gw_pose;

gw_code gw_pose_init(const gw_animation *animation, gw_pose *pose, gw_error *error);
void gw_pose_finish(gw_pose *pose);

/* The matrices at a time (ns, any sign); clips are looped. */
void gw_pose_at_time(const gw_animation *animation, int64_t time, gw_pose *pose);
/* The same with every clip at `phase` of its length, 0..1: what bounds are measured with. */
void gw_pose_at_phase(const gw_animation *animation, double phase, gw_pose *pose);

/* Vertex [v] in scene metres, and its shading normal (unit, or zero where it has none). Either may be NULL.
 */
void gw_pose_vertices(const gw_animation *animation, const gw_pose *pose, double *positions, float *normals);

#endif
