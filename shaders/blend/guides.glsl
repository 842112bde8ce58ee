// What the samples of cells met, and which of them lie on one surface.
struct Met {
    vec4 point; // from the eye, ray units; w: its t, 0 if nothing was met
    vec3 normal;
    uint id;
};

Met met_at(uint number) {
    uvec2 mark = CELL_MARK(number);
    return Met(CELL_POINT(number), unpackSnorm4x8(mark.y).xyz, mark.x);
}

// 1: the samples lie on one surface, 0: on two. x: by depth and normal, y: by depth alone.
vec2 likeness(Met a, Met b) {
    vec4 from = a.point, to = b.point;
    precise vec3 step = to.xyz - from.xyz;
    precise float off = max(abs(dot(a.normal, step)), abs(dot(b.normal, step)));
    precise float sine = off / max(length_precise(step), 1e-30);
    precise float depth = clamp((frame.gazing.y - sine) / (0.5 * frame.gazing.y), 0.0, 1.0);
    // A step is a gap where it is deeper than wide: rough ground is none.
    precise vec3 between = to.xyz / max(to.w, 1e-30) - from.xyz / max(from.w, 1e-30);
    precise float wide = length_precise(between) * min(from.w, to.w);
    precise float deep = abs(to.w - from.w) * length_precise(from.xyz) / max(from.w, 1e-30);
    precise float shallow = clamp(2.0 - 0.5 * deep / max(wide, 1e-30), 0.0, 1.0);
    precise float turn = clamp((dot(a.normal, b.normal) - frame.gazing.z) / max(frame.gazing.w - frame.gazing.z, 1e-6), 0.0, 1.0);
    bool apart = (from.w > 0.0) != (to.w > 0.0);
    float near = a.id == b.id || frame.gazing.y >= 1.0 ? 1.0 : max(depth, shallow);
    return apart ? vec2(0.0) : vec2(a.id == b.id ? 1.0 : near * turn, near);
}
