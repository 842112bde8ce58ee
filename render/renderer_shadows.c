/* See renderer_internal.h: the shadow rays of what one dispatch has met. They are listed, one for each
 * fragment and light that face each other, and traced in batches, so that the state of those that are
 * suspended has bounded room. */
#include "render/renderer_internal.h"

#include <string.h>

void gw_shadow_buffers_finish(gw_shadow_buffers *buffers) {
    gw_gl_buffer *all[] = {&buffers->visibilities, &buffers->rays, &buffers->states, &buffers->queues[0],
                           &buffers->queues[1]};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
        gw_gl_buffer_finish(all[i]);
    memset(buffers, 0, sizeof *buffers);
}

uint64_t gw_shadow_buffers_bytes(const gw_shadow_buffers *buffers) {
    return buffers->visibilities.size + buffers->rays.size + buffers->states.size + buffers->queues[0].size +
           buffers->queues[1].size;
}

static uint32_t state_words(int tinted) {
    return tinted ? GW_STATE_WORDS + GW_TINT_STATE_WORDS : GW_STATE_WORDS;
}

uint64_t gw_shadow_ray_bytes(uint32_t fragments, uint32_t lights, int tinted) {
    const uint64_t colors = tinted ? (uint64_t)fragments + GW_KEPT_WORDS : 0;
    return ((uint64_t)fragments * 2 + GW_KEPT_WORDS + colors) * lights * sizeof(uint32_t) +
           (state_words(tinted) + 2) * sizeof(uint32_t);
}

/* words: visibilities, and behind them what is kept from round to round; as many for their colours. */
static gw_code reserve(const gw_frame_job *job, size_t places, size_t words, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_shadow_buffers *shadows = job->shadows;
    size_t batch = gw_renderer_chunk_slots(renderer);
    if (batch > places)
        batch = places;
    const int tinted = (job->key.features & GW_FEATURE_TRANSMISSION) != 0;
    gw_code code = gw_renderer_grow(renderer, &shadows->visibilities, "visibilities",
                                    (tinted ? 2 : 1) * words * sizeof(uint32_t), error);
    if (!code)
        code = gw_renderer_grow(renderer, &shadows->rays, "shadow rays", places * sizeof(uint32_t), error);
    if (!code)
        code = gw_renderer_grow(renderer, &shadows->states, "shadow ray states",
                                batch * state_words(tinted) * sizeof(uint32_t), error);
    for (int i = 0; !code && i < 2; ++i)
        code = gw_renderer_grow(renderer, &shadows->queues[i], "shadow ray queue", batch * sizeof(uint32_t),
                                error);
    if (!code) {
        gw_gl_buffer_bind(&shadows->visibilities, GW_BINDING_VISIBILITIES);
        gw_gl_buffer_bind(&shadows->rays, GW_BINDING_SHADOW_RAYS);
    }
    return code;
}

/* Kernels of shadow rays know nothing of what is lit. */
static gw_code kernel_of(const gw_frame_job *job, const char *name, gw_features features, int resume,
                         const char *more, GLuint *out, gw_error *error) {
    gw_kernel_key key = job->key;
    if ((key.features & GW_FEATURE_LOD) && !(features & GW_FEATURE_LOD)) {
        key.until_coarse = 1;
        key.level_blend = key.leaf_blend = 0;
    }
    key.features &= features;
    if (!(features & key.features & GW_FEATURE_ALPHA))
        key.features &= ~(GW_FEATURE_TEXTURES | GW_FEATURE_VERTEX_COLORS);
    if (!(key.features & GW_FEATURE_TEXTURES))
        key.texture_classes = 0;
    key.voxel_emission = 0;
    key.debug = GW_DEBUG_NONE;
    key.guides = 0;
    key.resume = resume;
    const int walks = (features & GW_FEATURE_WIDE_NODES) != 0;
    if (walks && !key.voxels_only)
        key.root_grid = job->renderer->buffers.root_grid_level;
    gw_code code = gw_renderer_kernel(job->renderer, name, &key, more, out, error);
    if (!code && key.texture_classes > 0) {
        const uint32_t *side = job->renderer->buffers.textures.side;
        glProgramUniform4f(*out, 1, (float)side[0], (float)side[1], (float)side[2], (float)side[3]);
    }
    return code;
}

/* Whether rays that may meet voxels are traced apart from those that meet triangles only. What lets light
 * through is composited along every ray in one and the same way. */
static int coarse_apart(const gw_frame_job *job) {
    return (job->key.features & GW_FEATURE_LOD) && !job->key.voxels_only && !job->renderer->one_kernel &&
           !(job->key.features & (GW_FEATURE_ALPHA | GW_FEATURE_TRANSMISSION));
}

/* Rays listed, from the list's beginning, and from its end backwards. */
typedef struct ray_counts {
    uint32_t all, coarse;
} ray_counts;

static gw_code list_rays(gw_frame_job *job, size_t slots, int resume, uint32_t kept_begin, ray_counts *counts,
                         gw_error *error) {
    const gw_features features = GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_SPARSE |
                                 GW_FEATURE_SPOT_LIGHTS | GW_FEATURE_AREA_LIGHTS | GW_FEATURE_EMISSIVE_LIGHTS;
    uint32_t totals[GW_TOTAL_WORDS];
    GLuint program = 0;
    const char *more = coarse_apart(job) ? "#define COARSE_APART 1\n" : NULL;
    gw_code code = kernel_of(job, "shade/list_shadows.comp", features, resume, more, &program, error);
    if (!code && resume)
        glProgramUniform1ui(program, 0, (GLuint)slots);
    if (!code && (job->key.features & GW_FEATURE_LOD)) {
        glProgramUniform1ui(program, 3, kept_begin);
        glProgramUniform1ui(job->shade, 3, kept_begin);
    }
    if (!code)
        code = gw_frame_dispatch(job, program, slots, error);
    if (!code)
        code = gw_renderer_read_totals(job->renderer, totals, error);
    if (!code) {
        job->counters.step_cap_hits += totals[0];
        *counts = (ray_counts){totals[3], totals[GW_TOTAL_COARSE_SHADOWS]};
    }
    return code;
}

static gw_code trace_batch(gw_frame_job *job, gw_features lod, uint32_t begin, uint32_t count,
                           gw_error *error) {
    const gw_features features =
        lod | GW_FEATURE_GAZE | GW_FEATURE_SPARSE | GW_FEATURE_ALPHA | GW_FEATURE_TEXTURES |
        GW_FEATURE_VERTEX_COLORS | GW_FEATURE_WIDE_NODES | GW_FEATURE_TRANSMISSION | GW_FEATURE_ABSORPTION |
        GW_FEATURE_DENSE_LEAVES | GW_FEATURE_SPOT_LIGHTS | GW_FEATURE_AREA_LIGHTS |
        GW_FEATURE_EMISSIVE_LIGHTS | GW_FEATURE_TRANSMISSION_MAPS | GW_FEATURE_MAP_PLACEMENT;
    gw_renderer *renderer = job->renderer;
    gw_shadow_buffers *shadows = job->shadows;
    gw_code code = GW_OK;
    for (int round = 0; !code && count > 0; ++round) {
        uint32_t totals[GW_TOTAL_WORDS];
        GLuint program = 0;
        code = kernel_of(job, "trace/shadow.comp", features, round > 0, NULL, &program, error);
        if (!code)
            code = gw_renderer_clear_totals(renderer, error);
        if (code)
            return code;
        gw_gl_buffer_bind(&shadows->queues[round % 2], GW_BINDING_QUEUE);
        gw_gl_buffer_bind(&shadows->queues[1 - round % 2], GW_BINDING_NEXT_QUEUE);
        glProgramUniform1ui(program, 0, count);
        glProgramUniform1ui(program, 2, begin);
        code =
            gw_gl_dispatch(renderer->device, program, (count + GW_BLOCK_PIXELS - 1) / GW_BLOCK_PIXELS, error);
        if (!code)
            code = gw_renderer_read_totals(renderer, totals, error);
        if (!code) {
            job->counters.step_cap_hits += totals[0];
            job->counters.resumed += totals[2];
            count = totals[2];
        }
    }
    return code;
}

/* lod: 0 or GW_FEATURE_LOD, whether the rays may meet voxels. */
static gw_code trace_rays(gw_frame_job *job, gw_features lod, uint32_t begin, uint32_t count,
                          gw_error *error) {
    const uint32_t batch = (uint32_t)gw_renderer_chunk_slots(job->renderer);
    gw_code code = GW_OK;
    for (uint32_t done = 0; !code && done < count; done += batch)
        code = trace_batch(job, lod, begin + done, count - done < batch ? count - done : batch, error);
    return code;
}

gw_code gw_frame_shadows(gw_frame_job *job, size_t slots, int resume, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    const uint32_t lights = job->block.counts[1] + job->block.counts[2];
    if (!(job->key.features & GW_FEATURE_SHADOWS) || lights == 0)
        return GW_OK;
    const size_t slots_of_all = job->rays->slots,
                 places = slots_of_all * gw_kernel_fragments(&job->key) * lights;
    gw_code code = reserve(job, places, places + slots_of_all * lights * GW_KEPT_WORDS, error);
    ray_counts counts = {0, 0};
    if (!code)
        code = list_rays(job, slots, resume, (uint32_t)places, &counts, error);
    job->counters.shadow_rays += counts.all + counts.coarse;
    gw_gl_buffer_bind(&job->shadows->states, GW_BINDING_STATES);
    if (!code)
        code = trace_rays(job, coarse_apart(job) ? 0 : GW_FEATURE_LOD, 0, counts.all, error);
    if (!code)
        code = trace_rays(job, GW_FEATURE_LOD, (uint32_t)places - counts.coarse, counts.coarse, error);
    gw_gl_buffer_bind(&job->rays->states, GW_BINDING_STATES);
    return code ? code : gw_renderer_clear_totals(renderer, error);
}
