/* The renderer: octree + frame state -> the pixels of one rectangle of a plane.
 *
 * Holds the scene and octree on the GPU (uploaded once; a scene that moves for
 * each new time), the specialised kernels, and the buffers of the
 * largest rectangle asked for so far. Pixels are a function of (scene, octree, placement, plane, wall-global
 * pixel, frame state) only. Belongs to the thread of its GL device. Scene and octree are borrowed until
 * destroy. */
#ifndef GW_RENDER_RENDERER_H
#define GW_RENDER_RENDERER_H

#include "base/gl.h"
#include "base/log.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"
#include "render/features.h"
#include "render/frame_state.h"
#include "render/luminance.h"
#include "render/view.h"

#include <jansson.h>
#include <stdint.h>

typedef struct gw_renderer gw_renderer;

/* Whether an effect that was called for got something to do. */
typedef struct gw_effect_use {
    uint64_t met;          /* its rays, or fragments of materials that call for it */
    uint32_t frames, idle; /* in which it ran and its use was counted; those in which it met nothing */
} gw_effect_use;

/* Deterministic work of one frame. steps to voxel_rays are zero unless counting was on. */
typedef struct gw_counters {
    uint64_t rays, steps, node_loads, triangle_tests, voxels;
    uint64_t voxel_rays;      /* rays that met a voxel, by themselves or by a shadow ray */
    uint64_t step_cap_hits;   /* rays that the driver cut off: must stay 0; always counted */
    uint64_t nan_pixels;      /* pixels replaced by the background; always counted */
    uint64_t mirror_rays;     /* reflected; as shadow_rays */
    uint64_t glossy_rays;     /* reflected by what is no mirror; as shadow_rays */
    uint64_t refracted_rays;  /* that went through something; as shadow_rays */
    uint64_t cone_rays;       /* of occlusion and the diffuse bounce; as shadow_rays */
    uint64_t shadow_rays;     /* always counted; their steps and tests are in the numbers above */
    uint64_t resumed;         /* further dispatches of suspended rays, summed over rays; always counted */
    uint64_t loop_iterations; /* the most of one ray in one dispatch, of the loop budget: no sum; 0 unless
                                 counting was on */
    /* By the number of each effect's bit. Those of materials, and voxels, only with counting. */
    gw_effect_use effects[GW_MOST_FEATURES];
} gw_counters;
/* Rays of all effects, beside those of pixels. */
uint64_t gw_secondary_rays(const gw_counters *counters);
void gw_counters_add(gw_counters *to, const gw_counters *from);

/* Where kernels are made that a frame calls for and that are not there. Pixels are the same. */
typedef enum gw_kernel_making {
    GW_KERNELS_AUTO,    /* in the background, but for software GL, which would compile them twice */
    GW_KERNELS_AT_ONCE, /* on the renderer's thread, before the frame */
    /* By a thread of their own, if living kernels that know more can draw meanwhile; else at once. For scenes
     * that stand still: what moves is uploaded anew under that thread's feet. */
    GW_KERNELS_BACKGROUND,
    GW_KERNELS_WAYS
} gw_kernel_making;

typedef struct gw_renderer_options {
    int count; /* 1: count steps, loads, tests (slower, same pixels) */
    /* Loop iterations of one ray per dispatch, after which it is suspended and goes on in another; 0: 4,000.
     * Software GL ends all loops of a group of up to 16 lanes after 65,535 iterations, so 4,095 is the most
     * that is safe there. */
    uint32_t loop_budget;
    /* Of the octree's build: an animated scene is rebuilt with them for each frame's time. NULL: it stays at
     * time 0, and so does a scene without animation, for which nothing is made. */
    const gw_settings *settings;
    /* 1: where voxels may be met every ray is traced by the kernel that knows them, not only those that do
     * meet one (slower, same pixels: for tests and benches). */
    int one_kernel;
    int time_blending; /* 1: measure what gw_renderer_take_blend_ns() tells (a little slower, same pixels) */
    gw_features
        force_features; /* gw_feature bits to compile in although nothing calls for them: same pixels */
    /* gw_feature bits to leave out although something calls for them: other pixels. GW_BAD_INPUT for those
     * without which the octree cannot be read. */
    gw_features forbid_features;
    gw_kernel_making kernels;
    const gw_log *log;
} gw_renderer_options;

gw_code gw_renderer_create(gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                           const gw_renderer_options *options, gw_renderer **out, gw_error *error);
void gw_renderer_destroy(gw_renderer **renderer);

/* Renders the rectangle into rgba ([height][width][4], sRGB, alpha 255). counters may be NULL; they are added
 * to. */
gw_code gw_renderer_frame(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                          const gw_rectangle *rectangle, const gw_frame_state *state, uint8_t *rgba,
                          gw_counters *counters, gw_error *error);

/* ns that making pixels of samples took since this was last called; 0 without time_blending, and where every
 * pixel has a ray of its own. */
int64_t gw_renderer_take_blend_ns(gw_renderer *renderer);

/* The light of the frames' pixels since this was last called; of frames whose state wants it (metering). Of
 * one that shows what was kept of a still view (accumulate), that of what it shows. */
void gw_renderer_take_luminance(gw_renderer *renderer, gw_luminance *out);

/* 1 while kernels are being made in the background. */
int gw_renderer_makes_kernels(const gw_renderer *renderer);

/* Which of two eyes, 0 or 1, the next frames are drawn for: the samples of still views (accumulate) are kept
 * for each by itself. Changes no pixel. */
void gw_renderer_choose_view(gw_renderer *renderer, uint32_t view);

/* Adds to *rays how many primary rays such a frame traces, rims included, without tracing them. Where every
 * pixel has one ray that is the rectangle's pixels. With accumulation: if nothing is kept of the view. */
gw_code gw_renderer_count_rays(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                               const gw_rectangle *rectangle, const gw_frame_state *state, uint64_t *rays,
                               gw_error *error);

/* What the rays of a frame's pixels met, for metrics: one ray through the middle of each pixel under the
 * state's tau and gazes, whatever sample_block and samples say. Nothing is lit: mirrors and glass are
 * surfaces, normals are those of the vertices. NULL arrays are left out. */
typedef struct gw_geometry {
    uint32_t *ids;  /* [height][width] triangle, or node with bit 31, of what weighs most along the ray;
                       GW_NO_TRIANGLE where less than half of it met anything */
    float *depths;  /* [height][width] mm of wall space from the eye */
    float *normals; /* [height][width][3] unit, rebased space */
} gw_geometry;
/* All of its arrays, for width x height pixels; finish frees what was made, of zeroed ones nothing. */
gw_code gw_geometry_create(uint32_t width, uint32_t height, gw_geometry *out, gw_error *error);
void gw_geometry_finish(gw_geometry *geometry);
gw_code gw_renderer_geometry(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                             const gw_rectangle *rectangle, const gw_frame_state *state,
                             const gw_geometry *out, gw_error *error);

/* Rays for oracles and benches, in rebased space; directions need not be unit, t is in units of the
 * direction. One whose components are all subnormal is none, and the ray a miss: devices may take them for
 * zero. */
typedef struct gw_ray {
    float origin[3], minimum; /* hits with minimum < t <= maximum count; minimum is 0 as a rule */
    float direction[3], maximum;
} gw_ray;
typedef struct gw_hit {
    float t;           /* of the hit; ray.maximum if none */
    uint32_t triangle; /* canonical id or GW_NO_TRIANGLE */
} gw_hit;
typedef enum gw_trace_method {
    GW_TRACE_OCTREE,      /* the shipped traversal at tau 0: the nearest hit */
    GW_TRACE_BRUTE_FORCE, /* every triangle, same shader code for the test */
    GW_TRACE_ANY          /* the traversal of shadows: some hit if there is one, always the same one */
} gw_trace_method;
gw_code gw_renderer_trace(gw_renderer *renderer, gw_trace_method method, const gw_ray *rays, size_t ray_count,
                          gw_hit *hits, gw_counters *counters, gw_error *error);

/* Another traversal of the same rays, for benches: what is 0 or NULL is as in the shipped one. */
enum { GW_TRACE_TEXTURES = 5 };
typedef struct gw_trace_variant {
    const char *kernel;                              /* instead of trace/rays.comp, which it resembles */
    const char *defines;                             /* lines put after the octree's own */
    const gw_gl_buffer *textures[GW_TRACE_TEXTURES]; /* by unit, see trace/fetch.glsl */
    int storage;                                     /* 1: nodes, references, triangles as storage blocks */
    int count;                                       /* 1: count work */
} gw_trace_variant;
/* What the kernels took, without copying rays and hits: by the wall's clock, and of this process's
 * processors. */
typedef struct gw_trace_time {
    double wall_ms, processor_ms;
} gw_trace_time;
/* As gw_renderer_trace by the octree. */
gw_code gw_renderer_trace_variant(gw_renderer *renderer, const gw_trace_variant *variant, const gw_ray *rays,
                                  size_t ray_count, gw_hit *hits, gw_counters *counters, gw_trace_time *time,
                                  gw_error *error);

/* Adds to a report "effects": {run, skipped: [{name, why}], forced, forbidden, met: {name: {met, frames,
 * idle}}, variants: {alive, programs, deleted, compiled, read, refused, making, background, failed, pending,
 * stand_in_frames}}; "lights" (render/renderer_lights.c); and for a scene that moves "rebuild"
 * (render/moving.h). counters: of all that was drawn; NULL: nothing was. */
gw_code gw_renderer_report(const gw_renderer *renderer, const gw_counters *counters, json_t *report,
                           gw_error *error);
/* Effects that the scene and the last frame called for, but for the forbidden ones. */
gw_features gw_renderer_features(const gw_renderer *renderer);
/* Bytes on the GPU, by what they hold. */
typedef struct gw_renderer_parts {
    uint64_t nodes, references,
        voxels;                     /* of the octree; lists with their boxes, voxels with what they emit */
    uint64_t triangles, attributes; /* corners; faces, vertices, materials and lights */
    uint64_t textures;
    uint64_t rays; /* of the largest frame so far */
} gw_renderer_parts;
gw_renderer_parts gw_renderer_parts_of(const gw_renderer *renderer);
/* All of them. */
uint64_t gw_renderer_bytes(const gw_renderer *renderer);
/* What frames of these settings may need on the GPU beyond that, at most, however large the rectangle: it is
 * rendered in chunks, in the same buffers. bytes: of one ray, with voxels. rays: at a time. lists: bytes of
 * the samples of a frame with a gaze, or with several rays a pixel. */
void gw_renderer_ray_memory(const gw_renderer *renderer, const gw_settings *settings, uint64_t *bytes,
                            uint64_t *rays, uint64_t *lists);

#endif
