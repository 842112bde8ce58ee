/* A scene and its octree on the GPU, in the form that tracing and shading read. Uploaded once; belongs to the
 * thread of its GL device. */
#ifndef GW_RENDER_SCENE_BUFFERS_H
#define GW_RENDER_SCENE_BUFFERS_H

#include "base/gl.h"
#include "base/status.h"
#include "build/octree.h"
#include "build/scene.h"
#include "render/environment_textures.h"
#include "render/light_list.h"
#include "render/texture_set.h"

#include <stdint.h>

typedef struct gw_scene_buffers {
    gw_gl_buffer nodes, references, triangles, payloads, emissions, boxes, faces, vertices, materials, lights;
    gw_gl_buffer extensions;       /* of materials; empty without any */
    gw_gl_buffer second_texcoords; /* of vertices; empty without any */
    gw_gl_buffer tangents;         /* the same */
    gw_texture_set textures;       /* colours */
    gw_texture_set data;
    GLuint albedo_table, sheen_table; /* render/albedo_table.h; the second 0 where nothing has sheen */
    uint32_t root_grid_level;         /* of the grid behind the nodes (root_grid.h), 0: none */
    gw_light_list list;               /* what the buffer of lights holds */
    uint32_t environment_count;       /* lights of it that the environment has */
    gw_environment_textures environment;
    uint8_t *smoothest; /* texels of its maps of roughness, as render/gloss.h says */
} gw_scene_buffers;

/* extensions: 1: rows of material extensions, second texture coordinates and tangents exist even if the scene
 * has none. */
gw_code gw_scene_buffers_init(gw_gl *device, const gw_scene *scene, const gw_octree *octree, int extensions,
                              const gw_light_knobs *knobs, gw_scene_buffers *out, gw_error *error);
/* The lights and the environment by other knobs. */
gw_code gw_scene_buffers_light(gw_gl *device, const gw_scene *scene, const gw_light_knobs *knobs,
                               gw_scene_buffers *buffers, gw_error *error);
/* The same scene in another pose, with its octree: what depends on it is uploaded again. */
gw_code gw_scene_buffers_move(gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                              gw_scene_buffers *buffers, gw_error *error);
void gw_scene_buffers_finish(gw_scene_buffers *buffers);
/* Binds everything to the texture units that the shaders name (trace/fetch.glsl, shade/surface.glsl). */
void gw_scene_buffers_bind(const gw_scene_buffers *buffers, uint32_t texture_filter);

#endif
