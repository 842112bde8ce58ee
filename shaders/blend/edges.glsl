// Silhouettes and creases between samples, so that they are neither smeared over a square of pixels nor stepped along it. Samples
// know what they met. Where the four cells round a patch lie on several surfaces, each pixel's own ray is tested against the triangles
// of those four - no traversal - and what it meets decides, if nothing that may lie in front is left open; where it misses
// them, what is not one of those; else the surface that has the majority of the four. Then only samples of that surface count. Where everything belongs together, and where
// nothing does (foliage), nothing changes.
#include "trace/fetch.glsl"
#include "blend/guides.glsl"

// A triangle seen along the ray through the patch's middle: corners less the eye, turned so that the ray's largest component is the
// last and sheared so that it is the only one, as in trace/triangle.glsl. Edge functions and plane are then those of a ray
// (x, y, 1): dot(edge, ray) and dot(offset / normal).
struct Patch_triangle {
    vec3 edges[3], normal;
    float offset, nearest, farthest; // of t
};

// What the four cells round the patch met.
Met met[4];
uint ids[16];           // of all sixteen
mat4 alike, level;      // likeness of the four, by depth and normal, by depth alone
float pairs;            // how many of the six are on one surface
vec4 counts;            // how many of the sixteen met the same triangle as each of the four
bvec4 tested;           // each of the four met a triangle that can be tested
Patch_triangle cut[4];
int largest_axis;
vec2 slopes;

vec3 turned(vec3 v) {
    return largest_axis == 0 ? v.yzx : largest_axis == 1 ? v.zxy : v;
}

void aim(vec3 direction) {
    vec3 size = abs(direction);
    largest_axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    vec3 q = turned(direction);
    precise vec2 slope = q.xy / q.z;
    slopes = slope;
}

vec3 sheared(vec3 v) {
    vec3 q = turned(v);
    precise vec2 across = q.xy - slopes * q.z;
    return vec3(across, q.z);
}

vec3 cross_precise(vec3 a, vec3 b) {
    precise vec3 product = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return product;
}

float dot_precise(vec3 a, vec3 b) {
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}

bool can_be_tested(uint id) {
    return (id & GW_FRAGMENT_VOXEL) == 0u && (TRIANGLE(id, 0).w & GW_TRIANGLE_ALPHA) == 0u;
}

Patch_triangle patch_triangle(uint id) {
    vec3 corner[3];
    for (int i = 0; i < 3; ++i) {
        precise vec3 from_eye = uintBitsToFloat(TRIANGLE(id, i).xyz) - frame.eye.xyz;
        corner[i] = sheared(from_eye);
    }
    Patch_triangle triangle;
    for (int i = 0; i < 3; ++i)
        triangle.edges[i] = cross_precise(corner[i], corner[(i + 1) % 3]);
    precise vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    triangle.normal = cross_precise(ab, ac);
    triangle.offset = dot_precise(corner[0], triangle.normal);
    triangle.nearest = min(corner[0].z, min(corner[1].z, corner[2].z));
    triangle.farthest = max(corner[0].z, max(corner[1].z, corner[2].z));
    return triangle;
}

// cell: the first of the four; direction: through the patch's middle.
void load_edges(ivec2 cell, uint rate, vec3 direction) {
    uint corner = number_of_cell(cell - 1, rate), row = cells_per_row(rate);
    for (int k = 0; k < 16; ++k)
        ids[k] = CELL_MARK(corner + uint(k >> 2) * row + uint(k & 3)).x;
    aim(direction);
    for (int k = 0; k < 4; ++k) {
        met[k] = met_at(corner + uint(1 + (k >> 1)) * row + uint(1 + (k & 1)));
        counts[k] = 0.0;
        for (int j = 0; j < 16; ++j)
            counts[k] += ids[j] == met[k].id ? 1.0 : 0.0;
        tested[k] = can_be_tested(met[k].id);
        cut[k] = patch_triangle(tested[k] ? met[k].id : 0u);
    }
    alike = level = mat4(1.0);
    pairs = 0.0;
    for (int k = 0; k < 3; ++k)
        for (int l = k + 1; l < 4; ++l) {
            vec2 like = likeness(met[k], met[l]);
            alike[k][l] = alike[l][k] = like.x;
            level[k][l] = level[l][k] = like.y;
            pairs += like.y;
        }
}

// What a pixel's ray meets of the triangles of the four samples round it.
struct Test_of_samples {
    int met;     // the one, 0 to 3, that it meets first; -1: none, or another surface may lie in front: a sample of one is nearer
                 // whose triangle is too small to say where that surface ends
    vec4 missed; // 1: it does not meet any, and this one's triangle is large enough to say that its surface is not there
};

// t at which the sheared ray meets the triangle of one of the four, 1e30 where it does not.
float meet(int k, vec3 ray) {
    Patch_triangle triangle = cut[k];
    vec3 edges = vec3(dot_precise(triangle.edges[0], ray), dot_precise(triangle.edges[1], ray), dot_precise(triangle.edges[2], ray));
    bool inside = all(greaterThanEqual(edges, vec3(0.0))) || all(lessThanEqual(edges, vec3(0.0)));
    inside = inside && any(notEqual(edges, vec3(0.0)));
    precise float depth = triangle.offset / dot_precise(triangle.normal, ray) * ray.z;
    // Kept within the depths of the corners; not-a-number (edge-on) becomes the nearest.
    depth = depth >= triangle.nearest ? min(depth, triangle.farthest) : triangle.nearest;
    precise float t = depth / ray.z;
    return tested[k] && inside ? t : 1e30;
}

// Triangles that only one of the sixteen samples met are grain, no silhouettes; three say where a surface ends.
Test_of_samples test_samples(vec3 direction) {
    vec3 ray = sheared(direction);
    float nearest = 1e30;
    Test_of_samples result = Test_of_samples(-1, vec4(0.0));
    for (int k = 0; k < 4; ++k) {
        float t = meet(k, ray);
        result.met = t < nearest ? k : result.met;
        nearest = min(t, nearest);
    }
    bool hit = result.met >= 0, open = false;
    vec4 like = alike[max(result.met, 0)];
    for (int k = 0; k < 4; ++k) {
        float t = met[k].point.w;
        bool nearer = t > 0.0 && t < nearest && like[k] < 0.5;
        bool telling = tested[k] && counts[k] >= 3.0;
        open = open || (nearer && !telling) || (k == result.met && counts[k] < 2.0);
#ifndef MISSES_SAY_NOTHING // the naive variant, for the test that shows why
        result.missed[k] = telling && !hit ? 1.0 : 0.0;
#endif
    }
    result.met = open ? -1 : result.met;
    return result;
}

// color: without edges; share: the pixel's place in the patch; direction: its ray.
vec3 cut_at_edges(vec3 color, vec2 share, vec3 direction) {
    precise vec4 tent = vec4((1.0 - share.x) * (1.0 - share.y), share.x * (1.0 - share.y), (1.0 - share.x) * share.y,
                             share.x * share.y);
    // apart: how much of the pixel lies between samples of two surfaces. Without a triangle that decides, creases are no edges.
    precise vec2 apart = vec2(0.0);
    for (int k = 0; k < 3; ++k)
        for (int l = k + 1; l < 4; ++l)
            apart += tent[k] * tent[l] * (1.0 - vec2(alike[k][l], level[k][l]));
    Test_of_samples test = test_samples(direction);
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
    precise vec3 kept = weighted(weights, near_cells[5].rgb, near_cells[6].rgb, near_cells[9].rgb, near_cells[10].rgb) /
                        max(weights.x + weights.y + weights.z + weights.w, 1e-20);
    return mix(color, kept, clamp(16.0 * divided, 0.0, 1.0) * borne_out);
}
