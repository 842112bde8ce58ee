// The origin of a ray that leaves a surface, on the side of the unit normal n: as many units in the last place away as the
// point, made of the triangle's corners, and the triangle test may err, so that the ray never meets what it leaves. Near 0,
// where units in the last place shrink but errors do not, a fixed distance (Waechter and Binder, A Fast and Robust Method for
// Avoiding Self-Intersection, Ray Tracing Gems, 2019). Rebased coordinates are at most about 1.
vec3 offset_from_surface(vec3 p, vec3 n) {
#if defined(NO_OFFSET)
    return p; // the naive variants, for the tests that show why
#elif defined(WIDE_OFFSET)
    return p + n * 1e-3;
#else
    ivec3 steps = ivec3(256.0 * n);
    vec3 moved = intBitsToFloat(floatBitsToInt(p) + mix(steps, -steps, lessThan(p, vec3(0.0))));
    precise vec3 near_zero = p + n * (1.0 / 65536.0);
    return mix(moved, near_zero, lessThan(abs(p), vec3(1.0 / 32.0)));
#endif
}
