// Child lists as slots: slot 8 * cell + child. Its list starts at the number of pairs of all slots before it, which is the
// sum of the cell's prefixes (all pairs of earlier cells) plus the counts of its earlier siblings.
layout(std430, binding = 5) readonly buffer Prefixes { uint prefixes[]; };

uint slot_count(uint cell, uint child) {
    return prefixes[cell * 8u + 8u + child] - prefixes[cell * 8u + child];
}

// First pair of child's list; cell is relative to the window.
uint slot_begin(uint cell, uint child) {
    uint begin = 0u;
    for (uint k = 0u; k < 8u; ++k)
        begin += k < child ? prefixes[cell * 8u + 8u + k] : prefixes[cell * 8u + k];
    return begin;
}
