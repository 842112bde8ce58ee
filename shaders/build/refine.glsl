// What the refinement kernels share: one level is refined in a window of its cells, whose (triangle, cell) pairs stand
// grouped by cell and in rising triangle order. Kernels run in the order mask, prefix, scatter, classify, emit, move;
// nothing depends on the order in which invocations run.
#include "common/shared.h"

// A thread of the pair kernels owns PAIRS_PER_THREAD consecutive pairs, a group 64 threads. The counts of a block are below
// 2^16, so two fit in a word.
#define PAIRS_PER_THREAD 8u
#define PAIRS_PER_BLOCK 512u
#define SLOTS_PER_THREAD 4u
#define SLOTS_PER_BLOCK 256u

// Why a cell stopped: kept in the flags of a fresh child node until the host has counted it.
#define GW_REASON_SMALL 1u
#define GW_REASON_FAN 2u
#define GW_REASON_DEPTH 3u
#define GW_REASON_ISOLATED 4u
#define GW_REASON_BUDGET 5u

layout(location = 0) uniform uint group_base; // first work group of this slice of the dispatch
layout(location = 1) uniform uint pair_first; // window: pairs [pair_first, pair_first + pair_count) of the level
layout(location = 2) uniform uint pair_count;
layout(location = 3) uniform uint cell_first; // window: cells
layout(location = 4) uniform uint cell_count;
layout(location = 5) uniform uint level; // of the cells that are refined
layout(location = 6) uniform uint out_count; // pairs that the window sends down

layout(local_size_x = 64) in;

uint group_index() {
    return gl_WorkGroupID.x + group_base;
}

// Packed counts: eight children, children 0,1 in x ... 6,7 in w, the lower one in the low half.
uvec4 spread_counts(uint nibbles) {
    uvec4 pair = uvec4(nibbles, nibbles >> 8, nibbles >> 16, nibbles >> 24);
    return (pair & 0xfu) | ((pair & 0xf0u) << 12);
}

// Nibble k is 1 where mask has bit k.
uint nibble_flags(uint mask) {
    uint spread = (mask | (mask << 12)) & 0x000f000fu;
    spread = (spread | (spread << 6)) & 0x03030303u;
    return (spread | (spread << 3)) & 0x11111111u;
}

uint count_of(uvec4 packed_counts, uint child) {
    uint word = packed_counts[child >> 1];
    return (child & 1u) == 0u ? word & 0xffffu : word >> 16;
}

shared uvec4 scan_values[64];

// Inclusive sums of `value` over the threads of the group; the group's total is scan_values[63] afterwards.
uvec4 group_inclusive_scan(uvec4 value) {
    uint thread = gl_LocalInvocationIndex;
    scan_values[thread] = value;
    barrier();
    for (uint step = 1u; step < 64u; step <<= 1) {
        uvec4 left = thread >= step ? scan_values[thread - step] : uvec4(0u);
        barrier();
        value += left;
        scan_values[thread] = value;
        barrier();
    }
    return value;
}
