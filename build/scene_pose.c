#include "build/scene_pose.h"

#include "base/memory.h"
#include "build/animation.h"

#include <math.h>
#include <stdlib.h>

struct gw_posed {
    gw_scene view; /* borrows everything but positions and normals */
    const gw_animation *animation;
    gw_pose pose;
    double *world;
    float *turned; /* normals before they are cleaned */
    float *positions, *normals;
    uint64_t held;
};

int gw_scene_rebase_point(const gw_scene *scene, const double world[3], float out[3]) {
    int held = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double rebased = scalbn(world[axis] - scene->centre[axis], -scene->exponent);
        const double inside = fmin(1.0, fmax(-1.0, rebased));
        held |= !(inside == rebased);
        out[axis] = (float)inside + 0.0f; /* -0 becomes +0 */
    }
    return held;
}

int gw_scene_clean_normal(const float normal[3], float out[3]) {
    const double n[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const int usable = isfinite(length) && length > 1e-30;
    for (int axis = 0; axis < 3; axis++)
        out[axis] = usable ? (float)(n[axis] / length) + 0.0f : 0.0f;
    return usable;
}

gw_code gw_posed_create(const gw_scene *scene, gw_posed **out, gw_error *error) {
    gw_posed *posed = NULL;
    *out = NULL;
    gw_code code = gw_allocate((void **)&posed, 1, sizeof *posed, "posed scene", error);
    if (code != GW_OK)
        return code;
    posed->view = *scene;
    posed->animation = scene->animation;
    code = gw_pose_init(scene->animation, &posed->pose, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&posed->world, scene->vertex_count, 3 * sizeof(double), "posed vertices",
                           error);
    if (code == GW_OK)
        code = gw_allocate((void **)&posed->turned, scene->vertex_count, 3 * sizeof(float), "posed vertices",
                           error);
    if (code == GW_OK)
        code = gw_allocate((void **)&posed->positions, scene->vertex_count, 3 * sizeof(float),
                           "posed vertices", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&posed->normals, scene->vertex_count, 3 * sizeof(float), "posed vertices",
                           error);
    if (code != GW_OK) {
        gw_posed_destroy(&posed);
        return code;
    }
    posed->view.positions = posed->positions;
    posed->view.normals = posed->normals;
    gw_posed_move(posed, 0);
    *out = posed;
    return GW_OK;
}

void gw_posed_destroy(gw_posed **address) {
    if (!address || !*address)
        return;
    gw_posed *posed = *address;
    gw_pose_finish(&posed->pose);
    free(posed->world);
    free(posed->turned);
    free(posed->positions);
    free(posed->normals);
    free(posed);
    *address = NULL;
}

void gw_posed_move(gw_posed *posed, int64_t time) {
    gw_pose_at_time(posed->animation, time, &posed->pose);
    gw_pose_vertices(posed->animation, &posed->pose, posed->world, posed->turned);
    posed->held = 0;
    for (size_t v = 0; v < posed->view.vertex_count; v++) {
        posed->held +=
            (uint64_t)gw_scene_rebase_point(&posed->view, posed->world + v * 3, posed->positions + v * 3);
        gw_scene_clean_normal(posed->turned + v * 3, posed->normals + v * 3);
    }
}

const gw_scene *gw_posed_scene(const gw_posed *posed) {
    return &posed->view;
}

uint64_t gw_posed_held(const gw_posed *posed) {
    return posed->held;
}
