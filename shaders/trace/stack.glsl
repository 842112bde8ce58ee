// The traversal's stack: one word for each octree level, indexed by scale (log2 of the cell's side in grid units).
// Registers and selects, since a dynamically indexed array costs more on llvmpipe (traversal time x1.31); the number of
// registers follows from OCTREE_DEPTH, so no octree can be too deep for it.
#if OCTREE_DEPTH > 15
#error "the traversal stack holds 15 levels"
#endif

uint stack_1, stack_2, stack_3, stack_4, stack_5, stack_6, stack_7, stack_8;
uint stack_9, stack_10, stack_11, stack_12, stack_13, stack_14, stack_15;

#define STACK_PUSH_LEVEL(slot, level) slot = at == level ? word : slot
void stack_push(int at, uint word) {
    STACK_PUSH_LEVEL(stack_1, 1);
#if OCTREE_DEPTH >= 2
    STACK_PUSH_LEVEL(stack_2, 2);
#endif
#if OCTREE_DEPTH >= 3
    STACK_PUSH_LEVEL(stack_3, 3);
#endif
#if OCTREE_DEPTH >= 4
    STACK_PUSH_LEVEL(stack_4, 4);
#endif
#if OCTREE_DEPTH >= 5
    STACK_PUSH_LEVEL(stack_5, 5);
#endif
#if OCTREE_DEPTH >= 6
    STACK_PUSH_LEVEL(stack_6, 6);
#endif
#if OCTREE_DEPTH >= 7
    STACK_PUSH_LEVEL(stack_7, 7);
#endif
#if OCTREE_DEPTH >= 8
    STACK_PUSH_LEVEL(stack_8, 8);
#endif
#if OCTREE_DEPTH >= 9
    STACK_PUSH_LEVEL(stack_9, 9);
#endif
#if OCTREE_DEPTH >= 10
    STACK_PUSH_LEVEL(stack_10, 10);
#endif
#if OCTREE_DEPTH >= 11
    STACK_PUSH_LEVEL(stack_11, 11);
#endif
#if OCTREE_DEPTH >= 12
    STACK_PUSH_LEVEL(stack_12, 12);
#endif
#if OCTREE_DEPTH >= 13
    STACK_PUSH_LEVEL(stack_13, 13);
#endif
#if OCTREE_DEPTH >= 14
    STACK_PUSH_LEVEL(stack_14, 14);
#endif
#if OCTREE_DEPTH >= 15
    STACK_PUSH_LEVEL(stack_15, 15);
#endif
}

#define STACK_POP_LEVEL(slot, level) word = at == level ? slot : word
uint stack_pop(int at) {
    uint word = stack_1;
#if OCTREE_DEPTH >= 2
    STACK_POP_LEVEL(stack_2, 2);
#endif
#if OCTREE_DEPTH >= 3
    STACK_POP_LEVEL(stack_3, 3);
#endif
#if OCTREE_DEPTH >= 4
    STACK_POP_LEVEL(stack_4, 4);
#endif
#if OCTREE_DEPTH >= 5
    STACK_POP_LEVEL(stack_5, 5);
#endif
#if OCTREE_DEPTH >= 6
    STACK_POP_LEVEL(stack_6, 6);
#endif
#if OCTREE_DEPTH >= 7
    STACK_POP_LEVEL(stack_7, 7);
#endif
#if OCTREE_DEPTH >= 8
    STACK_POP_LEVEL(stack_8, 8);
#endif
#if OCTREE_DEPTH >= 9
    STACK_POP_LEVEL(stack_9, 9);
#endif
#if OCTREE_DEPTH >= 10
    STACK_POP_LEVEL(stack_10, 10);
#endif
#if OCTREE_DEPTH >= 11
    STACK_POP_LEVEL(stack_11, 11);
#endif
#if OCTREE_DEPTH >= 12
    STACK_POP_LEVEL(stack_12, 12);
#endif
#if OCTREE_DEPTH >= 13
    STACK_POP_LEVEL(stack_13, 13);
#endif
#if OCTREE_DEPTH >= 14
    STACK_POP_LEVEL(stack_14, 14);
#endif
#if OCTREE_DEPTH >= 15
    STACK_POP_LEVEL(stack_15, 15);
#endif
    return word;
}
