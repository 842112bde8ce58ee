/* See renderer_internal.h: the samples of a chunk, and pixels made of them. Kernels of shaders/sample list
 * the samples and write what the batches are dispatched with: nothing of the list comes back before the first
 * batch is traced. */
#include "render/renderer_internal.h"

#include "base/clock.h"

#include <stdio.h>
#include <string.h>

enum { PAIR_SIDE = 16, RIM_BLOCKS = 4, GROUP = 64 };

static gw_gl_buffer *buffer_of(gw_sample_buffers *buffers, size_t i) {
    gw_gl_buffer *const all[] = {&buffers->rates,  &buffers->counts,     &buffers->group_sums, &buffers->list,
                                 &buffers->guides, &buffers->samples,    &buffers->blocks,     &buffers->sums,
                                 &buffers->pixels, &buffers->block_lists};
    return i < sizeof all / sizeof all[0] ? all[i] : NULL;
}

void gw_sample_buffers_finish(gw_sample_buffers *buffers) {
    for (size_t i = 0; buffer_of(buffers, i); ++i)
        gw_gl_buffer_finish(buffer_of(buffers, i));
}

uint64_t gw_sample_buffers_bytes(const gw_sample_buffers *buffers) {
    gw_sample_buffers copy = *buffers;
    uint64_t bytes = 0;
    for (size_t i = 0; buffer_of(&copy, i); ++i)
        bytes += buffer_of(&copy, i)->size;
    return bytes;
}

static int32_t floor_to(int32_t value, int32_t multiple) {
    return value - ((value % multiple) + multiple) % multiple;
}

/* The grid of the chunk's list: whole pairs and squares of blocks that hold the chunk and its rim. */
static void place_grid(gw_frame_block *block) {
    const int32_t square = GW_LIST_SQUARE * GW_BLOCK_SIDE;
    int32_t size[2], blocks[2] = {block->chunk[2], block->chunk[3] / block->chunk[2]};
    for (int i = 0; i < 2; ++i) {
        block->list[i] = floor_to(block->chunk[i] - RIM_BLOCKS * GW_BLOCK_SIDE, PAIR_SIDE);
        int32_t end = block->chunk[i] + (blocks[i] + RIM_BLOCKS) * GW_BLOCK_SIDE;
        size[i] = (end - block->list[i] + square - 1) / square * GW_LIST_SQUARE;
    }
    block->list[2] = size[0];
    block->list[3] = size[0] * size[1];
}

uint32_t gw_most_rays_of_pixel(const gw_frame_block *block) {
    uint32_t coarse = (block->sampling[0] + 3) / 4; /* of the smallest squares, 2 x 2 */
    return coarse > block->counts[3] ? coarse : block->counts[3];
}

/* Most samples that the list may hold, padding included. */
static size_t most_samples(const gw_frame_block *block) {
    size_t columns = (size_t)block->chunk[2] + 2 * RIM_BLOCKS;
    size_t rows = (size_t)(block->chunk[3] / block->chunk[2]) + 2 * RIM_BLOCKS;
    return (columns * rows * gw_most_rays_of_pixel(block) + 1) * GW_BLOCK_PIXELS;
}

/* Samples that are traced at a time. */
static size_t batch_slots(const gw_frame_job *job) {
    size_t slots = gw_renderer_chunk_slots(job->renderer), most = most_samples(&job->block);
    return slots < most ? slots : most;
}

static size_t most_batches(const gw_frame_job *job) {
    return (most_samples(&job->block) + batch_slots(job) - 1) / batch_slots(job);
}

/* Makes the buffer at least that large. */
static gw_code reserve(gw_renderer *renderer, gw_gl_buffer *buffer, const char *name, size_t bytes,
                       GLuint binding, gw_error *error) {
    gw_code code = GW_OK;
    if (bytes > buffer->size) {
        gw_gl_buffer_finish(buffer);
        code = gw_gl_buffer_create(renderer->device, name, bytes, NULL, 0, buffer, error);
    }
    if (!code)
        gw_gl_buffer_bind(buffer, binding);
    return code;
}

static gw_code reserve_lists(const gw_frame_job *job, gw_error *error) {
    gw_sample_buffers *to = &job->renderer->samples;
    const size_t word = sizeof(uint32_t), blocks = (size_t)job->block.list[3];
    const struct {
        gw_gl_buffer *buffer;
        const char *name;
        size_t bytes;
        GLuint binding;
    } rows[] = {
        {&to->rates, "block rates", blocks * word, GW_LIST_BINDING_RATES},
        {&to->counts, "block samples", blocks * word, GW_LIST_BINDING_COUNTS},
        {&to->group_sums, "sums of samples", blocks / GROUP * 2 * word, GW_LIST_BINDING_GROUP_SUMS},
        {&to->list, "sample list", (GW_LIST_ARGUMENTS + 4 * most_batches(job)) * word, GW_LIST_BINDING_LIST},
        {&to->samples, "samples", most_samples(&job->block) * word, GW_BINDING_SAMPLES},
        {&to->blocks, "sample blocks", blocks * word, GW_BINDING_BLOCKS}};
    gw_code code = GW_OK;
    for (size_t i = 0; !code && i < sizeof rows / sizeof rows[0]; ++i)
        code = reserve(job->renderer, rows[i].buffer, rows[i].name, rows[i].bytes, rows[i].binding, error);
    return code;
}

static gw_code list_program(const gw_frame_job *job, const char *name, GLuint *out, gw_error *error) {
    char defines[128] = "";
    if (job->block.counts[0] > 0)
        strcat(defines, "#define GAZE 1\n");
    if (job->key.gaze_seed)
        strcat(defines, "#define GAZE_SEED 1\n");
    if (job->block.sampling[1] == 4)
        strcat(defines, "#define WIDE_SQUARES 1\n");
    if (job->state->rate_blend)
        strcat(defines, "#define RATE_BLEND 1\n");
    return gw_gl_program(job->renderer->device, name, defines, out, error);
}

/* The frame block goes to the GPU with the list's grid. */
gw_code gw_frame_list_samples(gw_frame_job *job, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_gl *device = renderer->device;
    GLuint rates, count, offsets, scatter;
    place_grid(&job->block);
    const uint64_t groups = (uint64_t)job->block.list[3] / GROUP;
    gw_code code = gw_gl_buffer_write(&renderer->frame, 0, sizeof job->block, &job->block, error);
    if (!code)
        code = reserve_lists(job, error);
    if (!code)
        code = list_program(job, "sample/rates.comp", &rates, error);
    if (!code)
        code = list_program(job, "sample/count.comp", &count, error);
    if (!code)
        code = gw_gl_program(device, "sample/offsets.comp", NULL, &offsets, error);
    if (!code)
        code = gw_gl_program(device, "sample/scatter.comp", NULL, &scatter, error);
    if (code)
        return code;
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, renderer->frame.id);
    glProgramUniform1ui(offsets, 0, (GLuint)groups);
    glProgramUniform1ui(offsets, 1, (GLuint)most_batches(job));
    glProgramUniform1ui(offsets, 2, (GLuint)(batch_slots(job) / GROUP));
    code = gw_gl_dispatch(device, rates, groups, error);
    if (!code)
        code = gw_gl_dispatch(device, count, groups, error);
    if (!code)
        code = gw_gl_dispatch(device, offsets, 1, error);
    if (!code)
        code = gw_gl_dispatch(device, scatter, groups, error);
    return code;
}

static gw_code read_list(const gw_frame_job *job, uint32_t words[GW_LIST_ARGUMENTS], gw_error *error) {
    return gw_gl_buffer_read(&job->renderer->samples.list, 0, GW_LIST_ARGUMENTS * sizeof *words, words,
                             error);
}

gw_code gw_frame_count_samples(gw_frame_job *job, size_t block_count, gw_error *error) {
    uint32_t words[GW_LIST_ARGUMENTS] = {0};
    (void)block_count;
    gw_code code = gw_frame_list_samples(job, error);
    if (!code)
        code = read_list(job, words, error);
    job->counters.rays += words[0];
    return code;
}

/* Room for the batch's rays and for everything that is made of all samples. The batch sees its own part of
 * the lists, so that its slots begin at 0. */
static gw_code bind_batch(gw_frame_job *job, size_t first, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_sample_buffers *samples = &renderer->samples;
    size_t slots = batch_slots(job), most = most_samples(&job->block), end = first + slots;
    size_t here = (end < most ? end : most) - first;
    gw_code code =
        gw_renderer_reserve(renderer, slots, gw_kernel_fragments(&job->key), job->key.count, error);
    if (!code)
        code = reserve(renderer, &samples->sums, "radiance of samples", most * 16, GW_BINDING_SUMS, error);
    if (!code && job->key.guides)
        code = reserve(renderer, &samples->guides, "guides of samples", most * 16, GW_BINDING_GUIDES, error);
    if (code)
        return code;
    if (job->key.guides)
        gw_gl_buffer_bind_range(&samples->guides, GW_BINDING_GUIDES, first * 16, here * 16);
    gw_gl_buffer_bind_range(&samples->samples, GW_BINDING_SAMPLES, first * 4, here * 4);
    gw_gl_buffer_bind_range(&samples->sums, GW_BINDING_SUMS, first * 16, here * 16);
    return GW_OK;
}

/* The first batch is dispatched before anybody knows how many there are. */
static gw_code trace_batches(gw_frame_job *job, gw_error *error) {
    uint32_t words[GW_LIST_ARGUMENTS] = {0};
    size_t slots = batch_slots(job), first = 0;
    gw_code code = GW_OK;
    do {
        code = bind_batch(job, first, error);
        if (code)
            return code;
        job->arguments = &job->renderer->samples.list;
        job->argument_offset = (GW_LIST_ARGUMENTS + 4 * (first / slots)) * sizeof(uint32_t);
        code = gw_frame_batch(job, slots, error);
        job->arguments = NULL;
        if (!code && first == 0)
            code = read_list(job, words, error);
        const size_t left = (size_t)words[1] * GROUP - first; /* of them from this batch on */
        if (!code && job->key.count)
            code = gw_ray_buffers_add_work(job->rays, left < slots ? left : slots, &job->counters, error);
        first += slots;
    } while (!code && first < (size_t)words[1] * GROUP);
    job->counters.rays += words[0];
    return code;
}

/* The kernel that makes pixels; edges: with silhouettes; listed: of blocks in a list. */
static gw_code pixel_program(const gw_frame_job *job, int edges, int listed, GLuint *out, gw_error *error) {
    const int gazed = job->block.counts[0] > 0;
    char defines[192];
    snprintf(defines, sizeof defines, "%s%s%s%s%s%s%s",
             job->key.features & GW_FEATURE_ACCUMULATE ? "#define ACCUMULATE 1\n" : "",
             gazed ? "#define GAZE 1\n" : "", job->key.gaze_seed ? "#define GAZE_SEED 1\n" : "",
             gazed && job->state->rate_blend ? "#define RATE_BLEND 1\n" : "",
             job->state->reconstruction >= GW_RECONSTRUCTION_CUBIC ? "#define CUBIC 1\n" : "",
             edges ? "#define EDGE_AWARE 1\n" : "", listed ? "#define LISTED 1\n" : "");
    return gw_gl_program(job->renderer->device, "blend/reconstruct.comp", defines, out, error);
}

/* Lists the blocks in which there are edges and those in which there are none, and makes the pixels of each
 * list by its own kernel. */
static gw_code reconstruct_listed(gw_frame_job *job, size_t blocks, gw_error *error) {
    static const uint32_t heads[2][4] = {{0, 0, 1, 0}, {0, 0, 1, 0}};
    gw_renderer *renderer = job->renderer;
    gw_gl_buffer *lists = &renderer->samples.block_lists;
    GLuint list;
    gw_code code = gw_gl_program(renderer->device, "blend/edge_blocks.comp", NULL, &list, error);
    if (!code)
        code = reserve(renderer, lists, "lists of blocks", sizeof heads + blocks * sizeof(uint32_t),
                       GW_BINDING_BLOCK_LISTS, error);
    if (!code)
        code = gw_gl_buffer_write(lists, 0, sizeof heads, heads, error);
    if (!code)
        code = gw_gl_dispatch(renderer->device, list, blocks, error);
    for (int edges = 0; edges < 2 && !code; ++edges) {
        GLuint program;
        code = pixel_program(job, edges, 1, &program, error);
        if (!code)
            code = gw_gl_dispatch_indirect(renderer->device, program, lists, (size_t)edges * sizeof heads[0],
                                           error);
    }
    return code;
}

static gw_code reconstruct(gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    const size_t blocks = pixel_slots / GW_BLOCK_PIXELS;
    GLuint program;
    gw_gl_buffer_bind(&renderer->samples.sums, GW_BINDING_SUMS);
    if (job->key.guides)
        gw_gl_buffer_bind(&renderer->samples.guides, GW_BINDING_GUIDES);
    gw_code code = reserve(renderer, &renderer->samples.pixels, "pixels of samples",
                           pixel_slots * sizeof(uint32_t), GW_BINDING_PIXELS, error);
    if (!code && job->key.guides)
        return reconstruct_listed(job, blocks, error);
    if (!code)
        code = pixel_program(job, 0, 0, &program, error);
    return code ? code : gw_gl_dispatch(renderer->device, program, blocks, error);
}

/* What comes before it is waited for, or its time would be counted here. */
static gw_code reconstruct_timed(gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_code code = gw_gl_finish(renderer->device, error);
    const int64_t begin = gw_now_ns();
    if (!code)
        code = reconstruct(job, pixel_slots, error);
    if (!code)
        code = gw_gl_finish(renderer->device, error);
    renderer->blend_ns += gw_now_ns() - begin;
    return code;
}

gw_code gw_frame_samples(gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    gw_code code = trace_batches(job, error);
    if (!code)
        code = job->renderer->time_blending ? reconstruct_timed(job, pixel_slots, error)
                                            : reconstruct(job, pixel_slots, error);
    return code;
}
