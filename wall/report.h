/* The report: JSON with stable keys (docs/command-line.md); what was not measured or does not exist yet is
 * null. Also the statistics that summaries and reports share. One thread. */
#ifndef GW_WALL_REPORT_H
#define GW_WALL_REPORT_H

#include "base/gl.h"
#include "base/hash.h"
#include "base/image.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"
#include "render/predicted_error.h"
#include "render/renderer.h"
#include "tracking/recording.h"
#include "tracking/server.h"
#include "wall/build_together.h"
#include "wall/layout.h"
#include "wall/profile.h"
#include "wall/site.h"
#include "wall/swap_skew.h"

#include <jansson.h>
#include <stddef.h>

/* Every key, null, but for version and command (the words of argv with spaces between). */
gw_code gw_report_create(int argc, char **argv, json_t **out, gw_error *error);

void gw_report_device(json_t *report, const gw_gl_limits *limits);
/* Measures the float environment on the device. */
gw_code gw_report_floats(json_t *report, gw_gl *device, gw_error *error);
void gw_report_scene(json_t *report, const gw_scene *scene, double import_ms);
void gw_report_octree(json_t *report, const gw_octree *octree, const gw_scene *scene,
                      const gw_gl_limits *limits, double build_ms, int from_cache);
/* Which ranks built the octree, and how the work was divided; after gw_report_octree. */
void gw_report_builders(json_t *report, const gw_together *who);
/* Bytes of the scene's triangles on the GPU: for intersection, for shading, and their vertices. */
uint64_t gw_triangle_bytes(const gw_scene *scene);
/* The settings, and the profile that they started from. */
void gw_report_settings(json_t *report, const gw_settings *settings, const gw_profile *profile);
void gw_report_counters(json_t *report, const gw_counters *counters);
/* Warns of what must never be: pixels that are no numbers, rays that were cut off. */
void gw_report_faults(const gw_log *log, const gw_counters *counters);
/* What was predicted over the run, the knobs in force in its last frame, and the budget (taken; may be null).
 */
void gw_report_predicted_error(json_t *report, const gw_predicted_error *predicted,
                               const gw_frame_state *last, json_t *budget);
/* Key `tracking`: a recording that is played, of all its devices or the one that counts (NULL: all). */
void gw_report_recording(json_t *report, const gw_recording *recording, const char *sender);
/* Into tracking: what became of --serve. */
void gw_report_served(json_t *report, const char *name, gw_server_counters served);

/* What became of a tile (wall/gate.h). */
typedef struct gw_tile_record {
    const char *state;                 /* live, late, lost */
    uint32_t presented, late, skipped; /* frames */
    uint32_t lost, returned;           /* times */
    uint32_t lost_frame;               /* where it was last lost, if it was */
    uint32_t rejoin_ms;                /* to its first frame after it was started again; 0: it was not */
    const char *fault;                 /* NULL or "": none */
    double processor_ms;               /* that its rank has used */
} gw_tile_record;
/* A record for each tile. */
void gw_report_tiles(json_t *report, const gw_layout *layout, const gw_tile_record *records);
/* gate and swap_skew_ms; dropped: connections at the gate's door. The median and the largest skew (ms) come
 * back for the summary. */
void gw_report_gate(json_t *report, int live, const gw_site_times *times, uint32_t dropped,
                    const gw_swap_skew *swaps, double *median, double *maximum);

typedef struct gw_spread {
    double median, p95, maximum, minimum;
} gw_spread;
/* Of count values; all zero for none. */
gw_spread gw_spread_of(const double *values, size_t count);
/* frames, and frame_ms by the times of the `known` last of them. */
void gw_report_frames(json_t *report, const double *milliseconds, size_t known, size_t frame_count);

/* Whether the frames are all that were asked for. */
void gw_report_ended(json_t *report, int interrupted);

/* Hash of size and pixels. */
gw_hash gw_image_hash(const gw_image *image);
/* file may be NULL when the picture was not written. */
void gw_report_image(json_t *report, const char *file, const gw_image *image);

/* Writes it, keys in their fixed order. */
gw_code gw_report_write(const json_t *report, const char *path, gw_error *error);

#endif
