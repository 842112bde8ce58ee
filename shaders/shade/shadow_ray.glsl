// The ray from what a fragment shows to a light. Its width is that of the ray which met the fragment: constant towards a
// directional light, shrinking to 0 at a point light, as the beam from the pixel's footprint does. Needs shade/surface.glsl and
// shade/light_list.glsl before it.
#include "shade/area_light.glsl"
#include "shade/secondary_start.glsl"

// A point light is met a little before its place: it may lie in the plane of a lamp.
const float BEFORE_POINT_LIGHT = 1.0 - 1.0 / 1048576.0;

// Where a light with a place is met, whatever rounding the way there has.
vec3 light_place(uint light, vec3 from, vec3 towards) {
    vec3 place = light_row(light, 0).xyz;
#ifdef WIDE_LIGHTS
    precise vec3 met = from + towards;
    place = light_row(light, 2).w > 0.0 || light_row(light, 4).w > 0.0 ? met : place;
#endif
    return place;
}

struct Shadow_ray {
    bool needed;            // false: no light comes from there whatever stands between
    vec3 origin, direction; // rebased; t = 1 at a point light, unit length towards a directional one
    float maximum;          // t of the light
    float width;            // rebased units, at t = 0
    float narrowing;        // per unit of t
    float clear;            // t up to which only triangles count
};

// The accepted error at the ray's start, in grid units. It does not grow along the ray: below half the side of the finest cell
// nothing but triangles can be met.
float accepted_at_start(Shadow_ray ray, float tau) {
    precise float grid = frame.secondary.x * tau * (0.5 * float(1 << OCTREE_DEPTH));
    precise float start = ray.width * grid;
    return start;
}

// id, t: of the fragment; origin to tau: of the ray that met it, width at t.
Shadow_ray shadow_ray_of(uint id, float t, vec3 origin, vec3 direction, float width, float tau, uint light) {
    bool point = light >= frame.counts.y;
    Secondary_start start = secondary_start(id, t, origin, direction);
    Light_point met = point_of_light(light, start.place);
    vec3 towards = met.towards;
    precise float rise = dot(towards, start.normal);
    precise float accepted = frame.secondary.x * tau * width;
    float far = point ? length_precise(towards) : NEVER_CLEAR;
    Secondary_origin from = secondary_origin(start, accepted, rise, shadow_origin_near(start, accepted, far));
    // A light that near is within what voxels can tell.
    bool near = reach_of(start, accepted) > 0.5 * far;

    Shadow_ray ray;
    // Light from behind reaches no surface; what lies in a voxel faces all ways as far as its normals disagree.
    ray.needed = rise > 0.0 || start.agreement < 1.0;
#if defined(SPOT_LIGHTS) || defined(EMISSIVE_LIGHTS)
    float reached = point ? share_of_light(light, towards / max(far, 1e-12), far * frame.eye.w) : 1.0;
    ray.needed = ray.needed && reached > 0.0;
#endif
    ray.needed = ray.needed && max(max(met.share.r, met.share.g), met.share.b) > 0.0;
    ray.width = width;
    ray.narrowing = point ? width : 0.0;
    ray.maximum = point ? BEFORE_POINT_LIGHT : 1e30;
    ray.origin = near ? offset_from_surface(start.place, start.normal) : from.origin;
    ray.direction = point ? light_place(light, start.place, towards) - ray.origin : towards;
    ray.clear = near ? NEVER_CLEAR : from.clear;
    return ray;
}
