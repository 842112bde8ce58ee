/* The voxeliser of Weier et al. 2014 (section 3, Table 1), for the bench only: the rasteriser finds the
 * voxels that each triangle touches and writes one extended fragment for each. Needs the GL device's thread.
 */
#ifndef GW_WALL_VOXELISE_H
#define GW_WALL_VOXELISE_H

#include "base/gl.h"
#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* 28 bytes, as in the paper. */
typedef struct gw_fragment {
    uint32_t code[2]; /* Morton code of the voxel, low word first; x in bit 0 */
    uint32_t color;   /* RGBA8 of the material; textures are not looked up */
    float normal[3];
    uint32_t triangle;
} gw_fragment;

typedef struct gw_voxelised {
    gw_fragment *fragments; /* in no order; the same triangle and voxel occur once */
    uint64_t count;
    uint32_t draws;      /* slices of triangles: a driver's storage block holds so many fragments */
    double milliseconds; /* drawing, without reading back */
    double subpixel;     /* the rasteriser's grid, of a pixel: corners are rounded to it */
    gw_gl_buffer buffer; /* the same fragments on the GPU, if one draw held them all; otherwise empty */
} gw_voxelised;

/* Voxels of the root cube [-1,1]^3, resolution (2 to 1024) along a side. enlarge 0 leaves out the
 * conservative enlargement: what touches a pixel without its centre is then missed. limit caps the fragments
 * of one draw (0: what the driver allows). */
gw_code gw_voxelise(gw_gl *device, const gw_scene *scene, uint32_t resolution, int enlarge, uint32_t limit,
                    gw_voxelised *out, gw_error *error);
void gw_voxelised_finish(gw_voxelised *voxelised);

#endif
