#include "tests/tools/stk_materials.h"

#include "base/file.h"
#include "base/memory.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t largest_picture = (size_t)256 << 20;

/* Shaders that make a surface more than an opaque one. Normal and gloss maps are left out. */
static const struct {
    const char *shader, *alpha_mode;
    int unlit;
} kinds[] = {{"", "OPAQUE", 0},       {"alphatest", "MASK", 0},   {"grass", "MASK", 0},
             {"unlit", "MASK", 1},    {"alphablend", "BLEND", 0}, {"additive", "BLEND", 1},
             {"displace", "BLEND", 0}};
enum { KIND_COUNT = sizeof kinds / sizeof *kinds };

gw_code stk_materials_start(const stk_scene *scene, const char *folder, stk_materials *out, gw_error *error) {
    *out = (stk_materials){.scene = scene,
                           .folder = folder,
                           .materials = json_array(),
                           .textures = json_array(),
                           .images = json_array()};
    char *pictures = gw_path_join(folder, "textures");
    gw_code code = pictures ? gw_make_directories(pictures, error)
                            : gw_fail(error, GW_MACHINE, "out of memory for a file name");
    free(pictures);
    return code;
}

void stk_materials_finish(stk_materials *materials) {
    for (size_t i = 0; i < materials->file_count; i++) {
        free(materials->files[i].folder);
        xml_finish(&materials->files[i].document);
    }
    for (size_t i = 0; i < materials->count; i++)
        free(materials->list[i].picture);
    free(materials->files);
    free(materials->list);
    json_decref(materials->materials);
    json_decref(materials->textures);
    json_decref(materials->images);
    *materials = (stk_materials){0};
}

/* The folder's materials.xml. */
static gw_code material_file(stk_materials *self, const char *folder, const xml_document **out,
                             gw_error *error) {
    for (size_t i = 0; i < self->file_count; i++)
        if (!strcmp(self->files[i].folder, folder)) {
            *out = &self->files[i].document;
            return GW_OK;
        }
    gw_bytes bytes = {0};
    char *path = NULL;
    gw_code code = gw_grow((void **)&self->files, &self->file_capacity, self->file_count + 1,
                           sizeof *self->files, "material files", error);
    if (code != GW_OK)
        return code;
    stk_material_file *file = &self->files[self->file_count];
    *file = (stk_material_file){.folder = gw_copy_text(folder)};
    if (!file->folder)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    self->file_count++;
    code = stk_path(folder, "materials.xml", &path, error);
    if (code == GW_OK && gw_file_exists(path)) {
        code = gw_file_read(path, largest_picture, &bytes, error);
        if (code == GW_OK)
            code = xml_parse(path, bytes.data, bytes.size, &file->document, error);
    }
    gw_bytes_finish(&bytes);
    free(path);
    *out = &file->document;
    return code;
}

/* Index into kinds of the picture's shader in this file, -1 when the file does not name the picture. */
static int kind_in(const xml_document *d, const char *picture) {
    for (int32_t e = d->element_count ? xml_child(d, 0, -1) : -1; e >= 0; e = xml_child(d, 0, e)) {
        const char *name = xml_attribute_of(d, e, "name"), *shader = xml_attribute_of(d, e, "shader");
        if (!name || strcmp(name, picture) != 0)
            continue;
        for (int k = 1; shader && k < KIND_COUNT; k++)
            if (!strcmp(shader, kinds[k].shader))
                return k;
        return 0;
    }
    return -1;
}

/* PNG or JPEG, by the first bytes. */
static const char *extension_of(const gw_bytes *bytes) {
    if (bytes->size > 8 && !memcmp(bytes->data, "\x89PNG\r\n\x1a\n", 8))
        return "png";
    return bytes->size > 3 && !memcmp(bytes->data, "\xff\xd8\xff", 3) ? "jpg" : NULL;
}

/* Copies the picture into textures/ and adds it to the glTF lists; *out is -1 when it cannot be used. */
static gw_code copy_picture(stk_materials *self, const char *path, int32_t *out, gw_error *error) {
    gw_bytes bytes = {0};
    char name[128];
    *out = -1;
    gw_code code = gw_file_read(path, largest_picture, &bytes, error);
    const char *extension = code == GW_OK ? extension_of(&bytes) : NULL;
    if (code != GW_OK || !extension) {
        gw_bytes_finish(&bytes);
        return code;
    }
    int length = snprintf(name, sizeof name, "textures/%03u-%.80s", self->texture_count, gw_path_name(path));
    char *dot = strrchr(name, '.');
    if (dot)
        *dot = '\0';
    for (char *c = name + strlen("textures/"); *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '-' && *c != '_')
            *c = '_';
    length = (int)strlen(name);
    snprintf(name + length, sizeof name - (size_t)length, ".%s", extension);
    char *target = gw_path_join(self->folder, name);
    code = target ? gw_file_write(target, bytes.data, bytes.size, error)
                  : gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (code == GW_OK) {
        json_array_append_new(self->images, json_pack("{s:s}", "uri", name));
        json_array_append_new(self->textures, json_pack("{s:i}", "source", (int)self->texture_count));
        *out = (int32_t)self->texture_count++;
    }
    free(target);
    gw_bytes_finish(&bytes);
    return code;
}

static gw_code add_material(stk_materials *self, int kind, const char *path, int found, uint32_t *out,
                            gw_error *error) {
    gw_code code = gw_grow((void **)&self->list, &self->capacity, self->count + 1, sizeof *self->list,
                           "materials", error);
    if (code != GW_OK)
        return code;
    stk_material *made = &self->list[self->count];
    *made = (stk_material){.picture = gw_copy_text(path), .shader = kinds[kind].shader, .texture = -1};
    if (!made->picture)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    *out = (uint32_t)self->count++;
    for (uint32_t i = 0; i < *out && made->texture < 0; i++)
        if (!strcmp(self->list[i].picture, path))
            made->texture = self->list[i].texture;
    if (found && made->texture < 0)
        code = copy_picture(self, path, &made->texture, error);
    self->missing += made->texture < 0;
    json_t *surface = json_pack("{s:f, s:f}", "metallicFactor", 0.0, "roughnessFactor", 0.8);
    if (made->texture >= 0)
        json_object_set_new(surface, "baseColorTexture", json_pack("{s:i}", "index", (int)made->texture));
    else
        json_object_set_new(surface, "baseColorFactor", json_pack("[f,f,f,f]", 0.5, 0.5, 0.5, 1.0));
    json_t *material =
        json_pack("{s:s, s:o, s:s}", "name", gw_path_name(path), "pbrMetallicRoughness", surface, "alphaMode",
                  made->texture >= 0 ? kinds[kind].alpha_mode : "OPAQUE");
    if (kind != 0)
        json_object_set_new(material, "doubleSided", json_true());
    if (kinds[kind].unlit)
        json_object_set_new(material, "extensions", json_pack("{s:{}}", "KHR_materials_unlit"));
    if (!material || json_array_append_new(self->materials, material) != 0)
        return gw_fail(error, GW_MACHINE, "out of memory for materials");
    return code;
}

gw_code stk_materials_find(stk_materials *self, const char *mesh_folder, const char *picture, uint32_t *out,
                           gw_error *error) {
    char *shared = NULL, *path = NULL;
    int kind = -1, found = 0;
    gw_code code = stk_path(self->scene->data, "textures", &shared, error);
    const char *folders[] = {mesh_folder, self->scene->track, shared};
    for (int i = 0; i < 3 && code == GW_OK; i++) {
        const xml_document *document = NULL;
        code = material_file(self, folders[i], &document, error);
        if (code == GW_OK && kind < 0)
            kind = kind_in(document, picture);
        if (code == GW_OK && !found) {
            free(path);
            code = stk_path(folders[i], picture, &path, error);
            found = code == GW_OK && gw_file_exists(path);
        }
    }
    kind = kind < 0 ? 0 : kind;
    uint32_t at = 0;
    while (
        code == GW_OK && at < self->count &&
        (strcmp(self->list[at].picture, path) != 0 || strcmp(self->list[at].shader, kinds[kind].shader) != 0))
        at++;
    *out = at;
    if (code == GW_OK && at == self->count)
        code = add_material(self, kind, path, found, out, error);
    free(shared);
    free(path);
    return code;
}
