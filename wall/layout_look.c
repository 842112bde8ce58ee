#include "wall/layout_look.h"

#include "base/portable_math.h"
#include "render/vector3.h"

#include <math.h>

/* Solves corner + x * step_x + y * step_y = origin + t * direction. */
static int meet_plane(const gw_plane *plane, const double origin[3], const double direction[3], double *t,
                      double at[2]) {
    double normal[3], across[3], from[3];
    gw_cross(plane->step_x, plane->step_y, normal);
    const double slope = gw_dot(normal, direction), area = gw_dot(normal, normal);
    if (!(fabs(slope) > 0) || !(area > 0))
        return 0;
    for (int i = 0; i < 3; i++)
        from[i] = plane->corner[i] - origin[i];
    *t = gw_dot(normal, from) / slope;
    for (int i = 0; i < 3; i++)
        from[i] = origin[i] + *t * direction[i] - plane->corner[i];
    gw_cross(from, plane->step_y, across);
    at[0] = gw_dot(across, normal) / area;
    gw_cross(plane->step_x, from, across);
    at[1] = gw_dot(across, normal) / area;
    return *t > 0;
}

int gw_layout_meet(const gw_layout *layout, const double origin[3], const double direction[3], uint32_t *tile,
                   double framed[2], double *distance) {
    double nearest = INFINITY;
    for (uint32_t i = 0; i < layout->tile_count; i++) {
        const gw_tile *candidate = &layout->tiles[i];
        const gw_rectangle *r = &candidate->rectangle;
        double t, at[2];
        if (!meet_plane(&candidate->plane, origin, direction, &t, at) || !(t < nearest))
            continue;
        const double x = at[0] - r->x, y = at[1] - r->y;
        if (x < 0 || y < 0 || x > r->width || y > r->height)
            continue;
        nearest = *distance = t;
        *tile = i;
        framed[0] = candidate->framed[0] + x;
        framed[1] = candidate->framed[1] + y;
    }
    return nearest < INFINITY;
}

size_t gw_gaze_ring(const gw_layout *layout, const gw_gaze *gaze, gw_ring_point out[GW_RING_POINTS]) {
    double eye[3], forward[3], up[3], right[3];
    size_t count = 0;
    for (int i = 0; i < 3; i++) {
        eye[i] = (double)gaze->eye[i];
        forward[i] = (double)gaze->direction[i];
        up[i] = (double)gaze->up[i];
    }
    gw_cross(forward, up, right);
    const double width = tan((double)gaze->half_width * GW_PI / 180),
                 height = tan((double)gaze->half_height * GW_PI / 180);
    for (int p = 0; p < GW_RING_POINTS; p++) {
        const double angle = 2 * GW_PI * p / GW_RING_POINTS;
        double direction[3], distance;
        uint32_t tile;
        for (int i = 0; i < 3; i++)
            direction[i] = forward[i] + width * cos(angle) * right[i] + height * sin(angle) * up[i];
        count += (size_t)gw_layout_meet(layout, eye, direction, &tile, out[count].framed, &distance);
    }
    return count;
}

void gw_layout_framed_pixel(const gw_layout *layout, const double framed[2], double pixel[2]) {
    double nearest = INFINITY;
    for (uint32_t i = 0; i < layout->tile_count; i++) {
        const gw_tile *tile = &layout->tiles[i];
        const double extent[2] = {tile->rectangle.width, tile->rectangle.height};
        double inside[2], apart = 0;
        for (int k = 0; k < 2; k++) {
            const double at = framed[k] - tile->framed[k];
            inside[k] = fmin(fmax(at, 0), extent[k]);
            apart += (at - inside[k]) * (at - inside[k]);
        }
        for (int k = 0; k < 2 && apart < nearest; k++)
            pixel[k] = tile->picture[k] + inside[k];
        nearest = fmin(nearest, apart);
    }
}
