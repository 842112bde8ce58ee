/* The spacing of samples that viewers resolve, on the host and in double: the rule by which shaders/sample
 * rates blocks, for filters and tests. Plain values; any thread. */
#ifndef GW_RENDER_SPARSE_H
#define GW_RENDER_SPARSE_H

#include "render/frame_block.h"

/* Spacing of samples, in pixels, that the sharpest viewer resolves at a position of the plane (pixels, not
 * whole); INFINITY when nobody's gaze is known. */
double gw_sparse_spacing(const gw_frame_block *block, double x, double y);

/* Width of a pixel where its ray leaves the octree's cube, rebased units: the widest that anything there is
 * seen with. 0 when the ray does not meet the cube. */
double gw_sparse_widest_pixel(const gw_frame_block *block, double x, double y);

/* The smallest tau that a viewer calls for there; tau_inside when nobody's gaze is known. */
double gw_sparse_tau(const gw_frame_block *block, double x, double y);

/* gaze_rule seed (shaders/trace/gaze_seed.glsl): distance along the wall from the nearest viewer's ellipse
 * over seed_distance; 0 inside, at most 1023. */
double gw_sparse_seed_distance(const gw_frame_block *block, double x, double y);

#endif
