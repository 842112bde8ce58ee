// Primary rays. A ray is a function of the plane and the wall-global pixel only: the same bits in whatever rectangle and
// dispatch it is traced. Blocks of 8 x 8 pixels stand at wall-global multiples of 8; lanes run in Morton order.
// With REFLECTED they are secondary ones instead (shade/secondary_rays.comp), from a buffer. With SPARSE a ray may stand for a square of 2 to 16 pixels a side, or for a part of a pixel, as shaders/sample lists it.
#include "common/small_math.glsl"
#ifdef GAZE
#include "trace/gaze.glsl"
#ifdef GAZE_SEED
#include "trace/gaze_seed.glsl"
#endif
#endif

// The square of pixels that a ray stands for.
struct Pixel_square {
    ivec2 first; // wall-global
    int side;
    bool present; // false: padding at a list's end, or outside the rectangle
#ifdef SPARSE
    vec2 place; // of the ray in a square that has several, from its centre, sides
    uint which; // of these
#endif
};

struct Pixel_ray {
    vec3 origin;    // rebased
    vec3 direction; // t = 1 on the wall's plane, in ray units; unit length with REFLECTED
    float width;    // footprint per unit of t, ray units
    float tau;      // footprints
#ifdef REFLECTED
    float start; // footprint at t = 0
    float clear; // t up to which only triangles count
    float throughput; // largest share of a pixel that depends on it, 0: what it meets asks for no more rays
    float reach; // of a cone: length up to which anything counts, below 0 if what it meets need not be lit; 0: no cone
#endif
};

// The ray's footprint at t.
float footprint_at(Pixel_ray ray, float t) {
#ifdef REFLECTED
    precise float footprint = ray.start + ray.width * t;
    return abs(footprint); // behind a focus it grows again
#else
    return ray.width * t;
#endif
}

ivec2 pixel_of_slot(uint slot) {
    uint block = slot >> 6, lane = slot & 63u;
    uint per_row = uint(frame.chunk.z);
    ivec2 first = frame.chunk.xy + 8 * ivec2(block % per_row, block / per_row);
    return first + ivec2((lane & 1u) | ((lane >> 1) & 2u) | ((lane >> 2) & 4u),
                         ((lane >> 1) & 1u) | ((lane >> 2) & 2u) | ((lane >> 3) & 4u));
}

#ifdef SPARSE
layout(std430, binding = 9) readonly buffer Samples { uint samples[]; };
#endif

bool in_window(ivec2 pixel) {
    return all(greaterThanEqual(pixel, frame.window.xy)) && all(lessThan(pixel, frame.window.zw));
}

#ifdef REFLECTED
layout(std430, binding = 17) readonly buffer Given_rays { uvec4 given_rays[]; }; // GW_SECONDARY_ROWS each
#endif

Pixel_square square_of_slot(uint slot) {
#if defined(REFLECTED)
    return Pixel_square(ivec2(0), 1, uintBitsToFloat(given_rays[slot * GW_SECONDARY_ROWS + 2u].x) >= 0.0);
#elif defined(SPARSE)
    uint word = samples[slot];
    uint rate = GW_SAMPLE_RATE(word);
    uint which = GW_SAMPLE_WHICH(word);
    vec4 places = rate == 0u ? frame.sample_places[which >> 1] : frame.coarse_places[(which >> 1) & 3u];
    return Pixel_square(frame.list.xy + ivec2(GW_SAMPLE_X(word), GW_SAMPLE_Y(word)), 1 << (rate & 7u),
                        word != GW_NO_SAMPLE, (which & 1u) == 0u ? places.xy : places.zw, which);
#else
    ivec2 pixel = pixel_of_slot(slot);
    return Pixel_square(pixel, 1, in_window(pixel));
#endif
}

// Width of a pixel's step as seen along the ray.
float width_across(vec3 pixel_step, vec3 direction, float inverse_squared) {
    precise float along = dot(pixel_step, direction) * inverse_squared;
    precise vec3 across = pixel_step - direction * along;
    return length_precise(across);
}

// Width of a pixel as seen along the ray through it, per unit of t.
float pixel_width(vec3 direction) {
    precise float inverse_squared =
        1.0 / max(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z, 1e-30);
    return max(width_across(frame.step_x.xyz, direction, inverse_squared),
               width_across(frame.step_y.xyz, direction, inverse_squared));
}

#ifdef REFLECTED
Pixel_ray ray_of_slot(uint slot, out Pixel_square square) {
    uint row = slot * GW_SECONDARY_ROWS;
    vec4 start = uintBitsToFloat(given_rays[row]), aim = uintBitsToFloat(given_rays[row + 1u]);
    vec4 knobs = uintBitsToFloat(given_rays[row + 2u]);
    square = square_of_slot(slot);
    return Pixel_ray(start.xyz, aim.xyz, aim.w, knobs.x, start.w, knobs.y, knobs.z, knobs.w);
}
#else
Pixel_ray ray_of_square(Pixel_square square) {
    Pixel_ray ray;
    ray.origin = frame.eye.xyz;
    precise vec2 centre = vec2(square.first) + 0.5 * float(square.side);
    float side = float(square.side);
#ifdef SPARSE
    centre += square.place * side;
    side = square.side == 1 ? frame.corner.w : side;
#else
    centre += frame.accumulation.xy;
#endif
#ifdef RAYS_FROM_THE_TILE // the naive variant, for the test that shows why
    vec2 first = vec2(frame.window.xy);
    vec3 corner = frame.corner.xyz + frame.step_x.xyz * first.x + frame.step_y.xyz * first.y;
    centre -= first;
#else
    vec3 corner = frame.corner.xyz;
#endif
    precise vec3 direction = corner + frame.step_x.xyz * centre.x + frame.step_y.xyz * centre.y;
    ray.direction = direction;
    ray.width = pixel_width(direction) * side;
    ray.tau = frame.accuracy.y;
#ifdef GAZE
    if (frame.counts.x > 0u) {
#ifdef GAZE_SEED
        float distance_ = seed_distance_at(direction);
        ray.tau = distance_ > 0.0 ? frame.accuracy.x : frame.accuracy.y;
        ray.width *= 1.0 + distance_;
#else
        Acuity acuity = acuity_at(direction);
        ray.tau = acuity.tau;
        float resolved = acuity.width * frame.gazing.x;
#if defined(SPARSE) && !defined(VOXELS_OF_SQUARES) // the naive variant, for the test that shows why
        // A square's footprint doubles from rate to rate, what the viewer resolves does not: voxels go by that, or their level
        // would jump where more pixels begin to share a ray. The footprint itself stays wide for textures.
        precise float accepted = max(ray.width / side, resolved);
        precise float share = accepted / ray.width;
        ray.tau *= square.side > 1 ? min(share, 1.0) : 1.0;
#endif
        ray.width = max(ray.width, resolved);
#endif
    }
#endif
    return ray;
}

Pixel_ray ray_of_slot(uint slot, out Pixel_square square) {
    square = square_of_slot(slot);
    return ray_of_square(square);
}
#endif
