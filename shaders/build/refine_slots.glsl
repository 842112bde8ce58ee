// Child lists as slots: slot 8 * cell + child. Its list starts at the number of pairs of all slots before it, which is the
// sum of the cell's prefixes (all pairs of earlier cells) plus the counts of its earlier siblings.
// Read through a texture: on software GL a fetch costs a fraction of eight loads from a storage block.
layout(binding = 2) uniform usamplerBuffer prefix_texels; // two per cell of the window, and two after the last

struct cell_prefixes {
    uvec4 low, high;           // children 0-3 and 4-7: pairs of earlier cells that touch the child
    uvec4 low_next, high_next; // the same of the cell after it
};

cell_prefixes fetch_prefixes(uint cell) {
    int texel = int(cell) * 2;
    return cell_prefixes(texelFetch(prefix_texels, texel), texelFetch(prefix_texels, texel + 1),
                         texelFetch(prefix_texels, texel + 2), texelFetch(prefix_texels, texel + 3));
}

uint sum_of(uvec4 v) {
    return v.x + v.y + v.z + v.w;
}

// First pair of a child's list; cell is relative to the window.
uint slot_begin(cell_prefixes p, uint child) {
    uvec4 before_low = uvec4(greaterThan(uvec4(child), uvec4(0u, 1u, 2u, 3u)));
    uvec4 before_high = uvec4(greaterThan(uvec4(child), uvec4(4u, 5u, 6u, 7u)));
    return sum_of(p.low) + sum_of(p.high) + sum_of((p.low_next - p.low) * before_low) +
           sum_of((p.high_next - p.high) * before_high);
}

uint slot_count(cell_prefixes p, uint child) {
    uvec4 counts = child < 4u ? p.low_next - p.low : p.high_next - p.high;
    return counts[child & 3u];
}
