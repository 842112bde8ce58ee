// Rays and hits in buffers, for trace/rays.comp and trace/brute_force.comp. A direction is scaled by a power of two, which
// is exact, so that its largest component is in [1, 2): tiny and huge directions then step like others. Minimum, maximum
// and t are scaled with it.
layout(std430, binding = 0) readonly buffer Rays { vec4 rays[]; }; // origin, minimum; direction, maximum
layout(std430, binding = 1) buffer Hits { uvec2 hits[]; };         // t, triangle

struct Scaled_ray {
    vec3 origin, direction;
    float minimum, maximum;
    float to_scaled, from_scaled; // factors of t
};

Scaled_ray load_ray(uint slot) {
    vec4 start = rays[slot * 2u], aim = rays[slot * 2u + 1u];
    vec3 size = abs(aim.xyz);
    float largest = max(size.x, max(size.y, size.z));
    uint stored = (floatBitsToUint(largest) >> 23) & 0xffu;
    uint exponent = clamp(stored, 1u, 253u);
    Scaled_ray ray;
    ray.from_scaled = uintBitsToFloat((254u - exponent) << 23);
    ray.to_scaled = uintBitsToFloat(exponent << 23);
    ray.origin = start.xyz;
    ray.direction = stored == 0u ? vec3(0.0) : aim.xyz * ray.from_scaled; // none at all: a miss
    ray.minimum = start.w * ray.to_scaled;
    ray.maximum = aim.w * ray.to_scaled;
    return ray;
}

void store_hit(uint slot, Scaled_ray ray, float t, uint triangle) {
    float original = triangle == GW_NO_TRIANGLE ? rays[slot * 2u + 1u].w : t * ray.from_scaled;
    hits[slot] = uvec2(floatBitsToUint(original), triangle);
}
