// Silhouettes and creases between samples, so that they are neither smeared over a square of pixels nor stepped along it. Samples
// know what they met. Where samples round a pixel lie on several surfaces, the pixel's own ray is tested against the triangles
// of the nearest four - no traversal - and what it meets decides, if nothing that may lie in front is left open; else the surface
// that has the majority of the four. Then only samples of that surface count. Where everything belongs together, and where
// nothing does (foliage), nothing changes.
#include "trace/triangle.glsl"
#include "blend/guides.glsl"

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
