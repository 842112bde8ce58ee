// A suspended ray: all that is needed to go on in another dispatch as if nothing had happened. The stack is not kept: the
// walk restarts at the root, towards the kept cell, and decides nothing again that was decided above it.
layout(std430, binding = 2) buffer States { uint states[]; };

void state_save(uint slot) {
    uint at = slot * GW_STATE_WORDS;
    uint modes = uint(cell.z);
#ifdef LOD
    modes |= (uint(scale) << 16) | (uint(voxel_scale) << 21) | (uint(leaf_again) << 26) | (uint(in_root) << 27);
#endif
    states[at] = uint(cell.x) | (uint(cell.y) << 16);
    states[at + 1u] = modes;
    states[at + 2u] = floatBitsToUint(cell_entry);
    states[at + 3u] = floatBitsToUint(hit_t);
    states[at + 4u] = hit_triangle;
    states[at + 5u] = list_cursor;
    states[at + 6u] = floatBitsToUint(floor_t);
    states[at + 7u] = floor_triangle;
#if defined(LOD) || defined(ALPHA)
    states[at + GW_STATE_TRANSMITTANCE] = floatBitsToUint(transmittance);
    states[at + GW_STATE_TRANSMITTANCE + 1u] = floatBitsToUint(group_opacity);
    states[at + GW_STATE_TRANSMITTANCE + 2u] = floatBitsToUint(group_end);
#endif
#ifdef LOD
    states[at + 11u] = floatBitsToUint(child_share);
    states[at + 12u] = floatBitsToUint(leaf_share);
    states[at + 14u] = floatBitsToUint(voxel_given);
    states[at + 15u] = floatBitsToUint(outer_share);
#endif
#ifdef ALPHA
    states[at + 13u] = hit_flags;
#endif
}

// After enter_root.
void state_load(uint slot) {
    uint at = slot * GW_STATE_WORDS;
    uint modes = states[at + 1u];
    cell = ivec3(states[at] & 0xffffu, states[at] >> 16, modes & 0xffffu);
    cell_entry = uintBitsToFloat(states[at + 2u]);
    hit_t = uintBitsToFloat(states[at + 3u]);
    hit_triangle = states[at + 4u];
    list_cursor = states[at + 5u];
    floor_t = uintBitsToFloat(states[at + 6u]);
    floor_triangle = states[at + 7u];
#if defined(LOD) || defined(ALPHA)
    transmittance = uintBitsToFloat(states[at + GW_STATE_TRANSMITTANCE]);
    group_opacity = uintBitsToFloat(states[at + GW_STATE_TRANSMITTANCE + 1u]);
    group_end = uintBitsToFloat(states[at + GW_STATE_TRANSMITTANCE + 2u]);
#endif
#ifdef LOD
    force_scale = int((modes >> 16) & 31u);
    voxel_scale = int((modes >> 21) & 31u);
    leaf_again = ((modes >> 26) & 1u) != 0u;
    in_root = ((modes >> 27) & 1u) != 0u;
    child_share = uintBitsToFloat(states[at + 11u]);
    leaf_share = uintBitsToFloat(states[at + 12u]);
    voxel_given = uintBitsToFloat(states[at + 14u]);
    outer_share = uintBitsToFloat(states[at + 15u]);
#endif
#ifdef ALPHA
    hit_flags = states[at + 13u];
#endif
}
