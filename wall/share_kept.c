#include "wall/share_kept.h"

#include "base/file.h"
#include "build/octree_cache.h"
#include "build/pack_octree.h"
#include "wall/interrupt.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char *const suffixes[] = {".gwo", ".gwb", ".gwp", NULL};

/* free() it; NULL without a folder. */
static char *path_of(const char *folder, gw_hash key) {
    char text[33], name[64];
    if (!folder)
        return NULL;
    gw_hash_text(key, text);
    snprintf(name, sizeof name, "block-%s.gwb", text);
    return gw_path_join(folder, name);
}

/* GW_BAD_INPUT when it is not there, or not what its name says. */
static gw_code read_block(const char *path, gw_hash key, gw_sealed *out, gw_error *error) {
    gw_code code = gw_sealed_read(path, key, out, error);
    if (code || gw_hash_equal(gw_hash_bytes((gw_hash){0, 0}, out->data, out->size), key))
        return code;
    free(out->data);
    *out = (gw_sealed){0};
    return gw_fail(error, GW_BAD_INPUT, "file '%s' holds something else than its name says", path);
}

int gw_kept_read(const char *folder, gw_hash key, void *block, size_t size, const gw_log *log) {
    gw_sealed kept = {0};
    gw_error refused = {0};
    char *path = path_of(folder, key);
    int found = 0;
    if (path && gw_file_exists(path)) {
        if (read_block(path, key, &kept, &refused))
            gw_log_write(log, GW_LOG_WARNING, "%s; it is sent again", refused.text);
        else
            found = kept.size == size;
    }
    if (found)
        memcpy(block, kept.data, size);
    free(kept.data);
    free(path);
    return found;
}

int gw_kept_has(const char *folder, gw_hash key) {
    char *path = path_of(folder, key);
    /* It is in use from now on. */
    const int has = path && !utimensat(AT_FDCWD, path, NULL, 0);
    free(path);
    return has;
}

void gw_kept_write(const char *folder, gw_hash key, const void *block, size_t size, uint64_t limit,
                   const gw_log *log) {
    gw_error unwritten = {0};
    char *path = path_of(folder, key);
    if (!path)
        return;
    gw_interrupt_hold();
    if (gw_sealed_write(path, key, block, size, &unwritten))
        gw_log_write(log, GW_LOG_WARNING, "scene or octree is not kept: %s", unwritten.text);
    else
        gw_sealed_trim(path, suffixes, limit);
    gw_interrupt_release();
    free(path);
}

/* --- a tile that was started again
 * ------------------------------------------------------------------------------- */

/* A segment of this process alone. */
static gw_code read_segment(gw_segment *segment, const char *folder, gw_hash key, gw_error *error) {
    gw_sealed kept = {0};
    char *path = path_of(folder, key);
    gw_code code = path ? read_block(path, key, &kept, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while reading the cache");
    free(path);
    if (code)
        return code;
    *segment = (gw_segment){.block = kept.data, .size = kept.size, .key = key};
    return GW_OK;
}

static gw_code restore_scene(gw_share *share, const char *folder, const gw_rejoin_keys *keys,
                             gw_error *error) {
    gw_segment *segment = &share->scene_segment;
    gw_code code = read_segment(segment, folder, keys->scene_block, error);
    if (!code)
        code = gw_unpack_scene(segment->block, segment->size, &share->scene, error);
    if (!code && !gw_hash_equal(share->scene.scene.hash, keys->scene))
        code = gw_fail(error, GW_MACHINE, "the scene in the cache is another one");
    return code;
}

/* The first machine of a run keeps the octree under what it was made from, the others under its content. */
static gw_code restore_octree(gw_share *share, const char *folder, const gw_rejoin_keys *keys,
                              const gw_settings *settings, gw_error *error) {
    gw_segment *segment = &share->octree_segment;
    const gw_hash made_from = gw_octree_cache_key(&share->scene.scene, settings);
    char *path = gw_octree_cache_path(folder, made_from);
    gw_octree *octree = NULL;
    gw_code code;
    if (path && gw_file_exists(path)) {
        code = gw_octree_cache_load(path, made_from, &share->scene.scene, &octree, error);
        if (!code)
            share->octree = *octree;
        free(octree); /* its arrays are the view's now */
    } else {
        code = read_segment(segment, folder, keys->octree_block, error);
        if (!code)
            code = gw_unpack_octree(segment->block, segment->size, &share->octree, error);
    }
    free(path);
    if (!code && !gw_hash_equal(share->octree.hash, keys->octree))
        code = gw_fail(error, GW_MACHINE, "the octree in the cache is another one");
    return code;
}

gw_code gw_share_restore(gw_share *share, const char *folder, const gw_rejoin_keys *keys,
                         const gw_settings *settings, gw_error *error) {
    if (!folder)
        return gw_fail(error, GW_MACHINE, "there is no cache to read scene and octree from");
    gw_code code = restore_scene(share, folder, keys, error);
    if (!code)
        code = restore_octree(share, folder, keys, settings, error);
    return code ? gw_context(error, "what this tile is drawn with is not in this machine's cache %s", folder)
                : GW_OK;
}
