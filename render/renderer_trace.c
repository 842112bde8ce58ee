/* Rays for oracles and benches: the octree's traversal, or every triangle with the same test. */
#include "render/renderer_internal.h"

/* Triangles per brute-force dispatch: its loop is uniform, so this is all a group of lanes iterates. */
enum { BRUTE_FORCE_RANGE = 32768 };

_Static_assert(sizeof(gw_ray) == 32 && sizeof(gw_hit) == 8, "as trace/rays.comp reads and writes them");

static gw_kernel_key ray_key(const gw_renderer *renderer) {
    return (gw_kernel_key){.features =
                               (renderer->scene_features | renderer->forced_features) & GW_FEATURE_WIDE_NODES,
                           .depth = renderer->octree->depth,
                           .loop_budget = renderer->loop_budget,
                           .count = renderer->count};
}

static gw_code trace_octree(gw_renderer *renderer, size_t count, gw_counters *counters, gw_error *error) {
    gw_kernel_key key = ray_key(renderer);
    uint32_t length = (uint32_t)count;
    gw_code code = GW_OK;
    /* A round over all rays, then rounds over those that were suspended. */
    for (int to = 1; !code && length > 0; to = 1 - to) {
        GLuint kernel;
        uint32_t totals[4];
        gw_gl_buffer_bind(&renderer->rays.queues[1 - to], GW_BINDING_QUEUE);
        gw_gl_buffer_bind(&renderer->rays.queues[to], GW_BINDING_NEXT_QUEUE);
        code = gw_renderer_kernel(renderer, "trace/rays.comp", &key, &kernel, error);
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
            counters->step_cap_hits += totals[0];
            counters->resumed += length;
        }
        key.resume = 1;
    }
    if (!code && key.count)
        code = gw_renderer_add_work(renderer, count, counters, error);
    return code;
}

static gw_code trace_brute_force(gw_renderer *renderer, size_t count, gw_error *error) {
    gw_kernel_key key = {.depth = renderer->octree->depth, .loop_budget = renderer->loop_budget};
    GLuint kernel;
    gw_code code = gw_renderer_kernel(renderer, "trace/brute_force.comp", &key, &kernel, error);
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

/* Makes the buffer at least that large; contents are lost when it grows. */
static gw_code grow_buffer(gw_renderer *renderer, gw_gl_buffer *buffer, const char *name, size_t size,
                           gw_error *error) {
    if (buffer->id && buffer->size >= size)
        return GW_OK;
    gw_gl_buffer_finish(buffer);
    return gw_gl_buffer_create(renderer->device, name, size, NULL, 0, buffer, error);
}

static gw_code trace_chunk(gw_renderer *renderer, gw_trace_method method, const gw_ray *rays, size_t count,
                           gw_hit *hits, gw_counters *counters, gw_error *error) {
    gw_gl_buffer *given = &renderer->given_rays, *found = &renderer->found_hits;
    gw_code code = grow_buffer(renderer, given, "rays", count * sizeof(gw_ray), error);
    if (!code)
        code = grow_buffer(renderer, found, "hits", count * sizeof(gw_hit), error);
    if (!code)
        code = gw_gl_buffer_write(given, 0, count * sizeof(gw_ray), rays, error);
    if (!code)
        code = gw_renderer_reserve(renderer, count, 1, renderer->count, error);
    if (!code) {
        gw_gl_buffer_bind(given, GW_BINDING_FRAGMENTS);
        gw_gl_buffer_bind(found, GW_BINDING_STATUSES);
        code = method == GW_TRACE_OCTREE ? trace_octree(renderer, count, counters, error)
                                         : trace_brute_force(renderer, count, error);
    }
    if (!code)
        code = gw_gl_buffer_read(found, 0, count * sizeof(gw_hit), hits, error);
    for (size_t i = 0; !code && i < count; ++i)
        if (hits[i].triangle != GW_NO_TRIANGLE)
            hits[i].triangle &= ~GW_HIT_BACK;
    return code;
}

gw_code gw_renderer_trace(gw_renderer *renderer, gw_trace_method method, const gw_ray *rays, size_t ray_count,
                          gw_hit *hits, gw_counters *counters, gw_error *error) {
    gw_counters own = {0};
    if (!counters)
        counters = &own;
    counters->rays += ray_count;
    gw_scene_buffers_bind(&renderer->buffers, GW_FILTER_TRILINEAR);
    size_t chunk = gw_renderer_chunk_slots(renderer);
    for (size_t begin = 0; begin < ray_count; begin += chunk) {
        size_t count = ray_count - begin < chunk ? ray_count - begin : chunk;
        gw_code code = trace_chunk(renderer, method, rays + begin, count, hits + begin, counters, error);
        if (code)
            return gw_context(error, "tracing %zu rays", ray_count);
    }
    return GW_OK;
}
