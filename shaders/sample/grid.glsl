// The grid of blocks that samples are listed for: the chunk and a rim of what its pixels may read, from a multiple of 16 pixels
// on, in whole squares of blocks. Kernels run in the order rates, count, offsets, scatter; nothing depends on the order in
// which invocations run.
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;

ivec2 grid_size() {
    return ivec2(frame.list.z, frame.list.w / frame.list.z);
}

uint index_of(ivec2 block) {
    return uint(block.y * frame.list.z + block.x);
}

// Block of an invocation: a work group owns a square of blocks, its lanes in Morton order, so that samples that follow each other
// in the list lie beside each other in the picture also where a block has only one.
ivec2 block_of_invocation() {
    uint square = group_base + gl_WorkGroupID.x, lane = gl_LocalInvocationIndex;
    uint per_row = uint(frame.list.z) / uint(GW_LIST_SQUARE);
    return GW_LIST_SQUARE * ivec2(square % per_row, square / per_row) +
           ivec2((lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u),
                 ((lane >> 1) & 1u) | ((lane >> 2) & 2u) | ((lane >> 3) & 4u));
}
