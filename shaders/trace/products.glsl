// Sums of products of tracing, each operation rounded by itself.
//
// The language lets a driver take a * b + c with one rounding wherever `precise` does not stand. CONTRACTED does so in all places
// where that could be: no invariant may depend on it (docs/numerics.md). CONTRACTED_PRECISE does it under `precise`, too: a
// driver that disregards the word, and the naive variant for the test that shows what it is for. One rounding is emulated through
// double, since fma() of software GL rounds twice.
#if defined(CONTRACTED) || defined(CONTRACTED_PRECISE)
float multiply_add(float a, float b, float c) {
    return float(double(a) * double(b) + double(c));
}
vec3 multiply_add(vec3 a, vec3 b, vec3 c) {
    return vec3(dvec3(a) * dvec3(b) + dvec3(c));
}
#else
float multiply_add(float a, float b, float c) {
    precise float sum = a * b + c;
    return sum;
}
vec3 multiply_add(vec3 a, vec3 b, vec3 c) {
    precise vec3 sum = a * b + c;
    return sum;
}
#endif

#ifdef CONTRACTED_PRECISE
float product_difference(float a, float b, float c, float d) {
    return multiply_add(a, b, -(c * d));
}
float sum_of_products(vec3 a, vec3 b) {
    return multiply_add(a.z, b.z, multiply_add(a.y, b.y, a.x * b.x));
}
vec2 sheared(vec3 v, vec2 slopes) {
    return vec2(multiply_add(-slopes.x, v.z, v.x), multiply_add(-slopes.y, v.z, v.y));
}
#else
float product_difference(float a, float b, float c, float d) {
    precise float difference = a * b - c * d;
    return difference;
}
float sum_of_products(vec3 a, vec3 b) {
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}
vec2 sheared(vec3 v, vec2 slopes) {
    precise vec2 place = v.xy - slopes * v.z;
    return place;
}
#endif

// The cross product of p and q in the plane: its sign says on which side of the edge pq the ray passes. The edge qp has the
// same products, negated.
float edge_product(vec2 p, vec2 q) {
#ifdef ORDERED_EDGES
    // The same expression for pq and qp, so that they are opposite however it is rounded: for drivers that disregard `precise`.
    bool turned = p.x < q.x || (p.x == q.x && p.y < q.y);
    vec2 first = turned ? q : p, second = turned ? p : q;
    float product = product_difference(first.x, second.y, first.y, second.x);
    product = all(equal(p, q)) ? 0.0 : product;
    return turned ? -product : product;
#else
    return product_difference(p.x, q.y, p.y, q.x);
#endif
}
