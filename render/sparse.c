/* See sparse.h. */
#include "render/sparse.h"

#include "base/portable_math.h"
#include "render/vector3.h"

#include <math.h>

static double along(const double point[3], const float axis[4]) {
    return point[0] * (double)axis[0] + point[1] * (double)axis[1] + point[2] * (double)axis[2];
}

/* Degrees that a point lies outside the viewer's ellipse, less than 0 inside, and its distance: as
 * acuity_of() of shaders/trace/gaze.glsl, in double. */
static double outside_of(const gw_viewer *viewer, const double point[3], double *distance) {
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
    *distance = sqrt(gw_dot(towards, towards));
    return eccentricity - half_angle;
}

/* Spacing of samples, ray units, that the viewer cannot tell apart at a point. */
static double spacing_of(const gw_frame_block *block, const gw_viewer *viewer, const double point[3]) {
    double distance, outside = outside_of(viewer, point, &distance);
    double blurred = fmax(outside - (double)block->accuracy[3], 0);
    double pitch = 0.5 * ((double)block->acuity[1] + (double)block->acuity[0] * blurred) * (GW_PI / 180.0);
    return distance * fmin(pitch, 1.0);
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

/* A pixel as seen in the direction of point, per unit of t: the wider axis. */
static double width_at(const gw_frame_block *block, const double point[3]) {
    return fmax(step_width(block->step_x, point), step_width(block->step_y, point));
}

static void point_at(const gw_frame_block *block, double x, double y, double out[3]) {
    for (int i = 0; i < 3; ++i)
        out[i] = (double)block->corner[i] + (double)block->step_x[i] * x + (double)block->step_y[i] * y;
}

double gw_sparse_spacing(const gw_frame_block *block, double x, double y) {
    double point[3], least = INFINITY;
    point_at(block, x, y, point);
    for (uint32_t i = 0; i < block->counts[0]; ++i)
        least = fmin(least, spacing_of(block, &block->viewers[i], point));
    double width = width_at(block, point);
    return width > 0 ? least / width : 0;
}

double gw_sparse_widest_pixel(const gw_frame_block *block, double x, double y) {
    double point[3], enters = 0, leaves = INFINITY;
    point_at(block, x, y, point);
    for (int i = 0; i < 3; ++i) {
        const double eye = (double)block->eye[i], one = (-1 - eye) / point[i], other = (1 - eye) / point[i];
        if (point[i] != 0) {
            enters = fmax(enters, fmin(one, other));
            leaves = fmin(leaves, fmax(one, other));
        } else if (fabs(eye) > 1) {
            leaves = 0;
        }
    }
    return leaves > enters && isfinite(leaves) ? leaves * width_at(block, point) : 0;
}

double gw_sparse_tau(const gw_frame_block *block, double x, double y) {
    const double tau = (double)block->accuracy[0], inside = (double)block->accuracy[1],
                 blend = (double)block->accuracy[2];
    double point[3], distance, least = INFINITY;
    point_at(block, x, y, point);
    for (uint32_t i = 0; i < block->counts[0]; ++i) {
        double outside = outside_of(&block->viewers[i], point, &distance);
        double ramp = blend > 0 ? fmin(fmax(outside / blend, 0), 1) : outside > 0;
        least = fmin(least, inside + (tau - inside) * (ramp * ramp * (3 - 2 * ramp)));
    }
    return block->counts[0] > 0 ? least : inside;
}

static double seed_distance_of(const gw_frame_block *block, const gw_viewer *viewer, const double point[3],
                               double farthest) {
    double normal[3], to_wall = 0, towards[3], from_centre[3];
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = (double)block->step_x[j] * (double)block->step_y[k] -
                    (double)block->step_x[k] * (double)block->step_y[j];
        to_wall += ((double)block->corner[i] - (double)viewer->eye[i]) * normal[i];
        towards[i] = point[i] - (double)viewer->eye[i];
    }
    const double centre = to_wall / along(normal, viewer->forward); /* where the gaze meets the wall */
    if (!(centre > 0 && centre < 1e30))
        return farthest;
    for (int i = 0; i < 3; ++i)
        from_centre[i] = towards[i] - (double)viewer->forward[i] * centre;
    const double x = along(towards, viewer->right) / (double)viewer->up[3],
                 y = along(towards, viewer->up) / (double)viewer->forward[3],
                 beyond = sqrt(x * x + y * y) - along(towards, viewer->forward);
    if (beyond <= 0)
        return 0;
    /* The line from the centre to the point leaves the cone at a share centre / (beyond + centre) of it. */
    const double distance = beyond / (beyond + centre) * sqrt(gw_dot(from_centre, from_centre));
    return fmin(distance * (double)block->step_x[3], farthest);
}

double gw_sparse_seed_distance(const gw_frame_block *block, double x, double y) {
    double point[3], least = 1023;
    point_at(block, x, y, point);
    for (uint32_t i = 0; i < block->counts[0]; ++i)
        least = fmin(least, seed_distance_of(block, &block->viewers[i], point, least));
    return least;
}
