/* Samples: outside the gaze one ray serves a square of 2, 4 or 8 pixels a side where every viewer's eye
 * resolves no more; where a pixel counts by itself it may have several rays (`samples`). The rate of a block
 * of 8 x 8 pixels is a function of the plane, the wall-global block and the frame state only; a rim of one
 * block round what is drawn is sampled too, so that blending needs nothing of a neighbouring tile. Plain host
 * code; belongs to the renderer that calls it. */
#ifndef GW_RENDER_SPARSE_H
#define GW_RENDER_SPARSE_H

#include "base/status.h"
#include "render/frame_block.h"

#include <stddef.h>
#include <stdint.h>

/* Samples of one chunk of blocks and its rim, in the words of shaders/common/frame.h; they only grow. */
typedef struct gw_sparse {
    size_t sample_count;  /* with padding to whole groups of 64 */
    size_t real_samples;  /* without */
    size_t coarse_blocks; /* of the chunk, not its rim: blocks with fewer rays than pixels */
    uint32_t *samples;
    size_t sample_capacity;
    size_t block_count;
    uint32_t *blocks; /* rows of the chunk's width + 2 */
    size_t block_capacity;
} gw_sparse;

void gw_sparse_finish(gw_sparse *sparse);

/* Spacing of samples, in pixels, that the sharpest viewer resolves at a position of the plane (pixels, not
 * whole); INFINITY when nobody's gaze is known. */
double gw_sparse_spacing(const gw_frame_block *block, double x, double y);

/* log2 of the side, 0..most, of the squares that the block at block coordinates (x, y) may be sampled in: the
 * spacing that the sharpest viewer resolves anywhere in the block (Guenter et al. 2012), over the pixel's
 * width. */
uint32_t gw_sparse_rate(const gw_frame_block *block, int32_t x, int32_t y, uint32_t most);

/* Lists the samples of columns x rows blocks from block coordinates (x, y), and of the rim. Both are at most
 * GW_SPARSE_SIDE: a sample's word has room for so many. */
enum { GW_SPARSE_SIDE = 1022 };
gw_code gw_sparse_list(gw_sparse *sparse, const gw_frame_block *block, int32_t x, int32_t y, int32_t columns,
                       int32_t rows, uint32_t most, gw_error *error);

#endif
