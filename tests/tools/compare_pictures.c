/* Compares a picture with the one of another renderer:
 *   compare_pictures OURS REFERENCE TRIPLE.jpg [LEVELS MASK]
 * prints one line of JSON: FLIP and the mean difference in codes of 8 bits, absolute and by channel (ours
 * minus reference), and, of `render --debug levels` at tau 0 with one ray a pixel and a reference that is
 * white where something is hit, the share of pixels that only one of the two hits. Writes both pictures and
 * the map of FLIP side by side. Exit codes as gazewall's. */
#include "base/file.h"
#include "base/image.h"
#include "base/memory.h"
#include "render/flip.h"

#include <stdio.h>
#include <stdlib.h>
#include <turbojpeg.h>

enum { MAXIMUM_PIXELS = 1 << 26, MAXIMUM_FILE = 1 << 28, JPEG_QUALITY = 86 };

static gw_code read_picture(const char *path, gw_image *out, gw_error *error) {
    gw_bytes bytes = {0};
    gw_code code = gw_file_read(path, MAXIMUM_FILE, &bytes, error);
    if (!code)
        code = gw_image_decode(bytes.data, bytes.size, path, MAXIMUM_PIXELS, out, error);
    gw_bytes_finish(&bytes);
    return code;
}

static gw_code write_jpeg(const char *path, const gw_image *image, gw_error *error) {
    unsigned char *bytes = NULL;
    unsigned long size = 0;
    tjhandle encoder = tjInitCompress();
    gw_code code = GW_OK;
    if (!encoder || tjCompress2(encoder, image->rgba, (int)image->width, 0, (int)image->height, TJPF_RGBA,
                                &bytes, &size, TJSAMP_444, JPEG_QUALITY, TJFLAG_ACCURATEDCT) != 0)
        code = gw_fail(error, GW_MACHINE, "%s: %s", path, tjGetErrorStr2(encoder));
    if (!code)
        code = gw_file_write(path, bytes, size, error);
    tjFree(bytes);
    tjDestroy(encoder);
    return code;
}

typedef struct difference {
    double absolute, by_channel[3]; /* codes of 8 bits */
} difference;

static difference mean_difference(const gw_image *ours, const gw_image *reference) {
    const size_t pixels = (size_t)ours->width * ours->height;
    difference mean = {0};
    for (size_t i = 0; i < pixels * 4; i++) {
        const double apart = (double)ours->rgba[i] - reference->rgba[i];
        if (i % 4 == 3)
            continue;
        mean.absolute += (apart < 0 ? -apart : apart) / (3.0 * (double)pixels);
        mean.by_channel[i % 4] += apart / (double)pixels;
    }
    return mean;
}

/* A triangle is pure red there, which no sky of ours is. */
static double mask_mismatch(const gw_image *levels, const gw_image *mask) {
    const size_t pixels = (size_t)levels->width * levels->height;
    size_t apart = 0;
    for (size_t i = 0; i < pixels; i++) {
        const uint8_t *level = levels->rgba + i * 4;
        const int ours = level[0] > 250 && level[1] < 5 && level[2] < 5;
        apart += ours != (mask->rgba[i * 4] > 127);
    }
    return (double)apart / (double)pixels;
}

static gw_code write_triple(const gw_image *ours, const gw_image *reference, const float *map,
                            const char *path, gw_error *error) {
    gw_image heat = {0}, all = {0};
    gw_code code = gw_image_create(ours->width, ours->height, &heat, error);
    if (!code)
        code = gw_image_create(ours->width * 3, ours->height, &all, error);
    for (size_t i = 0; !code && i < (size_t)ours->width * ours->height; i++)
        gw_flip_color(map[i], heat.rgba + i * 4);
    const gw_image *const parts[3] = {ours, reference, &heat};
    for (int i = 0; !code && i < 3; i++)
        gw_image_place(&all, parts[i], (int64_t)i * ours->width, 0);
    if (!code)
        code = write_jpeg(path, &all, error);
    gw_image_finish(&heat);
    gw_image_finish(&all);
    return code;
}

static gw_code same_size(const gw_image *a, const gw_image *b, gw_error *error) {
    if (a->width == b->width && a->height == b->height)
        return GW_OK;
    return gw_fail(error, GW_BAD_INPUT, "the pictures are %u x %u and %u x %u pixels", a->width, a->height,
                   b->width, b->height);
}

static gw_code compare(const gw_image pictures[4], int masks, const char *triple, gw_error *error) {
    float *map = NULL;
    double flip = 0;
    const size_t pixels = (size_t)pictures[0].width * pictures[0].height;
    gw_code code = gw_allocate((void **)&map, pixels, sizeof *map, "differences", error);
    if (!code)
        code = gw_flip(&pictures[1], &pictures[0], GW_FLIP_PIXELS_PER_DEGREE, map, &flip, error);
    if (!code)
        code = write_triple(&pictures[0], &pictures[1], map, triple, error);
    free(map);
    if (code)
        return code;
    const difference mean = mean_difference(&pictures[0], &pictures[1]);
    printf("{\"flip\": %.4f, \"mean\": %.2f, \"bias\": [%.2f, %.2f, %.2f]", flip, mean.absolute,
           mean.by_channel[0], mean.by_channel[1], mean.by_channel[2]);
    if (masks)
        printf(", \"mask\": %.5f", mask_mismatch(&pictures[2], &pictures[3]));
    puts("}");
    return GW_OK;
}

int main(int count, char **words) {
    gw_error error = {0};
    gw_image pictures[4] = {{0}};
    const int masks = count == 6;
    if (count != 4 && count != 6) {
        fputs("usage: compare_pictures OURS REFERENCE TRIPLE.jpg [LEVELS MASK]\n", stderr);
        return GW_BAD_INPUT;
    }
    const char *const paths[4] = {words[1], words[2], masks ? words[4] : NULL, masks ? words[5] : NULL};
    gw_code code = GW_OK;
    for (int i = 0; i < 4 && paths[i] && !code; i++) {
        code = read_picture(paths[i], &pictures[i], &error);
        if (!code)
            code = same_size(&pictures[0], &pictures[i], &error);
    }
    if (!code)
        code = compare(pictures, masks, words[3], &error);
    if (code)
        fprintf(stderr, "compare_pictures: %s\n", error.text);
    for (int i = 0; i < 4; i++)
        gw_image_finish(&pictures[i]);
    return code;
}
