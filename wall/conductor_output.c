/* What a run leaves behind: report, frames.csv, pictures, recorded states, the summary. */
#include "wall/conductor_internal.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "wall/interrupt.h"
#include "wall/picture.h"
#include "wall/rank.h"
#include "wall/report.h"
#include "wall/verbs.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* The words that the launcher put before the user's. */
static int is_own_word(const char *word) {
    return !strncmp(word, "--verb=", 7) || !strncmp(word, "--link=", 7) ||
           !strncmp(word, "--profile-text=", 15);
}

/* The command as the user gave it. */
gw_code gw_conductor_create_report(gw_conductor *conductor, const struct gw_rank *rank, int argc, char **argv,
                                   gw_error *error) {
    char **words = NULL;
    gw_code code = gw_allocate((void **)&words, (size_t)argc + 1, sizeof *words, "report", error);
    if (code)
        return code;
    static char program[] = "gazewall", verb[] = "sim", wall[] = "wall";
    int count = 0;
    words[count++] = program;
    words[count++] = rank->options.cluster ? wall : verb;
    int first = 1;
    while (first < argc && is_own_word(argv[first]))
        first++;
    for (int i = first; i < argc; i++)
        words[count++] = argv[i];
    code = gw_report_create(count, words, &conductor->report, error);
    free(words);
    return code;
}

gw_code gw_conductor_open_rows(gw_conductor *conductor, const char *folder, gw_error *error) {
    char *path = gw_picture_path(folder, "frames.csv");
    conductor->rows = path ? fopen(path, "we") : NULL;
    gw_code code =
        conductor->rows ? GW_OK : gw_fail(error, GW_NO_OUTPUT, "%s/frames.csv cannot be written", folder);
    free(path);
    if (!code)
        fputs(
            "frame,presented_ms,time_s,eye_x_mm,eye_y_mm,eye_z_mm,gazes,gaze_x,gaze_y,gaze_z,gaze_age_s,"
            "gaze_confidence,tau,tau_inside,epoch,accumulate,strain,exposure,gaze_margin,acuity_slope,sample_"
            "block,"
            "error_worst,error_mean,rays,frame_ms,slowest_tile_ms,age_ms,filter_ms,wait_ms,trace_ms,gate_ms,"
            "scan_out_ms,latency_ms,predicted_ms,",
            conductor->rows);
    for (int v = 0; v < GW_TRACK_VIEWERS && !code; v++)
        fprintf(conductor->rows,
                "fixation%d_x_mm,fixation%d_y_mm,fixation%d_z_mm,fixation%d_wide_deg,fixation%d_narrow_deg,"
                "fixation%d_rests,",
                v, v, v, v, v, v);
    if (!code)
        fputs("late_tiles,skipped_tiles,lost_tiles\n", conductor->rows);
    return code;
}

static char *make_text(const char *format, ...) __attribute__((format(printf, 1, 2)));
static char *make_text(const char *format, ...) {
    char *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    return length < 0 ? NULL : text;
}

gw_code gw_conductor_describe(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_model *model = &rank->model;
    const gw_scene *scene = model->scene;
    const gw_octree *octree = model->octree;
    const gw_gl_limits *limits = gw_gl_limits_of(model->device);
    conductor->scene_moves = scene->animation != NULL;
    if (rank->options.step < 0 && !conductor->tracked && scene->animation)
        conductor->step = 1000000000 / 30; /* nothing else tells the pace at which it plays */
    gw_code code = gw_conductor_take_path(conductor, rank, error);
    if (code)
        return code;
    gw_report_device(conductor->report, limits);
    gw_report_scene(conductor->report, scene, model->import_ms);
    gw_report_octree(conductor->report, octree, scene, limits, model->build_ms, model->from_cache);
    gw_report_builders(conductor->report, &rank->together);
    conductor->scene_line = make_text("%s: %" PRIu32 " triangles (%" PRIu64 " dropped), %" PRIu32
                                      " materials, %" PRIu32 " textures",
                                      scene->path, scene->triangle_count, gw_dropped_total(&scene->dropped),
                                      scene->material_count, scene->texture_count);
    double bytes = (double)gw_octree_bytes(octree);
    conductor->octree_line = make_text(
        "depth %" PRIu32 ", %" PRIu32 " nodes, %.1f MiB, %s in %.2f s on %s, one copy for %d rank%s",
        octree->depth, octree->node_count, bytes / 1048576.0,
        model->from_cache ? "read from the cache" : "built", model->build_ms * 1e-3, limits->renderer,
        rank->size, rank->size == 1 ? "" : "s");
    return gw_report_floats(conductor->report, model->device, error);
}

/* Empty cells where nobody is tracked. */
static void write_latency(FILE *rows, const gw_latency *latency) {
    if (!latency->tracked) {
        fputs(",,,,,,,,", rows);
        return;
    }
    for (int i = 0; i < GW_LATENCY_STAGES; i++)
        fprintf(rows, "%.3f,", (double)latency->ms[i]);
    fprintf(rows, "%.3f,%.3f,", gw_latency_total(latency), (double)latency->predicted);
}

/* Empty cells of viewers whose gaze is not known or beside the wall. */
static void write_fixations(FILE *rows, const gw_fixations *fixations) {
    for (int v = 0; v < GW_TRACK_VIEWERS; v++) {
        const gw_viewer_fixation *f = &fixations->viewers[v];
        if (f->known)
            fprintf(rows, "%.2f,%.2f,%.2f,%.3f,%.3f,%d,", f->point[0], f->point[1], f->point[2],
                    f->half_angles[0], f->half_angles[1], f->rests);
        else
            fputs(",,,,,,", rows);
    }
}

void gw_conductor_write_row(gw_conductor *conductor, uint32_t frame, const gw_counters *sum, double presented,
                            double slowest) {
    const gw_frame_state *s = &conductor->states[gw_kept(conductor, frame)],
                         knobs = gw_frame_state_in_force(s);
    const gw_gaze *g = &s->gazes[0]; /* all zero when there is none */
    fprintf(conductor->rows,
            "%" PRIu32 ",%.3f,%.9f,%.9g,%.9g,%.9g,%" PRIu32 ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%" PRIu32
            ",%d,%.9g,%.9g,%.9g,%.9g,%d,%.6g,%.6g,%" PRIu64 ",%.3f,%.3f,",
            s->frame, presented, (double)s->time * 1e-9, s->eye[0], s->eye[1], s->eye[2], s->gaze_count,
            (double)g->direction[0], (double)g->direction[1], (double)g->direction[2], (double)g->age,
            (double)g->confidence, (double)knobs.tau, (double)knobs.tau_inside, s->epoch, s->accumulate,
            (double)s->strain, (double)s->exposure, (double)knobs.gaze_margin, (double)knobs.acuity_slope,
            1 << knobs.sample_block, gw_predicted_error_worst(&conductor->seen),
            gw_predicted_error_mean(&conductor->seen), sum->rays,
            conductor->milliseconds[gw_kept(conductor, frame)], slowest);
    write_latency(conductor->rows, &conductor->latencies[gw_kept(conductor, frame)]);
    write_fixations(conductor->rows, &conductor->fixations);
    fprintf(conductor->rows, "%" PRIu32 ",%" PRIu32 ",%" PRIu32 "\n", conductor->missed[GW_MISSED_LATE],
            conductor->missed[GW_MISSED_SKIPPED], conductor->missed[GW_MISSED_LOST]);
    fflush(conductor->rows);
}

static void print(struct gw_rank *rank, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void print(struct gw_rank *rank, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    gw_link_send(&rank->line, GW_LINK_PRINT, 0, text);
}

/* How many frames' times are still known. */
static uint32_t known_frames(const gw_conductor *conductor) {
    return conductor->frame_count < conductor->kept ? conductor->frame_count : conductor->kept;
}

/* total: ms of all frames. */
static void sum_up_rays(const gw_conductor *conductor, struct gw_rank *rank, double total) {
    const gw_layout *layout = &rank->site.layout;
    const double pixels = (double)conductor->frame_count * layout->picture[0] * layout->picture[1];
    print(rank, "rays     %.2f million, %.2f per pixel, %.2f million a second",
          (double)conductor->counters.rays * 1e-6, (double)conductor->counters.rays / pixels,
          (double)conductor->counters.rays * 1e-3 / total);
    const gw_budget *budget = &conductor->budget;
    if (gw_budget_is_on(budget))
        print(rank, "budget   %g %s a frame, exceeded in %" PRIu32 " of %" PRIu32 " frames",
              budget->rays > 0 ? budget->rays : budget->milliseconds, budget->rays > 0 ? "rays" : "ms",
              budget->over, budget->frames);
    print(rank, "error    outside the gaze %.1f times coarser than viewers resolve at worst, %.2f on average",
          gw_predicted_error_worst(&conductor->predicted), gw_predicted_error_mean(&conductor->predicted));
}

static void sum_up(const gw_conductor *conductor, struct gw_rank *rank) {
    const gw_layout *layout = &rank->site.layout;
    const char *out = rank->options.out;
    const uint32_t known = known_frames(conductor);
    gw_spread ms = gw_spread_of(conductor->milliseconds, known);
    double total = 0;
    for (uint32_t i = 0; i < known; i++)
        total += conductor->milliseconds[i] * conductor->frame_count / known;
    if (rank->options.pictures.pattern)
        print(rank, "pattern  %s", gw_pattern_names[rank->options.pictures.pattern]);
    if (conductor->scene_line)
        print(rank, "scene    %s", conductor->scene_line);
    if (conductor->octree_line)
        print(rank, "octree   %s", conductor->octree_line);
    print(rank, "wall     %" PRIu32 " tiles, %" PRIu32 "x%" PRIu32 " px, %.0fx%.0f mm%s", layout->tile_count,
          layout->picture[0], layout->picture[1], layout->size[0], layout->size[1],
          conductor->lost_count ? ", NOT ALL OF THEM TO THE END: see the warnings" : "");
    print(rank, "frames   %" PRIu32 ": median %.0f ms, slowest %.0f ms", conductor->frame_count, ms.median,
          ms.maximum);
    if (conductor->swap_maximum > 0)
        print(rank, "swap     the tiles presented a frame within %.3f ms of each other, %.3f ms at worst",
              conductor->swap_median, conductor->swap_maximum);
    if (rank->options.pictures.video)
        print(rank, "video    %s", rank->options.pictures.video);
    if (!rank->options.gate_only && !rank->options.pictures.pattern)
        sum_up_rays(conductor, rank, total);
    if (out && !conductor->lost_count)
        print(rank,
              "look at  %s/wall.png (the wall), %s/wall-bezels.png (as it hangs), tile-*.png (one per rank), "
              "frames.csv",
              out, out);
    if (rank->options.draw.report)
        print(rank, "report   %s", rank->options.draw.report);
}

static const char *state_of(const gw_gate_tile *tile) {
    static const char *const names[] = {"live", "late", "lost"};
    return names[tile->state];
}

/* What the gate saw of the tiles. */
static void report_gate(gw_conductor *conductor, const struct gw_rank *rank) {
    gw_tile_record records[GW_MAXIMUM_TILES] = {{.state = "live",
                                                 .presented = conductor->presented,
                                                 .processor_ms = 1e-6 * (double)gw_processor_ns()}};
    const gw_site_times times = gw_sim_times(&rank->options, &rank->site);
    for (uint32_t i = 1; i < rank->site.layout.tile_count; i++) {
        const gw_gate_tile *tile = gw_gate_tile_of(conductor->gate, i);
        records[i] = (gw_tile_record){.state = state_of(tile),
                                      .presented = tile->presented,
                                      .late = tile->late,
                                      .skipped = tile->skipped,
                                      .lost = tile->lost,
                                      .returned = tile->returned,
                                      .lost_frame = tile->lost_frame,
                                      .rejoin_ms = tile->rejoin_ms,
                                      .fault = tile->fault,
                                      .processor_ms = 1e-6 * (double)tile->processor};
    }
    gw_report_tiles(conductor->report, &rank->site.layout, records);
    const gw_door *door = gw_gate_door(conductor->gate);
    gw_report_gate(conductor->report, rank->options.live, &times, door ? gw_door_refused(door) : 0,
                   gw_gate_swaps(conductor->gate), &conductor->swap_median, &conductor->swap_maximum);
}

gw_code gw_conductor_finish(gw_conductor *conductor, struct gw_rank *rank, gw_error *error) {
    const gw_sim_options *options = &rank->options;
    gw_code code = GW_OK;
    if (conductor->rows && (ferror(conductor->rows) | fclose(conductor->rows)))
        code = gw_fail(error, GW_NO_OUTPUT, "%s/frames.csv could not be written to its end", options->out);
    if (!code && options->save_states)
        code = gw_states_save(options->save_states, conductor->states, conductor->frame_count, error);
    json_object_set_new(conductor->report, "site_reloads", json_integer(conductor->reloads));
    report_gate(conductor, rank);
    if (conductor->serve)
        gw_report_served(conductor->report, gw_serve_name(conductor->serve),
                         gw_serve_count(conductor->serve));
    gw_serve_close(&conductor->serve);
    gw_report_frames(conductor->report, conductor->milliseconds, known_frames(conductor),
                     conductor->frame_count);
    gw_report_ended(conductor->report, gw_link_stop(&rank->line));
    json_object_set_new(conductor->report, "latency_ms",
                        gw_latency_json(conductor->latencies, known_frames(conductor)));
    if (conductor->tracked)
        gw_tracked_report(conductor->tracked, conductor->report);
    gw_tracked_close(&conductor->tracked);
    gw_report_counters(conductor->report, &conductor->counters);
    gw_report_faults(&rank->line.log, &conductor->counters);
    const gw_frame_state *last = &conductor->states[gw_kept(conductor, conductor->frame_count - 1)];
    gw_report_predicted_error(conductor->report, &conductor->predicted, last,
                              gw_budget_json(&conductor->budget));
    if (!code && rank->renderer)
        code = gw_renderer_report(rank->renderer, &conductor->counters, conductor->report, error);
    if (!code && options->draw.report) {
        gw_interrupt_hold();
        code = gw_report_write(conductor->report, options->draw.report, error);
        gw_interrupt_release();
    }
    if (!code && !options->draw.quiet)
        sum_up(conductor, rank);
    return code ? code : conductor->lost_count ? GW_TILES_LOST : GW_OK;
}
