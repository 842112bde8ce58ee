// What colours the light of a shadow's ray takes on its straight way through what lets light through. The opacities along the ray
// (blend/opacity.glsl) have the strongest channel of each surface, tint the others beside it. What a medium absorbs (Beer and Lambert) counts
// from front to back, each medium for itself. Needs trace/walk.glsl, blend/opacity.glsl and shade/transmission.glsl before it.
vec3 tint;            // of surfaces
vec3 optical_depth;   // of media whose backs the ray has left, less the way to fronts that it has entered
vec3 open_absorption; // of media that it is in, per unit of length, less those that it started in

void begin_tint() {
    tint = vec3(1.0);
    optical_depth = vec3(0.0);
    open_absorption = vec3(0.0);
}

// Whether the ray has met the medium's surface there already: at the edge between two triangles it meets both.
bool met_again(uint triangle, float t) {
    uint before = floor_triangle == GW_NO_TRIANGLE ? triangle : floor_triangle & ~GW_HIT_BACK;
    bool same_side = ((floor_triangle ^ hit_triangle) & GW_HIT_BACK) == 0u;
    bool same_medium = texelFetch(faces, int(before)).w == texelFetch(faces, int(triangle)).w;
    bool boundary = (TRIANGLE(triangle, 0).w & GW_TRIANGLE_BOUNDARY) != 0u;
#ifdef EDGES_COUNT_TWICE
    boundary = false; // the naive variant, for the test that shows why
#endif
    return floor_triangle != GW_NO_TRIANGLE && boundary && same_side && same_medium && t <= floor_t * BESIDE;
}

// Opacity of a surface for the channel that passes best.
float tinted_alpha(uint triangle, Surface surface, float t) {
    if (met_again(triangle, t))
        return 0.0;
    vec3 through = straight_through(triangle, surface, ray_direction);
    precise vec3 passed = vec3(1.0 - surface.alpha) + surface.alpha * through;
    float most = max(passed.r, max(passed.g, passed.b));
    bool sheer = (TRIANGLE(triangle, 0).w & GW_TRIANGLE_SHEER) != 0u;
    if (sheer && most > 0.0)
        tint *= passed / most;
#ifdef ABSORPTION
    if ((TRIANGLE(triangle, 0).w & GW_TRIANGLE_BOUNDARY) != 0u) {
        vec3 absorption = extension_row(texelFetch(faces, int(triangle)).w, GW_EXTENSION_ATTENUATION).rgb;
        bool back = meets_back(triangle, ray_direction);
        precise vec3 turned = back ? absorption : -absorption;
        precise vec3 depth = turned * (t * length_precise(ray_direction));
        optical_depth += depth;
        open_absorption -= turned;
    }
#endif
    precise float most_of_sheer = surface.alpha * (1.0 - max(through.r, max(through.g, through.b)));
    return sheer ? most_of_sheer : surface.alpha;
}

// maximum: t of the light; a light without a place is in no medium.
uint tint_word(float maximum) {
    precise vec3 depth = optical_depth;
    if (maximum < 1e29) {
        precise vec3 rest = open_absorption * (maximum * length_precise(ray_direction));
        depth += max(rest, vec3(0.0));
    }
    precise vec3 left = clamp(tint, 0.0, 1.0) * exp(-clamp(depth, vec3(0.0), vec3(80.0)));
    uvec3 code = uvec3(round(sqrt(left) * 1023.0));
    return code.r | (code.g << 10) | (code.b << 20);
}
