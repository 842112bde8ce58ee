/* `gazewall record SOURCE... TRACK`: live trackers, or people made by formula, into a file. Main thread. */
#include "tracking/generator.h"
#include "tracking/recording_writer.h"
#include "tracking/setup.h"
#include "wall/console.h"
#include "wall/interrupt.h"
#include "wall/options.h"
#include "wall/record_live.h"
#include "wall/verbs.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SOURCES = GW_TRACKER_SOURCES, WORDS = SOURCES + 1 };

typedef struct record_options {
    gw_error *error;
    const char *words[WORDS]; /* sources, then the track */
    int count;
    double seconds; /* 0: until it is ended */
    int64_t seed;   /* -1: not said */
    const char *bind;
    uint64_t gaze_sensors; /* bits */
    int overwrite, quiet, consent_gaze;
    gw_log_level level;
} record_options;

enum {
    KEY_SECONDS = 0x2000,
    KEY_CONSENT,
    KEY_GAZE_SENSORS,
    KEY_BIND,
    KEY_SEED,
    KEY_OVERWRITE,
    KEY_QUIET,
    KEY_LOG
};

static const struct argp_option option_table[] = {
    {"seconds", KEY_SECONDS, "S", 0, "How long (default: until Ctrl-C; generate: 10)", 0},
    {"consent-gaze", KEY_CONSENT, NULL, 0,
     "Record gazes too: who is looking has agreed to it. Without it nothing of them is written", 0},
    {"gaze-sensors", KEY_GAZE_SENSORS, "LIST", 0,
     "Sensors whose poses are gazes (default 1,3,5,7, as docs/tracks.md has it), or none", 0},
    {"bind", KEY_BIND, "ADDRESS", 0, "Numeric address of the interface to listen on (default: all)", 0},
    {"seed", KEY_SEED, "N", 0, "generate: another person, another day (default 1)", 0},
    {"overwrite", KEY_OVERWRITE, NULL, 0, "Replace a file that is there", 0},
    {"quiet", KEY_QUIET, NULL, 0, "Errors only", 0},
    {"log", KEY_LOG, "LEVEL", 0, "error, warning (default), info or debug", 0},
    {0},
};

static error_t take_word(const char *word, record_options *options) {
    if (options->count < WORDS) {
        options->words[options->count++] = word;
        return 0;
    }
    gw_fail(options->error, GW_BAD_INPUT, "at most %d sources and one track: '%s' is too much", SOURCES,
            word);
    return EINVAL;
}

/* Numbers of sensors 0 to 63 with commas between. */
static gw_code parse_sensors(const char *text, record_options *options) {
    const char *at = text;
    options->gaze_sensors = 0;
    if (strcmp(text, "none") == 0)
        return GW_OK;
    for (;; at++) {
        char *end;
        const long sensor = strtol(at, &end, 10);
        if (*at < '0' || *at > '9' || sensor > 63 || (*end != ',' && *end != '\0'))
            return gw_fail(options->error, GW_BAD_INPUT,
                           "--gaze-sensors '%s': numbers of sensors, 0 to 63, with commas between, or none",
                           text);
        options->gaze_sensors |= (uint64_t)1 << sensor;
        at = end;
        if (*end == '\0')
            return GW_OK;
    }
}

static int is_generated(const char *source) {
    return strncmp(source, "generate:", 9) == 0;
}

static error_t check_options(const record_options *options) {
    gw_error *error = options->error;
    const char *first = options->words[0];
    const int generated = options->count > 0 && is_generated(first);
    for (int i = 1; i + 1 < options->count; i++)
        if (generated || is_generated(options->words[i])) {
            gw_fail(error, GW_BAD_INPUT, "generate: stands alone: no other source is recorded with it");
            return EINVAL;
        }
    if (options->count < 2)
        gw_fail(error, GW_BAD_INPUT,
                "name a source and the track to write: gazewall record Tracker0@host "
                "head.vrpn.gz");
    else if (options->seed >= 0 && !generated)
        gw_fail(error, GW_BAD_INPUT, "--seed has no effect on %s", first);
    else if (generated && (options->consent_gaze || options->bind != NULL))
        gw_fail(error, GW_BAD_INPUT, "--consent-gaze and --bind have no effect on %s: nobody is recorded",
                first);
    else
        return 0;
    return EINVAL;
}

static error_t parse_option(int key, char *value, struct argp_state *state) {
    record_options *options = state->input;
    gw_error *error = options->error;
    switch (key) {
    case KEY_SECONDS:
        return gw_parse_number("--seconds", value, 0.1, 366.0 * 86400.0, &options->seconds, error) ? EINVAL
                                                                                                   : 0;
    case KEY_SEED:
        return gw_parse_integer("--seed", value, 0, INT64_MAX, &options->seed, error) ? EINVAL : 0;
    case KEY_CONSENT:
        options->consent_gaze = 1;
        return 0;
    case KEY_GAZE_SENSORS:
        return parse_sensors(value, options) ? EINVAL : 0;
    case KEY_BIND:
        options->bind = value;
        return 0;
    case KEY_OVERWRITE:
        options->overwrite = 1;
        return 0;
    case KEY_QUIET:
        options->quiet = 1;
        return 0;
    case KEY_LOG:
        if (gw_log_level_parse(value, &options->level))
            return 0;
        gw_fail(error, GW_BAD_INPUT, "--log '%s' is not error, warning, info or debug", value);
        return EINVAL;
    case ARGP_KEY_ARG:
        return take_word(value, options);
    case ARGP_KEY_END:
        return check_options(options);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static char *help_text(int key, const char *text, void *input) {
    char *out = NULL;
    size_t size = 0;
    (void)input;
    if (key != ARGP_KEY_HELP_POST_DOC)
        return (char *)text;
    FILE *stream = open_memstream(&out, &size);
    if (stream == NULL)
        return (char *)text;
    fprintf(stream,
            "%s\n\nPeople made by formula, for tests: the same kind, seed and length give the same "
            "file.\n",
            text);
    for (size_t i = 0; i < gw_generator_kind_count; i++)
        fprintf(stream, "  generate:%-12s %s\n", gw_generator_kinds[i].name, gw_generator_kinds[i].text);
    fclose(stream);
    return out;
}

static const struct argp record_argp = {
    .options = option_table,
    .parser = parse_option,
    .args_doc = "SOURCE... TRACK",
    .doc =
        "Records trackers into TRACK: a VRPN log, or CSV when its name ends in .csv; gzipped when it ends in "
        ".gz."
        "\vdocs/tracks.md tells the format byte by byte; gazewall replay TRACK what was recorded.",
    .help_filter = help_text,
};

static gw_code generate(const record_options *options, gw_error *error) {
    gw_recording *recording = NULL;
    const char *path = options->words[1];
    gw_code code = gw_generate(options->words[0] + 9, options->seed < 0 ? 1 : (uint64_t)options->seed,
                               options->seconds > 0.0 ? options->seconds : 10.0, &recording, error);
    if (code == GW_OK)
        code = gw_recording_write(path, GW_RECORDING_BY_NAME, recording, 0, INT64_MAX, options->overwrite,
                                  error);
    if (code == GW_OK && !options->quiet)
        printf("%s: %zu events in %.3f s, made by formula\n", path, recording->count,
               (double)recording->duration * 1e-9);
    gw_recording_destroy(&recording);
    return code;
}

static gw_code record(const record_options *options, const gw_log *log, int *interrupted, gw_error *error) {
    gw_record_wishes wishes = {.source_count = options->count - 1,
                               .track = options->words[options->count - 1],
                               .bind = options->bind,
                               .seconds = options->seconds,
                               .consent_gaze = options->consent_gaze,
                               .gaze_sensors = options->gaze_sensors,
                               .overwrite = options->overwrite,
                               .quiet = options->quiet,
                               .log = log};
    for (int i = 0; i < wishes.source_count; i++)
        wishes.sources[i] = options->words[i];
    return gw_record_live(&wishes, interrupted, error);
}

int gw_verb_record(int argc, char **argv) {
    gw_error error = {0};
    record_options options = {.error = &error, .level = GW_LOG_WARNING, .seed = -1, .gaze_sensors = 0xaa};
    int helped = 0, interrupted = 0;
    if (gw_arguments_parse(&record_argp, argc, argv, &options, &helped, &error) != GW_OK)
        return gw_console_fail("record", &error);
    if (helped)
        return GW_OK;
    gw_console console;
    gw_console_init(&console, "record", options.level, options.quiet);
    gw_code code = is_generated(options.words[0]) ? generate(&options, &error)
                                                  : record(&options, &console.log, &interrupted, &error);
    gw_console_finish(&console);
    if (code != GW_OK)
        return gw_console_fail("record", &error);
    /* Ctrl-C is how a recording ends; other signals are somebody else's haste. */
    return interrupted == 0 || interrupted == SIGINT ? GW_OK : 128 + interrupted;
}
