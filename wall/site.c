#include "wall/site.h"

void gw_site_defaults(gw_site *site) {
    for (int i = 0; i < GW_MAXIMUM_TILES; i++)
        site->panels[i] = (gw_panel){.gpu = -1, .white = {1, 1, 1}, .brightness = 1};
    site->times = (gw_site_times){.load = 600, .death = 2, .refresh = 60};
    site->address[0] = site->tracker[0] = '\0';
    site->eye_distance = 63;
    site->fly_speed = 2;
}
