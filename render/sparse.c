/* See sparse.h. */
#include "render/sparse.h"

#include "base/portable_math.h"
#include "render/vector3.h"

#include <math.h>

static double along(const double point[3], const float axis[4]) {
    return point[0] * (double)axis[0] + point[1] * (double)axis[1] + point[2] * (double)axis[2];
}

/* Spacing of samples, ray units, that the viewer cannot tell apart at a point: acuity_of() of
 * shaders/trace/gaze.glsl in double. */
static double spacing_of(const gw_frame_block *block, const gw_viewer *viewer, const double point[3]) {
    double towards[3];
    for (int i = 0; i < 3; ++i)
        towards[i] = point[i] - (double)viewer->eye[i];
    double x = along(towards, viewer->right), y = along(towards, viewer->up),
           z = along(towards, viewer->forward);
    double across = sqrt(x * x + y * y);
    double eccentricity = gw_atan2(across, z) * (180.0 / GW_PI);
    double half_width = fmax((double)viewer->eye[3], 1e-3),
           half_height = fmax((double)viewer->right[3], 1e-3);
    double spread = sqrt(x / half_width * (x / half_width) + y / half_height * (y / half_height));
    double half_angle = spread > 0 ? across / spread : half_height;
    double blurred = fmax(eccentricity - half_angle - (double)block->accuracy[3], 0);
    double pitch = 0.5 * ((double)block->acuity[1] + (double)block->acuity[0] * blurred) * (GW_PI / 180.0);
    return sqrt(gw_dot(towards, towards)) * fmin(pitch, 1.0);
}

/* Width of a pixel's step as seen from the rendering eye in the direction of point. */
static double step_width(const float step[4], const double point[3]) {
    double square = gw_dot(point, point), part = square > 0 ? along(point, step) / square : 0, sum = 0;
    for (int i = 0; i < 3; ++i) {
        double across = (double)step[i] - point[i] * part;
        sum += across * across;
    }
    return sqrt(sum);
}

double gw_sparse_spacing(const gw_frame_block *block, double x, double y) {
    double point[3], least = INFINITY;
    for (int i = 0; i < 3; ++i)
        point[i] = (double)block->corner[i] + (double)block->step_x[i] * x + (double)block->step_y[i] * y;
    for (uint32_t i = 0; i < block->counts[0]; ++i)
        least = fmin(least, spacing_of(block, &block->viewers[i], point));
    double width = fmax(step_width(block->step_x, point), step_width(block->step_y, point));
    return width > 0 ? least / width : 0;
}
