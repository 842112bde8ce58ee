#include "base/image.h"

#include "base/file.h"
#include "base/memory.h"

#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

gw_code gw_image_create(uint32_t width, uint32_t height, gw_image *out, gw_error *error) {
    *out = (gw_image){0};
    if (width == 0 || height == 0 || width > GW_IMAGE_MAXIMUM_SIDE || height > GW_IMAGE_MAXIMUM_SIDE) {
        return gw_fail(error, GW_BAD_INPUT, "an image of %u x %u pixels is outside 1 to %d a side", width,
                       height, GW_IMAGE_MAXIMUM_SIDE);
    }
    void *rgba = NULL;
    gw_code code = gw_allocate(&rgba, (size_t)width * height, 4, "pixels", error);
    if (!code) {
        *out = (gw_image){.width = width, .height = height, .rgba = rgba};
    }
    return code;
}

void gw_image_finish(gw_image *image) {
    free(image->rgba);
    *image = (gw_image){0};
}

/* Allocates for a decoder; the size comes from a hostile file. */
static gw_code create_checked(uint64_t width, uint64_t height, const char *name, uint64_t maximum_pixels,
                              gw_image *out, gw_error *error) {
    if (width == 0 || height == 0 || width > GW_IMAGE_MAXIMUM_SIDE || height > GW_IMAGE_MAXIMUM_SIDE) {
        return gw_fail(error, GW_BAD_INPUT, "%s: %llu x %llu pixels is outside 1 to %d a side", name,
                       (unsigned long long)width, (unsigned long long)height, GW_IMAGE_MAXIMUM_SIDE);
    }
    if (width * height > maximum_pixels) {
        return gw_fail(error, GW_BAD_INPUT, "%s: %llu x %llu pixels are more than the limit of %llu", name,
                       (unsigned long long)width, (unsigned long long)height,
                       (unsigned long long)maximum_pixels);
    }
    gw_code code = gw_image_create((uint32_t)width, (uint32_t)height, out, error);
    return code ? gw_context(error, "%s", name) : GW_OK;
}

static gw_code decode_png(const void *data, size_t size, const char *name, uint64_t maximum_pixels,
                          gw_image *out, gw_error *error) {
    png_image png;
    memset(&png, 0, sizeof png);
    png.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_memory(&png, data, size)) {
        return gw_fail(error, GW_BAD_INPUT, "%s: broken PNG: %s", name, png.message);
    }
    gw_code code = create_checked(png.width, png.height, name, maximum_pixels, out, error);
    if (code) {
        png_image_free(&png);
        return code;
    }
    /* libpng takes 16-bit files without a gamma for linear; picture files mean sRGB. */
    png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    png.format = PNG_FORMAT_RGBA;
    if (!png_image_finish_read(&png, NULL, out->rgba, 0, NULL)) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: broken PNG: %s", name, png.message);
        png_image_free(&png);
        gw_image_finish(out);
    }
    return code;
}

static gw_code decode_jpeg(const void *data, size_t size, const char *name, uint64_t maximum_pixels,
                           gw_image *out, gw_error *error) {
    int width = 0, height = 0, subsampling = 0, space = 0;
    gw_code code = GW_OK;
    tjhandle decoder = tjInitDecompress();
    if (!decoder) {
        return gw_fail(error, GW_MACHINE, "%s: not enough memory for the JPEG decoder", name);
    }
    if (tjDecompressHeader3(decoder, data, (unsigned long)size, &width, &height, &subsampling, &space) != 0 ||
        width < 0 || height < 0) {
        code = gw_fail(error, GW_BAD_INPUT, "%s: broken JPEG: %s", name, tjGetErrorStr2(decoder));
    } else {
        code = create_checked((uint64_t)width, (uint64_t)height, name, maximum_pixels, out, error);
    }
    /* A scan limit, because a small progressive file can ask for thousands of passes over a large picture. */
    if (!code && tjDecompress2(decoder, data, (unsigned long)size, out->rgba, width, 0, height, TJPF_RGBA,
                               TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) != 0) {
        /* Stray bytes between markers are common and harmless; every other warning means missing picture. */
        const char *reason = tjGetErrorStr2(decoder);
        if (tjGetErrorCode(decoder) != TJERR_WARNING || !strstr(reason, "extraneous bytes")) {
            code = gw_fail(error, GW_BAD_INPUT, "%s: broken JPEG: %s", name, reason);
            gw_image_finish(out);
        }
    }
    tjDestroy(decoder);
    return code;
}

gw_code gw_image_decode(const void *data, size_t size, const char *name, uint64_t maximum_pixels,
                        gw_image *out, gw_error *error) {
    static const uint8_t png_signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    static const uint8_t jpeg_signature[3] = {0xff, 0xd8, 0xff};
    *out = (gw_image){0};
    if (size >= sizeof png_signature && memcmp(data, png_signature, sizeof png_signature) == 0) {
        return decode_png(data, size, name, maximum_pixels, out, error);
    }
    if (size >= sizeof jpeg_signature && memcmp(data, jpeg_signature, sizeof jpeg_signature) == 0) {
        return decode_jpeg(data, size, name, maximum_pixels, out, error);
    }
    return gw_fail(error, GW_BAD_INPUT, "%s: neither a PNG nor a JPEG picture", name);
}

/* A PNG in the making: libpng writes here, and leaves by longjmp when something fails. */
typedef struct png_output {
    gw_bytes bytes;
    size_t capacity;
    char message[128];
} png_output;

static void on_png_data(png_structp png, png_bytep data, size_t size) {
    png_output *output = png_get_io_ptr(png);
    void *bytes = output->bytes.data;
    if (gw_grow(&bytes, &output->capacity, output->bytes.size + size, 1, "bytes", NULL)) {
        png_error(png, "not enough memory");
    }
    output->bytes.data = bytes;
    memcpy(output->bytes.data + output->bytes.size, data, size);
    output->bytes.size += size;
}

static void on_png_flush(png_structp png) {
    (void)png;
}

static void on_png_error(png_structp png, png_const_charp message) {
    png_output *output = png_get_error_ptr(png);
    strncpy(output->message, message, sizeof output->message - 1);
    png_longjmp(png, 1);
}

static void on_png_warning(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

static void put_comment(png_structp png, png_infop info, const char *comment) {
    /* tEXt is Latin-1; text beyond ASCII needs the international kind. */
    int ascii = 1;
    for (const char *byte = comment; *byte; byte++) {
        ascii &= (unsigned char)*byte < 128;
    }
    char key[] = "Comment";
    png_text text = {0};
    text.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    text.key = key;
    text.text = (char *)(uintptr_t)comment;
    text.text_length = ascii ? strlen(comment) : 0;
    text.itxt_length = ascii ? 0 : strlen(comment);
    png_set_text(png, info, &text, 1);
}

/* 1 on success. Kept apart so that no local of the caller lives across the longjmp. */
static int encode_png(const gw_image *image, const char *comment, png_structp png, png_infop info,
                      png_output *output) {
    if (setjmp(png_jmpbuf(png))) {
        return 0;
    }
    png_set_write_fn(png, output, on_png_data, on_png_flush);
    png_set_IHDR(png, info, image->width, image->height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_compression_level(png, 4);
    if (comment) {
        put_comment(png, info, comment);
    }
    png_write_info(png, info);
    png_set_filler(png, 0, PNG_FILLER_AFTER);
    for (uint32_t y = 0; y < image->height; y++) {
        png_write_row(png, image->rgba + (size_t)y * image->width * 4);
    }
    png_write_end(png, info);
    return 1;
}

gw_code gw_image_write_png(const char *path, const gw_image *image, const char *comment, gw_error *error) {
    png_output output = {0};
    gw_code code = GW_OK;
    png_infop info = NULL;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &output, on_png_error, on_png_warning);
    if (png) {
        info = png_create_info_struct(png);
    }
    if (!info) {
        code = gw_fail(error, GW_MACHINE, "%s: not enough memory for the PNG encoder", path);
    } else if (!encode_png(image, comment, png, info, &output)) {
        code = gw_fail(error, GW_NO_OUTPUT, "%s: the picture cannot be encoded: %s", path, output.message);
    } else {
        code = gw_file_write(path, output.bytes.data, output.bytes.size, error);
    }
    png_destroy_write_struct(&png, &info);
    gw_bytes_finish(&output.bytes);
    return code;
}

void gw_image_place(gw_image *target, const gw_image *source, int64_t x, int64_t y) {
    int64_t left = x < 0 ? 0 : x, top = y < 0 ? 0 : y;
    int64_t right = x + source->width < target->width ? x + source->width : target->width;
    int64_t bottom = y + source->height < target->height ? y + source->height : target->height;
    if (left >= right) {
        return;
    }
    for (int64_t row = top; row < bottom; row++) {
        memcpy(target->rgba + 4 * (size_t)(row * target->width + left),
               source->rgba + 4 * (size_t)((row - y) * source->width + (left - x)),
               4 * (size_t)(right - left));
    }
}
