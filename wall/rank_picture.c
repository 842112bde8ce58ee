/* A tile's own picture: what is drawn over it. */
#include "wall/rank.h"

#include "base/clock.h"
#include "base/image.h"
#include "base/memory.h"
#include "wall/frame_code.h"

#include <string.h>

void gw_rank_time(gw_rank *rank, gw_lane lane, int64_t begin) {
    rank->lane_ms[lane] = (float)((double)(gw_now_ns() - begin) * 1e-6);
}

void gw_rank_overlay(const gw_rank *rank, uint32_t tile, const gw_frame_state *state, const gw_done *done,
                     const gw_lanes *lanes, const gw_missed *missed, gw_image *image) {
    const gw_overlay_text text = {.tile = rank->site.layout.tiles[tile].name,
                                  .host = rank->site.panels[tile].host,
                                  .rank = tile,
                                  .frame = state->frame,
                                  .rays_per_second = done->render_ns > 0 ? (double)done->counters.rays * 1e9 /
                                                                               (double)done->render_ns
                                                                         : 0,
                                  .pose_age = state->gaze_count ? (double)state->gazes[0].age : -1,
                                  .late = missed->late,
                                  .skipped = missed->skipped,
                                  .lost = missed->lost,
                                  .latency = rank->latency};
    gw_overlay_draw(image, lanes, &text);
}

/* Overlay and frame code over a copy of the tile's pixels. */
gw_code gw_rank_decorate(gw_rank *rank, const gw_frame_state *state, gw_done *done, gw_error *error) {
    const gw_picture_options *options = &rank->options.pictures;
    const gw_rectangle *r = &rank->site.layout.tiles[rank->number].rectangle;
    const size_t bytes = (size_t)r->width * r->height * 4;
    memcpy(done->lanes, rank->lane_ms, sizeof done->lanes);
    if (!options->codes)
        return GW_OK;
    gw_code code = rank->shown ? GW_OK : gw_allocate((void **)&rank->shown, bytes, 1, "shown pixels", error);
    if (code)
        return code;
    gw_image image = {.width = r->width, .height = r->height, .rgba = rank->shown};
    memcpy(rank->shown, rank->pixels, bytes);
    if (options->overlay) {
        gw_lanes_note(&rank->lanes, rank->lane_ms);
        gw_rank_overlay(rank, (uint32_t)rank->number, state, done, &rank->lanes, &rank->missed, &image);
    }
    gw_frame_code_draw(&image, state->frame);
    return GW_OK;
}

const uint8_t *gw_rank_shown(const gw_rank *rank) {
    return rank->shown ? rank->shown : rank->pixels;
}
