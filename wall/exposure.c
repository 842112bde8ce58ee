#include "wall/exposure.h"

#include <math.h>
#include <string.h>

void gw_exposure_init(gw_exposure *exposure, const gw_settings *settings) {
    memset(exposure, 0, sizeof *exposure);
    exposure->automatic = settings->exposure == GW_SETTING_AUTO;
    exposure->key = settings->exposure_key;
    exposure->speed = settings->exposure_speed;
}

int gw_exposure_note(gw_exposure *exposure, uint32_t tile, const gw_luminance *luminance, uint64_t pixels) {
    const uint64_t eyes = 2;
    if (gw_luminance_pixels(luminance) > eyes * pixels)
        return 0;
    exposure->tiles[tile] = *luminance;
    return 1;
}

static double moved(const gw_exposure *exposure, double target, double seconds) {
    const double way = target - exposure->stops, most = exposure->speed * seconds;
    if (!exposure->known || seconds <= 0)
        return target;
    if (fabs(way) < GW_EXPOSURE_REST)
        return exposure->stops;
    return fabs(way) <= most ? target : exposure->stops + copysign(most, way);
}

void gw_exposure_decide(gw_exposure *exposure, gw_frame_state *state) {
    gw_luminance all = {{0}};
    double mean;
    if (!exposure->automatic)
        return;
    for (uint32_t i = 0; i < GW_MAXIMUM_TILES; i++)
        gw_luminance_add(&all, &exposure->tiles[i]);
    if (gw_luminance_mean(&all, &mean)) {
        const double wanted = log2(exposure->key) - mean;
        const double target = fmax(-GW_EXPOSURE_MOST, fmin(wanted, GW_EXPOSURE_MOST));
        exposure->stops = moved(exposure, target, (double)(state->time - exposure->time) * 1e-9);
        exposure->known = 1;
    }
    exposure->time = state->time;
    state->exposure = (float)exposure->stops;
}
