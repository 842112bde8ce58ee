/* `gazewall replay TRACK`: what is in a recording of trackers, and its poses as CSV. Main thread. */
#include "base/file.h"
#include "base/memory.h"
#include "tracking/track.h"
#include "wall/console.h"
#include "wall/options.h"
#include "wall/verbs.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct replay_options {
    gw_error *error;
    const char *track, *csv, *sender;
    int info, quiet;
    gw_log_level level;
} replay_options;

enum { KEY_INFO = 0x2000, KEY_CSV, KEY_SENDER, KEY_QUIET, KEY_LOG };

static const struct argp_option option_table[] = {
    {"info", KEY_INFO, NULL, 0, "Print what is in the track (default without --csv)", 0},
    {"csv", KEY_CSV, "FILE", 0, "Write every pose as a row: seconds, sensor, mm, quaternion x y z w", 0},
    {"sender", KEY_SENDER, "NAME", 0, "The VRPN device to read (default: the first that reports poses)", 0},
    {"quiet", KEY_QUIET, NULL, 0, "Errors only", 0},
    {"log", KEY_LOG, "LEVEL", 0, "error, warning (default), info or debug", 0},
    {0},
};

static error_t parse_option(int key, char *value, struct argp_state *state) {
    replay_options *options = state->input;
    switch (key) {
    case KEY_INFO:
        options->info = 1;
        return 0;
    case KEY_CSV:
        options->csv = value;
        return 0;
    case KEY_SENDER:
        options->sender = value;
        return 0;
    case KEY_QUIET:
        options->quiet = 1;
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
    case ARGP_KEY_END:
        if (options->track != NULL)
            return 0;
        gw_fail(options->error, GW_BAD_INPUT, "name a track: a VRPN log file, or demo");
        return EINVAL;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp replay_argp = {
    .options = option_table,
    .parser = parse_option,
    .args_doc = "TRACK",
    .doc = "What is in a recording of head and gaze trackers (a VRPN log file; demo is the embedded one)."
           "\vdocs/tracks.md tells the format byte by byte, and how to record.",
};

static int compare_times(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Times between one sensor's reports. */
typedef struct intervals {
    int64_t median, longest, longest_at; /* ns */
    size_t gaps;                         /* intervals longer than three medians and 50 ms */
} intervals;

static gw_code find_intervals(const gw_track *track, int sensor, intervals *out, gw_error *error) {
    *out = (intervals){0};
    size_t count = track->sensor_count[sensor];
    if (count < 2)
        return GW_OK;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, count - 1, sizeof(int64_t), "times between reports", error);
    if (code != GW_OK)
        return code;
    int64_t *lengths = memory;
    for (size_t i = 0; i + 1 < count; i++) {
        int64_t start = track->reports[track->sensor_reports[sensor][i]].time;
        lengths[i] = track->reports[track->sensor_reports[sensor][i + 1]].time - start;
        if (lengths[i] > out->longest) {
            out->longest = lengths[i];
            out->longest_at = start;
        }
    }
    qsort(lengths, count - 1, sizeof *lengths, compare_times);
    out->median = lengths[(count - 1) / 2];
    for (size_t i = 0; i + 1 < count; i++)
        out->gaps += lengths[i] > 50000000 && lengths[i] / 3 > out->median;
    free(lengths);
    return GW_OK;
}

static void print_range(const gw_track *track, int sensor) {
    double low[3] = {0}, high[3] = {0};
    for (size_t i = 0; i < track->sensor_count[sensor]; i++)
        for (int axis = 0; axis < 3; axis++) {
            double at = track->reports[track->sensor_reports[sensor][i]].position[axis];
            low[axis] = i == 0 || at < low[axis] ? at : low[axis];
            high[axis] = i == 0 || at > high[axis] ? at : high[axis];
        }
    printf("             x %.0f to %.0f, y %.0f to %.0f, z %.0f to %.0f mm\n", low[0], high[0], low[1],
           high[1], low[2], high[2]);
}

static gw_code print_sensor(const gw_track *track, int sensor, gw_error *error) {
    static const char *const names[2] = {"head", "gaze"};
    size_t count = track->sensor_count[sensor];
    if (count == 0 && sensor > GW_SENSOR_GAZE)
        return GW_OK; /* a viewer who is not there */
    printf("sensor %d %s: %zu poses", sensor, names[sensor % 2], count);
    if (count == 0) {
        puts("");
        return GW_OK;
    }
    const gw_pose_report *first = &track->reports[track->sensor_reports[sensor][0]];
    const gw_pose_report *last = &track->reports[track->sensor_reports[sensor][count - 1]];
    double seconds = (double)(last->time - first->time) * 1e-9;
    intervals found;
    gw_code code = find_intervals(track, sensor, &found, error);
    if (code != GW_OK)
        return code;
    printf(" from %.3f to %.3f s", (double)first->time * 1e-9, (double)last->time * 1e-9);
    if (seconds > 0.0)
        printf(", %.1f Hz (median interval %.2f ms), %zu gaps, longest interval %.1f ms at %.3f s",
               (double)(count - 1) / seconds, (double)found.median * 1e-6, found.gaps,
               (double)found.longest * 1e-6, (double)found.longest_at * 1e-9);
    puts("");
    print_range(track, sensor);
    return GW_OK;
}

static void print_counters(const gw_track_counters *c) {
    const struct {
        const char *name;
        uint64_t count;
    } rows[] = {
        {"of other types", c->other_type},
        {"of unknown types", c->unknown_type},
        {"of other senders", c->other_sender},
        {"of unknown senders", c->unknown_sender},
        {"of wrong size or name", c->bad_payload},
        {"of other sensors", c->bad_sensor},
        {"not finite", c->not_finite},
    };
    printf("records      %" PRIu64 ": %" PRIu64 " poses, %" PRIu64 " descriptions, %" PRIu64 " skipped\n",
           c->records, c->poses, c->descriptions, c->records - c->poses - c->descriptions);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (rows[i].count > 0)
            printf("             %" PRIu64 " %s\n", rows[i].count, rows[i].name);
    if (c->out_of_order > 0)
        printf("             %" PRIu64 " poses came out of order and were sorted\n", c->out_of_order);
}

static gw_code print_info(const gw_track *track, gw_error *error) {
    printf("track        %s\nsender       %s\nduration     %.3f s\n", track->name, track->sender,
           (double)track->duration * 1e-9);
    gw_code code = GW_OK;
    for (int sensor = 0; sensor < GW_TRACK_SENSORS && code == GW_OK; sensor++)
        code = print_sensor(track, sensor, error);
    print_counters(&track->counters);
    return code;
}

static gw_code write_csv(const gw_track *track, const char *path, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL)
        return gw_fail(error, GW_MACHINE, "%s: out of memory for the table", path);
    fputs("time_s,sensor,x_mm,y_mm,z_mm,qx,qy,qz,qw\n", stream);
    for (size_t i = 0; i < track->report_count; i++) {
        const gw_pose_report *r = &track->reports[i];
        fprintf(stream, "%.6f,%d,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f,%.9f\n", (double)r->time * 1e-9,
                (int)r->sensor, r->position[0], r->position[1], r->position[2], r->orientation[0],
                r->orientation[1], r->orientation[2], r->orientation[3]);
    }
    int lost = ferror(stream) != 0;
    lost |= fclose(stream) != 0;
    gw_code code = lost ? gw_fail(error, GW_MACHINE, "%s: out of memory for the table", path)
                        : gw_file_write(path, text, size, error);
    free(text);
    return code;
}

int gw_verb_replay(int argc, char **argv) {
    gw_error error = {0};
    replay_options options = {.error = &error, .level = GW_LOG_WARNING};
    int helped = 0;
    if (gw_arguments_parse(&replay_argp, argc, argv, &options, &helped, &error) != GW_OK)
        return gw_console_fail("replay", &error);
    if (helped)
        return GW_OK;
    gw_console console;
    gw_console_init(&console, "replay", options.level, options.quiet);
    gw_track_options how = {.sender = options.sender, .log = &console.log};
    gw_track *track = NULL;
    gw_code code = strcmp(options.track, "demo") == 0 && options.sender == NULL
                       ? gw_track_demo(2000.0, 1125.0, &track, &error)
                       : gw_track_load(options.track, &how, &track, &error);
    if (code == GW_OK && options.csv != NULL)
        code = write_csv(track, options.csv, &error);
    if (code == GW_OK && (options.info || options.csv == NULL))
        code = print_info(track, &error);
    gw_track_destroy(&track);
    gw_console_finish(&console);
    return code == GW_OK ? GW_OK : gw_console_fail("replay", &error);
}
