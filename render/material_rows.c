/* See material_rows.h. */
#include "render/material_rows.h"

#include "base/memory.h"
#include "build/gpu_types.h"
#include "shaders/common/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(gw_gpu_extension) == GW_EXTENSION_ROWS * 16, "rows of an extension");

static const float blackest = 1e30f; /* absorption per length of what lets nothing through */

/* Reflectance at 0 and 90 degrees as KHR_materials_ior and KHR_materials_specular define them. */
static void fill_specular(const gw_material_extension *in, float out[4]) {
    const double step = ((double)in->ior - 1.0) / ((double)in->ior + 1.0);
    for (int i = 0; i < 3; ++i)
        out[i] = in->specular * fminf((float)(step * step) * in->specular_color[i], 1.0f);
    out[3] = in->specular;
}

/* Beer and Lambert: what is left after the distance is the colour. */
static void fill_attenuation(const gw_scene *scene, const gw_material_extension *in, float out[4]) {
    const double distance = ldexp((double)in->attenuation_distance, -scene->exponent); /* rebased */
    for (int i = 0; i < 3; ++i) {
        const double left = in->attenuation_color[i];
        out[i] = !(distance > 0.0) || left >= 1.0 ? 0.0f
                 : left > 0.0                     ? (float)fmin(-log(left) / distance, (double)blackest)
                                                  : blackest;
    }
    out[3] = 0.0f;
}

static void fill_use(const gw_texture_use *in, float rows[2][4]) {
    for (int i = 0; i < 2; ++i) {
        memcpy(rows[i], in->to_uv[i], sizeof in->to_uv[i]);
        rows[i][3] = (float)in->coordinate;
    }
}

static void fill_row(const gw_scene *scene, const gw_material_extension *in, const gw_texture_set *colors,
                     const gw_texture_set *data, gw_gpu_extension *out) {
    const gw_texture_use *uses[] = {&in->normal, &in->metallic_roughness, &in->occlusion, &in->emissive_map,
                                    &in->transmission_map};
    const float factors[4] = {in->normal_scale, in->occlusion_strength, in->roughness, in->metalness};
    const float transmission[4] = {in->transmission, in->ior,
                                   (float)ldexp((double)in->thickness, -scene->exponent), 0};
    out->maps[0] = gw_texture_word(data, in->normal.texture, GW_TEXTURE_NORMAL);
    out->maps[1] = gw_texture_word(data, in->metallic_roughness.texture, GW_TEXTURE_DATA);
    out->maps[2] = gw_texture_word(data, in->occlusion.texture, GW_TEXTURE_DATA);
    out->maps[3] = gw_texture_word(colors, in->emissive_map.texture, GW_TEXTURE_COLOR);
    out->more_maps[0] = gw_texture_word(data, in->transmission_map.texture, GW_TEXTURE_DATA);
    memcpy(out->factors, factors, sizeof factors);
    memcpy(out->emissive, in->emissive, sizeof in->emissive);
    out->emissive[3] = (float)in->unlit;
    fill_specular(in, out->specular);
    memcpy(out->transmission, transmission, sizeof transmission);
    fill_attenuation(scene, in, out->attenuation);
    out->coat[0] = in->clearcoat;
    out->coat[1] = in->clearcoat_roughness;
    memcpy(out->sheen, in->sheen_color, sizeof in->sheen_color);
    out->sheen[3] = in->sheen_roughness;
    for (int i = 0; i < 5; ++i)
        fill_use(uses[i], &out->to_uv[2 * i]);
}

gw_code gw_material_rows_upload(gw_gl *device, const gw_scene *scene, const gw_texture_set *colors,
                                const gw_texture_set *data, gw_gl_buffer *out, gw_error *error) {
    const gw_material_extension none = gw_material_extension_none();
    gw_gpu_extension *rows = NULL;
    gw_code code = gw_allocate((void **)&rows, scene->material_count, sizeof *rows,
                               "material extensions for the GPU", error);
    if (code)
        return code;
    for (uint32_t i = 0; i < scene->material_count; ++i)
        fill_row(scene, scene->extensions ? &scene->extensions[i] : &none, colors, data, &rows[i]);
    code = gw_gl_buffer_create(device, "material extensions", scene->material_count * sizeof *rows, rows,
                               GL_RGBA32UI, out, error);
    free(rows);
    return code;
}
