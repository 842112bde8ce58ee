/* The frame state: everything a frame depends on besides scene and site. One plain struct below 512 bytes
 * that travels in the gate's release message, is recorded one per frame and repeated by replay: the same
 * state gives the same pixels. */
#ifndef GW_RENDER_FRAME_STATE_H
#define GW_RENDER_FRAME_STATE_H

#include "base/settings.h"
#include "build/gpu_types.h"

#include <stddef.h>
#include <stdint.h>

/* States are compared as bytes, so neither struct may have a hole. */
#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wpadded"
/* One viewer's gaze in wall space (mm). */
typedef struct gw_gaze {
    float eye[3];
    float direction[3];            /* unit */
    float up[3];                   /* unit, about across direction: orients the ellipse */
    float half_width, half_height; /* deg */
    float age;                     /* s */
    float confidence;              /* 0..1 */
} gw_gaze;

typedef struct gw_frame_state {
    uint32_t frame;      /* number, from 0 */
    uint32_t gaze_count; /* 0: nobody's gaze is known, so everything is sharp (tau_inside everywhere) */
    int64_t time;        /* ns of the scene's and track's clock */
    double eye[3];       /* rendering eye, wall space, mm; between the two with stereo */
    gw_gaze gazes[GW_MAXIMUM_VIEWERS];
    /* Knobs of the FRAME stage, as floats (settings.h says what they mean). */
    float tau, tau_inside, gaze_margin, gaze_blend, gaze_growth, gaze_latency, gaze_growth_limit,
        acuity_slope, voxel_slab, voxel_flatness, fold_agreement, least_remainder, separated_tau,
        gaze_footprint, shadow_tau, edge_depth, edge_normal, seed_distance, mirror_roughness,
        least_throughput;
    uint8_t geometry, level_blend, leaf_blend, texture_filter, triangle_precision;
    uint8_t debug;        /* gw_debug_view */
    uint8_t sample_block; /* log2 of the side of the largest sample block, 0..4 */
    uint8_t reconstruction, rate_blend, gaze_rule;
    uint8_t coarse_samples; /* log2 of the rays of a coarse square, 0..3 */
    uint8_t samples;        /* log2 of the rays of a sharp pixel, 0..4 */
    uint32_t seed;
    uint8_t environment_lights;
    uint8_t shadow_samples; /* 0, 1, 2: 1, 4, 16 */
    uint8_t emissive_lights;
    uint8_t reserved; /* 0 */
    /* Accumulation of a still view: pixels are the mean, in linear light, of samples 0 to accumulate - 1 (0
     * counts as 1). epoch numbers the still views from 1; 0: no further sample of this view will be asked
     * for, so nothing is kept for one. */
    uint32_t epoch;
    uint16_t accumulate;
    uint8_t near_light; /* a knob as above */
    uint8_t bounces;    /* 0..8 */
    /* How far tau, gaze_margin, acuity_slope and sample_block are strained to be faster: 1, as they stand, to
     * GW_MAXIMUM_STRAIN. See gw_frame_state_in_force(). */
    float strain;
    /* Navigation: where in the scene the wall's neutral viewer stands and what the wall's middle shows, scene
     * metres, up is y. Both the same (0): the scene stands as it is placed. */
    float stand[3], look_at[3];
    /* Stereo: from `eye` to the right eye, mm; the left one lies as far on the other side. 0: one eye. */
    float eye_offset[3];
    /* Navigation: wall mm per scene metre. 0: as the scene is placed by a viewpoint, or true to scale. */
    float scene_scale;
    /* From the light of the pixels to the codes of the screen, which the samples do not depend on. */
    float exposure;       /* stops: what was set, or what rank 0 decided */
    uint8_t tone, dither; /* knobs as above */
    uint8_t metering;     /* 1: tiles tell how bright their pixels are, for exposure=auto */
    uint8_t cones;        /* occlusion_cones, their number: 0 to 6 */
    float occlusion_distance;
    float emissive_least, emissive_faintest; /* knobs as above */
    uint8_t diffuse_bounce;
    uint8_t glossy_roughness; /* 255ths, as textures have it */
    uint16_t light_least;     /* 65535ths */
} gw_frame_state;
#pragma GCC diagnostic pop
_Static_assert(offsetof(gw_frame_state, seed) == offsetof(gw_frame_state, samples) + sizeof(uint8_t) &&
                   offsetof(gw_frame_state, light_least) + 2 == sizeof(gw_frame_state),
               "no holes for compilers that know no -Wpadded either: after the bytes, and at the end");
_Static_assert(sizeof(gw_frame_state) < 512, "the frame state travels in one small message");

typedef enum gw_debug_view {
    GW_DEBUG_NONE,
    GW_DEBUG_LEVELS,
    GW_DEBUG_STEPS,
    GW_DEBUG_NORMALS,
    GW_DEBUG_GAZE,
    GW_DEBUG_RATES,
    GW_DEBUG_ECCENTRICITY,
    GW_DEBUG_FOOTPRINT,
    GW_DEBUG_LOADS, /* work of each pixel's rays, as GW_DEBUG_STEPS */
    GW_DEBUG_TESTS,
    GW_DEBUG_VOXELS,
    GW_DEBUG_BOUNDS, /* no view: the frame as it is, and an error if anything was read out of range */
    GW_DEBUG_VIEWS
} gw_debug_view;

enum { GW_MAXIMUM_CONES = 6 };
enum { GW_MAXIMUM_ACCUMULATION = 256, GW_MAXIMUM_STRAIN = 16 };

/* Copies the FRAME settings into the state; accumulate is the number of samples to draw at once. */
void gw_frame_state_apply(gw_frame_state *state, const gw_settings *settings);

/* The state that is drawn: with strain q, and strain 1 in it,
 *   tau * q^(1/4)       the footprint that it multiplies grows with acuity_slope already
 *   gaze_margin / q
 *   acuity_slope * q    so the periphery pays and the centre of gaze does not
 *   sample_block * 2^floor(log2 q), at most 16
 * What is inside an ellipse stays as it is, and without any gaze everything does. */
gw_frame_state gw_frame_state_in_force(const gw_frame_state *state);

/* What the samples of a frame depend on, in one form: two states with equal bytes of it show the same view,
 * to the bit. Without what only names the frame (number, epoch, accumulate), without what makes codes of
 * light (exposure, tone, dither), without the time unless the scene moves, and of the gaze's age and
 * confidence only what changes pixels. */
gw_frame_state gw_frame_state_view(const gw_frame_state *state, int scene_moves);

#endif
