/* `gazewall calibrate`: unit, axes, turn and shift of a tracker from points whose places were measured, as
 * lines to paste into a site file; and what viewers' gazes at known targets are off by. Main thread. */
#include "base/file.h"
#include "tracking/calibrate.h"
#include "wall/calibrate_collect.h"
#include "wall/calibrate_file.h"
#include "wall/calibrate_live.h"
#include "wall/console.h"
#include "wall/options.h"
#include "wall/site.h"
#include "wall/verbs.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct calibrate_options {
    gw_error *error;
    const char *source, *points, *gazes, *look, *bind, *out;
    int64_t sensor;        /* -1: the file says */
    double seconds, still; /* seconds 0: not said */
    int exact, quiet;
} calibrate_options;

enum {
    KEY_POINTS = 0x2000,
    KEY_GAZE,
    KEY_LOOK,
    KEY_SENSOR,
    KEY_BIND,
    KEY_SECONDS,
    KEY_STILL,
    KEY_EXACT,
    KEY_OUT,
    KEY_QUIET
};

static const struct argp_option option_table[] = {
    {"points", KEY_POINTS, "FILE", 0,
     "The marks: where they are in wall space, and what the device reported there, or when it was there", 0},
    {"sensor", KEY_SENSOR, "N", 0,
     "The sensor that was held at the marks (default: what the file says, or 0)", 0},
    {"bind", KEY_BIND, "ADDRESS", 0, "Numeric address of the interface on which the source is listened to",
     0},
    {"seconds", KEY_SECONDS, "S", 0, "Sample for S seconds, 0.1 to 30, at a mark (default 1) or a target (2)",
     0},
    {"still", KEY_STILL, "MM", 0, "Samples that spread by more are taken again, at most twice (default 5)",
     0},
    {"exact", KEY_EXACT, NULL, 0,
     "Keep unit and turn as they were measured, where they might be a usual unit and a pure axis map", 0},
    {"gaze", KEY_GAZE, "FILE", 0, "Instead: the errors of viewers' gazes at known targets, from a file", 0},
    {"look", KEY_LOOK, "SITE", 0,
     "Instead: those errors live, of the site's viewers, who look at nine targets on its wall", 0},
    {"out", KEY_OUT, "FILE", 0, "Write the lines for the site file there instead of printing them", 0},
    {"quiet", KEY_QUIET, NULL, 0, "Print only the lines for the site file", 0},
    {0},
};

static error_t parse_end(const calibrate_options *options) {
    const int wanted = (options->points != NULL) + (options->gazes != NULL) + (options->look != NULL);
    if (wanted > 1)
        gw_fail(options->error, GW_BAD_INPUT, "--points, --gaze and --look are three things; one at a time");
    else if (wanted == 0)
        gw_fail(options->error, GW_BAD_INPUT,
                "name the marks with --points FILE, or the gazes with --gaze FILE or --look SITE; "
                "docs/calibrate.md tells how to measure them");
    else if (!options->points && (options->source || options->sensor >= 0 || options->exact || options->bind))
        gw_fail(options->error, GW_BAD_INPUT, "a source, --sensor, --bind and --exact go with --points");
    else
        return 0;
    return EINVAL;
}

static error_t parse_option(int key, char *value, struct argp_state *state) {
    calibrate_options *options = state->input;
    switch (key) {
    case KEY_POINTS:
        return gw_parse_name("--points", value, &options->points, options->error) ? EINVAL : 0;
    case KEY_GAZE:
        return gw_parse_name("--gaze", value, &options->gazes, options->error) ? EINVAL : 0;
    case KEY_LOOK:
        return gw_parse_name("--look", value, &options->look, options->error) ? EINVAL : 0;
    case KEY_BIND:
        return gw_parse_name("--bind", value, &options->bind, options->error) ? EINVAL : 0;
    case KEY_SECONDS:
        return gw_parse_number("--seconds", value, 0.1, 30, &options->seconds, options->error) ? EINVAL : 0;
    case KEY_STILL:
        return gw_parse_number("--still", value, 0, 1e6, &options->still, options->error) ? EINVAL : 0;
    case KEY_OUT:
        return gw_parse_name("--out", value, &options->out, options->error) ? EINVAL : 0;
    case KEY_SENSOR:
        return gw_parse_integer("--sensor", value, 0, 999, &options->sensor, options->error) ? EINVAL : 0;
    case KEY_EXACT:
        options->exact = 1;
        return 0;
    case KEY_QUIET:
        options->quiet = 1;
        return 0;
    case ARGP_KEY_ARG:
        if (!options->source) {
            options->source = value;
            return 0;
        }
        gw_fail(options->error, GW_BAD_INPUT, "one source at a time: '%s' is a second one after '%s'", value,
                options->source);
        return EINVAL;
    case ARGP_KEY_END:
        return parse_end(options);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp calibrate_argp = {
    .options = option_table,
    .parser = parse_option,
    .args_doc = "[SOURCE]",
    .doc =
        "Where a tracker stands in the room, in which unit and along which axes it measures: from marks "
        "whose "
        "places were measured, and what it reported there. SOURCE is a recording in which the sensor was "
        "held "
        "at the marks, or a tracker (NAME@HOST, dtrack:PORT): then you are asked to hold the sensor at one "
        "mark "
        "after the other. Where the file has all positions, none is needed."
        "\vExit codes: 0 solved; 2 the file is wrong, or the marks cannot tell; 3 a tracker is not heard of; "
        "5 --out could not be written.\n\n"
        "docs/calibrate.md leads through it, docs/sites.md tells where the lines go.\n\n"
        "gazewall calibrate Tracker0@10.0.0.5 --points marks.yaml",
};

/* --- a room
 * --------------------------------------------------------------------------------------------------- */

static gw_code take_recording(const calibrate_options *options, gw_marks *marks, gw_error *error) {
    gw_recording *recording = NULL;
    gw_code code = gw_recording_load(options->source, &recording, error);
    if (!code)
        code = gw_marks_take_recording(marks, recording, error);
    gw_recording_destroy(&recording);
    return code;
}

static gw_live_options live_options(const calibrate_options *options, double seconds, const gw_log *log) {
    return (gw_live_options){.answers = stdin,
                             .talk = stderr,
                             .seconds = options->seconds > 0 ? options->seconds : seconds,
                             .still = options->still,
                             .log = log};
}

static gw_code gather_marks(const calibrate_options *options, const gw_log *log, gw_marks *marks,
                            gw_error *error) {
    gw_code code = gw_marks_load(options->points, marks, error);
    if (code)
        return code;
    if (options->sensor >= 0)
        marks->sensor = (int32_t)options->sensor;
    uint32_t unknown = marks->count;
    for (uint32_t i = marks->count; i-- > 0;)
        if (!marks->known[i])
            unknown = i;
    if (unknown == marks->count && options->source)
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: every mark has a 'device' position, so '%s' would not be read; leave it out, or "
                       "take those positions out of the file",
                       options->points, options->source);
    if (unknown == marks->count)
        return GW_OK;
    if (!options->source)
        return gw_fail(
            error, GW_BAD_INPUT,
            "%s: mark '%s' has no 'device' position; name the tracker, or the recording in which the "
            "sensor was held there",
            options->points, marks->points[unknown].name);
    const gw_live_options live = live_options(options, 1, log);
    const int recorded = gw_file_exists(options->source);
    if (!marks->source[0] && !recorded)
        snprintf(marks->source, sizeof marks->source, "%s", options->source);
    code = recorded ? take_recording(options, marks, error)
                    : gw_marks_take_live(marks, options->source, options->bind, &live, error);
    return code ? gw_context(error, "%s", options->points) : GW_OK;
}

static void print_marks(const gw_marks *marks, const gw_calibration *found) {
    int names = 4;
    for (uint32_t i = 0; i < marks->count; i++)
        names = (int)strlen(marks->points[i].name) > names ? (int)strlen(marks->points[i].name) : names;
    printf("%-*s  %8s  %13s  %s\n", names, "mark", "off, mm", "by the others", "samples, spread in mm");
    for (uint32_t i = 0; i < marks->count; i++) {
        printf("%-*s  %8.2f  ", names, marks->points[i].name, found->residuals[i]);
        if (found->alone[i] < 0)
            printf("%13s", "-");
        else
            printf("%13.2f", found->alone[i]);
        if (marks->samples[i].count)
            printf("  %u, %.2f", marks->samples[i].count, marks->samples[i].spread * found->room.unit);
        printf("%s\n", found->left_out == (int32_t)i ? "  LEFT OUT" : "");
    }
}

static void print_findings(const gw_marks *marks, const gw_calibration *found) {
    const char *unit = gw_room_unit_name(found->room.unit);
    char axes[GW_AXIS_TEXT];
    gw_axis_map_write(&found->room.axes, axes);
    printf("rms %.2f mm; in the middle of the marks a position is good to %.2f mm, a direction to %.3f "
           "degrees\n",
           found->rms, found->expected, found->expected_turn);
    printf("unit: %.6g mm measured%s%s\n", found->measured_unit, found->unit_snapped ? ", taken for " : "",
           found->unit_snapped ? unit : "");
    printf("axes: %s, %s\n", axes,
           !found->hand_known                        ? "taken for right-handed"
           : gw_axis_map_hand(&found->room.axes) < 0 ? "left-handed"
                                                     : "right-handed");
    printf("turn: %.3f degrees measured%s\n", found->measured_turn,
           found->turn_snapped ? ", taken for none" : "");
    if (found->left_out >= 0)
        printf("mark '%s' was left out: the others put it %.0f mm from where it was measured; measure it "
               "again\n",
               marks->points[found->left_out].name, found->alone[found->left_out]);
}

/* What may be wrong although numbers came out. */
static void warn(const gw_marks *marks, const gw_calibration *found, const gw_log *log) {
    if (!found->hand_known)
        gw_log_write(log, GW_LOG_WARNING,
                     "the marks are within %.0f mm of a plane and cannot tell a left-handed device from a "
                     "right-handed one; add a mark at another height",
                     2 * found->spread[2]);
    if (found->rms > 20)
        gw_log_write(
            log, GW_LOG_WARNING,
            "marks and device disagree by %.0f mm; are the marks in this order, and is it this sensor?",
            found->rms);
    else if (found->left_out < 0 && marks->count < 6)
        gw_log_write(log, GW_LOG_INFO, "with %u marks a bad one cannot be found; 6 are enough", marks->count);
    for (uint32_t i = 0; i < marks->count; i++)
        if (marks->samples[i].count && marks->samples[i].spread * found->room.unit > 5)
            gw_log_write(log, GW_LOG_WARNING, "the sensor moved at mark '%s': samples spread by %.1f mm",
                         marks->points[i].name, marks->samples[i].spread * found->room.unit);
}

static gw_code put_out(const char *path, const char *text, size_t size, gw_error *error) {
    if (path)
        return gw_file_write(path, text, size, error);
    fwrite(text, 1, size, stdout);
    return GW_OK;
}

/* To digits that people can read, far below what marks are good to. */
static gw_room round_room(const gw_room *room) {
    gw_room out = *room;
    const double decade = pow(10, floor(log10(room->unit)) - 6);
    if (!gw_room_unit_name(room->unit))
        out.unit = rint(room->unit / decade) * decade;
    for (int i = 0; i < 4; i++)
        out.turn[i] = rint(room->turn[i] * 1e7) / 1e7 + 0.0;
    for (int i = 0; i < 3; i++)
        out.shift[i] = rint(room->shift[i] * 100) / 100 + 0.0;
    return out;
}

/* As an entry of `trackers`. */
static gw_code put_room(const calibrate_options *options, const gw_marks *marks, const gw_calibration *found,
                        gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return gw_fail(error, GW_MACHINE, "memory is out");
    const gw_room rounded = round_room(&found->room);
    fprintf(out, "trackers:\n  - source: \"%s\"\n", marks->source[0] ? marks->source : "NAME@HOST");
    gw_site_put_room(out, &rounded, "    ");
    gw_code code =
        fclose(out) ? gw_fail(error, GW_MACHINE, "memory is out") : put_out(options->out, text, size, error);
    free(text);
    return code;
}

static gw_code calibrate_room(const calibrate_options *options, const gw_log *log, gw_error *error) {
    static gw_marks marks;
    gw_calibration found;
    gw_code code = gather_marks(options, log, &marks, error);
    if (!code && gw_calibrate(marks.points, marks.count, !options->exact, &found, error))
        code = gw_context(error, "%s", options->points);
    if (code)
        return code;
    if (!options->quiet) {
        print_marks(&marks, &found);
        print_findings(&marks, &found);
    }
    warn(&marks, &found, log);
    return put_room(options, &marks, &found, error);
}

/* --- gazes
 * ---------------------------------------------------------------------------------------------------- */

static void print_viewer(uint32_t viewer, uint32_t targets, const gw_gaze_check *check) {
    printf("viewer %u: %u gazes at %u targets", viewer + 1, check->used, targets);
    if (check->dropped)
        printf(", %u more could not be used", check->dropped);
    printf("\n  on average %.2f degrees %s and %.2f %s, spread %.2f across and %.2f upright\n"
           "  half within %.2f degrees, 95 of 100 within %.2f\n",
           fabs(check->bias[0]), check->bias[0] < 0 ? "left" : "right", fabs(check->bias[1]),
           check->bias[1] < 0 ? "below" : "above", check->spread[0], check->spread[1], check->median,
           check->most);
}

static gw_code look(const calibrate_options *options, const gw_log *log, gw_gazes *out, gw_error *error) {
    static gw_site site;
    const gw_live_options live = live_options(options, 2, log);
    memset(out, 0, sizeof *out);
    gw_code code = gw_site_load(options->look, &site, error);
    if (!code && (code = gw_gazes_take_live(&site, &live, out, error)))
        gw_context(error, "%s", options->look);
    return code;
}

static gw_code check_gazes(const calibrate_options *options, const gw_log *log, gw_error *error) {
    gw_gazes gazes;
    char text[GW_TRACK_VIEWERS * 128] = "";
    gw_code code =
        options->gazes ? gw_gazes_load(options->gazes, &gazes, error) : look(options, log, &gazes, error);
    for (uint32_t v = 0; v < GW_TRACK_VIEWERS && !code; v++) {
        gw_gaze_check check;
        if (!gw_gaze_check_of(gazes.samples[v], (uint32_t)gazes.count[v], &check))
            continue;
        if (!options->quiet)
            print_viewer(v, gazes.targets[v], &check);
        if (gazes.targets[v] < 9)
            gw_log_write(log, GW_LOG_WARNING,
                         "viewer %u looked at %u targets; nine over the whole wall tell more", v + 1,
                         gazes.targets[v]);
        if (check.most > 45)
            gw_log_write(log, GW_LOG_WARNING,
                         "viewer %u: gazes are off by up to %.0f degrees: is the tracker's room right?",
                         v + 1, check.most);
        snprintf(text + strlen(text), sizeof text - strlen(text), "gaze_error: %.1f # of viewer %u\n",
                 fmin(45, ceil(10 * check.most) / 10), v + 1);
    }
    gw_gazes_finish(&gazes);
    if (!code && !text[0])
        code = gw_fail(error, options->gazes ? GW_BAD_INPUT : GW_MACHINE, "%s: no gaze of it can be used",
                       options->gazes ? options->gazes : options->look);
    return code ? code : put_out(options->out, text, strlen(text), error);
}

int gw_verb_calibrate(int argc, char **argv) {
    gw_error error = {0};
    calibrate_options options = {.error = &error, .sensor = -1, .still = 5};
    int helped = 0;
    gw_code code = gw_arguments_parse(&calibrate_argp, argc, argv, &options, &helped, &error);
    if (helped && !code)
        return GW_OK;
    gw_console console;
    gw_console_init(&console, "calibrate", options.quiet ? GW_LOG_WARNING : GW_LOG_INFO, 0);
    if (!code)
        code = options.points ? calibrate_room(&options, &console.log, &error)
                              : check_gazes(&options, &console.log, &error);
    gw_console_finish(&console);
    return code ? gw_console_fail("calibrate", &error) : GW_OK;
}
