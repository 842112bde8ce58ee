/* `gazewall inspect`: what is in a scene and its octree, or what this machine's GL device is. */
#include "wall/verbs.h"

#include "base/gl_probe.h"
#include "build/octree_picture.h"
#include "wall/console.h"
#include "wall/inspect_report.h"
#include "wall/interrupt.h"
#include "wall/model.h"
#include "wall/picture.h"
#include "wall/report.h"

#include "base/file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct inspect_options {
    gw_draw_options draw;
    const char *out;
    int device;
    int validate;
} inspect_options;

enum { PICTURE_SIDE = 1024 }; /* px of the scene's longer side */

enum { KEY_DEVICE = 0x4000, KEY_OUT, KEY_VALIDATE };

static const struct argp_option options_table[] = {
    {"device", KEY_DEVICE, NULL, 0, "tell about the GL device instead of a scene: limits, float environment",
     1},
    {"out", KEY_OUT, "FOLDER", 0,
     "write the report there, as inspect.json, and pictures of the octree's cells by level: levels_x.png, "
     "levels_y.png, levels_z.png",
     1},
    {"validate", KEY_VALIDATE, NULL, 0,
     "check every node of the octree on the GPU: kinds, masks, links, lists, overlap, areas; what is wrong "
     "is "
     "named, and the exit code is 3",
     1},
    {0}};

static error_t parse_inspect(int key, char *argument, struct argp_state *state) {
    inspect_options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->draw;
        return 0;
    case KEY_DEVICE:
        o->device = 1;
        return 0;
    case KEY_OUT:
        return gw_parse_name("--out", argument, &o->out, o->draw.error) ? EINVAL : 0;
    case KEY_VALIDATE:
        o->validate = 1;
        return 0;
    case ARGP_KEY_ARG:
        if (!o->draw.scene) {
            o->draw.scene = argument;
            return 0;
        }
        gw_fail(o->draw.error, GW_BAD_INPUT, "'%s' is one scene too many; inspect takes one", argument);
        return EINVAL;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&gw_scene_argp, 0, NULL, 0}, {0}};
static const struct argp inspect_argp = {.options = options_table,
                                         .parser = parse_inspect,
                                         .args_doc = "[SCENE]",
                                         .children = children,
                                         .doc = "What is in a scene, what was dropped and why, which effects "
                                                "it calls for, and its octree; or what the GL "
                                                "device is. Without SCENE: the embedded demo scene.\v"
                                                "Examples:\n"
                                                "  gazewall inspect model.glb --report model.json\n"
                                                "  gazewall inspect --device\n"};

/* --- the device
 * -------------------------------------------------------------------------------------------------- */

static void print_device(const gw_gl_limits *l) {
    printf("renderer           %s (%s)%s\n", l->renderer, l->vendor, l->software ? ", software" : "");
    printf("version            %s\n", l->version);
    printf("storage block      %.0f MiB, %d blocks a stage, %d binding points\n",
           (double)l->storage_block_bytes / 1048576.0, l->storage_blocks, l->storage_bindings);
    printf("buffer texture     %" PRId64 " texels, %d units a stage\n", l->texture_buffer_texels,
           l->texture_units);
    printf("work groups        %" PRId64 " x %" PRId64 " x %" PRId64 ", %d invocations, %d bytes shared\n",
           l->work_groups[0], l->work_groups[1], l->work_groups[2], l->work_group_invocations,
           l->shared_bytes);
    printf("textures           %d px a side, %d layers\n", l->texture_side, l->texture_layers);
    printf("program binaries   %d format%s\n", l->program_binary_formats,
           l->program_binary_formats == 1 ? "" : "s");
    printf("resets of the GPU  %s\n", l->resets_told ? "told by the driver" : "not told by the driver");
}

static void print_floats(const gw_float_environment *f) {
    printf("a*b+c              %s without 'precise', %s with it; fma() %s\n",
           f->contracts ? "rounded once" : "rounded twice",
           f->precise_holds ? "rounded twice" : "ROUNDED ONCE",
           f->fma_fused ? "rounds once" : "rounds twice");
    printf("division           %s (%u of %d wrong in the last bit)\n",
           f->division_exact ? "exact" : "not exact", f->division_wrong, GW_PROBE_SAMPLES);
    printf("square root        %s (%u of %d wrong in the last bit)\n", f->sqrt_exact ? "exact" : "not exact",
           f->sqrt_wrong, GW_PROBE_SAMPLES);
    printf("denormals          %s; infinity %s; NaN %s\n", f->denormals_kept ? "kept" : "flushed to zero",
           f->infinity_kept ? "kept" : "lost", f->nan_kept ? "seen" : "not seen");
    printf("min, max of NaN    %s; conversion beyond an int %s\n",
           f->minimum_is_number ? "the number" : "not always the number",
           f->conversion_saturates ? "saturates" : "is anything");
    if (!f->precise_holds)
        printf("                   'precise' does not hold: set triangle_precision=ordered, or rays pass "
               "between triangles\n");
}

static void tell_gpus(json_t *report, int quiet) {
    gw_gl_gpu gpus[GW_GL_MAXIMUM_GPUS];
    const size_t count = gw_gl_list_gpus(gpus);
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) {
        if (!quiet)
            printf("%-18s %zu: %s\n", i ? "" : "GPUs (--gpu N)", i, gpus[i].name);
        json_array_append_new(list, json_string(gpus[i].name));
    }
    json_object_set_new(json_object_get(report, "device"), "gpus", list);
}

static gw_code inspect_device(gw_model *model, const inspect_options *o, const gw_log *log, json_t *report,
                              gw_error *error) {
    gw_float_environment floats = {0};
    gw_code code = gw_model_open_device(model, &o->draw, log, error);
    if (!code)
        code = gw_gl_probe_floats(model->device, &floats, error);
    if (code)
        return code;
    if (!o->draw.quiet) {
        print_device(gw_gl_limits_of(model->device));
        print_floats(&floats);
    }
    gw_report_device(report, gw_gl_limits_of(model->device));
    tell_gpus(report, o->draw.quiet);
    return gw_report_floats(report, model->device, error);
}

/* --- a scene
 * ----------------------------------------------------------------------------------------------------- */

static void print_dropped(const gw_dropped *dropped) {
    const char *between = "dropped            ";
    for (size_t i = 0; i < gw_dropped_row_count; i++) {
        const uint64_t count = gw_dropped_by(dropped, &gw_dropped_rows[i]);
        if (count == 0)
            continue;
        printf("%s%" PRIu64 " %s", between, count, gw_dropped_rows[i].words);
        between = ", ";
    }
    printf("%s", between[0] == 'd' ? "dropped            nothing\n" : "\n");
}

static void print_hash(const char *label, gw_hash hash) {
    char text[33];
    gw_hash_text(hash, text);
    printf("%s%s\n", label, text);
}

static void print_scene(const gw_scene *s) {
    printf("scene              %s\n", s->path);
    printf("triangles          %" PRIu32 ", %" PRIu32 " vertices (%" PRIu32 " positions)\n",
           s->triangle_count, s->vertex_count, s->welded_count);
    print_dropped(&s->dropped);
    printf("box                %g,%g,%g to %g,%g,%g m\n", s->bounds[0][0], s->bounds[0][1], s->bounds[0][2],
           s->bounds[1][0], s->bounds[1][1], s->bounds[1][2]);
    printf("materials          %" PRIu32 ", textures %" PRIu32 ", lights %" PRIu32 ", viewpoints %" PRIu32
           ", camera paths %" PRIu32 "\n",
           s->material_count, s->texture_count, s->light_count, s->viewpoint_count, s->path_count);
    for (uint32_t i = 0; i < s->texture_count; i++)
        printf("    texture        %s, %ux%u px\n", s->textures[i].name, s->textures[i].image.width,
               s->textures[i].image.height);
    for (uint32_t i = 0; i < s->viewpoint_count; i++)
        printf("    viewpoint      %s\n", s->viewpoints[i].name);
    for (uint32_t i = 0; i < s->path_count; i++)
        printf("    camera path    %s, %g to %g s\n", s->paths[i].name, s->paths[i].keys[0].time,
               s->paths[i].keys[s->paths[i].key_count - 1].time);
    for (size_t i = 0; i < s->note_count; i++)
        printf("note               %s\n", s->notes[i]);
    print_hash("hash               ", s->hash);
}

static void print_octree(const gw_octree *t, const gw_scene *scene, double build_ms) {
    const gw_octree_statistics *s = &t->statistics;
    printf("octree             depth %" PRIu32 " (deepest node %" PRIu32 "), built in %.0f ms\n", t->depth,
           s->deepest, build_ms);
    printf("    phases         refinement %.0f, leaf payload %.0f, inner payload %.0f, assembly %.0f ms; "
           "%" PRIu32 " part%s\n",
           s->milliseconds[0], s->milliseconds[1], s->milliseconds[2], s->milliseconds[3], s->parts,
           s->parts == 1 ? "" : "s");
    printf("    nodes          %" PRIu32 ": %" PRIu64 " inner, %" PRIu64 " leaves (%" PRIu64
           " of one triangle)\n",
           t->node_count, s->inner, s->leaves, s->single_leaves);
    printf("    leaves because few triangles %" PRIu64 ", one shared vertex %" PRIu64 ", depth limit %" PRIu64
           "; longest list %" PRIu32 "\n",
           s->stopped_small, s->stopped_fan, s->stopped_depth, s->longest_list);
    if (s->least_gain > 0)
        printf("    memory budget  %" PRIu64 " leaves that the rules would refine\n", s->stopped_budget);
    if (s->dense_leaves > 0)
        printf("    dense          %" PRIu64 " leaves with %" PRIu32 " boxes over their lists\n",
               s->dense_leaves, t->box_count);
    printf("    isolated       %" PRIu64 " cells refined for small things\n", s->refined_isolated);
    printf("    references     %" PRIu32 ", %.2f a triangle; %" PRIu64 " pairs, %" PRIu64 " overlap tests\n",
           t->reference_count, (double)t->reference_count / scene->triangle_count, s->pairs,
           s->overlap_tests);
    print_hash("    hash           ", t->hash);
}

static void print_lights(const json_t *report) {
    size_t i;
    json_t *light;
    const json_t *lights = json_object_get(report, "lights"), *faint = json_object_get(lights, "faint");
    json_array_foreach(json_object_get(lights, "list"), i, light) {
        const json_t *rgb = json_object_get(light, "irradiance"),
                     *angle = json_object_get(light, "angle_deg"), *reach = json_object_get(light, "reach_m"),
                     *triangles = json_object_get(light, "triangles");
        printf("%-18s %s of the %s, irradiance %.3g,%.3g,%.3g%s, extent %.3g %s, %d shadow ray%s a pixel",
               i ? "" : "lights", json_string_value(json_object_get(light, "kind")),
               json_string_value(json_object_get(light, "of")), json_number_value(json_array_get(rgb, 0)),
               json_number_value(json_array_get(rgb, 1)), json_number_value(json_array_get(rgb, 2)),
               angle ? "" : " at 1 m", json_number_value(angle ? angle : json_object_get(light, "extent_m")),
               angle ? "degrees" : "m", (int)json_integer_value(json_object_get(light, "shadow_rays")),
               json_integer_value(json_object_get(light, "shadow_rays")) == 1 ? "" : "s");
        if (triangles)
            printf(", %d triangles, %.2g of it folded", (int)json_integer_value(triangles),
                   json_number_value(json_object_get(light, "folded")));
        if (reach)
            printf(", ends at %.3g m", json_number_value(reach));
        printf("\n");
    }
    if (json_integer_value(json_object_get(faint, "triangles")) > 0)
        printf("    faint          %d triangles glow and are no light: %.2g of the power of all that do\n",
               (int)json_integer_value(json_object_get(faint, "triangles")),
               json_number_value(json_object_get(faint, "share")));
}

static void print_effects(const json_t *report) {
    size_t i;
    json_t *item;
    const json_t *effects = json_object_get(report, "effects");
    printf("effects run       ");
    json_array_foreach(json_object_get(effects, "run"), i, item)
        printf(" %s", json_is_string(item) ? json_string_value(item)
                                           : json_string_value(json_object_get(item, "name")));
    printf("\n");
    json_array_foreach(json_object_get(effects, "skipped"), i, item)
        printf("    not            %s: %s\n", json_string_value(json_object_get(item, "name")),
               json_string_value(json_object_get(item, "why")));
}

/* Options that could change nothing are mistakes. */
static gw_code check_options(const inspect_options *o, gw_error *error) {
    const gw_draw_options *draw = &o->draw;
    if (o->device && (draw->scene || draw->animation || draw->cache || o->validate))
        return gw_fail(error, GW_BAD_INPUT, "--device tells about the GL device alone; leave out the scene");
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        if (gw_setting_value(&draw->settings, row) == row->initial)
            continue;
        if (o->device)
            return gw_fail(error, GW_BAD_INPUT,
                           "--device tells about the GL device alone; leave out --set %s", row->name);
        if (row->stage != GW_SETTING_BUILD)
            return gw_fail(error, GW_BAD_INPUT,
                           "--set %s changes frames, and inspect draws none; it takes the settings 'of the "
                           "octree' in 'gazewall settings'",
                           row->name);
    }
    return GW_OK;
}

/* The scene is told before the octree is built: when that fails, this is what it failed for. */
static gw_code inspect_import(gw_model *model, const inspect_options *o, const gw_log *log,
                              gw_inspect_report *inspected, gw_error *error) {
    gw_code code = gw_model_import(model, &o->draw, log, error);
    if (!code)
        code = gw_inspect_mesh(model, inspected, error);
    if (!code && !o->draw.quiet) {
        print_scene(model->scene);
        gw_inspect_print_mesh(inspected, model->scene);
        fflush(stdout);
    }
    return code;
}

static void fill_report(const gw_model *model, const inspect_options *o, const gw_inspect_report *inspected,
                        json_t *report) {
    const gw_gl_limits *limits = gw_gl_limits_of(model->device);
    gw_report_device(report, limits);
    gw_report_scene(report, model->scene, model->import_ms);
    gw_report_octree(report, model->octree, model->scene, limits, model->build_ms, model->from_cache);
    gw_report_settings(report, &o->draw.settings, &o->draw.profile);
    gw_inspect_report_json(inspected, model, report);
    json_object_set_new(json_object_get(report, "octree"), "validated",
                        o->validate ? json_true() : json_null());
}

static gw_code inspect_scene(gw_model *model, const inspect_options *o, const gw_log *log, json_t *report,
                             gw_error *error) {
    gw_renderer *renderer = NULL;
    gw_renderer_options how = {.log = log};
    gw_inspect_report inspected;
    gw_code code = inspect_import(model, o, log, &inspected, error);
    if (!code)
        code = gw_model_open_device(model, &o->draw, log, error);
    if (!code)
        code = gw_model_build(model, &o->draw, log, error);
    if (!code && o->validate)
        code = gw_octree_validate(model->device, model->scene, model->octree, error);
    if (!code)
        code = gw_renderer_create(model->device, model->scene, model->octree, &how, &renderer, error);
    if (!code)
        code = gw_renderer_report(renderer, NULL, report, error);
    if (!code)
        gw_inspect_octree(model, renderer, &o->draw.settings, &inspected);
    gw_renderer_destroy(&renderer);
    if (code)
        return code;
    fill_report(model, o, &inspected, report);
    if (o->draw.quiet)
        return GW_OK;
    print_octree(model->octree, model->scene, model->build_ms);
    gw_inspect_print_levels(&inspected);
    gw_inspect_print_memory(&inspected, model->scene);
    print_lights(report);
    print_effects(report);
    if (o->validate)
        printf("validated          every invariant of the octree holds\n");
    return GW_OK;
}

/* levels_x.png, levels_y.png and levels_z.png in the folder. */
static gw_code write_pictures(const gw_model *model, const char *folder, gw_error *error) {
    gw_code code = GW_OK;
    for (int axis = 0; !code && axis < 3; axis++) {
        gw_image image = {0};
        char *path = gw_picture_path(folder, "levels_%c.png", 'x' + axis);
        code = path ? gw_octree_picture(model->scene, model->octree, axis, PICTURE_SIDE, &image, error)
                    : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
        if (!code)
            code = gw_image_write_png(path, &image, "octree cells by level: a cut, the leaves from outside",
                                      error);
        gw_image_finish(&image);
        free(path);
    }
    return code;
}

static gw_code write_files(const inspect_options *o, const gw_model *model, const json_t *report,
                           gw_error *error) {
    gw_code code = GW_OK;
    gw_interrupt_hold();
    if (o->draw.report)
        code = gw_report_write(report, o->draw.report, error);
    if (!code && o->out) {
        char *path = gw_path_join(o->out, "inspect.json");
        code = path ? gw_report_write(report, path, error)
                    : gw_fail(error, GW_MACHINE, "memory is out while naming the report");
        free(path);
    }
    if (!code && o->out && model->octree)
        code = write_pictures(model, o->out, error);
    gw_interrupt_release();
    return code;
}

int gw_verb_inspect(int argc, char **argv) {
    inspect_options o = {.device = 0};
    gw_console console;
    gw_model model = {0};
    json_t *report = NULL;
    gw_error error = {0};
    int helped = 0;
    gw_draw_options_init(&o.draw, &error);
    gw_code code = gw_arguments_parse(&inspect_argp, argc, argv, &o, &helped, &error);
    if (helped && !code)
        return GW_OK;
    if (!code)
        code = check_options(&o, &error);
    if (!code)
        code = gw_file_writable(o.draw.report, &error);
    if (!code && o.out)
        code = gw_make_directories(o.out, &error);
    gw_console_init(&console, "inspect", o.draw.level, o.draw.quiet);
    if (!code)
        code = gw_report_create(argc, argv, &report, &error);
    if (!code)
        code = o.device ? inspect_device(&model, &o, &console.log, report, &error)
                        : inspect_scene(&model, &o, &console.log, report, &error);
    if (!code)
        code = write_files(&o, &model, report, &error);
    gw_model_close(&model);
    json_decref(report);
    gw_console_finish(&console);
    return code ? gw_console_fail("inspect", &error) : GW_OK;
}
