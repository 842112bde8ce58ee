/* Frames: a rectangle is cut into chunks of whole blocks; each chunk is traced and shaded, then rays that
 * were suspended go on until none is left. Chunks change nothing in the pixels, they bound the length of a
 * dispatch and the buffers. */
#include "render/renderer_internal.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "render/frame_block.h"

#include <math.h>
#include <string.h>

static int64_t block_of(int64_t pixel) {
    return pixel >= 0 ? pixel / GW_BLOCK_SIDE : -((-pixel + GW_BLOCK_SIDE - 1) / GW_BLOCK_SIDE);
}

/* Copies the chunk's pixels that lie in the rectangle. */
static void place_pixels(const gw_frame_job *job) {
    const int32_t *chunk = job->block.chunk, *window = job->block.window;
    const int32_t wide = chunk[2] * GW_BLOCK_SIDE, high = chunk[3] / chunk[2] * GW_BLOCK_SIDE;
    const int32_t first = chunk[0] > window[0] ? chunk[0] : window[0];
    const int32_t end = chunk[0] + wide < window[2] ? chunk[0] + wide : window[2];
    for (int32_t y = 0; y < high && first < end; ++y) {
        const int32_t row = chunk[1] + y - window[1];
        if (row < 0 || chunk[1] + y >= window[3])
            continue;
        const uint8_t *from =
            job->renderer->host_pixels + 4 * ((size_t)y * (size_t)wide + (size_t)(first - chunk[0]));
        memcpy(job->rgba + 4 * ((size_t)row * job->rectangle->width + (size_t)(first - window[0])), from,
               4 * (size_t)(end - first));
    }
}

/* Pixels of the chunk that lie in the rectangle. */
static uint64_t pixels_of_chunk(const gw_frame_job *job) {
    const int32_t *chunk = job->block.chunk, *window = job->block.window;
    int64_t size[2] = {(int64_t)chunk[2] * GW_BLOCK_SIDE, (int64_t)(chunk[3] / chunk[2]) * GW_BLOCK_SIDE};
    uint64_t pixels = 1;
    for (int i = 0; i < 2; ++i) {
        int64_t first = chunk[i] > window[i] ? chunk[i] : window[i];
        int64_t end = chunk[i] + size[i] < window[2 + i] ? chunk[i] + size[i] : window[2 + i];
        pixels *= end > first ? (uint64_t)(end - first) : 0;
    }
    return pixels;
}

gw_code gw_frame_batch(gw_frame_job *job, size_t slots, gw_error *error) {
    uint32_t totals[GW_TOTAL_WORDS] = {0};
    gw_code code = gw_renderer_clear_totals(job->renderer, error);
    if (!code)
        code = gw_frame_kernels(job, 0, error);
    if (!code)
        code = gw_frame_round(job, slots, 0, 0, error);
    if (!code)
        code = gw_renderer_read_totals(job->renderer, totals, error);
    job->counters.step_cap_hits += totals[0];
    job->counters.nan_pixels += totals[1];
    if (!code && totals[2] > 0)
        code = gw_frame_resume(job, totals[2], error);
    return code;
}

/* A ray for each pixel. */
static gw_code render_pixels(gw_frame_job *job, size_t slots, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    job->counters.rays += pixels_of_chunk(job);
    gw_code code =
        gw_renderer_reserve(renderer, slots, gw_kernel_fragments(&job->key), job->key.count, error);
    if (!code)
        code = gw_frame_batch(job, slots, error);
    if (!code && job->key.count)
        code = gw_ray_buffers_add_work(&renderer->rays, slots, &job->counters, error);
    return code;
}

static gw_code take_pixels(const gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_code code = gw_grow((void **)&renderer->host_pixels, &renderer->host_pixel_capacity, pixel_slots * 4,
                           1, "pixels", error);
    if (!code)
        code = gw_gl_buffer_read(gw_frame_pixels(job), 0, pixel_slots * sizeof(uint32_t),
                                 renderer->host_pixels, error);
    if (!code)
        place_pixels(job);
    return code;
}

static gw_code render_chunk(gw_frame_job *job, size_t block_count, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    const int sparse = (job->key.features & GW_FEATURE_SPARSE) != 0;
    size_t pixel_slots = block_count * GW_BLOCK_PIXELS;
    gw_code code = sparse ? gw_frame_list_samples(job, error) : GW_OK;
    if (!code && (job->key.features & GW_FEATURE_ACCUMULATE))
        code = gw_accumulation_bind(renderer, job->chunk, pixel_slots, error);
    for (uint32_t i = job->first_sample; !code && i < job->end_sample; ++i) {
        gw_frame_block_set_sample(job->state, i, &job->block);
        job->block.tone[3] = i + 1 == job->end_sample ? 1.0f : 0.0f; /* light is that of what is shown */
        code = gw_gl_buffer_write(&renderer->frame, 0, sizeof job->block, &job->block, error);
        if (!code)
            code =
                sparse ? gw_frame_samples(job, pixel_slots, error) : render_pixels(job, pixel_slots, error);
    }
    return code ? code : take_pixels(job, pixel_slots, error);
}

/* What is kept of a still view, with another exposure, curve or dither. */
static gw_code show_kept_chunk(gw_frame_job *job, size_t block_count, gw_error *error) {
    const size_t pixel_slots = block_count * GW_BLOCK_PIXELS;
    gw_code code = gw_frame_kept_pixels(job, pixel_slots, error);
    return code ? code : take_pixels(job, pixel_slots, error);
}

typedef gw_code (*gw_chunk_visit)(gw_frame_job *job, size_t block_count, gw_error *error);

/* Chunks are bands of block rows; a band too wide for one chunk is cut into columns as well. */
static gw_code visit_chunks(gw_frame_job *job, gw_chunk_visit visit, gw_error *error) {
    const gw_rectangle *r = job->rectangle;
    const int sparse = (job->key.features & GW_FEATURE_SPARSE) != 0;
    int64_t first_x = block_of(r->x), end_x = block_of((int64_t)r->x + r->width - 1) + 1;
    int64_t first_y = block_of(r->y), end_y = block_of((int64_t)r->y + r->height - 1) + 1;
    int64_t limit = (int64_t)(sparse ? GW_MOST_SAMPLES / gw_most_rays_of_pixel(&job->block)
                                     : gw_renderer_chunk_slots(job->renderer)) /
                    GW_BLOCK_PIXELS;
    int64_t most_side = sparse ? GW_MOST_SPARSE_SIDE : limit;
    int64_t columns = end_x - first_x < most_side ? end_x - first_x : most_side;
    int64_t rows = limit / columns < most_side ? limit / columns : most_side;
    gw_code code = GW_OK;
    for (int64_t y = first_y; y < end_y && !code; y += rows)
        for (int64_t x = first_x; x < end_x && !code; x += columns) {
            int64_t wide = end_x - x < columns ? end_x - x : columns;
            int64_t high = end_y - y < rows ? end_y - y : rows;
            job->block.chunk[0] = (int32_t)(x * GW_BLOCK_SIDE);
            job->block.chunk[1] = (int32_t)(y * GW_BLOCK_SIDE);
            job->block.chunk[2] = (int32_t)wide;
            job->block.chunk[3] = (int32_t)(wide * high);
            code = visit(job, (size_t)(wide * high), error);
            job->chunk++;
        }
    return code;
}

/* A scene that moves is put where it is at the frame's time. */
static gw_code move_scene(gw_renderer *renderer, int64_t time, gw_error *error) {
    if (!renderer->moving || renderer->time == time)
        return GW_OK;
    gw_code code = gw_moving_to(renderer->moving, time, &renderer->scene, &renderer->octree, error);
    if (!code)
        code = gw_scene_buffers_move(renderer->device, renderer->scene, renderer->octree, &renderer->buffers,
                                     error);
    if (code)
        return gw_context(error, "moving the scene to %.3f s", (double)time * 1e-9);
    renderer->time = time;
    code = gw_media_take(renderer->scene, &renderer->media, error);
    return code ? code : gw_renderer_take_features(renderer, error);
}

/* Lights stand as the frame's state wants them. */
static gw_code light_scene(gw_renderer *renderer, const gw_frame_state *state, gw_error *error) {
    const gw_light_knobs knobs = gw_renderer_light_knobs(renderer, state);
    if (memcmp(&knobs, &renderer->light_knobs, sizeof knobs) == 0)
        return GW_OK;
    gw_background_wait(renderer->background);
    gw_code code =
        gw_scene_buffers_light(renderer->device, renderer->still, &knobs, &renderer->buffers, error);
    if (code)
        return gw_context(error, "the scene's lights");
    renderer->light_knobs = knobs;
    return gw_renderer_take_features(renderer, error);
}

/* Everything about the frame but its chunks. */
static gw_code begin_frame(gw_frame_job *job, const gw_similarity *placement, const gw_plane *plane,
                           const gw_frame_state *state, gw_error *error) {
    const int64_t furthest = 1 << 24; /* pixel centres are exact in float below this */
    const gw_rectangle *rectangle = job->rectangle;
    gw_renderer *renderer = job->renderer;
    if (rectangle->width == 0 || rectangle->height == 0 || rectangle->x < -furthest ||
        rectangle->y < -furthest || (int64_t)rectangle->x + rectangle->width > furthest ||
        (int64_t)rectangle->y + rectangle->height > furthest)
        return gw_fail(
            error, GW_BAD_INPUT,
            "a rectangle of %u x %u pixels at (%d, %d) cannot be rendered; sides must be at least 1 and "
            "coordinates within 2^24",
            rectangle->width, rectangle->height, rectangle->x, rectangle->y);
    uint32_t dropped = 0;
    gw_code code = move_scene(renderer, state->time, error);
    if (!code)
        code = light_scene(renderer, state, error);
    const float glossy = (float)state->glossy_roughness * (1.0f / 255.0f);
    if (!code &&
        (renderer->mirror_roughness != state->mirror_roughness || renderer->glossy_roughness != glossy)) {
        renderer->mirror_roughness = state->mirror_roughness;
        renderer->glossy_roughness = glossy;
        code = gw_renderer_take_features(renderer, error);
    }
    if (!code)
        code = gw_frame_block_fill(renderer->scene, renderer->octree, placement, plane, state, &job->block,
                                   &dropped, error);
    if (code)
        return code;
    if (dropped > 0)
        gw_log_write(renderer->log, GW_LOG_WARNING,
                     "frame %u: %u of %u gazes cannot be used and are left out", state->frame, dropped,
                     state->gaze_count);
    const gw_environment_textures *environment = &renderer->buffers.environment;
    job->block.environment[0] = environment->rotation;
    job->block.environment[1] = (float)(environment->height / GW_PI);
    job->block.environment[2] = environment->seen ? 1.0f : 0.0f;
    job->block.environment[3] = renderer->scene_features & GW_FEATURE_GLOSSY ? glossy : 0.0f;
    memcpy(job->block.environment_mean, environment->mean, sizeof environment->mean);
    job->block.environment_mean[3] =
        renderer->buffers.list.emissive > 0 ? fmaxf(state->emissive_faintest, 1e-30f) : 0.0f;
    job->block.counts[1] = renderer->buffers.list.directional;
    job->block.counts[2] = renderer->buffers.list.placed;
    job->block.window[0] = rectangle->x;
    job->block.window[1] = rectangle->y;
    job->block.window[2] = rectangle->x + (int32_t)rectangle->width;
    job->block.window[3] = rectangle->y + (int32_t)rectangle->height;
    const double eye[3] = {(double)job->block.eye[0], (double)job->block.eye[1], (double)job->block.eye[2]};
    gw_media_at(&renderer->media, eye, job->block.media);
    job->key = gw_frame_key(renderer, state, job->block.counts[0], 0);
    job->bounces = state->bounces < GW_MOST_BOUNCES ? state->bounces : GW_MOST_BOUNCES;
    return GW_OK;
}

static uint32_t samples_of(const gw_frame_state *state) {
    return state->accumulate > 0 ? state->accumulate : 1;
}

/* Chunks drawn, and their light counted if the frame wants that. */
static gw_code draw_chunks(gw_frame_job *job, gw_luminance *luminance, gw_error *error) {
    const int meters = (job->key.features & GW_FEATURE_METERING) != 0;
    gw_code code = meters ? gw_frame_meter(job->renderer, error) : GW_OK;
    if (!code)
        code = visit_chunks(job, render_chunk, error);
    return !code && meters ? gw_frame_read_meter(job->renderer, luminance, error) : code;
}

static int is_toned_alike(const gw_frame_state *a, const gw_frame_state *b) {
    return a->exposure == b->exposure && a->tone == b->tone && a->dither == b->dither;
}

/* The samples that the view lacks, added to those that are kept of it. */
static gw_code accumulate(gw_frame_job *job, const gw_similarity *placement, const gw_plane *plane,
                          gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_accumulation *kept = &renderer->accumulation;
    const size_t bytes = (size_t)job->rectangle->width * job->rectangle->height * 4;
    gw_accumulation_view view;
    memset(&view, 0, sizeof view);
    view.state = gw_frame_state_view(job->state, renderer->moving != NULL);
    view.placement = *placement;
    view.plane = *plane;
    view.rectangle = *job->rectangle;
    gw_code code = gw_accumulation_begin(kept, &view, job->end_sample, error);
    if (code)
        return code;
    const int meters = job->state->metering != 0;
    if (meters && !kept->metered)
        kept->samples = 0;
    job->first_sample = kept->samples;
    const int lacks = job->first_sample < job->end_sample;
    if (lacks) {
        kept->samples = 0; /* until all chunks have the new ones */
        code = draw_chunks(job, &kept->luminance, error);
        kept->metered = meters;
    } else if (!is_toned_alike(&kept->toned, job->state)) {
        code = visit_chunks(job, show_kept_chunk, error);
    } else {
        memcpy(job->rgba, kept->rgba, bytes);
    }
    if (code) {
        kept->samples = 0;
        return code;
    }
    kept->samples = job->end_sample;
    kept->toned = *job->state;
    memcpy(kept->rgba, job->rgba, bytes);
    if (meters)
        gw_luminance_add(&job->renderer->luminance, &kept->luminance);
    return GW_OK;
}

/* Without accumulation. */
static gw_code draw_once(gw_frame_job *job, gw_error *error) {
    gw_luminance luminance = {{0}};
    gw_code code = draw_chunks(job, &luminance, error);
    if (!code && job->state->metering)
        gw_luminance_add(&job->renderer->luminance, &luminance);
    return code;
}

/* Before and after a frame that checks what it reads. */
static gw_code begin_checks(gw_renderer *renderer, gw_error *error) {
    uint32_t words[GW_RANGE_WORDS] = {0};
    memset(words + 1, 0xff, sizeof words - sizeof *words);
    gw_code code = gw_renderer_grow(renderer, &renderer->out_of_range, "out of range", sizeof words, error);
    if (!code)
        code = gw_gl_buffer_write(&renderer->out_of_range, 0, sizeof words, words, error);
    if (!code)
        gw_gl_buffer_bind(&renderer->out_of_range, GW_BINDING_OUT_OF_RANGE);
    return code;
}

static gw_code end_checks(gw_renderer *renderer, gw_error *error) {
    static const char *const names[] = {"node", "reference", "triangle", "payload", "box"};
    uint32_t words[GW_RANGE_WORDS];
    gw_code code = gw_gl_buffer_read(&renderer->out_of_range, 0, sizeof words, words, error);
    for (int i = 1; !code && words[0] && i < GW_RANGE_WORDS; ++i)
        if (words[i] != UINT32_MAX)
            code =
                gw_fail(error, GW_MACHINE,
                        "%u reads out of range, the first of %s %u: the octree on the GPU is damaged, or a "
                        "kernel is wrong",
                        words[0], names[i - 1], words[i]);
    return code;
}

gw_code gw_renderer_frame(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                          const gw_rectangle *rectangle, const gw_frame_state *given, uint8_t *rgba,
                          gw_counters *counters, gw_error *error) {
    const gw_frame_state drawn = gw_frame_state_in_force(given), *state = &drawn;
    gw_frame_job job = {.renderer = renderer,
                        .rays = &renderer->rays,
                        .shadows = &renderer->shadows,
                        .rectangle = rectangle,
                        .state = state,
                        .end_sample = samples_of(state),
                        .rgba = rgba};
    gw_code code = begin_frame(&job, placement, plane, state, error);
    if (code)
        return code;
    renderer->has_drawn = 1;
    renderer->loop_iterations = 0;
    renderer->last_features = gw_frame_calls_for(renderer, state, job.block.counts[0]);
    gw_scene_buffers_bind(&renderer->buffers, state->texture_filter);
    code = gw_frame_choose_kernels(&job, placement, plane, error);
    if (!code)
        code = gw_effects_begin(&job, error);
    if (!code && job.key.check_fetches)
        code = begin_checks(renderer, error);
    if (!code)
        code = job.key.features & GW_FEATURE_ACCUMULATE ? accumulate(&job, placement, plane, error)
                                                        : draw_once(&job, error);
    gw_gl_variant_end(renderer->device);
    if (!code)
        code = gw_effects_end(&job, error);
    if (!code && job.key.check_fetches)
        code = end_checks(renderer, error);
    if (code)
        return gw_context(error, "frame %u", state->frame);
    job.counters.loop_iterations = renderer->loop_iterations;
    if (counters)
        gw_counters_add(counters, &job.counters);
    return GW_OK;
}

/* One ray through the middle of every pixel, with the footprint and the tau that the frame has there, and of
 * the features only those that decide what is met. */
gw_code gw_renderer_geometry(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                             const gw_rectangle *rectangle, const gw_frame_state *given,
                             const gw_geometry *out, gw_error *error) {
    gw_frame_state state = gw_frame_state_in_force(given);
    state.sample_block = state.samples = state.bounces = state.cones = state.diffuse_bounce = 0;
    state.accumulate = 0;
    state.epoch = 0;
    state.debug = GW_DEBUG_NONE;
    gw_frame_job job = {.renderer = renderer,
                        .rays = &renderer->rays,
                        .shadows = &renderer->shadows,
                        .rectangle = rectangle,
                        .state = &state,
                        .geometry = out,
                        .unit = ldexp(placement->scale, renderer->scene->exponent)};
    gw_code code = begin_frame(&job, placement, plane, &state, error);
    if (code)
        return code;
    job.key.features &= GW_GEOMETRY_FEATURES;
    job.key.data_classes = 0;
    job.key.count = job.key.voxel_emission = 0;
    job.key.guides = 1;
    gw_scene_buffers_bind(&renderer->buffers, state.texture_filter);
    code = gw_frame_own_kernels(&job, error);
    if (!code)
        code = visit_chunks(&job, gw_frame_geometry, error);
    gw_gl_variant_end(renderer->device);
    return code ? gw_context(error, "geometry of frame %u", state.frame) : GW_OK;
}

gw_code gw_renderer_count_rays(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                               const gw_rectangle *rectangle, const gw_frame_state *given, uint64_t *rays,
                               gw_error *error) {
    const gw_frame_state drawn = gw_frame_state_in_force(given), *state = &drawn;
    gw_frame_job job = {
        .renderer = renderer, .rays = &renderer->rays, .rectangle = rectangle, .state = state};
    gw_code code = begin_frame(&job, placement, plane, state, error);
    if (!code && (job.key.features & GW_FEATURE_SPARSE))
        code = visit_chunks(&job, gw_frame_count_samples, error);
    else if (!code)
        job.counters.rays = (uint64_t)rectangle->width * rectangle->height;
    if (!code)
        *rays += job.counters.rays * samples_of(state);
    return code;
}
