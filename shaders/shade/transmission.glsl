// What a surface that lets light through does to a ray. A medium's surface reflects by Fresnel's equations and bends what goes
// on by Snell's law; a thin sheet reflects and bends nothing. Needs shade/surface.glsl before it.
#include "shade/material_extension.glsl"
#include "shade/media.glsl"

struct Optics {
    bool sheer;        // light passes at all
    bool boundary;     // of a medium; else a thin sheet
    bool passed;       // the surface of a medium in which another one counts: as if it were not there
    uvec2 beyond;      // media behind it
    float share;       // of what is not reflected that goes through
    float reflectance; // 1: total reflection
    float eta;         // index before over index behind
    float cosine, cosine_beyond;
    vec3 normal; // that counts, unit, on the ray's side
};

// Of unpolarised light at the smooth border of two dielectrics.
float fresnel_dielectric(float eta, float cosine, out float cosine_beyond) {
    precise float squared = eta * eta * (1.0 - cosine * cosine);
    cosine_beyond = sqrt(max(1.0 - squared, 0.0));
    precise float s = (eta * cosine - cosine_beyond) / max(eta * cosine + cosine_beyond, 1e-9);
    precise float p = (eta * cosine_beyond - cosine) / max(eta * cosine_beyond + cosine, 1e-9);
    precise float reflectance = 0.5 * (s * s + p * p);
    return squared >= 1.0 ? 1.0 : reflectance;
}

float index_of_medium(uint medium) {
    float index = max(extension_row(max(medium, 1u) - 1u, GW_EXTENSION_TRANSMISSION).y, 1.0);
    return medium == 0u ? 1.0 : index;
}

// Whether a ray of that direction meets the triangle's back; as trace/triangle.glsl tells.
bool meets_back(uint triangle, vec3 direction) {
    vec3 a = uintBitsToFloat(TRIANGLE(triangle, 0).xyz);
    precise vec3 ab = uintBitsToFloat(TRIANGLE(triangle, 1).xyz) - a, ac = uintBitsToFloat(TRIANGLE(triangle, 2).xyz) - a;
    precise vec3 normal = vec3(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
    precise float along = direction.x * normal.x + direction.y * normal.y + direction.z * normal.z;
    return along > 0.0;
}

// direction: of the ray, unit; normal: shading normal on its side; passing: of the surface; media: that the ray is in.
Optics optics_of(uint id, vec3 direction, vec3 normal, float metalness, float passing, uvec2 media) {
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    uint triangle = voxel ? 0u : id;
    uint material = texelFetch(faces, int(triangle)).w;
    vec4 row = extension_row(material, GW_EXTENSION_TRANSMISSION);
    uint flags = voxel ? 0u : TRIANGLE(triangle, 0).w;
    bool boundary = (flags & GW_TRIANGLE_BOUNDARY) != 0u, back = meets_back(triangle, direction);
    uint medium = material + 1u;
    uvec2 entered = in_medium(media, medium) ? media : with_medium(media, medium);
    uvec2 beyond = back ? without_medium(media, medium) : entered;
    Optics optics;
    optics.sheer = (flags & GW_TRIANGLE_SHEER) != 0u;
    optics.beyond = boundary ? beyond : media;
    optics.boundary = boundary;
    optics.passed = boundary && innermost_medium(beyond) == innermost_medium(media);
    optics.share = optics.sheer ? row.x * passing * (1.0 - metalness) : 0.0;
    precise float eta = index_of_medium(innermost_medium(media)) /
                        (boundary ? index_of_medium(innermost_medium(beyond)) : max(row.y, 1.0));
    float cosine_beyond;
    optics.cosine = clamp(-dot(direction, normal), 1e-4, 1.0);
    optics.reflectance = fresnel_dielectric(eta, optics.cosine, cosine_beyond);
    optics.eta = boundary ? eta : 1.0;
    optics.cosine_beyond = boundary ? cosine_beyond : optics.cosine;
    optics.normal = normal;
    return optics;
}

// What of a light passes a surface on its straight way, as a shadow shows it: bent rays would need a search. What a medium absorbs
// between its surfaces is not in it.
vec3 straight_through(uint triangle, Surface surface, vec3 direction) {
    uint material = texelFetch(faces, int(triangle)).w;
    vec4 row = extension_row(material, GW_EXTENSION_TRANSMISSION);
    uint flags = TRIANGLE(triangle, 0).w;
    float cosine_beyond;
    float cosine = clamp(abs(dot(surface.normal, normalize(direction))), 1e-4, 1.0);
    precise float through = (1.0 - fresnel_dielectric(1.0 / max(row.y, 1.0), cosine, cosine_beyond)) * row.x *
                            (1.0 - surface.metalness) * passing_of(surface);
    precise vec3 seen = through * ((flags & GW_TRIANGLE_BOUNDARY) != 0u ? sqrt(surface.base_color) : surface.base_color);
    return (flags & GW_TRIANGLE_SHEER) != 0u ? seen : vec3(0.0);
}

// A colour of the surface that a medium's light passes twice, on the way in and out, a sheet's once.
vec3 tint_of(Optics optics, vec3 base_color) {
    return optics.boundary ? sqrt(base_color) : base_color;
}
