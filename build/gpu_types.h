/* The C view of what C and GLSL share: shaders/common/shared.h and the structures derived from it. */
#ifndef GW_BUILD_GPU_TYPES_H
#define GW_BUILD_GPU_TYPES_H

#include <stdint.h>

#define GW_HOST 1
#include "shaders/common/shared.h"

typedef struct gw_node {
    uint32_t link; /* x */
    uint32_t bits; /* y */
} gw_node;

typedef struct gw_payload {
    uint32_t color, normal, surface;
} gw_payload;

/* A box of a dense leaf. */
typedef struct gw_box {
    float low[3];
    uint32_t link; /* first reference, or the box to go on with when this one is missed */
    float high[3];
    uint32_t triangles; /* and GW_BOX_LAST */
} gw_box;

/* A triangle for intersection, 48 bytes: three rebased vertices; the fourth words are free and zero. */
typedef struct gw_gpu_triangle {
    float vertex[3][4];
} gw_gpu_triangle;

/* A triangle for shading, 16 bytes. */
typedef struct gw_gpu_face {
    uint32_t vertex[3]; /* into the vertex attributes */
    uint32_t material;
} gw_gpu_face;

/* A vertex for shading, 16 bytes: octahedral normal (2 x 16 bits, 0xffffffff: none), texture coordinates as
 * float bits, RGBA8 colour factor. */
typedef struct gw_gpu_vertex {
    uint32_t normal;
    float u, v;
    uint32_t color;
} gw_gpu_vertex;

#endif
