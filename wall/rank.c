#include "wall/rank.h"

#include "base/clock.h"
#include "base/image.h"
#include "base/memory.h"
#include "render/camera.h"
#include "wall/conductor.h"
#include "wall/interrupt.h"
#include "wall/mpi_wait.h"
#include "wall/notice.h"
#include "wall/picture.h"
#include "wall/rank_device.h"
#include "wall/rejoin.h"
#include "wall/stereo.h"
#include "wall/tile_picture.h"
#include "wall/verbs.h"

#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ATTEND_MS = 20 }; /* how often rank 0 listens while it draws */

static const gw_tile *own_tile(const gw_rank *rank) {
    return &rank->site.layout.tiles[rank->number];
}

static gw_stereo own_stereo(const gw_rank *rank) {
    return (gw_stereo)rank->site.panels[rank->number].stereo;
}

/* --- a frame
 * ---------------------------------------------------------------------------------------------------- */

static gw_code draw_scene(gw_rank *rank, const gw_release *release, gw_done *done, gw_error *error) {
    const gw_tile *tile = own_tile(rank);
    const gw_layout *layout = &rank->site.layout;
    gw_similarity placement;
    const int64_t begin = gw_now_ns();
    gw_code code = gw_place_frame(&rank->share.scene.scene, &release->state, layout->size[0], layout->size[1],
                                  layout->centre, layout->eye, &placement, error);
    if (!code)
        code = gw_stereo_draw(rank->renderer, &placement, own_stereo(rank), tile, &release->state,
                              rank->eye_pixels, rank->pixels, &done->counters, error);
    if (!code)
        code = gw_gl_check_reset(error);
    done->render_ns = gw_now_ns() - begin;
    done->making = (uint32_t)gw_renderer_makes_kernels(rank->renderer);
    gw_renderer_take_luminance(rank->renderer, &done->luminance);
    const double blend_ms = (double)gw_renderer_take_blend_ns(rank->renderer) * 1e-6;
    rank->lane_ms[GW_LANE_BLEND] = (float)blend_ms;
    rank->lane_ms[GW_LANE_TRACE] = (float)((double)done->render_ns * 1e-6 - blend_ms);
    if (!code && release->predict)
        code = gw_stereo_predict(&rank->share.scene.scene, &rank->share.octree, &placement, own_stereo(rank),
                                 tile, &release->state, &done->predicted, error);
    return code;
}

static gw_code draw(gw_rank *rank, const gw_release *release, gw_done *done, gw_error *error) {
    const gw_pattern_kind pattern = rank->options.pictures.pattern;
    gw_code code = gw_tile_fault_strike(rank->options.tile_faults, rank->options.tile_fault_count,
                                        (uint32_t)rank->number, release->number, error);
    if (code || rank->options.gate_only)
        return code;
    if (release->site != rank->site_epoch)
        return gw_fail(error, GW_MACHINE,
                       "frame %" PRIu32 " is of site %" PRIu32 ", and this tile has site %" PRIu32,
                       release->state.frame, release->site, rank->site_epoch);
    done->site = rank->site_epoch;
    rank->missed.skipped += release->number - rank->next;
    rank->next = release->number + 1;
    if (pattern)
        gw_pattern_draw(pattern, &rank->site, (uint32_t)rank->number, rank->pixels);
    else
        code = draw_scene(rank, release, done, error);
    if (!code)
        code = gw_rank_decorate(rank, &release->state, done, error);
    if (!code && rank->options.out && gw_tile_writes_itself(rank, (uint32_t)rank->number))
        code = gw_tile_write_pictures(rank, (uint32_t)rank->number, gw_rank_shown(rank), release, error);
    if (code)
        return code;
    const int64_t begin = gw_now_ns();
    code = gw_present_stage(rank->present, gw_rank_shown(rank), error);
    gw_rank_time(rank, GW_LANE_PRESENT, begin);
    return code;
}

void gw_rank_draw(gw_rank *rank, const gw_release *release, gw_done *done) {
    gw_error error = {0};
    memset(done, 0, sizeof *done);
    done->frame = release->state.frame;
    rank->latency = release->latency;
    done->code = (int32_t)draw(rank, release, done, &error);
    snprintf(done->text, sizeof done->text, "%s", error.text);
    rank->drawn = done->code ? 0 : release->number + 1;
}

int gw_rank_present(gw_rank *rank, uint32_t *number, int64_t *when) {
    if (!rank->drawn)
        return 0;
    const int64_t begin = gw_now_ns();
    *number = rank->drawn - 1;
    *when = gw_present_show(rank->present);
    rank->drawn = 0;
    if (!rank->programs_kept)
        gw_model_keep_programs(rank->model.device, &rank->line.log);
    rank->programs_kept = 1;
    rank->lane_ms[GW_LANE_PRESENT] += (float)((double)(gw_now_ns() - begin) * 1e-6);
    return 1;
}

gw_code gw_rank_take_site(gw_rank *rank, const gw_site *site, uint32_t epoch, gw_error *error) {
    const gw_rectangle *now = &own_tile(rank)->rectangle, *new = &site->layout.tiles[rank->number].rectangle;
    if (site->layout.tile_count != rank->site.layout.tile_count || now->width != new->width ||
        now->height != new->height)
        return gw_fail(error, GW_MACHINE, "a new site came whose tiles are not those of this run");
    rank->site = *site;
    rank->site_epoch = epoch;
    free(rank->eye_pixels);
    rank->eye_pixels = NULL;
    const size_t scratch = gw_stereo_scratch(own_stereo(rank), own_tile(rank));
    gw_code code = gw_present_take_panel(rank->present, &site->panels[rank->number], error);
    if (!code && scratch)
        code = gw_allocate((void **)&rank->eye_pixels, scratch, 1, "pixels of an eye", error);
    return code;
}

/* Instead of a frozen frame, or of none: what this tile waits for, or why it ends. Nothing more can be done
 * about a failure here. */
static void show_notice(gw_rank *rank, gw_notice_kind kind, const char *reason) {
    const gw_tile *tile = own_tile(rank);
    const gw_rectangle *rectangle = &tile->rectangle;
    gw_error ignored = {0};
    gw_image image;
    if (!rectangle->width || gw_notice_draw(kind, rectangle->width, rectangle->height, tile->name,
                                            rank->number, reason, &image, &ignored))
        return;
    if (!gw_present_stage(rank->present, image.rgba, &ignored))
        gw_present_show(rank->present);
    char *path = rank->options.out && kind == GW_NOTICE_ENDED
                     ? gw_picture_path(rank->options.out, "tile-%s-notice.png", tile->name)
                     : NULL;
    if (path)
        gw_image_write_png(path, &image, "Gazewall " GW_VERSION ", notice", &ignored);
    free(path);
    gw_image_finish(&image);
}

/* --- before frame 1
 * --------------------------------------------------------------------------------------------- */

static gw_code spread_site(gw_rank *rank, gw_error *error) {
    gw_code code = rank->number == 0 ? gw_wall_site(&rank->options.wall, &rank->site, error) : GW_OK;
    if (code)
        return code;
    MPI_Request request;
    code =
        gw_mpi_check(MPI_Ibcast(&rank->site, (int)sizeof rank->site, MPI_BYTE, 0, MPI_COMM_WORLD, &request),
                     "sending the site", error);
    if (!code)
        code = gw_mpi_wait(&request, rank->load_deadline, "waiting for the site", error);
    if (!code && rank->site.layout.tile_count != (uint32_t)rank->size)
        code = gw_fail(error, GW_MACHINE, "the wall has %" PRIu32 " tiles, but MPI started %d ranks",
                       rank->site.layout.tile_count, rank->size);
    rank->load_deadline = rank->begin + (int64_t)(gw_sim_times(&rank->options, &rank->site).load * 1e9);
    return code;
}

/* Rank 0 reads its cache; what is not there is built by the ranks that it chooses. */
static gw_code build(gw_rank *rank, gw_error *error) {
    gw_model *model = &rank->model;
    const gw_draw_options *draw = &rank->options.draw;
    const gw_together_options options = {.settings = &draw->settings,
                                         .log = &rank->line.log,
                                         .builders = rank->options.builders,
                                         .machine = rank->share.leader,
                                         .deadline = rank->load_deadline,
                                         .fault = rank->options.fault,
                                         .fault_rank = rank->options.fault_rank};
    gw_octree *octree = NULL;
    int64_t begin = gw_now_ns();
    int needed = rank->number == 0 && !gw_model_find(model, draw, &rank->line.log);
    gw_code code = gw_build_together(model->device, &rank->share.scene.scene, &options, needed, &octree,
                                     &rank->together, error);
    if (!code && octree)
        gw_model_keep(model, draw, octree, begin, &rank->line.log);
    return code;
}

/* Rank 0 imports, all build; every rank maps the one copy of its machine. */
static gw_code load(gw_rank *rank, gw_conductor *conductor, gw_error *error) {
    gw_model *model = &rank->model;
    const gw_draw_options *draw = &rank->options.draw;
    char *cache = gw_cache_folder(draw);
    const gw_share_options options = {.deadline = rank->load_deadline,
                                      .cache = cache,
                                      .cache_limit = draw->cache_limit,
                                      .restarts = gw_sim_restarts(&rank->options, &rank->site) > 0,
                                      .log = &rank->line.log};
    gw_code code = gw_rank_open_window(rank, error);
    if (!code && rank->number == 0)
        code = gw_model_import(model, draw, &rank->line.log, error);
    if (!code && rank->number == 0 && rank->options.pictures.remake)
        code = gw_side_car_check_scene(&rank->options.remade, model->scene, error);
    if (!code)
        code = gw_share_scene(&rank->share, model->scene, &options, error);
    if (!code)
        code = gw_rank_open_device(rank, error);
    if (!code)
        code = build(rank, error);
    if (!code && rank->number == 0)
        code = gw_conductor_describe(conductor, rank, error);
    if (!code)
        code = gw_share_octree(&rank->share, model->octree, &options, error);
    gw_model_drop(model);
    free(cache);
    return code;
}

static void attend(void *context) {
    gw_rank_attend(context);
}

/* Between slices of long work: whoever waits for this rank learns that it lives. */
static void pulse(void *context, double silence) {
    gw_rank *rank = context;
    gw_rank_attend(rank);
    if (rank->number > 0) {
        gw_gate_client_pulse(&rank->gate, silence);
        return;
    }
    int64_t now = gw_now_ns();
    if (silence > 0)
        gw_link_promise(&rank->line, silence + 10);
    if (silence > 0 || now - rank->attended > ATTEND_MS * INT64_C(1000000))
        gw_gate_attend(rank->conducted, (int64_t)(silence * 1e9));
    rank->attended = now;
}

gw_code gw_rank_create_renderer(gw_rank *rank, gw_error *error) {
    const gw_layout *layout = &rank->site.layout;
    const gw_share *shared = &rank->share;
    gw_similarity placement;
    gw_code code = GW_OK;
    /* A scene that cannot be placed is told now, not in the first frame. */
    if (!rank->options.path && !rank->options.states)
        code = gw_place_scene(&shared->scene.scene, layout->size[0], layout->size[1], layout->centre,
                              layout->eye, &placement, error);
    if (code)
        return code;
    gw_renderer_options options = {.count = rank->options.draw.count,
                                   .settings = &rank->options.draw.settings,
                                   .force_features = rank->options.draw.force_effects,
                                   .forbid_features = rank->options.draw.forbid_effects,
                                   .kernels = rank->options.draw.kernels,
                                   .time_blending = rank->options.pictures.overlay,
                                   .log = &rank->line.log};
    code = gw_renderer_create(rank->model.device, &shared->scene.scene, &shared->octree, &options,
                              &rank->renderer, error);
    if (!code)
        gw_gl_set_pulse(rank->model.device, pulse, rank);
    return code;
}

/* The window of the whole wall is the pilot's. */
static gw_code open_presentation(gw_rank *rank, gw_error *error) {
    const gw_rectangle *rectangle = &own_tile(rank)->rectangle;
    if (rank->present || !rank->model.device || rank->options.windows == GW_WINDOWS_WALL)
        return GW_OK;
    return gw_present_open(rank->model.device, &rank->site.panels[rank->number], rectangle->width,
                           rectangle->height, &rank->present, error);
}

gw_code gw_rank_open_window(gw_rank *rank, gw_error *error) {
    if (!gw_rank_has_window(rank))
        return GW_OK;
    gw_code code = gw_rank_open_device(rank, error);
    if (!code)
        code = open_presentation(rank, error);
    if (!code && gw_present_is_seen(rank->present))
        show_notice(rank, GW_NOTICE_WAITS, "loading the scene");
    return code;
}

gw_code gw_rank_make_room(gw_rank *rank, gw_error *error) {
    const gw_rectangle *rectangle = &own_tile(rank)->rectangle;
    const size_t scratch = gw_stereo_scratch(own_stereo(rank), own_tile(rank));
    gw_code code =
        gw_allocate((void **)&rank->pixels, (size_t)rectangle->width * rectangle->height, 4, "pixels", error);
    if (!code && scratch)
        code = gw_allocate((void **)&rank->eye_pixels, scratch, 1, "pixels of an eye", error);
    if (!code)
        code = open_presentation(rank, error);
    rank->gate.idle = attend;
    rank->gate.idle_context = rank;
    return code;
}

/* All that this rank's tile is drawn with; a test pattern needs no scene. */
static gw_code prepare_drawing(gw_rank *rank, gw_conductor *conductor, gw_error *error) {
    gw_code code = GW_OK;
    if (gw_rank_needs_scene(rank)) {
        code = load(rank, conductor, error);
        if (!code)
            code = gw_rank_create_renderer(rank, error);
    } else
        code = gw_rank_open_window(rank, error);
    return code ? code : gw_rank_make_room(rank, error);
}

static gw_code get_ready(gw_rank *rank, gw_conductor *conductor, gw_error *error) {
    gw_code code = rank->options.gate_only ? GW_OK : prepare_drawing(rank, conductor, error);
    if (code)
        return code;
    gw_log_write(&rank->line.log, GW_LOG_DEBUG, "rank %d draws tile %s in process %ld", rank->number,
                 own_tile(rank)->name, (long)getpid());
    gw_link_send(&rank->line, GW_LINK_READY, 0, "");
    /* The last collective: from here on nobody depends on a rank that may die. */
    MPI_Request request;
    code = gw_mpi_check(MPI_Ibarrier(MPI_COMM_WORLD, &request), "waiting for all ranks", error);
    return code ? code : gw_mpi_wait(&request, rank->load_deadline, "waiting for all ranks", error);
}

/* --- the run
 * ---------------------------------------------------------------------------------------------------- */

/* Of a process that took the place of one that was lost: how long it took to show its first frame. */
static void note_rejoin(gw_rank *rank, int64_t when) {
    if (!rank->rejoined)
        return;
    rank->gate.rejoin_ms = 1 + (uint32_t)((when - rank->rejoined) / 1000000);
    rank->rejoined = 0;
    gw_log_write(&rank->line.log, GW_LOG_DEBUG, "tile %s: first frame after %.0f ms of processor",
                 own_tile(rank)->name, (double)gw_processor_ns() * 1e-6);
}

gw_code gw_rank_follow(gw_rank *rank, gw_error *error) {
    const gw_rectangle *rectangle = &own_tile(rank)->rectangle;
    const size_t size = (size_t)rectangle->width * rectangle->height * 4;
    for (;;) {
        gw_release release;
        uint32_t shown;
        int64_t when;
        const int64_t begin = gw_now_ns();
        gw_code code = gw_gate_client_wait(&rank->gate, &release, error);
        if (code)
            return code;
        gw_rank_time(rank, GW_LANE_WAIT, begin);
        if (gw_rank_present(rank, &shown, &when)) {
            gw_gate_client_presented(&rank->gate, shown, when);
            note_rejoin(rank, when);
        }
        if (release.kind == GW_RELEASE_QUIT) {
            gw_gate_client_leave(&rank->gate);
            return GW_OK;
        }
        if (release.site != rank->site_epoch && release.site == rank->gate.site_epoch)
            code = gw_rank_take_site(rank, &rank->gate.site, release.site, error);
        if (code)
            return code;
        static gw_done done;
        gw_rank_draw(rank, &release, &done);
        const int pixels = !done.code && release.pixels;
        const int64_t answering = gw_now_ns();
        code = gw_gate_client_answer(&rank->gate, &done, pixels ? rank->pixels : NULL, size, error);
        gw_rank_time(rank, GW_LANE_GATE, answering);
        /* A live wall goes on without a tile that cannot draw; otherwise rank 0 ends the run. */
        if (!code && done.code && rank->options.live)
            code = gw_fail(error, (gw_code)done.code, "%s", done.text);
        if (code)
            return code;
    }
}

/* The number that mpirun gave this process, before MPI itself says so; -1: it was not started by mpirun. */
static int number_from_mpirun(void) {
    const char *number = getenv("OMPI_COMM_WORLD_RANK");
    return number ? (int)strtol(number, NULL, 10) : -1;
}

/* The line first: what MPI's own start finds wrong is told by name, and no rank of another program gets so
 * far. */
static gw_code connect_line(gw_rank *rank, gw_error *error) {
    const gw_draw_options *draw = &rank->options.draw;
    rank->number = rank->options.rejoin ? gw_rejoin_number(rank->options.rejoin) : number_from_mpirun();
    if (rank->number < 0)
        return gw_fail(error, GW_BAD_INPUT,
                       "a rank is started by gazewall sim or gazewall wall; start one of them");
    gw_code code = gw_link_connect(rank->options.link, rank->number, &rank->line, error);
    /* What every rank does the same way is told by rank 0 alone, unless somebody looks for trouble. */
    gw_log_level level = draw->quiet ? GW_LOG_ERROR : draw->level;
    if (rank->number > 0 && level == GW_LOG_INFO)
        level = GW_LOG_WARNING;
    rank->line.log.threshold = level;
    return code;
}

static gw_code start_mpi(gw_rank *rank, gw_error *error) {
    if (MPI_Init(NULL, NULL) != MPI_SUCCESS)
        return gw_fail(error, GW_MACHINE, "MPI could not be started");
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank->number);
    MPI_Comm_size(MPI_COMM_WORLD, &rank->size);
    return GW_OK;
}

static const char *see_root_lost(void *line) {
    return gw_link_root_lost(line);
}

static gw_code run(gw_rank *rank, int argc, char **argv, gw_error *error) {
    gw_conductor conductor = {0};
    gw_code code = gw_share_init(&rank->share, rank->options.machines, error);
    if (!code)
        code = spread_site(rank, error);
    if (!code && rank->number == 0)
        code = gw_conductor_init(&conductor, rank, argc, argv, error);
    else if (!code)
        code = gw_gate_client_open(&rank->gate, &rank->share, rank->number, rank->load_deadline, error);
    rank->conducted = conductor.gate;
    if (!code)
        code = get_ready(rank, &conductor, error);
    if (!code)
        code = rank->number == 0 ? gw_conductor_run(&conductor, rank, error) : gw_rank_follow(rank, error);
    return code;
}

int gw_verb_rank(int argc, char **argv) {
    static gw_rank rank;
    gw_error error = {0};
    int helped = 0;
    /* mpirun is our parent: it dies with the launcher, and we with it. */
    gw_interrupt_follow_parent(0);
    gw_code code = gw_sim_options_parse(argc, argv, &rank.options, &helped, &error);
    if (!code)
        code = connect_line(&rank, &error);
    if (code) {
        fprintf(stderr, "gazewall rank: %s\n", error.text);
        return (int)code;
    }
    /* Until the site is known, which has times of its own. */
    rank.begin = gw_now_ns();
    rank.load_deadline = rank.begin + INT64_C(600000000000);
    rank.gate.lost = see_root_lost;
    rank.gate.lost_context = &rank.line;
    if (rank.options.rejoin)
        code = gw_rank_rejoin(&rank, &error);
    else if (!(code = start_mpi(&rank, &error)))
        code = run(&rank, argc, argv, &error);
    if (code && code != GW_TILES_LOST)
        show_notice(&rank, GW_NOTICE_ENDED, error.text);
    else
        gw_model_keep_programs(rank.model.device, &rank.line.log);
    if (code && code != GW_TILES_LOST)
        gw_link_send(&rank.line, GW_LINK_FAILED, (int32_t)code, error.text);
    else
        gw_link_send(&rank.line, rank.number == 0 ? GW_LINK_RESULT : GW_LINK_LEFT, (int32_t)code, "");
    /* No MPI_Finalize: it is a collective, and would wait for a tile that was lost. The GL device and the
     * mappings end with the process. */
    fflush(NULL);
    _exit(code == GW_TILES_LOST ? 0 : (int)code);
}
