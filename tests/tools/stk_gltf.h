/* Writes a flattened SuperTuxKart track as glTF 2.0: NAME.gltf, NAME.bin and textures/ in a folder. Any
 * thread. */
#ifndef GW_TESTS_TOOLS_STK_GLTF_H
#define GW_TESTS_TOOLS_STK_GLTF_H

#include "base/status.h"
#include "tests/tools/stk_scene.h"

#include <stdint.h>

typedef struct stk_gltf_counts {
    uint64_t triangles; /* of all instances */
    uint64_t hidden;    /* left out: without a texture, so invisible walls */
    uint32_t materials, textures;
    uint32_t missing; /* pictures that are not there or neither PNG nor JPEG: their surfaces are grey */
} stk_gltf_counts;

/* The folder must exist. */
gw_code stk_gltf_write(const stk_scene *scene, const char *folder, const char *name, stk_gltf_counts *counts,
                       gw_error *error);

#endif
