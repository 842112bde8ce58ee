#include "wall/stereo.h"

#include <inttypes.h>
#include <string.h>

static int shows_both(gw_stereo stereo) {
    return stereo != GW_STEREO_MONO && stereo != GW_STEREO_LEFT && stereo != GW_STEREO_RIGHT;
}

/* Of view i: -1 the left eye, 0 between them, 1 the right one. */
static int side_of(gw_stereo stereo, uint32_t i) {
    if (shows_both(stereo))
        return i ? 1 : -1;
    return stereo == GW_STEREO_LEFT ? -1 : stereo == GW_STEREO_RIGHT ? 1 : 0;
}

static void place_eye(const gw_frame_state *state, int side, double eye[3]) {
    for (int i = 0; i < 3; i++)
        eye[i] = state->eye[i] + side * (double)state->eye_offset[i];
}

/* Pixels twice as wide (axis 0) or as high (1) over the same area. A tile that begins with an odd pixel of
 * its plane shifts the plane by one, so that all others share its numbers. */
static void halve(gw_eye_view *view, int axis) {
    double *step = axis ? view->plane.step_y : view->plane.step_x;
    int32_t *first = axis ? &view->rectangle.y : &view->rectangle.x;
    uint32_t *size = axis ? &view->rectangle.height : &view->rectangle.width;
    const int odd = *first & 1;
    for (int i = 0; i < 3; i++) {
        view->plane.corner[i] += odd * step[i];
        step[i] *= 2;
    }
    *first = (*first - odd) / 2;
    *size /= 2;
}

/* First row of the tile that the wall shows to an eye, 0 or 1. */
static uint32_t first_row(const gw_tile *tile, uint32_t eye) {
    return (eye + tile->picture[1]) & 1;
}

/* Every second row of the wall: pixels twice as high, about the middle of the row that shows them. */
static void take_rows(gw_eye_view *view, const gw_tile *tile, uint32_t eye) {
    const uint32_t first = first_row(tile, eye);
    const int32_t row = tile->rectangle.y + (int32_t)first, odd = row & 1;
    for (int i = 0; i < 3; i++) {
        view->plane.corner[i] += (odd - 0.5) * view->plane.step_y[i];
        view->plane.step_y[i] *= 2;
    }
    view->rectangle.y = (row - odd) / 2;
    view->rectangle.height = (tile->rectangle.height - first + 1) / 2;
}

uint32_t gw_stereo_views(gw_stereo stereo, const gw_tile *tile, const gw_frame_state *state,
                         gw_eye_view views[GW_MOST_EYES]) {
    const uint32_t count = shows_both(stereo) ? 2 : 1;
    for (uint32_t i = 0; i < count; i++) {
        gw_eye_view *view = &views[i];
        view->plane = tile->plane;
        view->rectangle = tile->rectangle;
        place_eye(state, side_of(stereo, i), view->eye);
        if (stereo == GW_STEREO_SIDE_BY_SIDE)
            halve(view, 0);
        else if (stereo == GW_STEREO_TOP_BOTTOM)
            halve(view, 1);
        else if (stereo == GW_STEREO_ROW_INTERLACE)
            take_rows(view, tile, i);
    }
    return count;
}

void gw_stereo_place(gw_stereo stereo, const gw_tile *tile, uint32_t view, const uint8_t *view_pixels,
                     uint8_t *tile_pixels) {
    const size_t width = tile->rectangle.width, height = tile->rectangle.height, row_bytes = width * 4;
    switch (stereo) {
    case GW_STEREO_SIDE_BY_SIDE:
        for (size_t row = 0; row < height; row++)
            memcpy(tile_pixels + row * row_bytes + view * row_bytes / 2, view_pixels + row * row_bytes / 2,
                   row_bytes / 2);
        break;
    case GW_STEREO_TOP_BOTTOM:
        memcpy(tile_pixels + view * (height / 2) * row_bytes, view_pixels, height / 2 * row_bytes);
        break;
    case GW_STEREO_ROW_INTERLACE:
        for (size_t row = first_row(tile, view), from = 0; row < height; row += 2, from++)
            memcpy(tile_pixels + row * row_bytes, view_pixels + from * row_bytes, row_bytes);
        break;
    case GW_STEREO_ANAGLYPH:
        for (size_t i = 0; i < width * height * 4; i += 4)
            for (size_t channel = 0; channel < 4; channel++)
                if (view == (channel > 0))
                    tile_pixels[i + channel] = view_pixels[i + channel];
        break;
    default:
        memcpy(tile_pixels, view_pixels, height * row_bytes);
    }
}

size_t gw_stereo_scratch(gw_stereo stereo, const gw_tile *tile) {
    const size_t width = tile->rectangle.width, height = tile->rectangle.height;
    if (!shows_both(stereo))
        return 0;
    return 4 * (stereo == GW_STEREO_ANAGLYPH       ? width * height
                : stereo == GW_STEREO_SIDE_BY_SIDE ? width / 2 * height
                                                   : width * ((height + 1) / 2));
}

gw_code gw_stereo_draw(gw_renderer *renderer, const gw_similarity *placement, gw_stereo stereo,
                       const gw_tile *tile, const gw_frame_state *state, uint8_t *scratch, uint8_t *pixels,
                       gw_counters *counters, gw_error *error) {
    gw_eye_view views[GW_MOST_EYES];
    const uint32_t count = gw_stereo_views(stereo, tile, state, views);
    gw_code code = GW_OK;
    for (uint32_t i = 0; i < count && !code; i++) {
        gw_frame_state seen = *state;
        memcpy(seen.eye, views[i].eye, sizeof seen.eye);
        gw_renderer_choose_view(renderer, i);
        code = gw_renderer_frame(renderer, placement, &views[i].plane, &views[i].rectangle, &seen,
                                 count > 1 ? scratch : pixels, counters, error);
        if (!code && count > 1)
            gw_stereo_place(stereo, tile, i, scratch, pixels);
    }
    return code;
}

gw_code gw_stereo_predict(const gw_scene *scene, const gw_octree *octree, const gw_similarity *placement,
                          gw_stereo stereo, const gw_tile *tile, const gw_frame_state *state,
                          gw_predicted_error *out, gw_error *error) {
    gw_eye_view views[GW_MOST_EYES];
    const uint32_t count = gw_stereo_views(stereo, tile, state, views);
    gw_code code = GW_OK;
    for (uint32_t i = 0; i < count && !code; i++) {
        gw_frame_state seen = *state;
        memcpy(seen.eye, views[i].eye, sizeof seen.eye);
        code = gw_predict_error(scene, octree, placement, &views[i].plane, &views[i].rectangle, &seen, out,
                                error);
    }
    return code;
}

int gw_site_is_stereo(const gw_site *site) {
    for (uint32_t i = 0; i < site->layout.tile_count; i++)
        if (site->panels[i].stereo != GW_STEREO_MONO)
            return 1;
    return 0;
}

gw_code gw_stereo_check_tile(const gw_site *site, uint32_t index, gw_error *error) {
    const gw_tile *tile = &site->layout.tiles[index];
    const uint32_t stereo = site->panels[index].stereo;
    const uint32_t width = tile->rectangle.width, height = tile->rectangle.height;
    if (stereo == GW_STEREO_SIDE_BY_SIDE && width % 2)
        return gw_fail(error, GW_BAD_INPUT,
                       "tile '%s' is %" PRIu32 " px wide; side by side gives each eye half of them: make it "
                       "an even number",
                       tile->name, width);
    if (stereo == GW_STEREO_TOP_BOTTOM && height % 2)
        return gw_fail(error, GW_BAD_INPUT,
                       "tile '%s' is %" PRIu32 " px high; top-bottom gives each eye half of them: make it "
                       "an even number",
                       tile->name, height);
    if (stereo == GW_STEREO_ROW_INTERLACE && height < 2)
        return gw_fail(error, GW_BAD_INPUT,
                       "tile '%s' is one row high; row-interlace gives each eye every second row",
                       tile->name);
    return GW_OK;
}

gw_code gw_stereo_check(const gw_site *site, gw_error *error) {
    gw_code code = GW_OK;
    for (uint32_t i = 0; i < site->layout.tile_count && !code; i++)
        code = gw_stereo_check_tile(site, i, error);
    return code;
}
