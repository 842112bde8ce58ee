/* How far a frame is from its reference, by every metric that the ledger knows: of geometry, of the picture,
 * as a viewer sees it, over time, and in which direction. docs/metrics.md defines each, with units, sources
 * and what it was compared with; gw_metric_table has their names, once, for files and tables.
 *
 * Pure functions; memory is a few arrays of one frame's size, freed before they return. Any thread. */
#ifndef GW_RENDER_METRICS_H
#define GW_RENDER_METRICS_H

#include "base/image.h"
#include "base/status.h"
#include "render/flicker.h"
#include "render/frame_block.h"
#include "render/view.h"

#include <stdint.h>

typedef enum gw_metric {
    /* Geometry. */
    GW_METRIC_HIT_MISMATCH,
    GW_METRIC_DEPTH_MEAN,
    GW_METRIC_DEPTH_95,
    GW_METRIC_DEPTH_LARGEST,
    GW_METRIC_DEPTH_BIAS,
    GW_METRIC_PARALLAX_MEAN,
    GW_METRIC_PARALLAX_LARGEST,
    GW_METRIC_NORMAL_MEAN,
    GW_METRIC_NORMAL_95,
    GW_METRIC_NORMAL_LARGEST,
    GW_METRIC_SILHOUETTE_MEAN,
    GW_METRIC_SILHOUETTE_LARGEST,
    /* The picture. */
    GW_METRIC_CHANGED,
    GW_METRIC_LARGEST,
    GW_METRIC_PSNR,
    GW_METRIC_PSNR_RED,
    GW_METRIC_PSNR_GREEN,
    GW_METRIC_PSNR_BLUE,
    GW_METRIC_SSIM,
    GW_METRIC_SSIM_RED,
    GW_METRIC_SSIM_GREEN,
    GW_METRIC_SSIM_BLUE,
    GW_METRIC_RELATIVE_SQUARE,
    GW_METRIC_BIAS,
    GW_METRIC_BIAS_RED,
    GW_METRIC_BIAS_GREEN,
    GW_METRIC_BIAS_BLUE,
    GW_METRIC_NOT_FINITE,
    /* As it is seen. */
    GW_METRIC_FLIP,
    GW_METRIC_SEEN_FLIP,
    GW_METRIC_SEEN_PSNR,
    /* Over a track; gw_metric_track only. */
    GW_METRIC_FLICKER,
    GW_METRIC_FLICKER_99,
    GW_METRIC_POP,
    GW_METRIC_SEEN_FLICKER,
    GW_METRIC_SEEN_POP,
    GW_METRIC_COUNT
} gw_metric;

/* Which way a metric gets worse. */
typedef enum gw_metric_sense {
    GW_METRIC_UP,    /* 0 is perfect, more is worse */
    GW_METRIC_DOWN,  /* less is worse: PSNR, SSIM */
    GW_METRIC_SIGNED /* 0 is perfect; the sign tells the direction: + brighter, farther than the reference */
} gw_metric_sense;

/* How the values of a track's frames become one. */
typedef enum gw_metric_sum { GW_METRIC_SUM_MEAN, GW_METRIC_SUM_WORST, GW_METRIC_SUM_OF_TRACK } gw_metric_sum;

typedef struct gw_metric_row {
    const char *name; /* of CSV columns and JSON keys */
    const char *unit; /* "" for pure numbers */
    const char *what;
    gw_metric_sense sense;
    gw_metric_sum sum;
} gw_metric_row;
extern const gw_metric_row gw_metric_table[GW_METRIC_COUNT];

/* NAN where it could not be measured: nothing of the kind was given, or nothing was there to compare. */
typedef struct gw_metrics {
    double values[GW_METRIC_COUNT];
} gw_metrics;
void gw_metrics_clear(gw_metrics *metrics); /* all NAN */
/* How bad a value is, from 0 (perfect), so that all of them can be compared and ordered: its size, for SSIM
 * 1 - value, for PSNR the root mean square error as a share of white. NAN stays NAN. */
double gw_metric_badness(gw_metric metric, double value);

/* One frame; what is NULL is not compared. All of its arrays have the size of the frame. */
typedef struct gw_metric_frame {
    uint32_t width, height;  /* px; of the picture, too */
    const gw_image *picture; /* as shown */
    const float *light;      /* [height][width][3] linear, of any size: for what 8 bits cannot hold */
    const uint32_t
        *ids; /* [height][width] of what was hit; GW_NO_TRIANGLE: nothing. Only hit or not counts */
    const float *depths;  /* [height][width] along the ray, of what was hit, in any one unit */
    const float *normals; /* [height][width][3], of any length, of what was hit */
} gw_metric_frame;

typedef struct gw_metric_view {
    double pixels_per_degree;    /* 1..1000; gw_pixels_per_degree() of the view's middle */
    const gw_frame_block *block; /* of the viewers' gazes, for what is seen; NULL: nobody looks */
    double baseline; /* how far the other eye stands, in the unit of the depths; 0: no parallax is told */
} gw_metric_view;

/* Pixels of the plane that a degree spans at the middle of width x height of them, seen from the eye; 1 to
 * 1000. */
double gw_pixels_per_degree(const gw_plane *plane, const double eye[3], uint32_t width, uint32_t height);

/* GW_BAD_INPUT when sizes differ or pixels_per_degree is out of range. */
gw_code gw_metrics_compare(const gw_metric_frame *reference, const gw_metric_frame *test,
                           const gw_metric_view *view, gw_metrics *out, gw_error *error);

/* Means, worst cases and stability over the frames of a track, in their order. Zeroed before the first. */
typedef struct gw_metric_track {
    uint32_t frames;
    double sums[GW_METRIC_COUNT];
    uint32_t measured[GW_METRIC_COUNT]; /* frames in which it could be */
    gw_flicker plain, seen;             /* owned */
} gw_metric_track;
/* Compares the next frame, adds it, and leaves its own values in *out (may be NULL). Flicker needs pictures.
 */
gw_code gw_metric_track_add(gw_metric_track *track, const gw_metric_frame *reference,
                            const gw_metric_frame *test, const gw_metric_view *view, gw_metrics *out,
                            gw_error *error);
void gw_metric_track_cut(gw_metric_track *track); /* the next frame begins another sequence */
void gw_metric_track_of(const gw_metric_track *track, gw_metrics *out);
void gw_metric_track_finish(gw_metric_track *track);

#endif
