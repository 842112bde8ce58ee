/* Where pixels are: planes of the wall, rectangles of them, and the placement of scene space in wall space.
 * Plain values, host only, no state; any thread. */
#ifndef GW_RENDER_VIEW_H
#define GW_RENDER_VIEW_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* A plane of pixels in wall space (mm). Pixel (x, y) has its centre at corner + (x + 0.5) * step_x + (y +
 * 0.5) * step_y; x to the right, y downwards. All tiles cut from one plane use its numbers, so that a pixel's
 * ray does not depend on the tile: only on the plane and the wall-global pixel. */
typedef struct gw_plane {
    double corner[3];            /* outer corner of pixel (0,0) */
    double step_x[3], step_y[3]; /* mm per pixel */
} gw_plane;

/* A rectangle of a plane's pixels; x and y may be negative (aprons). */
typedef struct gw_rectangle {
    int32_t x, y;
    uint32_t width, height; /* px, at least 1 */
} gw_rectangle;

/* Similarity wall_mm = scale * rotation * scene_m + translation. */
typedef struct gw_similarity {
    double rotation[3][3]; /* orthonormal, det +1 */
    double scale;          /* wall mm per scene m, > 0 */
    double translation[3];
} gw_similarity;

/* Resolves the scene's placement for a wall: width and height in mm, centre in wall space, its plane facing
 * +z, and the neutral eye. */
gw_code gw_place_scene(const gw_scene *scene, double wall_width, double wall_height,
                       const double wall_centre[3], const double neutral_eye[3], gw_similarity *out,
                       gw_error *error);
/* The neutral eye stands at the viewpoint and looks along it, at the scale of the scene's own placement by
 * viewpoint, or true to scale. */
gw_code gw_place_viewpoint(const gw_scene *scene, const gw_viewpoint *view, const double neutral_eye[3],
                           gw_similarity *out, gw_error *error);
void gw_scene_to_wall(const gw_similarity *placement, const double scene[3], double wall[3]);
void gw_wall_to_scene(const gw_similarity *placement, const double wall[3], double scene[3]);
/* Wall space to the octree's rebased space. */
void gw_wall_to_rebased(const gw_similarity *placement, const gw_scene *scene, const double wall[3],
                        double rebased[3]);

#endif
