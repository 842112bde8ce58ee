#include "wall/conductor_internal.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "wall/rank.h"
#include "wall/report.h"

#include <inttypes.h>
#include <string.h>

/* --- before frame 1
 * --------------------------------------------------------------------------------------------- */

gw_code gw_conductor_init(gw_conductor *conductor, struct gw_rank *rank, int argc, char **argv,
                          gw_error *error) {
    const gw_sim_options *options = &rank->options;
    for (int i = 0; i < GW_MAXIMUM_TILES; i++)
        conductor->lost_frame[i] = -1;
    gw_code code = gw_conductor_create_report(conductor, rank, argc, argv, error);
    if (!code)
        code = gw_conductor_choose_source(conductor, rank, error);
    if (!code)
        code = gw_allocate((void **)&conductor->states, conductor->kept, sizeof *conductor->states,
                           "frame states", error);
    if (!code)
        code = gw_allocate((void **)&conductor->milliseconds, conductor->kept, sizeof(double), "frame times",
                           error);
    if (!code && options->out)
        code = gw_make_directories(options->out, error);
    if (!code && options->out)
        code = gw_conductor_open_rows(conductor, options->out, error);
    if (!code)
        code = gw_pilot_open(rank, &conductor->pilot, error);
    if (!code)
        code = gw_gate_create(&rank->site.layout, &conductor->gate, error);
    gw_report_settings(conductor->report, &options->draw.settings);
    return code;
}

/* --- a frame
 * ---------------------------------------------------------------------------------------------------- */

/* How long a silent tile is waited for. Kernels are compiled in the first frame, on all tiles at once. */
static int64_t patience_of(const gw_conductor *conductor, const struct gw_rank *rank, uint32_t done_frames) {
    const double first_frame = 120;
    double seconds = rank->options.frame_deadline;
    if (seconds <= 0) {
        seconds = 20e-3 * gw_spread_of(conductor->milliseconds,
                                       done_frames < conductor->kept ? done_frames : conductor->kept)
                              .median;
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
                 rank->site.layout.tiles[tile].name, tile, frame, why);
}

/* After the gate: adds up what the tiles did; a tile that could not draw ends the run, because the others
 * would fail the same way. *slowest in ms. */
static gw_code add_up(gw_conductor *conductor, const struct gw_rank *rank, const gw_done *own, uint32_t frame,
                      const uint8_t **pixels, gw_counters *sum, double *slowest, gw_error *error) {
    memset(sum, 0, sizeof *sum);
    memset(&conductor->seen, 0, sizeof conductor->seen);
    *slowest = 0;
    for (uint32_t i = 0; i < rank->site.layout.tile_count; i++) {
        const gw_gate_tile *tile = i ? gw_gate_tile_of(conductor->gate, i) : NULL;
        pixels[i] = NULL;
        if (tile && tile->state == GW_TILE_LOST) {
            if (conductor->lost_frame[i] < 0)
                note_loss(conductor, rank, i, frame, "nothing came from it in time");
            continue;
        }
        const gw_done *done = tile ? &tile->done : own;
        if (done->code)
            return gw_fail(error, (gw_code)done->code, "tile %s: %s", rank->site.layout.tiles[i].name,
                           done->text);
        pixels[i] = tile ? tile->pixels : rank->pixels;
        double milliseconds = (double)done->render_ns * 1e-6;
        if (milliseconds > *slowest) {
            *slowest = milliseconds;
            conductor->slowest_tile = i;
        }
        gw_counters_add(sum, &done->counters);
        gw_predicted_error_add(&conductor->seen, &done->predicted);
        gw_budget_note(&conductor->budget, i, done);
    }
    gw_predicted_error_add(&conductor->predicted, &conductor->seen);
    return GW_OK;
}

/* Known before the frame is released, so that the last one can be treated as such. */
static int is_last(const gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame) {
    return frame + 1 == conductor->frame_count || gw_pilot_wants_end(conductor->pilot) ||
           (rank->options.save_states && frame + 1 == GW_MAXIMUM_STATES);
}

static gw_code draw_frame(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, int64_t start,
                          int *last, gw_error *error) {
    gw_pilot_poll(conductor->pilot, frame);
    *last = is_last(conductor, rank, frame);
    gw_release release = {.kind = GW_RELEASE_FRAME, .last = (uint32_t)*last};
    release.pixels = release.last || rank->options.out || gw_pilot_wants_pixels(conductor->pilot);
    release.predict = release.last || rank->options.out || gw_budget_is_on(&conductor->budget);
    gw_code code = gw_conductor_make_state(conductor, rank, frame, &release.state, error);
    conductor->states[gw_kept(conductor, frame)] = release.state;
    int64_t begin = gw_now_ns();
    if (!code)
        code = gw_gate_release(conductor->gate, &release, error);
    if (code)
        return code;
    gw_done own;
    uint32_t lost = 0;
    const int64_t patience = patience_of(conductor, rank, frame);
    const double wall = (double)rank->site.layout.picture[0] * rank->site.layout.picture[1];
    promise(rank, patience, wall);
    gw_rank_draw(rank, &release, &own);
    promise(rank, patience, wall);
    code = gw_gate_collect(conductor->gate, patience, &lost, error);
    if (code)
        return code;
    int64_t end = gw_now_ns();
    conductor->milliseconds[gw_kept(conductor, frame)] = (double)(end - begin) * 1e-6;

    const uint8_t *pixels[GW_MAXIMUM_TILES];
    gw_counters sum;
    double slowest;
    code = add_up(conductor, rank, &own, release.state.frame, pixels, &sum, &slowest, error);
    if (code)
        return code;
    conductor->slowest_ms = slowest;
    gw_counters_add(&conductor->counters, &sum);
    if (gw_budget_is_on(&conductor->budget))
        gw_budget_decide(&conductor->budget, &release.state);
    if (conductor->rows)
        gw_conductor_write_row(conductor, frame, &sum, (double)(end - start) * 1e-6, slowest);
    promise(rank, 0, 4 * wall);
    if (rank->options.out)
        code = gw_conductor_write_pictures(conductor, rank, &release, pixels, error);
    else if (release.last)
        code = gw_conductor_hash_picture(conductor, rank, pixels, error);
    const gw_pilot_facts facts = {.state = &release.state,
                                  .pixels = pixels,
                                  .milliseconds = (double)(end - begin) * 1e-6,
                                  .rays = sum.rays};
    return code ? code : gw_pilot_show(conductor->pilot, &facts, error);
}

/* --- after the last frame
 * --------------------------------------------------------------------------------------- */

gw_code gw_conductor_run(gw_conductor *conductor, struct gw_rank *rank, gw_error *error) {
    gw_code code = GW_OK;
    int64_t start = gw_now_ns();
    uint32_t frame = 0;
    int last = 0;
    conductor->started = conductor->started ? start : 0;
    /* An interruption ends the run after this frame, with what there is: states, rows, report. */
    for (; !last && !code && !(frame && gw_link_stop(&rank->line)); frame++) {
        char text[160];
        gw_conductor_status(conductor, rank, frame, text);
        gw_log_progress(&rank->line.log, text,
                        conductor->frame_count == GW_ENDLESS ? -1 : (double)frame / conductor->frame_count);
        code = draw_frame(conductor, rank, frame, start, &last, error);
    }
    promise(rank, patience_of(conductor, rank, 0), 0);
    gw_pilot_close(&conductor->pilot);
    gw_gate_quit(conductor->gate);
    conductor->frame_count = frame;
    return code ? code : gw_conductor_finish(conductor, rank, error);
}
