// Directions across n, which turn with it but where its largest component is another one.
mat3 frame_about(vec3 n) {
    vec3 size = abs(n);
    vec3 axis = size.x >= size.y && size.x >= size.z ? vec3(0.0, 1.0, 0.0) : size.y >= size.z ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    precise vec3 across = cross(axis, n);
    across /= max(length_precise(across), 1e-6);
    precise vec3 other = cross(n, across);
    return mat3(across, other, n);
}
