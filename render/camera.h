/* Cameras: where a scene's camera path is at a time, and the plane of pixels that a camera looks through.
 * Plain values, host only, in double; any thread. */
#ifndef GW_RENDER_CAMERA_H
#define GW_RENDER_CAMERA_H

#include "base/status.h"
#include "build/scene.h"
#include "render/frame_state.h"
#include "render/view.h"

/* The path of a scene by name or number from 0. GW_BAD_INPUT when there is none, naming what there is. */
gw_code gw_camera_path_find(const gw_scene *scene, const char *name, const gw_camera_path **out,
                            gw_error *error);

/* Eye and look-at (scene metres) at a time in seconds: through all keys, smooth in between (cubic, the slope
 * at a key is that of the line between its neighbours: Catmull and Rom 1974, for keys that are not evenly
 * spaced). Before the first key and after the last one it stands still. */
void gw_camera_path_at(const gw_camera_path *path, double time, double eye[3], double look_at[3]);

/* What a perspective camera is: a plane of pixels across the view at the distance of what is looked at, in a
 * wall space that is the scene's, in mm. */
typedef struct gw_perspective {
    gw_similarity placement;
    gw_plane plane;
    double eye[3], centre[3]; /* mm; centre: of the plane's pixels */
} gw_perspective;

/* fov: vertical, deg. Straight up or down, or with an up along the view, the picture's top is away from us.
 * GW_BAD_INPUT when eye and look_at are the same point. */
gw_code gw_perspective_of(const double eye[3], const double look_at[3], const double up[3], double fov,
                          const uint32_t size[2], gw_perspective *out, gw_error *error);

/* Where the scene stands for a frame: as the state's navigation says, or, where it has none, as
 * gw_place_scene() does. */
gw_code gw_place_frame(const gw_scene *scene, const gw_frame_state *state, double wall_width,
                       double wall_height, const double wall_centre[3], const double neutral_eye[3],
                       gw_similarity *out, gw_error *error);

#endif
