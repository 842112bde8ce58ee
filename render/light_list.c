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

/* Metres at which a white surface that faces all of a light reflects the radiance `least`. */
static double reach_of(double red, double green, double blue, double least) {
    return sqrt(fmax(fmax(red, green), blue) / (GW_PI * least));
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

static gw_light_note *add_note(gw_light_list *out, const gw_light *light, gw_light_source source) {
    gw_light_note *note = &out->notes[out->note_count++];
    *note = (gw_light_note){.source = source, .kind = light->kind, .reach = (double)light->range};
    memcpy(note->color, light->color, sizeof note->color);
    note->extent = light->kind == GW_LIGHT_RECTANGLE ? sqrt(gw_light_area(light)) : (double)light->extent;
    return note;
}

/* Its range, or nearer. */
static float end_of(const gw_light *light, double least) {
    const double reach =
        reach_of((double)light->color[0], (double)light->color[1], (double)light->color[2], least);
    /* A range of 0 is none, but a light without light ends at once; and its square is divided by. */
    const float ends = fmaxf((float)reach, 1e-9f);
    return light->range > 0.0f ? fminf(light->range, ends) : ends;
}

static int is_full(gw_light_list *out, uint32_t more) {
    const int full = out->directional + out->placed + more > GW_MOST_LIGHTS;
    out->left_out += full != 0;
    return full;
}

static void add_light(const gw_scene *scene, const gw_light *given, gw_light_source source,
                      const gw_light_knobs *knobs, gw_light_list *out) {
    const unsigned group = given->kind == GW_LIGHT_DIRECTIONAL ? GW_LIGHTS_DIRECTIONAL
                           : given->kind == GW_LIGHT_SPOT      ? GW_LIGHTS_SPOT
                                                               : GW_LIGHTS_POINT;
    gw_light light = *given;
    if (knobs->left_out & group)
        return;
    if (knobs->left_out & GW_LIGHTS_SPOT)
        light.range = 0.0f;
    else if (knobs->light_least > 0.0f && light.kind != GW_LIGHT_DIRECTIONAL)
        light.range = end_of(&light, (double)knobs->light_least);
    const uint32_t samples = has_extent(&light) ? knobs->shadow_samples : 0;
    if (is_full(out, samples > 0 ? samples : 1))
        return;
    gw_light_note *note = add_note(out, &light, source);
    do {
        gw_gpu_light *row = &out->rows[out->directional + out->placed];
        fill_light(scene, &light, row);
        row->vector[3] = source == GW_LIGHT_OF_ENVIRONMENT ? 1.0f : 0.0f;
        if (samples > 0)
            fill_extent(scene, &light, samples, row);
        row->shape[2] = (float)note->rows;
        out->wide |= samples > 0;
        out->ends |= light.range > 0.0f;
        *(light.kind == GW_LIGHT_DIRECTIONAL ? &out->directional : &out->placed) += 1;
    } while (++note->rows < samples);
}

static void add_surfaces(const gw_scene *scene, const gw_emissive_light *light, const gw_light_knobs *knobs,
                         gw_light_list *out) {
    gw_light_note *note = &out->notes[out->note_count++];
    *note = (gw_light_note){.source = GW_LIGHT_OF_SURFACES,
                            .extent = sqrt(light->area),
                            .triangles = light->triangles,
                            .folded = light->folded};
    for (int i = 0; i < 3; ++i)
        note->color[i] = (float)light->color[i];
    if (knobs->emissive_least > 0.0f)
        note->reach =
            reach_of(light->color[0], light->color[1], light->color[2], (double)knobs->emissive_least);
    for (; note->rows < knobs->shadow_samples; ++note->rows) {
        gw_gpu_light *row = &out->rows[out->directional + out->placed];
        for (int i = 0; i < 3; ++i) {
            row->vector[i] = rebased(scene, light->middle[i] - scene->centre[i]);
            row->color[i] = 1.0f / knobs->shadow_samples;
        }
        row->color[3] = note->reach > 0.0 ? (float)(1.0 / note->reach / note->reach) : 0.0f;
        row->shape[1] = 1.0f;
        row->shape[2] = (float)note->rows;
        row->shape[3] = knobs->shadow_samples;
        memcpy(&row->side[0], &light->first_slot, sizeof light->first_slot);
        memcpy(&row->side[1], &light->slot_count, sizeof light->slot_count);
        row->side[3] = GW_LIGHT_EMISSIVE;
        ++out->placed;
        ++out->emissive;
    }
}

/* Slots stand behind all rows. */
static void place_slots(gw_light_list *list) {
    const uint32_t rows = list->directional + list->placed;
    for (uint32_t i = rows - list->emissive; i < rows; ++i) {
        uint32_t place;
        memcpy(&place, &list->rows[i].side[0], sizeof place);
        place = rows * GW_LIGHT_ROWS + place * GW_EMISSIVE_ROWS;
        memcpy(&list->rows[i].side[0], &place, sizeof place);
    }
}

/* Fewer points for each where there are too many lights for so many. */
static uint8_t samples_that_fit(const gw_scene *scene, size_t others, uint8_t samples) {
    for (; samples > 1; samples = (uint8_t)(samples / 4)) {
        size_t rows = others * samples;
        for (uint32_t i = 0; i < scene->light_count; ++i)
            rows += has_extent(&scene->lights[i]) ? samples : 1;
        if (rows <= GW_MOST_LIGHTS)
            return samples;
    }
    return samples;
}

gw_code gw_light_list_make(const gw_scene *scene, const gw_light *environment, uint32_t count,
                           const gw_light_knobs *wanted, gw_light_list *out, gw_error *error) {
    gw_light_knobs fitting = *wanted, *knobs = &fitting;
    memset(out, 0, sizeof *out);
    gw_code code = gw_emissive_lights_make(scene, wanted->emissive_lights, wanted->emissive_faintest,
                                           &out->surfaces, error);
    fitting.shadow_samples =
        samples_that_fit(scene, (size_t)count + out->surfaces.count, wanted->shadow_samples);
    const size_t lights = (size_t)scene->light_count + count + out->surfaces.count,
                 most = lights * (knobs->shadow_samples > 0 ? knobs->shadow_samples : 1);
    if (!code)
        code = gw_allocate((void **)&out->rows, most, sizeof *out->rows, "lights for the GPU", error);
    if (!code)
        code = gw_allocate((void **)&out->notes, lights, sizeof *out->notes, "notes on lights", error);
    if (code) {
        gw_light_list_finish(out);
        return code;
    }
    for (uint32_t i = 0; i < scene->light_count; ++i)
        if (scene->lights[i].kind == GW_LIGHT_DIRECTIONAL)
            add_light(scene, &scene->lights[i], GW_LIGHT_OF_SCENE, knobs, out);
    for (uint32_t i = 0; i < count; ++i)
        add_light(scene, &environment[i], GW_LIGHT_OF_ENVIRONMENT, knobs, out);
    for (uint32_t i = 0; i < scene->light_count; ++i)
        if (scene->lights[i].kind != GW_LIGHT_DIRECTIONAL)
            add_light(scene, &scene->lights[i], GW_LIGHT_OF_SCENE, knobs, out);
    for (uint32_t i = 0; i < out->surfaces.count; ++i)
        if (!is_full(out, knobs->shadow_samples))
            add_surfaces(scene, &out->surfaces.lights[i], knobs, out);
    place_slots(out);
    return GW_OK;
}

size_t gw_light_list_bytes(const gw_light_list *list) {
    return (size_t)(list->directional + list->placed) * sizeof *list->rows +
           list->surfaces.slot_count * sizeof *list->surfaces.slots;
}

void gw_light_list_copy(const gw_light_list *list, void *to) {
    const size_t rows = (size_t)(list->directional + list->placed) * sizeof *list->rows;
    if (rows > 0)
        memcpy(to, list->rows, rows);
    if (list->surfaces.slot_count > 0)
        memcpy((char *)to + rows, list->surfaces.slots,
               list->surfaces.slot_count * sizeof *list->surfaces.slots);
}

gw_light_knobs gw_light_knobs_of(const gw_frame_state *state) {
    return (gw_light_knobs){.environment_lights = state->environment_lights,
                            .shadow_samples = (uint8_t)(1u << 2 * state->shadow_samples),
                            .emissive_lights = state->emissive_lights,
                            .light_least = (float)state->light_least / 65535.0f,
                            .emissive_least = state->emissive_least,
                            .emissive_faintest = state->emissive_faintest};
}

void gw_light_list_finish(gw_light_list *list) {
    gw_emissive_lights_finish(&list->surfaces);
    free(list->rows);
    free(list->notes);
    memset(list, 0, sizeof *list);
}
