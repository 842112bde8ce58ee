/* See light_list.h. */
#include "render/light_list.h"

#include "base/memory.h"
#include "base/portable_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static float rebased(const gw_scene *scene, double metres) {
    return (float)ldexp(metres, -scene->exponent);
}

/* share = clamp(scale * cosine + offset, 0, 1)^2, as KHR_lights_punctual recommends; 1 where there is no
 * cone. */
static void fill_cone(const gw_light *in, gw_gpu_light *out) {
    out->shape[1] = 1.0f;
    if (in->kind != GW_LIGHT_SPOT)
        return;
    const double inner = gw_cos((double)in->cone[0]), outer = gw_cos((double)in->cone[1]);
    const double scale = 1.0 / fmax(0.001, inner - outer);
    out->shape[0] = (float)scale;
    out->shape[1] = (float)(-outer * scale);
    memcpy(out->axis, in->axis, sizeof in->axis);
}

static void fill_light(const gw_scene *scene, const gw_light *in, gw_gpu_light *out) {
    const int directional = in->kind == GW_LIGHT_DIRECTIONAL;
    for (int i = 0; i < 3; ++i) {
        out->vector[i] =
            directional ? (float)-in->vector[i] : rebased(scene, in->vector[i] - scene->centre[i]);
        out->color[i] = in->color[i];
    }
    out->color[3] = in->range > 0.0f ? 1.0f / in->range / in->range : 0.0f;
    fill_cone(in, out);
}

gw_code gw_light_list_make(const gw_scene *scene, gw_light_list *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    void *memory = NULL;
    gw_code code =
        gw_allocate(&memory, scene->light_count, sizeof(gw_gpu_light), "lights for the GPU", error);
    if (code)
        return code;
    out->rows = memory;
    uint32_t at = 0;
    for (int placed = 0; placed < 2; ++placed)
        for (uint32_t i = 0; i < scene->light_count; ++i)
            if ((scene->lights[i].kind != GW_LIGHT_DIRECTIONAL) == placed) {
                fill_light(scene, &scene->lights[i], &out->rows[at++]);
                *(placed ? &out->placed : &out->directional) += 1;
            }
    return GW_OK;
}

void gw_light_list_finish(gw_light_list *list) {
    free(list->rows);
    memset(list, 0, sizeof *list);
}
