/* Materials as the JSON of a glTF 2.0 file has them: which pictures they read, with which texture
 * coordinates, and what the material extensions say. Reads untrusted JSON; any thread. */
#ifndef GW_BUILD_GLTF_MATERIAL_H
#define GW_BUILD_GLTF_MATERIAL_H

#include "base/status.h"
#include "build/gltf.h"
#include "build/gltf_data.h"
#include "build/source_model.h"

#include <jansson.h>
#include <stdint.h>

/* What the material says of a map (a textureInfo object), NULL when it has none. With specular-glossiness the
 * base colour is its diffuse map. */
const json_t *gw_gltf_map(const json_t *material, gw_map map);

/* Sets of texture coordinates (TEXCOORD_n) that the material's maps read: [0] that of the base colour, or of
 * its first map; [1] the first other one. -1: none. */
void gw_gltf_texcoord_sets(const json_t *material, int32_t sets[2]);

/* uv of the picture = to_uv * (u, v, 1): the map's KHR_texture_transform. */
void gw_gltf_texture_transform(const json_t *map, double to_uv[2][3]);

/* Factors of the extensions (and of the core's maps); 1 when anything differs from none. */
int gw_gltf_extension(const json_t *material, const gw_material *core, gw_material_extension *out);

int32_t gw_gltf_texcoord_set(const json_t *map); /* TEXCOORD_n of one */

/* Colour at 0 degrees and glossiness of KHR_materials_pbrSpecularGlossiness; left as it is without that. */
void gw_gltf_specular(const json_t *material, float specular[4]);

/* Points source->maps to sources of the model, which are added as needed; names in notes what no source can
 * stand for. */
gw_code gw_gltf_map_sources(gw_gltf_data *data, const json_t *material, uint32_t index,
                            gw_source_model *model, gw_error *error);

#endif
