/* The report of a renderer's lights. */
#include "render/renderer_internal.h"

#include "base/portable_math.h"

#include <math.h>

static const char *kind_of(const gw_light_note *note) {
    static const char *const kinds[GW_LIGHT_KINDS] = {"directional", "point", "spot", "rectangle"};
    return note->source == GW_LIGHT_OF_SURFACES ? "surfaces" : kinds[note->kind];
}

static json_t *light_json(const gw_light_note *note, int shadows) {
    static const char *const sources[] = {"scene", "environment", "materials"};
    const int angle = note->kind == GW_LIGHT_DIRECTIONAL && note->source != GW_LIGHT_OF_SURFACES;
    json_t *light =
        json_pack("{s:s, s:s, s:[f,f,f], s:f, s:i}", "kind", kind_of(note), "of", sources[note->source],
                  "irradiance", (double)note->color[0], (double)note->color[1], (double)note->color[2],
                  angle ? "angle_deg" : "extent_m", angle ? 2.0 * note->extent * 180.0 / GW_PI : note->extent,
                  "shadow_rays", shadows ? (int)note->rows : 0);
    if (light && note->reach > 0.0)
        json_object_set_new(light, "reach_m", json_real(note->reach));
    if (light && note->source == GW_LIGHT_OF_SURFACES) {
        json_object_set_new(light, "triangles", json_integer(note->triangles));
        json_object_set_new(light, "folded", json_real(note->folded));
    }
    return light;
}

/* {list[{kind, of, irradiance, angle_deg | extent_m, shadow_rays, reach_m, triangles, folded}],
 * left_out, faint{triangles, share}} */
gw_code gw_renderer_report_lights(const gw_renderer *renderer, json_t *report, gw_error *error) {
    const gw_light_list *list = &renderer->buffers.list;
    const int shadows = (renderer->scene_features & GW_FEATURE_SHADOWS) != 0;
    json_t *lights = json_array();
    int failed = !lights;
    for (uint32_t i = 0; i < list->note_count && !failed; ++i)
        failed = json_array_append_new(lights, light_json(&list->notes[i], shadows));
    json_t *all = failed
                      ? NULL
                      : json_pack("{s:O, s:I, s:{s:I, s:f}}", "list", lights, "left_out",
                                  (json_int_t)list->left_out, "faint", "triangles",
                                  (json_int_t)list->surfaces.faint_triangles, "share", list->surfaces.faint);
    json_decref(lights);
    if (!all || json_object_set_new(report, "lights", all))
        return gw_fail(error, GW_MACHINE, "no memory for the report of lights");
    return GW_OK;
}
