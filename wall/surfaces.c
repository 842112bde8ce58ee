#include "wall/surfaces.h"

#include "render/vector3.h"

#include <math.h>
#include <string.h>

/* The plane of a triangle as the scene has it; one that moves is taken as it stands at time 0, which turns at
 * most the way in which the viewer slides along it. */
static void normal_of(const gw_scene *scene, uint32_t triangle, double out[3]) {
    const uint32_t *corners = scene->triangles[triangle];
    double edges[2][3];
    for (int e = 0; e < 2; e++)
        for (int k = 0; k < 3; k++)
            edges[e][k] = (double)scene->positions[3 * (size_t)corners[e + 1] + (size_t)k] -
                          (double)scene->positions[3 * (size_t)corners[0] + (size_t)k];
    gw_cross(edges[0], edges[1], out);
}

static int meet(void *context, const double from[3], const double direction[3], double reach,
                double *distance, double normal[3]) {
    gw_scene_surfaces *surfaces = context;
    const gw_scene *scene = surfaces->scene;
    gw_ray ray = {.minimum = 0, .maximum = (float)ldexp(reach, -scene->exponent)};
    gw_hit hit;
    for (int k = 0; k < 3; k++) {
        ray.origin[k] = (float)ldexp(from[k] - scene->centre[k], -scene->exponent);
        ray.direction[k] = (float)direction[k];
    }
    if (surfaces->error.code ||
        gw_renderer_trace(surfaces->renderer, GW_TRACE_OCTREE, &ray, 1, &hit, NULL, &surfaces->error))
        return 0;
    if (hit.triangle == GW_NO_TRIANGLE || hit.triangle >= scene->triangle_count)
        return 0;
    *distance = ldexp((double)hit.t, scene->exponent);
    normal_of(scene, hit.triangle, normal);
    if (!gw_normalise(normal, 0))
        memcpy(normal, direction, 3 * sizeof *normal); /* met all the same: straight on */
    return 1;
}

gw_surfaces gw_scene_surfaces_of(gw_scene_surfaces *store, gw_renderer *renderer, const gw_scene *scene) {
    *store = (gw_scene_surfaces){.renderer = renderer, .scene = scene};
    return (gw_surfaces){.meet = meet, .context = store};
}
