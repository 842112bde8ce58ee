/* `gazewall bench WHAT`: measurements. */
#include "wall/verbs.h"

#include "base/file.h"
#include "base/suggest.h"
#include "wall/bench.h"
#include "wall/interrupt.h"
#include "wall/picture.h"
#include "wall/report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* What of --scene is opened before a bench runs. */
typedef enum bench_needs {
    NEEDS_OCTREE,
    NEEDS_SCENE,
    NEEDS_SCENES, /* several, after the bench's name; it opens them itself */
    NEEDS_NOTHING,
    NEEDS_NO_DEVICE /* nor a scene */
} bench_needs;

typedef struct bench_kind {
    const char *name;
    gw_code (*run)(gw_bench *bench, gw_error *error);
    bench_needs needs;
    int plain_lists; /* 1: compares forms of the octree that know no boxes over lists */
    int32_t depth;   /* of the octree unless --set says another; 0: the setting's default */
} bench_kind;

static const bench_kind kinds[] = {
    {"build", gw_bench_build, NEEDS_OCTREE, 0, 0},
    {"peers", gw_bench_peers, NEEDS_OCTREE, 0, 0},
    {"modes", gw_bench_modes_run, NEEDS_OCTREE, 0, 9},
    {"layouts", gw_bench_layouts, NEEDS_OCTREE, 1, 0},
    {"table2", gw_bench_table2, NEEDS_SCENES, 0, 0},
    {"growth", gw_bench_growth, NEEDS_NOTHING, 0, 0},
    {"resident", gw_bench_resident, NEEDS_SCENES, 0, 0},
    {"voxelise", gw_bench_voxelise, NEEDS_SCENE, 1, 0},
    {"rebuild", gw_bench_rebuild, NEEDS_SCENE, 0, 0},
    {"scale", gw_bench_scale, NEEDS_OCTREE, 0, 0},
    {"aliasing", gw_bench_aliasing, NEEDS_SCENES, 0, 0},
    {"tracking", gw_bench_tracking, NEEDS_NO_DEVICE, 0, 0},
    {"effects", gw_bench_effects, NEEDS_SCENES, 0, 0},
    {"accuracy", gw_bench_accuracy, NEEDS_SCENES, 0, 0},
    {"precision", gw_bench_precision, NEEDS_NOTHING, 0, 0},
};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

typedef struct bench_options {
    gw_bench bench;
    const bench_kind *kind;
} bench_options;

enum {
    KEY_OUT = 0x5000,
    KEY_QUICK,
    KEY_REPEATS,
    KEY_SIZE,
    KEY_FRAMES,
    KEY_PATH,
    KEY_POINT_LIGHT,
    KEY_DENSITY,
    KEY_TIMES_ONLY,
    KEY_KNOB,
    KEY_MAX_ERROR,
    KEY_MAX_COST,
    KEY_SAVE_PROFILE,
    KEY_RAYS
};

static const struct argp_option options_table[] = {
    {"out", KEY_OUT, "FOLDER", 0, "write WHAT.csv and WHAT.json there; made if missing", 1},
    {"quick", KEY_QUICK, NULL, 0, "fewer repeats and rays: shows that it works, measures little", 1},
    {"repeats", KEY_REPEATS, "N", 0, "1 to 1000; default 7 (quick 2), of modes 3 (1)", 1},
    {"size", KEY_SIZE, "WxH", 0,
     "px, of the picture that modes draws (default 1024x1024, quick 128x128), that effects draws (384x384, "
     "quick 96x96), that accuracy draws (384x216, quick 96x54), and whose rays peers and layouts trace "
     "(1024x576, quick 160x90)",
     1},
    {"path", KEY_PATH, "NAME", 0,
     "camera path that modes follows and effects and accuracy look from the middle of, by name or number; "
     "default: the "
     "first",
     1},
    {"point-light", KEY_POINT_LIGHT, NULL, 0,
     "modes: one point light with hard shadows instead of the scene's lights, as in the paper", 1},
    {"density", KEY_DENSITY, "N", 0,
     "modes: pictures of the path are as fine as a wall seen from near, N px a degree at their middle, "
     "however "
     "wide that makes them; 55 is a panel of 55 inches at 2 m",
     1},
    {"times-only", KEY_TIMES_ONLY, NULL, 0,
     "modes: leaves out errors and flicker, which take most of the bench's time", 1},
    {"frames", KEY_FRAMES, "N", 0,
     "1 to 64, default 4 (quick 2): pairs of frames on that path; frames of aliasing, default 12 (quick 3). "
     "accuracy: frames in a row on that path, or of a walk along the wall, for flicker and popping too; N of "
     "them take N times as long; default 1: none",
     1},
    {"knob", KEY_KNOB, "NAME", 0, "accuracy: measures only this setting; may be repeated", 1},
    {"max-error", KEY_MAX_ERROR, "METRIC=E", 0,
     "accuracy: looks for the cheapest settings whose error by a metric (flip, seen_flip, depth_95, ...; "
     "docs/metrics.md) is at most E; E alone: seen_flip. May be repeated: all must hold. Those of time "
     "(flicker, "
     "pop, ...) need --frames",
     1},
    {"max-cost", KEY_MAX_COST, "COST=N", 0,
     "accuracy: looks for the settings of least seen_flip that cost at most N: work, rays, ms or bytes", 1},
    {"save-profile", KEY_SAVE_PROFILE, "FILE", 0,
     "accuracy: writes the settings that it found there, for --profile of sim, wall and render", 1},
    {"rays", KEY_RAYS, "N", 0,
     "1000 to 1000000000, of precision in each family; default 1000000 (quick 20000)", 1},
    {0}};

static gw_code add_scene(gw_bench *bench, const char *path, gw_error *error) {
    const size_t most = sizeof bench->scenes / sizeof *bench->scenes;
    if (bench->scene_count == most)
        return gw_fail(error, GW_BAD_INPUT, "'%s' is one scene too many; a bench takes %zu", path, most);
    bench->scenes[bench->scene_count++] = path;
    return GW_OK;
}

static gw_code add_knob(gw_bench *bench, const char *name, gw_error *error) {
    const size_t most = sizeof bench->knobs / sizeof *bench->knobs;
    if (bench->knob_count == most)
        return gw_fail(error, GW_BAD_INPUT, "--knob: %zu are the most; without any, all are measured", most);
    bench->knobs[bench->knob_count++] = name;
    return GW_OK;
}

static gw_code add_bound(gw_bench *bench, const char *text, gw_error *error) {
    if (bench->bound_count == GW_BENCH_BOUNDS)
        return gw_fail(error, GW_BAD_INPUT, "--max-error: %d bounds are the most", GW_BENCH_BOUNDS);
    bench->max_errors[bench->bound_count++] = text;
    return GW_OK;
}

/* "build, peers ... or rebuild". */
static const char *names_of_kinds(char text[280]) {
    size_t used = 0;
    for (size_t i = 0; i < KIND_COUNT; i++)
        used += (size_t)snprintf(text + used, 280 - used, "%s%s",
                                 i == 0                ? ""
                                 : i + 1 == KIND_COUNT ? " or "
                                                       : ", ",
                                 kinds[i].name);
    return text;
}

static gw_code choose_kind(bench_options *o, const char *word, gw_error *error) {
    const char *names[KIND_COUNT];
    for (size_t i = 0; i < KIND_COUNT; i++) {
        names[i] = kinds[i].name;
        if (!strcmp(word, kinds[i].name) && !o->kind) {
            o->kind = &kinds[i];
            return GW_OK;
        }
    }
    if (o->kind && o->kind->needs == NEEDS_SCENES)
        return add_scene(&o->bench, word, error);
    if (o->kind)
        return gw_fail(error, GW_BAD_INPUT, "'%s' is one word too many; bench measures one thing at a time",
                       word);
    const char *near = gw_suggest(word, names, KIND_COUNT);
    char all[280];
    return gw_fail(error, GW_BAD_INPUT, "there is no bench '%s'; it is %s%s%s%s", word, names_of_kinds(all),
                   near ? " (did you mean '" : "", near ? near : "", near ? "'?)" : "");
}

static error_t parse_bench(int key, char *argument, struct argp_state *state) {
    bench_options *o = state->input;
    gw_error *error = o->bench.draw.error;
    int64_t integer = 0;
    gw_code code = GW_OK;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->bench.draw;
        break;
    case KEY_OUT:
        code = gw_parse_name("--out", argument, &o->bench.out, error);
        break;
    case KEY_QUICK:
        o->bench.quick = 1;
        break;
    case KEY_REPEATS:
        code = gw_parse_integer("--repeats", argument, 1, 1000, &integer, error);
        o->bench.repeats = (uint32_t)integer;
        break;
    case KEY_SIZE:
        code = gw_parse_pair("--size", argument, 8192, o->bench.size, error);
        break;
    case KEY_FRAMES:
        code = gw_parse_integer("--frames", argument, 1, 64, &integer, error);
        o->bench.frames = (uint32_t)integer;
        break;
    case KEY_DENSITY:
        code = gw_parse_number("--density", argument, 1, 1000, &o->bench.density, error);
        break;
    case KEY_TIMES_ONLY:
        o->bench.times_only = 1;
        break;
    case KEY_POINT_LIGHT:
        o->bench.point_light = 1;
        break;
    case KEY_RAYS:
        code = gw_parse_integer("--rays", argument, 1000, 1000000000, &integer, error);
        o->bench.rays = (uint64_t)integer;
        break;
    case KEY_PATH:
        o->bench.path = argument;
        break;
    case KEY_KNOB:
        code = add_knob(&o->bench, argument, error);
        break;
    case KEY_MAX_ERROR:
        code = add_bound(&o->bench, argument, error);
        break;
    case KEY_MAX_COST:
        o->bench.max_cost = argument;
        break;
    case KEY_SAVE_PROFILE:
        code = gw_parse_name("--save-profile", argument, &o->bench.save_profile, error);
        break;
    case ARGP_KEY_ARG:
        code = choose_kind(o, argument, error);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return code ? EINVAL : 0;
}

static const struct argp_child children[] = {{&gw_draw_argp, 0, NULL, 0}, {0}};
static const struct argp bench_argp = {
    .options = options_table,
    .parser = parse_bench,
    .args_doc = "build|peers|modes|layouts|table2 [SCENE...]|growth|resident "
                "[SCENE...]|voxelise|rebuild|scale|aliasing [SCENE...]|tracking|effects [SCENE...]|accuracy "
                "[SCENE...]|precision",
    .children = children,
    .doc =
        "build: builds the scene's octree again and again; medians, phases, pairs, bytes a triangle.\n"
        "peers: traces the same primary rays through this octree and through Embree (libembree3), in turns; "
        "ratio of the medians, and every hit on which they differ, by kind; and a foveated frame of those "
        "pixels "
        "against the peer's full one. Targets with verdicts.\n"
        "modes: draws pairs of frames of a camera path with triangles only, voxels only, hybrid and "
        "foveated, in "
        "turns, in an octree of 512^3: rays, work, time against exact triangles, error and flicker against "
        "16 rays "
        "a pixel, plain and as a viewer sees them who looks at the centre.\n"
        "scale: counts the work of walls of 1, 4, 16 and 35 panels, a ray for every pixel against a foveated "
        "frame, "
        "and the work of a ray in scenes of 10 thousand to 10 million triangles; plots.\n"
        "aliasing: each SCENE (without: a city made by formula) seen whole in 200 rows from a camera that "
        "moves slowly, "
        "one ray a pixel: error and flicker of triangles only, voxels only and both against 64 rays a "
        "pixel.\n"
        "layouts: traces the rays of peers through other forms of the octree's nodes (Weier et al.'s, 4x4x4 "
        "children, a "
        "root "
        "grid), other fetches, stacks and traversals, in turns: bytes, counted work, ratio to what ships; "
        "fails "
        "when a hit differs.\n"
        "table2: bytes of octrees refined everywhere against those that stop early, by the rules of the "
        "paper that "
        "this octree comes from and by ours, for each SCENE; its Table 2 beside it.\n"
        "growth: builds octrees of 10 thousand to 10 million triangles (quick: 300 thousand) of a rock made "
        "by "
        "formula; time, tests, nodes and bytes, fitted exponents, plots.\n"
        "resident: opens every SCENE (without: 36 rocks) with an octree of 512^3 and a renderer of its own, "
        "all at once on one device; bytes by part, one frame of each.\n"
        "voxelise: the same paper's rasterised voxeliser against refinement: pairs that one of them lacks, "
        "and why; "
        "time and bytes.\n"
        "tracking: filters of heads and gazes on people made by formula, through the whole tracker: lag "
        "against the "
        "true path, jitter at rest, error when a frame is seen, saccades found, processor time a sample.\n"
        "effects: the price list: each SCENE (without: --scene, or the demo) drawn with each effect that it "
        "calls "
        "for and "
        "without, at full quality and foveated, and with effects that nothing calls for: rays, work, bytes, "
        "time, "
        "the error of leaving it out; a chart. --quick: a small picture, the unused ones all at once.\n"
        "accuracy: the ledger: each knob of each SCENE (without: --scene, or the demo) at several values, "
        "all others "
        "as they stand, against a frame without any approximation: errors, work, bytes, time, pictures, "
        "plots, and "
        "one page that shows them together (accuracy.html), and accuracy.md, with a sentence for each knob. "
        "Geometry (hits, depths, normals, silhouettes) is compared by one more ray a pixel. What the folder "
        "of --out holds already is not "
        "measured "
        "again. --quick: a small picture and the chief knobs. --max-error and --max-cost look for settings.\n"
        "precision: rays at vertices and edges of rocks of a million triangles (quick: 6 thousand), from "
        "inside "
        "and outside: failures in a million of each rung of the triangle test, and of Embree; time; fails "
        "where "
        "what ships does.\n"
        "rebuild: octrees of an animated scene, pose after pose, built anew and rebuilt: time, buffers; "
        "fails when they differ.\v"
        "Examples:\n"
        "  gazewall bench build --scene dragon.ply --out results\n"
        "  gazewall bench peers --quick\n"
        "  gazewall bench table2 dragon.ply sponza.gltf --out results\n"
        "  gazewall bench accuracy dragon.ply --knob tau --knob samples --out ledger\n"
        "  gazewall bench accuracy --max-error seen_flip=0.05 --save-profile mine.yaml --out ledger\n"};

gw_code gw_bench_write(const gw_bench *bench, const char *name, const char *rows, size_t size,
                       gw_error *error) {
    if (!bench->out)
        return GW_OK;
    char *csv = gw_picture_path(bench->out, "%s.csv", name),
         *json = gw_picture_path(bench->out, "%s.json", name);
    gw_code code = csv && json ? GW_OK : gw_fail(error, GW_MACHINE, "memory is out while naming results");
    gw_interrupt_hold();
    if (!code)
        code = gw_file_write(csv, rows, size, error);
    if (!code)
        code = gw_report_write(bench->report, json, error);
    gw_interrupt_release();
    free(csv);
    free(json);
    return code;
}

/* The depth was 0 before the command line was read: no --set can make it that. */
static void choose_depth(const bench_kind *kind, gw_settings *settings) {
    gw_settings defaults;
    gw_settings_init(&defaults);
    if (settings->octree_depth == 0)
        settings->octree_depth = kind->depth ? kind->depth : defaults.octree_depth;
}

gw_code gw_bench_svg(const gw_bench *bench, const char *name, const char *svg, size_t size, gw_error *error) {
    char *path = gw_picture_path(bench->out, "%s.svg", name);
    gw_code code = path ? gw_file_write(path, svg, size, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming results");
    free(path);
    return code;
}

gw_code gw_bench_plot(const gw_bench *bench, const char *name, const gw_plot *plot, gw_error *error) {
    char *svg = NULL;
    size_t size = 0;
    gw_code code = gw_plot_svg(plot, &svg, &size, error);
    if (!code)
        code = gw_bench_svg(bench, name, svg, size, error);
    free(svg);
    return code;
}

gw_renderer_options gw_bench_rendering(const gw_bench *bench, int count) {
    return (gw_renderer_options){.count = count,
                                 .force_features = bench->draw.force_effects,
                                 .forbid_features = bench->draw.forbid_effects,
                                 .kernels = bench->draw.kernels ? bench->draw.kernels : GW_KERNELS_AT_ONCE,
                                 .log = &bench->console.log};
}

static gw_code prepare(bench_options *o, int argc, char **argv, gw_error *error) {
    gw_bench *bench = &o->bench;
    choose_depth(o->kind, &bench->draw.settings);
    gw_model *model = &bench->model;
    if (o->kind->plain_lists)
        bench->draw.settings.dense_leaf = 0;
    gw_code code = gw_report_create(argc, argv, &bench->report, error);
    if (!code && o->kind->needs == NEEDS_OCTREE)
        code = gw_model_open(model, &bench->draw, &bench->console.log, error);
    if (!code && o->kind->needs == NEEDS_SCENE)
        code = gw_model_import(model, &bench->draw, &bench->console.log, error);
    if (!code && o->kind->needs == NEEDS_NO_DEVICE) {
        gw_report_settings(bench->report, &bench->draw.settings, &bench->draw.profile);
        return GW_OK;
    }
    if (!code && o->kind->needs != NEEDS_OCTREE)
        code = gw_model_open_device(model, &bench->draw, &bench->console.log, error);
    if (code)
        return code;
    const gw_gl_limits *limits = gw_gl_limits_of(model->device);
    gw_report_device(bench->report, limits);
    gw_report_settings(bench->report, &bench->draw.settings, &bench->draw.profile);
    if (model->scene)
        gw_report_scene(bench->report, model->scene, model->import_ms);
    if (model->octree)
        gw_report_octree(bench->report, model->octree, model->scene, limits, model->build_ms,
                         model->from_cache);
    return GW_OK;
}

/* What a bench would not heed is refused: nobody should take its figures for others. */
static gw_code check_heeded(const bench_options *o, gw_error *error) {
    const gw_bench *bench = &o->bench;
    gw_code (*const run)(gw_bench *, gw_error *) = o->kind->run;
    const int modes = run == gw_bench_modes_run, aliasing = run == gw_bench_aliasing;
    const int effects = run == gw_bench_effects, accuracy = run == gw_bench_accuracy;
    const int draws = modes || aliasing || effects || accuracy || run == gw_bench_peers ||
                      run == gw_bench_layouts || run == gw_bench_resident;
    const char *lost = bench->size[0] && !draws                            ? "--size"
                       : bench->frames && !modes && !aliasing && !accuracy ? "--frames"
                       : bench->path && !modes && !effects && !accuracy    ? "--path"
                       : bench->point_light && !modes                      ? "--point-light"
                       : bench->density > 0 && !modes                      ? "--density"
                       : bench->times_only && !modes                       ? "--times-only"
                       : bench->knob_count && !accuracy                    ? "--knob"
                       : bench->bound_count && !accuracy                   ? "--max-error"
                       : bench->max_cost && !accuracy                      ? "--max-cost"
                       : bench->save_profile && !accuracy                  ? "--save-profile"
                       : bench->rays && run != gw_bench_precision          ? "--rays"
                                                                           : NULL;
    if (lost)
        return gw_fail(error, GW_BAD_INPUT, "bench %s has no use for %s; leave it out", o->kind->name, lost);
    return o->kind->needs >= NEEDS_NOTHING && bench->draw.scene
               ? gw_fail(error, GW_BAD_INPUT, "bench %s makes its own scenes: leave --scene out",
                         o->kind->name)
               : GW_OK;
}

int gw_verb_bench(int argc, char **argv) {
    static bench_options o;
    char all[280];
    gw_bench *bench = &o.bench;
    gw_error error = {0};
    int helped = 0;
    gw_draw_options_init(&bench->draw, &error);
    bench->draw.settings.octree_depth = 0;
    gw_code code = gw_arguments_parse(&bench_argp, argc, argv, &o, &helped, &error);
    if (helped && !code)
        return GW_OK;
    if (!code && !o.kind)
        code = gw_fail(&error, GW_BAD_INPUT, "say what to measure: gazewall bench %s", names_of_kinds(all));
    if (!code)
        code = check_heeded(&o, &error);
    if (!code)
        code = gw_file_writable(bench->draw.report, &error);
    if (!code && bench->out)
        code = gw_make_directories(bench->out, &error);
    gw_console_init(&bench->console, "bench", bench->draw.level, bench->draw.quiet);
    if (!code)
        code = prepare(&o, argc, argv, &error);
    if (!code)
        code = o.kind->run(bench, &error);
    if (!code && bench->draw.report)
        code = gw_report_write(bench->report, bench->draw.report, &error);
    gw_model_close(&bench->model);
    json_decref(bench->report);
    gw_console_finish(&bench->console);
    return code ? gw_console_fail("bench", &error) : GW_OK;
}
