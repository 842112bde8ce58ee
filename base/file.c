#include "base/file.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

void gw_bytes_finish(gw_bytes *bytes) {
    free(bytes->data);
    *bytes = (gw_bytes){0};
}

static gw_code fail_errno(gw_error *error, gw_code code, const char *path, const char *what, int number) {
    char reason[128];
    return gw_fail(error, code, "%s: %s: %s", path, what, strerror_r(number, reason, sizeof reason));
}

/* Reads until the end; fails when more than limit bytes come, for files that grow or lie about their size. */
static gw_code read_all(int file, const char *path, size_t limit, gw_bytes *out, gw_error *error) {
    void *data = NULL;
    size_t capacity = 0, size = 0;
    gw_code code = GW_OK;
    for (;;) {
        if (size == limit + 1) {
            code = gw_fail(error, GW_BAD_INPUT, "%s: larger than the limit of %zu bytes", path, limit);
            break;
        }
        size_t wanted = size + 65536 < limit + 2 ? size + 65536 : limit + 2;
        if (gw_grow(&data, &capacity, wanted, 1, "bytes", NULL)) {
            code = gw_fail(error, GW_MACHINE, "%s: not enough memory for %zu bytes", path, wanted);
            break;
        }
        size_t room = capacity - 1 - size;
        if (room > limit + 1 - size) {
            room = limit + 1 - size;
        }
        ssize_t got = read(file, (uint8_t *)data + size, room);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            code = fail_errno(error, GW_BAD_INPUT, path, "cannot be read", errno);
            break;
        }
        if (got == 0) {
            ((uint8_t *)data)[size] = 0;
            *out = (gw_bytes){.data = data, .size = size};
            return GW_OK;
        }
        size += (size_t)got;
    }
    free(data);
    return code;
}

gw_code gw_file_read(const char *path, size_t limit, gw_bytes *out, gw_error *error) {
    *out = (gw_bytes){0};
    if (limit > SIZE_MAX / 4) {
        limit = SIZE_MAX / 4;
    }
    /* Not blocking, so that a FIFO without a writer is refused instead of waited for. */
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) {
        return fail_errno(error, GW_BAD_INPUT, path, "cannot be opened", errno);
    }
    gw_code code = GW_OK;
    struct stat status;
    if (fstat(file, &status) != 0) {
        code = fail_errno(error, GW_BAD_INPUT, path, "cannot be read", errno);
    } else if (S_ISDIR(status.st_mode)) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: is a folder, a file is needed", path);
    } else if (!S_ISREG(status.st_mode)) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: is not a regular file", path);
    } else if ((uint64_t)status.st_size > limit) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: %lld bytes, larger than the limit of %zu bytes", path,
                       (long long)status.st_size, limit);
    } else {
        code = read_all(file, path, limit, out, error);
    }
    close(file);
    return code;
}

static int write_all(int file, const uint8_t *data, size_t size) {
    while (size > 0) {
        ssize_t put = write(file, data, size);
        if (put < 0 && errno == EINTR) {
            continue;
        }
        if (put < 0) {
            return errno;
        }
        data += put;
        size -= (size_t)put;
    }
    return 0;
}

/* What writing to path means. Only regular files and new names are written by way of a temporary file and
 * rename: that would put a file in the place of a device or a FIFO. Links to files are followed, so that they
 * stay links. */
typedef struct target {
    char *path; /* owned */
    bool in_place;
} target;

static gw_code target_init(target *out, const char *path, gw_error *error) {
    struct stat status;
    bool exists = stat(path, &status) == 0;
    *out = (target){.in_place = exists && !S_ISREG(status.st_mode)};
    out->path = exists && !out->in_place ? realpath(path, NULL) : gw_copy_text(path);
    if (!out->path) {
        return gw_fail(error, GW_MACHINE, "%s: not enough memory for a file name", path);
    }
    return GW_OK;
}

static int write_in_place(const char *path, const void *data, size_t size) {
    int file = open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (file < 0) {
        return errno;
    }
    int number = write_all(file, data, size);
    if (close(file) != 0 && number == 0) {
        number = errno;
    }
    return number;
}

static int write_and_rename(const char *path, const void *data, size_t size) {
    size_t length = strlen(path);
    char *temporary = malloc(length + 8);
    if (!temporary) {
        return ENOMEM;
    }
    memcpy(temporary, path, length);
    memcpy(temporary + length, ".XXXXXX", 8);
    int file = mkostemp(temporary, O_CLOEXEC);
    if (file < 0) {
        int number = errno;
        free(temporary);
        return number;
    }
    int number = write_all(file, data, size);
    /* mkostemp makes files for the owner only; results are for everybody to read. */
    if (number == 0 && fchmod(file, 0644) != 0) {
        number = errno;
    }
    if (close(file) != 0 && number == 0) {
        number = errno;
    }
    if (number == 0 && rename(temporary, path) != 0) {
        number = errno;
    }
    if (number != 0) {
        unlink(temporary);
    }
    free(temporary);
    return number;
}

gw_code gw_file_write(const char *path, const void *data, size_t size, gw_error *error) {
    target to;
    gw_code code = target_init(&to, path, error);
    if (code) {
        return code;
    }
    int number = to.in_place ? write_in_place(to.path, data, size) : write_and_rename(to.path, data, size);
    free(to.path);
    return number ? fail_errno(error, GW_NO_OUTPUT, path, "cannot be written", number) : GW_OK;
}

gw_code gw_file_writable(const char *path, gw_error *error) {
    if (!path) {
        return GW_OK;
    }
    target to;
    gw_code code = target_init(&to, path, error);
    if (code) {
        return code;
    }
    struct stat status;
    char *place = to.in_place ? gw_copy_text(to.path) : gw_path_folder(to.path);
    if (!place) {
        code = gw_fail(error, GW_MACHINE, "%s: not enough memory for a file name", path);
    } else if (stat(place, &status) != 0 || access(place, W_OK) != 0) {
        code = fail_errno(error, GW_NO_OUTPUT, path, "cannot be written", errno);
    } else if (S_ISDIR(status.st_mode) == to.in_place) {
        code = fail_errno(error, GW_NO_OUTPUT, path, "cannot be written", to.in_place ? EISDIR : ENOTDIR);
    }
    free(place);
    free(to.path);
    return code;
}

gw_code gw_make_directories(const char *path, gw_error *error) {
    char *partial = gw_copy_text(path);
    if (!partial) {
        return gw_fail(error, GW_MACHINE, "%s: not enough memory for a folder name", path);
    }
    gw_code code = GW_OK;
    for (char *end = partial; !code; end++) {
        end += strcspn(end, "/");
        char kept = *end;
        *end = '\0';
        struct stat status;
        if (*partial && mkdir(partial, 0777) != 0) {
            int number = errno;
            if (number == EEXIST && stat(partial, &status) == 0) {
                number = S_ISDIR(status.st_mode) ? 0 : ENOTDIR;
            }
            if (number != 0) {
                code = fail_errno(error, GW_NO_OUTPUT, path, "the folder cannot be made", number);
            }
        }
        *end = kept;
        if (!kept) {
            break;
        }
    }
    free(partial);
    return code;
}

int gw_file_exists(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode) && access(path, R_OK) == 0;
}

char *gw_path_join(const char *folder, const char *name) {
    size_t length = strlen(folder);
    if (length == 0 || name[0] == '/') {
        return gw_copy_text(name);
    }
    size_t name_size = strlen(name) + 1;
    char *joined = malloc(length + 1 + name_size);
    if (!joined) {
        return NULL;
    }
    memcpy(joined, folder, length);
    if (folder[length - 1] != '/') {
        joined[length++] = '/';
    }
    memcpy(joined + length, name, name_size);
    return joined;
}

char *gw_path_folder(const char *path) {
    const char *slash = strrchr(path, '/');
    if (!slash) {
        return gw_copy_text(".");
    }
    size_t length = slash == path ? 1 : (size_t)(slash - path);
    char *folder = malloc(length + 1);
    if (folder) {
        memcpy(folder, path, length);
        folder[length] = '\0';
    }
    return folder;
}

const char *gw_path_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

int gw_path_has_extension(const char *path, const char *extension) {
    size_t length = strlen(path), wanted = strlen(extension);
    return length > wanted && strcasecmp(path + length - wanted, extension) == 0;
}

/* Inflates into out until the stream ends, the limit is passed or zlib objects; returns zlib's last word, or
 * Z_MEM_ERROR. *over is 1 when the limit was passed. */
static int inflate_members(z_stream *stream, size_t limit, gw_bytes *out, size_t *capacity, int *over) {
    int state = Z_OK;
    for (;;) {
        void *data = out->data;
        if (gw_grow(&data, capacity, out->size + 65536, 1, "bytes", NULL)) {
            return Z_MEM_ERROR;
        }
        out->data = data;
        size_t room = *capacity - 1 - out->size;
        if (room > UINT_MAX) {
            room = UINT_MAX;
        }
        stream->next_out = out->data + out->size;
        stream->avail_out = (uInt)room;
        state = inflate(stream, Z_NO_FLUSH);
        out->size += room - stream->avail_out;
        if (out->size > limit) {
            *over = 1;
            return state;
        }
        if (state == Z_STREAM_END && stream->avail_in > 0) {
            /* gzip files may be several streams, one after the other. */
            state = inflateReset(stream);
        }
        if (state != Z_OK) {
            return state;
        }
    }
}

gw_code gw_gunzip(const void *data, size_t size, size_t limit, const char *name, gw_bytes *out,
                  gw_error *error) {
    *out = (gw_bytes){0};
    if (size > UINT_MAX) {
        return gw_fail(error, GW_BAD_INPUT, "%s: compressed data of %zu bytes is too large", name, size);
    }
    z_stream stream = {0};
    stream.next_in = (z_const Bytef *)data;
    stream.avail_in = (uInt)size;
    if (inflateInit2(&stream, 15 + 16) != Z_OK) {
        return gw_fail(error, GW_MACHINE, "%s: not enough memory to expand it", name);
    }
    size_t capacity = 0;
    int over = 0;
    int state = inflate_members(&stream, limit, out, &capacity, &over);
    inflateEnd(&stream);
    gw_code code = GW_OK;
    if (over) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: expands to more than the limit of %zu bytes", name, limit);
    } else if (state == Z_MEM_ERROR) {
        code = gw_fail(error, GW_MACHINE, "%s: not enough memory to expand it", name);
    } else if (state == Z_BUF_ERROR) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: the compressed data is cut short", name);
    } else if (state != Z_STREAM_END) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: the compressed data is broken", name);
    }
    if (code) {
        gw_bytes_finish(out);
        return code;
    }
    out->data[out->size] = 0;
    return GW_OK;
}
