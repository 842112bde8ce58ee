#include "wall/options.h"

#include "base/file.h"
#include "base/gl.h"
#include "base/memory.h"
#include "base/suggest.h"
#include "render/features.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- one value
 * ------------------------------------------------------------------------------------------------- */

/* A whole number in digits; 0 when text has anything else before `end`. */
static int read_integer(const char *text, const char *end, int64_t *out) {
    if (text == end || (!isdigit((unsigned char)*text) && *text != '-'))
        return 0;
    char *stop;
    errno = 0;
    long long value = strtoll(text, &stop, 10);
    *out = value;
    return stop == end && errno == 0;
}

static int read_number(const char *text, const char *end, double *out) {
    if (text == end || isspace((unsigned char)*text))
        return 0;
    char *stop;
    *out = strtod(text, &stop);
    return stop == end && isfinite(*out);
}

gw_code gw_parse_pair(const char *name, const char *text, uint32_t maximum, uint32_t out[2],
                      gw_error *error) {
    const char *cross = strchr(text, 'x');
    int64_t a = 0, b = 0;
    if (!cross || !read_integer(text, cross, &a) || !read_integer(cross + 1, text + strlen(text), &b))
        return gw_fail(error, GW_BAD_INPUT, "%s '%s' is not two whole numbers with an x between, as in %s",
                       name, text, maximum > 1000 ? "960x540" : "2x2");
    if (a < 1 || b < 1 || a > (int64_t)maximum || b > (int64_t)maximum)
        return gw_fail(error, GW_BAD_INPUT, "%s '%s' is out of range; both numbers must be 1 to %u", name,
                       text, maximum);
    out[0] = (uint32_t)a;
    out[1] = (uint32_t)b;
    return GW_OK;
}

gw_code gw_parse_numbers(const char *name, const char *text, size_t count, double *out, gw_error *error) {
    const char *at = text;
    for (size_t i = 0; i < count; i++) {
        const char *end = i + 1 < count ? strchr(at, ',') : at + strlen(at);
        if (!end || !read_number(at, end, &out[i]))
            return gw_fail(error, GW_BAD_INPUT, "%s '%s' is not %zu numbers with commas between, as in %s",
                           name, text, count, count == 2 ? "480,270" : "0,1.6,4");
        at = end + 1;
    }
    return GW_OK;
}

gw_code gw_parse_integers(const char *name, const char *text, size_t limit, uint32_t maximum, uint32_t *out,
                          size_t *count, gw_error *error) {
    *count = 0;
    for (const char *at = text;;) {
        const char *end = at + strcspn(at, ",");
        int64_t value;
        if (!read_integer(at, end, &value) || value < 1 || value > (int64_t)maximum)
            return gw_fail(
                error, GW_BAD_INPUT,
                "%s '%s': '%.*s' is not a whole number from 1 to %u (give them with commas between, as in "
                "500,200,324)",
                name, text, (int)(end - at), at, maximum);
        if (*count == limit)
            return gw_fail(error, GW_BAD_INPUT, "%s '%s' has more than %zu numbers", name, text, limit);
        out[(*count)++] = (uint32_t)value;
        if (!*end)
            return GW_OK;
        at = end + 1;
    }
}

gw_code gw_parse_number(const char *name, const char *text, double minimum, double maximum, double *out,
                        gw_error *error) {
    if (!read_number(text, text + strlen(text), out))
        return gw_fail(error, GW_BAD_INPUT, "%s '%s' is not a number", name, text);
    if (*out < minimum || *out > maximum)
        return gw_fail(error, GW_BAD_INPUT, "%s %s is out of range; it must be %g to %g", name, text, minimum,
                       maximum);
    return GW_OK;
}

gw_code gw_parse_integer(const char *name, const char *text, int64_t minimum, int64_t maximum, int64_t *out,
                         gw_error *error) {
    if (!read_integer(text, text + strlen(text), out))
        return gw_fail(error, GW_BAD_INPUT, "%s '%s' is not a whole number", name, text);
    if (*out < minimum || *out > maximum)
        return gw_fail(error, GW_BAD_INPUT, "%s %s is out of range; it must be %lld to %lld", name, text,
                       (long long)minimum, (long long)maximum);
    return GW_OK;
}

/* --- a command line
 * -------------------------------------------------------------------------------------------- */

enum { MAXIMUM_OPTIONS = 96 };

/* All options of an argp and its children, flat. */
static size_t collect(const struct argp *argp, const struct argp_option **out, size_t count) {
    for (const struct argp_option *o = argp->options; o && (o->name || o->key || o->doc); o++)
        if (o->name && count < MAXIMUM_OPTIONS)
            out[count++] = o;
    for (const struct argp_child *c = argp->children; c && c->argp; c++)
        count = collect(c->argp, out, count);
    return count;
}

static const struct argp_option *find_option(const struct argp_option *const *options, size_t count,
                                             const char *name, size_t length) {
    for (size_t i = 0; i < count; i++)
        if (!strncmp(options[i]->name, name, length) && !options[i]->name[length])
            return options[i];
    return NULL;
}

static gw_code unknown_option(const struct argp_option *const *options, size_t count, const char *word,
                              size_t length, gw_error *error) {
    const char *names[MAXIMUM_OPTIONS + 1];
    size_t known = 0;
    for (size_t i = 0; i < count; i++)
        if (!(options[i]->flags & OPTION_HIDDEN))
            names[known++] = options[i]->name;
    names[known++] = "help";
    char bare[64];
    snprintf(bare, sizeof bare, "%.*s", (int)length, word);
    const char *near = gw_suggest(bare, names, known);
    if (near)
        return gw_fail(error, GW_BAD_INPUT, "unknown option '--%s'; did you mean '--%s'?", bare, near);
    return gw_fail(error, GW_BAD_INPUT, "unknown option '--%s'; --help lists the options", bare);
}

/* Looks over argv before argp does, because argp tells its parsers nothing about an option that it does not
 * know. Leaves argp only well-formed command lines. */
static gw_code check(const struct argp *argp, int argc, char **argv, int *help, gw_error *error) {
    const struct argp_option *options[MAXIMUM_OPTIONS];
    size_t count = collect(argp, options, 0);
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        if (!strcmp(word, "--help") || !strcmp(word, "-h") || !strcmp(word, "-?")) {
            *help = 1;
            return GW_OK;
        }
        if (!strcmp(word, "--"))
            return GW_OK;
        if (word[0] != '-' || !word[1]) {
            if (!argp->parser)
                return gw_fail(error, GW_BAD_INPUT, "'%s' is one word too many; see --help", word);
            continue;
        }
        if (word[1] != '-')
            return gw_fail(error, GW_BAD_INPUT,
                           "unknown option '%s'; options are whole words after two dashes, --help lists them",
                           word);
        size_t length = strcspn(word + 2, "=");
        const struct argp_option *option = find_option(options, count, word + 2, length);
        if (!option)
            return unknown_option(options, count, word + 2, length, error);
        int has_value = word[2 + length] == '=';
        if (has_value && !option->arg)
            return gw_fail(error, GW_BAD_INPUT, "option '--%s' takes no value", option->name);
        if (option->arg && !has_value && ++i == argc)
            return gw_fail(error, GW_BAD_INPUT, "option '--%s' needs a value: --%s %s", option->name,
                           option->name, option->arg);
    }
    return GW_OK;
}

gw_code gw_arguments_parse(const struct argp *argp, int argc, char **argv, void *input, int *helped,
                           gw_error *error) {
    *helped = 0;
    gw_code code = check(argp, argc, argv, helped, error);
    if (code)
        return code;
    if (*helped) {
        char name[64];
        snprintf(name, sizeof name, "gazewall %s", argv[0]);
        argp_help(argp, stdout, ARGP_HELP_USAGE | ARGP_HELP_LONG | ARGP_HELP_DOC, name);
        return GW_OK;
    }
    error_t failed =
        argp_parse(argp, argc, argv, ARGP_NO_EXIT | ARGP_NO_ERRS | ARGP_NO_HELP | ARGP_IN_ORDER, NULL, input);
    if (failed && error->code == GW_OK)
        return gw_fail(error, GW_BAD_INPUT, "the command line could not be read (%s); see --help",
                       strerror(failed));
    return error->code;
}

/* --- the options of all drawing verbs
 * --------------------------------------------------------------------------- */

enum {
    KEY_SCENE = 0x1000,
    KEY_SET,
    KEY_PROFILE,
    KEY_PROFILE_TEXT,
    KEY_TAU,
    KEY_SAMPLES,
    KEY_SEED,
    KEY_TIME,
    KEY_ANIMATION,
    KEY_DEBUG,
    KEY_REPORT,
    KEY_SHADERS,
    KEY_COUNT,
    KEY_ALLOW,
    KEY_FORBID,
    KEY_FORCE,
    KEY_CACHE,
    KEY_CACHE_LIMIT,
    KEY_QUIET,
    KEY_LOG,
    KEY_GPU,
    KEY_KERNELS
};

static const char *const debug_names[GW_DEBUG_VIEWS] = {"none",  "levels", "steps",        "normals",
                                                        "gaze",  "rates",  "eccentricity", "footprint",
                                                        "loads", "tests",  "voxels",       "bounds"};

static const struct argp_option scene_options[] = {
    {NULL, 0, NULL, 0, "What is drawn:", 10},
    {"scene", KEY_SCENE, "FILE", 0,
     "model (.gltf .glb .obj .ply .ply.gz .stl .off) or YAML scene; default: the embedded demo scene", 10},
    {"set", KEY_SET, "NAME=VALUE", 0, "any setting, may be repeated; 'gazewall settings' lists them", 10},
    {"profile", KEY_PROFILE, "FILE", 0,
     "settings that were found together: draft, show, study, exact, or a file of 'gazewall bench accuracy'; "
     "what "
     "comes "
     "later on the command line holds over it",
     10},
    {"profile-text", KEY_PROFILE_TEXT, "TEXT", OPTION_HIDDEN, NULL, 10},
    {"animation", KEY_ANIMATION, "NAME", 0,
     "the animation of a glTF file that plays, looped: its name, its number from 0, all, or none; default: "
     "the "
     "first",
     10},
    {"cache", KEY_CACHE, "FOLDER", 0,
     "keep built octrees there and read them back in later runs, or 'none'; default: sim and render keep "
     "them "
     "in $XDG_CACHE_HOME/gazewall (~/.cache/gazewall), the others nowhere",
     10},
    {"cache-limit", KEY_CACHE_LIMIT, "MIB", 0,
     "1 to 1048576, default 4096: what the cache folder may hold; the least recently used goes first", 10},
    {"gpu", KEY_GPU, "N", 0,
     "draw on GPU N, from 0, and no other ('gazewall inspect --device' lists them); default: the first that "
     "serves",
     10},
    {"kernels", KEY_KERNELS, "WAY", 0,
     "auto, at-once or background: where kernels are compiled that a later frame calls for, while others can "
     "draw the same pixels; default auto: sim and wall in the background but on software OpenGL, the others "
     "at "
     "once",
     10},
    {NULL, 0, NULL, 0, "What is told:", 11},
    {"report", KEY_REPORT, "FILE", 0, "write the report there, as JSON", 11},
    {"quiet", KEY_QUIET, NULL, 0, "no progress and no summary, only errors", 11},
    {"log", KEY_LOG, "LEVEL", 0, "error, warning, info or debug; default info", 11},
    {"shaders", KEY_SHADERS, "FOLDER", 0, "read the shaders there instead of the embedded ones", 11},
    {0}};

static const struct argp_option frame_options[] = {
    {"tau", KEY_TAU, "FOOTPRINTS", 0,
     "0 to 64, default 1: outside the gaze a cell up to this many ray footprints wide stands for its "
     "contents "
     "(0: exact triangles everywhere); the same as --set tau=",
     10},
    {"samples", KEY_SAMPLES, "N", 0,
     "1, 2, 4, 8 or 16, default 1: rays of a pixel where the viewer sees it sharp; the same as --set "
     "samples=",
     10},
    {"seed", KEY_SEED, "N", 0, "0 to 4294967295, default 0: of every random number", 10},
    {"time", KEY_TIME, "SECONDS", 0,
     "0 to 1e6, default 0: where on the track's and the animation's clock the first frame stands", 10},
    {"debug", KEY_DEBUG, "VIEW", 0,
     "levels (red: triangles, green to blue: voxel levels), normals, gaze (accepted error), rates "
     "(pixels a "
     "ray), eccentricity, footprint, work of each ray: steps, loads (of nodes), tests (of triangles), "
     "voxels, bounds (no view: fails if anything is read out of range; slower), or none; default none",
     10},
    {"forbid-effect", KEY_FORBID, "NAME", 0,
     "leave an effect out although the scene or a frame calls for it, such as shadows; may be repeated; "
     "'gazewall inspect' lists them",
     10},
    {"force-effect", KEY_FORCE, "NAME", 0,
     "compile an effect in although nothing calls for it (slower, same pixels); may be repeated", 10},
    {"allow-effect", KEY_ALLOW, "NAME", 0,
     "take back an earlier --forbid-effect or --force-effect: what calls for the effect decides", 10},
    {"count", KEY_COUNT, NULL, 0,
     "count steps, node loads and triangle tests for the report (slower, same pixels)", 11},
    {0}};

static gw_code set_debug(gw_draw_options *options, const char *word) {
    for (size_t i = 0; i < GW_DEBUG_VIEWS; i++)
        if (!strcmp(word, debug_names[i])) {
            options->debug = (gw_debug_view)i;
            return GW_OK;
        }
    const char *near = gw_suggest(word, debug_names, GW_DEBUG_VIEWS);
    return gw_fail(options->error, GW_BAD_INPUT,
                   "--debug '%s' is no view; it is one of none, levels, steps, normals, gaze, rates, "
                   "eccentricity, footprint, loads, tests, voxels, bounds%s%s%s",
                   word, near ? " (did you mean '" : "", near ? near : "", near ? "'?)" : "");
}

/* An option that is a setting's other name. */
static gw_code set_by_name(gw_draw_options *options, const char *name, const char *text) {
    char assignment[64];
    snprintf(assignment, sizeof assignment, "%s=%s", name, text);
    gw_code code = gw_settings_assign(&options->settings, assignment, options->error);
    return code ? gw_context(options->error, "--%s", name) : GW_OK;
}

/* Of several options for one effect the last holds. */
static gw_code set_effect(gw_draw_options *options, int key, const char *name) {
    gw_features bit = 0;
    gw_code code = gw_feature_of_name(name, &bit, options->error);
    options->force_effects &= ~bit;
    options->forbid_effects &= ~bit;
    if (key == KEY_FORCE)
        options->force_effects |= bit;
    else if (key == KEY_FORBID)
        options->forbid_effects |= bit;
    return code ? gw_context(options->error, "--%s-effect",
                             key == KEY_FORCE    ? "force"
                             : key == KEY_FORBID ? "forbid"
                                                 : "allow")
                : GW_OK;
}

static gw_code set_kernels(gw_draw_options *options, const char *way) {
    static const char *const ways[GW_KERNELS_WAYS] = {"auto", "at-once", "background"};
    for (int i = 0; i < GW_KERNELS_WAYS; i++)
        if (!strcmp(way, ways[i])) {
            options->kernels = (gw_kernel_making)i;
            return GW_OK;
        }
    return gw_fail(options->error, GW_BAD_INPUT,
                   "--kernels '%s' is no way; it is auto, at-once or background", way);
}

/* What the launcher has read counts; a rank on another host may have no such file, or another. */
static gw_code take_profile(gw_draw_options *options, const char *word) {
    const size_t length = strlen(word);
    const char *text = NULL;
    for (size_t i = 0; i < options->carried_count; i++)
        if (!strncmp(options->carried[i], word, length) && options->carried[i][length] == '\n')
            text = options->carried[i] + length + 1;
    if (options->profile_count == GW_CARRIED_PROFILES)
        return gw_fail(options->error, GW_BAD_INPUT, "--profile: %d of them are the most",
                       GW_CARRIED_PROFILES);
    options->profiles[options->profile_count++] = word;
    gw_code code = text ? gw_profile_parse(text, strlen(text), word, &options->settings, &options->profile,
                                           options->error)
                        : gw_profile_apply(word, &options->settings, &options->profile, options->error);
    if (text)
        snprintf(options->profile.file, sizeof options->profile.file, "%.255s", word);
    return code ? gw_context(options->error, "--profile") : GW_OK;
}

static error_t parse_draw(int key, char *argument, struct argp_state *state) {
    gw_draw_options *options = state->input;
    gw_error *error = options->error;
    int64_t integer = 0;
    gw_code code = GW_OK;
    switch (key) {
    case KEY_SCENE:
        options->scene = argument;
        if (!*argument)
            code = gw_fail(error, GW_BAD_INPUT,
                           "--scene has an empty name; give a file, or leave it out for the demo scene");
        break;
    case KEY_SET:
        code = gw_settings_assign(&options->settings, argument, error);
        if (code)
            gw_context(error, "--set");
        break;
    case KEY_PROFILE:
        code = take_profile(options, argument);
        break;
    case KEY_PROFILE_TEXT:
        if (options->carried_count < GW_CARRIED_PROFILES)
            options->carried[options->carried_count++] = argument;
        break;
    case KEY_TAU:
        code = set_by_name(options, "tau", argument);
        break;
    case KEY_SAMPLES:
        code = set_by_name(options, "samples", argument);
        break;
    case KEY_SEED:
        code = gw_parse_integer("--seed", argument, 0, UINT32_MAX, &integer, error);
        options->seed = (uint32_t)integer;
        break;
    case KEY_TIME:
        code = gw_parse_number("--time", argument, 0, 1e6, &options->time, error);
        break;
    case KEY_ANIMATION:
        options->animation = argument;
        break;
    case KEY_DEBUG:
        code = set_debug(options, argument);
        break;
    case KEY_REPORT:
        code = gw_parse_name("--report", argument, &options->report, error);
        break;
    case KEY_SHADERS:
        options->shaders = argument;
        break;
    case KEY_CACHE_LIMIT:
        code = gw_parse_integer("--cache-limit", argument, 1, 1 << 20, &integer, error);
        options->cache_limit = (uint64_t)integer << 20;
        break;
    case KEY_CACHE:
        options->cache = argument;
        if (!*argument)
            code = gw_fail(error, GW_BAD_INPUT, "--cache has an empty name; give a folder, or 'none'");
        break;
    case KEY_ALLOW:
    case KEY_FORBID:
    case KEY_FORCE:
        code = set_effect(options, key, argument);
        break;
    case KEY_GPU:
        code = gw_parse_integer("--gpu", argument, 0, GW_GL_MAXIMUM_GPUS - 1, &integer, error);
        options->choose_gpu = 1;
        options->gpu = (int32_t)integer;
        break;
    case KEY_KERNELS:
        code = set_kernels(options, argument);
        break;
    case KEY_COUNT:
        options->count = 1;
        break;
    case KEY_QUIET:
        options->quiet = 1;
        break;
    case KEY_LOG:
        if (!gw_log_level_parse(argument, &options->level))
            code = gw_fail(error, GW_BAD_INPUT,
                           "--log '%s' is no level; it is one of error, warning, info, debug", argument);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return code ? EINVAL : 0;
}

const struct argp gw_scene_argp = {.options = scene_options, .parser = parse_draw};
static const struct argp frame_argp = {.options = frame_options, .parser = parse_draw};

static error_t pass_on(int key, char *argument, struct argp_state *state) {
    (void)argument;
    if (key != ARGP_KEY_INIT)
        return ARGP_ERR_UNKNOWN;
    state->child_inputs[0] = state->child_inputs[1] = state->input;
    return 0;
}

static const struct argp_child draw_children[] = {
    {&gw_scene_argp, 0, NULL, 0}, {&frame_argp, 0, NULL, 0}, {0}};
const struct argp gw_draw_argp = {.parser = pass_on, .children = draw_children};

void gw_draw_options_init(gw_draw_options *options, gw_error *error) {
    memset(options, 0, sizeof *options);
    options->error = error;
    options->level = GW_LOG_INFO;
    options->cache_limit = (uint64_t)4096 << 20;
    gw_settings_init(&options->settings);
    gw_profile_init(&options->profile);
}

char *gw_cache_folder(const gw_draw_options *options) {
    if (options->cache)
        return strcmp(options->cache, "none") ? gw_copy_text(options->cache) : NULL;
    if (!options->keeps)
        return NULL;
    const char *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (base && base[0] == '/') /* the specification: relative ones are ignored */
        return gw_path_join(base, "gazewall");
    return home && home[0] == '/' ? gw_path_join(home, ".cache/gazewall") : NULL;
}

gw_code gw_parse_name(const char *option, const char *argument, const char **out, gw_error *error) {
    *out = argument;
    return *argument ? GW_OK : gw_fail(error, GW_BAD_INPUT, "%s has an empty name", option);
}

gw_code gw_stray_argument(const char *argument, gw_error *error) {
    return gw_fail(error, GW_BAD_INPUT, "'%s' belongs to no option; a scene is given as --scene %s", argument,
                   argument);
}

gw_code gw_draw_options_decide_frames(const gw_draw_options *options, gw_error *error) {
    const char *given = options->seed != 0                ? "--seed"
                        : options->time != 0              ? "--time"
                        : options->debug != GW_DEBUG_NONE ? "--debug"
                                                          : NULL;
    char text[64];
    for (size_t i = 0; i < gw_setting_count && !given; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        if (row->stage == GW_SETTING_BUILD || gw_setting_value(&options->settings, row) == row->initial)
            continue;
        gw_setting_text(&options->settings, row, text);
        return gw_fail(
            error, GW_BAD_INPUT,
            "--states holds the settings of every frame; leave out %s=%s, or record states with it",
            row->name, text);
    }
    return given ? gw_fail(error, GW_BAD_INPUT, "--states holds that for every frame; leave out %s", given)
                 : GW_OK;
}
