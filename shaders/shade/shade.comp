// Fragments to pixels: each is lit and added with its weight; pixels whose ray is done are encoded, rays that go on are
// queued with what has been added so far.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=11 LOD=1 GAZE=1 TEXTURES=1 TEXTURE_CLASSES=4 SMOOTH_NORMALS=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 ACCUMULATE=1 TONE=1 EXPOSURE=1 DITHER=1 METERING=1; OCTREE_DEPTH=11 ALPHA=1 RESUME=1 VERTEX_COLORS=1 EMISSIVE=1 POINT_LIGHTS=1 DIRECTIONAL_LIGHTS=1 COUNT=1
// variants: OCTREE_DEPTH=11 LOD=1 GAZE=1 SPARSE=1 GUIDES=1 EMISSIVE=1 VOXEL_EMISSION=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 LOD=1 GAZE=1 GUIDES=1 RESUME=1 FRAGMENTS=8u; OCTREE_DEPTH=11 UNTIL_COARSE=1 GUIDES=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 COUNT=1 DEBUG_VIEW=8; OCTREE_DEPTH=11 COUNT=1 DEBUG_VIEW=9; OCTREE_DEPTH=11 COUNT=1 DEBUG_VIEW=10
// variants: OCTREE_DEPTH=11 LOD=1 GAZE=1 SHADOWS=1 POINT_LIGHTS=1 DIRECTIONAL_LIGHTS=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 UNTIL_COARSE=1 SHADOWS=1 SPOT_LIGHTS=1 AREA_LIGHTS=1 ENVIRONMENT=1 ALPHA=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 LOD=1 SECONDARY=1 MIRROR=1 FRAGMENTS=8u; OCTREE_DEPTH=11 REFLECTED=1 SECONDARY=1 MIRROR=1; OCTREE_DEPTH=11 REFLECTED=1 SHADOWS=1 POINT_LIGHTS=1 ALPHA=1 RESUME=1
// variants: OCTREE_DEPTH=11 SECONDARY=1 ALPHA=1 TRANSMISSION=1 ABSORPTION=1; OCTREE_DEPTH=11 REFLECTED=1 SECONDARY=1 ALPHA=1 TRANSMISSION=1 LOD=1 RESUME=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 NORMAL_MAPS=1 MATERIAL_MAPS=1 EMISSIVE_MAPS=1 MAP_PLACEMENT=1 SQUARE_TEXELS=1 TEXTURE_CLASSES=1 DATA_CLASSES=2
// variants: OCTREE_DEPTH=11 SPECULAR=1 CLEARCOAT=1 SHEEN=1 UNLIT=1 DIRECTIONAL_LIGHTS=1
// variants: OCTREE_DEPTH=11 SPECULAR=1 SPECULAR_MAPS=1 CLEARCOAT=1 SHEEN=1 LAYER_MAPS=1 MAP_PLACEMENT=1 TEXTURE_CLASSES=1 DATA_CLASSES=1
// variants: OCTREE_DEPTH=11 LOD=1 SPECULAR_MAPS=1 LAYER_MAPS=1 FRAGMENTS=8u; OCTREE_DEPTH=11 SECONDARY=1 ALPHA=1 TRANSMISSION=1 TRANSMISSION_MAPS=1 DATA_CLASSES=1
// variants: OCTREE_DEPTH=11 LOD=1 SPECULAR=1 CLEARCOAT=1 SHEEN=1 UNLIT=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 LOD=1 NORMAL_MAPS=1 MATERIAL_MAPS=1 DATA_CLASSES=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 LOD=1 REFLECTED=1 SECONDARY=1 CONES=1 OCCLUSION=1 DIFFUSE=1 MIRROR=1 TRANSMISSION=1 ALPHA=1 ABSORPTION=1 UNLIT=1 SHEEN=1 CLEARCOAT=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 LOD=1 SECONDARY=1 CONES=1 OCCLUSION=1 FRAGMENTS=8u; OCTREE_DEPTH=11 LOD=1 REFLECTED=1 SECONDARY=1 CONES=1 OCCLUSION=1 DIFFUSE=1 MIRROR=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 EMISSIVE_LIGHTS=1 EMISSIVE=1 CLEARCOAT=1; OCTREE_DEPTH=11 LOD=1 REFLECTED=1 SECONDARY=1 CONES=1 DIFFUSE=1 MIRROR=1 TRANSMISSION=1 ALPHA=1 EMISSIVE_LIGHTS=1 SHADOWS=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 CLEARCOAT=1 EMISSIVE_LIGHTS=1 ENVIRONMENT=1 DIRECTIONAL_LIGHTS=1
// variants: OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1; OCTREE_DEPTH=11 LOD=1 REFLECTED=1 SECONDARY=1 GLOSSY=1 MIRROR=1 TRANSMISSION=1 CONES=1 OCCLUSION=1 ALPHA=1 EMISSIVE_LIGHTS=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 DEBUG_VIEW=1; OCTREE_DEPTH=11 COUNT=1 DEBUG_VIEW=2; OCTREE_DEPTH=11 GAZE=1 DEBUG_VIEW=4
// variants: OCTREE_DEPTH=11 GAZE=1 SPARSE=1 DEBUG_VIEW=5; OCTREE_DEPTH=11 GAZE=1 DEBUG_VIEW=6; OCTREE_DEPTH=11 GAZE=1 DEBUG_VIEW=7
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
#ifndef FRAGMENTS
#define FRAGMENTS 1u
#endif
#ifndef DEBUG_VIEW
#define DEBUG_VIEW 0
#endif
#ifndef TEXTURE_CLASSES
#define TEXTURE_CLASSES 0
#endif
layout(local_size_x = 64) in;
#include "common/frame_block.glsl"
#include "common/finite.glsl"
uniform uint group_base;
layout(std430, binding = 0) readonly buffer Fragments { uint fragments[]; };
layout(std430, binding = 1) readonly buffer Statuses { uvec2 statuses[]; };
#ifdef ALPHA
layout(std430, binding = 2) buffer States { uint states[]; };
#endif
layout(std430, binding = 3) buffer Totals { uint totals[]; };
layout(std430, binding = 4) readonly buffer Queue { uint queue[]; };
layout(std430, binding = 5) writeonly buffer NextQueue { uint next_queue[]; };
#ifdef COUNT
layout(std430, binding = 6) readonly buffer Work { uvec4 work_of[]; };
#endif
#if defined(DIFFUSE) && defined(REFLECTED)
#define BRINGS_EVERYWHERE 1 // what of a cone's light comes from everywhere, as with_cones() asks
#endif
#ifdef REFLECTED
layout(std430, binding = 27) buffer Given_sums { vec4 sums[]; };
#else
layout(std430, binding = 7) buffer Sums { vec4 sums[]; };
#endif
#ifdef TRANSMISSION
layout(std430, binding = 28) buffer Media { uvec2 media_of[]; }; // of rays, by slot
#endif
#ifdef GUIDES
layout(std430, binding = 21) buffer Guides { uvec4 guides[]; };
#ifdef SPARSE
#define GUIDE_NORMAL(normal) packSnorm4x8(vec4(normal, 0.0))
#else // for those who measure, of rays of pixels: finer, and in the end how much of the ray met something
#include "common/octahedral.glsl"
#define GUIDE_NORMAL(normal) packSnorm2x16(octahedral_encode(normal))
#endif
#endif
#ifdef RESUME
layout(location = 0) uniform uint queue_length;
#endif
#include "trace/fetch.glsl"
#include "trace/pixel.glsl"
#include "blend/opacity.glsl"
#include "shade/surface.glsl"
#include "shade/environment.glsl"
#include "shade/lights.glsl"
#ifdef SECONDARY
#include "shade/secondary_light.glsl"
#endif
#ifdef TRANSMISSION
#include "shade/absorption.glsl"
#endif
#include "shade/debug_view.glsl"
#ifndef SPARSE
#include "blend/store_pixel.glsl"
#endif

#ifdef ALPHA
// The last fragment's opacity was not known when it was traced: the ray's own bookkeeping is brought up to date here.
// Returns the fragment's weight; left is what remains of the ray.
float composite_provisional(uint slot, float opacity, inout float left) {
    uint at = slot * GW_STATE_WORDS + GW_STATE_TRANSMITTANCE;
    transmittance = uintBitsToFloat(states[at]);
    group_opacity = uintBitsToFloat(states[at + 1u]);
    group_lean = 0.0; // a cut-out has no back of its own
    float weight = composite(opacity, 0.0, 1.0);
    states[at + 1u] = floatBitsToUint(group_opacity);
    left = remaining();
    return weight;
}
#endif

#ifdef COUNT
// What effects of materials got to do: fragments of each.
void count_material(uint id) {
    if ((id & GW_FRAGMENT_VOXEL) == 0u)
        atomicAdd(totals[GW_TOTAL_WORDS + texelFetch(faces, int(id)).w], 1u);
}
#endif

// sum: radiance and weight of all that was shaded; left: what of the ray met nothing.
vec3 finish(vec4 sum, float left, vec3 background) {
    float behind = left >= OPAQUE_REMAINDER ? left : 0.0;
    precise vec3 met = sum.w > 0.0 ? sum.rgb * ((1.0 - behind) / sum.w) : (1.0 - behind) * background;
    return met + behind * background;
}

#if defined(CONES) && defined(REFLECTED)
#define IS_CONE(ray) ((ray).reach != 0.0)

// What a cone meets counts fully up to half of its reach, and not at all from there on.
float cone_weight(Pixel_ray ray, float t, float weight) {
    precise float share = clamp(2.0 - 2.0 * t / max(abs(ray.reach), 1e-30), 0.0, 1.0);
    precise float counted = weight * share;
    return IS_CONE(ray) ? counted : weight;
}

// What of a cone met nothing that counts.
float open_share(Pixel_ray ray, vec4 sum, float left) {
    float open = max(left, 1.0 - sum.w);
    return IS_CONE(ray) ? (open >= OPAQUE_REMAINDER ? open : 0.0) : left;
}
#else
#define IS_CONE(ray) false
#endif

void main() {
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
#ifdef RESUME
    bool present = at < queue_length;
    uint slot = queue[present ? at : 0u];
#else
    bool present = true;
    uint slot = at;
#endif
    uvec2 status = statuses[slot];
    if (!present || (status.x & GW_STATUS_OUTSIDE) != 0u)
        return;
    Pixel_square square;
    Pixel_ray ray = ray_of_slot(slot, square);
    vec3 view = -normalize(ray.direction);
    seed_lights(square, ray);
    bool unlit = IS_CONE(ray);
#if defined(GLOSSY) && defined(REFLECTED)
    unlit = unlit || (given_rays[slot * GW_SECONDARY_ROWS + 3u].w & GW_UNLIT_RAY) != 0u;
#endif
    uint count = GW_STATUS_COUNT(status.x);
    float left = uintBitsToFloat(status.y);
    bool suspended = (status.x & GW_STATUS_SUSPENDED) != 0u;
    precise vec4 sum = vec4(0.0);
    uint row = slot;
#ifdef BRINGS_EVERYWHERE
    row = slot * GW_BROUGHT_ROWS_DIFFUSE;
    precise vec4 everywhere = vec4(0.0);
#endif
#ifdef RESUME
    sum = sums[row];
#ifdef BRINGS_EVERYWHERE
    everywhere = sums[row + 1u];
#endif
#endif
#ifdef GUIDES
    uvec4 guide = uvec4(GW_NO_TRIANGLE, 0u, 0u, 0u);
#ifdef RESUME
    guide = guides[slot];
#endif
#endif
#ifdef TRANSMISSION
    uvec2 media = media_of[slot], passed_into = media;
#endif
    for (uint i = 0u; i < count; ++i) {
        uint word = (slot * FRAGMENTS + i) * GW_FRAGMENT_WORDS;
        uint id = fragments[word];
        float t = uintBitsToFloat(fragments[word + 1u]);
        float weight = uintBitsToFloat(fragments[word + 2u]);
        Surface surface = surface_of_fragment(id, t, ray);
#ifdef TRANSMISSION
        Optics optics = optics_of(id, -view, surface.normal, surface.metalness, passing_of(surface), media);
        if (optics.boundary)
            surface.alpha = optics.passed ? 0.0 : 1.0;
#endif
#ifdef ALPHA
        if (i + 1u == count && (status.x & GW_STATUS_PROVISIONAL) != 0u) {
            weight = composite_provisional(slot, weight * surface.alpha, left);
            suspended = suspended && left >= OPAQUE_REMAINDER;
        }
#endif
#ifdef GUIDES
        if (weight > uintBitsToFloat(guide.w))
            guide = uvec4(id, floatBitsToUint(t), GUIDE_NORMAL(surface.normal), floatBitsToUint(weight));
#endif
#ifdef COUNT
        count_material(id);
#endif
#if defined(CONES) && defined(REFLECTED)
        weight = cone_weight(ray, t, weight);
#endif
        see_surface(surface, view);
        Surface rest = surface;
#ifdef TRANSMISSION
        rest.base_color *= 1.0 - optics.share; // what goes through is not scattered
#endif
#if defined(CONES) && defined(REFLECTED) && defined(EMISSIVE_LIGHTS)
        // Lights bring it where cones start.
        float brightest = max(max(rest.emissive.r, rest.emissive.g), rest.emissive.b), least = frame.environment_mean.w;
        rest.emissive *= IS_CONE(ray) && least > 0.0 && brightest >= least ? 1.0 - lit_of(rest) : 1.0;
#endif
        vec2 seen = vec2(0.0);
#if defined(EMISSIVE_LIGHTS) && defined(MIRROR)
        seen.x = (GW_ASKED_KINDS(asked_of[slot * FRAGMENTS + i]) & GW_RAY_REFLECTED) != 0u ? mirror_share(id) : 0.0;
#endif
#if defined(EMISSIVE_LIGHTS) && defined(TRANSMISSION)
        bool reflects = optics.sheer && (GW_ASKED_KINDS(asked_of[slot * FRAGMENTS + i]) & GW_RAY_REFLECTED) != 0u;
        seen.x = reflects ? 1.0 : seen.x;
#endif
#if defined(EMISSIVE_LIGHTS) && defined(GLOSSY)
        float gloss_roughness, gloss = glossy_share(id, rest, gloss_roughness);
        seen.x = (GW_ASKED_KINDS(asked_of[slot * FRAGMENTS + i]) & GW_RAY_REFLECTED) != 0u ? max(seen.x, gloss) : seen.x;
#ifdef CLEARCOAT
        seen.y = (GW_ASKED_KINDS(asked_of[slot * FRAGMENTS + i]) & GW_RAY_COAT) != 0u ? coat_share(id, rest) : 0.0;
#ifdef COATS_LIT_TWICE
        seen.y = 0.0; // the naive variant, for the test that shows why
#endif
#endif
#endif
#ifdef BRINGS_EVERYWHERE
        bool mirrors = true;
#ifdef TRANSMISSION
        mirrors = !optics.sheer; // what it brings stands in its place
#endif
        precise vec3 reflected_everywhere = reflect_environment(rest, view, irradiance_around(rest),
                                                                mirrors ? radiance_around(rest, view) : vec3(0.0),
                                                                radiance_around_coat(rest, view));
#endif
        precise vec3 lit = light_surface(rest, view, slot * FRAGMENTS + i, seen);
#ifdef SECONDARY
        lit = with_secondary(lit, rest, view, id, slot * FRAGMENTS + i);
#endif
#ifdef TRANSMISSION
        lit = with_transmitted(lit, surface, view, optics, asked_of[slot * FRAGMENTS + i], unlit);
        lit *= left_of_light(media, t * length_precise(ray.direction));
#ifdef BRINGS_EVERYWHERE
        reflected_everywhere *= left_of_light(media, t * length_precise(ray.direction));
#endif
        if (optics.passed)
            passed_into = optics.beyond;
#endif
        sum += weight * vec4(debug_fragment(lit, surface, id), 1.0);
#ifdef BRINGS_EVERYWHERE
        vec3 passed_on = diffuse_share(rest) * share_below(rest) * lit_of(rest);
        everywhere += weight * vec4(reflected_everywhere, dot(passed_on, vec3(0.2126, 0.7152, 0.0722)));
#endif
    }
#ifdef GUIDES
    guides[slot] = guide;
#endif
    if (suspended) {
#ifdef TRANSMISSION
        media_of[slot] = passed_into;
#endif
#if defined(SHADOWS) && (defined(LOD) || defined(UNTIL_COARSE))
        keep_visibilities(slot);
#endif
        sums[row] = sum;
#ifdef BRINGS_EVERYWHERE
        sums[row + 1u] = everywhere;
#endif
        next_queue[atomicAdd(totals[2], 1u)] = slot;
        return;
    }
#if defined(GUIDES) && !defined(SPARSE)
    guides[slot].w = floatBitsToUint(1.0 - left);
#endif
    vec3 background = radiance_behind(ray, unlit);
#if defined(CONES) && defined(REFLECTED)
    left = open_share(ray, sum, left);
    background = IS_CONE(ray) ? vec3(0.0) : background;
#endif
#if defined(GLOSSY) && defined(REFLECTED)
    bool glossy = (given_rays[slot * GW_SECONDARY_ROWS + 3u].w & GW_GLOSSY_RAY) != 0u;
    background = glossy ? vec3(0.0) : background; // what asked for the ray knows it better
    left = glossy && left < OPAQUE_REMAINDER ? 0.0 : left;
#endif
    vec3 color = finish(sum, left, background);
#ifdef COUNT
    uvec4 work = work_of[slot];
#else
    const uvec4 work = uvec4(0u);
#endif
    color = debug_pixel(color, square, ray, work);
    if (!finite(color)) {
        atomicAdd(totals[1], 1u);
        color = frame.background.rgb;
    }
#if defined(SPARSE) || defined(REFLECTED)
    sums[row] = vec4(color, left); // shaders/blend, or what asked for the ray, takes it from here
#ifdef BRINGS_EVERYWHERE
    float counts = sum.w > 0.0 ? (1.0 - left) / sum.w : 0.0; // as finish() has it
    vec4 part = everywhere * counts;
    sums[row + 1u] = IS_CONE(ray) && finite(part.rgb) && finite(part.www) ? part : vec4(0.0);
#endif
#else
    store_pixel(square.first - frame.chunk.xy, color);
#endif
}
