#include "wall/report.h"

#include "base/file.h"
#include "base/gl_probe.h"
#include "base/memory.h"
#include "wall/verbs.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const keys[] = {"version",    "command", "device",       "scene",    "octree",
                                   "memory",     "tiles",   "frames",       "ended",    "frame_ms",
                                   "counters",   "effects", "profile",      "settings", "predicted_error",
                                   "latency_ms", "gate",    "swap_skew_ms", "tracking", "float_environment",
                                   "build",      "image",   "site_reloads", "lights"};

static json_t *command_text(int argc, char **argv) {
    size_t size = 1;
    for (int i = 0; i < argc; i++)
        size += strlen(argv[i]) + 1;
    char *text = calloc(size, 1);
    char *at = text;
    for (int i = 0; text && i < argc; i++) {
        if (i > 0)
            *at++ = ' ';
        at = stpcpy(at, argv[i]);
    }
    /* An argument may hold any bytes; a command that is not UTF-8 is reported as null. */
    json_t *command = text ? json_string(text) : NULL;
    free(text);
    return command ? command : json_null();
}

gw_code gw_report_create(int argc, char **argv, json_t **out, gw_error *error) {
    json_t *report = json_object();
    if (!report)
        return gw_fail(error, GW_MACHINE, "memory is out while making the report");
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        json_object_set_new(report, keys[i], json_null());
    json_object_set_new(report, "version", json_string(GW_VERSION));
    json_object_set_new(report, "command", command_text(argc, argv));
    *out = report;
    return GW_OK;
}

/* Text that may hold any bytes: what is not UTF-8 becomes null. */
static json_t *text_or_null(const char *text) {
    json_t *string = text ? json_string(text) : NULL;
    return string ? string : json_null();
}

static json_t *hash_text(gw_hash hash) {
    char text[33];
    gw_hash_text(hash, text);
    return json_string(text);
}

static json_t *count(uint64_t value) {
    return json_integer((json_int_t)value);
}

void gw_report_device(json_t *report, const gw_gl_limits *limits) {
    json_object_set_new(
        report, "device",
        json_pack("{s:o, s:o, s:o, s:b, s:I, s:I, s:[I,I,I], s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:b}",
                  "vendor", text_or_null(limits->vendor), "renderer", text_or_null(limits->renderer),
                  "version", text_or_null(limits->version), "software", limits->software,
                  "storage_block_bytes", (json_int_t)limits->storage_block_bytes, "texture_buffer_texels",
                  (json_int_t)limits->texture_buffer_texels, "work_groups",
                  (json_int_t)limits->work_groups[0], (json_int_t)limits->work_groups[1],
                  (json_int_t)limits->work_groups[2], "work_group_invocations",
                  limits->work_group_invocations, "shared_bytes", limits->shared_bytes, "storage_blocks",
                  limits->storage_blocks, "storage_bindings", limits->storage_bindings, "texture_units",
                  limits->texture_units, "texture_side", limits->texture_side, "texture_layers",
                  limits->texture_layers, "program_binary_formats", limits->program_binary_formats,
                  "resets_told", limits->resets_told));
}

gw_code gw_report_floats(json_t *report, gw_gl *device, gw_error *error) {
    gw_float_environment floats = {0};
    gw_code code = gw_gl_probe_floats(device, &floats, error);
    if (code)
        return code;
    json_object_set_new(
        report, "float_environment",
        json_pack("{s:b, s:b, s:b, s:b, s:b, s:b, s:b, s:b, s:b, s:b, s:I, s:I, s:i}", "contracts",
                  floats.contracts, "precise_holds", floats.precise_holds, "fma_fused", floats.fma_fused,
                  "denormals_kept", floats.denormals_kept, "division_exact", floats.division_exact,
                  "sqrt_exact", floats.sqrt_exact, "infinity_kept", floats.infinity_kept, "nan_kept",
                  floats.nan_kept, "minimum_is_number", floats.minimum_is_number, "conversion_saturates",
                  floats.conversion_saturates, "division_wrong", (json_int_t)floats.division_wrong,
                  "sqrt_wrong", (json_int_t)floats.sqrt_wrong, "samples", GW_PROBE_SAMPLES));
    return GW_OK;
}

static json_t *notes_of(const gw_scene *scene) {
    json_t *notes = json_array();
    for (size_t i = 0; i < scene->note_count; i++)
        json_array_append_new(notes, text_or_null(scene->notes[i]));
    return notes;
}

static json_t *dropped_of(const gw_dropped *dropped) {
    json_t *object = json_object();
    for (size_t i = 0; i < gw_dropped_row_count; i++)
        json_object_set_new(object, gw_dropped_rows[i].name,
                            count(gw_dropped_by(dropped, &gw_dropped_rows[i])));
    return object;
}

void gw_report_scene(json_t *report, const gw_scene *scene, double import_ms) {
    json_t *object = json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:[[f,f,f],[f,f,f]], s:f, s:o}", "file",
        text_or_null(scene->path), "hash", hash_text(scene->hash), "triangles", count(scene->triangle_count),
        "dropped", dropped_of(&scene->dropped), "vertices", count(scene->vertex_count), "materials",
        count(scene->material_count), "textures", count(scene->texture_count), "lights",
        count(scene->light_count), "viewpoints", count(scene->viewpoint_count), "bounds_m",
        scene->bounds[0][0], scene->bounds[0][1], scene->bounds[0][2], scene->bounds[1][0],
        scene->bounds[1][1], scene->bounds[1][2], "import_ms", import_ms, "notes", notes_of(scene));
    json_object_set_new(report, "scene", object);
}

static json_t *statistics_of(const gw_octree_statistics *s) {
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:{s:f, s:f, s:f, s:f}}",
        "pairs", count(s->pairs), "overlap_tests", count(s->overlap_tests), "inner", count(s->inner),
        "single_leaves", count(s->single_leaves), "stopped_small", count(s->stopped_small), "stopped_fan",
        count(s->stopped_fan), "stopped_depth", count(s->stopped_depth), "stopped_budget",
        count(s->stopped_budget), "least_gain", count(s->least_gain), "refined_isolated",
        count(s->refined_isolated), "dense_leaves", count(s->dense_leaves), "longest_list",
        count(s->longest_list), "deepest", count(s->deepest), "parts", count(s->parts), "phases_ms",
        "refinement", s->milliseconds[0], "leaf_payload", s->milliseconds[1], "inner_payload",
        s->milliseconds[2], "assembly", s->milliseconds[3]);
}

uint64_t gw_triangle_bytes(const gw_scene *scene) {
    return scene->triangle_count * (uint64_t)(sizeof(gw_gpu_triangle) + sizeof(gw_gpu_face)) +
           scene->vertex_count * (uint64_t)sizeof(gw_gpu_vertex);
}

void gw_report_octree(json_t *report, const gw_octree *octree, const gw_scene *scene,
                      const gw_gl_limits *limits, double build_ms, int from_cache) {
    json_t *object = json_pack(
        "{s:o, s:o, s:o, s:o, s:{s:o, s:o, s:o, s:o, s:o, s:o}, s:f, s:f, s:o}", "hash",
        hash_text(octree->hash), "depth", count(octree->depth), "nodes", count(octree->node_count), "leaves",
        count(octree->statistics.leaves), "bytes", "nodes", count(octree->statistics.inner * sizeof(gw_node)),
        "leaves", count(octree->statistics.leaves * sizeof(gw_node)), "references",
        count(gw_octree_reference_bytes(octree)), "payload",
        count((gw_octree_payload_bytes(octree) + gw_octree_emission_bytes(octree))), "boxes",
        count(gw_octree_box_bytes(octree)), "triangles", count(gw_triangle_bytes(scene)),
        "references_per_triangle", (double)octree->reference_count / (double)scene->triangle_count,
        "build_ms", build_ms, "statistics", statistics_of(&octree->statistics));
    json_object_set_new(report, "octree", object);
    json_object_set_new(report, "build",
                        json_pack("{s:s, s:o}", "partition", from_cache ? "cache" : "rank 0", "driver",
                                  text_or_null(limits->version)));
}

void gw_report_builders(json_t *report, const gw_together *who) {
    json_t *build = json_object_get(report, "build"), *parts = json_array();
    for (uint32_t i = 0; i < who->part_count; i++)
        json_array_append_new(parts, json_pack("{s:i, s:o}", "rank", who->ranks[i], "overlap_tests",
                                               count(who->overlap_tests[i])));
    if (who->part_count > 1)
        json_object_set_new(build, "partition", json_sprintf("%" PRIu32 " parts", who->part_count));
    json_object_set_new(build, "split_level", count(who->split_level));
    json_object_set_new(build, "parts", parts);
}

void gw_report_settings(json_t *report, const gw_settings *settings, const gw_profile *profile) {
    json_t *object = json_object();
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        double value = gw_setting_value(settings, row);
        char text[64];
        gw_setting_text(settings, row, text);
        json_t *entry = isinf(value)                      ? json_string(text)
                        : row->kind == GW_SETTING_REAL    ? json_real(value)
                        : row->kind == GW_SETTING_INTEGER ? json_integer((json_int_t)value)
                        : row->kind == GW_SETTING_SWITCH  ? json_boolean(value != 0)
                                                          : json_string(text);
        json_object_set_new(object, row->name, entry);
    }
    json_object_set_new(report, "settings", object);
    json_object_set_new(report, "profile", gw_profile_json(profile, settings));
}

void gw_report_counters(json_t *report, const gw_counters *c) {
    const struct {
        const char *name;
        uint64_t value;
    } rows[] = {{"rays", c->rays},
                {"steps", c->steps},
                {"node_loads", c->node_loads},
                {"triangle_tests", c->triangle_tests},
                {"step_cap_hits", c->step_cap_hits},
                {"nan_pixels", c->nan_pixels},
                {"voxels", c->voxels},
                {"voxel_rays", c->voxel_rays},
                {"shadow_rays", c->shadow_rays},
                {"mirror_rays", c->mirror_rays},
                {"glossy_rays", c->glossy_rays},
                {"refracted_rays", c->refracted_rays},
                {"cone_rays", c->cone_rays},
                {"resumed", c->resumed},
                {"loop_iterations", c->loop_iterations}};
    json_t *object = json_object();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        json_object_set_new(object, rows[i].name, count(rows[i].value));
    json_object_set_new(report, "counters", object);
}

void gw_report_faults(const gw_log *log, const gw_counters *c) {
    if (c->nan_pixels > 0)
        gw_log_write(
            log, GW_LOG_WARNING,
            "%" PRIu64 " pixels came to no number and show the background: a fault of this program or of "
            "the driver, not of the scene; the report's effects tell which one to try --forbid-effect with",
            c->nan_pixels);
    if (c->step_cap_hits > 0)
        gw_log_write(log, GW_LOG_WARNING,
                     "%" PRIu64
                     " rays were cut off by the driver's limit of loops: what lies behind is missing",
                     c->step_cap_hits);
}

void gw_report_predicted_error(json_t *report, const gw_predicted_error *predicted,
                               const gw_frame_state *last, json_t *budget) {
    const gw_frame_state knobs = gw_frame_state_in_force(last);
    json_t *in_force = json_pack("{s:f, s:f, s:f, s:f, s:i, s:o, s:i}", "strain", (double)last->strain, "tau",
                                 (double)knobs.tau, "gaze_margin", (double)knobs.gaze_margin, "acuity_slope",
                                 (double)knobs.acuity_slope, "sample_block", 1 << knobs.sample_block, "epoch",
                                 count(last->epoch), "accumulate", (int)last->accumulate);
    json_object_set_new(report, "predicted_error",
                        json_pack("{s:f, s:f, s:o, s:o, s:o}", "worst", gw_predicted_error_worst(predicted),
                                  "mean", gw_predicted_error_mean(predicted), "places",
                                  count(predicted->places), "in_force", in_force, "budget", budget));
}

static json_t *recording_counters(const gw_recording_counters *c) {
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}",
        "bytes", count(c->bytes), "records", count(c->records), "used", count(c->used), "poses",
        count(c->poses), "gazes", count(c->gazes), "buttons", count(c->buttons), "analogs", count(c->analogs),
        "links", count(c->links), "stamps", count(c->stamps), "texts", count(c->texts), "descriptions",
        count(c->descriptions), "other_type", count(c->other_type), "unknown_type", count(c->unknown_type),
        "unknown_sender", count(c->unknown_sender), "bad_payload", count(c->bad_payload), "bad_sensor",
        count(c->bad_sensor), "not_finite", count(c->not_finite), "out_of_order", count(c->out_of_order),
        "clock_steps", count(c->clock_steps));
}

void gw_report_recording(json_t *report, const gw_recording *recording, const char *sender) {
    const gw_recording_damage *damage = &recording->damage;
    json_t *notes = json_array();
    for (uint32_t i = 0; i < recording->note_count; i++)
        json_array_append_new(notes, text_or_null(recording->notes[i]));
    json_object_set_new(
        report, "tracking",
        json_pack("{s:s, s:o, s:s, s:b, s:o, s:f, s:f, s:o, s:o, s:o}", "state", "recording", "file",
                  text_or_null(recording->name), "form", recording->is_csv ? "csv" : "vrpn", "gzip",
                  recording->is_gzip, "sender", text_or_null(sender), "start_unix_s",
                  (double)recording->start * 1e-9, "duration_s", (double)recording->duration * 1e-9, "damage",
                  damage->found ? json_pack("{s:o, s:o, s:s}", "offset", count(damage->offset), "record",
                                            count(damage->record), "text", damage->text)
                                : json_null(),
                  "notes", notes, "counters", recording_counters(&recording->counters)));
}

void gw_report_served(json_t *report, const char *name, gw_server_counters served) {
    json_t *tracking = json_object_get(report, "tracking");
    if (!json_is_object(tracking)) {
        tracking = json_object();
        json_object_set_new(report, "tracking", tracking);
    }
    json_object_set_new(tracking, "served",
                        json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "as", name, "clients",
                                  count(served.clients), "messages", count(served.messages), "unsendable",
                                  count(served.unsendable), "refused", count(served.refused), "slow",
                                  count(served.slow), "unreachable", count(served.unreachable), "ignored",
                                  count(served.ignored), "malformed", count(served.malformed)));
}

void gw_report_tiles(json_t *report, const gw_layout *layout, const gw_tile_record *records) {
    json_t *tiles = json_array();
    for (uint32_t i = 0; i < layout->tile_count; i++) {
        const gw_tile *tile = &layout->tiles[i];
        const gw_tile_record *r = &records[i];
        json_array_append_new(
            tiles,
            json_pack("{s:s, s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:[I,I,I,I]}", "name",
                      tile->name, "rank", count(i), "state", r->state, "presented", count(r->presented),
                      "late", count(r->late), "skipped", count(r->skipped), "lost", count(r->lost),
                      "returned", count(r->returned), "rejoin_ms",
                      r->rejoin_ms ? count(r->rejoin_ms) : json_null(), "lost_frame",
                      r->lost ? count(r->lost_frame) : json_null(), "fault",
                      r->fault && r->fault[0] ? text_or_null(r->fault) : json_null(), "processor_ms",
                      r->processor_ms, "picture", (json_int_t)tile->picture[0], (json_int_t)tile->picture[1],
                      (json_int_t)tile->rectangle.width, (json_int_t)tile->rectangle.height));
    }
    json_object_set_new(report, "tiles", tiles);
}

void gw_report_gate(json_t *report, int live, const gw_site_times *times, uint32_t dropped,
                    const gw_swap_skew *swaps, double *median, double *maximum) {
    json_object_set_new(report, "gate",
                        json_pack("{s:s, s:o, s:{s:f, s:o, s:f, s:f, s:o}}", "mode",
                                  live ? "live" : "lock-step", "dropped_connections", count(dropped), "times",
                                  "load_s", times->load, "frame_s",
                                  times->frame > 0 ? json_real(times->frame) : json_null(), "death_s",
                                  times->death, "refresh_hz", times->refresh, "restarts_a_minute",
                                  count(live ? (uint32_t)times->restarts : 0)));
    json_object_set_new(report, "swap_skew_ms", gw_swap_skew_json(swaps, median, maximum));
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

gw_spread gw_spread_of(const double *values, size_t value_count) {
    gw_spread spread = {0};
    void *copy = NULL;
    if (value_count == 0 || gw_allocate(&copy, value_count, sizeof *values, "statistics", NULL))
        return spread;
    double *sorted = copy;
    memcpy(sorted, values, value_count * sizeof *values);
    qsort(sorted, value_count, sizeof *sorted, compare);
    spread.minimum = sorted[0];
    spread.median = 0.5 * (sorted[(value_count - 1) / 2] + sorted[value_count / 2]);
    spread.p95 = sorted[(value_count - 1) * 95 / 100];
    spread.maximum = sorted[value_count - 1];
    free(sorted);
    return spread;
}

void gw_report_frames(json_t *report, const double *milliseconds, size_t known, size_t frame_count) {
    gw_spread spread = gw_spread_of(milliseconds, known);
    json_object_set_new(report, "frames", count(frame_count));
    json_object_set_new(
        report, "frame_ms",
        json_pack("{s:f, s:f, s:f}", "median", spread.median, "p95", spread.p95, "max", spread.maximum));
}

void gw_report_ended(json_t *report, int interrupted) {
    json_object_set_new(report, "ended", json_string(interrupted ? "interrupted" : "finished"));
}

gw_hash gw_image_hash(const gw_image *image) {
    const uint32_t size[2] = {image->width, image->height};
    gw_hash hash = gw_hash_bytes((gw_hash){0}, size, sizeof size);
    return gw_hash_bytes(hash, image->rgba, (size_t)image->width * image->height * 4);
}

void gw_report_image(json_t *report, const char *file, const gw_image *image) {
    json_object_set_new(
        report, "image",
        json_pack("{s:o, s:o}", "file", text_or_null(file), "hash", hash_text(gw_image_hash(image))));
}

gw_code gw_report_write(const json_t *report, const char *path, gw_error *error) {
    char *text = json_dumps(report, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
    if (!text)
        return gw_fail(error, GW_MACHINE, "the report could not be put into words: memory is out");
    size_t length = strlen(text);
    text[length] = '\n'; /* in place of the final zero byte: the file's length is given */
    gw_code code = gw_file_write(path, text, length + 1, error);
    free(text);
    return code;
}
