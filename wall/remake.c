/* --remake: a side-car in place of wall, scene, settings and frame. */
#include "wall/sim_options.h"

#include <string.h>

static gw_code refuse(gw_error *error, const char *what) {
    return gw_fail(error, GW_BAD_INPUT,
                   "--remake takes wall, scene, settings and frame from its file; leave out %s", what);
}

/* A setting of the command line that the side-car would overrule. */
static gw_code check_settings(const gw_sim_options *options, gw_error *error) {
    gw_settings plain;
    gw_settings_init(&plain);
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        char what[128];
        snprintf(what, sizeof what, "--set %s", row->name);
        if (gw_setting_value(&options->draw.settings, row) != gw_setting_value(&plain, row))
            return refuse(error, what);
    }
    return options->draw.force_effects || options->draw.forbid_effects
               ? refuse(error, "--force-effect and --forbid-effect")
               : GW_OK;
}

static gw_code check(const gw_sim_options *o, gw_error *error) {
    const gw_wall_options *wall = &o->wall;
    if (o->cluster)
        return gw_fail(error, GW_BAD_INPUT, "--remake makes one picture on one machine; use gazewall sim");
    if (wall->site || wall->tiles_given || wall->size_given || wall->width_count || wall->height_count ||
        wall->bezel > 0 || wall->stereo_given || wall->eye_distance >= 0)
        return refuse(error, "--site, --tiles, --size and their kin");
    if (o->track || o->gaze != GW_GAZE_FROM_TRACK || o->states || o->path)
        return refuse(error, "--track, --gaze, --no-gaze, --states and --path");
    if (o->windows == GW_WINDOWS_WALL || o->input)
        return refuse(error, "--window and --input");
    if (o->frames || o->step >= 0 || o->budget_ms > 0 || o->budget_rays > 0)
        return refuse(error, "--frames, --step and --budget");
    if (o->pictures.pattern || o->draw.animation)
        return refuse(error, o->draw.animation ? "--animation" : "--pattern");
    if (o->draw.debug != GW_DEBUG_NONE || o->draw.seed || o->draw.time > 0 || o->draw.time < 0)
        return refuse(error, "--debug, --seed and --time");
    return check_settings(o, error);
}

gw_code gw_sim_options_remake(gw_sim_options *options, gw_error *error) {
    gw_side_car *made = &options->remade;
    gw_code code = check(options, error);
    if (!code)
        code = gw_side_car_read(options->pictures.remake, made, error);
    if (code)
        return code;
    options->wall.given = &made->site;
    options->draw.settings = made->settings;
    options->draw.force_effects = made->force_effects;
    options->draw.forbid_effects = made->forbid_effects;
    options->draw.animation = made->animation;
    options->pictures.pattern = made->pattern;
    if (!options->draw.scene)
        options->draw.scene = made->scene;
    return GW_OK;
}
