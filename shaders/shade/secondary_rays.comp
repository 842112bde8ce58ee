// The secondary rays of one batch of requests.
//
// variants: OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 SMOOTH_NORMALS=1; OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 LOD=1 GAZE=1 SPARSE=1 SMOOTH_NORMALS=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 REFLECTED=1 LOD=1 FRAGMENTS=8u; OCTREE_DEPTH=11 SECONDARY=1 TRANSMISSION=1
// variants: OCTREE_DEPTH=11 SECONDARY=1 TRANSMISSION=1 TRANSMISSION_MAPS=1 DATA_CLASSES=1
// variants: OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 TRANSMISSION=1 REFLECTED=1 LOD=1 SMOOTH_NORMALS=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 TRANSMISSION=1 CONES=1 OCCLUSION=1 DIFFUSE=1 LOD=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 TRANSMISSION=1 CONES=1 OCCLUSION=1; OCTREE_DEPTH=11 SECONDARY=1 CONES=1 OCCLUSION=1 LOD=1 SMOOTH_NORMALS=1 FRAGMENTS=8u; OCTREE_DEPTH=11 SECONDARY=1 MIRROR=1 CONES=1 OCCLUSION=1 DIFFUSE=1 LOD=1 GAZE=1 SPARSE=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 SMOOTH_NORMALS=1; OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 LOD=1 GAZE=1 SPARSE=1 MATERIAL_MAPS=1 DATA_CLASSES=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 CLEARCOAT=1; OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 CLEARCOAT=1 LAYER_MAPS=1 SHEEN=1 SPECULAR=1 DATA_CLASSES=1 LOD=1 FRAGMENTS=8u
// variants: OCTREE_DEPTH=11 SECONDARY=1 GLOSSY=1 MIRROR=1 TRANSMISSION=1 CONES=1 OCCLUSION=1 DIFFUSE=1 REFLECTED=1 LOD=1 CLEARCOAT=1 SHEEN=1 SPECULAR=1 UNLIT=1 FRAGMENTS=8u
#ifndef OCTREE_DEPTH
#define OCTREE_DEPTH 11
#endif
#ifndef FRAGMENTS
#define FRAGMENTS 1u
#endif
layout(local_size_x = 64) in;
#include "common/frame_block.glsl"
uniform uint group_base;
layout(std430, binding = 0) readonly buffer Fragments { uint fragments[]; };
layout(std430, binding = 20) readonly buffer Requests { uint requests[]; };
layout(std430, binding = 26) writeonly buffer Next_rays { uvec4 next_rays[]; };
#if defined(TRANSMISSION) || defined(CONES) || (defined(GLOSSY) && defined(CLEARCOAT))
layout(std430, binding = 19) readonly buffer Asked { uint asked_of[]; };
#endif
#ifdef TRANSMISSION
layout(std430, binding = 28) readonly buffer Media { uvec2 media_of[]; };
#endif
layout(location = 0) uniform uvec3 batch; // first request, number of them, 1 if what they meet may ask for more
#include "trace/fetch.glsl"
#include "trace/pixel.glsl"
#include "shade/surface.glsl"
#include "shade/secondary_kinds.glsl"
#include "shade/secondary_ray.glsl"
#if defined(MIRROR) || defined(TRANSMISSION) || defined(GLOSSY)
#include "shade/reflected_ray.glsl"
#endif
#ifdef TRANSMISSION
#include "shade/refracted_ray.glsl"
#endif
#if defined(CONES) || defined(GLOSSY)
#include "shade/frame_about.glsl"
#endif
#ifdef GLOSSY
#include "shade/glossy_ray.glsl"
#endif
#ifdef CONES
#include "shade/cone_ray.glsl"
#endif

void main() {
    uint at = (group_base + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    bool present = at < batch.y;
    uint request = requests[batch.x + (present ? at : 0u)];
    uint fragment = GW_REQUEST_FRAGMENT(request), word = fragment * GW_FRAGMENT_WORDS;
    Pixel_square square;
    Pixel_ray ray = ray_of_slot(fragment / FRAGMENTS, square);
    Met met = met_by(ray, fragments[word], uintBitsToFloat(fragments[word + 1u]));
    float part = throughput_of(ray, uintBitsToFloat(fragments[word + 2u]));
    float reach = 0.0;
#if defined(MIRROR) || defined(TRANSMISSION) || defined(GLOSSY)
    Secondary_ray next = reflected_ray(met);
#ifdef GLOSSY
    uint seed = lobe_seed(square, fragment / FRAGMENTS);
    Glosses glosses = glosses_at(ray, met.id, uintBitsToFloat(fragments[word + 1u]));
    Gloss gloss = glosses.base;
    vec3 normal = met.normal;
#ifdef CLEARCOAT
    uint asked_kinds = GW_ASKED_KINDS(asked_of[fragment]);
    bool coat = (asked_kinds & GW_RAY_COAT) != 0u && GW_REQUEST_WHICH(request) == coat_ray_of(asked_kinds);
    normal = coat ? glosses.coat_normal : normal;
    if (coat)
        gloss = glosses.coat;
#endif
    Secondary_ray from_lobe = glossy_ray(met, normal, gloss, place_in_lobe(square, seed));
    uint glossy = gloss.share > 0.0 ? GW_GLOSSY_RAY | (unlit_lobe(gloss.roughness, seed) ? GW_UNLIT_RAY : 0u) : 0u;
    if (glossy != 0u)
        next = from_lobe;
#endif
#ifdef TRANSMISSION
    uvec2 media = media_of[fragment / FRAGMENTS];
    Optics optics = optics_of(met.id, met.direction, met.normal, met.metalness, met.passing, media);
    Secondary_ray through = refracted_ray(met, optics, tint_of(optics, met.color));
    bool refracts = optics.sheer && (GW_REQUEST_WHICH(request) == 1u || (GW_ASKED_KINDS(asked_of[fragment]) & GW_RAY_REFLECTED) == 0u);
    next.media = media;
    next.part = optics.sheer ? optics.reflectance : next.part;
    if (refracts)
        next = through;
#if defined(GLOSSY) && defined(REFLECTED)
    // Lights shine straight through as this ray goes on.
    if (refracts)
        glossy = given_rays[(fragment / FRAGMENTS) * GW_SECONDARY_ROWS + 3u].w & GW_UNLIT_RAY;
#endif
#endif
#endif
#ifdef CONES
    uint first_cone = first_cone_of(GW_ASKED_KINDS(asked_of[fragment]));
    bool cone = GW_REQUEST_WHICH(request) >= first_cone;
    Secondary_ray from_cone = cone_ray(met, GW_REQUEST_WHICH(request) - (cone ? first_cone : 0u));
#ifdef TRANSMISSION
    from_cone.media = media;
#endif
#if defined(MIRROR) || defined(TRANSMISSION) || defined(GLOSSY)
    if (cone)
        next = from_cone;
#ifdef GLOSSY
    glossy = cone ? 0u : glossy;
#endif
#else
    Secondary_ray next = from_cone;
#endif
    reach = cone ? ((frame.sampling.w & GW_CONES_LIGHT) != 0u ? frame.cones[0].w : -frame.cones[0].w) : 0.0;
#endif
    precise float throughput = part * next.part;
    uint row = at * GW_SECONDARY_ROWS;
    next_rays[row] = floatBitsToUint(vec4(next.origin, next.width));
    next_rays[row + 1u] = floatBitsToUint(vec4(next.direction, next.growth));
    next_rays[row + 2u] = floatBitsToUint(vec4(present ? next.tau : -1.0, next.clear, batch.z != 0u ? throughput : 0.0, reach));
#ifdef TRANSMISSION
    uvec3 through_what = uvec3(next.media, next.skipped);
#elif defined(GLOSSY)
    const uvec3 through_what = uvec3(0u);
#endif
#ifdef GLOSSY
    next_rays[row + 3u] = uvec4(through_what, (scrambled(seed) & GW_LOBE_SEED) | glossy);
#elif defined(TRANSMISSION)
    next_rays[row + 3u] = uvec4(through_what, 0u);
#endif
}
