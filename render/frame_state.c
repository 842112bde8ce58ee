/* See frame_state.h. */
#include "render/frame_state.h"

#include <math.h>

void gw_frame_state_apply(gw_frame_state *state, const gw_settings *settings) {
    state->tau = (float)settings->tau;
    state->tau_inside = (float)settings->tau_inside;
    state->gaze_margin = (float)settings->gaze_margin;
    state->gaze_blend = (float)settings->gaze_blend;
    state->gaze_growth = (float)settings->gaze_growth;
    state->gaze_latency = (float)settings->gaze_latency;
    state->gaze_growth_limit = (float)settings->gaze_growth_limit;
    state->acuity_slope = (float)settings->acuity_slope;
    state->voxel_slab = (float)settings->voxel_slab;
    state->voxel_flatness = (float)settings->voxel_flatness;
    state->fold_agreement = (float)settings->fold_agreement;
    state->least_remainder = (float)settings->least_remainder;
    state->separated_tau = (float)settings->separated_tau;
    state->gaze_footprint = (float)settings->gaze_footprint;
    state->shadow_tau = (float)settings->shadow_tau;
    state->seed_distance = (float)settings->seed_distance;
    state->mirror_roughness = (float)settings->mirror_roughness;
    state->least_throughput = (float)settings->least_throughput;
    state->glossy_roughness = (uint8_t)(255.0 * settings->glossy_roughness + 0.5);
    state->light_least = (uint16_t)(65535.0 * settings->light_least + 0.5);
    state->bounces = (uint8_t)settings->bounces;
    state->near_light = (uint8_t)settings->near_light;
    state->gaze_rule = (uint8_t)settings->gaze_rule;
    state->edge_depth = (float)settings->edge_depth;
    state->edge_normal = (float)settings->edge_normal;
    state->reconstruction = (uint8_t)settings->reconstruction;
    state->rate_blend = (uint8_t)settings->rate_blend;
    state->geometry = (uint8_t)settings->geometry;
    state->level_blend = (uint8_t)settings->level_blend;
    state->leaf_blend = (uint8_t)settings->leaf_blend;
    state->texture_filter = (uint8_t)settings->texture_filter;
    state->sample_block = (uint8_t)settings->sample_block;
    state->samples = (uint8_t)settings->samples;
    state->coarse_samples = (uint8_t)settings->coarse_samples;
    state->triangle_precision = (uint8_t)settings->triangle_precision;
    state->shadow_samples = (uint8_t)settings->shadow_samples;
    state->environment_lights = (uint8_t)settings->environment_lights;
    state->emissive_lights = (uint8_t)settings->emissive_lights;
    state->emissive_least = (float)settings->emissive_least;
    state->emissive_faintest = (float)settings->emissive_faintest;
    state->accumulate = (uint16_t)settings->accumulate;
    state->strain = (float)settings->strain;
    state->metering = settings->exposure == GW_SETTING_AUTO;
    state->exposure = state->metering ? 0.0f : (float)settings->exposure;
    state->tone = (uint8_t)settings->tone;
    state->dither = (uint8_t)settings->dither;
    static const uint8_t cones[] = {0, 1, 3, 5, GW_MAXIMUM_CONES};
    state->cones = cones[settings->occlusion_cones];
    state->occlusion_distance = (float)settings->occlusion_distance;
    state->diffuse_bounce = (uint8_t)settings->diffuse_bounce;
}

gw_frame_state gw_frame_state_in_force(const gw_frame_state *state) {
    enum { LARGEST_BLOCK = 4 };
    gw_frame_state drawn = *state;
    const float most = GW_MAXIMUM_STRAIN;
    const float strain = state->strain > 1.0f ? state->strain < most ? state->strain : most : 1.0f;
    drawn.strain = 1.0f;
    drawn.tau *= sqrtf(sqrtf(strain)); /* exactly rounded, so the same on every host */
    drawn.gaze_margin /= strain;
    drawn.acuity_slope *= strain;
    for (float q = 2.0f; q <= strain && drawn.sample_block < LARGEST_BLOCK; q *= 2.0f)
        drawn.sample_block++;
    return drawn;
}

gw_frame_state gw_frame_state_view(const gw_frame_state *state, int scene_moves) {
    gw_frame_state view = *state;
    view.frame = view.epoch = 0;
    view.accumulate = 0;
    view.exposure = 0.0f;
    view.tone = view.dither = view.metering = 0;
    if (!scene_moves)
        view.time = 0;
    for (uint32_t i = 0; i < GW_MAXIMUM_VIEWERS; ++i) {
        gw_gaze *gaze = &view.gazes[i];
        /* It widens the ellipse by nothing at first and by no more in the end (render/frame_block.c). */
        const double late = (double)gaze->age - (double)view.gaze_latency;
        if (late <= 0.0)
            gaze->age = 0.0f;
        else if ((double)view.gaze_growth * late >= (double)view.gaze_growth_limit)
            gaze->age = 1e9f;
        gaze->confidence = gaze->confidence > 0.0f ? 1.0f : 0.0f;
    }
    return view;
}
