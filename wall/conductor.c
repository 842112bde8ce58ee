#include "wall/conductor.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/image.h"
#include "base/memory.h"
#include "render/camera.h"
#include "wall/interrupt.h"
#include "wall/picture.h"
#include "wall/rank.h"
#include "wall/report.h"
#include "wall/verbs.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* --- before frame 1
 * --------------------------------------------------------------------------------------------- */

/* The command as the user gave it: sim's words without the launcher's own --link, which stands first. */
static gw_code create_report(gw_conductor *conductor, int argc, char **argv, gw_error *error) {
    char **words = NULL;
    gw_code code = gw_allocate((void **)&words, (size_t)argc + 1, sizeof *words, "report", error);
    if (code)
        return code;
    static char program[] = "gazewall", verb[] = "sim";
    int count = 0;
    words[count++] = program;
    words[count++] = verb;
    for (int i = 2; i < argc; i++)
        words[count++] = argv[i];
    code = gw_report_create(count, words, &conductor->report, error);
    free(words);
    return code;
}

static gw_code read_track(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_sim_options *options = &rank->options;
    gw_track_options how = {.log = &rank->line.log};
    gw_code code = options->track
                       ? gw_track_load(options->track, &how, &conductor->track, error)
                       : gw_track_demo(rank->layout.size[0], rank->layout.size[1], &conductor->track, error);
    if (code)
        return code;
    gw_report_track(conductor->report, conductor->track);
    int64_t left = conductor->track->duration - conductor->first_time;
    /* Without the far end: on a track that comes back to its start, the last frame would repeat the first. */
    if (options->step < 0)
        conductor->step = left > 0 ? left / conductor->frame_count : 0;
    return GW_OK;
}

/* What the frames are made from. */
static gw_code choose_source(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_sim_options *options = &rank->options;
    conductor->frame_count = options->frames ? options->frames : 1;
    gw_budget_init(&conductor->budget, options->budget_ms, options->budget_rays,
                   options->draw.settings.strain);
    conductor->first_time = (int64_t)(options->draw.time * 1e9);
    conductor->step = options->step > 0 ? (int64_t)(options->step * 1e9) : 0;
    if (options->states) {
        gw_code code = gw_states_load(options->states, &conductor->recorded, error);
        if (code)
            return code;
        if (!options->frames)
            conductor->frame_count = (uint32_t)conductor->recorded.count;
        if (conductor->frame_count > conductor->recorded.count)
            return gw_fail(error, GW_BAD_INPUT, "%s holds %zu frame states, --frames asks for %" PRIu32,
                           options->states, conductor->recorded.count, conductor->frame_count);
        return GW_OK;
    }
    if (options->gaze == GW_GAZE_AT_PIXEL)
        return gw_layout_point(&rank->layout, options->gaze_pixel, conductor->stare, error);
    return options->gaze == GW_GAZE_NONE ? GW_OK : read_track(conductor, rank, error);
}

static gw_code open_rows(gw_conductor *conductor, const char *folder, gw_error *error) {
    char *path = gw_picture_path(folder, "frames.csv");
    conductor->rows = path ? fopen(path, "we") : NULL;
    gw_code code =
        conductor->rows ? GW_OK : gw_fail(error, GW_NO_OUTPUT, "%s/frames.csv cannot be written", folder);
    free(path);
    if (!code)
        fputs("frame,presented_ms,time_s,eye_x_mm,eye_y_mm,eye_z_mm,gazes,gaze_x,gaze_y,gaze_z,gaze_age_s,"
              "gaze_confidence,tau,tau_inside,epoch,accumulate,strain,gaze_margin,acuity_slope,sample_block,"
              "error_worst,error_mean,rays,frame_ms,slowest_tile_ms,late_tiles,lost_"
              "tiles\n",
              conductor->rows);
    return code;
}

gw_code gw_conductor_init(gw_conductor *conductor, struct gw_rank *rank, int argc, char **argv,
                          gw_error *error) {
    const gw_sim_options *options = &rank->options;
    for (int i = 0; i < GW_MAXIMUM_TILES; i++)
        conductor->lost_frame[i] = -1;
    gw_code code = create_report(conductor, argc, argv, error);
    if (!code)
        code = choose_source(conductor, rank, error);
    if (!code)
        code = gw_allocate((void **)&conductor->states, conductor->frame_count, sizeof *conductor->states,
                           "frame states", error);
    if (!code)
        code = gw_allocate((void **)&conductor->milliseconds, conductor->frame_count, sizeof(double),
                           "frame times", error);
    if (!code && options->out)
        code = gw_make_directories(options->out, error);
    if (!code && options->out)
        code = open_rows(conductor, options->out, error);
    if (!code)
        code = gw_gate_create(&rank->layout, &conductor->gate, error);
    gw_report_settings(conductor->report, &options->draw.settings);
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

/* Every frame looks somewhere: where eye and look_at of a path meet, nothing says where to. */
static gw_code check_path(const gw_conductor *conductor, const char *name, gw_error *error) {
    for (uint32_t frame = 0; frame < conductor->frame_count; ++frame) {
        const double time = (double)(conductor->first_time + (int64_t)frame * conductor->step) * 1e-9;
        double stand[3], look_at[3];
        gw_camera_path_at(&conductor->path, time, stand, look_at);
        if ((float)stand[0] == (float)look_at[0] && (float)stand[1] == (float)look_at[1] &&
            (float)stand[2] == (float)look_at[2])
            return gw_fail(
                error, GW_BAD_INPUT,
                "path '%s' has no direction at %.3f s (frame %u): eye and look_at are the same point "
                "%g,%g,%g; move one of them in the keys about that time",
                name, time, (unsigned)frame, stand[0], stand[1], stand[2]);
    }
    return GW_OK;
}

/* The scene's path is needed longer than rank 0 has the scene. Without --step and a track's pace, frames are
 * spread over what is left of it. */
static gw_code take_path(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_camera_path *path = NULL;
    const gw_sim_options *options = &rank->options;
    if (!options->path)
        return GW_OK;
    gw_code code = gw_camera_path_find(rank->model.scene, options->path, &path, error);
    if (!code)
        code = gw_allocate((void **)&conductor->path.keys, path->key_count, sizeof *path->keys, "camera path",
                           error);
    if (code)
        return code;
    memcpy(conductor->path.keys, path->keys, path->key_count * sizeof *path->keys);
    conductor->path.key_count = path->key_count;
    double rest = path->keys[path->key_count - 1].time - options->draw.time;
    if (options->step < 0)
        conductor->step =
            conductor->frame_count > 1 && rest > 0 ? (int64_t)(rest * 1e9 / (conductor->frame_count - 1)) : 0;
    return check_path(conductor, options->path, error);
}

gw_code gw_conductor_describe(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_model *model = &rank->model;
    const gw_scene *scene = model->scene;
    const gw_octree *octree = model->octree;
    const gw_gl_limits *limits = gw_gl_limits_of(model->device);
    conductor->scene_moves = scene->animation != NULL;
    if (rank->options.step < 0 && !conductor->track && scene->animation)
        conductor->step = 1000000000 / 30; /* nothing else tells the pace at which it plays */
    gw_code code = take_path(conductor, rank, error);
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

/* --- a frame
 * ---------------------------------------------------------------------------------------------------- */

static void navigate(const gw_conductor *conductor, gw_frame_state *state) {
    double stand[3], look_at[3];
    if (!conductor->path.keys)
        return;
    gw_camera_path_at(&conductor->path, (double)state->time * 1e-9, stand, look_at);
    for (int k = 0; k < 3; k++) {
        state->stand[k] = (float)stand[k];
        state->look_at[k] = (float)look_at[k];
    }
}

static void make_state(gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame,
                       gw_frame_state *state) {
    const gw_draw_options *draw = &rank->options.draw;
    if (conductor->recorded.count) {
        *state = conductor->recorded.states[frame];
        return;
    }
    gw_frame_begin(state, frame, &draw->settings, draw->seed, draw->debug);
    int64_t time = conductor->first_time + (int64_t)frame * conductor->step;
    if (conductor->track) {
        gw_frame_look(state, conductor->track, time, rank->layout.eye, &draw->settings);
    } else {
        gw_frame_stare(state, rank->layout.eye,
                       rank->options.gaze == GW_GAZE_AT_PIXEL ? conductor->stare : NULL, &draw->settings);
        state->time = time;
    }
    navigate(conductor, state);
    if (gw_budget_is_on(&conductor->budget))
        state->strain = gw_budget_strain(&conductor->budget);
    const gw_frame_state *before = frame ? &conductor->states[frame - 1] : NULL;
    if (draw->settings.accumulate > 1)
        gw_frame_hold(state, before, rank->options.still[0], rank->options.still[1]);
    gw_frame_accumulate(state, before, conductor->scene_moves);
}

/* How long a silent tile is waited for. Kernels are compiled in the first frame, on all tiles at once. */
static int64_t patience_of(const gw_conductor *conductor, const struct gw_rank *rank, uint32_t done_frames) {
    const double first_frame = 120;
    double seconds = rank->options.frame_deadline;
    if (seconds <= 0) {
        seconds = 20e-3 * gw_spread_of(conductor->milliseconds, done_frames).median;
        seconds = seconds < 10 ? 10 : seconds;
    }
    if (done_frames == 0 && seconds < first_frame)
        seconds = first_frame;
    return (int64_t)(seconds * 1e9);
}

/* The launcher watches rank 0 as rank 0 watches the tiles: each stretch of work is announced with the time
 * that it may take. Pictures of so many pixels are written in it; 3 s a million is many times what that
 * needs. */
static void promise(struct gw_rank *rank, int64_t patience, double pixels) {
    gw_link_promise(&rank->line, (double)patience * 1e-9 + 10 + 3e-6 * pixels);
}

static void note_loss(gw_conductor *conductor, const struct gw_rank *rank, uint32_t tile, uint32_t frame,
                      const char *why) {
    conductor->lost_frame[tile] = frame;
    conductor->lost_count++;
    gw_log_write(&rank->line.log, GW_LOG_WARNING,
                 "tile %s (rank %" PRIu32 ") is lost since frame %" PRIu32 ": %s",
                 rank->layout.tiles[tile].name, tile, frame, why);
}

/* After the gate: adds up what the tiles did; a tile that could not draw ends the run, because the others
 * would fail the same way. *slowest in ms. */
static gw_code add_up(gw_conductor *conductor, const struct gw_rank *rank, const gw_done *own, uint32_t frame,
                      const uint8_t **pixels, gw_counters *sum, double *slowest, gw_error *error) {
    memset(sum, 0, sizeof *sum);
    memset(&conductor->seen, 0, sizeof conductor->seen);
    *slowest = 0;
    for (uint32_t i = 0; i < rank->layout.tile_count; i++) {
        const gw_gate_tile *tile = i ? gw_gate_tile_of(conductor->gate, i) : NULL;
        pixels[i] = NULL;
        if (tile && tile->state == GW_TILE_LOST) {
            if (conductor->lost_frame[i] < 0)
                note_loss(conductor, rank, i, frame, "nothing came from it in time");
            continue;
        }
        const gw_done *done = tile ? &tile->done : own;
        if (done->code)
            return gw_fail(error, (gw_code)done->code, "tile %s: %s", rank->layout.tiles[i].name, done->text);
        pixels[i] = tile ? tile->pixels : rank->pixels;
        double milliseconds = (double)done->render_ns * 1e-6;
        *slowest = milliseconds > *slowest ? milliseconds : *slowest;
        gw_counters_add(sum, &done->counters);
        gw_predicted_error_add(&conductor->seen, &done->predicted);
        gw_budget_note(&conductor->budget, i, done);
    }
    gw_predicted_error_add(&conductor->predicted, &conductor->seen);
    return GW_OK;
}

static void write_row(gw_conductor *conductor, uint32_t frame, const gw_counters *sum, double presented,
                      double slowest) {
    const gw_frame_state *s = &conductor->states[frame], knobs = gw_frame_state_in_force(s);
    const gw_gaze *g = &s->gazes[0]; /* all zero when there is none */
    fprintf(conductor->rows,
            "%" PRIu32 ",%.3f,%.9f,%.9g,%.9g,%.9g,%" PRIu32 ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%" PRIu32
            ",%d,%.9g,%.9g,%.9g,%d,%.6g,%.6g,%" PRIu64 ",%.3f,%.3f,0,%" PRIu32 "\n",
            s->frame, presented, (double)s->time * 1e-9, s->eye[0], s->eye[1], s->eye[2], s->gaze_count,
            (double)g->direction[0], (double)g->direction[1], (double)g->direction[2], (double)g->age,
            (double)g->confidence, (double)knobs.tau, (double)knobs.tau_inside, s->epoch, s->accumulate,
            (double)s->strain, (double)knobs.gaze_margin, (double)knobs.acuity_slope, 1 << knobs.sample_block,
            conductor->seen.worst, gw_predicted_error_mean(&conductor->seen), sum->rays,
            conductor->milliseconds[frame], slowest, conductor->lost_count);
    fflush(conductor->rows);
}

static gw_code write_picture(const char *folder, const char *name, const gw_image *image, const char *comment,
                             gw_error *error) {
    char *path = gw_path_join(folder, name);
    gw_interrupt_hold();
    gw_code code = path ? gw_image_write_png(path, image, comment, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    gw_interrupt_release();
    free(path);
    return code;
}

/* wall-NNNN.png and wall-bezels-NNNN.png, and the plain names for the last frame; a frame that lacks a tile
 * says so in its name and never gets a plain one. */
static gw_code write_pictures(gw_conductor *conductor, const struct gw_rank *rank, const gw_release *release,
                              const uint8_t *const *pixels, gw_error *error) {
    const char *folder = rank->options.out;
    const char *mark = conductor->lost_count ? "-incomplete" : "";
    for (int framed = 0; framed < 2; framed++) {
        gw_image image = {0};
        gw_code code = gw_picture_assemble(&rank->layout, pixels, framed, &image, error);
        const char *stem = framed ? "wall-bezels" : "wall";
        char name[64], comment[128];
        /* Not a word about the split: every split of a wall gives the same file. */
        snprintf(comment, sizeof comment, "Gazewall " GW_VERSION ", frame %" PRIu32 "%s",
                 release->state.frame, conductor->lost_count ? ", incomplete" : "");
        snprintf(name, sizeof name, "%s-%04" PRIu32 "%s.png", stem, release->state.frame, mark);
        if (!code)
            code = write_picture(folder, name, &image, comment, error);
        if (!code && release->last) {
            snprintf(name, sizeof name, "%s%s.png", stem, mark);
            code = write_picture(folder, name, &image, comment, error);
            if (!framed) {
                char *path = gw_path_join(folder, name);
                gw_report_image(conductor->report, path, &image);
                free(path);
            }
        }
        gw_image_finish(&image);
        if (code)
            return code;
    }
    return GW_OK;
}

/* Without --out the report still tells the last picture's hash. */
static gw_code hash_picture(gw_conductor *conductor, const struct gw_rank *rank, const uint8_t *const *pixels,
                            gw_error *error) {
    gw_image image = {0};
    gw_code code = gw_picture_assemble(&rank->layout, pixels, 0, &image, error);
    if (!code)
        gw_report_image(conductor->report, NULL, &image);
    gw_image_finish(&image);
    return code;
}

static gw_code draw_frame(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, int64_t start,
                          gw_error *error) {
    gw_release release = {.kind = GW_RELEASE_FRAME, .last = frame + 1 == conductor->frame_count};
    release.pixels = release.last || rank->options.out;
    release.predict = release.last || rank->options.out || gw_budget_is_on(&conductor->budget);
    make_state(conductor, rank, frame, &release.state);
    conductor->states[frame] = release.state;
    int64_t begin = gw_now_ns();
    gw_code code = gw_gate_release(conductor->gate, &release, error);
    if (code)
        return code;
    gw_done own;
    uint32_t lost = 0;
    const int64_t patience = patience_of(conductor, rank, frame);
    const double wall = (double)rank->layout.picture[0] * rank->layout.picture[1];
    promise(rank, patience, wall);
    gw_rank_draw(rank, &release, &own);
    promise(rank, patience, wall);
    code = gw_gate_collect(conductor->gate, patience, &lost, error);
    if (code)
        return code;
    int64_t end = gw_now_ns();
    conductor->milliseconds[frame] = (double)(end - begin) * 1e-6;

    const uint8_t *pixels[GW_MAXIMUM_TILES];
    gw_counters sum;
    double slowest;
    code = add_up(conductor, rank, &own, release.state.frame, pixels, &sum, &slowest, error);
    if (code)
        return code;
    gw_counters_add(&conductor->counters, &sum);
    if (gw_budget_is_on(&conductor->budget))
        gw_budget_decide(&conductor->budget, &release.state);
    if (conductor->rows)
        write_row(conductor, frame, &sum, (double)(end - start) * 1e-6, slowest);
    promise(rank, 0, 4 * wall);
    if (rank->options.out)
        code = write_pictures(conductor, rank, &release, pixels, error);
    else if (release.last)
        code = hash_picture(conductor, rank, pixels, error);
    return code;
}

/* --- after the last frame
 * --------------------------------------------------------------------------------------- */

static void print(struct gw_rank *rank, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void print(struct gw_rank *rank, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    gw_link_send(&rank->line, GW_LINK_PRINT, 0, text);
}

static void sum_up(const gw_conductor *conductor, struct gw_rank *rank) {
    const gw_layout *layout = &rank->layout;
    const char *out = rank->options.out;
    gw_spread ms = gw_spread_of(conductor->milliseconds, conductor->frame_count);
    double total = 0;
    for (uint32_t i = 0; i < conductor->frame_count; i++)
        total += conductor->milliseconds[i];
    double pixels = (double)conductor->frame_count * layout->picture[0] * layout->picture[1];
    print(rank, "scene    %s", conductor->scene_line ? conductor->scene_line : "");
    print(rank, "octree   %s", conductor->octree_line ? conductor->octree_line : "");
    print(rank, "wall     %" PRIu32 " tiles, %" PRIu32 "x%" PRIu32 " px, %.0fx%.0f mm%s", layout->tile_count,
          layout->picture[0], layout->picture[1], layout->size[0], layout->size[1],
          conductor->lost_count ? ", NOT ALL OF THEM TO THE END: see the warnings" : "");
    print(rank, "frames   %" PRIu32 ": median %.0f ms, slowest %.0f ms", conductor->frame_count, ms.median,
          ms.maximum);
    print(rank, "rays     %.2f million, %.2f per pixel, %.2f million a second",
          (double)conductor->counters.rays * 1e-6, (double)conductor->counters.rays / pixels,
          (double)conductor->counters.rays * 1e-3 / total);
    const gw_budget *budget = &conductor->budget;
    if (gw_budget_is_on(budget))
        print(rank, "budget   %g %s a frame, exceeded in %" PRIu32 " of %" PRIu32 " frames",
              budget->rays > 0 ? budget->rays : budget->milliseconds, budget->rays > 0 ? "rays" : "ms",
              budget->over, budget->frames);
    print(rank, "error    outside the gaze %.1f times coarser than viewers resolve at worst, %.2f on average",
          conductor->predicted.worst, gw_predicted_error_mean(&conductor->predicted));
    if (out && !conductor->lost_count)
        print(rank,
              "look at  %s/wall.png (the wall), %s/wall-bezels.png (as it hangs), tile-*.png (one per rank), "
              "frames.csv",
              out, out);
    if (rank->options.draw.report)
        print(rank, "report   %s", rank->options.draw.report);
}

static gw_code finish(gw_conductor *conductor, struct gw_rank *rank, gw_error *error) {
    const gw_sim_options *options = &rank->options;
    gw_code code = GW_OK;
    if (conductor->rows && (ferror(conductor->rows) | fclose(conductor->rows)))
        code = gw_fail(error, GW_NO_OUTPUT, "%s/frames.csv could not be written to its end", options->out);
    if (!code && options->save_states)
        code = gw_states_save(options->save_states, conductor->states, conductor->frame_count, error);
    gw_report_tiles(conductor->report, &rank->layout, conductor->lost_frame);
    gw_report_frames(conductor->report, conductor->milliseconds, conductor->frame_count);
    gw_report_counters(conductor->report, &conductor->counters);
    const gw_frame_state *last = &conductor->states[conductor->frame_count - 1];
    gw_report_predicted_error(conductor->report, &conductor->predicted, last,
                              gw_budget_json(&conductor->budget));
    if (!code)
        code = gw_renderer_report(rank->renderer, conductor->report, error);
    if (!code && options->draw.report) {
        gw_interrupt_hold();
        code = gw_report_write(conductor->report, options->draw.report, error);
        gw_interrupt_release();
    }
    if (!code && !options->draw.quiet)
        sum_up(conductor, rank);
    return code ? code : conductor->lost_count ? GW_TILES_LOST : GW_OK;
}

gw_code gw_conductor_run(gw_conductor *conductor, struct gw_rank *rank, gw_error *error) {
    gw_code code = GW_OK;
    int64_t start = gw_now_ns();
    for (uint32_t frame = 0; frame < conductor->frame_count && !code; frame++) {
        char text[64] = "drawing frames";
        if (conductor->seen.places)
            snprintf(text, sizeof text, "drawing frames, error %.1f times", conductor->seen.worst);
        gw_log_progress(&rank->line.log, text, (double)frame / conductor->frame_count);
        code = draw_frame(conductor, rank, frame, start, error);
    }
    promise(rank, patience_of(conductor, rank, 0), 0);
    gw_gate_quit(conductor->gate);
    return code ? code : finish(conductor, rank, error);
}
