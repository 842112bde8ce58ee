/* Flat blocks of bytes made of sections: what ranks share and caches keep. A block has a head, which begins
 * with gw_block_head, and sections at offsets that are multiples of 64; gaps are zero, so equal input gives
 * equal bytes. It has no pointers, and is read on machines of one byte order only (the version tells: it is
 * stored as this machine's number). Any thread. */
#ifndef GW_BUILD_BLOCK_H
#define GW_BUILD_BLOCK_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_block_head {
    char magic[8];
    uint32_t version;
    uint32_t section_count;
    uint64_t size; /* of the whole block, bytes */
} gw_block_head;

typedef struct gw_block_span {
    uint64_t offset, size; /* bytes, offset from the block's start */
} gw_block_span;

/* Gives every section of sizes[] its place behind a head of head_size bytes. Returns the block's size. */
uint64_t gw_block_place(size_t head_size, const uint64_t *sizes, gw_block_span *spans, uint32_t count);

/* Rounds up to the next section boundary. */
uint64_t gw_block_align(uint64_t offset);

/* Copies data into its section; nothing happens with an empty one. */
void gw_block_put(void *block, const gw_block_span *span, const void *data);

/* The head belongs to a block of this kind and size. what names the block ("the shared scene").
 * GW_BAD_INPUT. */
gw_code gw_block_check_head(const void *block, size_t size, const gw_block_head *expected, const char *what,
                            gw_error *error);

/* Every section lies inside the block and has the size expected of it. */
gw_code gw_block_check_spans(const gw_block_span *spans, const uint64_t *sizes, uint32_t count, size_t size,
                             const char *what, gw_error *error);

#endif
