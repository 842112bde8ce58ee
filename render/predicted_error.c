/* See predicted_error.h. */
#include "render/predicted_error.h"

#include "render/sparse.h"

#include <math.h>

enum { BLOCK = 8, WIDEST = 4 };

static double least_spacing(const gw_frame_block *block, double x, double y) {
    static const double places[5][2] = {
        {0, 0}, {BLOCK, 0}, {0, BLOCK}, {BLOCK, BLOCK}, {BLOCK / 2, BLOCK / 2}};
    double least = INFINITY;
    for (int i = 0; i < 5; ++i)
        least = fmin(least, gw_sparse_spacing(block, x + places[i][0], y + places[i][1]));
    return least;
}

/* Pixels a side of the square that shares a ray at (x, y): the rule of shaders/sample/rates.comp. */
static double side_at(const gw_frame_block *block, uint32_t most, double x, double y) {
    const double first[2] = {floor(x / BLOCK) * BLOCK, floor(y / BLOCK) * BLOCK};
    double least = least_spacing(block, first[0], first[1]), side = 1;
    for (uint32_t i = 0; i < most && i + 1 < WIDEST; ++i)
        side = least >= 2 * side ? 2 * side : side;
    if (most < WIDEST || least < 2 * side)
        return side;
    for (int i = 0; i < 4; ++i)
        least = fmin(least, least_spacing(block, floor(x / (2 * BLOCK)) * (2 * BLOCK) + BLOCK * (i & 1),
                                          floor(y / (2 * BLOCK)) * (2 * BLOCK) + BLOCK * (i >> 1)));
    return least >= 2 * side ? 2 * side : side;
}

/* What is drawn at a place, in pixels: how far apart samples lie, and how wide a voxel may be. */
typedef struct drawn_at {
    double pitch, voxel;
} drawn_at;

static drawn_at by_acuity(const gw_frame_block *in_force, const gw_frame_state *drawn, double own, double x,
                          double y) {
    const double side = side_at(in_force, drawn->sample_block, x, y), pitch = side > 1 ? side : own;
    const double resolved = (double)in_force->gazing[0] * gw_sparse_spacing(in_force, x, y);
    return (drawn_at){pitch, gw_sparse_tau(in_force, x, y) * fmax(fmin(pitch, 1), resolved)};
}

/* Every pixel has its rays; where voxels have grown by half a level, pixels are blurred as far as at the next
 * rate (shaders/blend/fine_blocks.comp). */
static drawn_at by_seed(const gw_frame_block *in_force, const gw_frame_state *drawn, double own, double x,
                        double y) {
    const double distance = gw_sparse_seed_distance(in_force, x, y), grown = 1 + distance;
    const double blur = fmin(grown * grown / 2, 2); /* 1 at half a level, 2 at a whole one */
    const int blurred = drawn->rate_blend && drawn->sample_block > 0 && blur > 1;
    return (drawn_at){blurred ? blur : own, (double)in_force->accuracy[distance > 0 ? 0 : 1] * own * grown};
}

double gw_predicted_error_at(const gw_frame_block *given, const gw_frame_block *in_force,
                             const gw_frame_state *state, double least_cell, double x, double y) {
    const gw_frame_state drawn = gw_frame_state_in_force(state);
    const double own = sqrt(1.0 / in_force->counts[3]);
    double limit = 1;
    drawn_at here = {own, (double)in_force->accuracy[1] * own};
    if (given->counts[0] > 0) {
        limit = fmax(1, gw_sparse_spacing(given, x, y));
        here = drawn.gaze_rule == GW_GAZE_SEED ? by_seed(in_force, &drawn, own, x, y)
                                               : by_acuity(in_force, &drawn, own, x, y);
    }
    /* A leaf begins to be its voxel at half its side (docs/rendering.md, "Voxels for triangles"). */
    if (drawn.geometry == GW_GEOMETRY_TRIANGLES ||
        (drawn.geometry == GW_GEOMETRY_HYBRID &&
         2 * here.voxel * gw_sparse_widest_pixel(in_force, x, y) < least_cell))
        here.voxel = 0;
    return fmax(1, fmax(here.pitch, here.voxel) / limit);
}

/* Of the deepest level that has a node, rebased units. */
static double least_cell_of(const gw_octree *octree) {
    uint32_t level = octree->depth;
    while (level > 0 && octree->level_begin[level] == octree->level_begin[level + 1])
        --level;
    return ldexp(2, -(int)level);
}

/* First place of the lattice at or after a pixel. */
static int64_t first_place(int32_t pixel) {
    const int64_t half = GW_PREDICTION_STEP / 2, step = GW_PREDICTION_STEP;
    int64_t offset = (int64_t)pixel - half;
    return half + (offset >= 0 ? (offset + step - 1) / step : -(-offset / step)) * step;
}

gw_code gw_predict_error(const gw_scene *scene, const gw_octree *octree, const gw_similarity *placement,
                         const gw_plane *plane, const gw_rectangle *rectangle, const gw_frame_state *state,
                         gw_predicted_error *out, gw_error *error) {
    gw_frame_block given, in_force;
    gw_frame_state relaxed = *state;
    const gw_frame_state drawn = gw_frame_state_in_force(state);
    relaxed.strain = 1;
    gw_code code = gw_frame_block_fill(scene, octree, placement, plane, &relaxed, &given, NULL, error);
    if (!code)
        code = gw_frame_block_fill(scene, octree, placement, plane, &drawn, &in_force, NULL, error);
    if (code)
        return code;
    const double least = least_cell_of(octree);
    const int64_t end_x = (int64_t)rectangle->x + rectangle->width,
                  end_y = (int64_t)rectangle->y + rectangle->height;
    for (int64_t y = first_place(rectangle->y); y < end_y; y += GW_PREDICTION_STEP)
        for (int64_t x = first_place(rectangle->x); x < end_x; x += GW_PREDICTION_STEP) {
            const double here = gw_predicted_error_at(&given, &in_force, state, least, (double)x, (double)y);
            const gw_predicted_error one = {.worst = here, .sum = here, .places = 1};
            gw_predicted_error_add(out, &one);
        }
    return GW_OK;
}

void gw_predicted_error_add(gw_predicted_error *to, const gw_predicted_error *from) {
    to->worst = fmax(to->worst, from->worst);
    to->sum += from->sum;
    to->places += from->places;
}

double gw_predicted_error_worst(const gw_predicted_error *error) {
    return error->places ? error->worst : 1;
}

double gw_predicted_error_mean(const gw_predicted_error *error) {
    return error->places ? error->sum / (double)error->places : 1;
}
