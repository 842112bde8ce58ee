/* See renderer_internal.h: one batch of rays, traced and shaded, round after round until none is suspended.
 */
#include "render/renderer_internal.h"

/* Tracing knows nothing of what only shading needs, and the other way round, so that kernels are shared.
 *
 * Where voxels may be met, the first round walks through triangles only and suspends rays at their first
 * voxel; the others are done, and the large kernels see the compact queue of the rest. */
gw_code gw_frame_kernels(gw_frame_job *job, int resume, gw_error *error) {
    const gw_features walk_features = GW_FEATURE_WIDE_NODES | GW_FEATURE_DENSE_LEAVES;
    const gw_features trace_features = GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_ALPHA |
                                       GW_FEATURE_SPARSE | GW_FEATURE_TRANSMISSION | walk_features;
    gw_kernel_key trace = job->key, shade = job->key;
    if (!resume && (job->key.features & GW_FEATURE_LOD) && !job->key.voxels_only &&
        !job->renderer->one_kernel) {
        trace.features &= ~GW_FEATURE_LOD;
        trace.level_blend = trace.leaf_blend = 0;
        trace.until_coarse = shade.until_coarse = 1;
        shade.features &= ~GW_FEATURE_LOD;
        shade.voxel_emission = 0;
    }
    trace.features &= trace_features;
    trace.texture_classes = trace.data_classes = 0;
    trace.voxel_emission = 0;
    trace.debug = GW_DEBUG_NONE;
    trace.guides = 0;
    trace.resume = shade.resume = resume;
    if (!trace.voxels_only)
        trace.root_grid = job->renderer->buffers.root_grid_level;
    shade.features &= ~walk_features;
    if (shade.features & GW_FEATURE_SPARSE)
        shade.features &= ~(GW_FEATURE_ACCUMULATE | GW_TONE_FEATURES); /* pixels are made by shaders/blend */
    shade.loop_budget = 0;
    shade.voxels_only = shade.level_blend = shade.leaf_blend = 0;
    shade.double_edges = shade.ordered_edges = shade.check_fetches = 0;
    gw_code code = gw_renderer_kernel(job->renderer, "trace/primary.comp", &trace, NULL, &job->trace, error);
    if (!code)
        code = gw_renderer_kernel(job->renderer, "shade/shade.comp", &shade, NULL, &job->shade, error);
    if (!code && (job->key.features & GW_COLOR_PICTURE_FEATURES) && job->key.texture_classes > 0) {
        const uint32_t *side = job->renderer->buffers.textures.side;
        glProgramUniform4f(job->shade, 1, (float)side[0], (float)side[1], (float)side[2], (float)side[3]);
    }
    return code;
}

gw_code gw_frame_dispatch(gw_frame_job *job, GLuint program, size_t slots, gw_error *error) {
    gw_gl *device = job->renderer->device;
    if (job->arguments)
        return gw_gl_dispatch_indirect(device, program, job->arguments, job->argument_offset, error);
    return gw_gl_dispatch(device, program, (slots + GW_BLOCK_PIXELS - 1) / GW_BLOCK_PIXELS, error);
}

gw_code gw_frame_round(gw_frame_job *job, size_t slots, int resume, int from, gw_error *error) {
    gw_ray_buffers *rays = job->rays;
    gw_gl_buffer_bind(&rays->queues[from], GW_BINDING_QUEUE);
    gw_code code = gw_frame_dispatch(job, job->trace, slots, error);
    if (!code)
        code = gw_frame_secondary(job, slots, resume, error);
    gw_gl_buffer_bind(&rays->queues[from], GW_BINDING_QUEUE);
    if (!code)
        code = gw_frame_shadows(job, slots, resume, error);
    gw_gl_buffer_bind(&rays->queues[from], GW_BINDING_QUEUE);
    gw_gl_buffer_bind(&rays->queues[1 - from], GW_BINDING_NEXT_QUEUE);
    if (!code && resume) /* rays of another bounce may have used the same kernel */
        glProgramUniform1ui(job->shade, 0, (GLuint)slots);
    if (!code)
        code = gw_frame_dispatch(job, job->shade, slots, error);
    return code;
}

/* One round after another over the suspended rays. Each round takes every ray further, so it ends. */
gw_code gw_frame_resume(gw_frame_job *job, uint32_t queue_length, gw_error *error) {
    gw_code code = gw_frame_kernels(job, 1, error);
    job->arguments = NULL;
    for (int from = 1; !code && queue_length > 0; from = 1 - from) {
        uint32_t totals[GW_TOTAL_WORDS];
        job->counters.resumed += queue_length;
        glProgramUniform1ui(job->trace, 0, queue_length);
        code = gw_renderer_clear_totals(job->renderer, error);
        if (!code)
            code = gw_frame_round(job, queue_length, 1, from, error);
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
