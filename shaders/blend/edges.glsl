// Silhouettes and creases between samples, so that they are neither smeared over a square of pixels nor stepped along it. Samples
// know what they met. Where samples round a pixel lie on several surfaces, the pixel's own ray is tested against the triangles
// of the nearest four - no traversal - and what it meets decides, if nothing that may lie in front is left open; else the surface
// that has the majority of the four. Then only samples of that surface count. Where everything belongs together, and where
// nothing does (foliage), nothing changes.
#include "trace/triangle.glsl"
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

// How many of the sixteen samples round the pixel met the same triangle as a sample.
float count_of(int at, int corner) {
    uint id = id_of(at);
    float count = 0.0;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            count += id_of(corner + j * cell_count.x + i) == id ? 1.0 : 0.0;
    return count;
}

bool can_be_tested(uint id) {
    return (id & GW_FRAGMENT_VOXEL) == 0u && (TRIANGLE(id, 0).w & GW_TRIANGLE_ALPHA) == 0u;
}

// The one of four samples, 0 to 3, whose triangle the pixel's ray meets first; -1 if it meets none, or if another surface may lie
// in front: a sample of one is nearer whose triangle is too small to say where that surface ends. Triangles that only one of the
// sixteen samples met are grain, no silhouettes.
int sample_met(ivec4 near, mat4 alike, int corner, vec3 direction) {
    set_ray(frame.eye.xyz, direction);
    hit_t = 1e30;
    hit_triangle = GW_NO_TRIANGLE;
    floor_t = 0.0;
    floor_triangle = GW_NO_TRIANGLE;
    bvec4 tested;
    for (int k = 0; k < 4; ++k) {
        uint id = id_of(near[k]);
        tested[k] = can_be_tested(id);
        if (tested[k])
            test_triangle(id);
    }
    int met = -1;
    for (int k = 0; k < 4; ++k)
        met = hit_triangle != GW_NO_TRIANGLE && id_of(near[k]) == (hit_triangle & ~GW_HIT_BACK) ? k : met;
    bool open = false;
    for (int k = 0; k < 4; ++k) {
        float t = points[near[k]].w, count = count_of(near[k], corner);
        bool nearer = t > 0.0 && t < hit_t && alike[max(met, 0)][k] < 0.5;
        open = open || (nearer && !(tested[k] && count >= 3.0)) || (k == met && count < 2.0);
    }
    return open ? -1 : met;
}

// color: without edges; place: of the pixel's centre, wall-global px.
vec3 cut_at_edges(vec3 color, int corner, vec2 share, vec2 place) {
    int at = corner + cell_count.x + 1;
    ivec4 near = ivec4(at, at + 1, at + cell_count.x, at + cell_count.x + 1);
    precise vec4 tent = vec4((1.0 - share.x) * (1.0 - share.y), share.x * (1.0 - share.y), (1.0 - share.x) * share.y,
                             share.x * share.y);
    // apart: how much of the pixel lies between samples of two surfaces; pairs: how many of the six are on one. Without a
    // triangle that decides, creases are no edges.
    mat4 alike = mat4(1.0), level = mat4(1.0);
    precise vec2 apart = vec2(0.0);
    precise float pairs = 0.0;
    for (int k = 0; k < 3; ++k)
        for (int l = k + 1; l < 4; ++l) {
            vec2 like = likeness(near[k], near[l]);
            alike[k][l] = alike[l][k] = like.x;
            level[k][l] = level[l][k] = like.y;
            apart += tent[k] * tent[l] * (1.0 - like);
            pairs += like.y;
        }
    precise vec3 direction = frame.corner.xyz + frame.step_x.xyz * place.x + frame.step_y.xyz * place.y;
    int met = sample_met(near, alike, corner, direction);
    // Without a triangle that decides: the majority, where the four are of two surfaces, not of three or four.
    precise vec4 share_of = level * tent, square = share_of * share_of;
    precise vec4 weights = met >= 0 ? alike[max(met, 0)] * (tent + 1e-4) : tent * square * square;
    float borne_out = met >= 0 ? 1.0 : clamp(pairs - 1.0, 0.0, 1.0);
    precise vec3 sum = weights.x * colors[near.x] + weights.y * colors[near.y];
    sum += weights.z * colors[near.z] + weights.w * colors[near.w];
    precise vec3 cut = sum / max(weights.x + weights.y + weights.z + weights.w, 1e-20);
    return mix(color, cut, clamp(16.0 * (met >= 0 ? apart.x : apart.y), 0.0, 1.0) * borne_out);
}
