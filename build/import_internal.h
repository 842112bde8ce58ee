/* What the parts of the importer share. The parent side (import.c, import_spawn.c, import_texture.c) runs in
 * any program; the child side (import_child.c, import_files.c, import_precheck.c, import_assimp.c,
 * import_material.c) only in the import child, under its limits. */
#ifndef GW_BUILD_IMPORT_INTERNAL_H
#define GW_BUILD_IMPORT_INTERNAL_H

#include "base/file.h"
#include "base/status.h"
#include "build/import.h"
#include "build/source_model.h"

#include <stddef.h>
#include <stdint.h>

struct aiColor4D;
struct aiFileIO;
struct aiMaterial;
struct aiScene;

typedef enum gw_model_format {
    GW_FORMAT_GLTF,
    GW_FORMAT_OBJ,
    GW_FORMAT_PLY,
    GW_FORMAT_STL,
    GW_FORMAT_OFF
} gw_model_format;

/* The format that the name's extension stands for ("a.ply.gz" is a packed PLY); 0 when it is none of ours. */
int gw_model_format_of(const char *path, gw_model_format *format, int *packed);
const char *gw_model_format_name(gw_model_format format);

/* --- parent --- */

/* A model file as a model with its textures loaded, in metres and y up as the file means it. */
gw_code gw_import_model(const char *path, const gw_import_options *options, gw_source_model **out,
                        gw_error *error);

/* Runs the import child on path and returns the bytes it sent. */
gw_code gw_import_spawn(const char *path, const gw_import_options *options, gw_bytes *out, gw_error *error);

/* Decodes the sources of a model into its scene's textures, and their means into material factors. */
gw_code gw_import_textures(gw_source_model *model, const char *path, const gw_log *log, gw_error *error);

/* Says that units and up axis were assumed, for formats that name none. */
gw_code gw_import_note_units(gw_scene *scene, const char *path, gw_error *error);

/* Finishes the model's geometry and gives its scene away, with the user's path; *model is destroyed. */
gw_code gw_import_finish(gw_source_model **model, const char *path, const gw_import_options *options,
                         gw_scene **out, gw_error *error);

/* What the user or the model said, even if it was "none". */
typedef struct gw_scene_given {
    int lights, ambient, background;
} gw_scene_given;

/* Light, ambient, background, viewpoint and notes for what a scene does not say. The geometry must be
 * finished. */
gw_code gw_scene_defaults(gw_scene *scene, const gw_scene_given *given, gw_error *error);

uint64_t gw_import_memory_limit(const gw_import_options *options);
double gw_import_time_limit(const gw_import_options *options);

/* --- child --- */

enum { GW_MTL_LOST_KEYS = 16 };

/* The bytes of the model's main file, expanded and prepared, and where its other files may be. */
typedef struct gw_import_files {
    const char *folder; /* of the model */
    char *main_name;    /* path under which assimp asks for the main file */
    gw_bytes main;
    size_t limit;  /* bytes of one file */
    char *missing; /* the first file that could not be opened, NULL for none; owned */
    uint32_t missing_count;
    uint32_t lost_mtl_keys[GW_MTL_LOST_KEYS]; /* lines of its material files that nothing stands for */
    int mtl_illum;                            /* 1: some line of them names illum */
    uint64_t promised_triangles;              /* glTF: what its meshes should hold; 0: not known */
    int32_t (*texcoord_sets)[2]; /* glTF: of its materials (gw_gltf_texcoord_sets()); NULL otherwise; owned */
    size_t texcoord_set_count;
} gw_import_files;

/* Callbacks through which assimp reads nothing but these files; the result lives as long as *files. */
struct aiFileIO gw_import_file_io(gw_import_files *files);

/* Looks for the damage that assimp 5.2.5 does not survive or does not notice: cut and mislabelled files. */
gw_code gw_import_precheck(gw_model_format format, const uint8_t *data, size_t size, gw_error *error);

/* Flattens what assimp read into a model. */
gw_code gw_import_convert(const struct aiScene *read, gw_model_format format, const gw_import_files *files,
                          gw_source_model *model, gw_error *error);

/* One material; its textures are added to the model's sources. */
gw_code gw_import_material(const struct aiScene *read, const struct aiMaterial *from, gw_model_format format,
                           const gw_import_files *files, gw_source_model *model, uint32_t index,
                           gw_error *error);
/* Place of a glTF material in the file's list, by the name that gw_gltf_mark() gave it; -1 for assimp's own.
 */
int32_t gw_import_material_index(const struct aiMaterial *from);

/* The same for MTL; docs/materials.md has what its keys become. */
gw_code gw_import_mtl_material(const struct aiScene *read, const struct aiMaterial *from,
                               const gw_import_files *files, gw_source_model *model, uint32_t index,
                               gw_error *error);
/* Looks through a material file for what assimp passes over. */
void gw_import_mtl_scan(const uint8_t *data, size_t size, gw_import_files *files);
/* Names what of the materials in use is not carried. */
gw_code gw_import_mtl_notes(const struct aiScene *read, const gw_import_files *files, gw_source_model *model,
                            gw_error *error);

/* Properties of a material: `missing` (0 for colours) for what is absent or no number. */
float gw_import_float(const struct aiMaterial *from, const char *key, float missing);
int gw_import_color(const struct aiMaterial *from, const char *key, struct aiColor4D *color);
void gw_import_set_color(float *out, const struct aiColor4D *color, int srgb, float maximum);
float gw_import_share(double value); /* held in 0..1 */
/* The material's first texture of a type (aiTextureType_) as a source index, -1 for none. alpha: the type of
 * a separate opacity picture, or aiTextureType_NONE. */
gw_code gw_import_texture(const struct aiScene *read, const struct aiMaterial *from, int type, int alpha,
                          gw_source_model *model, int32_t *index, gw_error *error);

/* A display value 0..1 as linear light. */
float gw_linear_from_srgb(float value);

#endif
