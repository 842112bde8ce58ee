// Payload words of all nodes of a window from their sums: shared.h says what the bits mean.
// variants: GW_EMISSION=1; GW_SEED_RULE=1
#include "build/payload.glsl"
#include "common/fixed_math.glsl"

// thresholds[i]: least linear value that is encoded as i (10 bits sRGB), made in double by the host: a search in this table
// is exact where pow() differs from driver to driver.
layout(std430, binding = 1) readonly buffer Thresholds { float thresholds[1024]; };
layout(std430, binding = 2) writeonly buffer Payloads { uint payloads[]; }; // [node in window][3]

#ifdef GW_EMISSION
layout(std430, binding = 3) writeonly buffer Emissions { uint emissions[]; };

// Shared exponent of 5 bits, mantissas of 9, by exact powers of two.
uint encode_radiance(vec3 radiance) {
    vec3 kept = clamp(radiance, 0.0, 65408.0);
    float largest = max(max(kept.x, kept.y), kept.z);
    int exponent = clamp(int(floatBitsToUint(largest) >> 23) - 127 + 1 + 15, 0, 31);
    float scale = uintBitsToFloat(uint(127 + 24 - exponent) << 23);
    precise vec3 scaled = floor(kept * scale + 0.5);
    uvec3 code = uvec3(min(scaled, 511.0));
    return code.x | (code.y << 9) | (code.z << 18) | (uint(exponent) << 27);
}
#endif

uint encode_channel(float linear) {
    uint code = 0u;
    for (uint bit = 512u; bit > 0u; bit >>= 1)
        code |= linear >= thresholds[code | bit] ? bit : 0u;
    return code;
}

// Octahedral map of a direction (Cigolle et al. 2014): 0 to 2 * half_steps along each axis.
uvec2 encode_normal(vec3 n, float half_steps) {
    precise float inverse = gw_reciprocal(abs(n.x) + abs(n.y) + abs(n.z));
    precise vec2 flat_normal = n.xy * inverse;
    if (n.z < 0.0) {
        precise vec2 folded = (1.0 - abs(flat_normal.yx)) * vec2(flat_normal.x < 0.0 ? -1.0 : 1.0, flat_normal.y < 0.0 ? -1.0 : 1.0);
        flat_normal = folded;
    }
    precise vec2 scaled = floor(flat_normal * half_steps + (half_steps + 0.5));
    return uvec2(clamp(scaled, 0.0, 2.0 * half_steps));
}

// value * scale + zero, rounded, within 0..most.
uint encode_fraction(float value, float scale, float zero, float most) {
    precise float scaled = floor(value * scale + (zero + 0.5));
    return uint(clamp(scaled, 0.0, most));
}

float length_of(vec3 v) {
    precise float square = v.x * v.x + v.y * v.y + v.z * v.z;
    return gw_square_root(square);
}

layout(location = 6) uniform float separation; // distance from the mean plane, rms in sides, from which no plane stands for a cell

struct cell_shape {
    vec3 direction;     // of the normal, any length
    bool two_sided, none, separated;
    uint agreement;     // code
    float offset, area; // of the surface along its normal, in sides; in face areas
    float spread;       // of a separated cell: distance from the mean plane, rms, in sides
    float one_sided;    // of a two-sided cell: 0: half of it faces either way, 1: all of it one way
};

#ifdef GW_SEED_RULE
// A voxel that is hit is hit: a solid of the cell's mean opacity.
cell_shape shape_of(surface_sum sum, float inverse_count) {
    precise float opacity = sum.moment.x * inverse_count;
    // Twice, since a two-sided voxel counts by half.
    precise float thickness = 2.0 * opacity * gw_reciprocal(1.0 - opacity + opacity * (2.0 / GW_PAYLOAD_AREA_MOST));
    vec3 direction = length_of(sum.normal) > 0.0 ? sum.normal : sum.aligned;
    return cell_shape(direction, true, direction == vec3(0.0), false, GW_PAYLOAD_SOLID, 0.0, thickness, 0.0, 0.0);
}
#else
cell_shape shape_of(surface_sum sum, float inverse_area) {
    float straight = length_of(sum.normal);
    float aligned = length_of(sum.aligned);
    // Opposed normals have met where turning them to one side makes the sum at least twice as long; a rough surface
    // has lateral normals that turning makes longer, too, but keeps a length of its own.
    precise float rough_length = 0.3 * sum.area;
    // Turned to one side, the normals of a flat wall's two sheets agree, however little of one of them the cell holds.
    precise float flat_length = 0.97 * sum.area;
    bool sheets = aligned > flat_length && straight < flat_length;
    bool two_sided = sheets || (aligned > 2.0 * straight && straight < rough_length);
    float longest = two_sided ? aligned : straight;
    precise float flatness = longest * inverse_area;
    bool none = max(straight, aligned) * inverse_area < 1.0e-3;
    vec3 direction = two_sided ? sum.aligned : sum.normal;
    uint agreement = encode_fraction(flatness, 255.0, 0.0, 255.0);
    agreement -= two_sided && agreement == GW_PAYLOAD_SOLID ? 1u : 0u;
    precise vec3 place = sum.moment * inverse_area - 0.5;
    precise vec3 unit = direction * gw_reciprocal(max(longest, 0.0));
    precise float offset = place.x * unit.x + place.y * unit.y + place.z * unit.z;
    // Mean square of the distance from the mean plane through the centroid: of second moments about it.
    precise vec3 middle = sum.moment * inverse_area;
    precise vec3 squares = sum.squares * inverse_area - middle * middle;
    precise vec3 products = sum.products * inverse_area - middle.yzx * middle.zxy;
    precise vec3 along = squares * unit * unit + 2.0 * products * unit.yzx * unit.zxy;
    precise float spread = along.x + along.y + along.z;
    bool separated = none || spread > separation * separation;
    return cell_shape(direction, two_sided, none, separated, agreement, offset, sum.area, gw_square_root(spread),
                      straight * gw_reciprocal(aligned));
}
#endif

// Word 1 of the payload.
uint encode_shape(cell_shape shape) {
    bool thick = shape.two_sided || shape.separated;
    uvec2 normal = encode_normal(shape.direction, thick ? 255.0 : 2047.0);
    uint spread = shape.separated ? encode_fraction(shape.spread, 20.0, -2.0, 7.0) : 0u;
    uint one_sided = encode_fraction(shape.one_sided, 7.0, 0.0, 7.0);
    uint word = thick ? normal.x | (normal.y << 9) | (spread << 18) | (one_sided << 21) : normal.x | (normal.y << 12);
    return (shape.none ? GW_PAYLOAD_NO_NORMAL : word) | (shape.agreement << 24);
}

void main() {
    uint node = job_index();
    if (node >= job_count)
        return;
    surface_sum sum = load_sum(node);
    float inverse_area = gw_reciprocal(sum.area);
    precise vec3 color = sum.color * inverse_area;
#ifdef GW_EMISSION
    precise vec3 emission = sum.emission * inverse_area;
    emissions[node] = encode_radiance(emission);
#endif
    cell_shape shape = shape_of(sum, inverse_area);
    payloads[node * 3u] = encode_channel(color.x) | (encode_channel(color.y) << 10) | (encode_channel(color.z) << 20) |
                          (shape.two_sided ? GW_PAYLOAD_TWO_SIDED : 0u) | (shape.separated ? GW_PAYLOAD_SEPARATED : 0u);
    payloads[node * 3u + 1u] = encode_shape(shape);
    float root = gw_square_root(shape.area);
    payloads[node * 3u + 2u] = encode_fraction(root, 4095.0 / 4.0, 0.0, 4095.0) |
                               (encode_fraction(shape.offset, GW_PAYLOAD_OFFSET_STEPS, 128.0, 255.0) << 12) |
                               (encode_fraction(sum.roughness * gw_reciprocal(sum.reflectance), 63.0, 0.0, 63.0) << 20) |
                               (encode_fraction(sum.metalness * inverse_area, 63.0, 0.0, 63.0) << 26);
}
