/* `gazewall replay TRACK`: what is in a recording of trackers, as text, table or drawing; or it is played to
 * others. Main thread. */
#include "base/file.h"
#include "tracking/recording_writer.h"
#include "tracking/server.h"
#include "tracking/track.h"
#include "wall/console.h"
#include "wall/options.h"
#include "wall/replay.h"
#include "wall/report.h"
#include "wall/verbs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct replay_options {
    gw_error *error;
    const char *track, *csv, *sender, *plot, *report, *site;
    gw_replay_pace pace;          /* .serve NULL: it is not played */
    double from, to, speed_limit; /* s, s, units per s */
    int info, quiet, step;
    gw_log_level level;
} replay_options;

enum {
    KEY_INFO = 0x2000,
    KEY_CSV,
    KEY_PLOT,
    KEY_REPORT,
    KEY_SITE,
    KEY_SERVE,
    KEY_SPEED,
    KEY_LOOP,
    KEY_STEP,
    KEY_SENDER,
    KEY_FROM,
    KEY_TO,
    KEY_SPEED_LIMIT,
    KEY_QUIET,
    KEY_LOG
};

static const struct argp_option option_table[] = {
    {"info", KEY_INFO, NULL, 0, "Print what is in the track (what it does without other wishes)", 0},
    {"csv", KEY_CSV, "FILE", 0, "Write every event as a row (docs/tracks.md lists the columns)", 0},
    {"plot", KEY_PLOT, "FILE.svg", 0, "Draw position and speed over time, and the gazes on the wall", 0},
    {"site", KEY_SITE, "FILE", 0,
     "The wall that --plot draws gazes on, and its trackers' units, axes and viewers (default: 2000 x 1125 "
     "mm)",
     0},
    {"serve", KEY_SERVE, "SPEC", 0,
     "Play it: vrpn[:PORT] to VRPN clients, from the first one on; dtrack[:ADDRESS:PORT] or "
     "gaze:ADDRESS:PORT by datagrams",
     0},
    {"speed", KEY_SPEED, "X", 0, "With --serve: so many times as fast (default 1)", 0},
    {"loop", KEY_LOOP, NULL, 0, "With --serve: again and again, until it is ended", 0},
    {"step", KEY_STEP, NULL, 0, "With --serve: the events of one moment for each Enter", 0},
    {"report", KEY_REPORT, "FILE.json", 0, "Write what --info prints as JSON", 0},
    {"sender", KEY_SENDER, "NAME", 0, "Only this device of the recording", 0},
    {"from", KEY_FROM, "SECONDS", 0, "Leave out what arrived before", 0},
    {"to", KEY_TO, "SECONDS", 0, "Leave out what arrived then and later", 0},
    {"speed-limit", KEY_SPEED_LIMIT, "UNITS", 0, "Faster than this per second is a jump (default 5; metres)",
     0},
    {"quiet", KEY_QUIET, NULL, 0, "Errors only", 0},
    {"log", KEY_LOG, "LEVEL", 0, "error, warning (default), info or debug", 0},
    {0},
};

static error_t parse_text(int key, char *value, replay_options *options) {
    switch (key) {
    case KEY_CSV:
        return gw_parse_name("--csv", value, &options->csv, options->error) ? EINVAL : 0;
    case KEY_PLOT:
        return gw_parse_name("--plot", value, &options->plot, options->error) ? EINVAL : 0;
    case KEY_SITE:
        options->site = value;
        return 0;
    case KEY_SERVE:
        options->pace.serve = value;
        return gw_server_check(value, options->error) ? EINVAL : 0;
    case KEY_REPORT:
        return gw_parse_name("--report", value, &options->report, options->error) ? EINVAL : 0;
    case KEY_SENDER:
        options->sender = value;
        return 0;
    case KEY_LOG:
        if (gw_log_level_parse(value, &options->level))
            return 0;
        gw_fail(options->error, GW_BAD_INPUT, "--log '%s' is not error, warning, info or debug", value);
        return EINVAL;
    case ARGP_KEY_ARG:
        if (options->track == NULL) {
            options->track = value;
            return 0;
        }
        gw_fail(options->error, GW_BAD_INPUT, "one track at a time: '%s' is a second one after '%s'", value,
                options->track);
        return EINVAL;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t check_options(const replay_options *options) {
    if (options->track == NULL)
        gw_fail(options->error, GW_BAD_INPUT, "name a track: a recording, or demo, walking, ...");
    else if (options->plot != NULL && !gw_path_has_extension(options->plot, ".svg"))
        gw_fail(options->error, GW_BAD_INPUT, "--plot %s: the drawing is SVG, so its name ends in .svg",
                options->plot);
    else if (options->pace.serve == NULL &&
             (options->step || options->pace.loop || options->pace.speed != 1.0))
        gw_fail(options->error, GW_BAD_INPUT, "--speed, --loop and --step have no effect without --serve");
    else if (options->step && options->pace.speed != 1.0)
        gw_fail(options->error, GW_BAD_INPUT, "--step and --speed exclude each other");
    else if (options->to <= options->from)
        gw_fail(options->error, GW_BAD_INPUT, "--to %g is not after --from %g", options->to, options->from);
    else
        return 0;
    return EINVAL;
}

static error_t parse_option(int key, char *value, struct argp_state *state) {
    const double year = 366.0 * 86400.0;
    replay_options *options = state->input;
    gw_error *error = options->error;
    switch (key) {
    case KEY_INFO:
        options->info = 1;
        return 0;
    case KEY_LOOP:
        options->pace.loop = 1;
        return 0;
    case KEY_STEP:
        options->step = 1;
        return 0;
    case KEY_SPEED:
        return gw_parse_number("--speed", value, 0.01, 100.0, &options->pace.speed, error) ? EINVAL : 0;
    case KEY_QUIET:
        options->quiet = 1;
        return 0;
    case KEY_FROM:
        return gw_parse_number("--from", value, 0.0, year, &options->from, error) ? EINVAL : 0;
    case KEY_TO:
        return gw_parse_number("--to", value, 0.0, year, &options->to, error) ? EINVAL : 0;
    case KEY_SPEED_LIMIT:
        return gw_parse_number("--speed-limit", value, 1e-6, 1e9, &options->speed_limit, error) ? EINVAL : 0;
    case ARGP_KEY_END:
        return check_options(options);
    default:
        return parse_text(key, value, options);
    }
}

static const struct argp replay_argp = {
    .options = option_table,
    .parser = parse_option,
    .args_doc = "TRACK",
    .doc = "What is in a recording of head and gaze trackers (a VRPN log or CSV, also gzipped; demo, walking "
           "and the "
           "others of configs/tracks by name alone); or it is played to other programs."
           "\vdocs/tracks.md tells the format byte by byte, and how to record.",
};

/* Leaves in it what --sender, --from and --to ask for. */
static gw_code choose(gw_recording *recording, const replay_options *options, gw_error *error) {
    const int32_t sender = options->sender != NULL ? gw_recording_sender(recording, options->sender) : -1;
    size_t kept = 0;
    if (options->sender != NULL && sender < 0) {
        char names[256] = "none";
        size_t used = 0;
        for (uint32_t i = 0; i < recording->sender_count && used < sizeof names; i++)
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "",
                                     recording->senders[i]);
        return gw_fail(error, GW_BAD_INPUT, "%s: there is no sender %s in it; senders: %s", recording->name,
                       options->sender, names);
    }
    for (size_t i = 0; i < recording->count; i++) {
        const double at = (double)recording->events[i].event.arrival * 1e-9;
        if ((sender < 0 || recording->events[i].sender == (uint32_t)sender) && at >= options->from &&
            at < options->to)
            recording->events[kept++] = recording->events[i];
    }
    recording->count = kept;
    if (kept == 0)
        return gw_fail(error, GW_BAD_INPUT, "%s: there is no event in it%s", recording->name,
                       options->sender != NULL || options->from > 0.0 ? " that was asked for" : "");
    return GW_OK;
}

/* What was found in a recording. */
typedef struct findings {
    gw_recording_statistics statistics;
    gw_replay_views views;
    char suspected[256]; /* its unit; "": it is not */
} findings;

static gw_code write_report(int argc, char **argv, const char *path, const gw_recording *recording,
                            const findings *found, gw_error *error) {
    json_t *report = NULL;
    gw_code code = gw_report_create(argc, argv, &report, error);
    if (code != GW_OK)
        return code;
    gw_replay_report(report, recording, &found->statistics, found->suspected);
    code = gw_report_write(report, path, error);
    json_decref(report);
    return code;
}

/* The wall that synthetic tracks and the demo track were made in front of, as one tile. */
static gw_code plain_wall(gw_site *site, gw_error *error) {
    const gw_grid grid = {.columns = 1,
                          .rows = 1,
                          .widths = {1920},
                          .heights = {1080},
                          .pitch = {2000.0 / 1920.0, 1125.0 / 1080.0},
                          .eye = {0, 0, 1800}};
    gw_site_defaults(site);
    return gw_layout_grid(&grid, &site->layout, error);
}

static gw_code draw(const gw_recording *recording, findings *found, const gw_site *site,
                    const replay_options *options, gw_error *error) {
    char *svg = NULL;
    size_t size = 0;
    gw_code code = gw_replay_draw(recording, &found->statistics, &found->views, site, &svg, &size, error);
    if (code == GW_OK)
        code = gw_file_write(options->plot, svg, size, error);
    free(svg);
    return code;
}

/* The wall and its trackers, and how the recording looks to them. */
static gw_code find(const gw_recording *recording, const replay_options *options, gw_site *site,
                    findings *found, gw_error *error) {
    const double gaze_limit = 1000.0; /* degrees per s: no saccade is faster (Bahill et al. 1975) */
    gw_code code = options->site ? gw_site_load(options->site, site, error) : plain_wall(site, error);
    if (code == GW_OK)
        code = gw_recording_measure(recording, options->speed_limit, gaze_limit, &found->statistics, error);
    if (code == GW_OK)
        code = gw_replay_views_open(recording, &site->trackers, &found->views, error);
    if (code == GW_OK &&
        !gw_replay_suspect(&found->views, recording, found->suspected, sizeof found->suspected))
        found->suspected[0] = '\0';
    return code;
}

static gw_code show(int argc, char **argv, const gw_recording *recording, const replay_options *options,
                    gw_error *error) {
    findings found = {.suspected = ""};
    gw_site *site = calloc(1, sizeof *site);
    if (site == NULL)
        return gw_fail(error, GW_MACHINE, "out of memory for the wall");
    gw_code code = find(recording, options, site, &found, error);
    if (code == GW_OK && options->csv != NULL)
        code = gw_recording_write(options->csv, GW_RECORDING_AS_CSV, recording, 0, INT64_MAX, 1, error);
    if (code == GW_OK && options->plot != NULL)
        code = draw(recording, &found, site, options, error);
    if (code == GW_OK && options->report != NULL)
        code = write_report(argc, argv, options->report, recording, &found, error);
    const int asked = options->csv || options->report || options->plot || options->pace.serve;
    if (code == GW_OK && (options->info || !asked))
        gw_replay_print(recording, &found.statistics, found.suspected);
    gw_replay_views_close(&found.views);
    gw_recording_statistics_finish(&found.statistics);
    free(site);
    return code;
}

int gw_verb_replay(int argc, char **argv) {
    gw_error error = {0};
    replay_options options = {
        .error = &error, .level = GW_LOG_WARNING, .to = 1e18, .speed_limit = 5.0, .pace.speed = 1.0};
    int helped = 0, interrupted = 0;
    if (gw_arguments_parse(&replay_argp, argc, argv, &options, &helped, &error) != GW_OK)
        return gw_console_fail("replay", &error);
    if (helped)
        return GW_OK;
    gw_console console;
    gw_console_init(&console, "replay", options.level, options.quiet);
    gw_recording *recording = NULL;
    gw_code code = gw_track_load(options.track, &recording, &error);
    if (code == GW_OK && recording->damage.found) {
        char damage[512];
        gw_recording_damage_text(recording, damage, sizeof damage);
        gw_log_write(&console.log, GW_LOG_WARNING, "%s: %s; what is before it is used: %.3f s",
                     recording->name, damage, (double)recording->duration * 1e-9);
    }
    if (code == GW_OK)
        code = choose(recording, &options, &error);
    if (code == GW_OK)
        code = show(argc, argv, recording, &options, &error);
    if (options.step)
        options.pace.speed = 0.0;
    if (code == GW_OK && options.pace.serve != NULL)
        code = gw_replay_play(recording, &options.pace, &console.log, options.quiet, &interrupted, &error);
    gw_recording_destroy(&recording);
    gw_console_finish(&console);
    if (code != GW_OK)
        return gw_console_fail("replay", &error);
    return interrupted ? 128 + interrupted : GW_OK;
}
