/* See frame_state.h. */
#include "render/frame_state.h"

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
    state->geometry = (uint8_t)settings->geometry;
    state->level_blend = (uint8_t)settings->level_blend;
    state->leaf_blend = (uint8_t)settings->leaf_blend;
    state->texture_filter = (uint8_t)settings->texture_filter;
    state->sample_block = (uint8_t)settings->sample_block;
    state->samples = (uint8_t)settings->samples;
    state->triangle_precision = (uint8_t)settings->triangle_precision;
}
