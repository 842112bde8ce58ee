// The ray that a mirror reflects: about the shading normal, unless that leads below the surface. The footprint goes on from the
// mirror, wider by what the mirror's curvature spreads the rays of one footprint: twice the angle by which its normals turn over it
// (Igehy, Tracing Ray Differentials, 1999). Like a shadow's ray it starts with triangles only (shade/shadow_ray.glsl), or above the
// voxel that it leaves. Needs shade/secondary_ray.glsl before it.
// Of a mirror as it is seen, the largest of its colours.
float reflectance_of(Met met) {
    float grazing = 1.0 - clamp(-dot(met.normal, met.direction), 0.0, 1.0);
    precise float grazing2 = grazing * grazing;
    float brightest = max(met.color.r, max(met.color.g, met.color.b));
    precise float reflectance = brightest + (1.0 - brightest) * (grazing2 * grazing2 * grazing);
    return reflectance;
}

// Along a unit direction above the surface.
Secondary_ray reflected_along(Met met, vec3 reflected) {
    float turn = turn_over(met);
    precise float growth = met.growth + 2.0 * min(turn, 1.0);
    float accepted = met.ray.tau * met.width;
    Secondary_origin from = secondary_origin(met.start, accepted, dot(reflected, met.start.normal),
                                             out_of_reach(met.start, accepted, reflected));
    Secondary_ray next;
    next.origin = from.origin;
    next.direction = reflected;
    next.width = met.width;
    next.growth = growth;
    next.tau = met.ray.tau;
    next.clear = from.clear;
    next.part = mirror_share(met.id) * reflectance_of(met);
#ifdef TRANSMISSION
    next.skipped = GW_NO_TRIANGLE;
#endif
    return next;
}

Secondary_ray reflected_ray(Met met) {
    precise vec3 reflected = met.direction - met.normal * (2.0 * dot(met.direction, met.normal));
    precise vec3 flat_one = met.direction - met.start.normal * (2.0 * dot(met.direction, met.start.normal));
    reflected = dot(reflected, met.start.normal) > 0.0 ? reflected : flat_one;
    return reflected_along(met, reflected);
}
