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

/* Of a light with an extent, which `samples` rows share. */
static void fill_extent(const gw_scene *scene, const gw_light *in, uint32_t samples, gw_gpu_light *out) {
    double share = 1.0 / samples;
    if (in->kind == GW_LIGHT_RECTANGLE) {
        for (int i = 0; i < 3; ++i) {
            out->axis[i] = rebased(scene, (double)in->sides[0][i]);
            out->side[i] = rebased(scene, (double)in->sides[1][i]);
        }
        out->side[3] = 1.0f;
    } else if (in->kind == GW_LIGHT_DIRECTIONAL) {
        const double sine = gw_sin(0.5 * (double)in->extent), depth = 2.0 * sine * sine;
        out->axis[3] = (float)depth;
        share /= 1.0 - 0.5 * depth; /* so that a surface which faces its middle has its irradiance */
    } else {
        out->axis[3] = rebased(scene, (double)in->extent);
    }
    for (int i = 0; i < 3; ++i)
        out->color[i] = (float)((double)out->color[i] * share);
    out->shape[3] = (float)samples;
}

static int has_extent(const gw_light *light) {
    return light->extent > 0.0f || light->kind == GW_LIGHT_RECTANGLE;
}

static void add_light(const gw_scene *scene, const gw_light *light, int environment,
                      const gw_light_knobs *knobs, gw_light_list *out) {
    const uint32_t samples = has_extent(light) ? knobs->shadow_samples : 0;
    uint32_t part = 0;
    do {
        gw_gpu_light *row = &out->rows[out->directional + out->placed];
        fill_light(scene, light, row);
        row->vector[3] = environment ? 1.0f : 0.0f;
        if (samples > 0)
            fill_extent(scene, light, samples, row);
        row->shape[2] = (float)part;
        out->wide |= samples > 0;
        *(light->kind == GW_LIGHT_DIRECTIONAL ? &out->directional : &out->placed) += 1;
    } while (++part < samples);
}

gw_code gw_light_list_make(const gw_scene *scene, const gw_light *environment, uint32_t count,
                           const gw_light_knobs *knobs, gw_light_list *out, gw_error *error) {
    const size_t most = knobs->shadow_samples > 0 ? knobs->shadow_samples : 1;
    memset(out, 0, sizeof *out);
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, ((size_t)scene->light_count + count) * most, sizeof(gw_gpu_light),
                               "lights for the GPU", error);
    if (code)
        return code;
    out->rows = memory;
    for (uint32_t i = 0; i < scene->light_count; ++i)
        if (scene->lights[i].kind == GW_LIGHT_DIRECTIONAL)
            add_light(scene, &scene->lights[i], 0, knobs, out);
    for (uint32_t i = 0; i < count; ++i)
        add_light(scene, &environment[i], 1, knobs, out);
    for (uint32_t i = 0; i < scene->light_count; ++i)
        if (scene->lights[i].kind != GW_LIGHT_DIRECTIONAL)
            add_light(scene, &scene->lights[i], 0, knobs, out);
    return GW_OK;
}

gw_light_knobs gw_light_knobs_of(const gw_frame_state *state) {
    return (gw_light_knobs){.environment_lights = state->environment_lights,
                            .shadow_samples = (uint8_t)(1u << 2 * state->shadow_samples)};
}

void gw_light_list_finish(gw_light_list *list) {
    free(list->rows);
    memset(list, 0, sizeof *list);
}
