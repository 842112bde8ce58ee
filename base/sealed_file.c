#include "base/sealed_file.h"

#include "base/file.h"
#include "base/memory.h"

#include <dirent.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

#include <unistd.h>

enum {
    VERSION = 1,
    CODEC_ZLIB = 1,
    AT_VERSION = 8,
    AT_CODEC = 12,
    AT_KEY = 16,
    AT_SIZE = 32,
    AT_STREAM_SIZE = 40,
    HEADER = 48,
    TRAILER = 16,
    ALIGNMENT = 64,
    PIECE = 1 << 20,
    MOST_EXPANSION = 1100, /* deflate packs at most 1032 to 1 */
    COMPRESSION_LEVEL = 1  /* measured on octrees: level 6 takes three times as long for 4 % less */
};
static const char MAGIC[8] = {'G', 'W', 'S', 'E', 'A', 'L', 'E', 'D'};
static const size_t LARGEST_FILE = (size_t)1 << 36;

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

/* --- reading
 * ----------------------------------------------------------------------------------------------------- */

static gw_code check_header(const gw_bytes *file, gw_hash key, gw_error *error) {
    const uint8_t *data = file->data;
    if (file->size < HEADER + TRAILER || memcmp(data, MAGIC, sizeof MAGIC) != 0)
        return gw_fail(error, GW_BAD_INPUT, "it is no sealed file");
    if (get_u32(data + AT_VERSION) != VERSION)
        return gw_fail(error, GW_BAD_INPUT, "its format version is %" PRIu32 ", not %d",
                       get_u32(data + AT_VERSION), VERSION);
    if (get_u32(data + AT_CODEC) != CODEC_ZLIB)
        return gw_fail(error, GW_BAD_INPUT, "its codec %" PRIu32 " is unknown", get_u32(data + AT_CODEC));
    if (!gw_hash_equal(get_hash(data + AT_KEY), key))
        return gw_fail(error, GW_BAD_INPUT, "it was made for another scene or other settings");
    gw_hash checksum = gw_hash_bytes((gw_hash){0, 0}, data, file->size - TRAILER);
    if (!gw_hash_equal(checksum, get_hash(data + file->size - TRAILER)))
        return gw_fail(error, GW_BAD_INPUT, "its checksum is wrong: it was cut or altered");
    if (get_u64(data + AT_STREAM_SIZE) != file->size - HEADER - TRAILER)
        return gw_fail(error, GW_BAD_INPUT, "it is longer or shorter than it says");
    if (get_u64(data + AT_SIZE) / MOST_EXPANSION > file->size)
        return gw_fail(error, GW_BAD_INPUT, "it claims to hold more than its data can");
    return GW_OK;
}

/* What zlib takes at once: its counters have 32 bits. */
static uInt piece_of(size_t left) {
    return left < (1u << 30) ? (uInt)left : 1u << 30;
}

static gw_code inflate_all(const uint8_t *stream_data, size_t stream_size, const gw_sealed *out,
                           gw_error *error) {
    z_stream stream = {.next_in = (Bytef *)(uintptr_t)stream_data};
    size_t done = 0;
    gw_code code = GW_OK;
    if (inflateInit(&stream) != Z_OK)
        return gw_fail(error, GW_MACHINE, "zlib cannot start");
    while (!code && done < out->size) {
        uInt room = piece_of(out->size - done);
        stream.avail_in = piece_of((size_t)(stream_data + stream_size - stream.next_in));
        stream.next_out = (Bytef *)out->data + done;
        stream.avail_out = room;
        int result = inflate(&stream, Z_NO_FLUSH);
        if ((result != Z_OK && result != Z_STREAM_END) || stream.avail_out == room)
            code = gw_fail(error, GW_BAD_INPUT, "its compressed data is broken or too short");
        done += room - stream.avail_out;
    }
    inflateEnd(&stream);
    return code;
}

static gw_code parse(const gw_bytes *file, gw_hash key, gw_sealed *out, gw_error *error) {
    gw_code code = check_header(file, key, error);
    if (code)
        return code;
    out->size = (size_t)get_u64(file->data + AT_SIZE);
    if (posix_memalign(&out->data, ALIGNMENT, out->size ? out->size : 1) != 0) {
        out->data = NULL;
        return gw_fail(error, GW_MACHINE, "no memory for its %zu bytes", out->size);
    }
    return inflate_all(file->data + HEADER, file->size - HEADER - TRAILER, out, error);
}

gw_code gw_sealed_read(const char *path, gw_hash key, gw_sealed *out, gw_error *error) {
    gw_bytes file = {0};
    *out = (gw_sealed){0};
    gw_code code = gw_file_read(path, LARGEST_FILE, &file, error);
    if (code)
        return code;
    code = parse(&file, key, out, error);
    gw_bytes_finish(&file);
    if (code) {
        free(out->data);
        *out = (gw_sealed){0};
        return gw_context(error, "file '%s' is refused", path);
    }
    utimensat(AT_FDCWD, path, NULL, 0); /* used now; a folder that cannot be written only ages */
    return GW_OK;
}

/* --- writing
 * ----------------------------------------------------------------------------------------------------- */

/* A growing output; deflate writes straight into it. */
typedef struct output {
    uint8_t *data;
    size_t size, capacity;
} output;

static gw_code deflate_all(const void *data, size_t size, output *out, gw_error *error) {
    z_stream stream = {0};
    size_t done = 0;
    int result = Z_OK;
    gw_code code = GW_OK;
    if (deflateInit(&stream, COMPRESSION_LEVEL) != Z_OK)
        return gw_fail(error, GW_MACHINE, "zlib cannot start");
    while (!code && result != Z_STREAM_END) {
        uInt piece = piece_of(size - done);
        code = gw_grow((void **)&out->data, &out->capacity, out->size + PIECE + TRAILER, 1, "compressed data",
                       error);
        if (code)
            break;
        stream.next_in = (Bytef *)(uintptr_t)data + done;
        stream.avail_in = piece;
        stream.next_out = out->data + out->size;
        stream.avail_out = PIECE;
        result = deflate(&stream, done + piece == size ? Z_FINISH : Z_NO_FLUSH);
        if (result == Z_STREAM_ERROR)
            code = gw_fail(error, GW_MACHINE, "zlib refuses to compress");
        done += piece - stream.avail_in;
        out->size += PIECE - stream.avail_out;
    }
    deflateEnd(&stream);
    return code;
}

gw_code gw_sealed_write(const char *path, gw_hash key, const void *data, size_t size, gw_error *error) {
    output out = {.size = HEADER};
    char *folder = gw_path_folder(path);
    gw_code code = folder ? gw_make_directories(folder, error) : gw_fail(error, GW_MACHINE, "out of memory");
    if (!code)
        code = gw_grow((void **)&out.data, &out.capacity, HEADER, 1, "compressed data", error);
    if (!code)
        code = deflate_all(data, size, &out, error);
    if (!code) {
        memcpy(out.data, MAGIC, sizeof MAGIC);
        put_u32(out.data + AT_VERSION, VERSION);
        put_u32(out.data + AT_CODEC, CODEC_ZLIB);
        put_hash(out.data + AT_KEY, key);
        put_u64(out.data + AT_SIZE, size);
        put_u64(out.data + AT_STREAM_SIZE, out.size - HEADER);
        put_hash(out.data + out.size, gw_hash_bytes((gw_hash){0, 0}, out.data, out.size));
        code = gw_file_write(path, out.data, out.size + TRAILER, error);
    }
    free(out.data);
    free(folder);
    return code;
}

/* --- the folder
 * -------------------------------------------------------------------------------------------------- */

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

static int has_suffix(const char *name, const char *const *suffixes) {
    for (; *suffixes; ++suffixes)
        if (gw_path_has_extension(name, *suffixes))
            return 1;
    return 0;
}

static size_t list_files(const char *folder, const char *const *suffixes, stored_file **files) {
    size_t count = 0, capacity = 0;
    DIR *directory = opendir(folder);
    struct dirent *entry;
    while (directory && (entry = readdir(directory))) {
        struct stat status;
        char *path = has_suffix(entry->d_name, suffixes) ? gw_path_join(folder, entry->d_name) : NULL;
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

void gw_sealed_trim(const char *kept, const char *const *suffixes, uint64_t limit) {
    stored_file *files = NULL;
    uint64_t total = 0;
    char *folder = gw_path_folder(kept);
    size_t count = folder ? list_files(folder, suffixes, &files) : 0;
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
