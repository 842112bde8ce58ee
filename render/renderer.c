/* See renderer.h. The life of a renderer and its buffers; frames are in renderer_frame.c, rays in
 * renderer_trace.c. */
#include "render/renderer_internal.h"

#include "base/memory.h"
#include "render/gloss.h"
#include "shaders/common/frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_LOOP_BUDGET = 4000, LEAST_LOOP_BUDGET = 32 };
enum { SOFTWARE_CHUNK = 1 << 17, DEVICE_CHUNK = 1 << 20 };

static uint32_t light_count(const gw_renderer *renderer) {
    return renderer->buffers.list.directional + renderer->buffers.list.placed;
}

/* Visibilities of every fragment and light have bounded room as well. */
size_t gw_renderer_chunk_slots(const gw_renderer *renderer) {
    size_t slots = gw_gl_limits_of(renderer->device)->software ? SOFTWARE_CHUNK : DEVICE_CHUNK;
    size_t lights = light_count(renderer);
    if ((renderer->scene_features & GW_FEATURE_SHADOWS) && lights > GW_CHUNK_LIGHTS)
        slots = (slots * GW_CHUNK_LIGHTS / lights / GW_BLOCK_PIXELS + 16) * GW_BLOCK_PIXELS;
    return slots;
}

gw_light_knobs gw_renderer_light_knobs(const gw_renderer *renderer, const gw_frame_state *state) {
    const gw_features forbidden = renderer->forbidden_features;
    gw_light_knobs knobs = gw_light_knobs_of(state);
    /* They are there for their shadows. */
    if (forbidden & (GW_FEATURE_ENVIRONMENT | GW_FEATURE_SHADOWS | GW_FEATURE_DIRECTIONAL_LIGHTS))
        knobs.environment_lights = 0;
    if (forbidden & GW_FEATURE_AREA_LIGHTS)
        knobs.shadow_samples = 0;
    /* They have an extent, and are what is seen to shine. */
    if (forbidden & (GW_FEATURE_EMISSIVE_LIGHTS | GW_FEATURE_EMISSIVE | GW_FEATURE_AREA_LIGHTS))
        knobs.emissive_lights = 0;
    knobs.left_out = (forbidden & GW_FEATURE_DIRECTIONAL_LIGHTS ? GW_LIGHTS_DIRECTIONAL : 0) |
                     (forbidden & GW_FEATURE_POINT_LIGHTS ? GW_LIGHTS_POINT : 0) |
                     (forbidden & GW_FEATURE_SPOT_LIGHTS ? GW_LIGHTS_SPOT : 0);
    return knobs;
}

gw_code gw_renderer_take_features(gw_renderer *renderer, gw_error *error) {
    gw_features called_for =
        gw_features_of_scene(renderer->scene, renderer->octree, renderer->mirror_roughness);
    if (gw_calls_for_gloss(renderer->scene, renderer->buffers.smoothest, renderer->mirror_roughness,
                           renderer->glossy_roughness))
        called_for |= GW_FEATURE_GLOSSY;
    if (renderer->buffers.environment_count > 0)
        called_for |= GW_FEATURE_DIRECTIONAL_LIGHTS | GW_FEATURE_SHADOWS;
    if (renderer->buffers.list.wide)
        called_for |= GW_FEATURE_AREA_LIGHTS;
    if (renderer->buffers.list.ends)
        called_for |= GW_FEATURE_SPOT_LIGHTS;
    if (renderer->buffers.list.emissive > 0)
        called_for |= GW_FEATURE_EMISSIVE_LIGHTS | GW_FEATURE_SHADOWS;
    gw_features missing = called_for & renderer->forbidden_features & GW_NEEDED_FEATURES;
    renderer->scene_features = called_for & ~renderer->forbidden_features;
    for (size_t i = 0; i < gw_feature_count; ++i)
        if (missing & gw_feature_rows[i].bit)
            return gw_fail(error, GW_BAD_INPUT,
                           "the effect '%s' is forbidden, but this octree cannot be read without it",
                           gw_feature_rows[i].name);
    return GW_OK;
}

gw_code gw_renderer_make_own_buffers(gw_renderer *renderer, gw_error *error) {
    const size_t words = GW_TOTAL_WORDS + (size_t)renderer->scene->material_count;
    gw_code code = gw_gl_buffer_create(renderer->device, "totals", words * sizeof(uint32_t), NULL, 0,
                                       &renderer->totals, error);
    if (!code)
        code = gw_gl_buffer_create(renderer->device, "frame block", sizeof(gw_frame_block), NULL, 0,
                                   &renderer->frame, error);
    return code;
}

gw_code gw_renderer_create(gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                           const gw_renderer_options *options, gw_renderer **out, gw_error *error) {
    static const gw_renderer_options defaults;
    gw_settings settings;
    *out = NULL;
    if (!options)
        options = &defaults;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_renderer), "the renderer", error);
    if (code)
        return code;
    gw_renderer *renderer = memory;
    renderer->device = device;
    renderer->scene = renderer->still = scene;
    renderer->octree = octree;
    renderer->log = options->log;
    renderer->count = options->count;
    renderer->one_kernel = options->one_kernel;
    renderer->time_blending = options->time_blending;
    renderer->kernels = options->kernels;
    renderer->loop_budget = options->loop_budget ? options->loop_budget : DEFAULT_LOOP_BUDGET;
    if (renderer->loop_budget < LEAST_LOOP_BUDGET)
        renderer->loop_budget = LEAST_LOOP_BUDGET; /* a ray must get from the root to its cell and on */
    renderer->forced_features = options->force_features & ~options->forbid_features;
    renderer->forbidden_features = options->forbid_features;
    gw_settings_init(&settings);
    if (options->settings)
        settings = *options->settings;
    gw_frame_state state = {0};
    gw_frame_state_apply(&state, &settings);
    renderer->mirror_roughness = state.mirror_roughness;
    renderer->glossy_roughness = (float)state.glossy_roughness * (1.0f / 255.0f);
    renderer->light_knobs = gw_renderer_light_knobs(renderer, &state);
    if (!code && scene->animation && options->settings)
        code = gw_moving_create(device, scene, options->settings, options->log, &renderer->moving, error);
    if (!code)
        code = gw_scene_buffers_init(device, scene, octree,
                                     (renderer->forced_features & GW_EXTENSION_FEATURES) != 0,
                                     &renderer->light_knobs, &renderer->buffers, error);
    if (!code)
        code = gw_renderer_take_features(renderer, error);
    if (!code)
        code = gw_media_take(scene, &renderer->media, error);
    if (!code)
        code = gw_renderer_make_own_buffers(renderer, error);
    if (code) {
        gw_renderer_destroy(&renderer);
        return gw_context(error, "putting the scene on the GPU");
    }
    *out = renderer;
    return GW_OK;
}

void gw_ray_buffers_finish(gw_ray_buffers *buffers) {
    gw_gl_buffer *all[] = {&buffers->fragments, &buffers->statuses,  &buffers->states,
                           &buffers->queues[0], &buffers->queues[1], &buffers->work,
                           &buffers->sums,      &buffers->pixels,    &buffers->media};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
        gw_gl_buffer_finish(all[i]);
    memset(buffers, 0, sizeof *buffers);
}

void gw_renderer_destroy(gw_renderer **renderer) {
    if (!renderer || !*renderer)
        return;
    gw_renderer *r = *renderer;
    gw_background_stop(&r->background);
    gw_renderer_finish_buffers(r);
    gw_scene_buffers_finish(&r->buffers);
    gw_media_finish(&r->media);
    gw_moving_destroy(&r->moving);
    free(r->host_pixels);
    free(r);
    *renderer = NULL;
}

void gw_renderer_finish_buffers(gw_renderer *r) {
    gw_ray_buffers_finish(&r->rays);
    gw_shadow_buffers_finish(&r->shadows);
    for (size_t i = 0; i <= GW_MOST_BOUNCES; ++i)
        gw_secondary_buffers_finish(&r->secondary[i]);
    gw_gl_buffer_finish(&r->totals);
    gw_gl_buffer_finish(&r->out_of_range);
    gw_gl_buffer_finish(&r->luminances);
    gw_gl_buffer_finish(&r->frame);
    gw_gl_buffer_finish(&r->given_rays);
    gw_gl_buffer_finish(&r->found_hits);
    gw_sample_buffers_finish(&r->samples);
    gw_accumulation_finish(&r->accumulation);
    gw_accumulation_finish(&r->other_accumulation);
}

/* Buffers that have room for every ray of a chunk, but for its fragments. */
static const struct {
    const char *name;
    size_t offset; /* in gw_ray_buffers */
    size_t bytes;  /* a ray */
    int counting;  /* exists only if work is counted */
    int picture;   /* exists only for rays of pixels */
    int media;     /* exists only if light passes through something */
} ray_rows[] = {
    {"ray statuses", offsetof(gw_ray_buffers, statuses), 8, 0, 0, 0},
    {"ray states", offsetof(gw_ray_buffers, states), GW_STATE_WORDS * sizeof(uint32_t), 0, 0, 0},
    {"ray queue", offsetof(gw_ray_buffers, queues[0]), 4, 0, 0, 0},
    {"next ray queue", offsetof(gw_ray_buffers, queues[1]), 4, 0, 0, 0},
    {"radiance sums", offsetof(gw_ray_buffers, sums), 16, 0, 1, 0},
    {"pixels", offsetof(gw_ray_buffers, pixels), 4, 0, 1, 0},
    {"counted work", offsetof(gw_ray_buffers, work), 16, 1, 0, 0},
    {"media of rays", offsetof(gw_ray_buffers, media), 8, 0, 0, 1},
};

static int has_media(const gw_renderer *renderer) {
    return ((renderer->scene_features | renderer->forced_features) & GW_FEATURE_TRANSMISSION) != 0;
}

static uint64_t bytes_of_ray(const gw_renderer *renderer, uint32_t fragments, int picture) {
    uint64_t bytes = fragments * (uint64_t)GW_FRAGMENT_WORDS * sizeof(uint32_t);
    for (size_t i = 0; i < sizeof ray_rows / sizeof ray_rows[0]; ++i)
        if ((!ray_rows[i].counting || renderer->count) && (!ray_rows[i].picture || picture) &&
            (!ray_rows[i].media || has_media(renderer)))
            bytes += ray_rows[i].bytes;
    return bytes;
}

/* Rays of every bounce have buffers of their own. */
void gw_renderer_ray_memory(const gw_renderer *renderer, const gw_settings *settings, uint64_t *bytes,
                            uint64_t *rays, uint64_t *lists) {
    const gw_kernel_key key = {.features = GW_FEATURE_LOD};
    const uint32_t fragments = gw_kernel_fragments(&key);
    gw_frame_state state = {0};
    gw_frame_state_apply(&state, settings);
    const gw_features asks = (renderer->scene_features | gw_frame_calls_for(renderer, &state, 0)) &
                             ~renderer->forbidden_features & GW_SECONDARY_FEATURES;
    const uint32_t bounces = asks ? state.bounces : 0;
    const uint64_t shadows = renderer->scene_features & GW_FEATURE_SHADOWS
                                 ? gw_shadow_ray_bytes(fragments, light_count(renderer), has_media(renderer))
                                 : 0;
    *bytes = bytes_of_ray(renderer, fragments, 1) + shadows;
    *bytes += bounces * (gw_secondary_ray_bytes(fragments, asks & GW_CONE_FEATURES ? state.cones : 0, asks) +
                         bytes_of_ray(renderer, fragments, 0) + shadows);
    *rays = gw_renderer_chunk_slots(renderer);
    *lists = (uint64_t)GW_MOST_SAMPLES * (GW_SAMPLE_BYTES + GW_SAMPLE_PIXEL_BYTES);
}

gw_code gw_renderer_grow(gw_renderer *renderer, gw_gl_buffer *buffer, const char *name, size_t size,
                         gw_error *error) {
    if (buffer->id && buffer->size >= size)
        return GW_OK;
    gw_gl_buffer_finish(buffer);
    return gw_gl_buffer_create(renderer->device, name, size, NULL, 0, buffer, error);
}

static gw_code create_ray_buffers(gw_renderer *renderer, gw_ray_buffers *rays, size_t slots,
                                  size_t fragment_words, int work, gw_error *error) {
    const int picture = rays == &renderer->rays;
    gw_code code = gw_gl_buffer_create(renderer->device, "fragments", fragment_words * sizeof(uint32_t), NULL,
                                       0, &rays->fragments, error);
    for (size_t i = 0; !code && i < sizeof ray_rows / sizeof ray_rows[0]; ++i) {
        const int exists = (!ray_rows[i].counting || work) && (!ray_rows[i].picture || picture) &&
                           (!ray_rows[i].media || has_media(renderer));
        code =
            gw_gl_buffer_create(renderer->device, ray_rows[i].name, exists ? slots * ray_rows[i].bytes : 0,
                                NULL, 0, (gw_gl_buffer *)(void *)((char *)rays + ray_rows[i].offset), error);
    }
    if (code)
        return code;
    rays->slots = slots;
    rays->fragment_words = fragment_words;
    rays->has_work = work;
    return GW_OK;
}

gw_code gw_ray_buffers_reserve(gw_renderer *renderer, gw_ray_buffers *rays, size_t slots, uint32_t fragments,
                               int work, gw_error *error) {
    size_t words = slots * fragments * GW_FRAGMENT_WORDS;
    if (slots <= rays->slots && words <= rays->fragment_words && (!work || rays->has_work))
        return GW_OK;
    size_t more_slots = slots > rays->slots ? slots : rays->slots;
    size_t more_words = words > rays->fragment_words ? words : rays->fragment_words;
    int more_work = work || rays->has_work;
    gw_ray_buffers_finish(rays);
    gw_code code = create_ray_buffers(renderer, rays, more_slots, more_words, more_work, error);
    if (code)
        gw_ray_buffers_finish(rays);
    return code;
}

void gw_ray_buffers_bind(const gw_ray_buffers *rays) {
    gw_gl_buffer_bind(&rays->fragments, GW_BINDING_FRAGMENTS);
    gw_gl_buffer_bind(&rays->statuses, GW_BINDING_STATUSES);
    gw_gl_buffer_bind(&rays->states, GW_BINDING_STATES);
    gw_gl_buffer_bind(&rays->queues[0], GW_BINDING_QUEUE);
    gw_gl_buffer_bind(&rays->queues[1], GW_BINDING_NEXT_QUEUE);
    gw_gl_buffer_bind(&rays->work, GW_BINDING_WORK);
    if (rays->media.id)
        gw_gl_buffer_bind(&rays->media, GW_BINDING_MEDIA);
}

uint64_t gw_ray_buffers_bytes(const gw_ray_buffers *rays) {
    uint64_t bytes = rays->fragments.size;
    for (size_t i = 0; i < sizeof ray_rows / sizeof ray_rows[0]; ++i)
        bytes += ((const gw_gl_buffer *)(const void *)((const char *)rays + ray_rows[i].offset))->size;
    return bytes;
}

gw_code gw_renderer_reserve(gw_renderer *renderer, size_t slots, uint32_t fragments, int work,
                            gw_error *error) {
    gw_ray_buffers *rays = &renderer->rays;
    gw_code code = gw_ray_buffers_reserve(renderer, rays, slots, fragments, work, error);
    if (code)
        return code;
    gw_ray_buffers_bind(rays);
    gw_gl_buffer_bind(&renderer->totals, GW_BINDING_TOTALS);
    gw_gl_buffer_bind(&rays->sums, GW_BINDING_SUMS);
    gw_gl_buffer_bind(&rays->pixels, GW_BINDING_PIXELS);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, renderer->frame.id);
    return GW_OK;
}

gw_code gw_renderer_clear_totals(gw_renderer *renderer, gw_error *error) {
    static const uint32_t zeros[GW_TOTAL_WORDS];
    return gw_gl_buffer_write(&renderer->totals, 0, sizeof zeros, zeros, error);
}

gw_code gw_renderer_read_totals(gw_renderer *renderer, uint32_t totals[GW_TOTAL_WORDS], gw_error *error) {
    gw_code code = gw_gl_buffer_read(&renderer->totals, 0, GW_TOTAL_WORDS * sizeof(uint32_t), totals, error);
    if (!code && totals[GW_TOTAL_ITERATIONS] > renderer->loop_iterations)
        renderer->loop_iterations = totals[GW_TOTAL_ITERATIONS];
    return code;
}

gw_code gw_ray_buffers_add_work(const gw_ray_buffers *rays, size_t slots, gw_counters *counters,
                                gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, slots, 4 * sizeof(uint32_t), "counted work", error);
    if (!code)
        code = gw_gl_buffer_read(&rays->work, 0, slots * 4 * sizeof(uint32_t), memory, error);
    const uint32_t(*work)[4] = memory;
    for (size_t i = 0; !code && i < slots; ++i) {
        counters->steps += work[i][0];
        counters->node_loads += work[i][1];
        counters->triangle_tests += work[i][2];
        counters->voxels += work[i][3];
        counters->voxel_rays += work[i][3] > 0;
    }
    free(memory);
    return code;
}

gw_code gw_renderer_kernel(gw_renderer *renderer, const char *name, const gw_kernel_key *key,
                           const char *more_defines, GLuint *out, gw_error *error) {
    char defines[GW_KERNEL_DEFINES];
    gw_code code = gw_kernel_defines(key, defines, sizeof defines, error);
    size_t used = code ? 0 : strlen(defines);
    if (!code && more_defines &&
        snprintf(defines + used, sizeof defines - used, "%s", more_defines) >= (int)(sizeof defines - used))
        code =
            gw_fail(error, GW_MACHINE, "the defines of '%s' need more than %zu bytes", name, sizeof defines);
    if (!code)
        code = gw_gl_program(renderer->device, name, defines, out, error);
    return code;
}

gw_renderer_parts gw_renderer_parts_of(const gw_renderer *renderer) {
    const gw_scene_buffers *scene = &renderer->buffers;
    uint64_t secondary = 0;
    for (size_t i = 0; i <= GW_MOST_BOUNCES; ++i)
        secondary += gw_secondary_buffers_bytes(&renderer->secondary[i]);
    return (gw_renderer_parts){
        .nodes = scene->nodes.size,
        .references = scene->references.size + scene->boxes.size,
        .voxels = scene->payloads.size + scene->emissions.size,
        .triangles = scene->triangles.size,
        .attributes = scene->faces.size + scene->vertices.size + scene->materials.size + scene->lights.size,
        .textures = scene->textures.bytes + scene->data.bytes + scene->environment.bytes,
        .rays = renderer->totals.size + renderer->luminances.size + renderer->frame.size +
                renderer->given_rays.size + renderer->found_hits.size +
                gw_ray_buffers_bytes(&renderer->rays) + gw_sample_buffers_bytes(&renderer->samples) +
                gw_accumulation_bytes(&renderer->accumulation) +
                gw_accumulation_bytes(&renderer->other_accumulation) +
                gw_shadow_buffers_bytes(&renderer->shadows) + secondary};
}

uint64_t gw_renderer_bytes(const gw_renderer *renderer) {
    const gw_renderer_parts p = gw_renderer_parts_of(renderer);
    return p.nodes + p.references + p.voxels + p.triangles + p.attributes + p.textures + p.rays;
}

void gw_counters_add(gw_counters *to, const gw_counters *from) {
    to->rays += from->rays;
    to->steps += from->steps;
    to->node_loads += from->node_loads;
    to->triangle_tests += from->triangle_tests;
    to->voxels += from->voxels;
    to->voxel_rays += from->voxel_rays;
    to->step_cap_hits += from->step_cap_hits;
    to->nan_pixels += from->nan_pixels;
    to->mirror_rays += from->mirror_rays;
    to->glossy_rays += from->glossy_rays;
    to->refracted_rays += from->refracted_rays;
    to->cone_rays += from->cone_rays;
    to->shadow_rays += from->shadow_rays;
    to->resumed += from->resumed;
    if (from->loop_iterations > to->loop_iterations)
        to->loop_iterations = from->loop_iterations;
    for (size_t i = 0; i < GW_MOST_FEATURES; ++i) {
        to->effects[i].frames += from->effects[i].frames;
        to->effects[i].idle += from->effects[i].idle;
        to->effects[i].met += from->effects[i].met;
    }
}
