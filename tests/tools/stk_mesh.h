/* Meshes of SuperTuxKart (.spm), static and skinned (rest pose), turned right-handed. Reads untrusted bytes.
 * Any thread. */
#ifndef GW_TESTS_TOOLS_STK_MESH_H
#define GW_TESTS_TOOLS_STK_MESH_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* The triangles of one material: indices count from the buffer's first vertex. */
typedef struct stk_buffer {
    uint32_t vertex_first, vertex_count, index_first, index_count, material;
} stk_buffer;

typedef struct stk_mesh {
    char (*textures)[256]; /* [material_count] the first texture of each; "" for none: an invisible wall */
    uint32_t material_count;
    stk_buffer *buffers;
    size_t buffer_count, buffer_capacity;
    float (*positions)[3]; /* z negated: the files are left-handed */
    float (*normals)[3];   /* unit; only where has_normals */
    float (*texcoords)[2]; /* v downwards; zero in buffers without texture */
    uint8_t (*colors)[4];  /* only where has_colors */
    size_t vertex_count, position_capacity, normal_capacity, texcoord_capacity, color_capacity;
    uint32_t *indices; /* winding turned */
    size_t index_count, index_capacity;
    int has_normals, has_colors;
} stk_mesh;

/* name is the file's, for messages. On failure *out is empty. */
gw_code stk_mesh_read(const char *name, const uint8_t *data, size_t size, stk_mesh *out, gw_error *error);
void stk_mesh_finish(stk_mesh *mesh);

#endif
