#include "wall/site.h"

const char *const gw_stereo_names[GW_STEREO_COUNT] = {
    [GW_STEREO_MONO] = "mono",
    [GW_STEREO_SIDE_BY_SIDE] = "side-by-side",
    [GW_STEREO_TOP_BOTTOM] = "top-bottom",
    [GW_STEREO_ANAGLYPH] = "anaglyph",
    [GW_STEREO_ROW_INTERLACE] = "row-interlace",
    [GW_STEREO_LEFT] = "left",
    [GW_STEREO_RIGHT] = "right",
};

void gw_site_defaults(gw_site *site) {
    for (int i = 0; i < GW_MAXIMUM_TILES; i++)
        site->panels[i] = (gw_panel){.gpu = -1, .white = {1, 1, 1}, .brightness = 1};
    site->times = (gw_site_times){.load = 600, .death = 2, .refresh = 60, .restarts = 3};
    site->address[0] = site->tracker[0] = '\0';
    gw_tracker_setup_none(&site->trackers);
    site->port = 0;
    site->eye_distance = 63;
    site->fly_speed = 2;
}
