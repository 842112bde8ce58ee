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

// Of the four cells round the patch. Triangles that only one of the sixteen samples met are grain, no silhouettes; three say where a
// surface ends.
mat4 alike, level;                    // likeness by depth and normal, by depth alone
float creases[6], gaps[6], misses[6]; // of the pairs 01 02 03 12 13 23: 1 where they are on two surfaces, by either; where only one tells
float together;                       // pairs on one surface
bvec4 tested;                         // it met a triangle that can be tested
vec4 telling;                         // 1: one that is large enough to say where its surface ends
vec4 lone;                            // 1: one that no other sample met
vec4 open_from;                       // t of what it met that does not tell, 1e30 if nothing is left open
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

void compare_pair(Met a, Met b, int k, int l, int pair) {
    vec2 like = likeness(a, b);
    alike[k][l] = alike[l][k] = like.x;
    level[k][l] = level[l][k] = like.y;
    creases[pair] = 1.0 - like.x;
    gaps[pair] = 1.0 - like.y;
    misses[pair] = telling[k] != telling[l] ? gaps[pair] : 0.0;
    together += like.y;
}

// cell: the first of the four; direction: through the patch's middle.
void load_edges(ivec2 cell, uint rate, vec3 direction) {
    uint corner = number_of_cell(cell - 1, rate), row = cells_per_row(rate), ids[16];
    Met met[4];
    for (int k = 0; k < 16; ++k)
        ids[k] = CELL_MARK(corner + uint(k >> 2) * row + uint(k & 3)).x;
    aim(direction);
    for (int k = 0; k < 4; ++k) {
        met[k] = met_at(corner + uint(1 + (k >> 1)) * row + uint(1 + (k & 1)));
        float count = 0.0;
        for (int j = 0; j < 16; ++j)
            count += ids[j] == met[k].id ? 1.0 : 0.0;
        tested[k] = can_be_tested(met[k].id);
        telling[k] = tested[k] && count >= 3.0 ? 1.0 : 0.0;
        lone[k] = count < 2.0 ? 1.0 : 0.0;
        open_from[k] = met[k].point.w > 0.0 && telling[k] == 0.0 ? met[k].point.w : 1e30;
        cut[k] = patch_triangle(tested[k] ? met[k].id : 0u);
    }
    alike = level = mat4(1.0);
    together = 0.0;
    compare_pair(met[0], met[1], 0, 1, 0);
    compare_pair(met[0], met[2], 0, 2, 1);
    compare_pair(met[0], met[3], 0, 3, 2);
    compare_pair(met[1], met[2], 1, 2, 3);
    compare_pair(met[1], met[3], 1, 3, 4);
    compare_pair(met[2], met[3], 2, 3, 5);
}

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

// What of the four is on the surface that the ray meets first; x below 0: it meets none.
vec4 met_surface(vec3 direction, out bool open) {
    vec3 ray = sheared(direction);
    float nearest = 1e30, alone = 0.0;
    vec4 like = vec4(-1.0);
    for (int k = 0; k < 4; ++k) {
        float t = meet(k, ray);
        bool nearer = t < nearest;
        like = nearer ? alike[k] : like;
        alone = nearer ? lone[k] : alone;
        nearest = nearer ? t : nearest;
    }
    // Another surface may lie in front: a nearer sample's triangle is too small to say where that surface ends.
    bvec4 before = lessThan(open_from, vec4(nearest)), other = lessThan(like, vec4(0.5));
    open = alone > 0.0 || (before.x && other.x) || (before.y && other.y) || (before.z && other.z) || (before.w && other.w);
    return like;
}

// color: without edges; share: the pixel's place in the patch; direction: its ray.
vec3 cut_at_edges(vec3 color, vec2 share, vec3 direction) {
    precise vec4 tent = vec4((1.0 - share.x) * (1.0 - share.y), share.x * (1.0 - share.y), (1.0 - share.x) * share.y,
                             share.x * share.y);
    precise float both[6] =
        float[6](tent.x * tent.y, tent.x * tent.z, tent.x * tent.w, tent.y * tent.z, tent.y * tent.w, tent.z * tent.w);
    // How much of the pixel lies between samples of two surfaces, and of one that is not there. Without a triangle that decides,
    // creases are no edges.
    precise float crease = 0.0, gap = 0.0, missed = 0.0;
    for (int pair = 0; pair < 6; ++pair) {
        crease += both[pair] * creases[pair];
        gap += both[pair] * gaps[pair];
        missed += both[pair] * misses[pair];
    }
    bool open;
    vec4 like = met_surface(direction, open);
    bool hit = like.x >= 0.0, by_hit = hit && !open;
#ifdef MISSES_SAY_NOTHING // the naive variant, for the test that shows why
    bool by_miss = false;
#else
    bool by_miss = !hit && missed > 0.0;
#endif
    // By a miss: what is left when surfaces that are not there go; a silhouette must lose as many pixels as it gains. Without a
    // triangle that decides: the majority, where the four are of two surfaces, not of three or four.
    precise vec4 share_of = level * tent, square = share_of * share_of, most_of = square * square;
    precise vec4 weights = by_hit ? like * (tent + 1e-4) : tent * (by_miss ? vec4(1.0) - telling : most_of);
    float divided = by_hit ? crease : by_miss ? missed : gap;
    float borne_out = by_hit || by_miss ? 1.0 : clamp(together - 1.0, 0.0, 1.0);
    precise vec3 kept = weighted(weights, near_cells[5].rgb, near_cells[6].rgb, near_cells[9].rgb, near_cells[10].rgb) /
                        max(weights.x + weights.y + weights.z + weights.w, 1e-20);
    return mix(color, kept, clamp(16.0 * divided, 0.0, 1.0) * borne_out);
}
