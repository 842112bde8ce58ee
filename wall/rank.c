#include "wall/rank.h"

#include "base/clock.h"
#include "base/image.h"
#include "base/memory.h"
#include "render/camera.h"
#include "wall/conductor.h"
#include "wall/interrupt.h"
#include "wall/mpi_wait.h"
#include "wall/rank_device.h"
#include "wall/stereo.h"
#include "wall/tile_picture.h"
#include "wall/verbs.h"

#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const gw_tile *own_tile(const gw_rank *rank) {
    return &rank->site.layout.tiles[rank->number];
}

static gw_stereo own_stereo(const gw_rank *rank) {
    return (gw_stereo)rank->site.panels[rank->number].stereo;
}

/* --- a frame
 * ---------------------------------------------------------------------------------------------------- */

void gw_rank_draw(gw_rank *rank, const gw_release *release, gw_done *done) {
    const gw_tile *tile = own_tile(rank);
    gw_error error = {0};
    memset(done, 0, sizeof *done);
    done->frame = release->state.frame;
    int64_t begin = gw_now_ns();
    const gw_layout *layout = &rank->site.layout;
    gw_similarity placement;
    gw_code code = gw_place_frame(&rank->share.scene.scene, &release->state, layout->size[0], layout->size[1],
                                  layout->centre, layout->eye, &placement, &error);
    if (!code)
        code = gw_stereo_draw(rank->renderer, &placement, own_stereo(rank), tile, &release->state,
                              rank->eye_pixels, rank->pixels, &done->counters, &error);
    done->render_ns = gw_now_ns() - begin;
    if (!code && release->predict)
        code = gw_stereo_predict(&rank->share.scene.scene, &rank->share.octree, &placement, own_stereo(rank),
                                 tile, &release->state, &done->predicted, &error);
    if (!code && rank->options.out && gw_tile_writes_itself(rank, (uint32_t)rank->number))
        code = gw_tile_write_pictures(rank, (uint32_t)rank->number, rank->pixels, release, &error);
    done->code = (int32_t)code;
    snprintf(done->text, sizeof done->text, "%s", error.text);
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
                                      .log = &rank->line.log};
    gw_code code = gw_rank_has_window(rank) ? gw_rank_open_device(rank, error) : GW_OK;
    if (!code && rank->number == 0)
        code = gw_model_import(model, draw, &rank->line.log, error);
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

static gw_code get_ready(gw_rank *rank, gw_conductor *conductor, gw_error *error) {
    gw_code code = load(rank, conductor, error);
    if (code)
        return code;
    const gw_layout *layout = &rank->site.layout;
    const gw_share *shared = &rank->share;
    gw_similarity placement;
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
                                   .log = &rank->line.log};
    code = gw_renderer_create(rank->model.device, &shared->scene.scene, &shared->octree, &options,
                              &rank->renderer, error);
    if (code)
        return code;
    const gw_rectangle *rectangle = &own_tile(rank)->rectangle;
    const size_t scratch = gw_stereo_scratch(own_stereo(rank), own_tile(rank));
    code =
        gw_allocate((void **)&rank->pixels, (size_t)rectangle->width * rectangle->height, 4, "pixels", error);
    if (!code && scratch)
        code = gw_allocate((void **)&rank->eye_pixels, scratch, 1, "pixels of an eye", error);
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

/* Ranks above 0: draws what rank 0 releases until it says quit. */
static gw_code follow(gw_rank *rank, gw_error *error) {
    const int64_t patience = (int64_t)(rank->options.load_deadline * 1e9);
    const gw_rectangle *rectangle = &own_tile(rank)->rectangle;
    const size_t size = (size_t)rectangle->width * rectangle->height * 4;
    for (;;) {
        gw_release release;
        gw_code code = gw_gate_wait(&release, patience, error);
        if (code)
            return code;
        if (release.kind == GW_RELEASE_QUIT) {
            gw_gate_leave();
            return GW_OK;
        }
        gw_done done;
        gw_rank_draw(rank, &release, &done);
        code = gw_gate_answer(&done, done.code || !release.pixels ? NULL : rank->pixels, size, error);
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
    rank->number = number_from_mpirun();
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

static gw_code run(gw_rank *rank, int argc, char **argv, gw_error *error) {
    gw_conductor conductor = {0};
    gw_code code = gw_share_init(&rank->share, rank->options.machines, error);
    if (!code)
        code = spread_site(rank, error);
    if (!code && rank->number == 0)
        code = gw_conductor_init(&conductor, rank, argc, argv, error);
    if (!code)
        code = get_ready(rank, &conductor, error);
    if (!code)
        code = rank->number == 0 ? gw_conductor_run(&conductor, rank, error) : follow(rank, error);
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
    rank.load_deadline = gw_now_ns() + (int64_t)(rank.options.load_deadline * 1e9);
    code = start_mpi(&rank, &error);
    if (!code)
        code = run(&rank, argc, argv, &error);
    if (code && code != GW_TILES_LOST)
        gw_link_send(&rank.line, GW_LINK_FAILED, (int32_t)code, error.text);
    else
        gw_link_send(&rank.line, rank.number == 0 ? GW_LINK_RESULT : GW_LINK_LEFT, (int32_t)code, "");
    /* No MPI_Finalize: it is a collective, and would wait for a tile that was lost. The GL device and the
     * mappings end with the process. */
    fflush(NULL);
    _exit(code == GW_TILES_LOST ? 0 : (int)code);
}
