// Reading a voxel's payload (common/shared.h).
#include "common/octahedral.glsl"

vec3 payload_normal(uvec3 payload) {
    return octahedral_decode(vec2(payload.y & 0xfffu, (payload.y >> 12) & 0xfffu) * (2.0 / 4095.0) - 1.0);
}

// 1: all normals of the cell agree; 0: they cancel.
float payload_agreement(uvec3 payload) {
    bool meaningless = (payload.x & GW_PAYLOAD_NO_NORMAL) != 0u;
    return meaningless ? 0.0 : float(payload.y >> 24) * (1.0 / 255.0);
}

// Surface in the cell over the cell's face area.
float payload_area(uvec3 payload) {
    return float(payload.z & 0xffffu) * (1.0 / float(GW_PAYLOAD_AREA_SCALE));
}

// How much of the cell's outline, seen along the ray, its surface covers: area turned towards the ray over the cell's
// projected area. Where the normals disagree the mean |n.d| of all directions, 1/2, stands in for them.
float payload_coverage(uvec3 payload, vec3 direction) {
    vec3 d = normalize(direction);
    float agreement = payload_agreement(payload);
    precise float facing = mix(0.5, abs(dot(payload_normal(payload), d)), agreement);
    precise float outline = abs(d.x) + abs(d.y) + abs(d.z);
    precise float coverage = min(payload_area(payload) * facing / outline, 1.0);
    return coverage;
}
