/* See renderer_internal.h: the rays that what one dispatch has met asks for - what mirrors reflect. They are
 * listed, made and then a batch of rays like any other, traced, lit and shaded by the same kernels with their
 * rays from a buffer, before what asked for them is shaded and takes what they bring. What they meet asks in
 * turn, one bounce deeper with buffers of its own, until no bounce is left. */
#include "render/renderer_internal.h"

#include <string.h>

static size_t whole_groups(size_t slots) {
    return (slots + GW_BLOCK_PIXELS - 1) / GW_BLOCK_PIXELS * GW_BLOCK_PIXELS;
}

void gw_secondary_buffers_finish(gw_secondary_buffers *buffers) {
    gw_ray_buffers_finish(&buffers->traced);
    gw_shadow_buffers_finish(&buffers->shadows);
    gw_gl_buffer *all[] = {&buffers->asked, &buffers->requests, &buffers->rays, &buffers->radiance};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
        gw_gl_buffer_finish(all[i]);
    memset(buffers, 0, sizeof *buffers);
}

uint64_t gw_secondary_buffers_bytes(const gw_secondary_buffers *buffers) {
    return gw_ray_buffers_bytes(&buffers->traced) + gw_shadow_buffers_bytes(&buffers->shadows) +
           buffers->asked.size + buffers->requests.size + buffers->rays.size + buffers->radiance.size;
}

/* What a secondary ray brings: rows of 16 bytes. */
static size_t rows_of(gw_features features) {
    return features & GW_FEATURE_DIFFUSE ? GW_BROUGHT_ROWS_DIFFUSE : 1;
}

uint64_t gw_secondary_ray_bytes(uint32_t fragments, uint32_t cones, gw_features asked) {
    const uint64_t most = GW_RAYS_OF_FRAGMENT + cones;
    return fragments * ((1 + most) * sizeof(uint32_t) + most * rows_of(asked) * 4 * sizeof(float)) +
           GW_SECONDARY_ROWS * 4 * sizeof(float);
}

/* What kernels of secondary rays must know of the rays that ask for them. */
static gw_kernel_key key_of(const gw_frame_job *job) {
    const gw_features all = GW_SECONDARY_FEATURES | GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_SPARSE |
                            GW_FEATURE_SMOOTH_NORMALS | GW_FEATURE_NORMAL_MAPS | GW_FEATURE_MATERIAL_MAPS |
                            GW_FEATURE_MAP_PLACEMENT | GW_FEATURE_SQUARE_TEXELS |
                            GW_FEATURE_TRANSMISSION_MAPS;
    const gw_features of_gloss = GW_FEATURE_SPECULAR | GW_FEATURE_CLEARCOAT | GW_FEATURE_LAYER_MAPS |
                                 GW_FEATURE_SHEEN | GW_FEATURE_UNLIT;
    const gw_features features = all | (job->key.features & GW_FEATURE_GLOSSY ? of_gloss : 0);
    return (gw_kernel_key){.features = job->key.features & features,
                           .depth = job->key.depth,
                           .data_classes = job->key.data_classes,
                           .reflected = job->key.reflected};
}

/* The most that a fragment may ask for. */
static size_t rays_of_fragment(const gw_frame_job *job) {
    return GW_RAYS_OF_FRAGMENT + (job->key.features & GW_CONE_FEATURES ? job->block.sampling[2] : 0);
}

static gw_code list_requests(gw_frame_job *job, gw_secondary_buffers *to, size_t slots, int resume,
                             uint32_t *count, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    const size_t places = job->rays->slots * gw_kernel_fragments(&job->key);
    gw_kernel_key key = key_of(job);
    uint32_t totals[GW_TOTAL_WORDS];
    GLuint program = 0;
    key.resume = resume;
    gw_code code = gw_renderer_grow(renderer, &to->asked, "rays asked for", places * sizeof(uint32_t), error);
    if (!code)
        code = gw_renderer_grow(renderer, &to->requests, "requests of rays",
                                places * rays_of_fragment(job) * sizeof(uint32_t), error);
    if (!code)
        code = gw_renderer_kernel(renderer, "shade/list_secondary.comp", &key, NULL, &program, error);
    if (code)
        return code;
    gw_gl_buffer_bind(&to->asked, GW_BINDING_ASKED);
    gw_gl_buffer_bind(&to->requests, GW_BINDING_REQUESTS);
    if (resume)
        glProgramUniform1ui(program, 0, (GLuint)slots);
    code = gw_frame_dispatch(job, program, slots, error);
    if (code || job->bounce == job->bounces)
        return code; /* rays of the last bounce carry that they ask for none */
    code = gw_renderer_read_totals(renderer, totals, error);
    if (!code) {
        job->counters.step_cap_hits += totals[0];
        *count = totals[3];
        job->counters.refracted_rays += totals[GW_TOTAL_REFRACTED];
        job->counters.cone_rays += totals[GW_TOTAL_CONES];
        job->counters.glossy_rays += totals[GW_TOTAL_GLOSSY];
        job->counters.mirror_rays +=
            totals[3] - totals[GW_TOTAL_REFRACTED] - totals[GW_TOTAL_CONES] - totals[GW_TOTAL_GLOSSY];
    }
    return code;
}

/* The rays of `count` requests from `begin` on. */
static gw_code make_rays(const gw_frame_job *job, gw_secondary_buffers *to, uint32_t begin, uint32_t count,
                         gw_error *error) {
    gw_renderer *renderer = job->renderer;
    const gw_kernel_key key = key_of(job);
    GLuint program = 0;
    gw_code code = gw_renderer_kernel(renderer, "shade/secondary_rays.comp", &key, NULL, &program, error);
    if (!code)
        code = gw_renderer_grow(renderer, &to->rays, "secondary rays",
                                whole_groups(count) * GW_SECONDARY_ROWS * 4 * sizeof(float), error);
    if (code)
        return code;
    gw_frame_bind_rays(job);
    gw_gl_buffer_bind(&to->asked, GW_BINDING_ASKED);
    gw_gl_buffer_bind(&to->requests, GW_BINDING_REQUESTS);
    gw_gl_buffer_bind(&to->rays, GW_BINDING_NEXT_RAYS);
    glProgramUniform3ui(program, 0, begin, count, job->bounce + 1 < job->bounces);
    return gw_gl_dispatch(renderer->device, program, whole_groups(count) / GW_BLOCK_PIXELS, error);
}

static gw_code trace_rays(gw_frame_job *job, gw_secondary_buffers *to, uint32_t begin, uint32_t count,
                          gw_error *error) {
    gw_renderer *renderer = job->renderer;
    const size_t slots = whole_groups(count), row = rows_of(job->key.features) * 4 * sizeof(float);
    gw_frame_job next = *job;
    next.rays = &to->traced;
    next.shadows = &to->shadows;
    next.given = &to->rays;
    next.sums = &to->radiance;
    next.sums_offset = begin * row;
    next.sums_size = slots * row;
    next.bounce++;
    next.arguments = NULL;
    next.counters = (gw_counters){0};
    next.key.reflected = 1;
    next.key.guides = 0;
    next.key.debug = GW_DEBUG_NONE;
    next.key.features &= ~(GW_FEATURE_SPARSE | GW_FEATURE_GAZE | GW_FEATURE_ACCUMULATE | GW_TONE_FEATURES);
    gw_code code = gw_ray_buffers_reserve(renderer, next.rays, slots, gw_kernel_fragments(&next.key),
                                          next.key.count, error);
    if (code)
        return code;
    gw_frame_bind_rays(&next);
    code = gw_frame_batch(&next, slots, error);
    if (!code && next.key.count)
        code = gw_ray_buffers_add_work(next.rays, slots, &next.counters, error);
    gw_counters_add(&job->counters, &next.counters);
    return code;
}

void gw_frame_bind_rays(const gw_frame_job *job) {
    gw_ray_buffers_bind(job->rays);
    if (!job->given)
        return;
    gw_gl_buffer_bind(job->given, GW_BINDING_GIVEN_RAYS);
    gw_gl_buffer_bind_range(job->sums, GW_BINDING_GIVEN_SUMS, job->sums_offset, job->sums_size);
}

gw_code gw_frame_secondary(gw_frame_job *job, size_t slots, int resume, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    if (!(job->key.features & GW_SECONDARY_FEATURES))
        return GW_OK;
    gw_secondary_buffers *to = &renderer->secondary[job->bounce];
    uint32_t count = 0;
    gw_code code = list_requests(job, to, slots, resume, &count, error);
    if (!code)
        code = gw_renderer_grow(
            renderer, &to->radiance, "radiance of secondary rays",
            whole_groups(count > 0 ? count : 1) * rows_of(job->key.features) * 4 * sizeof(float), error);
    const uint32_t batch = (uint32_t)gw_renderer_chunk_slots(renderer);
    for (uint32_t begin = 0; !code && begin < count; begin += batch) {
        uint32_t here = count - begin < batch ? count - begin : batch;
        code = make_rays(job, to, begin, here, error);
        if (!code)
            code = trace_rays(job, to, begin, here, error);
    }
    gw_frame_bind_rays(job);
    gw_gl_buffer_bind(&to->asked, GW_BINDING_ASKED);
    gw_gl_buffer_bind(&to->radiance, GW_BINDING_RADIANCE);
    return code || job->bounce == job->bounces ? code : gw_renderer_clear_totals(renderer, error);
}
