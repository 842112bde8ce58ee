/* Views that benches draw: along a camera path of the scene, or, where it has none, through the default wall.
 * Plain values; any thread. */
#ifndef GW_WALL_BENCH_VIEW_H
#define GW_WALL_BENCH_VIEW_H

#include "render/camera.h"
#include "wall/bench.h"

/* The paper's paths have so many frames (Weier et al. 2014, Table 3); neighbouring frames of ours are as far
 * apart as theirs. */
enum { GW_PATH_FRAMES = 700 };

typedef struct gw_bench_path {
    const gw_scene *scene;
    const gw_camera_path *path; /* NULL: the default wall, which stands still */
    uint32_t size[2];           /* px */
    double density;             /* px a degree at the middle of the path's pictures; 0: by the path's angle */
} gw_bench_path;

typedef struct gw_bench_view {
    gw_similarity placement;
    gw_plane plane;
    gw_rectangle rectangle;   /* from (0, 0) */
    double eye[3], centre[3]; /* mm; centre: of the picture */
    double pixels_per_degree; /* there; at least 1 */
} gw_bench_view;

/* bench->path, or the scene's first path, or none. side: of the square picture unless bench->size says
 * another. */
gw_code gw_bench_path_open(const gw_bench *bench, uint32_t side, gw_bench_path *out, gw_error *error);

/* Frame 0..GW_PATH_FRAMES-1, spread evenly from the path's first key to its last. */
gw_code gw_bench_view_at(const gw_bench_path *path, uint32_t frame, gw_bench_view *out, gw_error *error);

/* The state of such a view: the bench's settings, its eye, and a gaze at the centre or none. */
gw_frame_state gw_bench_state(const gw_bench *bench, const gw_bench_view *view, int gazed);

/* The first target of foveation in a view: whatever its distance, pixels as fine as 192 a degree are to the
 * viewer; at the centre a circle of 15 % of the width, margin included, has a ray for each, up to twice its
 * radius 2 x 2 share one, beyond 4 x 4. `samples` 1. */
gw_frame_state gw_bench_target_state(const gw_bench *bench, const gw_bench_view *view);

#endif
