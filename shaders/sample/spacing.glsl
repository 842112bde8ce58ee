// Spacing of samples, in pixels, that the sharpest viewer resolves at a place of the plane (wall-global px). Needs
// trace/pixel.glsl, with GAZE, before it.
float spacing_at(vec2 place) {
    precise vec3 point = frame.corner.xyz + frame.step_x.xyz * place.x + frame.step_y.xyz * place.y;
    precise float spacing = acuity_at(point).width / max(pixel_width(point), 1e-30);
    return spacing;
}
