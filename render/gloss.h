/* Whether a scene calls for rays that nearly smooth surfaces reflect, maps of roughness looked at. Any
 * thread. */
#ifndef GW_RENDER_GLOSS_H
#define GW_RENDER_GLOSS_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* Of each texture that some material has as its roughness or its clearcoat's, the least of its texels (their
 * green), 0..255; of others 0. *out is the caller's to free; NULL where the scene has no textures. What a
 * footprint averages is no smoother than its smoothest texel. */
gw_code gw_smoothest_texels(const gw_scene *scene, uint8_t **out, gw_error *error);

/* 1 if a material in use, or its clearcoat, is smoother than glossy_roughness somewhere, lit, no mirror
 * (metal of at most mirror_roughness) and no glass, and the scene has any light to reflect. smoothest: as
 * above; NULL: maps may be smooth anywhere. */
int gw_calls_for_gloss(const gw_scene *scene, const uint8_t *smoothest, float mirror_roughness,
                       float glossy_roughness);

#endif
