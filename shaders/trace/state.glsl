// A suspended ray: all that is needed to go on in another dispatch as if nothing had happened. The stack is not kept: the
// walk starts at the root again, towards the kept cell.
layout(std430, binding = 2) buffer States { uint states[]; };
#if defined(LOD) || defined(UNTIL_COARSE)
#define LOD_STATE
#endif
#if defined(LOD_STATE) || defined(ALPHA)
#define OPACITY_STATE
#endif
#if defined(SHADOW_RAYS) && defined(TRANSMISSION)
#define TINT_STATE
#define STATE_WORDS (GW_STATE_WORDS + GW_TINT_STATE_WORDS)
#else
#define STATE_WORDS GW_STATE_WORDS
#endif

void state_save(uint slot) {
    uint at = slot * STATE_WORDS;
    uint modes = uint(cell.z);
#ifdef LOD_STATE
    modes |= (uint(scale) << 16) | (uint(voxel_scale) << 21) | (uint(leaf_again) << 26) | (uint(in_root) << 27) |
             (uint(leave_ahead) << 28);
#endif
#ifdef ALPHA
    modes |= (hit_flags & GW_TRIANGLE_ALPHA) << 29;
#endif
    states[at] = uint(cell.x) | (uint(cell.y) << 16);
    states[at + 1u] = modes;
    states[at + 2u] = floatBitsToUint(cell_entry);
    states[at + 3u] = floatBitsToUint(hit_t);
    states[at + 4u] = hit_triangle;
    states[at + 5u] = list_cursor;
    states[at + 6u] = floatBitsToUint(floor_t);
    states[at + 7u] = floor_triangle;
#ifdef OPACITY_STATE
    states[at + GW_STATE_TRANSMITTANCE] = floatBitsToUint(transmittance);
    states[at + GW_STATE_TRANSMITTANCE + 1u] = floatBitsToUint(group_opacity);
    states[at + GW_STATE_TRANSMITTANCE + 2u] = floatBitsToUint(group_end);
#endif
#ifdef LOD_STATE
    states[at + 11u] = floatBitsToUint(child_share);
    states[at + 12u] = floatBitsToUint(leaf_share);
    states[at + 13u] = floatBitsToUint(group_lean);
    states[at + 14u] = floatBitsToUint(voxel_given);
    states[at + 15u] = floatBitsToUint(outer_share);
#endif
#ifdef TINT_STATE
    for (int i = 0; i < 3; ++i) {
        states[at + GW_STATE_WORDS + uint(i)] = floatBitsToUint(tint[i]);
        states[at + GW_STATE_WORDS + 3u + uint(i)] = floatBitsToUint(optical_depth[i]);
        states[at + GW_STATE_WORDS + 6u + uint(i)] = floatBitsToUint(open_absorption[i]);
    }
#endif
}

#ifdef LOD
#ifdef ROOT_GRID_SCALE
// Down from the grid to where the ray stood: below it, or before a leaf that it names; else it is read again.
int descend_from_grid(int target) {
    uint index = grid_entry();
    uvec2 node = NODE(index);
    COUNT_STEP();
    COUNT_NODE(true);
    int entry_scale = int(GW_GRID_ENTRY_SCALE(node.y));
    bool leaf = GW_NODE_KIND(node.y) != GW_KIND_INNER;
    bool below = target <= ROOT_GRID_SCALE && !leaf;
    bool before = target < SCALE_ABOVE_GRID && target > ROOT_GRID_SCALE && leaf;
    uint word = node_word_of(index, node);
    stack_push(from_grid && below ? entry_scale : 0, word);
    node_word = from_grid && below ? word : from_grid && before ? word_above(index, entry_scale) : node_word;
    scale = from_grid && below ? entry_scale : from_grid && before ? entry_scale + 1 : scale;
    return from_grid && !below ? scale : target;
}
#endif

// Down from the root to the cell of that scale in which the ray stood: what was decided above it is not decided again.
void descend_to(int target) {
    bool valid = true;
#ifdef ROOT_GRID_SCALE
    target = descend_from_grid(target);
#endif
    while (scale > target && valid) {
        ++iterations;
        COUNT_STEP();
        COUNT_NODE(true);
        int child_scale = scale - 1;
        uint index = child_at(node_word, octant_at(child_scale), valid);
        uvec2 node = NODE(index);
        scale = child_scale;
        node_word = node_word_of(index, node);
        stack_push(child_scale, node_word);
    }
}
#endif

// After enter_root.
void state_load(uint slot) {
    uint at = slot * STATE_WORDS;
    uint modes = states[at + 1u];
    cell = ivec3(states[at] & 0xffffu, states[at] >> 16, modes & 0xffffu);
    cell_entry = uintBitsToFloat(states[at + 2u]);
    hit_t = uintBitsToFloat(states[at + 3u]);
    hit_triangle = states[at + 4u];
    list_cursor = states[at + 5u];
    floor_t = uintBitsToFloat(states[at + 6u]);
    floor_triangle = states[at + 7u];
#ifdef OPACITY_STATE
    transmittance = uintBitsToFloat(states[at + GW_STATE_TRANSMITTANCE]);
    group_opacity = uintBitsToFloat(states[at + GW_STATE_TRANSMITTANCE + 1u]);
    group_end = uintBitsToFloat(states[at + GW_STATE_TRANSMITTANCE + 2u]);
#endif
#ifdef LOD
    voxel_scale = int((modes >> 21) & 31u);
    leaf_again = ((modes >> 26) & 1u) != 0u;
    in_root = ((modes >> 27) & 1u) != 0u;
    leave_ahead = ((modes >> 28) & 1u) != 0u;
    child_share = uintBitsToFloat(states[at + 11u]);
    leaf_share = uintBitsToFloat(states[at + 12u]);
    group_lean = uintBitsToFloat(states[at + 13u]);
    voxel_given = uintBitsToFloat(states[at + 14u]);
    outer_share = uintBitsToFloat(states[at + 15u]);
#endif
#ifdef ALPHA
    hit_flags = (modes >> 29) & 1u;
#endif
#ifdef TINT_STATE
    for (int i = 0; i < 3; ++i) {
        tint[i] = uintBitsToFloat(states[at + GW_STATE_WORDS + uint(i)]);
        optical_depth[i] = uintBitsToFloat(states[at + GW_STATE_WORDS + 3u + uint(i)]);
        open_absorption[i] = uintBitsToFloat(states[at + GW_STATE_WORDS + 6u + uint(i)]);
    }
#endif
#ifdef LOD
    descend_to(int((modes >> 16) & 31u));
#endif
}
