// Two lists of the chunk's blocks in one array, from either end: those without silhouettes or creases between their samples, and
// those with. Before them, 4 words each: the groups that a dispatch over the list has on x and y, 1, and how many blocks it has.
// The order within a list is arbitrary; nothing depends on it.
layout(std430, binding = 22) buffer Block_lists { uint block_lists[]; };
#define LISTS_AT 8u
#define LIST_ROW 32768u // groups on x: what every driver allows

#ifdef EDGE_AWARE
#define LIST_HEAD 4u
#else
#define LIST_HEAD 0u
#endif

uint listed_place(uint head, uint at) {
    return LISTS_AT + (head == 0u ? at : uint(frame.chunk.w) - 1u - at);
}

// The block of this work group, GW_NO_PLACE beyond the list's end.
uint listed_block() {
    uint at = gl_WorkGroupID.y * LIST_ROW + gl_WorkGroupID.x;
    return at < block_lists[LIST_HEAD + 3u] ? block_lists[listed_place(LIST_HEAD, at)] : GW_NO_PLACE;
}

void list_block(uint head, uint index) {
    uint at = atomicAdd(block_lists[head + 3u], 1u);
    block_lists[listed_place(head, at)] = index;
    atomicMax(block_lists[head], min(at + 1u, LIST_ROW));
    atomicMax(block_lists[head + 1u], at / LIST_ROW + 1u);
}
