/* What frames cost, by a model that is printed beside the measurement: C = R (c_r + v c_v + t c_t + s c_s),
 * R rays of pixels, v nodes and voxels, t triangle tests and s further rays (mirrors, glass, shadows, cones)
 * a ray, and the prices c_* of one of each. The same for bytes: of the octree's parts and of a frame's rays.
 *
 * Prices come from measurements by least squares of the relative error, none below 0 (Lawson and Hanson,
 * Solving Least Squares Problems, 1974, ch. 23; with so few terms every subset is tried, which finds the same
 * optimum without iterations). A model that is off by more than GW_COST_FACTOR is flagged: a cost model of a
 * printed GPU paper was wrong by 1000 and nobody saw. Plain values; any thread. */
#ifndef GW_WALL_COST_MODEL_H
#define GW_WALL_COST_MODEL_H

#include "base/status.h"
#include "render/renderer.h"

#include <jansson.h>
#include <stddef.h>

enum { GW_COST_TERMS = 4 };
#define GW_COST_FACTOR 3.0

typedef enum gw_cost_kind { GW_COST_TIME, GW_COST_MEMORY } gw_cost_kind;

/* Amounts of the terms of its kind, and what was measured: ms, or bytes. */
typedef struct gw_cost_sample {
    double amounts[GW_COST_TERMS], measured;
} gw_cost_sample;
/* One frame, or the mean of several with the mean of their counters. Counted work (gw_renderer_options.count)
 * is needed. */
gw_cost_sample gw_cost_of_frame(const gw_counters *counters, double ms);
/* A renderer that has drawn frames: octree_bytes of nodes, lists and voxels as built, triangles and pixels as
 * numbers. */
gw_cost_sample gw_cost_of_memory(const gw_octree *octree, const gw_scene *scene, uint64_t pixels,
                                 uint64_t bytes);

typedef struct gw_cost_model {
    gw_cost_kind kind;
    double prices[GW_COST_TERMS]; /* ms or bytes for one; 0: nothing measured tells that it costs anything */
    double error;                 /* root mean square of model / measured - 1 */
    size_t samples;
} gw_cost_model;

/* GW_BAD_INPUT without samples, or when one is not finite, or measured nothing. Fewer samples than terms
 * leave prices at 0 that others explain as well. */
gw_code gw_cost_fit(gw_cost_kind kind, const gw_cost_sample *samples, size_t count, gw_cost_model *out,
                    gw_error *error);
double gw_cost_predict(const gw_cost_model *model, const gw_cost_sample *sample);

typedef struct gw_cost_verdict {
    double predicted, ratio; /* predicted over measured */
    int flagged;             /* 1: not within GW_COST_FACTOR, or no number */
} gw_cost_verdict;
gw_cost_verdict gw_cost_judge(const gw_cost_model *model, const gw_cost_sample *sample);
/* The sample at `which` by a model of all the others: what the model is worth for settings not measured. With
 * fewer than two samples, flagged. */
gw_code gw_cost_judge_left_out(gw_cost_kind kind, const gw_cost_sample *samples, size_t count, size_t which,
                               gw_cost_verdict *out, gw_error *error);

/* Names of a kind's terms for columns, and units of their prices: "ns" or "bytes" for one. */
const char *gw_cost_term(gw_cost_kind kind, size_t term);
/* {kind, unit, prices{name: price}, error, samples}. NULL when memory is out. */
json_t *gw_cost_report(const gw_cost_model *model);
/* "ray 12.1 ns + node 3.2 ns + ..." into text, cut at size. */
void gw_cost_describe(const gw_cost_model *model, char *text, size_t size);

#endif
