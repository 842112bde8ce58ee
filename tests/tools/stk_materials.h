/* What SuperTuxKart's materials.xml says of the pictures that meshes name, as glTF materials and textures.
 * Reads untrusted files. Any thread. */
#ifndef GW_TESTS_TOOLS_STK_MATERIALS_H
#define GW_TESTS_TOOLS_STK_MATERIALS_H

#include "base/status.h"
#include "tests/tools/stk_scene.h"
#include "tests/tools/xml.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* One materials.xml, read once; element_count is 0 when the folder has none. */
typedef struct stk_material_file {
    char *folder;
    xml_document document;
} stk_material_file;

typedef struct stk_material {
    char *picture;      /* path of the picture, or its bare name where it was not found */
    const char *shader; /* one of the few that change the surface's kind */
    int32_t texture;    /* index in glTF, -1 for none */
} stk_material;

typedef struct stk_materials {
    const stk_scene *scene;
    const char *folder; /* where the glTF file goes; pictures are copied to textures/ there */
    stk_material_file *files;
    stk_material *list;
    size_t file_count, file_capacity, count, capacity;
    uint32_t texture_count, missing;
    json_t *materials, *textures, *images; /* of the glTF file; owned here */
} stk_materials;

gw_code stk_materials_start(const stk_scene *scene, const char *folder, stk_materials *out, gw_error *error);
void stk_materials_finish(stk_materials *materials);

/* The glTF material of a picture that a mesh in mesh_folder names; copies the picture at first sight. */
gw_code stk_materials_find(stk_materials *materials, const char *mesh_folder, const char *picture,
                           uint32_t *out, gw_error *error);

#endif
