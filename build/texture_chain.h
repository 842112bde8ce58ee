/* Mip chains of textures for the voxel payload: linear light, integer averages, the same bytes on every
 * machine. Colour is averaged with alpha as weight, so that the colour of transparent texels does not bleed.
 * Host only; any thread. */
#ifndef GW_BUILD_TEXTURE_CHAIN_H
#define GW_BUILD_TEXTURE_CHAIN_H

#include "base/status.h"
#include "build/scene.h"

#include <stddef.h>
#include <stdint.h>

/* One texel: red, green, blue (linear, 0..65535) and alpha (0..65535). */
typedef struct gw_chain_texel {
    uint16_t red, green, blue, alpha;
} gw_chain_texel;

/* One chain inside the common texel array: level 0 has 2^width_bits x 2^height_bits texels, level i half of
 * each side, at least 1; levels follow each other; the last is 1 x 1. */
typedef struct gw_texture_chain {
    uint32_t offset; /* of level 0, in texels */
    uint32_t width_bits, height_bits;
} gw_texture_chain;

typedef struct gw_texture_chains {
    uint32_t count;
    gw_texture_chain *chains;
    size_t texel_count, texel_capacity;
    gw_chain_texel *texels;
    int32_t *chain_of; /* [material_count] chain of the material's base colour, -1 for none */
} gw_texture_chains;

/* Chains for all base-colour textures that materials name, level 0 at most maximum_side. A material with an
 * alpha cut-off gets a chain whose alpha is cut first and averaged then. */
gw_code gw_texture_chains_init(const gw_scene *scene, uint32_t maximum_side, gw_texture_chains *out,
                               gw_error *error);
void gw_texture_chains_finish(gw_texture_chains *chains);

#endif
