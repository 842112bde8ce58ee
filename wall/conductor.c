#include "wall/conductor_internal.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "wall/rank.h"
#include "wall/report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* --- before frame 1
 * --------------------------------------------------------------------------------------------- */

static int see_death(void *link, gw_death *out) {
    return gw_link_poll_lost(link, out);
}

static gw_code open_gate(gw_conductor *conductor, struct gw_rank *rank, gw_error *error) {
    const gw_site_times times = gw_sim_times(&rank->options, &rank->site);
    const gw_gate_options gate = {.layout = &rank->site.layout,
                                  .share = &rank->share,
                                  .live = rank->options.live,
                                  /* Between the frames of a lock-step run pictures are written. */
                                  .silence = (int64_t)(1e9 * (rank->options.live ? times.death : times.load)),
                                  .deadline = rank->load_deadline,
                                  .frames = conductor->kept,
                                  .died = see_death,
                                  .died_context = &rank->line,
                                  .log = &rank->line.log};
    return gw_gate_create(&gate, &conductor->gate, error);
}

gw_code gw_conductor_init(gw_conductor *conductor, struct gw_rank *rank, int argc, char **argv,
                          gw_error *error) {
    const gw_sim_options *options = &rank->options;
    gw_code code = gw_conductor_create_report(conductor, rank, argc, argv, error);
    if (!code)
        code = gw_conductor_choose_source(conductor, rank, error);
    if (!code)
        code = gw_allocate((void **)&conductor->states, conductor->kept, sizeof *conductor->states,
                           "frame states", error);
    if (!code)
        code = gw_allocate((void **)&conductor->milliseconds, conductor->kept, sizeof(double), "frame times",
                           error);
    if (!code)
        code = gw_allocate((void **)&conductor->latencies, conductor->kept, sizeof *conductor->latencies,
                           "latencies", error);
    if (!code && options->out)
        code = gw_make_directories(options->out, error);
    if (!code && options->out)
        code = gw_conductor_open_rows(conductor, options->out, error);
    gw_site_watch_begin(&conductor->watch, options->wall.site);
    if (!code)
        code = gw_pilot_open(rank, &conductor->pilot, error);
    if (!code)
        code = gw_conductor_open_pictures(conductor, rank, error);
    if (!code && options->serve) {
        code = gw_serve_open(options->serve, &conductor->serve, error);
        if (!code)
            gw_log_write(&rank->line.log, GW_LOG_INFO, "serving %s", gw_serve_name(conductor->serve));
    }
    if (!code)
        code = open_gate(conductor, rank, error);
    gw_report_settings(conductor->report, &options->draw.settings, &options->draw.profile);
    return code;
}

/* --- a frame
 * ---------------------------------------------------------------------------------------------------- */

static double usual_tile_ms(const gw_conductor *conductor, uint32_t done_frames) {
    return gw_spread_of(conductor->tile_ms, done_frames < GW_USUAL_FRAMES ? done_frames : GW_USUAL_FRAMES)
        .median;
}

/* How long what is waited for (docs/gate.md). Kernels are compiled in the first frame, on all tiles at once,
 * so all are waited for. */
static gw_patience patience_of(const gw_conductor *conductor, const struct gw_rank *rank,
                               uint32_t done_frames) {
    const double first_frame = 120, least = 10;
    const gw_site_times times = gw_sim_times(&rank->options, &rank->site);
    double frame = times.frame > 0 ? times.frame : 3 / times.refresh, death = times.death;
    if (times.frame <= 0)
        frame = fmax(frame, 2e-3 * usual_tile_ms(conductor, done_frames));
    if (!rank->options.live && rank->options.death_deadline <= 0)
        death = fmax(fmax(least, death), 20e-3 * usual_tile_ms(conductor, done_frames));
    if (done_frames == 0)
        death = fmax(death, first_frame);
    return (gw_patience){.live = rank->options.live && done_frames > 0,
                         .frame = (int64_t)(frame * 1e9),
                         .death = (int64_t)(death * 1e9)};
}

/* The launcher watches rank 0 as rank 0 watches the tiles: each stretch of work is announced with the time
 * that it may take. Pictures of so many pixels are written in it; 3 s a million is many times what that
 * needs. */
static void promise(struct gw_rank *rank, int64_t patience, double pixels) {
    gw_link_promise(&rank->line, (double)patience * 1e-9 + 10 + 3e-6 * pixels);
}

static double wall_pixels(const struct gw_rank *rank) {
    return (double)rank->site.layout.picture[0] * rank->site.layout.picture[1];
}

/* A tile that could not draw. In lock-step that ends the run, because the others would fail the same way. */
static gw_code note_failure(gw_conductor *conductor, const struct gw_rank *rank, uint32_t tile,
                            const gw_done *done, gw_error *error) {
    if (!rank->options.live || tile == 0)
        return gw_fail(error, (gw_code)done->code, "tile %s: %s", rank->site.layout.tiles[tile].name,
                       done->text);
    gw_gate_tile_died(conductor->gate, tile, done->text);
    conductor->missed[GW_MISSED_LOST]++;
    conductor->missing++;
    return GW_OK;
}

static void count_lost(gw_conductor *conductor, const struct gw_rank *rank) {
    conductor->lost_count = 0;
    for (uint32_t i = 1; i < rank->site.layout.tile_count; i++)
        conductor->lost_count += gw_gate_tile_of(conductor->gate, i)->lost > 0;
}

/* A bit for each tile that is lost now. */
static uint64_t lost_tiles(const gw_conductor *conductor, const struct gw_rank *rank) {
    uint64_t lost = 0;
    _Static_assert(GW_MAXIMUM_TILES <= 64, "a bit for each tile");
    for (uint32_t i = 1; i < rank->site.layout.tile_count; i++)
        lost |= (uint64_t)(gw_gate_tile_of(conductor->gate, i)->state == GW_TILE_LOST) << i;
    return lost;
}

static void note_light(gw_conductor *conductor, const struct gw_rank *rank, uint32_t tile,
                       const gw_done *done) {
    const gw_tile *drawn = &rank->site.layout.tiles[tile];
    const uint64_t pixels = (uint64_t)drawn->rectangle.width * drawn->rectangle.height;
    if (!gw_exposure_note(&conductor->exposure, tile, &done->luminance, pixels))
        gw_log_write(&rank->line.log, GW_LOG_WARNING,
                     "tile %s counted the light of more pixels than it has in frame %" PRIu32
                     "; its last count stands",
                     drawn->name, done->frame);
}

/* After the gate: adds up what the tiles did. *slowest in ms. */
static gw_code add_up(gw_conductor *conductor, const struct gw_rank *rank, const gw_done *own, uint32_t frame,
                      const uint8_t **pixels, const gw_done **all, gw_counters *sum, double *slowest,
                      gw_error *error) {
    double milliseconds[GW_MAXIMUM_TILES];
    uint32_t drawn = 0;
    *slowest = 0;
    memset(sum, 0, sizeof *sum);
    memset(&conductor->seen, 0, sizeof conductor->seen);
    memset(conductor->missed, 0, sizeof conductor->missed);
    conductor->missing = 0;
    for (uint32_t i = 0; i < rank->site.layout.tile_count; i++) {
        const gw_gate_tile *tile = i ? gw_gate_tile_of(conductor->gate, i) : NULL;
        const gw_done *done = tile ? &tile->done : own;
        all[i] = done;
        pixels[i] = NULL;
        if (tile && tile->missed) {
            conductor->missed[tile->missed]++;
            conductor->missing++;
            continue;
        }
        if (!done->code && done->site != rank->site_epoch)
            return gw_fail(error, GW_MACHINE, "tile %s drew frame %" PRIu32 " for another site",
                           rank->site.layout.tiles[i].name, done->frame);
        if (done->code) {
            gw_code code = note_failure(conductor, rank, i, done, error);
            if (code)
                return code;
            continue;
        }
        pixels[i] = tile ? tile->pixels : rank->pixels;
        if (!drawn || (double)done->render_ns * 1e-6 > *slowest) {
            *slowest = (double)done->render_ns * 1e-6;
            conductor->slowest_tile = i;
        }
        milliseconds[drawn++] = (double)done->render_ns * 1e-6;
        gw_counters_add(sum, &done->counters);
        gw_predicted_error_add(&conductor->seen, &done->predicted);
        gw_budget_note(&conductor->budget, i, done);
        note_light(conductor, rank, i, done);
    }
    conductor->tile_ms[frame % GW_USUAL_FRAMES] = gw_spread_of(milliseconds, drawn).median;
    gw_predicted_error_add(&conductor->predicted, &conductor->seen);
    count_lost(conductor, rank);
    return GW_OK;
}

/* Rank 0's tile shows what it drew last. */
static void present(gw_conductor *conductor, struct gw_rank *rank) {
    uint32_t shown;
    int64_t when;
    if (!gw_rank_present(rank, &shown, &when))
        return;
    conductor->presented++;
    gw_swap_skew_note(gw_gate_swaps(conductor->gate), shown, when, 0);
}

/* Known before the frame is released, so that the last one can be treated as such. */
static int is_last(const gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame) {
    return frame + 1 == conductor->frame_count || gw_pilot_wants_end(conductor->pilot) ||
           (rank->options.save_states && frame + 1 == GW_MAXIMUM_STATES);
}

/* What came after the state, for this frame's budget and for when the next will be seen. */
static void note_latency(gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame,
                         double slowest) {
    const double refresh = gw_sim_times(&rank->options, &rank->site).refresh;
    const double whole = conductor->milliseconds[gw_kept(conductor, frame)];
    gw_latency_complete(&conductor->latencies[gw_kept(conductor, frame)], slowest, whole, refresh);
    conductor->ahead_ms[frame % GW_USUAL_FRAMES] = whole + 500 / refresh;
}

/* What the frame shows, and what is wanted of it: nothing is released yet. */
static gw_code decide_frame(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, gw_release *out,
                            gw_error *error) {
    gw_pilot_poll(conductor->pilot, frame);
    const int last = is_last(conductor, rank, frame);
    *out = (gw_release){.kind = GW_RELEASE_FRAME,
                        .last = (uint32_t)last,
                        .pixels = (uint32_t)gw_conductor_wants_pixels(conductor, rank, last),
                        .predict = last || rank->options.out || gw_budget_is_on(&conductor->budget)};
    gw_code code = gw_conductor_reload(conductor, rank, frame, error);
    if (!code)
        code = gw_conductor_make_state(conductor, rank, frame, &out->state, error);
    if (frame)
        out->latency = conductor->latencies[gw_kept(conductor, frame - 1)];
    conductor->states[gw_kept(conductor, frame)] = out->state;
    return code;
}

/* Every tile draws, this one too, and is waited for as long as its patience lasts. */
static void run_frame(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, gw_release *release,
                      gw_done *own) {
    const int64_t begin = gw_now_ns();
    if (conductor->serve)
        gw_serve_frame(conductor->serve, &release->state);
    gw_gate_release(conductor->gate, release);
    gw_rank_time(rank, GW_LANE_GATE, begin);
    present(conductor, rank);
    const gw_patience patience = patience_of(conductor, rank, frame);
    promise(rank, patience.death, wall_pixels(rank));
    gw_rank_draw(rank, release, own);
    promise(rank, patience.death, wall_pixels(rank));
    const int64_t drawn = gw_now_ns();
    gw_gate_collect(conductor->gate, &patience);
    gw_rank_time(rank, GW_LANE_WAIT, drawn);
    conductor->milliseconds[gw_kept(conductor, frame)] = (double)(gw_now_ns() - begin) * 1e-6;
}

/* Counts, decides the next frame's budget, writes and shows what came. start: when the run began, ns. */
static gw_code finish_frame(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, int64_t start,
                            gw_release *release, const gw_done *own, gw_error *error) {
    const double presented = (double)(gw_now_ns() - start) * 1e-6;
    const uint8_t *pixels[GW_MAXIMUM_TILES], *shown[GW_MAXIMUM_TILES];
    const gw_done *done[GW_MAXIMUM_TILES];
    gw_counters sum;
    double slowest = 0;
    gw_code code = add_up(conductor, rank, own, frame, pixels, done, &sum, &slowest, error);
    if (code)
        return code;
    conductor->slowest_ms = slowest;
    conductor->making = own->making != 0;
    note_latency(conductor, rank, frame, slowest);
    gw_counters_add(&conductor->counters, &sum);
    if (gw_budget_is_on(&conductor->budget))
        gw_budget_decide(&conductor->budget, &release->state);
    if (conductor->rows)
        gw_conductor_write_row(conductor, frame, &sum, presented, slowest);
    promise(rank, 0, 4 * wall_pixels(rank));
    code = gw_conductor_show(conductor, rank, release, done, pixels, shown, error);
    const gw_pilot_facts facts = {.state = &release->state,
                                  .pixels = shown,
                                  .lost = lost_tiles(conductor, rank),
                                  .milliseconds = conductor->milliseconds[gw_kept(conductor, frame)],
                                  .rays = sum.rays};
    return code ? code : gw_pilot_show(conductor->pilot, &facts, error);
}

static gw_code draw_frame(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, int64_t start,
                          int *last, gw_error *error) {
    static gw_done own;
    gw_release release;
    gw_code code = decide_frame(conductor, rank, frame, &release, error);
    if (code)
        return code;
    *last = (int)release.last;
    run_frame(conductor, rank, frame, &release, &own);
    return finish_frame(conductor, rank, frame, start, &release, &own, error);
}

/* --- after the last frame
 * --------------------------------------------------------------------------------------- */

gw_code gw_conductor_run(gw_conductor *conductor, struct gw_rank *rank, gw_error *error) {
    gw_code code = GW_OK;
    int64_t start = gw_now_ns();
    uint32_t frame = 0;
    int last = 0;
    conductor->started = conductor->started ? start : 0;
    gw_conductor_open_door(conductor, rank);
    /* An interruption ends the run after this frame, with what there is: states, rows, report. */
    for (; !last && !code && !(frame && gw_link_stop(&rank->line)); frame++) {
        char text[160];
        gw_conductor_status(conductor, rank, frame, text);
        gw_log_progress(&rank->line.log, text,
                        conductor->frame_count == GW_ENDLESS ? -1 : (double)frame / conductor->frame_count);
        code = draw_frame(conductor, rank, frame, start, &last, error);
    }
    promise(rank, patience_of(conductor, rank, 0).death, 0);
    gw_pilot_close(&conductor->pilot);
    gw_gate_quit(conductor->gate);
    conductor->frame_count = frame;
    present(conductor, rank);
    gw_gate_wait_until_left(conductor->gate);
    count_lost(conductor, rank);
    gw_error closing = {0};
    const gw_code closed = gw_conductor_close_pictures(conductor, code, &closing);
    if (!code && closed)
        code = gw_fail(error, closed, "%s", closing.text);
    return code ? code : gw_conductor_finish(conductor, rank, error);
}
