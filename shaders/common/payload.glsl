// Reading a voxel's payload (common/shared.h).
#include "common/octahedral.glsl"
#include "common/small_math.glsl"

vec3 payload_normal(uvec3 payload) {
    bool thick = (payload.x & (GW_PAYLOAD_TWO_SIDED | GW_PAYLOAD_SEPARATED)) != 0u;
    uvec2 code = thick ? uvec2(payload.y, payload.y >> 9) & 0x1ffu : uvec2(payload.y, payload.y >> 12) & 0xfffu;
    float half_steps = thick ? 255.0 : 2047.0;
    precise vec2 square = (vec2(code) - half_steps) * (1.0 / half_steps);
    return octahedral_decode(square);
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

// What a voxel's words say of its surface, whatever ray meets it.
struct Voxel_shape {
    bool two_sided, separated, folded;
    float area;       // that a ray can meet, over the face's
    float agreement;
    float one_sided;  // of a two-sided cell: how much more of it faces one way, times the agreement
    float offset;     // of the mean plane along the normal, from the cell's centre, in sides
    float spread;     // of a separated cell: how far its sheets lie apart to both sides of it
    float filled;     // area over the plane's section
    float part;       // of its section that the slab stops
    float slab_share; // how much the voxel is that slab; the rest is a cloud
    float slab_half, slab_centre;
};

Voxel_shape voxel_shape(uvec3 payload, vec3 normal) {
    Voxel_shape shape;
    shape.two_sided = (payload.x & GW_PAYLOAD_TWO_SIDED) != 0u;
    shape.separated = (payload.x & GW_PAYLOAD_SEPARATED) != 0u;
    shape.agreement = payload_agreement(payload);
    // Where opposed normals met, one side of things lies behind the other: of what faces either way only the larger part can be
    // met by a ray.
    shape.one_sided = float(GW_PAYLOAD_ONE_SIDED_CODE(payload.y)) * (1.0 / 7.0) * shape.agreement;
    precise float area = payload_area(payload) * (shape.two_sided ? 0.5 * (1.0 + shape.one_sided) : 1.0);
    shape.area = area;
    // Where normals were turned to one side before their mean was taken (a ridge, a fold), the mean says little of a ray
    // across it.
    bool solid = payload.y >> 24 == GW_PAYLOAD_SOLID; // of the seed rule
    shape.folded = shape.two_sided && (shape.agreement < FOLD_AGREEMENT || solid);

    float reach = 0.5 * (abs(normal.x) + abs(normal.y) + abs(normal.z));
    shape.offset = payload_offset(payload);
    // The sheets of a wall lie apart by as much to both sides: nothing passes between them.
    shape.spread = shape.separated ? 0.1 + 0.05 * float(GW_PAYLOAD_SPREAD_CODE(payload.y)) : 0.0;
    // Where the plane cuts off a corner only, its section is told too large by the stored offset's last digit.
    precise float furthest = abs(shape.offset) + shape.spread + 0.5 / GW_PAYLOAD_OFFSET_STEPS;
    precise float filled = area / max(cube_section(normal, shape.offset), 1e-3);
    precise float filled_least = area / max(cube_section(normal, furthest), 1e-3);
    shape.filled = filled;
    // Half the slab is enough for a surface that fills its section: where the plane meets the cell's border, the other half
    // lies in the neighbour, which may be a leaf of triangles and add nothing. What fills it in part must not count twice, and
    // its slab lies inside the cell.
    shape.part = min(shape.separated ? filled_least : mix(filled, filled_least, min(filled, 1.0)), 1.0);
    shape.slab_half = SLAB_HALF + shape.spread;
    float most = max(reach - shape.slab_half, 0.0);
    precise float centre = mix(clamp(shape.offset, -most, most), shape.offset, shape.part * shape.part);
    shape.slab_centre = centre;
    // A separated cell is a slab only if it looks like a closed wall of parallel sheets: leaves agree less, and of more pairs of
    // sheets than one each pair is a plate with gaps beside it.
    float wall = clamp((shape.agreement - 0.97) * (1.0 / 0.02), 0.0, 1.0) * clamp(4.0 * shape.part - 3.0, 0.0, 1.0) *
                 (shape.two_sided ? clamp(3.3 - 2.0 * filled, 0.0, 1.0) : 1.0);
    float flat_share = clamp((shape.agreement - CLOUD_AGREEMENT) * (1.0 / 0.15), 0.0, 1.0);
    shape.slab_share = shape.folded ? 0.0 : shape.separated ? wall : flat_share;
    return shape;
}

struct Voxel_opacity {
    float opacity;
    float owed;  // at least opacity: what the ray ought to have met of the cell's surface by the end of the cell, here or in the cells before
    float lean;  // 1: all that is seen of it faces the ray, -1: away from it, 0: as much either way, or not told
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
// Constants measured on leaves and walls: docs/performance.md, "What voxels cover" and "Light through closed walls".
Voxel_opacity payload_opacity(uvec3 payload, vec3 normal, vec3 enter, vec3 leave) {
    Voxel_shape shape = voxel_shape(payload, normal);
    float agreement = shape.agreement, part = shape.part;
    vec3 chord = leave - enter;
    precise float enter_height = dot(normal, enter);
    precise float leave_height = dot(normal, leave);
    precise float travel = length_precise(chord);
    float rise = abs(leave_height - enter_height);
    precise float turned = mix(0.5 * travel, rise, agreement);
    precise float cloud = shape.area * turned;
    // Normals at the angle acos(agreement) about a fold's mean face a ray across it by up to the sine.
    precise float across = shape.area * sqrt((1.0 - agreement * agreement) * max(travel * travel - rise * rise, 0.0));
    cloud = shape.folded ? max(cloud, 0.9 * across) : cloud;
    cloud = shape.separated ? absorbed(cloud) : min(cloud, 1.0);

    // Heights along the ray's way. A ray that enters beside the surface, within the slab, met the slab's first part in the cell
    // before; if that is shown otherwise (triangles, a thinner slab), it met nothing there.
    float way = leave_height < enter_height ? -1.0 : 1.0;
    precise float begin = way * shape.slab_centre - shape.slab_half;
    precise float low = max(way * enter_height, begin);
    precise float high = min(way * leave_height, begin + 2.0 * shape.slab_half);
    float low_whole = way * enter_height <= way * shape.offset - shape.spread ? begin : low;
    precise vec2 crossed = clamp((high - vec2(low, low_whole)) / (SLAB_HALF * (2.0 - part * part)), 0.0, 1.0);
    precise float opacity = mix(cloud, crossed.x * part, shape.slab_share);
    precise float owed = mix(opacity, mix(cloud, crossed.y * part, shape.slab_share), part * part);
    // What fills half of its plane's section or more, however rough, goes on beyond the cell.
    precise float sheet = min(2.0 * agreement * shape.filled, 1.0) * (shape.separated && shape.two_sided ? shape.slab_share : 1.0);
    // Of what the ray sees by its normals the share more that faces one way; f and b of sum 1 and difference s are 1 and
    // (1 - s) / (1 + s) of the larger. Flat walls are left alone: what their sheets give too much is what closes their gaps.
    precise float one_way = clamp((shape.two_sided ? shape.one_sided : agreement) * rise / max(turned, 1e-6), 0.0, 1.0);
    precise float lean = -way * 2.0 * one_way / (1.0 + one_way) * clamp(9.5 - 10.0 * agreement, 0.0, 1.0);
    return Voxel_opacity(min(opacity, 1.0), min(owed, 1.0), lean, sheet);
}
