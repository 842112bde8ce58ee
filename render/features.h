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

/* A set of effects, one bit each. */
typedef uint64_t gw_features;
enum { GW_MOST_FEATURES = 64 };
#define GW_FEATURE_BIT(number) (UINT64_C(1) << (number))
#define GW_FEATURE_TEXTURES GW_FEATURE_BIT(0)
#define GW_FEATURE_VERTEX_COLORS GW_FEATURE_BIT(1)
#define GW_FEATURE_SMOOTH_NORMALS GW_FEATURE_BIT(2)
#define GW_FEATURE_EMISSIVE GW_FEATURE_BIT(3)
#define GW_FEATURE_ALPHA GW_FEATURE_BIT(4) /* masks and blending */
#define GW_FEATURE_DIRECTIONAL_LIGHTS GW_FEATURE_BIT(5)
#define GW_FEATURE_POINT_LIGHTS GW_FEATURE_BIT(6)
#define GW_FEATURE_LOD GW_FEATURE_BIT(7)           /* voxels beside triangles */
#define GW_FEATURE_GAZE GW_FEATURE_BIT(8)          /* footprints that depend on where viewers look */
#define GW_FEATURE_WIDE_NODES GW_FEATURE_BIT(9)    /* more than 2^24 octree nodes */
#define GW_FEATURE_SPARSE GW_FEATURE_BIT(10)       /* fewer rays than pixels where viewers cannot tell */
#define GW_FEATURE_DENSE_LEAVES GW_FEATURE_BIT(11) /* lists under boxes */
#define GW_FEATURE_ACCUMULATE GW_FEATURE_BIT(12)   /* samples of a still view add up */
#define GW_FEATURE_SHADOWS GW_FEATURE_BIT(13)      /* what stands before a light keeps it away */
#define GW_FEATURE_MIRROR GW_FEATURE_BIT(14)       /* perfect mirrors reflect */
#define GW_FEATURE_NORMAL_MAPS GW_FEATURE_BIT(15)
#define GW_FEATURE_MATERIAL_MAPS GW_FEATURE_BIT(16) /* metalness, roughness and occlusion */
#define GW_FEATURE_EMISSIVE_MAPS GW_FEATURE_BIT(17)
#define GW_FEATURE_CLEARCOAT GW_FEATURE_BIT(18)
#define GW_FEATURE_SHEEN GW_FEATURE_BIT(19)
#define GW_FEATURE_SPECULAR GW_FEATURE_BIT(20) /* reflectance of dielectrics other than 0.04 */
#define GW_FEATURE_UNLIT GW_FEATURE_BIT(21)
#define GW_FEATURE_MAP_PLACEMENT GW_FEATURE_BIT(22)   /* maps that lie otherwise than the base colour */
#define GW_FEATURE_SQUARE_TEXELS GW_FEATURE_BIT(23)   /* textures that are not interpolated */
#define GW_FEATURE_LAYER_MAPS GW_FEATURE_BIT(24)      /* of clearcoat and sheen */
#define GW_FEATURE_SPOT_LIGHTS GW_FEATURE_BIT(25)     /* lights with a cone or an end */
#define GW_FEATURE_AREA_LIGHTS GW_FEATURE_BIT(26)     /* lights with an extent: soft shadows */
#define GW_FEATURE_ENVIRONMENT GW_FEATURE_BIT(27)     /* light and background by direction */
#define GW_FEATURE_EMISSIVE_LIGHTS GW_FEATURE_BIT(28) /* what emits light lights other things */
#define GW_FEATURE_SPECULAR_MAPS GW_FEATURE_BIT(30)
#define GW_FEATURE_TRANSMISSION_MAPS GW_FEATURE_BIT(31)
#define GW_FEATURE_GLOSSY GW_FEATURE_BIT(32)       /* nearly smooth surfaces reflect */
#define GW_FEATURE_TRANSMISSION GW_FEATURE_BIT(33) /* light passes surfaces and is bent */
#define GW_FEATURE_ABSORPTION GW_FEATURE_BIT(34)   /* media take some of it on its way */
#define GW_FEATURE_TONE GW_FEATURE_BIT(40)         /* a curve other than linear */
#define GW_FEATURE_EXPOSURE GW_FEATURE_BIT(41)     /* light is multiplied before the curve */
#define GW_FEATURE_DITHER GW_FEATURE_BIT(42)       /* rounding to 8 bits by a pattern */
#define GW_FEATURE_OCCLUSION GW_FEATURE_BIT(43)    /* what stands near covers light from everywhere */
#define GW_FEATURE_DIFFUSE GW_FEATURE_BIT(44)      /* what is lit lights what stands near, once */
#define GW_FEATURE_METERING GW_FEATURE_BIT(45)     /* the picture's light is counted */
#define GW_FEATURE_TANGENTS GW_FEATURE_BIT(46)     /* normal maps lie as the file says */
#define GW_ALL_FEATURES UINT64_MAX

/* What makes fragments ask for secondary rays. */
#define GW_CONE_FEATURES (GW_FEATURE_OCCLUSION | GW_FEATURE_DIFFUSE)
#define GW_SECONDARY_FEATURES                                                                                \
    (GW_FEATURE_MIRROR | GW_FEATURE_GLOSSY | GW_FEATURE_TRANSMISSION | GW_CONE_FEATURES)

/* What frames decide, not the scene. */
#define GW_FRAME_FEATURES                                                                                    \
    (GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_SPARSE | GW_FEATURE_ACCUMULATE | GW_TONE_FEATURES |       \
     GW_CONE_FEATURES)

/* What makes a pixel of linear light: kernels that store none do without. */
#define GW_TONE_FEATURES (GW_FEATURE_TONE | GW_FEATURE_EXPOSURE | GW_FEATURE_DITHER | GW_FEATURE_METERING)

typedef struct gw_feature_row {
    gw_features bit;
    const char *name;   /* in reports and messages */
    const char *define; /* in shaders */
    const char *absent; /* why it is skipped, as a sentence about the scene or the frame */
} gw_feature_row;

extern const gw_feature_row gw_feature_rows[];
extern const size_t gw_feature_count;

/* What kernels read the rows of material extensions for (render/material_rows.h). */
#define GW_EXTENSION_FEATURES                                                                                \
    (GW_FEATURE_NORMAL_MAPS | GW_FEATURE_MATERIAL_MAPS | GW_FEATURE_EMISSIVE_MAPS | GW_FEATURE_CLEARCOAT |   \
     GW_FEATURE_SHEEN | GW_FEATURE_SPECULAR | GW_FEATURE_UNLIT | GW_FEATURE_MAP_PLACEMENT |                  \
     GW_FEATURE_TRANSMISSION | GW_FEATURE_LAYER_MAPS | GW_FEATURE_SPECULAR_MAPS |                            \
     GW_FEATURE_TRANSMISSION_MAPS | GW_FEATURE_TANGENTS)
/* What reads pictures over the footprint, and which of them colours. */
#define GW_PICTURE_FEATURES                                                                                  \
    (GW_COLOR_PICTURE_FEATURES | GW_FEATURE_NORMAL_MAPS | GW_FEATURE_MATERIAL_MAPS |                         \
     GW_FEATURE_TRANSMISSION_MAPS)
#define GW_COLOR_PICTURE_FEATURES                                                                            \
    (GW_FEATURE_TEXTURES | GW_FEATURE_EMISSIVE_MAPS | GW_FEATURE_LAYER_MAPS | GW_FEATURE_SPECULAR_MAPS)

/* Without these an octree that calls for them cannot be read. */
#define GW_NEEDED_FEATURES (GW_FEATURE_WIDE_NODES | GW_FEATURE_DENSE_LEAVES)

/* The bit of a name; GW_BAD_INPUT names the nearest known one. */
gw_code gw_feature_of_name(const char *name, gw_features *bit, gw_error *error);

/* mirror_roughness: up to which metal is a mirror. */
gw_features gw_features_of_material(const gw_material *material, float mirror_roughness);
gw_features gw_features_of_scene(const gw_scene *scene, const gw_octree *octree, float mirror_roughness);
/* viewers: gazes that are usable, which may be fewer than state->gaze_count. */
gw_features gw_features_of_frame(const gw_frame_state *state, uint32_t viewers, gw_features scene_features);

/* Everything that chooses one kernel. */
typedef struct gw_kernel_key {
    gw_features features;
    uint32_t depth;           /* of the octree */
    uint32_t texture_classes; /* 0..GW_MAXIMUM_TEXTURE_CLASSES */
    uint32_t data_classes;    /* 0..GW_MAXIMUM_DATA_CLASSES */
    uint32_t root_grid;       /* level of the grid at which a walk without voxels starts, 0: at the root */
    uint32_t loop_budget;
    uint32_t debug; /* gw_debug_view */
    int voxels_only, level_blend, leaf_blend, double_edges, ordered_edges, count, resume, any_hit;
    int reflected;      /* its rays are secondary ones, from a buffer */
    int until_coarse;   /* the first round of a frame with voxels: see renderer_batch.c */
    int gaze_seed;      /* gaze_rule = seed */
    int check_fetches;  /* reads of the octree are checked */
    int guides;         /* samples tell what they met, for edge-aware reconstruction */
    int voxel_emission; /* the octree knows what its voxels emit */
} gw_kernel_key;

enum { GW_LOD_FRAGMENTS = 8 }; /* what one dispatch may meet along one ray before the ray is suspended */

uint32_t gw_kernel_fragments(const gw_kernel_key *key); /* of one ray */
enum { GW_KERNEL_DEFINES = 2048 };                      /* bytes that suffice for them */
/* "#define ..." lines for the kernel; size is that of text. */
gw_code gw_kernel_defines(const gw_kernel_key *key, char *text, size_t size, gw_error *error);

#endif
