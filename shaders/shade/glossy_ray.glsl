// The ray that a nearly smooth surface reflects: about a microfacet's normal, drawn from those that the viewer sees (Heitz, Sampling the
// GGX Distribution of Visible Normals, JCGT 7(4), 2018). One a sample: which one is a fixed pattern on the wall, another for each
// sample of a still view, and for what is seen in reflections a number that goes on from there. Needs shade/reflected_ray.glsl and
// shade/frame_about.glsl before it.

uint scrambled(uint word) {
    word = word * 747796405u + 2891336453u;
    word = ((word >> ((word >> 28) + 4u)) ^ word) * 277803737u;
    return (word >> 22) ^ word;
}

// Where the ray stands among those of its pixel, sides of the square.
vec2 place_among(Pixel_square square) {
#if defined(SPARSE) && !defined(REFLECTED)
    return square.place - frame.accumulation.xy;
#else
    return vec2(0.0);
#endif
}

// By which lobes are drawn; within GW_LOBE_SEED.
uint lobe_seed(Pixel_square square, uint slot) {
#ifdef REFLECTED
    return given_rays[slot * GW_SECONDARY_ROWS + 3u].w & GW_LOBE_SEED;
#else
    uvec2 at = uvec2(square.first), among = uvec2(ivec2(round(16.0 * fract(place_among(square))))) & 15u;
    return (at.x * 0x9e3779b1u + at.y * 0x85ebca77u + among.x * 0xc2b2ae3du + among.y * 0x27d4eb2fu) & GW_LOBE_SEED;
#endif
}

// Number of the sample of a still view.
float sample_drawn() {
    return floor(1.0 / frame.accumulation.z - 0.5);
}

// Of so rough a lobe a share of the rays sees the environment without the lights taken from it: their highlights show that share.
bool unlit_lobe(float roughness, uint seed) {
    precise float place = fract(float(scrambled(seed ^ 0x68bc21ebu) >> 8) * (1.0 / 16777216.0) + sample_drawn() * 0.7548777);
#ifdef LAMPS_IN_LOBES
    return false; // the naive variant, for the test that shows why
#else
    return place < highlight_share(roughness);
#endif
}

// 0..1 in both directions. Multiples of the powers of the root of g^4 = g + 1 as in shade/area_light.glsl, of other powers.
vec2 place_in_lobe(Pixel_square square, uint seed) {
    uvec2 at = uvec2(square.first);
    uvec2 turned = uvec2(at.x * 0x8cb92ba7u + at.y * 0xd1b54a32u, at.x * 0xc13fa9a9u + at.y * 0xabc98388u);
#ifdef REFLECTED
    turned = uvec2(scrambled(seed), scrambled(seed ^ 0x5bd1e995u));
#endif
    float drawn = sample_drawn();
    precise vec2 moved = vec2(turned >> 8) * (1.0 / 16777216.0) + place_among(square) + drawn * vec2(0.5385969, 0.6287067);
#ifdef LOBE_MIDDLES
    moved = vec2(0.0); // the naive variant, for the test that shows why
#endif
    return fract(moved);
}

// view: unit, about the normal, which is z.
vec3 visible_normal(vec3 view, float a, vec2 place) {
    precise vec3 stretched = vec3(a * view.x, a * view.y, view.z);
    stretched /= max(length_precise(stretched), 1e-12);
    precise float square = stretched.x * stretched.x + stretched.y * stretched.y;
    vec3 across = square > 1e-14 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(max(square, 1e-14)) : vec3(1.0, 0.0, 0.0);
    precise vec3 other = cross(stretched, across);
    float radius = sqrt(place.x), angle = 6.28318530718 * place.y;
    precise float x = radius * cos(angle), y = radius * sin(angle), half_of = 0.5 * (1.0 + stretched.z);
    y = (1.0 - half_of) * sqrt(max(1.0 - x * x, 0.0)) + half_of * y;
    precise vec3 normal = x * across + y * other + sqrt(max(1.0 - x * x - y * y, 0.0)) * stretched;
    precise vec3 flat_one = vec3(a * normal.x, a * normal.y, max(normal.z, 1e-6));
    return flat_one / length_precise(flat_one);
}

// What would go below the surface meets another microfacet and is turned up again. The footprint takes in as much of the lobe as comes
// to one of the samples so far; less where it would reach back to the surface, as a cone's (shade/cone_ray.glsl).
Secondary_ray glossy_ray(Met met, vec3 normal, Gloss gloss, vec2 place) {
    mat3 about = frame_about(normal);
    float a = gloss.roughness * gloss.roughness;
    precise vec3 view = vec3(-dot(met.direction, about[0]), -dot(met.direction, about[1]), max(-dot(met.direction, about[2]), LEAST_COSINE));
    vec3 drawn = visible_normal(view / length_precise(view), a, place);
    precise vec3 facet = about[0] * drawn.x + about[1] * drawn.y + about[2] * drawn.z;
    precise vec3 reflected = met.direction - facet * (2.0 * dot(met.direction, facet));
    precise float rise = dot(reflected, met.start.normal);
    reflected += met.start.normal * (max(abs(rise), 1e-3) - rise);
    reflected /= max(length_precise(reflected), 1e-6);
    Secondary_ray next = reflected_along(met, reflected);
    precise float lobe = 2.0 * a * sqrt(frame.accumulation.z / float(max(frame.counts.w, 1u)));
    vec3 plane = met.start.normal;
    float height = max(dot(reflected, plane), 1e-3), extent = abs(plane.x) + abs(plane.y) + abs(plane.z);
#ifdef NARROW_LOBES
    lobe = 0.0; // the naive variant, for the test that shows why
#endif
    precise float most = 0.25 * height / (extent * max(next.tau, 1e-3));
    next.growth += min(lobe, most);
    precise float clear = max(next.clear, 4.0 * next.tau * met.width * extent / height);
    next.clear = met.voxel ? next.clear : min(clear, NEVER_CLEAR);
    next.part = gloss.part;
    return next;
}
