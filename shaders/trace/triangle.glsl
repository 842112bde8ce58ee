// The ray-triangle test, the same code for the octree and for brute force, so that both give the same bits.
//
// Inside test after Woop, Benthin and Wald (Watertight Ray/Triangle Intersection, JCGT 2(1), 2013): vertices are moved to
// the ray's origin and sheared so that the ray is the z axis; the signs of three edge products decide. Neighbours use the
// same products of a shared edge, negated, so no ray slips between them; zero counts as inside. Products are `precise`:
// contracted to fma they would lose that antisymmetry. t comes from the plane's equation, which is more exact than the
// weighted sum of vertex depths where a triangle is large (traversal.md 4), kept within the depths that the triangle has on
// the ray so that an edge-on triangle cannot answer with a wild t.
#include "trace/fetch.glsl"
#include "trace/products.glsl"
#include "common/finite.glsl"

vec3 ray_origin, ray_direction; // the true ray, not clamped, not mirrored
int shear_axis;                 // the direction's largest component
vec3 shear;                     // x, y: slopes along it; z: 1 / direction on it
float hit_t;                    // nearest hit so far
uint hit_triangle; // with GW_HIT_BACK where its back is met
float floor_t; // hits count from here on: after (floor_t, floor_triangle) in the order of (t, back, id)
uint floor_triangle;
#ifdef TRANSMISSION
uint skipped_triangle = GW_NO_TRIANGLE; // that the ray comes through
#endif
#ifdef ALPHA
uint hit_flags;
#endif

// Whether what has been met decides the ray, whatever else there is.
bool hit_suffices() {
#if defined(ANY_HIT) && defined(ALPHA)
    return hit_triangle != GW_NO_TRIANGLE && (hit_flags & GW_TRIANGLE_ALPHA) == 0u;
#elif defined(ANY_HIT)
    return hit_triangle != GW_NO_TRIANGLE;
#else
    return false;
#endif
}

vec3 along_shear(vec3 v) {
    return shear_axis == 0 ? v.yzx : shear_axis == 1 ? v.zxy : v;
}

void set_ray(vec3 origin, vec3 direction) {
    ray_origin = origin;
    ray_direction = direction;
    vec3 size = abs(direction);
    shear_axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    vec3 q = along_shear(direction);
    precise vec3 slopes = vec3(q.x / q.z, q.y / q.z, 1.0 / q.z);
    // Smaller than a float mesh can tell from zero; if kept, their products would be subnormal and their signs noise.
    const float least = 1.0 / 18446744073709551616.0;
    shear = vec3(mix(slopes.xy, vec2(0.0), lessThan(abs(slopes.xy), vec2(least))), slopes.z);
}

#ifdef DOUBLE_EDGES
// The products again in double, exact there for float factors, where a float product difference is exactly zero.
vec3 exact_edges(vec2 a, vec2 b, vec2 c, vec3 edges) {
    dvec2 da = dvec2(a), db = dvec2(b), dc = dvec2(c);
    precise dvec3 e = dvec3(dc.x * db.y - dc.y * db.x, da.x * dc.y - da.y * dc.x, db.x * da.y - db.y * da.x);
    return any(equal(edges, vec3(0.0))) ? vec3(sign(e)) * max(abs(edges), vec3(1.0)) : edges;
}
#endif

// Between which depths the triangle can be on the ray: where its section by the plane u = 0, in which the ray lies, begins and
// ends; u is that of the two coordinates beside the ray which has the wider spread, `least` its least. A triangle that lies in the
// ray's plane but for rounding has no t of its own: within all of its depths it might be taken for nearer than where it is, and
// then it hides what is before it, or the walk ends before the cells that hold it.
vec2 depths_on_ray(vec3 u, float least, vec3 depths) {
#ifdef DEPTHS_OF_VERTICES // the naive variant
    return vec2(min(depths.x, min(depths.y, depths.z)), max(depths.x, max(depths.y, depths.z)));
#else
    // One vertex lies alone on its side: the section runs between the two edges that meet there.
    bvec3 below = lessThan(u, vec3(least < 0.0 ? 0.0 : 1e-37));
    bool c_alone = below.x == below.y;
    bool b_alone = below.x == below.z;
    vec2 alone = c_alone ? vec2(u.z, depths.z) : b_alone ? vec2(u.y, depths.y) : vec2(u.x, depths.x);
    vec2 one = c_alone || b_alone ? vec2(u.x, depths.x) : vec2(u.y, depths.y);
    vec2 other = c_alone ? vec2(u.y, depths.y) : vec2(u.z, depths.z);
    precise vec2 share = vec2(alone.x / (alone.x - one.x), alone.x / (alone.x - other.x));
    precise vec2 reach = vec2(one.y - alone.y, other.y - alone.y);
    precise vec2 ends = alone.y + reach * share;
    return vec2(min(ends.x, ends.y), max(ends.x, ends.y));
#endif
}

#ifdef FAST_TRIANGLES
#include "trace/fast_triangle.glsl"
#else
// Whether the ray passes within the triangle; t there, and whether it meets the back. That is told by the edge products, not by
// the normal: where a closed surface is grazed both round, but only the products agree between neighbours, so that what enters
// leaves again (tests/hard/test_watertight.c).
bool meet_triangle(vec3 va, vec3 vb, vec3 vc, out float t, out bool back) {
    precise vec3 from_origin = va - ray_origin;
    precise vec3 a = along_shear(from_origin);
    precise vec3 b = along_shear(vb - ray_origin);
    precise vec3 c = along_shear(vc - ray_origin);
    vec2 a2 = sheared(a, shear.xy);
    vec2 b2 = sheared(b, shear.xy);
    vec2 c2 = sheared(c, shear.xy);
    vec3 edges = vec3(edge_product(c2, b2), edge_product(a2, c2), edge_product(b2, a2));
#ifdef DOUBLE_EDGES
    edges = exact_edges(a2, b2, c2, edges);
#endif
    // Written so that not-a-number is outside.
    bool one_side = all(greaterThanEqual(edges, vec3(0.0))) || all(lessThanEqual(edges, vec3(0.0)));
    vec2 least = min(min(a2, b2), c2);
    vec2 most = max(max(a2, b2), c2);
    // Seen edge-on, the products of a triangle far beside the ray are rounding, and may agree in sign by chance.
    bool near = all(lessThanEqual(vec4(least, -most), vec4(0.0)));

    precise vec3 ab = vb - va;
    precise vec3 ac = vc - va;
    vec3 normal = vec3(product_difference(ab.y, ac.z, ab.z, ac.y), product_difference(ab.z, ac.x, ab.x, ac.z),
                       product_difference(ab.x, ac.y, ab.y, ac.x));
    float along = sum_of_products(ray_direction, normal);
    precise vec3 depths = vec3(a.z, b.z, c.z) * shear.z;
#ifdef WEIGHTED_DEPTHS // the naive variant: t as the paper has it
    t = (edges.x * depths.x + edges.y * depths.y + edges.z * depths.z) / (edges.x + edges.y + edges.z);
#else
    bool by_x = most.x - least.x > most.y - least.y;
    vec2 range = depths_on_ray(by_x ? vec3(a2.x, b2.x, c2.x) : vec3(a2.y, b2.y, c2.y), by_x ? least.x : least.y, depths);
    precise float of_plane = sum_of_products(from_origin, normal) / along;
    // The ends are rounded, too: a t between them but for that is better than they are (Sponza, tests/oracle/test_embree.c).
    vec3 far = abs(depths);
    precise float slack = max(max(far.x, far.y), far.z) * (1.0 / 2097152.0);
    range = vec2(range.x - slack, range.y + slack);
    t = of_plane >= range.x ? min(of_plane, range.y) : range.x; // NaN (edge-on) becomes where the ray comes to the triangle
#endif
#ifdef FACING_BY_NORMAL // the naive variant
    back = along > 0.0;
#else
    back = any(lessThan(edges, vec3(0.0))) == (shear.z > 0.0);
#endif
    return one_side && near && any(notEqual(edges, vec3(0.0)));
}
#endif

#ifdef HITS_WITHIN_CELLS
bool in_present_cell(float t); // trace/grid.glsl
#endif

void test_vertices(vec3 va, vec3 vb, vec3 vc, uint id, uint flags) {
    float t;
    bool back;
    bool hit = meet_triangle(va, vb, vc, t, back);
    uint key = id | (back ? GW_HIT_BACK : 0u);
    bool nearer = t < hit_t || (t == hit_t && key < hit_triangle);
    bool beyond = t > floor_t || (t == floor_t && key > floor_triangle);
    hit = hit && nearer && beyond;
#ifdef HITS_WITHIN_CELLS // the naive variant, for the test that shows why
    hit = hit && in_present_cell(t);
#endif
#ifdef TRANSMISSION
    hit = hit && id != skipped_triangle;
#endif
    hit_t = hit ? t : hit_t;
    hit_triangle = hit ? key : hit_triangle;
#ifdef ALPHA
    hit_flags = hit ? flags : hit_flags;
#endif
}

// Whether what the triangle does to the ray is decided where it is hit.
uint deferred_flag(uint flags) {
#if defined(TRANSMISSION) && defined(SHADOW_RAYS)
    flags |= (flags & GW_TRIANGLE_SHEER) != 0u ? GW_TRIANGLE_ALPHA : 0u;
#elif defined(TRANSMISSION)
    flags |= (flags & GW_TRIANGLE_BOUNDARY) != 0u ? GW_TRIANGLE_ALPHA : 0u;
#endif
    return flags & GW_TRIANGLE_ALPHA;
}

void test_triangle(uint id) {
    uvec4 a = TRIANGLE(id, 0);
    vec3 b = uintBitsToFloat(TRIANGLE(id, 1).xyz);
    vec3 c = uintBitsToFloat(TRIANGLE(id, 2).xyz);
    test_vertices(uintBitsToFloat(a.xyz), b, c, id, deferred_flag(a.w));
}
