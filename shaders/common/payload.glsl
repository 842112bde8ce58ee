// Reading a voxel's payload (common/shared.h).
#include "common/octahedral.glsl"
#include "common/small_math.glsl"

vec3 payload_normal(uvec3 payload) {
    vec2 code = vec2(payload.y & 0xfffu, (payload.y >> 12) & 0xfffu);
    return octahedral_decode((code - 2047.0) * (1.0 / 2047.0));
}

// 1: all normals of the cell agree; 0: they cancel.
float payload_agreement(uvec3 payload) {
    return GW_PAYLOAD_HAS_NORMAL(payload.y) ? float(payload.y >> 24) * (1.0 / 255.0) : 0.0;
}

// Surface in the cell over the cell's face area.
float payload_area(uvec3 payload) {
    precise float root = float(GW_PAYLOAD_AREA_CODE(payload.z)) * (1.0 / 4095.0);
    precise float area = float(GW_PAYLOAD_AREA_MOST) * root * root;
    return area;
}

// Where a flat cell's surface lies: distance of its plane from the cell's centre along the normal, in sides.
float payload_offset(uvec3 payload) {
    return (float(GW_PAYLOAD_OFFSET_CODE(payload.z)) - 128.0) * (1.0 / float(GW_PAYLOAD_OFFSET_STEPS));
}

// Half the thickness, in sides, of the slab by which a flat cell stands for its plane: what the surfaces of neighbouring
// cells may be apart without a gap.
#define SLAB_HALF frame.acuity.z
// Agreement of the normals below which a cell is a cloud, and above which it is a slab.
#define CLOUD_AGREEMENT (frame.acuity.w - 0.15)
#define SLAB_AGREEMENT frame.acuity.w
// Agreement below which a two-sided cell is no thin plate but a fold, which no plane stands for.
#define FOLD_AGREEMENT frame.ambient.w

// Area of the plane n.x = s inside the unit cube about the origin (unit n): the second difference of squared distances from
// its corners. Components of n are kept from 0, where the quotient would lose its digits.
float cube_section(vec3 n, float s) {
    vec3 a = max(abs(n), vec3(0.03));
    float below = -abs(s);
    vec4 corner = vec4(a.x + a.y, a.x - a.y, -a.x + a.y, -a.x - a.y) * 0.5;
    vec4 upper = max(corner + (below + 0.5 * a.z), vec4(0.0));
    vec4 lower = max(corner + (below - 0.5 * a.z), vec4(0.0));
    precise vec4 squares = upper * upper - lower * lower;
    precise float sum = (squares.x - squares.y) - (squares.z - squares.w);
    precise float section = sum / (2.0 * a.x * a.y * a.z);
    return section;
}

// 1 - exp(-x) for x >= 0, below 0.004 off.
float absorbed(float x) {
    precise float series = 1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0)))));
    precise float share = 1.0 - 1.0 / series;
    return share;
}

struct Voxel_opacity {
    float opacity;
    float sheet; // 1: part of a surface that goes on in the next cells; 0: a thing of its own, apart from what they hold
};

// Opacity of a cell to a ray that enters it at `enter` and leaves it at `leave`, both from the cell's centre in sides of the
// cell, in the frame in which `normal` is given.
//
// Where the normals disagree the cell is a cloud: its area turned towards the ray, times the length of the ray in it, so that
// the sum over the cells of a layer does not depend on where the ray enters them. Where they agree it is its plane, as a thin
// slab: only rays that cross the plane are stopped, by the share of the plane's section that the surface fills. Beside a leaf
// of triangles a cloud would let grazing rays through that have crossed the surface in it, a slab does not.
// A separated cell is never a slab; the things in it hide each other by chance, as the particles of a fog do.
// Constants measured on leaves and walls: docs/performance.md, "Error of voxels".
Voxel_opacity payload_opacity(uvec3 payload, vec3 normal, vec3 enter, vec3 leave) {
    bool two_sided = (payload.x & GW_PAYLOAD_TWO_SIDED) != 0u;
    bool separated = (payload.x & GW_PAYLOAD_SEPARATED) != 0u;
    float agreement = payload_agreement(payload);
    // Where opposed normals met, one side of things lies behind the other: half of the area is what a ray can meet.
    float area = two_sided ? 0.5 * payload_area(payload) : payload_area(payload);
    vec3 chord = leave - enter;
    precise float enter_height = dot(normal, enter);
    precise float leave_height = dot(normal, leave);
    precise float travel = length_precise(chord);
    float rise = abs(leave_height - enter_height);
    precise float cloud = area * mix(0.5 * travel, rise, agreement);
    // Where normals were turned to one side before their mean was taken (a ridge, a fold), the mean says little of a ray
    // across it: normals at the angle acos(agreement) about it face that ray by up to the sine.
    bool solid = payload.y >> 24 == GW_PAYLOAD_SOLID; // of the seed rule
    bool folded = two_sided && (agreement < FOLD_AGREEMENT || solid);
    precise float across = area * sqrt((1.0 - agreement * agreement) * max(travel * travel - rise * rise, 0.0));
    cloud = folded ? max(cloud, 0.9 * across) : cloud;
    cloud = separated ? absorbed(cloud) : min(cloud, 1.0);

    float reach = 0.5 * (abs(normal.x) + abs(normal.y) + abs(normal.z));
    float offset = payload_offset(payload);
    float centre = clamp(offset, SLAB_HALF - reach, reach - SLAB_HALF);
    precise float low = max(min(enter_height, leave_height), centre - SLAB_HALF);
    precise float high = min(max(enter_height, leave_height), centre + SLAB_HALF);
    precise float filled = area / max(cube_section(normal, centre), 1e-3);
    // Half the slab is enough for a surface that fills its section: where the plane meets the cell's border, the other half
    // lies in the neighbour, which may be a leaf of triangles and add nothing. What fills it in part must not count twice.
    float part = min(filled, 1.0);
    precise float crossed = clamp((high - low) / (SLAB_HALF * (2.0 - part * part)), 0.0, 1.0);
    float slab_share = clamp((agreement - CLOUD_AGREEMENT) * (1.0 / 0.15), 0.0, 1.0);
    precise float opacity = mix(cloud, crossed * part, folded || separated ? 0.0 : slab_share);
    // What fills half of its plane's section or more, however rough, goes on beyond the cell.
    precise float sheet = min(2.0 * agreement * filled, 1.0);
    return Voxel_opacity(min(opacity, 1.0), separated && two_sided ? 0.0 : sheet);
}
