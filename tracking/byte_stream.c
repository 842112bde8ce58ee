#include "tracking/byte_stream.h"

#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

enum { PACKED = 1 << 16 };

struct gw_byte_stream {
    FILE *file; /* NULL: memory */
    const uint8_t *memory;
    size_t memory_left;
    uint64_t packed_before; /* bytes of the file before `packed` */
    uint64_t offset, limit, produced;
    int is_gzip, ended;
    z_stream inflater;
    char problem[128];
    size_t first, count; /* what is in the window and not taken */
    uint8_t packed[PACKED];
    uint8_t window[GW_BYTE_WINDOW];
};

/* Bytes of the file as they are. */
static size_t read_raw(gw_byte_stream *stream, uint8_t *to, size_t size) {
    if (stream->file != NULL) {
        size_t got = fread(to, 1, size, stream->file);
        if (got < size && ferror(stream->file))
            snprintf(stream->problem, sizeof stream->problem, "the file cannot be read on: %s",
                     strerror(errno));
        return got;
    }
    size_t got = size < stream->memory_left ? size : stream->memory_left;
    memcpy(to, stream->memory, got);
    stream->memory += got;
    stream->memory_left -= got;
    return got;
}

static void refill_packed(gw_byte_stream *stream) {
    stream->packed_before += (uint64_t)(stream->inflater.next_in - stream->packed);
    memmove(stream->packed, stream->inflater.next_in, stream->inflater.avail_in);
    size_t got =
        read_raw(stream, stream->packed + stream->inflater.avail_in, PACKED - stream->inflater.avail_in);
    stream->inflater.next_in = stream->packed;
    stream->inflater.avail_in += (uInt)got;
}

/* Several gzip streams may stand behind each other, as gzip itself allows. 1: another one begins. */
static int next_member(gw_byte_stream *stream) {
    if (stream->inflater.avail_in < 2)
        refill_packed(stream);
    if (stream->inflater.avail_in == 0) {
        stream->ended = 1;
        return 0;
    }
    return inflateReset(&stream->inflater) == Z_OK;
}

static void stop_packed(gw_byte_stream *stream, const char *what) {
    uint64_t at = stream->packed_before + (uint64_t)(stream->inflater.next_in - stream->packed);
    if (stream->problem[0] == '\0')
        snprintf(stream->problem, sizeof stream->problem, "%s at byte %llu of the .gz file", what,
                 (unsigned long long)at);
    stream->ended = 1;
}

static size_t read_packed(gw_byte_stream *stream, uint8_t *to, size_t size) {
    z_stream *inflater = &stream->inflater;
    inflater->next_out = to;
    inflater->avail_out = (uInt)size;
    while (inflater->avail_out > 0 && !stream->ended) {
        if (inflater->avail_in == 0)
            refill_packed(stream);
        int got = inflate(inflater, Z_NO_FLUSH);
        if (got == Z_STREAM_END)
            next_member(stream);
        else if (got == Z_BUF_ERROR && inflater->avail_in == 0)
            stop_packed(stream, "the gzip stream is cut off");
        else if (got != Z_OK)
            stop_packed(stream, "the gzip stream is damaged");
    }
    return size - inflater->avail_out;
}

static void fill(gw_byte_stream *stream) {
    memmove(stream->window, stream->window + stream->first, stream->count);
    stream->first = 0;
    size_t room = GW_BYTE_WINDOW - stream->count;
    if (room > stream->limit - stream->produced)
        room = (size_t)(stream->limit - stream->produced);
    if (room == 0) { /* peek asks for no more than a window, so it is the limit */
        snprintf(stream->problem, sizeof stream->problem, "more than %llu bytes are not read",
                 (unsigned long long)stream->limit);
        stream->ended = 1;
        return;
    }
    uint8_t *to = stream->window + stream->count;
    size_t got = stream->is_gzip ? read_packed(stream, to, room) : read_raw(stream, to, room);
    stream->ended |= got == 0;
    stream->count += got;
    stream->produced += got;
}

size_t gw_byte_stream_peek(gw_byte_stream *stream, size_t size, const uint8_t **bytes) {
    if (size > GW_BYTE_WINDOW)
        size = GW_BYTE_WINDOW;
    while (stream->count < size && !stream->ended)
        fill(stream);
    *bytes = stream->window + stream->first;
    return stream->count < size ? stream->count : size;
}

void gw_byte_stream_take(gw_byte_stream *stream, size_t size) {
    stream->first += size;
    stream->count -= size;
    stream->offset += size;
}

uint64_t gw_byte_stream_offset(const gw_byte_stream *stream) {
    return stream->offset;
}

int gw_byte_stream_is_gzip(const gw_byte_stream *stream) {
    return stream->is_gzip;
}

const char *gw_byte_stream_problem(const gw_byte_stream *stream) {
    return stream->problem[0] != '\0' ? stream->problem : NULL;
}

/* Looks at the first two bytes: 1f 8b is gzip (RFC 1952). */
static gw_code begin(gw_byte_stream *stream, gw_byte_stream **out, gw_error *error) {
    size_t got = read_raw(stream, stream->packed, 2);
    if (got == 2 && stream->packed[0] == 0x1f && stream->packed[1] == 0x8b) {
        enum { GZIP_ONLY = 16 };
        if (inflateInit2(&stream->inflater, MAX_WBITS + GZIP_ONLY) != Z_OK) {
            gw_byte_stream_close(&stream);
            return gw_fail(error, GW_MACHINE, "out of memory for expanding a .gz file");
        }
        stream->is_gzip = 1;
        stream->inflater.next_in = stream->packed;
        stream->inflater.avail_in = 2;
    } else {
        memcpy(stream->window, stream->packed, got);
        stream->count = got;
        stream->produced = got;
    }
    *out = stream;
    return GW_OK;
}

gw_code gw_byte_stream_open(const char *path, uint64_t limit, gw_byte_stream **out, gw_error *error) {
    *out = NULL;
    FILE *file = fopen(path, "rbe");
    struct stat about;
    if (file == NULL)
        return gw_fail(error, GW_BAD_INPUT, "%s: %s", path, strerror(errno));
    if (fstat(fileno(file), &about) == 0 && S_ISDIR(about.st_mode)) {
        fclose(file);
        return gw_fail(error, GW_BAD_INPUT, "%s: this is a folder, not a file", path);
    }
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_byte_stream), "reading a file", error);
    if (code != GW_OK) {
        fclose(file);
        return code;
    }
    gw_byte_stream *stream = memory;
    stream->file = file;
    stream->limit = limit;
    return begin(stream, out, error);
}

gw_code gw_byte_stream_of(const void *data, size_t size, uint64_t limit, gw_byte_stream **out,
                          gw_error *error) {
    *out = NULL;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_byte_stream), "reading bytes", error);
    if (code != GW_OK)
        return code;
    gw_byte_stream *stream = memory;
    stream->memory = data;
    stream->memory_left = size;
    stream->limit = limit;
    return begin(stream, out, error);
}

void gw_byte_stream_close(gw_byte_stream **stream) {
    if (*stream == NULL)
        return;
    if ((*stream)->is_gzip)
        inflateEnd(&(*stream)->inflater);
    if ((*stream)->file != NULL)
        fclose((*stream)->file);
    free(*stream);
    *stream = NULL;
}
