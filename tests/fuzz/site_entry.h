/* What a fuzzer and the unit test do with the bytes of a site file: read it, check what came out, write and
 * draw it. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_SITE_ENTRY_H
#define GW_TESTS_FUZZ_SITE_ENTRY_H

#include "wall/site.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static inline void fuzz_site_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_site_trackers(const gw_tracker_setup *setup) {
    fuzz_site_require(setup->source_count <= GW_TRACKER_SOURCES && setup->viewer_count <= GW_TRACK_VIEWERS);
    for (uint32_t s = 0; s < setup->source_count; s++) {
        const gw_room *room = &setup->sources[s].room;
        double length = 0;
        int seen = 0;
        for (int i = 0; i < 4; i++)
            length += room->turn[i] * room->turn[i];
        for (int i = 0; i < 3; i++) {
            fuzz_site_require(room->axes.sign[i] == 1 || room->axes.sign[i] == -1);
            fuzz_site_require(isfinite(room->shift[i]));
            seen |= 1 << room->axes.from[i];
        }
        fuzz_site_require(seen == 7 && room->unit > 0 && fabs(length - 1) < 1e-9 &&
                          setup->sources[s].spec[0]);
    }
    for (uint32_t v = 0; v < setup->viewer_count; v++) {
        const gw_tracker_viewer *viewer = &setup->viewers[v];
        fuzz_site_require(viewer->source >= 0 && (uint32_t)viewer->source < setup->source_count);
        fuzz_site_require(viewer->gaze_source >= 0 && (uint32_t)viewer->gaze_source < setup->source_count);
        fuzz_site_require(viewer->gaze < GW_GAZE_KINDS && viewer->gaze_error <= 45);
    }
}

/* What everybody who takes a site relies on. */
static inline void fuzz_site_sound(const gw_site *site) {
    const gw_layout *layout = &site->layout;
    fuzz_site_require(layout->tile_count >= 1 && layout->tile_count <= GW_MAXIMUM_TILES);
    for (int axis = 0; axis < 2; axis++)
        fuzz_site_require(layout->picture[axis] >= 1 && layout->picture[axis] <= GW_MAXIMUM_WALL_SIDE &&
                          layout->framed[axis] >= 1 && layout->framed[axis] <= GW_MAXIMUM_WALL_SIDE &&
                          isfinite(layout->size[axis]));
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        const gw_tile *tile = &layout->tiles[t];
        const gw_panel *panel = &site->panels[t];
        const uint32_t size[2] = {tile->rectangle.width, tile->rectangle.height};
        for (int axis = 0; axis < 2; axis++)
            fuzz_site_require(size[axis] >= 1 && tile->picture[axis] + size[axis] <= layout->picture[axis] &&
                              tile->framed[axis] + size[axis] <= layout->framed[axis]);
        for (int i = 0; i < 3; i++)
            fuzz_site_require(isfinite(tile->plane.corner[i]) && isfinite(tile->plane.step_x[i]) &&
                              isfinite(tile->plane.step_y[i]) && panel->white[i] >= 0.1 &&
                              panel->white[i] <= 1);
        fuzz_site_require(tile->name[0] && strlen(tile->name) < sizeof tile->name && panel->host[0] != '-');
        fuzz_site_require(panel->stereo < GW_STEREO_COUNT && panel->brightness >= 0.1);
    }
    fuzz_site_trackers(&site->trackers);
    fuzz_site_require(site->times.death > site->times.frame && site->times.refresh >= 1);
}

static inline void fuzz_site(const uint8_t *data, size_t size) {
    static gw_site site, again;
    static gw_site_notes notes;
    gw_error error = {0};
    char *text = NULL;
    size_t length = 0;
    gw_code code = gw_site_parse((const char *)data, size, "fuzz", &site, &notes, &error);
    fuzz_site_require((code == GW_OK) == (error.text[0] == '\0'));
    fuzz_site_require(notes.count <= GW_MAXIMUM_NOTES);
    if (code != GW_OK)
        return;
    fuzz_site_sound(&site);
    fuzz_site_require(gw_site_draw(&site, "fuzz", &text, &length, &error) == GW_OK);
    free(text);
    fuzz_site_require(gw_site_write(&site, &text, &length, &error) == GW_OK);
    fuzz_site_require(gw_site_parse(text, length, "again", &again, &notes, &error) == GW_OK);
    fuzz_site_sound(&again);
    fuzz_site_require(memcmp(&site.trackers, &again.trackers, sizeof site.trackers) == 0);
    free(text);
}

#endif
