// Pictures that explain the renderer: DEBUG_VIEW is a gw_debug_view.
#define DEBUG_LEVELS 1
#define DEBUG_STEPS 2
#define DEBUG_NORMALS 3
#define DEBUG_GAZE 4
#define DEBUG_RATES 5
#define DEBUG_ECCENTRICITY 6
#define DEBUG_FOOTPRINT 7
#define DEBUG_LOADS 8
#define DEBUG_TESTS 9
#define DEBUG_VOXELS 10

vec3 heat(float x) {
    float c = clamp(x, 0.0, 1.0);
    return clamp(vec3(3.0 * c - 1.0, 1.5 - abs(3.0 * c - 1.5), 1.0 - 2.0 * c) * vec3(1.0, 1.0, 1.0), 0.0, 1.0);
}

#if DEBUG_VIEW == DEBUG_LEVELS
// Triangles red; voxels green at the finest level to blue at the root.
vec3 level_color(uint id) {
    uint node = id & ~GW_FRAGMENT_VOXEL;
    float level = 0.0;
    for (int i = 1; i < 16; ++i)
        level += node >= frame.level_begin[i >> 2][i & 3] ? 1.0 : 0.0;
    float coarse = 1.0 - level / float(OCTREE_DEPTH);
    return (id & GW_FRAGMENT_VOXEL) != 0u ? mix(vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), min(2.0 * coarse, 1.0))
                                          : vec3(1.0, 0.0, 0.0);
}
#endif

// What a fragment shows instead of its lit colour.
vec3 debug_fragment(vec3 lit, Surface surface, uint id) {
#if DEBUG_VIEW == DEBUG_LEVELS
    return level_color(id);
#elif DEBUG_VIEW == DEBUG_NORMALS
    return surface.normal * 0.5 + 0.5;
#else
    return lit;
#endif
}

#if DEBUG_VIEW == DEBUG_ECCENTRICITY
// Red at the gaze to blue at 60 degrees from the nearest, darker lines every 10 degrees.
vec3 eccentricity_color(vec3 sum, vec3 direction) {
#ifdef GAZE
    if (frame.counts.x > 0u) {
        float degrees = eccentricity_at(direction);
        float line = abs(fract(degrees * 0.1 + 0.5) - 0.5) < 0.03 ? 0.4 : 1.0;
        return line * (0.5 * sum + 0.5 * heat(1.0 - degrees * (1.0 / 60.0)));
    }
#endif
    return sum;
}
#endif

// What a pixel shows instead of its sum; work: steps, node loads, triangle tests and voxels of its ray. The picture itself
// stays visible where a map lies over it.
vec3 debug_pixel(vec3 sum, Pixel_square square, Pixel_ray ray, uvec4 work) {
#if DEBUG_VIEW == DEBUG_STEPS
    return heat(float(work.x) / 200.0);
#elif DEBUG_VIEW == DEBUG_LOADS
    return heat(float(work.y) / 100.0);
#elif DEBUG_VIEW == DEBUG_TESTS
    return heat(float(work.z) / 100.0);
#elif DEBUG_VIEW == DEBUG_VOXELS
    return heat(float(work.w) / 20.0);
#elif DEBUG_VIEW == DEBUG_GAZE
    // Warmer where more error is accepted.
    float accepted = frame.accuracy.x > frame.accuracy.y ? (ray.tau - frame.accuracy.y) / (frame.accuracy.x - frame.accuracy.y) : 0.0;
    return 0.5 * sum + 0.5 * heat(accepted);
#elif DEBUG_VIEW == DEBUG_RATES
    // Pixels on a side that share a ray: red 1, yellow 2, green 4, blue 8.
    return 0.5 * sum + 0.5 * heat(1.0 - log2(float(square.side)) * (1.0 / 3.0));
#elif DEBUG_VIEW == DEBUG_ECCENTRICITY
    return eccentricity_color(sum, ray.direction);
#elif DEBUG_VIEW == DEBUG_FOOTPRINT
    // Width of the ray over that of a pixel: red 1 to blue 16.
    float across = max(pixel_width(ray.direction), 1e-30);
    return 0.5 * sum + 0.5 * heat(1.0 - log2(max(ray.width / across, 1.0)) * 0.25);
#else
    return sum;
#endif
}
