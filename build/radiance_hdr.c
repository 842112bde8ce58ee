/* See radiance_hdr.h. */
#include "build/radiance_hdr.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    const uint8_t *at, *end;
} reader;

static size_t left(const reader *from) {
    return (size_t)(from->end - from->at);
}

/* The next line without its end; 0 when there is none or it is too long. */
static int next_line(reader *from, char *line, size_t size) {
    const uint8_t *end = memchr(from->at, '\n', left(from));
    if (!end || (size_t)(end - from->at) >= size)
        return 0;
    const size_t length = (size_t)(end - from->at);
    memcpy(line, from->at, length);
    line[length] = '\0';
    if (length > 0 && line[length - 1] == '\r')
        line[length - 1] = '\0';
    from->at = end + 1;
    return 1;
}

/* Header lines up to the empty one. */
static gw_code read_header(reader *from, double *exposure, gw_error *error) {
    char line[1024];
    *exposure = 1.0;
    if (!next_line(from, line, sizeof line) || strncmp(line, "#?", 2) != 0)
        return gw_fail(error, GW_BAD_INPUT, "it is no Radiance picture: '#?RADIANCE' is not its first line");
    while (next_line(from, line, sizeof line)) {
        if (!line[0])
            return GW_OK;
        double value;
        if (strncmp(line, "FORMAT=", 7) == 0 && strcmp(line + 7, "32-bit_rle_rgbe") != 0)
            return gw_fail(error, GW_BAD_INPUT,
                           "its format is '%.40s': convert it to 32-bit_rle_rgbe (red, green and blue)",
                           line + 7);
        if (sscanf(line, "EXPOSURE=%lf", &value) == 1) {
            *exposure *= value; /* several multiply */
            if (!(*exposure >= 1e-12 && *exposure <= 1e12))
                return gw_fail(error, GW_BAD_INPUT, "its exposure %g is not in 1e-12..1e12", value);
        }
    }
    return gw_fail(error, GW_BAD_INPUT, "its header does not end");
}

static gw_code read_size(reader *from, gw_image *out, gw_error *error) {
    char line[128], vertical, horizontal, rest;
    long height, width;
    if (!next_line(from, line, sizeof line) ||
        sscanf(line, "%cY %ld %cX %ld %c", &vertical, &height, &horizontal, &width, &rest) != 4 ||
        vertical != '-' || horizontal != '+')
        return gw_fail(
            error, GW_BAD_INPUT,
            "its rows are not told as '-Y height +X width': save it from the top left to the right");
    if (height < 1 || width < 1 || height > GW_HDR_MAXIMUM_SIDE || width > GW_HDR_MAXIMUM_SIDE)
        return gw_fail(error, GW_BAD_INPUT, "it is %ld x %ld pixels, not 1..%d a side", width, height,
                       GW_HDR_MAXIMUM_SIDE);
    /* The tightest code is 2 bytes for 127 equal ones of a row's channel, or 4 for 255 equal pixels, whose
     * repeats may be 2^8 times as long each: a few bytes cannot ask for much memory. */
    if ((size_t)height > left(from) || (uint64_t)width * (uint64_t)height > 4096 * (uint64_t)left(from))
        return gw_fail(error, GW_BAD_INPUT, "it is cut: %ld x %ld pixels are promised, %zu bytes are there",
                       width, height, left(from));
    out->width = (uint32_t)width;
    out->height = (uint32_t)height;
    return GW_OK;
}

/* One channel after the other; a count above 128 repeats the next byte count - 128 times. */
static int read_channels(reader *from, uint8_t *row, uint32_t width) {
    for (uint32_t channel = 0; channel < 4; channel++)
        for (uint32_t x = 0; x < width;) {
            if (left(from) < 2)
                return 0;
            const uint32_t code = *from->at++, count = code > 128 ? code - 128 : code;
            if (count == 0 || count > width - x || (code <= 128 && left(from) < count))
                return 0;
            for (uint32_t i = 0; i < count; i++)
                row[4 * (x + i) + channel] = from->at[code > 128 ? 0 : i];
            from->at += code > 128 ? 1 : count;
            x += count;
        }
    return 1;
}

/* Flat pixels, among which (1, 1, 1, n) repeats the one before; such pixels in a row shift n by 8 bits more.
 */
static int read_pixels(reader *from, uint8_t *row, uint32_t width) {
    uint32_t shift = 0;
    for (uint32_t x = 0; x < width;) {
        if (left(from) < 4)
            return 0;
        const uint8_t *pixel = from->at;
        from->at += 4;
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            memcpy(row + 4 * (size_t)x++, pixel, 4);
            shift = 0;
            continue;
        }
        const uint32_t count = shift < 24 ? (uint32_t)pixel[3] << shift : UINT32_MAX;
        if (x == 0 || count > width - x)
            return 0;
        for (uint32_t i = 0; i < count; i++, x++)
            memcpy(row + 4 * (size_t)x, row + 4 * (size_t)(x - 1), 4);
        shift += 8;
    }
    return 1;
}

static int read_row(reader *from, uint8_t *row, uint32_t width) {
    const uint8_t *mark = from->at;
    const int channels = width >= 8 && width <= 32767 && left(from) >= 4 && mark[0] == 2 && mark[1] == 2 &&
                         mark[2] < 128 && ((uint32_t)mark[2] << 8 | mark[3]) == width;
    if (!channels)
        return read_pixels(from, row, width);
    from->at += 4;
    return read_channels(from, row, width);
}

gw_code gw_hdr_decode(const void *bytes, size_t size, gw_image *out, double *exposure, gw_error *error) {
    reader from = {bytes, (const uint8_t *)bytes + size};
    *out = (gw_image){0};
    gw_image image = {0};
    gw_code code = read_header(&from, exposure, error);
    if (code == GW_OK)
        code = read_size(&from, &image, error);
    if (code == GW_OK)
        code = gw_allocate((void **)&image.rgba, (size_t)image.width * image.height, 4, "a Radiance picture",
                           error);
    for (uint32_t y = 0; code == GW_OK && y < image.height; y++)
        if (!read_row(&from, image.rgba + (size_t)y * image.width * 4, image.width))
            code = gw_fail(error, GW_BAD_INPUT, "row %u of %u is cut or damaged", y, image.height);
    if (code == GW_OK)
        *out = image;
    else
        free(image.rgba);
    return code;
}
