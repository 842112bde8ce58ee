/* See material_rows.h. */
#include "render/material_rows.h"

#include "base/memory.h"
#include "build/gpu_types.h"
#include "shaders/common/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(gw_gpu_extension) == GW_EXTENSION_ROWS * 16, "rows of an extension");

static const float most = 1e30f; /* also the absorption per length of what lets nothing through */

_Static_assert(GW_EXTENSION_MAP_COUNT == GW_MAP_SHOWN_COUNT - GW_MAP_NORMAL, "maps of an extension");

/* Reflectance as KHR_materials_ior and KHR_materials_specular define it; with maps the shader goes on. */
static void fill_specular(const gw_material_extension *in, float out[4]) {
    const double step = ((double)in->ior - 1.0) / ((double)in->ior + 1.0);
    for (int i = 0; i < 3; ++i)
        out[i] = fminf((float)(step * step) * in->specular_color[i], most);
    out[3] = in->specular;
}

/* Beer and Lambert: what is left after the distance is the colour. */
static void fill_attenuation(const gw_scene *scene, const gw_material_extension *in, float out[4]) {
    const double distance = ldexp((double)in->attenuation_distance, -scene->exponent); /* rebased */
    for (int i = 0; i < 3; ++i) {
        const double left = in->attenuation_color[i];
        out[i] = !(distance > 0.0) || left >= 1.0 ? 0.0f
                 : left > 0.0                     ? (float)fmin(-log(left) / distance, (double)most)
                                                  : most;
    }
    out[3] = 0.0f;
}

static void fill_use(const gw_texture_use *in, float rows[2][4]) {
    for (int i = 0; i < 2; ++i) {
        memcpy(rows[i], in->to_uv[i], sizeof in->to_uv[i]);
        rows[i][3] = (float)in->coordinate;
    }
}

/* In the order of gw_map. */
static void fill_maps(const gw_material_extension *in, const gw_texture_set *colors,
                      const gw_texture_set *data, gw_gpu_extension *out) {
    gw_material_extension copy = *in;
    for (int i = 0; i < GW_EXTENSION_MAP_COUNT; ++i) {
        const gw_map map = (gw_map)(GW_MAP_NORMAL + i);
        const gw_texture_use *use = gw_texture_use_of(&copy, map);
        const gw_texture_kind kind = gw_texture_kind_of(map);
        out->maps[i / 4][i % 4] =
            gw_texture_word(kind == GW_TEXTURE_COLOR ? colors : data, use->texture, kind);
        fill_use(use, &out->to_uv[2 * i]);
    }
}

static void fill_row(const gw_scene *scene, const gw_material_extension *in, const gw_texture_set *colors,
                     const gw_texture_set *data, gw_gpu_extension *out) {
    const float factors[4] = {in->normal_scale, in->occlusion_strength, in->roughness, in->metalness};
    const float transmission[4] = {in->transmission, in->ior,
                                   (float)ldexp((double)in->thickness, -scene->exponent), 0};
    fill_maps(in, colors, data, out);
    memcpy(out->factors, factors, sizeof factors);
    memcpy(out->emissive, in->emissive, sizeof in->emissive);
    out->emissive[3] = (float)in->unlit;
    fill_specular(in, out->specular);
    memcpy(out->transmission, transmission, sizeof transmission);
    fill_attenuation(scene, in, out->attenuation);
    out->coat[0] = in->clearcoat;
    out->coat[1] = in->clearcoat_roughness;
    out->coat[2] = in->clearcoat_normal_scale;
    memcpy(out->sheen, in->sheen_color, sizeof in->sheen_color);
    out->sheen[3] = in->sheen_roughness;
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
