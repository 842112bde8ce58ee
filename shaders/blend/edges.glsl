// Silhouettes and creases between samples, so that they are neither smeared over a square of pixels nor stepped along it. Samples
// know what they met. Where samples round a pixel lie on several surfaces, the pixel's own ray is tested against the triangles
// of the nearest four - no traversal - and what it meets decides, if nothing that may lie in front is left open; where it misses
// them, what is not one of those; else the surface that has the majority of the four. Then only samples of that surface count. Where everything belongs together, and where
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

// What a pixel's ray meets of the triangles of the four samples round it.
struct Test_of_samples {
    int met;     // the one, 0 to 3, that it meets first; -1: none, or another surface may lie in front: a sample of one is nearer
                 // whose triangle is too small to say where that surface ends
    vec4 missed; // 1: it does not meet any, and this one's triangle is large enough to say that its surface is not there
};

// Triangles that only one of the sixteen samples met are grain, no silhouettes; three say where a surface ends.
Test_of_samples test_samples(ivec4 near, mat4 alike, int corner, vec3 direction) {
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
    bool hit = hit_triangle != GW_NO_TRIANGLE;
    int met = -1;
    for (int k = 0; k < 4; ++k)
        met = hit && id_of(near[k]) == (hit_triangle & ~GW_HIT_BACK) ? k : met;
    Test_of_samples result;
    bool open = false;
    for (int k = 0; k < 4; ++k) {
        float t = points[near[k]].w, count = count_of(near[k], corner);
        bool nearer = t > 0.0 && t < hit_t && alike[max(met, 0)][k] < 0.5;
        bool telling = tested[k] && count >= 3.0;
        open = open || (nearer && !telling) || (k == met && count < 2.0);
#ifdef MISSES_SAY_NOTHING // the naive variant, for the test that shows why
        result.missed[k] = 0.0;
#else
        result.missed[k] = telling && !hit ? 1.0 : 0.0;
#endif
    }
    result.met = open ? -1 : met;
    return result;
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
    Test_of_samples test = test_samples(near, alike, corner, direction);
    // What is left when surfaces that are not there go: a silhouette must lose as many pixels as it gains.
    vec4 left = tent * (1.0 - test.missed), gone = tent * test.missed;
    precise float parted = 0.0;
    for (int k = 0; k < 4; ++k)
        parted += gone[k] * dot(left, vec4(1.0) - level[k]);
    bool by_miss = parted > 0.0, decided = test.met >= 0 || by_miss;
    // Without a triangle that decides: the majority, where the four are of two surfaces, not of three or four.
    precise vec4 share_of = level * tent, square = share_of * share_of;
    precise vec4 weights = by_miss ? left : test.met >= 0 ? alike[max(test.met, 0)] * (tent + 1e-4) : tent * square * square;
    float divided = by_miss ? parted : test.met >= 0 ? apart.x : apart.y;
    float borne_out = decided ? 1.0 : clamp(pairs - 1.0, 0.0, 1.0);
    precise vec3 sum = weights.x * colors[near.x] + weights.y * colors[near.y];
    sum += weights.z * colors[near.z] + weights.w * colors[near.w];
    precise vec3 cut = sum / max(weights.x + weights.y + weights.z + weights.w, 1e-20);
    return mix(color, cut, clamp(16.0 * divided, 0.0, 1.0) * borne_out);
}
