/* See renderer_internal.h: the samples of a chunk, and pixels made of them. Kernels of shaders/sample list
 * the samples and write what the batches are dispatched with: nothing of the list comes back before the first
 * batch is traced. */
#include "render/renderer_internal.h"

#include "base/clock.h"

#include <stdio.h>
#include <string.h>

enum { PAIR_SIDE = 16, RIM_BLOCKS = 4, GROUP = 64 };
/* Lists of blend/lists.glsl; of regions and edges one for each rate from 1 on. */
enum {
    LIST_OWN,
    LIST_SOFT,
    LIST_MIXED,
    LIST_REGIONS,
    LIST_SAMPLED = LIST_REGIONS + 4,
    LIST_EDGES = LIST_SAMPLED + 4,
    LIST_COUNT = LIST_EDGES + 4,
    LISTS_AT = 64
};

static gw_gl_buffer *buffer_of(gw_sample_buffers *buffers, size_t i) {
    gw_gl_buffer *const all[] = {&buffers->rates,     &buffers->counts,      &buffers->group_sums,
                                 &buffers->list,      &buffers->guides,      &buffers->samples,
                                 &buffers->blocks,    &buffers->sums,        &buffers->pixels,
                                 &buffers->lists,     &buffers->cell_colors, &buffers->cell_points,
                                 &buffers->cell_marks};
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

/* Makes the buffer at least that large; format: as gw_gl_buffer_create(). */
static gw_code reserve_texels(gw_renderer *renderer, gw_gl_buffer *buffer, const char *name, size_t bytes,
                              GLenum format, GLuint binding, gw_error *error) {
    gw_code code = GW_OK;
    if (bytes > buffer->size) {
        gw_gl_buffer_finish(buffer);
        code = gw_gl_buffer_create(renderer->device, name, bytes, NULL, format, buffer, error);
    }
    if (!code)
        gw_gl_buffer_bind(buffer, binding);
    return code;
}

static gw_code reserve(gw_renderer *renderer, gw_gl_buffer *buffer, const char *name, size_t bytes,
                       GLuint binding, gw_error *error) {
    return reserve_texels(renderer, buffer, name, bytes, 0, binding, error);
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

/* Squares of 16 pixels lie in four blocks. */
static const char *wide_define(const gw_frame_job *job) {
    return job->block.sampling[1] == 4 ? "#define WIDE_SQUARES 1\n" : "";
}

static gw_code rates_program(const gw_frame_job *job, const char *wide, GLuint *out, gw_error *error) {
    char defines[128];
    snprintf(defines, sizeof defines, "%s%s%s%s", job->block.counts[0] > 0 ? "#define GAZE 1\n" : "",
             job->key.gaze_seed ? "#define GAZE_SEED 1\n" : "",
             job->state->rate_blend ? "#define RATE_BLEND 1\n" : "", wide);
    return gw_gl_program(job->renderer->device, "sample/rates.comp", defines, out, error);
}

/* The frame block goes to the GPU with the list's grid. */
gw_code gw_frame_list_samples(gw_frame_job *job, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_gl *device = renderer->device;
    GLuint rates, count, offsets, scatter;
    const char *wide = wide_define(job);
    place_grid(&job->block);
    const uint64_t groups = (uint64_t)job->block.list[3] / GROUP;
    gw_code code = gw_gl_buffer_write(&renderer->frame, 0, sizeof job->block, &job->block, error);
    if (!code)
        code = reserve_lists(job, error);
    if (!code)
        code = rates_program(job, wide, &rates, error);
    if (!code)
        code = gw_gl_program(device, "sample/count.comp", wide, &count, error);
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

/* What a kernel of shaders/blend may ask for: it gets no define that changes nothing in it, so that frames
 * share kernels. */
enum { ASKS_GAZE = 1, ASKS_STORE = 2, ASKS_KERNEL = 4, ASKS_EDGES = 8 };

static gw_code blend_program(const gw_frame_job *job, const char *name, int asks, const char *more,
                             GLuint *out, gw_error *error) {
    const int gazed = asks & ASKS_GAZE && job->block.counts[0] > 0;
    const int stores = asks & ASKS_STORE && job->key.features & GW_FEATURE_ACCUMULATE;
    const int cubic = asks & ASKS_KERNEL && job->state->reconstruction >= GW_RECONSTRUCTION_CUBIC;
    char defines[384], tone[128];
    snprintf(defines, sizeof defines, "%s%s%s%s%s%s%s",
             gw_tone_defines(asks & ASKS_STORE ? job->key.features : 0, tone),
             stores ? "#define ACCUMULATE 1\n" : "", gazed ? "#define GAZE 1\n" : "",
             gazed && job->key.gaze_seed ? "#define GAZE_SEED 1\n" : "", cubic ? "#define CUBIC 1\n" : "",
             asks & ASKS_EDGES && job->key.guides ? "#define EDGE_AWARE 1\n" : "", more);
    return gw_gl_program(job->renderer->device, name, defines, out, error);
}

/* log2 of the side of the largest squares that the frame may have. */
static uint32_t coarsest_rate(const gw_frame_job *job) {
    return job->block.counts[0] > 0 && !job->key.gaze_seed ? job->block.sampling[1] : 0;
}

static int softens(const gw_frame_job *job) {
    return job->block.counts[0] > 0 && job->state->rate_blend;
}

/* Cells of the grids of all rates, and words of the lists: as blend/cells.glsl and blend/lists.glsl place
 * them. */
static size_t most_cells(const gw_frame_job *job) {
    const size_t blocks = (size_t)job->block.list[3];
    static const size_t quarters[] = {0, 64, 80, 84, 85};
    return blocks * quarters[coarsest_rate(job)] / 4;
}

static size_t list_words(const gw_frame_job *job) {
    static const size_t edges[] = {0, 16, 20, 21, 22};
    const size_t grids = 14 + (job->key.guides ? edges[coarsest_rate(job)] : 0);
    return LISTS_AT + grids * (size_t)job->block.list[3];
}

static gw_code reserve_blending(const gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    uint32_t heads[LIST_COUNT][4] = {{0}};
    for (size_t i = 0; i < LIST_COUNT; ++i)
        heads[i][2] = 1;
    gw_renderer *renderer = job->renderer;
    gw_sample_buffers *to = &renderer->samples;
    const size_t cells = most_cells(job), met = job->key.guides ? cells : 0;
    gw_code code = reserve(renderer, &to->pixels, "pixels of samples", pixel_slots * sizeof(uint32_t),
                           GW_BINDING_PIXELS, error);
    if (!code)
        code = reserve(renderer, &to->lists, "lists of blocks", list_words(job) * sizeof(uint32_t),
                       GW_BINDING_LISTS, error);
    if (!code)
        code = gw_gl_buffer_write(&to->lists, 0, sizeof heads, heads, error);
    if (!code && cells > 0)
        code = reserve_texels(renderer, &to->cell_colors, "cells of samples", cells * 16, GL_RGBA32F,
                              GW_BINDING_CELL_COLORS, error);
    if (!code && met > 0)
        code = reserve_texels(renderer, &to->cell_points, "points of cells", met * 16, GL_RGBA32F,
                              GW_BINDING_CELL_POINTS, error);
    if (!code && met > 0)
        code = reserve_texels(renderer, &to->cell_marks, "marks of cells", met * 8, GL_RG32UI,
                              GW_BINDING_CELL_MARKS, error);
    return code;
}

static gw_code dispatch_list(const gw_frame_job *job, GLuint program, uint32_t list, gw_error *error) {
    return gw_gl_dispatch_indirect(job->renderer->device, program, &job->renderer->samples.lists,
                                   (size_t)list * 4 * sizeof(uint32_t), error);
}

static gw_code draw_list(const gw_frame_job *job, const char *name, int asks, const char *defines,
                         uint32_t list, gw_error *error) {
    GLuint program;
    gw_code code = blend_program(job, name, asks, defines, &program, error);
    return code ? code : dispatch_list(job, program, list, error);
}

static gw_code draw_list_of_rate(const gw_frame_job *job, const char *name, int asks, const char *defines,
                                 uint32_t first_list, uint32_t rate, gw_error *error) {
    GLuint program;
    gw_code code = blend_program(job, name, asks, defines, &program, error);
    if (code)
        return code;
    glProgramUniform1ui(program, 0, rate);
    return dispatch_list(job, program, first_list + rate - 1, error);
}

/* Sharpness falls within each rate but the coarsest, which has none to fall to. */
static const char *soft_define(const gw_frame_job *job, uint32_t rate) {
    return softens(job) && rate < coarsest_rate(job) ? "#define RATE_BLEND 1\n" : "";
}

/* Patches of a rate: those without edges, then those that the first kernel found to have some. */
static gw_code draw_patches(const gw_frame_job *job, uint32_t rate, gw_error *error) {
    const char *soft = soft_define(job, rate);
    char defines[64];
    snprintf(defines, sizeof defines, "#define RATE %u\n%s", rate, soft);
    gw_code code = draw_list(job, "blend/patches.comp", ASKS_STORE | ASKS_KERNEL | ASKS_EDGES, defines,
                             LIST_REGIONS + rate - 1, error);
    if (!code && job->key.guides)
        code = draw_list_of_rate(job, "blend/edge_patches.comp", ASKS_STORE | ASKS_KERNEL, soft, LIST_EDGES,
                                 rate, error);
    return code;
}

static gw_code fill_cells(const gw_frame_job *job, gw_error *error) {
    const int soft = softens(job);
    gw_code code = GW_OK;
    for (uint32_t rate = 1; rate <= coarsest_rate(job) && !code; ++rate) {
        const char *falls = soft_define(job, rate);
        code = draw_list_of_rate(job, "blend/sample_cells.comp", ASKS_EDGES | (*falls ? ASKS_GAZE : 0), falls,
                                 LIST_SAMPLED, rate, error);
    }
    return code ? code
                : draw_list(job, "blend/mixed_cells.comp", ASKS_EDGES | (soft ? ASKS_GAZE : 0),
                            soft ? "#define RATE_BLEND 1\n" : "", LIST_MIXED, error);
}

static gw_code reconstruct(gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_sample_buffers *samples = &renderer->samples;
    const uint32_t coarsest = coarsest_rate(job);
    GLuint list;
    gw_gl_buffer_bind(&samples->counts, GW_LIST_BINDING_COUNTS);
    gw_gl_buffer_bind(&samples->sums, GW_BINDING_SUMS);
    if (job->key.guides)
        gw_gl_buffer_bind(&samples->guides, GW_BINDING_GUIDES);
    gw_code code = reserve_blending(job, pixel_slots, error);
    if (!code)
        code = gw_gl_program(renderer->device, "blend/list_regions.comp", wide_define(job), &list, error);
    if (!code)
        code = gw_gl_dispatch(renderer->device, list, (uint64_t)job->block.list[3] / GROUP, error);
    if (!code)
        code = draw_list(job, "blend/fine_blocks.comp", ASKS_STORE, "", LIST_OWN, error);
    if (!code && softens(job))
        code = draw_list(job, "blend/fine_blocks.comp", ASKS_STORE | ASKS_GAZE, "#define SOFT 1\n", LIST_SOFT,
                         error);
    if (!code && coarsest > 0)
        code = fill_cells(job, error);
    gw_gl_texture_bind(&samples->cell_colors, GW_UNIT_CELL_COLORS);
    gw_gl_texture_bind(&samples->cell_points, GW_UNIT_CELL_POINTS);
    gw_gl_texture_bind(&samples->cell_marks, GW_UNIT_CELL_MARKS);
    for (uint32_t rate = 1; rate <= coarsest && !code; ++rate)
        code = draw_patches(job, rate, error);
    return code;
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
