/* What gltf_animation.c and gltf_skin.c share while they read one file; private to them. */
#ifndef GW_BUILD_GLTF_MOTION_H
#define GW_BUILD_GLTF_MOTION_H

#include "build/animation.h"
#include "build/gltf_data.h"
#include "build/source_model.h"

typedef struct gw_gltf_motion {
    const gw_gltf *gltf;
    gw_gltf_data data;
    gw_source_model *model;
    gw_animation *animation;
    size_t node_count; /* of the file */
    int32_t *place_of; /* [node_count] index in the animation, -1: hangs in no tree */
    uint8_t *moving;   /* [node_count] of the animation: it or a node above it has channels */
    size_t joint_capacity, binding_capacity, channel_capacity, time_capacity, value_capacity;
    uint32_t morphs; /* channels that move morph targets */
} gw_gltf_motion;

/* An index of an object below `limit`; -1 when absent; GW_BAD_INPUT when it is anything else. */
gw_code gw_gltf_index(const json_t *object, const char *key, size_t limit, int64_t *out, gw_error *error);

/* Ties the model's vertices to joints, span by span. */
gw_code gw_gltf_bind_vertices(gw_gltf_motion *motion, gw_error *error);

#endif
