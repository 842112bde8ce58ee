/* `gazewall record SOURCE... TRACK`: live trackers, or people made by formula, into a file. Main thread. */
#include "tracking/generator.h"
#include "tracking/recording_writer.h"
#include "wall/console.h"
#include "wall/options.h"
#include "wall/verbs.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { SOURCES = 4, WORDS = SOURCES + 1 };

typedef struct record_options {
    gw_error *error;
    const char *words[WORDS]; /* sources, then the track */
    int count;
    double seconds; /* 0: until it is ended */
    int64_t seed;   /* -1: not said */
    int overwrite, quiet;
    gw_log_level level;
} record_options;

enum { KEY_SECONDS = 0x2000, KEY_SEED, KEY_OVERWRITE, KEY_QUIET, KEY_LOG };

static const struct argp_option option_table[] = {
    {"seconds", KEY_SECONDS, "S", 0, "How long (default: generate: 10)", 0},
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

static int is_generated(const char *source) {
    return strncmp(source, "generate:", 9) == 0;
}

static error_t check_options(const record_options *options) {
    gw_error *error = options->error;
    if (options->count < 2)
        gw_fail(error, GW_BAD_INPUT,
                "name a source and the track to write: gazewall record "
                "generate:standing head.vrpn.gz");
    else if (options->count > 2 && is_generated(options->words[0]))
        gw_fail(error, GW_BAD_INPUT, "%s stands alone: no other source is recorded with it",
                options->words[0]);
    else if (options->seed >= 0 && !is_generated(options->words[0]))
        gw_fail(error, GW_BAD_INPUT, "--seed has no effect on %s", options->words[0]);
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

int gw_verb_record(int argc, char **argv) {
    gw_error error = {0};
    record_options options = {.error = &error, .level = GW_LOG_WARNING, .seed = -1};
    int helped = 0;
    if (gw_arguments_parse(&record_argp, argc, argv, &options, &helped, &error) != GW_OK)
        return gw_console_fail("record", &error);
    if (helped)
        return GW_OK;
    gw_code code = generate(&options, &error);
    return code == GW_OK ? GW_OK : gw_console_fail("record", &error);
}
