/* See sparse.h. */
#include "render/sparse.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "render/vector3.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 8, GROUP = 64 };

void gw_sparse_finish(gw_sparse *sparse) {
    free(sparse->samples);
    free(sparse->blocks);
    *sparse = (gw_sparse){0};
}

static double along(const double point[3], const float axis[4]) {
    return point[0] * (double)axis[0] + point[1] * (double)axis[1] + point[2] * (double)axis[2];
}

/* Spacing of samples, ray units, that the viewer cannot tell apart at a point: acuity_of() of
 * shaders/trace/gaze.glsl in double. */
static double spacing_of(const gw_frame_block *block, const gw_viewer *viewer, const double point[3]) {
    double towards[3];
    for (int i = 0; i < 3; ++i)
        towards[i] = point[i] - (double)viewer->eye[i];
    double x = along(towards, viewer->right), y = along(towards, viewer->up),
           z = along(towards, viewer->forward);
    double across = sqrt(x * x + y * y);
    double eccentricity = gw_atan2(across, z) * (180.0 / GW_PI);
    double half_width = fmax((double)viewer->eye[3], 1e-3),
           half_height = fmax((double)viewer->right[3], 1e-3);
    double spread = sqrt(x / half_width * (x / half_width) + y / half_height * (y / half_height));
    double half_angle = spread > 0 ? across / spread : half_height;
    double blurred = fmax(eccentricity - half_angle - (double)block->accuracy[3], 0);
    double pitch = 0.5 * ((double)block->acuity[1] + (double)block->acuity[0] * blurred) * (GW_PI / 180.0);
    return sqrt(gw_dot(towards, towards)) * fmin(pitch, 1.0);
}

/* Width of a pixel's step as seen from the rendering eye in the direction of point. */
static double step_width(const float step[4], const double point[3]) {
    double square = gw_dot(point, point), part = square > 0 ? along(point, step) / square : 0, sum = 0;
    for (int i = 0; i < 3; ++i) {
        double across = (double)step[i] - point[i] * part;
        sum += across * across;
    }
    return sqrt(sum);
}

double gw_sparse_spacing(const gw_frame_block *block, double x, double y) {
    double point[3], least = INFINITY;
    for (int i = 0; i < 3; ++i)
        point[i] = (double)block->corner[i] + (double)block->step_x[i] * x + (double)block->step_y[i] * y;
    for (uint32_t i = 0; i < block->counts[0]; ++i)
        least = fmin(least, spacing_of(block, &block->viewers[i], point));
    double width = fmax(step_width(block->step_x, point), step_width(block->step_y, point));
    return width > 0 ? least / width : 0;
}

uint32_t gw_sparse_rate(const gw_frame_block *block, int32_t x, int32_t y, uint32_t most) {
    /* Acuity falls with the distance from the gaze, so a block's least spacing lies at a corner, or inside
     * the ellipse, where the centre or a corner finds it small enough. */
    static const double places[5][2] = {{0, 0}, {SIDE, 0}, {0, SIDE}, {SIDE, SIDE}, {SIDE / 2, SIDE / 2}};
    double least = INFINITY;
    uint32_t rate = 0;
    if (block->counts[0] == 0)
        return 0;
    for (int i = 0; i < 5; ++i)
        least = fmin(least, gw_sparse_spacing(block, (double)x * SIDE + places[i][0],
                                              (double)y * SIDE + places[i][1]));
    while (rate < most && least >= (double)(2u << rate))
        rate++;
    return rate;
}

/* Appends a block's samples in Morton order; (x, y) is its first pixel, counted from the rim's. Pixels of
 * their own have `rays` samples each. */
static void append_block(gw_sparse *sparse, uint32_t *block, uint32_t x, uint32_t y, uint32_t rays) {
    uint32_t rate = *block >> 30, per_side = (uint32_t)SIDE >> rate, samples = rate == 0 ? rays : 1;
    *block |= (uint32_t)sparse->real_samples;
    for (uint32_t i = 0; i < per_side * per_side; ++i) {
        uint32_t column = (i & 1u) | (i >> 1 & 2u) | (i >> 2 & 4u),
                 row = (i >> 1 & 1u) | (i >> 2 & 2u) | (i >> 3 & 4u);
        uint32_t word = (x + (column << rate)) | (y + (row << rate)) << 13 | rate << 26;
        for (uint32_t which = 0; which < samples; ++which)
            sparse->samples[sparse->real_samples++] = word | which << 28;
    }
}

/* Whether block (i, j) of the chunk with its rim is read when pixels are made: all of the chunk is, and a
 * block of the rim where one beside it in the chunk is coarse. */
static int is_read(const uint32_t *blocks, int32_t i, int32_t j, int32_t columns, int32_t rows) {
    if (i > 0 && i <= columns && j > 0 && j <= rows)
        return 1;
    for (int32_t v = j > 1 ? j - 1 : 1; v <= j + 1 && v <= rows; ++v)
        for (int32_t u = i > 1 ? i - 1 : 1; u <= i + 1 && u <= columns; ++u)
            if (blocks[v * (columns + 2) + u] >> 30 > 0)
                return 1;
    return 0;
}

gw_code gw_sparse_list(gw_sparse *sparse, const gw_frame_block *block, int32_t x, int32_t y, int32_t columns,
                       int32_t rows, uint32_t most, gw_error *error) {
    size_t blocks = (size_t)(columns + 2) * (size_t)(rows + 2);
    uint32_t rays = block->counts[3];
    gw_code code = gw_grow((void **)&sparse->blocks, &sparse->block_capacity, blocks, sizeof *sparse->blocks,
                           "sample blocks", error);
    if (!code)
        code = gw_grow((void **)&sparse->samples, &sparse->sample_capacity, (blocks * rays + 1) * GROUP,
                       sizeof *sparse->samples, "samples", error);
    if (code)
        return code;
    sparse->block_count = blocks;
    sparse->real_samples = 0;
    sparse->coarse_blocks = 0;
    for (int32_t j = 0; j < rows + 2; ++j)
        for (int32_t i = 0; i < columns + 2; ++i) {
            uint32_t rate = gw_sparse_rate(block, x + i - 1, y + j - 1, most);
            int rim = i == 0 || j == 0 || i == columns + 1 || j == rows + 1;
            sparse->blocks[j * (columns + 2) + i] = rate << 30;
            sparse->coarse_blocks += rate > 0 && !rim;
        }
    for (int32_t j = 0; j < rows + 2; ++j)
        for (int32_t i = 0; i < columns + 2; ++i)
            if (is_read(sparse->blocks, i, j, columns, rows))
                append_block(sparse, &sparse->blocks[j * (columns + 2) + i], (uint32_t)i * SIDE,
                             (uint32_t)j * SIDE, rays);
    sparse->sample_count = sparse->real_samples;
    while (sparse->sample_count % GROUP != 0)
        sparse->samples[sparse->sample_count++] = GW_NO_SAMPLE;
    return GW_OK;
}
