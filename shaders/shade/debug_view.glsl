// Pictures that explain the renderer: DEBUG_VIEW is a gw_debug_view.
#define DEBUG_LEVELS 1
#define DEBUG_STEPS 2
#define DEBUG_NORMALS 3
#define DEBUG_GAZE 4

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

// What a pixel shows instead of its sum; steps: traversal steps of its ray.
vec3 debug_pixel(vec3 sum, Pixel_ray ray, float steps) {
#if DEBUG_VIEW == DEBUG_STEPS
    return heat(steps / 200.0);
#elif DEBUG_VIEW == DEBUG_GAZE
    // Warmer where more error is accepted; the picture itself stays visible.
    float accepted = frame.accuracy.x > frame.accuracy.y ? (ray.tau - frame.accuracy.y) / (frame.accuracy.x - frame.accuracy.y) : 0.0;
    return 0.5 * sum + 0.5 * heat(accepted);
#else
    return sum;
#endif
}
