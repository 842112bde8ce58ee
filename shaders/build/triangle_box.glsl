// Which of a cell's eight children does a triangle touch? Separating axes (Akenine-Moeller 2001; the edge axes are the
// three 2D edge functions of Schwarz and Seidel 2010) on boxes inflated by GW_INFLATION, evaluated about the parent's
// centre so that the eight answers share all products. Only precise + - * and comparisons: the same mask on every device.

// 2^-20 of the root cube's side 2: far above the rounding of the test and of the traversal's cell walk, so that a ray that
// clips a corner the wrong way still finds the triangle in the cell it did enter. 1/32 of a cell at depth 15.
#ifdef BOXES_AS_THEY_ARE
#define GW_INFLATION 0.0 // the naive variant, for the test that shows why
#else
#define GW_INFLATION 1.9073486328125e-06
#endif
// Bound of the relative rounding of a product difference, with room to spare: 2^-21.
#define GW_PRODUCT_SLACK 4.76837158203125e-07

// Interval [low, high] of the triangle on an axis of one 2D projection against the four child columns of that projection:
// shift is the projection of a column's centre. Bit order: (-,-), (+,-), (-,+), (+,+) of the projection's two axes.
bvec4 columns_touched(float low, float high, vec4 shift, float radius) {
    precise vec4 below = vec4(low) - shift;
    precise vec4 above = vec4(high) - shift;
    return bvec4(below.x <= radius && above.x >= -radius, below.y <= radius && above.y >= -radius,
                 below.z <= radius && above.z >= -radius, below.w <= radius && above.w >= -radius);
}

uint column_mask(bvec4 touched, uint a, uint b, uint c, uint d) {
    return (touched.x ? a : 0u) | (touched.y ? b : 0u) | (touched.z ? c : 0u) | (touched.w ? d : 0u);
}

// One edge in the projection along one axis: (p, q) are the two kept coordinates of the edge, (u, v) of the vertices.
bvec4 edge_columns(vec2 edge, vec2 first, vec2 second, vec2 third, float quarter, float half_side, float reach) {
    precise float f0 = edge.x * first.y - edge.y * first.x;
    precise float f1 = edge.x * second.y - edge.y * second.x;
    precise float f2 = edge.x * third.y - edge.y * third.x;
    precise float px = edge.x * quarter;
    precise float py = edge.y * quarter;
    precise vec4 shift = vec4(py - px, -px - py, px + py, px - py);
    precise float radius =
        half_side * (abs(edge.x) + abs(edge.y)) + GW_PRODUCT_SLACK * reach * (abs(edge.x) + abs(edge.y));
    return columns_touched(min(min(f0, f1), f2), max(max(f0, f1), f2), shift, radius);
}

// a, b, c: vertices. centre: of the parent cell. quarter: half the side of a child.
uint child_mask(vec3 a, vec3 b, vec3 c, vec3 centre, float quarter) {
    precise vec3 v0 = a - centre;
    precise vec3 v1 = b - centre;
    precise vec3 v2 = c - centre;
    precise float half_side = quarter + GW_INFLATION;

    vec3 low = min(min(v0, v1), v2);
    vec3 high = max(max(v0, v1), v2);
    precise float outer = quarter + half_side;
    precise float inner = half_side - quarter;
    uint mask = ((low.x <= inner && high.x >= -outer) ? 0x55u : 0u) | ((low.x <= outer && high.x >= -inner) ? 0xaau : 0u);
    mask &= ((low.y <= inner && high.y >= -outer) ? 0x33u : 0u) | ((low.y <= outer && high.y >= -inner) ? 0xccu : 0u);
    mask &= ((low.z <= inner && high.z >= -outer) ? 0x0fu : 0u) | ((low.z <= outer && high.z >= -inner) ? 0xf0u : 0u);
    uint box_mask = mask;

    vec3 extreme = max(abs(low), abs(high));
    float reach = max(max(extreme.x, extreme.y), extreme.z);

    precise vec3 e0 = v1 - v0;
    precise vec3 e1 = v2 - v1;
    precise vec3 e2 = v0 - v2;

    precise vec3 n = vec3(e0.y * e1.z - e0.z * e1.y, e0.z * e1.x - e0.x * e1.z, e0.x * e1.y - e0.y * e1.x);
    precise float d = n.x * v0.x + n.y * v0.y + n.z * v0.z;
    precise float lengths = (abs(e0.x) + abs(e0.y) + abs(e0.z)) * (abs(e1.x) + abs(e1.y) + abs(e1.z));
    precise float slab = half_side * (abs(n.x) + abs(n.y) + abs(n.z)) + GW_PRODUCT_SLACK * reach * lengths;
    precise vec3 m = n * quarter;
    precise vec4 lower = vec4(d + m.x + m.y + m.z, d - m.x + m.y + m.z, d + m.x - m.y + m.z, d - m.x - m.y + m.z);
    precise vec4 upper = vec4(d + m.x + m.y - m.z, d - m.x + m.y - m.z, d + m.x - m.y - m.z, d - m.x - m.y - m.z);
    mask &= column_mask(lessThanEqual(abs(lower), vec4(slab)), 1u, 2u, 4u, 8u) |
            column_mask(lessThanEqual(abs(upper), vec4(slab)), 16u, 32u, 64u, 128u);

    mask &= column_mask(edge_columns(e0.yz, v0.yz, v1.yz, v2.yz, quarter, half_side, reach), 0x03u, 0x0cu, 0x30u, 0xc0u);
    mask &= column_mask(edge_columns(e1.yz, v0.yz, v1.yz, v2.yz, quarter, half_side, reach), 0x03u, 0x0cu, 0x30u, 0xc0u);
    mask &= column_mask(edge_columns(e2.yz, v0.yz, v1.yz, v2.yz, quarter, half_side, reach), 0x03u, 0x0cu, 0x30u, 0xc0u);
    mask &= column_mask(edge_columns(e0.xz, v0.xz, v1.xz, v2.xz, quarter, half_side, reach), 0x05u, 0x0au, 0x50u, 0xa0u);
    mask &= column_mask(edge_columns(e1.xz, v0.xz, v1.xz, v2.xz, quarter, half_side, reach), 0x05u, 0x0au, 0x50u, 0xa0u);
    mask &= column_mask(edge_columns(e2.xz, v0.xz, v1.xz, v2.xz, quarter, half_side, reach), 0x05u, 0x0au, 0x50u, 0xa0u);
    mask &= column_mask(edge_columns(e0.xy, v0.xy, v1.xy, v2.xy, quarter, half_side, reach), 0x11u, 0x22u, 0x44u, 0x88u);
    mask &= column_mask(edge_columns(e1.xy, v0.xy, v1.xy, v2.xy, quarter, half_side, reach), 0x11u, 0x22u, 0x44u, 0x88u);
    mask &= column_mask(edge_columns(e2.xy, v0.xy, v1.xy, v2.xy, quarter, half_side, reach), 0x11u, 0x22u, 0x44u, 0x88u);

    // The parent's own test said yes, so some child is touched; where rounding at the rim says otherwise, keep the triangle.
    return mask != 0u ? mask : box_mask != 0u ? box_mask : 0xffu;
}
