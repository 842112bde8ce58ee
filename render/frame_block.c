/* See frame_block.h. Angles survive the similarity from wall to rebased space, so gaze is computed there. */
#include "render/frame_block.h"

#include "base/portable_math.h"
#include "render/vector3.h"

#include <math.h>
#include <string.h>

_Static_assert(sizeof(gw_frame_block) == 16 * (42 + 4 * GW_MAXIMUM_VIEWERS), "std140 rows without holes");

/* Smallest resolvable period at the centre of gaze, degrees (60 cycles per degree would be 1/60; 1/48 is the
 * value of Guenter et al., Foveated 3D Graphics, 2012). */
static const double smallest_period = 1.0 / 48.0;

typedef struct ray_space {
    const gw_similarity *placement;
    double scale; /* rebased units times ray scale per wall mm */
} ray_space;

static int finite3(const double v[3]) {
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* A direction of wall space in rebased axes. */
static void turn(const gw_similarity *placement, const double wall[3], double out[3]) {
    for (int j = 0; j < 3; ++j)
        out[j] = placement->rotation[0][j] * wall[0] + placement->rotation[1][j] * wall[1] +
                 placement->rotation[2][j] * wall[2];
}

static void to_ray_units(const ray_space *space, const double wall[3], float out[4]) {
    double turned[3];
    turn(space->placement, wall, turned);
    for (int j = 0; j < 3; ++j)
        out[j] = (float)(turned[j] * space->scale);
}

static float widened(float half_angle, const gw_frame_state *state, float age) {
    double growth = (double)state->gaze_growth * fmax((double)age - (double)state->gaze_latency, 0.0);
    return (float)(fmin(fmax((double)half_angle, 0.0), 180.0) +
                   fmin(growth, (double)state->gaze_growth_limit));
}

/* 0 when the gaze cannot be used. */
static int fill_viewer(const ray_space *space, const double eye[3], const gw_gaze *gaze,
                       const gw_frame_state *state, gw_viewer *out) {
    double offset[3], forward[3], up[3], right[3];
    for (int i = 0; i < 3; ++i) {
        offset[i] = (double)gaze->eye[i] - eye[i];
        forward[i] = (double)gaze->direction[i];
        up[i] = (double)gaze->up[i];
    }
    if (!finite3(offset) || !finite3(forward) || !gw_normalise(forward, 1e-12) ||
        !isfinite(gaze->half_width) || !isfinite(gaze->half_height) || !isfinite(gaze->age) ||
        !(gaze->confidence > 0.0f))
        return 0;
    gw_cross(forward, up, right);
    if (!finite3(up) || !gw_normalise(right, 1e-12)) {
        /* No usable up: the ellipse is oriented by the axis farthest from the gaze. */
        int axis = fabs(forward[1]) < 0.9 ? 1 : 0;
        const double fallback[3] = {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, 0.0};
        gw_cross(forward, fallback, right);
        if (!gw_normalise(right, 1e-12))
            return 0;
    }
    gw_cross(right, forward, up);
    const ray_space axes = {space->placement, 1.0};
    to_ray_units(space, offset, out->eye);
    to_ray_units(&axes, right, out->right);
    to_ray_units(&axes, up, out->up);
    to_ray_units(&axes, forward, out->forward);
    out->eye[3] = widened(gaze->half_width, state, gaze->age);
    out->right[3] = widened(gaze->half_height, state, gaze->age);
    const double steepest = 89.0; /* deg: an ellipse needs less than a right angle */
    out->up[3] = (float)tan(fmin(fmax((double)out->eye[3], 1e-3), steepest) * (GW_PI / 180.0));
    out->forward[3] = (float)tan(fmin(fmax((double)out->right[3], 1e-3), steepest) * (GW_PI / 180.0));
    return 1;
}

static gw_code check(const gw_plane *plane, const gw_frame_state *state, gw_error *error) {
    if (!finite3(state->eye))
        return gw_fail(error, GW_BAD_INPUT, "frame %u: the eye (%g, %g, %g) is not finite", state->frame,
                       state->eye[0], state->eye[1], state->eye[2]);
    if (!finite3(plane->corner) || !finite3(plane->step_x) || !finite3(plane->step_y))
        return gw_fail(error, GW_BAD_INPUT, "frame %u: the plane's corner or steps are not finite",
                       state->frame);
    const float knobs[] = {state->tau,
                           state->tau_inside,
                           state->gaze_margin,
                           state->gaze_blend,
                           state->gaze_growth,
                           state->gaze_latency,
                           state->gaze_growth_limit,
                           state->acuity_slope,
                           state->voxel_slab,
                           state->voxel_flatness,
                           state->fold_agreement,
                           state->least_remainder,
                           state->separated_tau,
                           state->gaze_footprint,
                           state->edge_depth,
                           state->edge_normal,
                           state->shadow_tau,
                           state->seed_distance,
                           state->mirror_roughness,
                           state->least_throughput,
                           state->occlusion_distance};
    if (!(fabsf(state->exposure) <= 64.0f))
        return gw_fail(error, GW_BAD_INPUT,
                       "frame %u: exposure is %g; it must be a number from -64 to 64 stops", state->frame,
                       (double)state->exposure);
    for (size_t i = 0; i < sizeof knobs / sizeof knobs[0]; ++i)
        if (!isfinite(knobs[i]) || knobs[i] < 0.0f)
            return gw_fail(error, GW_BAD_INPUT,
                           "frame %u: accuracy knob %zu is %g; it must be a number of at least 0",
                           state->frame, i, (double)knobs[i]);
    return GW_OK;
}

/* Places of 2, 4, 8 and 16 rays in a pixel, 1/16 px from its centre: the standard patterns of Direct3D 11, in
 * which no two rays share a row or a column. */
static const int8_t places_of_samples[][16][2] = {
    {{0, 0}},
    {{4, 4}, {-4, -4}},
    {{-2, -6}, {6, -2}, {-6, 2}, {2, 6}},
    {{1, -3}, {-1, 3}, {5, 1}, {-3, -5}, {-5, 5}, {-7, -1}, {3, 7}, {7, -7}},
    {{1, 1},
     {-1, -3},
     {-3, 2},
     {4, -1},
     {-5, -2},
     {2, 5},
     {5, 3},
     {3, -5},
     {-2, 6},
     {0, -7},
     {-4, -6},
     {-6, 4},
     {-8, 0},
     {7, -4},
     {6, 7},
     {-7, -8}}};

/* x brought into [-1/2, 1/2) by whole numbers. */
static double wrapped(double x) {
    return x - floor(x + 0.5);
}

/* The cones' directions about a normal: the hemisphere is cut into parts that count alike - of light that is
 * the same from everywhere each brings as much, which on the disk below it are equal areas (Malley's method)
 * - one about the normal from 5 on, and a ring. The first sample has their middles, the others fill them
 * evenly. */
static void place_cones(const gw_frame_state *state, const double moved[2], gw_frame_block *block) {
    const uint32_t cones = state->cones < GW_MAXIMUM_CONES ? state->cones : GW_MAXIMUM_CONES;
    const uint32_t inner = cones == 1 || cones >= 5, ring = cones - inner;
    for (uint32_t i = 0; i < cones; ++i) {
        const int is_inner = inner && i == 0;
        const double part = (double)inner / cones;
        const double area =
            is_inner ? part * (moved[1] - floor(moved[1])) : part + (1 - part) * (0.5 + moved[1]);
        const double turn = is_inner ? moved[0] : (i - inner + 0.5 + moved[0]) / ring, radius = sqrt(area);
        block->cones[i][0] = (float)(radius * gw_cos(2 * GW_PI * turn));
        block->cones[i][1] = (float)(radius * gw_sin(2 * GW_PI * turn));
        block->cones[i][2] = (float)sqrt(fmax(1 - area, 0));
        block->cones[i][3] = 2.0f * state->occlusion_distance; /* the cube has side 2 */
    }
    block->sampling[2] = cones;
}

void gw_frame_block_set_sample(const gw_frame_state *state, uint32_t number, gw_frame_block *block) {
    /* Powers of 1 / g, g the positive root of g^3 = g + 1: multiples of them, modulo 1, fill the square
     * evenly however many are taken (Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
     */
    static const double strides[2] = {0.7548776662466927, 0.5698402909980532};
    const uint32_t log2_samples = state->samples < 4 ? state->samples : 4, samples = 1u << log2_samples;
    double moved[2];
    for (int axis = 0; axis < 2; ++axis) {
        moved[axis] = wrapped(strides[axis] * number);
        block->accumulation[axis] = (float)moved[axis];
    }
    place_cones(state, moved, block);
    block->accumulation[2] = (float)(1.0 / (number + 1));
    block->accumulation[3] = number > 0 ? 1.0f : 0.0f;
    for (uint32_t i = 0; i < samples; ++i)
        for (uint32_t axis = 0; axis < 2; ++axis)
            block->sample_places[i / 2][i % 2 * 2 + axis] =
                (float)wrapped(places_of_samples[log2_samples][i][axis] / 16.0 + moved[axis]);
    uint32_t log2_coarse = state->coarse_samples < 3 ? state->coarse_samples : 3, coarse = 1u << log2_coarse;
    for (uint32_t i = 0; i < coarse; ++i)
        for (uint32_t axis = 0; axis < 2; ++axis)
            block->coarse_places[i / 2][i % 2 * 2 + axis] =
                (float)wrapped(places_of_samples[log2_coarse][i][axis] / 16.0 + moved[axis]);
    block->sampling[0] = coarse;
    block->sampling[1] = state->sample_block < 4 ? state->sample_block : 4;
    block->counts[3] = samples;
    block->corner[3] = (float)sqrt(1.0 / samples);
}

static void fill_tone(const gw_frame_state *state, gw_frame_block *block) {
    const int shown = state->debug == GW_DEBUG_NONE; /* else colours are numbers */
    block->tone[0] = shown ? (float)gw_exp2((double)state->exposure) : 1.0f;
    block->tone[1] = shown && state->tone == GW_TONE_FILMIC ? 1.0f : 0.0f;
    block->tone[2] = shown && state->dither ? 1.0f : 0.0f;
}

static void fill_scene(const gw_scene *scene, const gw_octree *octree, gw_frame_block *block) {
    for (int i = 0; i < 3; ++i) {
        block->background[i] = scene->background[i];
        block->ambient[i] = scene->ambient[i];
    }
    block->eye[3] = (float)ldexp(1.0, scene->exponent);
    for (uint32_t level = 0; level < 16; ++level)
        block->level_begin[level / 4][level % 4] =
            level <= octree->depth ? octree->level_begin[level] : UINT32_MAX;
}

gw_code gw_frame_block_fill(const gw_scene *scene, const gw_octree *octree, const gw_similarity *placement,
                            const gw_plane *plane, const gw_frame_state *state, gw_frame_block *block,
                            uint32_t *dropped, gw_error *error) {
    gw_code code = check(plane, state, error);
    if (code)
        return code;
    memset(block, 0, sizeof *block);
    fill_scene(scene, octree, block);
    fill_tone(state, block);
    block->sampling[3] = GW_CONES_OCCLUDE | (state->diffuse_bounce ? GW_CONES_LIGHT : 0) |
                         (state->diffuse_bounce == GW_BOUNCE_ALL ? GW_CONES_ALL : 0);

    double eye[3], corner[3];
    gw_wall_to_rebased(placement, scene, state->eye, eye);
    for (int i = 0; i < 3; ++i) {
        block->eye[i] = (float)eye[i];
        corner[i] = plane->corner[i] - state->eye[i];
    }
    /* Powers of two scale exactly: rays then have the same bits whatever the wall's size against the scene's.
     */
    double per_mm = ldexp(1.0 / placement->scale, -scene->exponent);
    int distance = 0;
    double length = sqrt(gw_dot(corner, corner)) * per_mm;
    if (length > 0.0)
        frexp(length, &distance);
    const ray_space space = {placement, ldexp(per_mm, -distance)};
    to_ray_units(&space, corner, block->corner);
    to_ray_units(&space, plane->step_x, block->step_x);
    to_ray_units(&space, plane->step_y, block->step_y);

    block->step_x[3] = (float)(1.0 / (fmax((double)state->seed_distance, 1.0) * space.scale));
    block->accuracy[0] = state->tau;
    block->accuracy[1] = state->tau_inside;
    block->accuracy[2] = state->gaze_blend;
    block->accuracy[3] = state->gaze_margin;
    block->acuity[0] = state->acuity_slope;
    block->gazing[0] = state->gaze_footprint;
    block->gazing[1] = state->edge_depth;
    block->gazing[2] = (float)cos((double)state->edge_normal * (GW_PI / 180.0));
    block->gazing[3] = (float)cos((double)state->edge_normal * (GW_PI / 360.0));
    /* Divisors in the kernels; a state that somebody else made may hold anything. */
    block->acuity[2] = fmaxf(state->voxel_slab, 0.005f);
    block->acuity[3] = state->voxel_flatness;
    block->ambient[3] = state->fold_agreement;
    block->background[3] = state->least_remainder;
    block->step_y[3] = state->separated_tau;
    block->secondary[0] = state->shadow_tau;
    block->secondary[1] = state->mirror_roughness;
    block->secondary[2] = state->near_light;
    block->secondary[3] = state->least_throughput;
    block->acuity[1] = (float)smallest_period;
    gw_frame_block_set_sample(state, 0, block);
    uint32_t gazes = state->gaze_count < GW_MAXIMUM_VIEWERS ? state->gaze_count : GW_MAXIMUM_VIEWERS;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < gazes; ++i)
        kept += (uint32_t)fill_viewer(&space, state->eye, &state->gazes[i], state, &block->viewers[kept]);
    block->counts[0] = kept;
    if (dropped)
        *dropped += state->gaze_count - kept;
    return GW_OK;
}
