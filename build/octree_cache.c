#include "build/octree_cache.h"

#include "build/octree_internal.h"

#include "base/file.h"
#include "base/memory.h"

#include <dirent.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum {
    VERSION = 2,
    CODEC_ZLIB = 1,
    STATISTICS = 16,
    LEVELS = GW_OCTREE_MAXIMUM_DEPTH + 2,
    AT_VERSION = 8,
    AT_CODEC = 12,
    AT_KEY = 16,
    AT_HASH = 32,
    AT_COUNTS = 48,
    AT_LEVELS = 64,
    AT_EMISSION = 132,
    AT_STATISTICS = 136,
    SPANS = 4,
    AT_STREAM_SIZE = 264,
    HEADER = 272,
    TRAILER = 16,
    COMPRESSION_LEVEL = 1 /* measured: level 6 takes three times as long for 4 % less */
};
static const char MAGIC[8] = {'G', 'W', 'O', 'C', 'T', 'R', 'E', 'E'};
static const char PREFIX[] = "octree-", SUFFIX[] = ".gwo";
/* Larger files are not ours: four times the bytes of the largest octree that any driver can hold. */
static const size_t LARGEST_FILE = (size_t)1 << 34;

static void put_u32(uint8_t *at, uint32_t value) {
    for (int i = 0; i < 4; ++i)
        at[i] = (uint8_t)(value >> (8 * i));
}

static void put_u64(uint8_t *at, uint64_t value) {
    put_u32(at, (uint32_t)value);
    put_u32(at + 4, (uint32_t)(value >> 32));
}

static uint32_t get_u32(const uint8_t *at) {
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint64_t get_u64(const uint8_t *at) {
    return get_u32(at) | (uint64_t)get_u32(at + 4) << 32;
}

static void put_hash(uint8_t *at, gw_hash hash) {
    put_u64(at, hash.high);
    put_u64(at + 8, hash.low);
}

static gw_hash get_hash(const uint8_t *at) {
    return (gw_hash){get_u64(at), get_u64(at + 8)};
}

gw_hash gw_octree_cache_key(const gw_scene *scene, const gw_settings *settings) {
    const uint32_t version = VERSION;
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
    snprintf(name, sizeof name, "%s%s%s", PREFIX, text, SUFFIX);
    return gw_path_join(folder, name);
}

/* The arrays of an octree in the order of the stream. */
typedef struct span {
    uint8_t *data;
    size_t size;
} span;

static void octree_spans(const gw_octree *octree, span spans[SPANS]) {
    spans[0] = (span){(uint8_t *)octree->nodes, (size_t)gw_octree_node_bytes(octree)};
    spans[1] = (span){(uint8_t *)octree->payloads, (size_t)gw_octree_payload_bytes(octree)};
    spans[2] = (span){(uint8_t *)octree->references, (size_t)gw_octree_reference_bytes(octree)};
    spans[3] = (span){(uint8_t *)octree->emissions, (size_t)gw_octree_emission_bytes(octree)};
}

/* What zlib takes at once: its counters have 32 bits. */
static uInt piece_of(size_t left) {
    return left < (1u << 30) ? (uInt)left : 1u << 30;
}

static gw_code inflate_span(z_stream *stream, const span *s, const uint8_t *end, gw_error *error) {
    size_t done = 0;
    while (done < s->size) {
        uInt room = piece_of(s->size - done);
        stream->avail_in = piece_of((size_t)(end - stream->next_in));
        stream->next_out = s->data + done;
        stream->avail_out = room;
        int result = inflate(stream, Z_NO_FLUSH);
        if ((result != Z_OK && result != Z_STREAM_END) || stream->avail_out == room)
            return gw_fail(error, GW_BAD_INPUT, "its compressed data is broken or too short");
        done += room - stream->avail_out;
    }
    return GW_OK;
}

static gw_code inflate_octree(const uint8_t *data, size_t size, const gw_octree *octree, gw_error *error) {
    span spans[SPANS];
    z_stream stream = {0};
    gw_code code = GW_OK;
    if (inflateInit(&stream) != Z_OK)
        return gw_fail(error, GW_MACHINE, "zlib cannot start");
    stream.next_in = (Bytef *)(uintptr_t)data;
    octree_spans(octree, spans);
    for (int i = 0; i < SPANS && code == GW_OK; ++i)
        code = inflate_span(&stream, &spans[i], data + size, error);
    inflateEnd(&stream);
    return code;
}

/* Every link, list and id stays inside its array; children lie behind their parents, so no walk can loop. */
static gw_code check_links(const gw_octree *octree, uint32_t triangle_count, gw_error *error) {
    const uint32_t *references = octree->references;
    uint32_t count = octree->reference_count;
    if (!(references[count - 1] & GW_REFERENCE_LAST))
        return gw_fail(error, GW_BAD_INPUT, "its last list has no end");
    for (uint32_t i = 1; i < count; ++i)
        if ((references[i] & GW_REFERENCE_ID) >= triangle_count)
            return gw_fail(error, GW_BAD_INPUT, "its reference %" PRIu32 " names no triangle of the scene",
                           i);
    for (uint32_t i = 0; i < octree->node_count; ++i) {
        gw_node node = octree->nodes[i];
        uint32_t children = (uint32_t)__builtin_popcount(GW_NODE_VALID(node.bits));
        uint32_t kind = GW_NODE_KIND(node.bits);
        int sound = kind == GW_KIND_INNER
                        ? children > 0 && node.link > i && node.link <= octree->node_count - children
                    : kind == GW_LEAF_LIST   ? node.link > 0 && node.link < count
                    : kind == GW_LEAF_SINGLE ? node.link < triangle_count
                                             : 0;
        if (!sound || (i == 0 && kind != GW_KIND_INNER))
            return gw_fail(error, GW_BAD_INPUT, "its node %" PRIu32 " points outside the file's arrays", i);
    }
    return GW_OK;
}

static gw_code check_levels(const gw_octree *octree, gw_error *error) {
    uint32_t depth = octree->depth;
    int sound = depth >= 1 && depth <= GW_OCTREE_MAXIMUM_DEPTH && octree->node_count > 0 &&
                octree->reference_count > 0 && octree->level_begin[0] == 0 &&
                octree->statistics.deepest <= depth && octree->level_begin[LEVELS - 1] == octree->node_count;
    for (uint32_t l = 0; sound && l + 1 < LEVELS; ++l)
        sound = octree->level_begin[l] <= octree->level_begin[l + 1];
    sound = sound && octree->level_begin[depth + 1] == octree->node_count;
    return sound ? GW_OK : gw_fail(error, GW_BAD_INPUT, "its counts contradict each other");
}

static void put_statistics(uint8_t *at, const gw_octree_statistics *s) {
    const uint64_t values[STATISTICS] = {s->pairs,        s->overlap_tests, s->inner,
                                         s->leaves,       s->single_leaves, s->stopped_small,
                                         s->stopped_fan,  s->stopped_depth, s->refined_isolated,
                                         s->longest_list, s->deepest,       s->parts};
    for (int i = 0; i < STATISTICS; ++i)
        put_u64(at + 8 * i, values[i]);
}

static void get_statistics(const uint8_t *at, gw_octree_statistics *s) {
    uint64_t *wide[] = {&s->pairs,       &s->overlap_tests, &s->inner,
                        &s->leaves,      &s->single_leaves, &s->stopped_small,
                        &s->stopped_fan, &s->stopped_depth, &s->refined_isolated};
    for (size_t i = 0; i < sizeof wide / sizeof *wide; ++i)
        *wide[i] = get_u64(at + 8 * i);
    s->longest_list = (uint32_t)get_u64(at + 8 * 9);
    s->deepest = (uint32_t)get_u64(at + 8 * 10);
    s->parts = (uint32_t)get_u64(at + 8 * 11);
}

static gw_code check_header(const gw_bytes *file, gw_hash key, gw_error *error) {
    const uint8_t *data = file->data;
    gw_hash checksum;
    if (file->size < HEADER + TRAILER || memcmp(data, MAGIC, sizeof MAGIC) != 0)
        return gw_fail(error, GW_BAD_INPUT, "it is no octree file");
    if (get_u32(data + AT_VERSION) != VERSION)
        return gw_fail(error, GW_BAD_INPUT, "its format version is %" PRIu32 ", not %d",
                       get_u32(data + AT_VERSION), VERSION);
    if (get_u32(data + AT_CODEC) != CODEC_ZLIB)
        return gw_fail(error, GW_BAD_INPUT, "its codec %" PRIu32 " is unknown", get_u32(data + AT_CODEC));
    if (!gw_hash_equal(get_hash(data + AT_KEY), key))
        return gw_fail(error, GW_BAD_INPUT, "it was made for another scene or other settings");
    checksum = gw_hash_bytes((gw_hash){0, 0}, data, file->size - TRAILER);
    if (!gw_hash_equal(checksum, get_hash(data + file->size - TRAILER)))
        return gw_fail(error, GW_BAD_INPUT, "its checksum is wrong: it was cut or altered");
    if (get_u64(data + AT_STREAM_SIZE) != file->size - HEADER - TRAILER)
        return gw_fail(error, GW_BAD_INPUT, "it is longer or shorter than it says");
    return GW_OK;
}

static gw_code read_counts(const uint8_t *data, gw_octree *octree, gw_error *error) {
    octree->hash = get_hash(data + AT_HASH);
    octree->depth = get_u32(data + AT_COUNTS);
    octree->node_count = get_u32(data + AT_COUNTS + 4);
    octree->reference_count = get_u32(data + AT_COUNTS + 8);
    for (int l = 0; l < LEVELS; ++l)
        octree->level_begin[l] = get_u32(data + AT_LEVELS + 4 * l);
    get_statistics(data + AT_STATISTICS, &octree->statistics);
    return check_levels(octree, error);
}

static gw_code parse(const gw_bytes *file, gw_hash key, const gw_scene *scene, gw_octree *octree,
                     gw_error *error) {
    gw_hash stored;
    gw_code code = check_header(file, key, error);
    if (code == GW_OK)
        code = read_counts(file->data, octree, error);
    /* deflate packs at most 1032 to 1: counts beyond that are a lie, not a reason to allocate. */
    if (code == GW_OK &&
        (gw_octree_node_bytes(octree) + gw_octree_payload_bytes(octree) + gw_octree_reference_bytes(octree)) /
                1100 >
            file->size)
        code = gw_fail(error, GW_BAD_INPUT, "its counts are larger than its data");
    if (code == GW_OK)
        code = gw_octree_allocate(octree, error);
    if (code == GW_OK && get_u32(file->data + AT_EMISSION) != 0)
        code = gw_allocate((void **)&octree->emissions, octree->node_count, sizeof *octree->emissions,
                           "emissions of voxels", error);
    if (code == GW_OK)
        code = inflate_octree(file->data + HEADER, file->size - HEADER - TRAILER, octree, error);
    if (code == GW_OK)
        code = check_links(octree, scene->triangle_count, error);
    stored = octree->hash;
    if (code == GW_OK) {
        gw_octree_hash(octree);
        if (!gw_hash_equal(stored, octree->hash))
            code = gw_fail(error, GW_BAD_INPUT, "the hash of its contents is wrong");
    }
    return code;
}

gw_code gw_octree_cache_load(const char *path, gw_hash key, const gw_scene *scene, gw_octree **out,
                             gw_error *error) {
    gw_bytes file = {0};
    gw_octree *octree = NULL;
    *out = NULL;
    gw_code code = gw_file_read(path, LARGEST_FILE, &file, error);
    if (code != GW_OK)
        return code;
    code = gw_allocate((void **)&octree, 1, sizeof *octree, "octree", error);
    if (code == GW_OK)
        code = parse(&file, key, scene, octree, error);
    gw_bytes_finish(&file);
    if (code != GW_OK) {
        gw_octree_destroy(&octree);
        return gw_context(error, "octree file '%s' is refused", path);
    }
    utimensat(AT_FDCWD, path, NULL, 0); /* used now; a folder that cannot be written only ages */
    *out = octree;
    return GW_OK;
}

/* A growing output; deflate writes straight into it. */
typedef struct output {
    uint8_t *data;
    size_t size, capacity;
} output;

static gw_code deflate_span(z_stream *stream, const span *s, int last, output *out, gw_error *error) {
    size_t done = 0;
    int finished = 0;
    while (!finished) {
        uInt piece = piece_of(s->size - done);
        int flush = last && done + piece == s->size ? Z_FINISH : Z_NO_FLUSH;
        gw_code code = gw_grow((void **)&out->data, &out->capacity, out->size + (1u << 20) + TRAILER, 1,
                               "compressed octree", error);
        if (code != GW_OK)
            return code;
        stream->next_in = s->data + done;
        stream->avail_in = piece;
        stream->next_out = out->data + out->size;
        stream->avail_out = 1u << 20;
        int result = deflate(stream, flush);
        if (result == Z_STREAM_ERROR)
            return gw_fail(error, GW_MACHINE, "zlib refuses to compress the octree");
        done += piece - stream->avail_in;
        out->size += (1u << 20) - stream->avail_out;
        finished = flush == Z_FINISH ? result == Z_STREAM_END : done == s->size;
    }
    return GW_OK;
}

static gw_code compress_octree(const gw_octree *octree, output *out, gw_error *error) {
    span spans[SPANS];
    z_stream stream = {0};
    gw_code code = GW_OK;
    if (deflateInit(&stream, COMPRESSION_LEVEL) != Z_OK)
        return gw_fail(error, GW_MACHINE, "zlib cannot start");
    octree_spans(octree, spans);
    for (int i = 0; i < SPANS && code == GW_OK; ++i)
        code = deflate_span(&stream, &spans[i], i == SPANS - 1, out, error);
    deflateEnd(&stream);
    return code;
}

static void write_header(uint8_t *data, gw_hash key, const gw_octree *octree, uint64_t stream_size) {
    memset(data, 0, HEADER);
    memcpy(data, MAGIC, sizeof MAGIC);
    put_u32(data + AT_VERSION, VERSION);
    put_u32(data + AT_CODEC, CODEC_ZLIB);
    put_hash(data + AT_KEY, key);
    put_hash(data + AT_HASH, octree->hash);
    put_u32(data + AT_COUNTS, octree->depth);
    put_u32(data + AT_COUNTS + 4, octree->node_count);
    put_u32(data + AT_COUNTS + 8, octree->reference_count);
    put_u32(data + AT_COUNTS + 12, STATISTICS);
    for (int l = 0; l < LEVELS; ++l)
        put_u32(data + AT_LEVELS + 4 * l, octree->level_begin[l]);
    put_statistics(data + AT_STATISTICS, &octree->statistics);
    put_u32(data + AT_EMISSION, octree->emissions != NULL);
    put_u64(data + AT_STREAM_SIZE, stream_size);
}

/* One octree file of a folder. */
typedef struct stored_file {
    char *path;
    uint64_t size;
    struct timespec used;
} stored_file;

static int older_first(const void *a, const void *b) {
    const stored_file *x = a, *y = b;
    if (x->used.tv_sec != y->used.tv_sec)
        return x->used.tv_sec < y->used.tv_sec ? -1 : 1;
    return (x->used.tv_nsec > y->used.tv_nsec) - (x->used.tv_nsec < y->used.tv_nsec);
}

static int is_octree_name(const char *name) {
    size_t length = strlen(name), tail = sizeof SUFFIX - 1;
    return strncmp(name, PREFIX, sizeof PREFIX - 1) == 0 && length > tail &&
           strcmp(name + length - tail, SUFFIX) == 0;
}

static size_t list_files(const char *folder, stored_file **files) {
    size_t count = 0, capacity = 0;
    DIR *directory = opendir(folder);
    struct dirent *entry;
    while (directory && (entry = readdir(directory))) {
        struct stat status;
        char *path = is_octree_name(entry->d_name) ? gw_path_join(folder, entry->d_name) : NULL;
        if (path && stat(path, &status) == 0 && S_ISREG(status.st_mode) &&
            gw_grow((void **)files, &capacity, count + 1, sizeof **files, "cache files", NULL) == GW_OK)
            (*files)[count++] = (stored_file){path, (uint64_t)status.st_size, status.st_mtim};
        else
            free(path);
    }
    if (directory)
        closedir(directory);
    return count;
}

/* Best effort: what cannot be removed stays, another launch may be removing the same files. */
static void trim_folder(const char *kept, uint64_t limit) {
    stored_file *files = NULL;
    uint64_t total = 0;
    char *folder = gw_path_folder(kept);
    size_t count = folder ? list_files(folder, &files) : 0;
    for (size_t i = 0; i < count; ++i)
        total += files[i].size;
    if (count > 0)
        qsort(files, count, sizeof *files, older_first);
    for (size_t i = 0; i < count; ++i) {
        if (total > limit && strcmp(gw_path_name(files[i].path), gw_path_name(kept)) != 0 &&
            unlink(files[i].path) == 0)
            total -= files[i].size;
        free(files[i].path);
    }
    free(files);
    free(folder);
}

gw_code gw_octree_cache_store(const char *path, gw_hash key, const gw_octree *octree, uint64_t limit,
                              gw_error *error) {
    output out = {0};
    char *folder = gw_path_folder(path);
    gw_code code = folder ? gw_make_directories(folder, error) : gw_fail(error, GW_MACHINE, "out of memory");
    if (code == GW_OK)
        code = gw_grow((void **)&out.data, &out.capacity, HEADER, 1, "compressed octree", error);
    out.size = HEADER;
    if (code == GW_OK)
        code = compress_octree(octree, &out, error);
    if (code == GW_OK) {
        write_header(out.data, key, octree, out.size - HEADER);
        put_hash(out.data + out.size, gw_hash_bytes((gw_hash){0, 0}, out.data, out.size));
        code = gw_file_write(path, out.data, out.size + TRAILER, error);
    }
    if (code == GW_OK && limit > 0)
        trim_folder(path, limit);
    free(out.data);
    free(folder);
    return code;
}
