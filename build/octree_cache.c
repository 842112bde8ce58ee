#include "build/octree_cache.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/sealed_file.h"
#include "build/pack_octree.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* .gwb: blocks that other machines keep; .gwp: binaries of programs (base/gl_binary.c). */
static const char *const suffixes[] = {".gwo", ".gwb", ".gwp", NULL};

gw_hash gw_octree_cache_key(const gw_scene *scene, const gw_settings *settings) {
    const uint32_t version = GW_OCTREE_BLOCK_VERSION;
    gw_hash key = gw_hash_bytes((gw_hash){0, 0}, &version, sizeof version);
    key = gw_hash_bytes(key, &scene->hash, sizeof scene->hash);
    for (size_t i = 0; i < gw_setting_count; ++i) {
        const gw_setting_row *row = &gw_setting_rows[i];
        if (row->stage != GW_SETTING_BUILD)
            continue;
        double value = gw_setting_value(settings, row);
        key = gw_hash_bytes(key, row->name, strlen(row->name));
        key = gw_hash_bytes(key, &value, sizeof value);
    }
    return key;
}

char *gw_octree_cache_path(const char *folder, gw_hash key) {
    char text[33], name[64];
    gw_hash_text(key, text);
    snprintf(name, sizeof name, "octree-%s.gwo", text);
    return gw_path_join(folder, name);
}

/* The octree takes the block over. */
static gw_code adopt(gw_sealed *file, const gw_scene *scene, gw_octree *octree, gw_error *error) {
    gw_code code = gw_unpack_octree(file->data, file->size, octree, error);
    if (!code)
        code = gw_octree_check_links(octree, scene->triangle_count, error);
    if (code)
        return code;
    gw_hash stored = octree->hash;
    gw_octree_hash(octree);
    if (!gw_hash_equal(stored, octree->hash))
        return gw_fail(error, GW_BAD_INPUT, "the hash of its contents is wrong");
    octree->block = file->data;
    file->data = NULL;
    return GW_OK;
}

gw_code gw_octree_cache_load(const char *path, gw_hash key, const gw_scene *scene, gw_octree **out,
                             gw_error *error) {
    gw_sealed file = {0};
    gw_octree *octree = NULL;
    *out = NULL;
    gw_code code = gw_sealed_read(path, key, &file, error);
    if (code)
        return code;
    code = gw_allocate((void **)&octree, 1, sizeof *octree, "octree", error);
    if (!code)
        code = adopt(&file, scene, octree, error);
    free(file.data);
    if (code) {
        gw_octree_destroy(&octree);
        return gw_context(error, "octree file '%s' is refused", path);
    }
    *out = octree;
    return GW_OK;
}

gw_code gw_octree_cache_store(const char *path, gw_hash key, const gw_octree *octree, uint64_t limit,
                              gw_error *error) {
    void *block = NULL;
    size_t size = gw_pack_octree_size(octree);
    gw_code code = gw_allocate(&block, size, 1, "octree file", error);
    if (code)
        return code;
    gw_pack_octree(octree, block);
    code = gw_sealed_write(path, key, block, size, error);
    free(block);
    if (!code && limit > 0)
        gw_sealed_trim(path, suffixes, limit);
    return code;
}
