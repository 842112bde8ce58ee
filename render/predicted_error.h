/* The error that a frame pays for its speed, by the acuity model: how many times farther apart than the
 * sharpest viewer can resolve the frame's samples lie, or voxels accepted in place of triangles reach. 1:
 * nobody can tell; 2: twice too coarse.
 *
 * What a viewer resolves is taken from the state's own settings (acuity_slope, gaze_margin, the ellipse with
 * the gaze's age), not from those that budget mode strained, and never finer than the wall's pixels. At a
 * place of the plane with a resolved spacing of r pixels and l = max(1, r), squares of p pixels a sample (1 /
 * sqrt(samples) where a pixel counts by itself), footprint f = max(min(p, 1), gaze_footprint r') with r' the
 * spacing under the strained settings, and the tau in force there, the error is max(1, p / l, tau f / l).
 * With gaze_rule seed every pixel has its ray: f = (1 + d) / sqrt(samples), d the distance along the wall
 * from the ellipse over seed_distance, and p is up to 2 where rate_blend blurs. Where even the octree's
 * smallest cells are more than 2 tau f as wide as the ray is at most in the octree's cube, no voxel stands
 * for anything and f is 0. Plain values; any thread. */
#ifndef GW_RENDER_PREDICTED_ERROR_H
#define GW_RENDER_PREDICTED_ERROR_H

#include "render/frame_block.h"

#include <stdint.h>

/* Over places of the plane; parts of a wall add up. */
typedef struct gw_predicted_error {
    double worst; /* 0: no place yet */
    double sum;
    uint64_t places;
} gw_predicted_error;

/* Places stand GW_PREDICTION_STEP pixels apart, at wall-global pixels, so that no split changes them. */
enum { GW_PREDICTION_STEP = 32 };

/* Error at a position of the plane, px: `given` and `in_force` are the blocks of the state with strain 1 and
 * of the state as it is drawn, least_cell the side of the octree's smallest cells, rebased units. */
double gw_predicted_error_at(const gw_frame_block *given, const gw_frame_block *in_force,
                             const gw_frame_state *state, double least_cell, double x, double y);

/* Adds the places of a rectangle that is drawn from the state. */
gw_code gw_predict_error(const gw_scene *scene, const gw_octree *octree, const gw_similarity *placement,
                         const gw_plane *plane, const gw_rectangle *rectangle, const gw_frame_state *state,
                         gw_predicted_error *out, gw_error *error);
void gw_predicted_error_add(gw_predicted_error *to, const gw_predicted_error *from);
double gw_predicted_error_worst(const gw_predicted_error *error); /* 1 when there is no place */
double gw_predicted_error_mean(const gw_predicted_error *error);  /* 1 when there is no place */

#endif
