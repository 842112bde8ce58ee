// Unit vectors as points of an octahedron unfolded into the square [-1,1]^2 (Cigolle et al., A Survey of Efficient
// Representations for Independent Unit Vectors, JCGT 3(2), 2014).
vec3 octahedral_decode(vec2 p) {
    precise vec3 v = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    float fold = max(-v.z, 0.0);
    v.x += v.x >= 0.0 ? -fold : fold;
    v.y += v.y >= 0.0 ? -fold : fold;
    return normalize(v);
}

// Of a unit vector.
vec2 octahedral_encode(vec3 n) {
    precise vec2 p = n.xy / max(abs(n.x) + abs(n.y) + abs(n.z), 1e-30);
    precise vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return n.z >= 0.0 ? p : folded;
}
