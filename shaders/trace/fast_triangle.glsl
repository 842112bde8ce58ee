// The usual test (Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997), for the precision ladder and
// for tests: a shared edge is computed otherwise for each of its triangles, so that a ray may slip between them.
bool meet_triangle(vec3 va, vec3 vb, vec3 vc, out float t, out bool back) {
    vec3 ab = vb - va, ac = vc - va, from_origin = ray_origin - va;
    vec3 p = cross(ray_direction, ac), q = cross(from_origin, ab);
    float determinant = dot(ab, p), inverse = 1.0 / determinant;
    float u = dot(from_origin, p) * inverse, v = dot(ray_direction, q) * inverse;
    t = dot(ac, q) * inverse;
    back = determinant < 0.0;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0;
}
