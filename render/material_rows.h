/* What materials have beyond gw_gpu_material, as the GPU reads it (gw_gpu_extension). Belongs to the thread
 * of its GL device. */
#ifndef GW_RENDER_MATERIAL_ROWS_H
#define GW_RENDER_MATERIAL_ROWS_H

#include "base/gl.h"
#include "base/status.h"
#include "build/scene.h"
#include "render/texture_set.h"

/* Texture units: of the rows, of the second texture coordinates, of the tables of reflection, of the first
 * array of data, of tangents. */
enum {
    GW_UNIT_EXTENSIONS = 17,
    GW_UNIT_SECOND_TEXCOORDS = 18,
    GW_UNIT_ALBEDO = 19,
    GW_UNIT_DATA = 22,
    GW_UNIT_SHEEN = 24,
    GW_UNIT_TANGENTS = 25
};

/* Rows of all materials; those of a scene without extensions change nothing. */
gw_code gw_material_rows_upload(gw_gl *device, const gw_scene *scene, const gw_texture_set *colors,
                                const gw_texture_set *data, gw_gl_buffer *out, gw_error *error);

#endif
