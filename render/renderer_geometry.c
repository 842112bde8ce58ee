/* See gw_renderer_geometry(): the words of shaders/shade/shade.comp, with GUIDES and without SPARSE. */
#include "render/renderer_internal.h"

#include "base/memory.h"
#include "render/vector3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS = 4 }; /* id, t, normal, share */

static float float_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* packSnorm2x16 of a point of the octahedron (shaders/common/octahedral.glsl). */
static void normal_of(uint32_t word, float out[3]) {
    const double x = fmax((double)(int16_t)(word & 0xffff) / 32767, -1),
                 y = fmax((double)(int16_t)(word >> 16) / 32767, -1), z = 1 - fabs(x) - fabs(y);
    const double fold = fmax(-z, 0);
    double v[3] = {x + (x >= 0 ? -fold : fold), y + (y >= 0 ? -fold : fold), z};
    const double length = sqrt(gw_dot(v, v));
    for (int k = 0; k < 3; ++k)
        out[k] = (float)(v[k] / length);
}

/* Length of the ray's direction, mm. */
static double step_of(const gw_frame_job *job, int32_t x, int32_t y) {
    const gw_frame_block *block = &job->block;
    double along[3];
    for (int k = 0; k < 3; ++k)
        along[k] = (double)block->corner[k] + (x + 0.5) * (double)block->step_x[k] +
                   (y + 0.5) * (double)block->step_y[k];
    return sqrt(gw_dot(along, along)) * job->unit;
}

static void place(const gw_frame_job *job, const uint32_t words[WORDS], int32_t x, int32_t y) {
    const gw_geometry *out = job->geometry;
    const size_t at =
        (size_t)(y - job->block.window[1]) * job->rectangle->width + (size_t)(x - job->block.window[0]);
    const int met = words[0] != GW_NO_TRIANGLE && (double)float_of(words[3]) >= 0.5;
    if (out->ids)
        out->ids[at] = met ? words[0] : GW_NO_TRIANGLE;
    if (out->depths)
        out->depths[at] = met ? (float)((double)float_of(words[1]) * step_of(job, x, y)) : 0;
    if (out->normals && met)
        normal_of(words[2], out->normals + at * 3);
    else if (out->normals)
        memset(out->normals + at * 3, 0, 3 * sizeof *out->normals);
}

/* Lanes of a block run in Morton order (shaders/trace/pixel.glsl). */
static void place_chunk(const gw_frame_job *job, const uint32_t *words, size_t block_count) {
    const int32_t *chunk = job->block.chunk, *window = job->block.window;
    for (size_t slot = 0; slot < block_count * GW_BLOCK_PIXELS; ++slot) {
        const size_t block = slot / GW_BLOCK_PIXELS, lane = slot % GW_BLOCK_PIXELS;
        const int32_t across = (int32_t)((lane & 1) | (lane >> 1 & 2) | (lane >> 2 & 4)),
                      down = (int32_t)((lane >> 1 & 1) | (lane >> 2 & 2) | (lane >> 3 & 4));
        const int32_t x = chunk[0] + (int32_t)(block % (size_t)chunk[2]) * GW_BLOCK_SIDE + across,
                      y = chunk[1] + (int32_t)(block / (size_t)chunk[2]) * GW_BLOCK_SIDE + down;
        if (x >= window[0] && y >= window[1] && x < window[2] && y < window[3])
            place(job, words + slot * WORDS, x, y);
    }
}

gw_code gw_geometry_create(uint32_t width, uint32_t height, gw_geometry *out, gw_error *error) {
    const size_t pixels = (size_t)width * height;
    *out = (gw_geometry){0};
    gw_code code = gw_allocate((void **)&out->ids, pixels, sizeof *out->ids, "ids", error);
    if (!code)
        code = gw_allocate((void **)&out->depths, pixels, sizeof *out->depths, "depths", error);
    if (!code)
        code = gw_allocate((void **)&out->normals, pixels * 3, sizeof *out->normals, "normals", error);
    return code;
}

void gw_geometry_finish(gw_geometry *geometry) {
    free(geometry->ids);
    free(geometry->depths);
    free(geometry->normals);
    *geometry = (gw_geometry){0};
}

gw_code gw_frame_geometry(gw_frame_job *job, size_t block_count, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_gl_buffer *guides = &renderer->samples.guides;
    const size_t slots = block_count * GW_BLOCK_PIXELS, bytes = slots * WORDS * sizeof(uint32_t);
    uint32_t *words = NULL;
    gw_code code = gw_allocate((void **)&words, slots * WORDS, sizeof *words, "what rays met", error);
    if (!code)
        code = gw_gl_buffer_write(&renderer->frame, 0, sizeof job->block, &job->block, error);
    if (!code)
        code = gw_renderer_reserve(renderer, slots, gw_kernel_fragments(&job->key), 0, error);
    if (!code)
        code = gw_renderer_grow(renderer, guides, "guides of pixels", bytes, error);
    if (!code) {
        gw_gl_buffer_bind_range(guides, GW_BINDING_GUIDES, 0, bytes);
        code = gw_frame_batch(job, slots, error);
    }
    if (!code)
        code = gw_gl_buffer_read(guides, 0, bytes, words, error);
    if (!code)
        place_chunk(job, words, block_count);
    free(words);
    return code;
}
