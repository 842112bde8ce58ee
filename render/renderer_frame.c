/* Frames: a rectangle is cut into chunks of whole blocks; each chunk is traced and shaded, then rays that
 * were suspended go on until none is left. Chunks change nothing in the pixels, they bound the length of a
 * dispatch and the buffers. */
#include "render/renderer_internal.h"

#include "base/memory.h"
#include "render/frame_block.h"

#include <string.h>

/* A frame under way. */
typedef struct frame_job {
    gw_renderer *renderer;
    gw_kernel_key key;
    gw_frame_block block;
    GLuint trace, shade;
    int may_be_sparse;     /* the frame calls for sparse samples; each chunk decides for itself */
    uint32_t sample_block; /* log2 of the side of the largest sample block */
    const gw_rectangle *rectangle;
    uint8_t *rgba;
    gw_counters counters;
} frame_job;

static int64_t block_of(int64_t pixel) {
    return pixel >= 0 ? pixel / GW_BLOCK_SIDE : -((-pixel + GW_BLOCK_SIDE - 1) / GW_BLOCK_SIDE);
}

static gw_kernel_key key_of(const gw_renderer *renderer, const gw_frame_state *state, uint32_t viewers) {
    uint32_t features = renderer->scene_features | renderer->forced_features |
                        gw_features_of_frame(state, viewers, renderer->scene_features);
    int lod = (features & GW_FEATURE_LOD) != 0;
    return (gw_kernel_key){.features = features,
                           .depth = renderer->octree->depth,
                           .texture_classes = renderer->buffers.textures.class_count,
                           .loop_budget = renderer->loop_budget,
                           .debug = state->debug,
                           .voxels_only = lod && state->geometry == GW_GEOMETRY_VOXELS,
                           .level_blend = lod && state->level_blend,
                           .leaf_blend = lod && state->leaf_blend,
                           .voxel_emission = lod && renderer->octree->emissions != NULL,
                           .double_edges = state->triangle_precision == GW_PRECISION_DOUBLE,
                           .count = renderer->count || state->debug == GW_DEBUG_STEPS};
}

/* Tracing knows nothing of what only shading needs, and the other way round, so that kernels are shared. */
static gw_code kernels_of(frame_job *job, int resume, gw_error *error) {
    const uint32_t walk_features = GW_FEATURE_WIDE_NODES | GW_FEATURE_DENSE_LEAVES;
    const uint32_t trace_features =
        GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_ALPHA | GW_FEATURE_SPARSE | walk_features;
    gw_kernel_key trace = job->key, shade = job->key;
    trace.features &= trace_features;
    trace.texture_classes = 0;
    trace.voxel_emission = 0;
    trace.debug = GW_DEBUG_NONE;
    trace.resume = shade.resume = resume;
    shade.features &= ~walk_features;
    shade.loop_budget = 0;
    shade.voxels_only = shade.level_blend = shade.leaf_blend = shade.double_edges = 0;
    gw_code code = gw_renderer_kernel(job->renderer, "trace/primary.comp", &trace, NULL, &job->trace, error);
    if (!code)
        code = gw_renderer_kernel(job->renderer, "shade/shade.comp", &shade, NULL, &job->shade, error);
    if (!code && (job->key.features & GW_FEATURE_TEXTURES) && job->key.texture_classes > 0) {
        const uint32_t *side = job->renderer->buffers.textures.side;
        glProgramUniform4f(job->shade, 1, (float)side[0], (float)side[1], (float)side[2], (float)side[3]);
    }
    return code;
}

static gw_code dispatch_both(frame_job *job, size_t slots, gw_error *error) {
    uint64_t groups = (slots + GW_BLOCK_PIXELS - 1) / GW_BLOCK_PIXELS;
    gw_code code = gw_gl_dispatch(job->renderer->device, job->trace, groups, error);
    if (!code)
        code = gw_gl_dispatch(job->renderer->device, job->shade, groups, error);
    return code;
}

/* One round after another over the suspended rays. Each round takes every ray further, so it ends. */
static gw_code resume_rays(frame_job *job, uint32_t queue_length, gw_error *error) {
    gw_ray_buffers *rays = &job->renderer->rays;
    gw_code code = kernels_of(job, 1, error);
    for (int from = 1; !code && queue_length > 0; from = 1 - from) {
        uint32_t totals[4];
        job->counters.resumed += queue_length;
        gw_gl_buffer_bind(&rays->queues[from], GW_BINDING_QUEUE);
        gw_gl_buffer_bind(&rays->queues[1 - from], GW_BINDING_NEXT_QUEUE);
        glProgramUniform1ui(job->trace, 0, queue_length);
        glProgramUniform1ui(job->shade, 0, queue_length);
        code = gw_renderer_clear_totals(job->renderer, error);
        if (!code)
            code = dispatch_both(job, queue_length, error);
        if (!code)
            code = gw_renderer_read_totals(job->renderer, totals, error);
        if (!code) {
            job->counters.step_cap_hits += totals[0];
            job->counters.nan_pixels += totals[1];
            queue_length = totals[2];
        }
    }
    return code;
}

/* Copies the chunk's pixels that lie in the rectangle; slots are in Morton order within blocks. */
static void place_pixels(const frame_job *job, size_t block_count) {
    const gw_rectangle *r = job->rectangle;
    for (size_t slot = 0; slot < block_count * GW_BLOCK_PIXELS; ++slot) {
        size_t block = slot / GW_BLOCK_PIXELS, lane = slot % GW_BLOCK_PIXELS;
        size_t per_row = (size_t)job->block.chunk[2];
        int64_t x = job->block.chunk[0] + (int64_t)(block % per_row) * GW_BLOCK_SIDE - r->x +
                    (int64_t)((lane & 1) | (lane >> 1 & 2) | (lane >> 2 & 4));
        int64_t y = job->block.chunk[1] + (int64_t)(block / per_row) * GW_BLOCK_SIDE - r->y +
                    (int64_t)((lane >> 1 & 1) | (lane >> 2 & 2) | (lane >> 3 & 4));
        if (x < 0 || y < 0 || x >= r->width || y >= r->height)
            continue;
        uint32_t pixel = job->renderer->host_pixels[slot];
        uint8_t *out = job->rgba + ((size_t)y * r->width + (size_t)x) * 4;
        for (int c = 0; c < 4; ++c)
            out[c] = (uint8_t)(pixel >> (8 * c));
    }
}

/* Replaces a buffer's contents; the buffer only grows. */
static gw_code refill(gw_renderer *renderer, gw_gl_buffer *buffer, const char *name, const uint32_t *words,
                      size_t count, GLuint binding, gw_error *error) {
    size_t bytes = count * sizeof *words;
    gw_code code = GW_OK;
    if (bytes > buffer->size) {
        gw_gl_buffer_finish(buffer);
        code = gw_gl_buffer_create(renderer->device, name, bytes, NULL, 0, buffer, error);
    }
    if (!code)
        code = gw_gl_buffer_write(buffer, 0, bytes, words, error);
    if (!code)
        gw_gl_buffer_bind(buffer, binding);
    return code;
}

/* Lists the chunk's samples and puts them on the GPU. A chunk that has a ray for each of its pixels needs
 * neither list nor rim: it is rendered as in a frame without sparse samples, with the same bits. */
static gw_code list_samples(frame_job *job, size_t block_count, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_sparse *sparse = &renderer->sparse;
    const int32_t *chunk = job->block.chunk;
    gw_code code = gw_sparse_list(sparse, &job->block, chunk[0] / GW_BLOCK_SIDE, chunk[1] / GW_BLOCK_SIDE,
                                  chunk[2], (int32_t)block_count / chunk[2], job->sample_block, error);
    job->key.features &= ~(uint32_t)GW_FEATURE_SPARSE;
    if (code || (sparse->coarse_blocks == 0 && job->block.counts[3] == 1 &&
                 !(renderer->forced_features & GW_FEATURE_SPARSE)))
        return code;
    job->key.features |= GW_FEATURE_SPARSE;
    code = refill(renderer, &renderer->samples, "samples", sparse->samples, sparse->sample_count,
                  GW_BINDING_SAMPLES, error);
    if (!code)
        code = refill(renderer, &renderer->blocks, "sample blocks", sparse->blocks, sparse->block_count,
                      GW_BINDING_BLOCKS, error);
    return code;
}

static gw_code reconstruct(frame_job *job, size_t pixel_slots, gw_error *error) {
    GLuint program;
    gw_code code = gw_gl_program(job->renderer->device, "blend/reconstruct.comp", NULL, &program, error);
    if (code)
        return code;
    glProgramUniform1ui(program, 0, (GLuint)pixel_slots);
    return gw_gl_dispatch(job->renderer->device, program,
                          (pixel_slots + GW_BLOCK_PIXELS - 1) / GW_BLOCK_PIXELS, error);
}

/* Pixels of the chunk that lie in the rectangle. */
static uint64_t pixels_of_chunk(const frame_job *job) {
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

static gw_code render_chunk(frame_job *job, size_t block_count, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    int sparse = 0;
    size_t pixel_slots = block_count * GW_BLOCK_PIXELS, slots = pixel_slots;
    uint32_t totals[4] = {0};
    job->block.chunk[3] = (int32_t)block_count;
    gw_code code = gw_gl_buffer_write(&renderer->frame, 0, sizeof job->block, &job->block, error);
    if (!code && job->may_be_sparse) {
        code = list_samples(job, block_count, error);
        sparse = (job->key.features & GW_FEATURE_SPARSE) != 0;
        slots = sparse ? renderer->sparse.sample_count : pixel_slots;
    }
    job->counters.rays += sparse ? renderer->sparse.real_samples : pixels_of_chunk(job);
    if (!code)
        code = gw_renderer_clear_totals(renderer, error);
    if (!code)
        code = gw_renderer_reserve(renderer, slots > pixel_slots ? slots : pixel_slots,
                                   gw_kernel_fragments(&job->key), job->key.count, error);
    if (!code)
        code = kernels_of(job, 0, error);
    if (!code)
        code = dispatch_both(job, slots, error);
    if (!code)
        code = gw_renderer_read_totals(renderer, totals, error);
    job->counters.step_cap_hits += totals[0];
    job->counters.nan_pixels += totals[1];
    if (!code && totals[2] > 0)
        code = resume_rays(job, totals[2], error);
    if (!code && sparse)
        code = reconstruct(job, pixel_slots, error);
    if (!code)
        code = gw_grow((void **)&renderer->host_pixels, &renderer->host_pixel_capacity, pixel_slots,
                       sizeof(uint32_t), "pixels", error);
    if (!code)
        code = gw_gl_buffer_read(&renderer->rays.pixels, 0, pixel_slots * sizeof(uint32_t),
                                 renderer->host_pixels, error);
    if (!code)
        place_pixels(job, block_count);
    if (!code && job->key.count)
        code = gw_renderer_add_work(renderer, slots, &job->counters, error);
    return code;
}

/* Chunks are bands of block rows; a band too wide for one chunk is cut into columns as well. */
static gw_code render_chunks(frame_job *job, gw_error *error) {
    const gw_rectangle *r = job->rectangle;
    int64_t first_x = block_of(r->x), end_x = block_of((int64_t)r->x + r->width - 1) + 1;
    int64_t first_y = block_of(r->y), end_y = block_of((int64_t)r->y + r->height - 1) + 1;
    int64_t limit = (int64_t)(gw_renderer_chunk_slots(job->renderer) / GW_BLOCK_PIXELS);
    int64_t most_columns = limit;
    if (job->may_be_sparse) {
        limit = limit * GW_SPARSE_CHUNK / job->block.counts[3];
        most_columns = limit < GW_SPARSE_SIDE ? limit : GW_SPARSE_SIDE;
    }
    int64_t columns = end_x - first_x < most_columns ? end_x - first_x : most_columns;
    int64_t rows = limit / columns;
    if (job->may_be_sparse && rows > GW_SPARSE_SIDE)
        rows = GW_SPARSE_SIDE;
    gw_code code = GW_OK;
    for (int64_t y = first_y; y < end_y && !code; y += rows)
        for (int64_t x = first_x; x < end_x && !code; x += columns) {
            int64_t wide = end_x - x < columns ? end_x - x : columns;
            int64_t high = end_y - y < rows ? end_y - y : rows;
            job->block.chunk[0] = (int32_t)(x * GW_BLOCK_SIDE);
            job->block.chunk[1] = (int32_t)(y * GW_BLOCK_SIDE);
            job->block.chunk[2] = (int32_t)wide;
            code = render_chunk(job, (size_t)(wide * high), error);
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
    renderer->scene_features = gw_features_of_scene(renderer->scene, renderer->octree);
    return GW_OK;
}

gw_code gw_renderer_frame(gw_renderer *renderer, const gw_similarity *placement, const gw_plane *plane,
                          const gw_rectangle *rectangle, const gw_frame_state *state, uint8_t *rgba,
                          gw_counters *counters, gw_error *error) {
    const int64_t furthest = 1 << 24; /* pixel centres are exact in float below this */
    if (rectangle->width == 0 || rectangle->height == 0 || rectangle->x < -furthest ||
        rectangle->y < -furthest || (int64_t)rectangle->x + rectangle->width > furthest ||
        (int64_t)rectangle->y + rectangle->height > furthest)
        return gw_fail(
            error, GW_BAD_INPUT,
            "a rectangle of %u x %u pixels at (%d, %d) cannot be rendered; sides must be at least 1 and "
            "coordinates within 2^24",
            rectangle->width, rectangle->height, rectangle->x, rectangle->y);
    frame_job job = {.renderer = renderer, .rectangle = rectangle, .rgba = rgba};
    uint32_t dropped = 0;
    gw_code code = move_scene(renderer, state->time, error);
    if (!code)
        code = gw_frame_block_fill(renderer->scene, renderer->octree, placement, plane, state, &job.block,
                                   &dropped, error);
    if (code)
        return code;
    if (dropped > 0)
        gw_log_write(renderer->log, GW_LOG_WARNING,
                     "frame %u: %u of %u gazes cannot be used and are left out", state->frame, dropped,
                     state->gaze_count);
    job.block.counts[1] = renderer->buffers.directional_count;
    job.block.counts[2] = renderer->buffers.point_count;
    job.block.window[0] = rectangle->x;
    job.block.window[1] = rectangle->y;
    job.block.window[2] = rectangle->x + (int32_t)rectangle->width;
    job.block.window[3] = rectangle->y + (int32_t)rectangle->height;
    job.key = key_of(renderer, state, job.block.counts[0]);
    renderer->has_drawn = 1;
    renderer->last_features = gw_features_of_frame(state, job.block.counts[0], renderer->scene_features);
    job.sample_block = state->sample_block < 3 ? state->sample_block : 3;
    job.may_be_sparse = (job.key.features & GW_FEATURE_SPARSE) != 0;
    gw_scene_buffers_bind(&renderer->buffers, state->texture_filter);
    code = render_chunks(&job, error);
    if (code)
        return gw_context(error, "frame %u", state->frame);
    if (counters)
        gw_counters_add(counters, &job.counters);
    return GW_OK;
}
