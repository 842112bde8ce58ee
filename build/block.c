#include "build/block.h"

#include <string.h>

enum { ALIGNMENT = 64 };

uint64_t gw_block_align(uint64_t offset) {
    return (offset + (ALIGNMENT - 1)) & ~(uint64_t)(ALIGNMENT - 1);
}

uint64_t gw_block_place(size_t head_size, const uint64_t *sizes, gw_block_span *spans, uint32_t count) {
    uint64_t offset = gw_block_align(head_size);
    for (uint32_t i = 0; i < count; i++) {
        spans[i] = (gw_block_span){.offset = offset, .size = sizes[i]};
        offset = gw_block_align(offset + sizes[i]);
    }
    return offset;
}

void gw_block_put(void *block, const gw_block_span *span, const void *data) {
    if (span->size > 0)
        memcpy((uint8_t *)block + span->offset, data, (size_t)span->size);
}

static gw_code damaged(gw_error *error, const char *what, const char *why) {
    return gw_fail(error, GW_BAD_INPUT, "%s is damaged (%s); start again", what, why);
}

gw_code gw_block_check_head(const void *block, size_t size, const gw_block_head *expected, const char *what,
                            gw_error *error) {
    gw_block_head head;
    if (size < sizeof head)
        return damaged(error, what, "it is cut");
    memcpy(&head, block, sizeof head);
    if (memcmp(head.magic, expected->magic, sizeof head.magic) != 0)
        return damaged(error, what, "it is of another kind");
    if (head.version != expected->version || head.section_count != expected->section_count)
        return damaged(error, what, "it is of another version");
    if (head.size != size)
        return damaged(error, what, "its size is wrong");
    return GW_OK;
}

gw_code gw_block_check_spans(const gw_block_span *spans, const uint64_t *sizes, uint32_t count, size_t size,
                             const char *what, gw_error *error) {
    for (uint32_t i = 0; i < count; i++)
        if (spans[i].size != sizes[i] || spans[i].offset % ALIGNMENT || spans[i].offset > size ||
            spans[i].size > size - spans[i].offset)
            return damaged(error, what, "a section lies outside");
    return GW_OK;
}
