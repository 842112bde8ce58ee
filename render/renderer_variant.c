/* Which kernels a frame is drawn with. Those of exactly what it calls for are best; while they are made in
 * the background, living ones that know more draw the same pixels, as effects that are forced in do. */
#include "render/renderer_internal.h"

#include <string.h>

static int shows_work(uint8_t debug) {
    return debug == GW_DEBUG_STEPS || debug == GW_DEBUG_LOADS || debug == GW_DEBUG_TESTS ||
           debug == GW_DEBUG_VOXELS;
}

gw_features gw_frame_calls_for(const gw_renderer *renderer, const gw_frame_state *state, uint32_t viewers) {
    /* Nothing covers light from everywhere where there is none, and nothing passes on what nothing sends. */
    const float *ambient = renderer->scene->ambient;
    const int dark = ambient[0] <= 0.0f && ambient[1] <= 0.0f && ambient[2] <= 0.0f &&
                     !(renderer->scene_features & GW_FEATURE_ENVIRONMENT);
    const int lit = !dark || (renderer->scene_features & (GW_FEATURE_SHADOWS | GW_FEATURE_EMISSIVE));
    return gw_features_of_frame(state, viewers, renderer->scene_features) &
           ~(dark ? GW_FEATURE_OCCLUSION : 0) & ~(lit ? 0 : GW_FEATURE_DIFFUSE);
}

gw_kernel_key gw_frame_key(const gw_renderer *renderer, const gw_frame_state *state, uint32_t viewers,
                           gw_features more) {
    gw_features features = (renderer->scene_features | renderer->forced_features | more |
                            gw_frame_calls_for(renderer, state, viewers)) &
                           ~renderer->forbidden_features;
    if (state->bounces == 0)
        features &= ~GW_SECONDARY_FEATURES;
    /* What lies at the border of a medium is decided where a ray meets it, as alpha is. */
    if (features & GW_FEATURE_TRANSMISSION)
        features |= GW_FEATURE_ALPHA;
    else
        features &= ~GW_FEATURE_ABSORPTION;
    int lod = (features & GW_FEATURE_LOD) != 0;
    return (gw_kernel_key){
        .features = features,
        .depth = renderer->octree->depth,
        .texture_classes = renderer->buffers.textures.class_count,
        .data_classes = renderer->buffers.data.class_count,
        .loop_budget = renderer->loop_budget,
        .debug = state->debug == GW_DEBUG_BOUNDS ? GW_DEBUG_NONE : state->debug,
        .check_fetches = state->debug == GW_DEBUG_BOUNDS,
        .voxels_only = lod && state->geometry == GW_GEOMETRY_VOXELS,
        .level_blend = lod && state->level_blend,
        .leaf_blend = lod && state->leaf_blend,
        .voxel_emission = lod && renderer->octree->emissions != NULL,
        .double_edges = state->triangle_precision == GW_PRECISION_DOUBLE,
        .ordered_edges = state->triangle_precision == GW_PRECISION_ORDERED,
        .count = renderer->count || shows_work(state->debug),
        .guides = (features & GW_FEATURE_SPARSE) && viewers > 0 && state->sample_block > 0 &&
                  state->reconstruction == GW_RECONSTRUCTION_EDGE_AWARE && state->gaze_rule == GW_GAZE_ACUITY,
        .gaze_seed = (features & (GW_FEATURE_GAZE | GW_FEATURE_SPARSE)) && viewers > 0 &&
                     state->gaze_rule == GW_GAZE_SEED};
}

/* What kernels may know beyond what a frame calls for and still stand in: effects of frames need nothing of
 * the scene on the GPU. Not accumulation, which draws still views only once. */
#define STAND_IN_FEATURES (GW_FRAME_FEATURES & ~GW_FEATURE_ACCUMULATE)

static gw_code hash_of(const gw_kernel_key *key, gw_hash *out, gw_error *error) {
    char defines[GW_KERNEL_DEFINES];
    gw_code code = gw_kernel_defines(key, defines, sizeof defines, error);
    if (!code)
        *out = gw_hash_bytes((gw_hash){0, 0}, defines, strlen(defines));
    return code;
}

/* Remembers a variant that the renderer draws with, in the place of one that lives no more. */
static void remember(gw_renderer *renderer, gw_hash hash, const gw_kernel_key *key) {
    gw_variant_drawn *free_place = NULL;
    for (size_t i = 0; i < GW_GL_VARIANTS; ++i) {
        gw_variant_drawn *drawn = &renderer->variants[i];
        if (gw_hash_equal(drawn->hash, hash))
            return;
        if (!free_place && !gw_gl_variant_lives(renderer->device, drawn->hash))
            free_place = drawn;
    }
    /* All eight live and this is none of them: it is about to take the place of one. */
    free_place = free_place ? free_place : &renderer->variants[0];
    *free_place = (gw_variant_drawn){hash, key->features, key->guides};
}

/* The living variant with the fewest effects that the frame does not call for; 0: there is none. */
static int find_stand_in(const gw_frame_job *job, gw_kernel_key *key, gw_hash *hash) {
    const gw_renderer *renderer = job->renderer;
    int best = GW_MOST_FEATURES;
    for (size_t i = 0; i < GW_GL_VARIANTS; ++i) {
        const gw_variant_drawn *drawn = &renderer->variants[i];
        const gw_features more = drawn->features & ~job->key.features;
        const int count = __builtin_popcountll(more);
        gw_hash made;
        if (count >= best || (job->key.features & ~drawn->features) || (more & ~STAND_IN_FEATURES) ||
            !gw_gl_variant_lives(renderer->device, drawn->hash))
            continue;
        gw_kernel_key theirs = gw_frame_key(renderer, job->state, job->block.counts[0], more);
        theirs.guides |= drawn->guides; /* which nobody reads where no pixels share a ray */
        if (hash_of(&theirs, &made, NULL) || !gw_hash_equal(made, drawn->hash))
            continue;
        best = count;
        *key = theirs;
        *hash = made;
    }
    return best < GW_MOST_FEATURES;
}

int gw_makes_in_background(const gw_renderer *renderer) {
    return !renderer->moving &&
           (renderer->kernels == GW_KERNELS_BACKGROUND ||
            (renderer->kernels == GW_KERNELS_AUTO && !gw_gl_limits_of(renderer->device)->software));
}

/* The most that one kind of rays may need: to find their ends and to light them, and both once more for those
 * that are suspended; shadow rays that may meet voxels apart from the others. */
static uint32_t most_of_rays(gw_features features) {
    return 4u + (features & GW_FEATURE_SHADOWS ? 6u : 0u) + (features & GW_SECONDARY_FEATURES ? 3u : 0u);
}

/* The most kernels that the frame may need, for progress. */
static uint32_t most_kernels(const gw_frame_job *job) {
    const gw_features features = job->key.features;
    const uint32_t rates = job->block.counts[0] > 0 ? job->block.sampling[1] : 0;
    uint32_t most = most_of_rays(features);
    if (features & GW_SECONDARY_FEATURES)
        most += most_of_rays(features);
    if (features & GW_FEATURE_SPARSE) /* lists of samples; pixels that have their own, or share a rate's */
        most += 7 + (rates > 0 ? 1 + 3 * rates : 0);
    return most + (features & GW_FEATURE_ACCUMULATE ? 1 : 0);
}

gw_code gw_frame_own_kernels(const gw_frame_job *job, gw_error *error) {
    gw_hash hash;
    gw_code code = hash_of(&job->key, &hash, error);
    if (!code)
        gw_gl_variant_begin(job->renderer->device, hash);
    return code;
}

gw_code gw_frame_choose_kernels(gw_frame_job *job, const gw_similarity *placement, const gw_plane *plane,
                                gw_error *error) {
    gw_renderer *renderer = job->renderer;
    gw_hash hash, other;
    gw_kernel_key key;
    gw_code code = hash_of(&job->key, &hash, error);
    if (!code)
        code = gw_background_take(renderer, error);
    if (!code && gw_makes_in_background(renderer) && !gw_gl_variant_lives(renderer->device, hash) &&
        find_stand_in(job, &key, &other) && gw_background_make(job, placement, plane, hash)) {
        renderer->stood_in++;
        job->key = key;
        hash = other;
    }
    if (code)
        return code;
    const int lives = gw_gl_variant_lives(renderer->device, hash);
    remember(renderer, hash, &job->key);
    gw_gl_variant_begin(renderer->device, hash);
    if (!lives)
        gw_gl_expect_programs(renderer->device, most_kernels(job));
    return GW_OK;
}
