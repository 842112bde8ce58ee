/* The JSON side of a glTF 2.0 file (.gltf, .glb): what has to be checked before assimp sees it, and what
 * assimp 5.2.5 does not carry. Reads untrusted bytes; never touches geometry. Any thread. */
#ifndef GW_BUILD_GLTF_H
#define GW_BUILD_GLTF_H

#include "base/file.h"
#include "base/status.h"
#include "build/source_model.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gw_gltf {
    json_t *root;
    int binary;           /* 1: .glb */
    const uint8_t *chunk; /* its BIN chunk inside the caller's bytes, NULL for none */
    size_t chunk_size;
} gw_gltf;

/* Parses and checks containers, version, lists and sizes: every index that leads to memory is in range, every
 * accessor lies inside its buffer. `data` must outlive *out. folder: where external buffers are looked for
 * (NULL: not looked for). */
gw_code gw_gltf_open(const void *data, size_t size, const char *folder, gw_gltf *out, gw_error *error);
void gw_gltf_close(gw_gltf *gltf);

/* extensionsUsed and extensionsRequired against what is carried: a required one that is not is GW_BAD_INPUT,
 * an optional one becomes a note of the model (NULL: only check). */
gw_code gw_gltf_check_extensions(const gw_gltf *gltf, gw_source_model *model, gw_error *error);

/* Adds what assimp drops: emissive strength, material names, extensions, pictures and their texture
 * transforms; notes what is not carried. Materials are matched by gw_material_source.file_index. folder:
 * where buffer files are (NULL: not looked for). */
gw_code gw_gltf_apply(const gw_gltf *gltf, const char *folder, gw_source_model *model, gw_error *error);

/* Triangles that the file's meshes promise, each mesh once: assimp drops those with bad indices. */
uint64_t gw_gltf_promised_triangles(const gw_gltf *gltf);

/* 1 when the file has animations or skins, so that the places of nodes and meshes matter. */
int gw_gltf_moves(const gw_gltf *gltf);

/* The same file with every material named "#index", because assimp keeps names but not places in the list; in
 * a file that moves nodes and meshes, too, and else nodes with a light. A light that several nodes carry
 * becomes one for each. Tangents that are not used are left out (gltf_tangents.h). */
gw_code gw_gltf_mark(gw_gltf *gltf, gw_bytes *out, gw_error *error);

#endif
