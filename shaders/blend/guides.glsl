// What the samples of a block's grid cells met, and which of them lie on one surface.
shared vec4 points[CELL_COUNT];  // what the cell's sample met, from the eye, ray units; w: its t, 0 if it met nothing
shared vec4 normals[CELL_COUNT]; // w: bits of the id

void fill_guide(int at, ivec2 cell, int rate) {
    ivec2 pixel = (cell << rate) + ((1 << rate) >> 2);
    uint block = block_of(pixel);
    uvec4 guide = guides[slot_of(pixel, block)];
    int side = 1 << GW_BLOCK_RATE(block);
    vec2 centre = vec2(frame.list.xy + (pixel & ~(side - 1))) + 0.5 * float(side);
    precise vec3 direction = frame.corner.xyz + frame.step_x.xyz * centre.x + frame.step_y.xyz * centre.y;
    bool met = guide.x != GW_NO_TRIANGLE;
    float t = uintBitsToFloat(guide.y);
    points[at] = met ? vec4(direction * t, t) : vec4(0.0);
    normals[at] = vec4(met ? unpackSnorm4x8(guide.z).xyz : vec3(0.0), uintBitsToFloat(guide.x));
}

uint id_of(int at) {
    return floatBitsToUint(normals[at].w);
}

// 1: the samples lie on one surface, 0: on two. x: by depth and normal, y: by depth alone.
vec2 likeness(int a, int b) {
    vec4 from = points[a], to = points[b], up = normals[a], other = normals[b];
    precise vec3 step = to.xyz - from.xyz;
    precise float off = max(abs(dot(up.xyz, step)), abs(dot(other.xyz, step)));
    precise float sine = off / max(length_precise(step), 1e-30);
    precise float depth = clamp((frame.gazing.y - sine) / (0.5 * frame.gazing.y), 0.0, 1.0);
    // A step is a gap where it is deeper than wide: rough ground is none.
    precise vec3 between = to.xyz / max(to.w, 1e-30) - from.xyz / max(from.w, 1e-30);
    precise float wide = length_precise(between) * min(from.w, to.w);
    precise float deep = abs(to.w - from.w) * length_precise(from.xyz) / max(from.w, 1e-30);
    precise float shallow = clamp(2.0 - 0.5 * deep / max(wide, 1e-30), 0.0, 1.0);
    precise float turn = clamp((dot(up.xyz, other.xyz) - frame.gazing.z) / max(frame.gazing.w - frame.gazing.z, 1e-6), 0.0, 1.0);
    bool same = floatBitsToUint(up.w) == floatBitsToUint(other.w);
    bool apart = (from.w > 0.0) != (to.w > 0.0);
    float near = same || frame.gazing.y >= 1.0 ? 1.0 : max(depth, shallow);
    return apart ? vec2(0.0) : vec2(same ? 1.0 : near * turn, near);
}
