/* See renderer_internal.h: kernels made by a thread of their own, with a GL context that shares objects with
 * the renderer's. It draws a small picture of the frame that calls for them, by a renderer of its own that
 * borrows the scene on the GPU: so exactly the kernels that such frames need are compiled, and have run,
 * before the tile's own thread takes them over. What that small picture did not meet - a mirror that it
 * misses - is compiled at once when a frame meets it. */
#include "render/renderer_internal.h"

#include "base/clock.h"
#include "base/memory.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

enum { SMALL_SIDE = 32 /* px, of the picture that is drawn to warm up */ };

typedef enum background_stage { IDLE, ASKED, MADE, FAILED } background_stage;

struct gw_background {
    pthread_t thread;
    pthread_mutex_t access; /* to stage and stops; the job belongs to the thread while it is ASKED */
    pthread_cond_t changed;
    background_stage stage;
    int stops;
    gw_gl *device;        /* the thread's */
    gw_renderer *painter; /* draws the small picture; the scene's buffers are the renderer's */
    gw_similarity placement;
    gw_plane plane;
    gw_rectangle rectangle;
    gw_frame_state state;
    gw_hash hash; /* of the variant that is wanted */
    int64_t begin;
    gw_error error;
    /* The renderer's thread only. */
    uint32_t made, failed;
    int broken;                      /* no thread, or no second context: everything is made at once */
    gw_hash refused[GW_GL_VARIANTS]; /* that failed last: they are made at once, which tells why */
};

static gw_code draw_small(gw_background *b, gw_error *error) {
    static const gw_counters none;
    gw_counters counters = none;
    void *pixels = NULL;
    gw_code code =
        gw_allocate(&pixels, (size_t)b->rectangle.width * b->rectangle.height, 4, "a small picture", error);
    if (!code && !b->painter->totals.id)
        code = gw_renderer_make_own_buffers(b->painter, error);
    if (!code)
        code = gw_renderer_frame(b->painter, &b->placement, &b->plane, &b->rectangle, &b->state, pixels,
                                 &counters, error);
    if (!code)
        code = gw_gl_finish(b->device, error);
    free(pixels);
    if (!code && !gw_gl_variant_lives(b->device, b->hash))
        code = gw_fail(error, GW_MACHINE, "a small picture of the frame calls for other kernels");
    return code;
}

static background_stage wait_for_job(gw_background *b) {
    pthread_mutex_lock(&b->access);
    while (b->stage != ASKED && !b->stops)
        pthread_cond_wait(&b->changed, &b->access);
    const background_stage stage = b->stops ? IDLE : ASKED;
    pthread_mutex_unlock(&b->access);
    return stage;
}

static void *work(void *argument) {
    gw_background *b = argument;
    gw_error error = {0};
    const gw_code untaken = gw_gl_take(b->device, &error);
    while (wait_for_job(b) == ASKED) {
        const gw_code code = untaken ? untaken : draw_small(b, &error);
        pthread_mutex_lock(&b->access);
        b->error = error;
        b->stage = code ? FAILED : MADE;
        pthread_cond_broadcast(&b->changed);
        pthread_mutex_unlock(&b->access);
        if (!untaken)
            error = (gw_error){0};
    }
    if (!untaken)
        gw_gl_leave(b->device);
    return NULL;
}

/* Signals go to the threads that were there before. */
static gw_code start_thread(gw_background *b, gw_error *error) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int failed = pthread_create(&b->thread, NULL, work, b);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed)
        return gw_fail(error, GW_MACHINE, "no thread: %s", strerror(failed));
    pthread_setname_np(b->thread, "gw-kernels");
    return GW_OK;
}

static gw_code start(gw_renderer *renderer, gw_error *error) {
    void *memory = NULL, *painter = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_background), "background kernels", error);
    if (code)
        return code;
    gw_background *b = renderer->background = memory;
    pthread_mutex_init(&b->access, NULL);
    pthread_cond_init(&b->changed, NULL);
    code = gw_allocate(&painter, 1, sizeof(gw_renderer), "background kernels", error);
    b->painter = painter;
    if (!code)
        code = gw_gl_create_shared(renderer->device, &b->device, error);
    if (!code)
        code = start_thread(b, error);
    b->broken = code != GW_OK;
    return code;
}

/* All but its own buffers and what it keeps from picture to picture. */
static void lend_scene(const gw_renderer *from, gw_background *b) {
    gw_renderer *to = b->painter;
    to->device = b->device;
    to->scene = from->scene;
    to->octree = from->octree;
    to->time = from->time;
    to->count = from->count;
    to->one_kernel = from->one_kernel;
    to->loop_budget = from->loop_budget;
    to->scene_features = from->scene_features;
    to->mirror_roughness = from->mirror_roughness;
    to->glossy_roughness = from->glossy_roughness;
    to->light_knobs = from->light_knobs;
    to->forced_features = from->forced_features;
    to->forbidden_features = from->forbidden_features;
    to->buffers = from->buffers;
    to->media = from->media;
    to->kernels = GW_KERNELS_AT_ONCE;
}

static int32_t floor_divided(int32_t value, int32_t by) {
    return value >= 0 ? value / by : -((-value + by - 1) / by);
}

/* The same view with larger pixels; of a still view one sample. */
static void take_job(gw_background *b, const gw_frame_job *job, const gw_similarity *placement,
                     const gw_plane *plane) {
    const gw_rectangle *r = job->rectangle;
    const uint32_t side = r->width > r->height ? r->width : r->height;
    const int32_t by = (int32_t)((side + SMALL_SIDE - 1) / SMALL_SIDE);
    b->placement = *placement;
    b->plane = *plane;
    for (int i = 0; i < 3; ++i) {
        b->plane.step_x[i] *= by;
        b->plane.step_y[i] *= by;
    }
    b->rectangle = (gw_rectangle){floor_divided(r->x, by), floor_divided(r->y, by),
                                  (r->width + (uint32_t)by - 1) / (uint32_t)by,
                                  (r->height + (uint32_t)by - 1) / (uint32_t)by};
    b->state = *job->state;
    if (b->state.accumulate > 1) {
        b->state.accumulate = 1;
        b->state.epoch = b->state.epoch > 0 ? b->state.epoch : 1;
    }
    b->begin = gw_now_ns();
}

static int is_refused(const gw_background *b, gw_hash hash) {
    for (size_t i = 0; i < GW_GL_VARIANTS; ++i)
        if (gw_hash_equal(b->refused[i], hash))
            return 1;
    return 0;
}

int gw_background_make(const gw_frame_job *job, const gw_similarity *placement, const gw_plane *plane,
                       gw_hash hash) {
    gw_renderer *renderer = job->renderer;
    gw_error error = {0};
    if (!renderer->background && start(renderer, &error))
        gw_log_write(renderer->log, GW_LOG_WARNING, "kernels are made at once, not in the background: %s",
                     error.text);
    gw_background *b = renderer->background;
    if (!b || b->broken || is_refused(b, hash))
        return 0;
    pthread_mutex_lock(&b->access);
    if (b->stage == IDLE) {
        lend_scene(renderer, b);
        take_job(b, job, placement, plane);
        b->hash = hash;
        b->stage = ASKED;
        pthread_cond_broadcast(&b->changed);
    }
    pthread_mutex_unlock(&b->access);
    return 1;
}

static gw_code adopt(gw_renderer *renderer, gw_background *b, gw_error *error) {
    gw_code code = gw_gl_variant_adopt(renderer->device, b->device, b->hash, error);
    b->made += code == GW_OK;
    if (!code)
        gw_log_write(renderer->log, GW_LOG_DEBUG,
                     "kernels for a frame's effects made in the background: %.1f s",
                     (double)(gw_now_ns() - b->begin) * 1e-9);
    return code;
}

gw_code gw_background_take(gw_renderer *renderer, gw_error *error) {
    gw_background *b = renderer->background;
    gw_code code = GW_OK;
    if (!b || b->broken)
        return GW_OK;
    pthread_mutex_lock(&b->access);
    if (b->stage == MADE)
        code = adopt(renderer, b, error);
    if (b->stage == FAILED) {
        b->refused[b->failed++ % GW_GL_VARIANTS] = b->hash;
        gw_log_write(renderer->log, GW_LOG_WARNING, "kernels were not made in the background: %s",
                     b->error.text);
    }
    if (b->stage != ASKED)
        b->stage = IDLE;
    pthread_mutex_unlock(&b->access);
    return code;
}

void gw_background_wait(gw_background *b) {
    if (!b || b->broken)
        return;
    pthread_mutex_lock(&b->access);
    while (b->stage == ASKED)
        pthread_cond_wait(&b->changed, &b->access);
    pthread_mutex_unlock(&b->access);
}

void gw_background_stop(gw_background **background) {
    gw_background *b = *background;
    if (!b)
        return;
    if (!b->broken) {
        gw_gl_stop_compiling(b->device); /* what the driver is at, it ends */
        pthread_mutex_lock(&b->access);
        b->stops = 1;
        pthread_cond_broadcast(&b->changed);
        pthread_mutex_unlock(&b->access);
        pthread_join(b->thread, NULL);
    }
    if (b->painter) {
        gw_renderer_finish_buffers(b->painter);
        free(b->painter->host_pixels);
        free(b->painter);
    }
    gw_gl_destroy(&b->device);
    pthread_cond_destroy(&b->changed);
    pthread_mutex_destroy(&b->access);
    free(b);
    *background = NULL;
}

int gw_renderer_makes_kernels(const gw_renderer *renderer) {
    uint32_t made, failed;
    int busy;
    gw_background_count(renderer->background, &made, &failed, &busy);
    return busy;
}

void gw_background_count(gw_background *b, uint32_t *made, uint32_t *failed, int *busy) {
    *made = *failed = 0;
    *busy = 0;
    if (!b)
        return;
    pthread_mutex_lock(&b->access);
    *made = b->made;
    *failed = b->failed;
    *busy = b->stage == ASKED;
    pthread_mutex_unlock(&b->access);
}
