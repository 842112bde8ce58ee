/* See renderer_internal.h: the samples of a still view, kept so that the next frame adds only what it lacks.
 * The sums stand by chunk, because chunks of one view are always the same. */
#include "render/renderer_internal.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

gw_code gw_accumulation_begin(gw_accumulation *kept, const gw_accumulation_view *view, uint32_t samples,
                              gw_error *error) {
    if (memcmp(&kept->view, view, sizeof *view) != 0 || samples < kept->samples)
        kept->samples = 0;
    kept->view = *view;
    return gw_grow((void **)&kept->rgba, &kept->rgba_capacity,
                   (size_t)view->rectangle.width * view->rectangle.height, 4, "accumulated pixels", error);
}

static gw_code add_chunk(gw_accumulation *kept, gw_error *error) {
    gw_code code = gw_grow((void **)&kept->chunks, &kept->chunk_capacity, kept->chunk_count + 1,
                           sizeof *kept->chunks, "accumulated chunks", error);
    if (!code)
        kept->chunks[kept->chunk_count++] = (gw_gl_buffer){0};
    return code;
}

gw_code gw_accumulation_bind(gw_renderer *renderer, size_t chunk, size_t pixel_slots, gw_error *error) {
    gw_accumulation *kept = &renderer->accumulation;
    const size_t bytes = pixel_slots * 4 * sizeof(float);
    gw_code code = chunk == kept->chunk_count ? add_chunk(kept, error) : GW_OK;
    gw_gl_buffer *buffer = code ? NULL : &kept->chunks[chunk];
    /* Too small only when the view is new: then nothing that stands in it counts. */
    if (!code && buffer->size < bytes) {
        gw_gl_buffer_finish(buffer);
        code = gw_gl_buffer_create(renderer->device, "accumulated samples", bytes, NULL, 0, buffer, error);
    }
    if (!code)
        gw_gl_buffer_bind(buffer, GW_BINDING_ACCUMULATED);
    return code;
}

int64_t gw_renderer_take_blend_ns(gw_renderer *renderer) {
    const int64_t taken = renderer->blend_ns;
    renderer->blend_ns = 0;
    return taken;
}

void gw_renderer_choose_view(gw_renderer *renderer, uint32_t view) {
    if (view == renderer->chosen_view)
        return;
    const gw_accumulation present = renderer->accumulation;
    renderer->accumulation = renderer->other_accumulation;
    renderer->other_accumulation = present;
    renderer->chosen_view = view;
}

uint64_t gw_accumulation_bytes(const gw_accumulation *kept) {
    uint64_t bytes = 0;
    for (size_t i = 0; i < kept->chunk_count; ++i)
        bytes += kept->chunks[i].size;
    return bytes;
}

void gw_accumulation_finish(gw_accumulation *kept) {
    for (size_t i = 0; i < kept->chunk_count; ++i)
        gw_gl_buffer_finish(&kept->chunks[i]);
    free(kept->chunks);
    free(kept->rgba);
    memset(kept, 0, sizeof *kept);
}
