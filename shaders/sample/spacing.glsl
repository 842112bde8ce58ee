// Spacing of samples, in pixels, that the sharpest viewer resolves at a place of the plane (wall-global px). Needs
// trace/pixel.glsl, with GAZE, before it. With GAZE_SEED pixels keep a ray each, and this is by how much voxels have grown.
float spacing_at(vec2 place) {
    precise vec3 point = frame.corner.xyz + frame.step_x.xyz * place.x + frame.step_y.xyz * place.y;
#ifdef GAZE_SEED
    precise float spacing = 1.0 + seed_distance_at(point);
#else
    precise float spacing = acuity_at(point).width / max(pixel_width(point), 1e-30);
#endif
    return spacing;
}
