/* Effects: what a scene and a frame call for, and nothing else, is compiled into the kernels.
 *
 * Each bit is derived from data (a material with a texture, a frame with a gaze, ...). A bit that is compiled
 * in although nothing calls for it gives the same pixels, only slower. Plain values; any thread. */
#ifndef GW_RENDER_FEATURES_H
#define GW_RENDER_FEATURES_H

#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"
#include "render/frame_state.h"

#include <stddef.h>
#include <stdint.h>

typedef enum gw_feature {
    GW_FEATURE_TEXTURES = 1 << 0,
    GW_FEATURE_VERTEX_COLORS = 1 << 1,
    GW_FEATURE_SMOOTH_NORMALS = 1 << 2,
    GW_FEATURE_EMISSIVE = 1 << 3,
    GW_FEATURE_ALPHA = 1 << 4, /* masks and blending */
    GW_FEATURE_DIRECTIONAL_LIGHTS = 1 << 5,
    GW_FEATURE_POINT_LIGHTS = 1 << 6,
    GW_FEATURE_LOD = 1 << 7,           /* voxels beside triangles */
    GW_FEATURE_GAZE = 1 << 8,          /* footprints that depend on where viewers look */
    GW_FEATURE_WIDE_NODES = 1 << 9,    /* more than 2^24 octree nodes */
    GW_FEATURE_SPARSE = 1 << 10,       /* fewer rays than pixels where viewers cannot tell */
    GW_FEATURE_DENSE_LEAVES = 1 << 11, /* lists under boxes */
    GW_FEATURE_ACCUMULATE = 1 << 12,   /* samples of a still view add up */
    GW_FEATURE_SHADOWS = 1 << 13,      /* what stands before a light keeps it away */
    GW_FEATURE_MIRROR = 1 << 14        /* perfect mirrors reflect, once */
} gw_feature;

/* What frames decide, not the scene. */
enum { GW_FRAME_FEATURES = GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_SPARSE | GW_FEATURE_ACCUMULATE };

typedef struct gw_feature_row {
    uint32_t bit;
    const char *name;   /* in reports and messages */
    const char *define; /* in shaders */
    const char *absent; /* why it is skipped, as a sentence about the scene or the frame */
} gw_feature_row;

extern const gw_feature_row gw_feature_rows[];
extern const size_t gw_feature_count;

/* Without these an octree that calls for them cannot be read. */
enum { GW_NEEDED_FEATURES = GW_FEATURE_WIDE_NODES | GW_FEATURE_DENSE_LEAVES };

/* The bit of a name; GW_BAD_INPUT names the nearest known one. */
gw_code gw_feature_of_name(const char *name, uint32_t *bit, gw_error *error);

/* mirror_roughness: up to which metal is a mirror. */
uint32_t gw_features_of_scene(const gw_scene *scene, const gw_octree *octree, float mirror_roughness);
/* viewers: gazes that are usable, which may be fewer than state->gaze_count. */
uint32_t gw_features_of_frame(const gw_frame_state *state, uint32_t viewers, uint32_t scene_features);

/* Everything that chooses one kernel. */
typedef struct gw_kernel_key {
    uint32_t features;
    uint32_t depth;           /* of the octree */
    uint32_t texture_classes; /* 0..GW_MAXIMUM_TEXTURE_CLASSES */
    uint32_t root_grid;       /* level of the grid at which a walk without voxels starts, 0: at the root */
    uint32_t loop_budget;
    uint32_t debug; /* gw_debug_view */
    int voxels_only, level_blend, leaf_blend, double_edges, count, resume, any_hit;
    int reflected;      /* its rays come from mirrors */
    int until_coarse;   /* the first round of a frame with voxels: see renderer_batch.c */
    int gaze_seed;      /* gaze_rule = seed */
    int guides;         /* samples tell what they met, for edge-aware reconstruction */
    int voxel_emission; /* the octree knows what its voxels emit */
} gw_kernel_key;

enum { GW_LOD_FRAGMENTS = 8 }; /* what one dispatch may meet along one ray before the ray is suspended */

uint32_t gw_kernel_fragments(const gw_kernel_key *key); /* of one ray */
/* "#define ..." lines for the kernel; size is that of text, 1024 suffices. */
gw_code gw_kernel_defines(const gw_kernel_key *key, char *text, size_t size, gw_error *error);

#endif
