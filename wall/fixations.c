#include "wall/fixations.h"

#include <math.h>
#include <string.h>

uint32_t gw_layout_rectangles(const gw_layout *layout, gw_wall_rectangle out[GW_MAXIMUM_TILES]) {
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        double corners[4][3];
        gw_tile_corners(&layout->tiles[t], corners);
        for (int i = 0; i < 3; i++) {
            out[t].corner[i] = corners[0][i];
            out[t].across[i] = corners[1][i] - corners[0][i];
            out[t].down[i] = corners[2][i] - corners[0][i];
        }
    }
    return layout->tile_count;
}

static void find(const gw_viewer_view *view, const gw_gaze_ray *rays, uint32_t count,
                 const gw_wall_rectangle *walls, uint32_t tiles, gw_viewer_fixation *out) {
    gw_gaze_spot spots[GW_FIXATION_SPOTS];
    gw_fixation found;
    for (uint32_t i = 0; i < count; i++)
        spots[i].is_open = gw_gaze_meets(walls, tiles, rays[i].from, rays[i].direction, spots[i].point) >= 0;
    if (!gw_fixation_of(spots, count, view->gaze_origin, &found))
        return;
    *out = (gw_viewer_fixation){.known = 1, .rests = found.is_fixation, .samples = found.used};
    memcpy(out->point, found.point, sizeof out->point);
    for (int k = 0; k < 2; k++)
        out->half_angles[k] =
            sqrt(found.half_angles[k] * found.half_angles[k] + view->gaze_error * view->gaze_error);
}

void gw_fixations_find(const gw_tracker *tracker, const gw_tracker_view *view, int64_t now,
                       const gw_layout *layout, gw_fixations *out) {
    gw_wall_rectangle walls[GW_MAXIMUM_TILES];
    gw_gaze_ray rays[GW_RECENT_GAZES];
    const uint32_t tiles = gw_layout_rectangles(layout, walls);
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < GW_TRACK_VIEWERS; i++) {
        const gw_viewer_view *viewer = &view->viewers[i];
        if (!viewer->has_gaze || viewer->confidence <= 0 || viewer->in_saccade)
            continue;
        const uint32_t count = gw_tracker_recent_gazes(tracker, i, now, rays);
        find(viewer, rays, count, walls, tiles, &out->viewers[i]);
    }
}
