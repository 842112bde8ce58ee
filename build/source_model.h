/* A model as a file gave it, before it becomes (part of) a checked scene: what the import child sends, what
 * YAML scenes merge. Nothing here is trusted yet: gw_scene_finish checks indices and positions. Any thread.
 */
#ifndef GW_BUILD_SOURCE_MODEL_H
#define GW_BUILD_SOURCE_MODEL_H

#include "base/status.h"
#include "build/scene.h"

#include <stddef.h>
#include <stdint.h>

/* Phong's exponent as a perceptual roughness: alpha^2 = 2 / (Ns + 2), and roughness is the root of alpha. */
float gw_roughness_of_exponent(double exponent);

/* Where a texture's pixels are: in a file beside the model, or bytes that came with it. */
typedef struct gw_texture_source {
    char *path;       /* as the model names it, relative to the model's folder; "" when embedded */
    char *alpha_path; /* a second file whose brightness is the opacity (MTL map_d); "" for none */
    uint8_t *bytes;   /* embedded file (PNG, JPEG), or raw pixels; owned */
    size_t size;
    uint32_t raw_width, raw_height; /* > 0: bytes are RGBA pixels */
    gw_wrap wrap_u, wrap_v;
    int32_t nearest; /* 1: not interpolated where it is enlarged */
    int32_t image;   /* place in the glTF file's list, -1 when unknown */
} gw_texture_source;

/* What a material says beyond gw_material. */
typedef struct gw_material_source {
    int32_t file_index;         /* place in the glTF file's list, -1 when unknown */
    int32_t maps[GW_MAP_COUNT]; /* indices into sources, -1 for none */
    int32_t
        alpha_from_texture; /* 1: the file names no alpha mode; take MASK if the texture has alpha (MTL) */
    int32_t normal_may_be_height; /* 1: MTL's bump: a normal map or one of heights, as its pixels tell */
    float exponent;    /* > 0: GW_MAP_ROUGHNESS_ALONE is MTL's map_Ns, shares of this Phong exponent */
    float specular[4]; /* of specular-glossiness: linear colour at 0 degrees, glossiness; below 0: none */
} gw_material_source;

gw_material_source gw_material_source_none(void);

/* Vertices that came from one primitive under one node of a glTF file, in the file's order. */
typedef struct gw_vertex_span {
    uint32_t node, mesh, primitive; /* places in the file's lists */
    uint32_t first, count;          /* vertices of the model */
} gw_vertex_span;

typedef struct gw_source_model {
    gw_scene
        *scene; /* file-side arrays; normals, texcoords and colors may be NULL; textures empty until loaded */
    double *world; /* [vertex_count][3] scene metres (file units before placement) */
    uint32_t source_count;
    gw_texture_source *sources;
    gw_material_source *material_sources; /* [scene->material_count] */
    uint32_t span_count;                  /* 0 unless the file has animations or skins */
    gw_vertex_span *spans;
    int32_t wants_normals; /* 1: a scan or bare mesh without shading normals: make smooth ones */
} gw_source_model;

gw_code gw_source_model_create(gw_source_model **out, gw_error *error); /* empty, with an empty scene */
void gw_source_model_destroy(gw_source_model **model);

/* The texture sources have been turned into textures or are not wanted any more. */
void gw_source_model_drop_sources(gw_source_model *model);

/* world = matrix * world for positions, normals, lights and viewpoints; a mirroring matrix turns the winding.
 */
gw_code gw_source_model_transform(gw_source_model *model, const double matrix[3][4], gw_error *error);

/* Moves everything of `part` to the end of `target` (indices shifted); part is left empty. Both must have
 * their textures loaded. */
gw_code gw_source_model_append(gw_source_model *target, gw_source_model *part, gw_error *error);

/* Shading normals for a mesh that has none: the mean of the faces round a vertex, weighted by their angle
 * there, over vertices of equal position; faces that meet at more than crease_degrees stay apart (vertices
 * are split). Does not depend on the order of triangles. */
gw_code gw_source_model_smooth_normals(gw_source_model *model, double crease_degrees, gw_error *error);

#endif
