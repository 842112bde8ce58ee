/* See renderer_internal.h: the samples of a chunk, and pixels made of them. */
#include "render/renderer_internal.h"

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
gw_code gw_frame_list_samples(gw_frame_job *job, size_t block_count, gw_error *error) {
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

gw_code gw_frame_reconstruct(gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    GLuint program;
    gw_code code = gw_gl_program(job->renderer->device, "blend/reconstruct.comp", NULL, &program, error);
    if (code)
        return code;
    glProgramUniform1ui(program, 0, (GLuint)pixel_slots);
    return gw_gl_dispatch(job->renderer->device, program,
                          (pixel_slots + GW_BLOCK_PIXELS - 1) / GW_BLOCK_PIXELS, error);
}
