#include "wall/replay_views.h"

#include "base/settings.h"

#include <string.h>

gw_code gw_replay_views_open(const gw_recording *recording, const gw_tracker_setup *trackers,
                             gw_replay_views *out, gw_error *error) {
    int8_t sources[GW_RECORDING_SENDERS];
    int is_site;
    gw_settings settings;
    gw_error none = {0};
    memset(out, 0, sizeof *out);
    gw_settings_init(&settings);
    if (gw_player_setup(recording, trackers, &out->setup, sources, &is_site, &none) != GW_OK) {
        gw_tracker_setup_none(&out->setup);
        return GW_OK;
    }
    const gw_tracker_options options = {.settings = &settings, .adopt_first = 1};
    gw_code code = gw_tracker_create(&out->setup, &options, &out->tracker, error);
    if (code == GW_OK)
        code = gw_player_open(recording, sources, 0, &out->player, error);
    if (code != GW_OK)
        gw_replay_views_close(out);
    return code;
}

void gw_replay_views_close(gw_replay_views *views) {
    gw_player_close(&views->player);
    gw_tracker_destroy(&views->tracker);
}

gw_viewer_view gw_replay_viewer(gw_replay_views *views, uint32_t viewer, int64_t time) {
    gw_tracker_view view;
    gw_player_feed(views->player, views->tracker, time);
    gw_tracker_at(views->tracker, time, time, &view);
    return view.viewers[viewer];
}

int gw_replay_suspect(gw_replay_views *views, const gw_recording *recording, char *text, size_t size) {
    if (views->player == NULL || recording->count == 0)
        return 0;
    gw_player_feed(views->player, views->tracker, recording->events[recording->count - 1].event.arrival);
    for (uint32_t s = 0; s < views->setup.source_count; s++)
        if (gw_tracker_suspect(views->tracker, (int)s, text, size))
            return 1;
    return 0;
}
