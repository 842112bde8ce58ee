/* See renderer_internal.h: what makes codes of the screen of linear light, and the counts of that light. */
#include "render/renderer_internal.h"

#include <stdio.h>
#include <string.h>

gw_code gw_frame_meter(gw_renderer *renderer, gw_error *error) {
    static const gw_luminance none;
    gw_code code = gw_renderer_grow(renderer, &renderer->luminances, "counts of light", sizeof none, error);
    if (!code)
        code = gw_gl_buffer_write(&renderer->luminances, 0, sizeof none, &none, error);
    if (!code)
        gw_gl_buffer_bind(&renderer->luminances, GW_BINDING_LUMINANCES);
    return code;
}

gw_code gw_frame_read_meter(gw_renderer *renderer, gw_luminance *out, gw_error *error) {
    return gw_gl_buffer_read(&renderer->luminances, 0, sizeof *out, out, error);
}

void gw_renderer_take_luminance(gw_renderer *renderer, gw_luminance *out) {
    *out = renderer->luminance;
    memset(&renderer->luminance, 0, sizeof renderer->luminance);
}

const char *gw_tone_defines(gw_features features, char text[128]) {
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < gw_feature_count; ++i)
        if (gw_feature_rows[i].bit & features & GW_TONE_FEATURES)
            used += (size_t)snprintf(text + used, 128 - used, "#define %s 1\n", gw_feature_rows[i].define);
    return text;
}

gw_code gw_frame_kept_pixels(gw_frame_job *job, size_t pixel_slots, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_gl_buffer *pixels = gw_frame_pixels(job);
    char defines[128];
    GLuint program;
    gw_frame_block_set_sample(job->state, job->end_sample - 1, &job->block);
    gw_code code =
        gw_gl_program(renderer->device, "blend/kept_pixels.comp",
                      gw_tone_defines(job->key.features & ~GW_FEATURE_METERING, defines), &program, error);
    if (!code)
        code = gw_gl_buffer_write(&renderer->frame, 0, sizeof job->block, &job->block, error);
    if (!code)
        code = gw_accumulation_bind(renderer, job->chunk, pixel_slots, error);
    if (!code)
        code = gw_renderer_grow(renderer, pixels, "pixels", pixel_slots * sizeof(uint32_t), error);
    if (code)
        return code;
    gw_gl_buffer_bind(pixels, GW_BINDING_PIXELS);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, renderer->frame.id);
    return gw_gl_dispatch(renderer->device, program, pixel_slots / GW_BLOCK_PIXELS, error);
}
