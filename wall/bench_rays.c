/* The primary rays that benches trace. */
#include "wall/bench.h"

#include "base/memory.h"
#include "wall/sim_options.h"

#include <math.h>

/* The ray from the eye (rebased) through the centre of a pixel of the plane. */
static void aim_ray(gw_ray *ray, const gw_plane *plane, const gw_similarity *placement, const gw_scene *scene,
                    const double eye[3], const uint32_t pixel[2]) {
    double point[3], target[3], length = 0;
    for (int k = 0; k < 3; k++)
        point[k] =
            plane->corner[k] + (pixel[0] + 0.5) * plane->step_x[k] + (pixel[1] + 0.5) * plane->step_y[k];
    gw_wall_to_rebased(placement, scene, point, target);
    for (int k = 0; k < 3; k++)
        length += (target[k] - eye[k]) * (target[k] - eye[k]);
    length = sqrt(length);
    for (int k = 0; k < 3; k++) {
        ray->origin[k] = (float)eye[k];
        ray->direction[k] = (float)((target[k] - eye[k]) / length);
    }
    ray->maximum = 1e30f;
}

void gw_bench_ray_size(const gw_bench *bench, uint32_t size[2]) {
    size[0] = bench->size[0];
    size[1] = bench->size[1];
    if (!size[0]) {
        size[0] = bench->quick ? 160 : 1024;
        size[1] = bench->quick ? 90 : 576;
    }
}

gw_code gw_bench_rays(const gw_bench *bench, gw_ray **rays, size_t *count, gw_error *error) {
    gw_wall_options wall;
    gw_layout layout;
    gw_similarity placement;
    const gw_scene *scene = bench->model.scene;
    uint32_t size[2];
    gw_bench_ray_size(bench, size);
    gw_wall_options_init(&wall, 1, 1);
    wall.size[0] = size[0];
    wall.size[1] = size[1];
    gw_code code = gw_wall_layout(&wall, &layout, error);
    if (!code)
        code = gw_place_scene(scene, layout.size[0], layout.size[1], layout.centre, layout.eye, &placement,
                              error);
    *count = (size_t)size[0] * size[1];
    if (!code)
        code = gw_allocate((void **)rays, *count, sizeof **rays, "rays", error);
    if (code)
        return code;
    const gw_plane *plane = &layout.tiles[0].plane;
    double eye[3];
    gw_wall_to_rebased(&placement, scene, layout.eye, eye);
    size_t i = 0;
    for (size_t block = 0; i < *count; block++) {
        uint32_t pixel[2];
        /* Blocks of 8x8 pixels in Morton order, as the renderer sends them: neighbours stay neighbours. */
        uint32_t columns = (size[0] + 7) / 8;
        for (uint32_t within = 0; within < 64; within++) {
            pixel[0] =
                (uint32_t)(block % columns) * 8 + ((within & 1) | (within >> 1 & 2) | (within >> 2 & 4));
            pixel[1] =
                (uint32_t)(block / columns) * 8 + ((within >> 1 & 1) | (within >> 2 & 2) | (within >> 3 & 4));
            if (pixel[0] < size[0] && pixel[1] < size[1])
                aim_ray(&(*rays)[i++], plane, &placement, scene, eye, pixel);
        }
    }
    return GW_OK;
}
