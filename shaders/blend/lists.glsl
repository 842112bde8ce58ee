// Work lists of what pixels are made of, one after another in an array behind their heads. A head: the groups that a dispatch over
// the list has on x and y, 1, and how many entries it has. The order within a list is arbitrary; nothing depends on it.
//
// A region is a block moved right and down by half a square of its rate: where its patches lie. Blocks and regions: column in bits
// 0-12, row in 13-25, rate in 26-28; patches: column and row of their first cell, 16 bits each.
layout(std430, binding = 25) buffer Lists { uint lists[]; };
#define LIST_ROW 32768u // groups on x: what every driver allows
#define LISTS_AT 64u
#define OWN_BLOCKS 0u            // at full rate, pixels that are their own samples
#define SOFT_BLOCKS 1u           // at full rate, sharpness has begun to fall
#define MIXED_REGIONS 2u         // some of their cells lie in blocks of other rates
#define REGIONS_OF(rate) (2u + (rate))
#define SAMPLED_OF(rate) (6u + (rate)) // blocks with samples, also in the rim
#define EDGES_OF(rate) (10u + (rate))  // patches with silhouettes or creases between their samples
#define OPEN_LISTS 11u                 // that blend/list_regions.comp fills; edges are found later

// Where a list begins, in grids of blocks: its room is what follows up to the next.
uint list_begin(uint list) {
    uint grids = list < 3u ? list : list < 12u ? 3u + list : list == 12u ? 30u : list == 13u ? 34u : 35u;
    return LISTS_AT + grids * uint(frame.list.w);
}

uint list_length(uint list) {
    return lists[4u * list + 3u];
}

uint listed_group() {
    return gl_WorkGroupID.y * LIST_ROW + gl_WorkGroupID.x;
}

// Entries that follow each other at the list's end; a group of a dispatch over it takes per_group of them.
uint extend_list(uint list, uint count, uint per_group) {
    uint begin = atomicAdd(lists[4u * list + 3u], count), groups = (begin + count + per_group - 1u) / per_group;
    if (count > 0u) {
        atomicMax(lists[4u * list], min(groups, LIST_ROW));
        atomicMax(lists[4u * list + 1u], (groups - 1u) / LIST_ROW + 1u);
    }
    return begin;
}

uint packed_place(ivec2 block, uint rate) {
    return uint(block.x) | uint(block.y) << 13 | rate << 26;
}

ivec2 place_of(uint entry) {
    return ivec2(entry & 0x1fffu, (entry >> 13) & 0x1fffu);
}

bool in_chunk(ivec2 block) {
    ivec2 first = (frame.chunk.xy - frame.list.xy) / 8, size = ivec2(frame.chunk.z, frame.chunk.w / frame.chunk.z);
    return all(greaterThanEqual(block, first)) && all(lessThan(block, first + size));
}

// Patches on a region's side.
uint patches_across(uint rate) {
    return rate < 4u ? 8u >> rate : 1u;
}

// First cell of a region: of rate 4, whose regions have odd columns and rows, the cell that they end.
ivec2 cell_of_region(ivec2 region, uint rate) {
    return rate < 4u ? region * int(patches_across(rate)) : region >> 1;
}
