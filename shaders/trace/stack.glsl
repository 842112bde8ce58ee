// The traversal's stack: one word for each octree level, indexed by scale (log2 of the cell's side in grid units), from 1.
// Registers and selects, since a dynamically indexed array costs more on llvmpipe (docs/performance.md); the number of
// registers follows from OCTREE_DEPTH, so no octree can be too deep for it. STACK_LOCAL is an array of the invocation,
// STACK_SHARED one of the work group, for devices where those win. A push at a scale that the stack does not have, 0 or above
// STACK_LEVELS, does nothing.
#if OCTREE_DEPTH > 15
#error "the traversal stack holds 15 levels"
#endif
// Scale of the root grid's cells, where the walk starts at a grid (trace/grid.glsl) and no level above needs a word, unless
// some rays walk from the root.
#if defined(ROOT_GRID_LEVEL) && !defined(WIDE_NODES) && !defined(NO_ROOT_GRID)
#define ROOT_GRID_SCALE (OCTREE_DEPTH - ROOT_GRID_LEVEL)
#ifndef LOD
#define STACK_LEVELS ROOT_GRID_SCALE
#endif
#endif
#ifndef STACK_LEVELS
#define STACK_LEVELS OCTREE_DEPTH
#endif

#if defined(STACK_LOCAL)
uint stack_words[STACK_LEVELS];
void stack_push(int at, uint word) {
    if (at >= 1 && at <= STACK_LEVELS)
        stack_words[at - 1] = word;
}
uint stack_pop(int at) {
    return stack_words[clamp(at, 1, STACK_LEVELS) - 1];
}
#elif defined(STACK_SHARED)
shared uint stack_words[STACK_LEVELS * 64];
void stack_push(int at, uint word) {
    if (at >= 1 && at <= STACK_LEVELS)
        stack_words[(at - 1) * 64 + int(gl_LocalInvocationIndex)] = word;
}
uint stack_pop(int at) {
    return stack_words[(clamp(at, 1, STACK_LEVELS) - 1) * 64 + int(gl_LocalInvocationIndex)];
}
#else

uint stack_1, stack_2, stack_3, stack_4, stack_5, stack_6, stack_7, stack_8;
uint stack_9, stack_10, stack_11, stack_12, stack_13, stack_14, stack_15;

#define STACK_PUSH_LEVEL(slot, level) slot = at == level ? word : slot
void stack_push(int at, uint word) {
    STACK_PUSH_LEVEL(stack_1, 1);
#if STACK_LEVELS >= 2
    STACK_PUSH_LEVEL(stack_2, 2);
#endif
#if STACK_LEVELS >= 3
    STACK_PUSH_LEVEL(stack_3, 3);
#endif
#if STACK_LEVELS >= 4
    STACK_PUSH_LEVEL(stack_4, 4);
#endif
#if STACK_LEVELS >= 5
    STACK_PUSH_LEVEL(stack_5, 5);
#endif
#if STACK_LEVELS >= 6
    STACK_PUSH_LEVEL(stack_6, 6);
#endif
#if STACK_LEVELS >= 7
    STACK_PUSH_LEVEL(stack_7, 7);
#endif
#if STACK_LEVELS >= 8
    STACK_PUSH_LEVEL(stack_8, 8);
#endif
#if STACK_LEVELS >= 9
    STACK_PUSH_LEVEL(stack_9, 9);
#endif
#if STACK_LEVELS >= 10
    STACK_PUSH_LEVEL(stack_10, 10);
#endif
#if STACK_LEVELS >= 11
    STACK_PUSH_LEVEL(stack_11, 11);
#endif
#if STACK_LEVELS >= 12
    STACK_PUSH_LEVEL(stack_12, 12);
#endif
#if STACK_LEVELS >= 13
    STACK_PUSH_LEVEL(stack_13, 13);
#endif
#if STACK_LEVELS >= 14
    STACK_PUSH_LEVEL(stack_14, 14);
#endif
#if STACK_LEVELS >= 15
    STACK_PUSH_LEVEL(stack_15, 15);
#endif
}

#define STACK_POP_LEVEL(slot, level) word = at == level ? slot : word
uint stack_pop(int at) {
    uint word = stack_1;
#if STACK_LEVELS >= 2
    STACK_POP_LEVEL(stack_2, 2);
#endif
#if STACK_LEVELS >= 3
    STACK_POP_LEVEL(stack_3, 3);
#endif
#if STACK_LEVELS >= 4
    STACK_POP_LEVEL(stack_4, 4);
#endif
#if STACK_LEVELS >= 5
    STACK_POP_LEVEL(stack_5, 5);
#endif
#if STACK_LEVELS >= 6
    STACK_POP_LEVEL(stack_6, 6);
#endif
#if STACK_LEVELS >= 7
    STACK_POP_LEVEL(stack_7, 7);
#endif
#if STACK_LEVELS >= 8
    STACK_POP_LEVEL(stack_8, 8);
#endif
#if STACK_LEVELS >= 9
    STACK_POP_LEVEL(stack_9, 9);
#endif
#if STACK_LEVELS >= 10
    STACK_POP_LEVEL(stack_10, 10);
#endif
#if STACK_LEVELS >= 11
    STACK_POP_LEVEL(stack_11, 11);
#endif
#if STACK_LEVELS >= 12
    STACK_POP_LEVEL(stack_12, 12);
#endif
#if STACK_LEVELS >= 13
    STACK_POP_LEVEL(stack_13, 13);
#endif
#if STACK_LEVELS >= 14
    STACK_POP_LEVEL(stack_14, 14);
#endif
#if STACK_LEVELS >= 15
    STACK_POP_LEVEL(stack_15, 15);
#endif
    return word;
}
#endif
