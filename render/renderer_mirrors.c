/* See renderer_internal.h: the reflected rays of what one dispatch has met in mirrors. They are a batch of
 * rays like any other, traced, lit and shaded by the same kernels with their rays from a buffer, before what
 * met the mirrors is shaded. One bounce: a mirror in a mirror shows the light from everywhere. */
#include "render/renderer_internal.h"

#include <string.h>

static size_t whole_groups(size_t slots) {
    return (slots + GW_BLOCK_PIXELS - 1) / GW_BLOCK_PIXELS * GW_BLOCK_PIXELS;
}

void gw_mirror_buffers_finish(gw_mirror_buffers *buffers) {
    gw_ray_buffers_finish(&buffers->traced);
    gw_gl_buffer *all[] = {&buffers->numbers, &buffers->mirrors, &buffers->rays, &buffers->radiance};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
        gw_gl_buffer_finish(all[i]);
    memset(buffers, 0, sizeof *buffers);
}

uint64_t gw_mirror_buffers_bytes(const gw_mirror_buffers *buffers) {
    return gw_ray_buffers_bytes(&buffers->traced) + buffers->numbers.size + buffers->mirrors.size +
           buffers->rays.size + buffers->radiance.size;
}

uint64_t gw_mirror_ray_bytes(uint32_t fragments) {
    return (uint64_t)fragments * (2 + 4) * sizeof(uint32_t) + GW_REFLECTED_ROWS * 4 * sizeof(float);
}

static gw_code list_mirrors(gw_frame_job *job, size_t slots, int resume, uint32_t *count, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_mirror_buffers *mirrors = &renderer->mirrors;
    const size_t places = job->rays->slots * gw_kernel_fragments(&job->key);
    const gw_kernel_key key = {
        .features = job->key.features & GW_FEATURE_LOD, .depth = job->key.depth, .resume = resume};
    uint32_t totals[GW_TOTAL_WORDS];
    GLuint program = 0;
    gw_code code = gw_renderer_grow(renderer, &mirrors->numbers, "numbers of reflections",
                                    places * sizeof(uint32_t), error);
    if (!code)
        code = gw_renderer_grow(renderer, &mirrors->mirrors, "mirrors met", places * sizeof(uint32_t), error);
    if (!code)
        code = gw_renderer_kernel(renderer, "shade/list_mirrors.comp", &key, NULL, &program, error);
    if (code)
        return code;
    gw_gl_buffer_bind(&mirrors->numbers, GW_BINDING_REFLECTION_NUMBERS);
    gw_gl_buffer_bind(&mirrors->mirrors, GW_BINDING_MIRRORS);
    if (resume)
        glProgramUniform1ui(program, 0, (GLuint)slots);
    code = gw_frame_dispatch(job, program, slots, error);
    if (!code)
        code = gw_renderer_read_totals(renderer, totals, error);
    if (!code) {
        job->counters.step_cap_hits += totals[0];
        *count = totals[3];
    }
    return code;
}

/* What leaves `count` mirrors from `begin` on. */
static gw_code make_rays(const gw_frame_job *job, uint32_t begin, uint32_t count, gw_error *error) {
    const gw_features features =
        GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_SPARSE | GW_FEATURE_SMOOTH_NORMALS;
    gw_renderer *renderer = job->renderer;
    const gw_kernel_key key = {.features = job->key.features & features, .depth = job->key.depth};
    GLuint program = 0;
    gw_code code = gw_renderer_kernel(renderer, "shade/mirror_rays.comp", &key, NULL, &program, error);
    if (!code)
        code = gw_renderer_grow(renderer, &renderer->mirrors.rays, "reflected rays",
                                whole_groups(count) * GW_REFLECTED_ROWS * 4 * sizeof(float), error);
    if (code)
        return code;
    gw_ray_buffers_bind(job->rays);
    gw_gl_buffer_bind(&renderer->mirrors.rays, GW_BINDING_REFLECTED_RAYS);
    glProgramUniform2ui(program, 0, begin, count);
    return gw_gl_dispatch(renderer->device, program, whole_groups(count) / GW_BLOCK_PIXELS, error);
}

static gw_code trace_rays(gw_frame_job *job, uint32_t begin, uint32_t count, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_mirror_buffers *mirrors = &renderer->mirrors;
    const size_t slots = whole_groups(count), row = 4 * sizeof(float);
    gw_frame_job second = *job;
    second.rays = &mirrors->traced;
    second.arguments = NULL;
    second.counters = (gw_counters){0};
    second.key.reflected = 1;
    second.key.guides = 0;
    second.key.debug = GW_DEBUG_NONE;
    second.key.features &= ~(GW_FEATURE_MIRROR | GW_FEATURE_SPARSE | GW_FEATURE_GAZE | GW_FEATURE_ACCUMULATE);
    gw_code code = gw_ray_buffers_reserve(renderer, second.rays, slots, gw_kernel_fragments(&second.key),
                                          second.key.count, error);
    if (code)
        return code;
    gw_ray_buffers_bind(second.rays);
    gw_gl_buffer_bind_range(&mirrors->radiance, GW_BINDING_REFLECTIONS, begin * row, slots * row);
    code = gw_frame_batch(&second, slots, error);
    if (!code && second.key.count)
        code = gw_ray_buffers_add_work(second.rays, slots, &second.counters, error);
    gw_counters_add(&job->counters, &second.counters);
    return code;
}

gw_code gw_frame_mirrors(gw_frame_job *job, size_t slots, int resume, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_mirror_buffers *mirrors = &renderer->mirrors;
    if (!(job->key.features & GW_FEATURE_MIRROR))
        return GW_OK;
    uint32_t count = 0;
    gw_code code = list_mirrors(job, slots, resume, &count, error);
    if (!code)
        code = gw_renderer_grow(renderer, &mirrors->radiance, "reflected radiance",
                                whole_groups(count > 0 ? count : 1) * 4 * sizeof(float), error);
    job->counters.mirror_rays += count;
    const uint32_t batch = (uint32_t)gw_renderer_chunk_slots(renderer);
    for (uint32_t begin = 0; !code && begin < count; begin += batch) {
        uint32_t here = count - begin < batch ? count - begin : batch;
        code = make_rays(job, begin, here, error);
        if (!code)
            code = trace_rays(job, begin, here, error);
    }
    gw_ray_buffers_bind(job->rays);
    gw_gl_buffer_bind(&mirrors->radiance, GW_BINDING_REFLECTIONS);
    return code ? code : gw_renderer_clear_totals(renderer, error);
}
