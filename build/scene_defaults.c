/* What a scene shows when its file does not say: every choice is noted. */
#include "build/import_internal.h"

#include "base/memory.h"
#include "base/portable_math.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static gw_code default_light(gw_scene *scene, gw_error *error) {
    static const double travel[3] = {0.45, -0.75, -0.5}; /* from the upper left, in front */
    const double length = sqrt(travel[0] * travel[0] + travel[1] * travel[1] + travel[2] * travel[2]);
    free(scene->lights);
    scene->light_count = 0;
    gw_code code = gw_allocate((void **)&scene->lights, 1, sizeof *scene->lights, "lights", error);
    if (code != GW_OK)
        return code;
    gw_light *light = &scene->lights[scene->light_count++];
    light->kind = GW_LIGHT_DIRECTIONAL;
    for (int i = 0; i < 3; i++) {
        light->vector[i] = travel[i] / length;
        light->color[i] = 2.4f;
    }
    return gw_scene_note(scene, error,
                         "no light in the file: a directional light from the upper left front is used");
}

static gw_code default_surroundings(gw_scene *scene, const gw_scene_given *given, gw_error *error) {
    static const float background[3] = {0.035f, 0.045f, 0.06f};
    gw_code code = GW_OK;
    if (!given->ambient) {
        for (int i = 0; i < 3; i++)
            scene->ambient[i] = 0.6f;
        code = gw_scene_note(scene, error, "no ambient light in the file: 0.6 from everywhere is used");
    }
    if (code == GW_OK && !given->background) {
        memcpy(scene->background, background, sizeof background);
        code = gw_scene_note(scene, error, "no background in the file: a dark blue grey is used");
    }
    return code;
}

/* In front of the bounding box, which fills the height of a picture of 40 degrees or the width of a 16:9 one.
 */
static gw_code default_viewpoint(gw_scene *scene, gw_error *error) {
    static const double fov = 40.0, margin = 1.1, aspect = 16.0 / 9.0;
    gw_code code =
        gw_allocate((void **)&scene->viewpoints, 1, sizeof *scene->viewpoints, "viewpoints", error);
    if (code != GW_OK)
        return code;
    gw_viewpoint *view = &scene->viewpoints[scene->viewpoint_count++];
    double half[3];
    for (int i = 0; i < 3; i++)
        half[i] = 0.5 * scene->bounds[1][i] - 0.5 * scene->bounds[0][i];
    const double reach = fmax(half[1], half[0] / aspect) * margin;
    const double half_fov = fov * GW_PI / 360.0;
    double distance = reach * gw_cos(half_fov) / gw_sin(half_fov) + half[2];
    if (!(distance > half[2])) /* a sheet seen from its edge */
        distance = 2.0 * half[2];
    snprintf(view->name, sizeof view->name, "front");
    memcpy(view->look_at, scene->centre, sizeof view->look_at);
    memcpy(view->eye, scene->centre, sizeof view->eye);
    view->eye[2] += distance;
    view->up[1] = 1.0;
    view->fov = fov;
    return gw_scene_note(scene, error, "no viewpoint in the file: one in front of the bounding box is used");
}

gw_code gw_scene_defaults(gw_scene *scene, const gw_scene_given *given, gw_error *error) {
    gw_code code = given->lights ? GW_OK : default_light(scene, error);
    if (code == GW_OK)
        code = default_surroundings(scene, given, error);
    if (code == GW_OK && scene->viewpoint_count == 0) {
        free(scene->viewpoints);
        scene->viewpoints = NULL;
        code = default_viewpoint(scene, error);
    }
    if (code == GW_OK)
        gw_scene_rehash(scene);
    return code;
}
