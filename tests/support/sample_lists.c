/* See sample_lists.h. */
#include "tests/support/sample_lists.h"

#include "render/renderer_internal.h"
#include "render/sparse.h"
#include "tests/support/check.h"

#include <math.h>

static void *read_words(const gw_gl_buffer *buffer, size_t count) {
    uint32_t *words = calloc(count ? count : 1, sizeof *words);
    assert_non_null(words);
    check_ok(gw_gl_buffer_read(buffer, 0, count * sizeof *words, words, &error));
    return words;
}

gw_sample_list gw_sample_list_take(const gw_camera *camera, gw_renderer *renderer, gw_rectangle rectangle) {
    gw_sample_list list = {0};
    uint64_t rays = 0;
    check_ok(gw_renderer_count_rays(renderer, &camera->placement, &camera->plane, &rectangle, &camera->state,
                                    &rays, &error));
    uint32_t *head = read_words(&renderer->samples.list, GW_LIST_ARGUMENTS);
    check_ok(gw_gl_buffer_read(&renderer->frame, 0, sizeof list.block, &list.block, &error));
    list.total = head[0];
    list.groups = head[1];
    list.coarse = head[2];
    free(head);
    list.samples = read_words(&renderer->samples.samples, (size_t)list.groups * 64);
    list.blocks = read_words(&renderer->samples.blocks, (size_t)list.block.list[3]);
    return list;
}

void gw_sample_list_finish(gw_sample_list *list) {
    free(list->samples);
    free(list->blocks);
    *list = (gw_sample_list){0};
}

uint32_t gw_sample_list_block(const gw_sample_list *list, int x, int y) {
    const int32_t *grid = list->block.list;
    int column = x - grid[0] / 8, row = y - grid[1] / 8;
    assert_true(column >= 0 && row >= 0 && column < grid[2] && row < grid[3] / grid[2]);
    return list->blocks[row * grid[2] + column];
}

static double least_spacing(const gw_frame_block *block, int x, int y) {
    static const double places[5][2] = {{0, 0}, {8, 0}, {0, 8}, {8, 8}, {4, 4}};
    double least = INFINITY;
    for (int i = 0; i < 5; ++i)
        least = fmin(least, gw_sparse_spacing(block, 8 * x + places[i][0], 8 * y + places[i][1]));
    return least;
}

uint32_t gw_sample_rate(const gw_frame_block *block, int x, int y, uint32_t most, int *borderline) {
    double least = least_spacing(block, x, y), wide = INFINITY;
    uint32_t rate = 0, own = most < 3 ? most : 3;
    int near = 0;
    if (block->counts[0] == 0)
        return 0;
    while (rate < own && least >= (double)(2u << rate))
        rate++;
    for (uint32_t i = 0; i < most; ++i)
        near |= fabs(least / (double)(2u << i) - 1) < 1e-4;
    for (int i = 0; i < 4 && most == 4; ++i)
        wide = fmin(wide, least_spacing(block, (x & ~1) + (i & 1), (y & ~1) + (i >> 1)));
    near |= most == 4 && fabs(wide / 16 - 1) < 1e-4;
    if (borderline)
        *borderline = near;
    return most == 4 && wide >= 16 ? 4 : rate;
}
