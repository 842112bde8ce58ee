/* What lets light through: which triangles bound a medium, which octree nodes hold such triangles, and which
 * media a point lies in. A material with transmission and a thickness bounds a medium, whose number is the
 * material's plus 1; one without thickness is a thin sheet. */
#ifndef GW_RENDER_TRANSMISSION_H
#define GW_RENDER_TRANSMISSION_H

#include "base/gl.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"

/* Media of a scene; the scene must outlive it. Zeroed: none. */
typedef struct gw_media {
    const gw_scene *scene;
    struct gw_medium *list; /* larger boxes first */
    uint32_t count;
} gw_media;

/* 1 if some light passes through the material; 1 if it bounds a medium. */
int gw_lets_light_through(const gw_scene *scene, uint32_t material);
int gw_bounds_medium(const gw_scene *scene, uint32_t material);
/* GW_TRIANGLE_BOUNDARY and GW_TRIANGLE_SHEER as they apply (shaders/common/frame.h). */
uint32_t gw_transmission_flags(const gw_scene *scene, uint32_t material);

/* Marks the nodes, on the GPU already, whose cells hold a triangle that lets light through: they never stand
 * for their contents, because a voxel bends no light. */
gw_code gw_transmission_mark_nodes(const gw_scene *scene, const gw_octree *octree, gw_gl_buffer *nodes,
                                   gw_error *error);

/* The scene's media where it is now; frees what *out held before. */
gw_code gw_media_take(const gw_scene *scene, gw_media *out, gw_error *error);
void gw_media_finish(gw_media *media);
/* The stack of media (shaders/shade/media.glsl) at a rebased place. */
void gw_media_at(const gw_media *media, const double place[3], uint32_t stack[2]);

#endif
