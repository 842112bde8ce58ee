/* The samples that a renderer lists for a frame, brought back from the GPU, and the rates by which it should,
 * in double. One thread. */
#ifndef GW_TESTS_SUPPORT_SAMPLE_LISTS_H
#define GW_TESTS_SUPPORT_SAMPLE_LISTS_H

#include "render/frame_block.h"
#include "tests/support/renders.h"

typedef struct gw_sample_list {
    gw_frame_block block; /* with chunk and grid */
    uint32_t total, groups, coarse;
    uint32_t *samples; /* 64 * groups */
    uint32_t *blocks;  /* of the grid, block.list[3] */
} gw_sample_list;

/* Of the rectangle's last chunk; the frame must call for sparse samples. Ends the test if it cannot. */
gw_sample_list gw_sample_list_take(const gw_camera *camera, gw_renderer *renderer, gw_rectangle rectangle);
void gw_sample_list_finish(gw_sample_list *list);

/* Word of the block at wall-global block coordinates, which the grid must hold. */
uint32_t gw_sample_list_block(const gw_sample_list *list, int x, int y);

/* log2 of the side, 0..most, of the squares in which the wall-global block may be sampled. borderline may be
 * NULL; it is set where a spacing that decides lies within 1e-4 of its threshold. */
uint32_t gw_sample_rate(const gw_frame_block *block, int x, int y, uint32_t most, int *borderline);

#endif
