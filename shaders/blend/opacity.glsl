// Front-to-back compositing along one ray, and the weights that blend octree levels.
//
// Opacities of adjacent cells of one surface that passes through them add, up to 1. Where the ray leaves one
// surface and meets another, what was left behind the first multiplies. Multiplying within a surface would let light
// through walls: a ray that crosses a wall in two cells of half coverage each would see a quarter of what is behind.

float transmittance;  // in front of the current group of cells
float group_opacity;  // of the group so far
float group_lean;     // of it, what faces the ray minus what faces away
float group_end;      // t at which its last cell ends

// Less than this may remain of a ray before it counts as stopped, and less than that may a voxel count before it is not
// worth shading; either way the colour of what was shaded stands for the rest.
#define OPAQUE_REMAINDER frame.background.w
#define LEAST_WEIGHT (0.25 * frame.background.w)

// Share of the accepted error at which a separated cell stands for its contents.
#define SEPARATED_TAU frame.step_y.w

// Factor between two t that rounding alone may have parted.
#define BESIDE (1.0 + 1.0 / 262144.0)

float remaining() {
    return transmittance * (1.0 - group_opacity);
}

void begin_group_if_apart(float entry) {
    bool apart = entry > group_end * BESIDE;
#ifdef MULTIPLY_OPACITY
    apart = true; // the naive variant, for the test that shows why
#endif
    precise float left = transmittance * (1.0 - group_opacity);
    transmittance = apart ? left : transmittance;
    group_opacity = apart ? 0.0 : group_opacity;
    group_lean = apart ? 0.0 : group_lean;
}

// Adds one thing of the given opacity to the current group; the result is its weight in the pixel. sheet 1: part of the
// group's surface; 0: a thing of its own, which what came before hides by chance. lean 1: it faces the ray, -1: away from it, 0:
// both or unknown. What a thing shows of its back lies behind what it shows of its front, be it in another cell: of the two sums
// the larger counts, or a bar would be twice as thick where its front and its back lie in two cells.
float composite(float opacity, float lean, float sheet) {
    float left = 1.0 - group_opacity;
#ifdef BACKS_COUNT
    lean = 0.0; // the naive variant, for the test that shows why
#endif
    precise float front = opacity * min(1.0 + lean, 1.0), back = opacity * min(1.0 - lean, 1.0);
    precise float unhidden = max(min(group_lean, 0.0) + front, min(-group_lean, 0.0) + back);
    group_lean += front - back;
    precise float added = mix(unhidden * left, min(unhidden, left), sheet);
    precise float weight = transmittance * added;
    group_opacity += added;
    return weight;
}

// Share of the children when a cell of side v stands for its contents at footprint f >= v / 2: 0 from f = v on, 1 at v / 2
// (Weier et al. 2014, section 4: their weight i, written for the coarser cell).
float children_share(float f, float v) {
#ifdef LEVEL_BLEND
    precise float i = clamp((v - f) / (0.5 * v), 0.0, 1.0);
    return i;
#else
    return f >= v ? 0.0 : 1.0;
#endif
}

// Share of the triangles in a leaf of side v: 1 below f = v / 2, 0 from f = v on.
float triangles_share(float f, float v) {
#ifdef VOXELS_ONLY
    return 0.0;
#elif defined(SHADOW_RAYS) && !defined(SHADOW_LEAF_BLEND)
    return 1.0; // a leaf is walked into only where it is about as wide as the ray: its triangles are cheap, and closed
#elif defined(LEAF_BLEND)
    precise float w = clamp((v - f) / (0.5 * v), 0.0, 1.0);
    return w;
#else
    return f >= v ? 0.0 : 1.0;
#endif
}
