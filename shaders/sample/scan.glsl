// Sums over the lanes of a group of 64.
shared uint scan_values[64];

// Inclusive; the group's total is scan_values[63] afterwards.
uint group_inclusive_scan(uint value) {
    uint lane = gl_LocalInvocationIndex;
    scan_values[lane] = value;
    barrier();
    for (uint step = 1u; step < 64u; step <<= 1) {
        uint left = lane >= step ? scan_values[lane - step] : 0u;
        barrier();
        value += left;
        scan_values[lane] = value;
        barrier();
    }
    return value;
}
