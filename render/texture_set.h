/* Textures on the GPU: a few arrays of square layers with power-of-two sides and mip chains made here.
 * Colours are sRGB-encoded and averaged in linear light; data (normals, roughness, ...) are linear. Normals
 * have their length in alpha, as 1 - sqrt(1 - length): what averaging has taken from it. Textures of other
 * sizes are resized to the next class above; when a scene has more sizes than arrays, the smallest are
 * resized further. No texture is left out: what does not fit is an error. Belongs to the thread of its GL
 * device. */
#ifndef GW_RENDER_TEXTURE_SET_H
#define GW_RENDER_TEXTURE_SET_H

#include "base/gl.h"
#include "base/settings.h"
#include "base/status.h"
#include "build/gpu_types.h"
#include "build/scene.h"
#include "shaders/common/frame.h"

#include <stdint.h>

typedef enum gw_texture_kind { GW_TEXTURE_COLOR, GW_TEXTURE_DATA, GW_TEXTURE_NORMAL } gw_texture_kind;

typedef struct gw_texture_set {
    uint32_t class_count;
    uint32_t side[GW_MAXIMUM_TEXTURE_CLASSES]; /* texels */
    uint32_t layers[GW_MAXIMUM_TEXTURE_CLASSES];
    GLuint arrays[GW_MAXIMUM_TEXTURE_CLASSES];
    GLuint samplers[3];     /* by GW_FILTER_* */
    uint32_t texture_count; /* of the scene */
    uint32_t *words; /* [2][texture_count] for materials, GW_NO_TEXTURE for unused ones: of data, and of
                        normals; of colours only the first half */
    uint64_t bytes;  /* on the GPU */
} gw_texture_set;

/* Uploads the textures that used materials name as colours, or as data and normals. GW_MACHINE when the
 * driver's limits or memory do not suffice. */
gw_code gw_texture_set_init(gw_gl *device, const gw_scene *scene, gw_texture_kind kind, gw_texture_set *out,
                            gw_error *error);
/* As which kind a material's map is read. */
gw_texture_kind gw_texture_kind_of(gw_map map);
/* The word of a texture (-1: none) that is used as this kind. */
uint32_t gw_texture_word(const gw_texture_set *set, int32_t texture, gw_texture_kind kind);
void gw_texture_set_finish(gw_texture_set *set);
/* Binds the arrays and the filter (GW_FILTER_*) to texture units first_unit and on. */
void gw_texture_set_bind(const gw_texture_set *set, uint32_t filter, GLuint first_unit);

#endif
