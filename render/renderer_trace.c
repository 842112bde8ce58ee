/* Rays for oracles and benches: the octree's traversal, or every triangle with the same test. */
#include "render/renderer_internal.h"

#include "base/clock.h"

/* Triangles per brute-force dispatch: its loop is uniform, so this is all a group of lanes iterates. */
enum { BRUTE_FORCE_RANGE = 32768 };

_Static_assert(sizeof(gw_ray) == 32 && sizeof(gw_hit) == 8, "as trace/rays.comp reads and writes them");

static gw_kernel_key ray_key(const gw_renderer *renderer) {
    return (gw_kernel_key){.features = (renderer->scene_features | renderer->forced_features) &
                                       (GW_FEATURE_WIDE_NODES | GW_FEATURE_DENSE_LEAVES),
                           .depth = renderer->octree->depth,
                           .loop_budget = renderer->loop_budget,
                           .count = renderer->count};
}

/* What one call of gw_renderer_trace or gw_renderer_trace_variant does. */
typedef struct trace_job {
    gw_trace_method method;
    const gw_trace_variant *variant; /* not of GW_TRACE_BRUTE_FORCE */
    gw_counters counters;
    gw_trace_time time;
} trace_job;

/* A round over all rays, then rounds over those that were suspended. */
static gw_code trace_octree(gw_renderer *renderer, trace_job *job, size_t count, gw_error *error) {
    const gw_trace_variant *variant = job->variant;
    gw_kernel_key key = ray_key(renderer);
    key.count = key.count || variant->count;
    key.any_hit = job->method == GW_TRACE_ANY;
    key.root_grid = variant->kernel ? 0 : renderer->buffers.root_grid_level;
    const char *name = variant->kernel ? variant->kernel : "trace/rays.comp";
    uint32_t length = (uint32_t)count;
    gw_code code = GW_OK;
    for (int to = 1; !code && length > 0; to = 1 - to) {
        GLuint kernel;
        uint32_t totals[GW_TOTAL_WORDS];
        gw_gl_buffer_bind(&renderer->rays.queues[1 - to], GW_BINDING_QUEUE);
        gw_gl_buffer_bind(&renderer->rays.queues[to], GW_BINDING_NEXT_QUEUE);
        code = gw_renderer_kernel(renderer, name, &key, variant->defines, &kernel, error);
        if (!code)
            code = gw_renderer_clear_totals(renderer, error);
        if (!code) {
            glProgramUniform1ui(kernel, 0, length);
            code = gw_gl_dispatch(renderer->device, kernel, (length + 63) / 64, error);
        }
        if (!code)
            code = gw_renderer_read_totals(renderer, totals, error);
        if (!code) {
            length = totals[2];
            job->counters.step_cap_hits += totals[0];
            job->counters.resumed += length;
        }
        key.resume = 1;
    }
    return code;
}

static gw_code trace_brute_force(gw_renderer *renderer, size_t count, gw_error *error) {
    gw_kernel_key key = {.depth = renderer->octree->depth, .loop_budget = renderer->loop_budget};
    GLuint kernel;
    gw_code code = gw_renderer_kernel(renderer, "trace/brute_force.comp", &key, NULL, &kernel, error);
    for (uint32_t begin = 0; !code && begin < renderer->scene->triangle_count; begin += BRUTE_FORCE_RANGE) {
        uint32_t left = renderer->scene->triangle_count - begin;
        glProgramUniform1ui(kernel, 0, (GLuint)count);
        glProgramUniform2ui(kernel, 1, begin, begin + (left < BRUTE_FORCE_RANGE ? left : BRUTE_FORCE_RANGE));
        code = gw_gl_dispatch(renderer->device, kernel, (count + 63) / 64, error);
        /* One short dispatch after another, so that software GL answers in between. */
        if (!code)
            code = gw_gl_finish(renderer->device, error);
    }
    return code;
}

static gw_code trace_chunk(gw_renderer *renderer, trace_job *job, const gw_ray *rays, size_t count,
                           gw_hit *hits, gw_error *error) {
    gw_gl_buffer *given = &renderer->given_rays, *found = &renderer->found_hits;
    int work = job->method != GW_TRACE_BRUTE_FORCE && (renderer->count || job->variant->count);
    gw_code code = gw_renderer_grow(renderer, given, "rays", count * sizeof(gw_ray), error);
    if (!code)
        code = gw_renderer_grow(renderer, found, "hits", count * sizeof(gw_hit), error);
    if (!code)
        code = gw_gl_buffer_write(given, 0, count * sizeof(gw_ray), rays, error);
    if (!code)
        code = gw_renderer_reserve(renderer, count, 1, work, error);
    int64_t begin = gw_now_ns(), processor = gw_processor_ns();
    if (!code) {
        gw_gl_buffer_bind(given, GW_BINDING_FRAGMENTS);
        gw_gl_buffer_bind(found, GW_BINDING_STATUSES);
        code = job->method == GW_TRACE_BRUTE_FORCE ? trace_brute_force(renderer, count, error)
                                                   : trace_octree(renderer, job, count, error);
    }
    job->time.wall_ms += (double)(gw_now_ns() - begin) * 1e-6;
    job->time.processor_ms += (double)(gw_processor_ns() - processor) * 1e-6;
    if (!code && work)
        code = gw_ray_buffers_add_work(&renderer->rays, count, &job->counters, error);
    if (!code)
        code = gw_gl_buffer_read(found, 0, count * sizeof(gw_hit), hits, error);
    for (size_t i = 0; !code && i < count; ++i)
        if (hits[i].triangle != GW_NO_TRIANGLE)
            hits[i].triangle &= ~GW_HIT_BACK;
    return code;
}

static void bind_inputs(const gw_renderer *renderer, const gw_trace_variant *variant) {
    gw_scene_buffers_bind(&renderer->buffers, GW_FILTER_TRILINEAR);
    for (GLuint unit = 0; unit < GW_TRACE_TEXTURES; ++unit)
        if (variant->textures[unit])
            gw_gl_texture_bind(variant->textures[unit], unit);
    if (variant->storage) {
        gw_gl_buffer_bind(&renderer->buffers.nodes, GW_BINDING_NODES);
        gw_gl_buffer_bind(&renderer->buffers.references, GW_BINDING_REFERENCES);
        gw_gl_buffer_bind(&renderer->buffers.triangles, GW_BINDING_TRIANGLES);
    }
}

static gw_code run_job(gw_renderer *renderer, trace_job *job, const gw_ray *rays, size_t ray_count,
                       gw_hit *hits, gw_error *error) {
    job->counters.rays += ray_count;
    renderer->loop_iterations = 0;
    bind_inputs(renderer, job->variant);
    size_t chunk = gw_renderer_chunk_slots(renderer);
    for (size_t begin = 0; begin < ray_count; begin += chunk) {
        size_t count = ray_count - begin < chunk ? ray_count - begin : chunk;
        gw_code code = trace_chunk(renderer, job, rays + begin, count, hits + begin, error);
        if (code)
            return gw_context(error, "tracing %zu rays", ray_count);
    }
    job->counters.loop_iterations = renderer->loop_iterations;
    return GW_OK;
}

gw_code gw_renderer_trace(gw_renderer *renderer, gw_trace_method method, const gw_ray *rays, size_t ray_count,
                          gw_hit *hits, gw_counters *counters, gw_error *error) {
    static const gw_trace_variant shipped;
    trace_job job = {.method = method, .variant = &shipped};
    gw_code code = run_job(renderer, &job, rays, ray_count, hits, error);
    if (counters)
        gw_counters_add(counters, &job.counters);
    return code;
}

gw_code gw_renderer_trace_variant(gw_renderer *renderer, const gw_trace_variant *variant, const gw_ray *rays,
                                  size_t ray_count, gw_hit *hits, gw_counters *counters, gw_trace_time *time,
                                  gw_error *error) {
    trace_job job = {.method = GW_TRACE_OCTREE, .variant = variant};
    gw_code code = run_job(renderer, &job, rays, ray_count, hits, error);
    if (counters)
        gw_counters_add(counters, &job.counters);
    *time = job.time;
    return code;
}
