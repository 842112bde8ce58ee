/* Images: PNG round trip and its comment, JPEG, limits before decoding, hostile bytes, placing. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/image.h"

#include <png.h>
#include <turbojpeg.h>
#include <unistd.h>

enum { WIDTH = 61, HEIGHT = 37 };

static gw_image make_picture(void) {
    gw_image image;
    gw_error error = {0};
    assert_int_equal(gw_image_create(WIDTH, HEIGHT, &image, &error), GW_OK);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        image.rgba[4 * i + 0] = (uint8_t)(i % WIDTH * 4);
        image.rgba[4 * i + 1] = (uint8_t)(i / WIDTH * 6);
        image.rgba[4 * i + 2] = (uint8_t)(i * 7);
        image.rgba[4 * i + 3] = (uint8_t)i; /* left out by the PNG */
    }
    return image;
}

static gw_bytes png_bytes(const char *comment) {
    char path[512];
    scratch_path(path, "picture.png");
    gw_image image = make_picture();
    gw_error error = {0};
    assert_int_equal(gw_image_write_png(path, &image, comment, &error), GW_OK);
    gw_image_finish(&image);
    gw_bytes bytes;
    assert_int_equal(gw_file_read(path, 1 << 20, &bytes, &error), GW_OK);
    unlink(path);
    return bytes;
}

static void png_round_trip_keeps_every_pixel(void **state) {
    (void)state;
    gw_bytes bytes = png_bytes(NULL);
    gw_image before = make_picture(), after;
    check_ok(gw_image_decode(bytes.data, bytes.size, "picture.png", 10000, &after, &error));
    assert_int_equal(after.width, WIDTH);
    assert_int_equal(after.height, HEIGHT);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        assert_memory_equal(before.rgba + 4 * i, after.rgba + 4 * i, 3);
        assert_int_equal(after.rgba[4 * i + 3], 255);
    }
    gw_image_finish(&before);
    gw_image_finish(&after);
    gw_bytes_finish(&bytes);
}

static int contains(const gw_bytes *bytes, const char *part) {
    return memmem(bytes->data, bytes->size, part, strlen(part)) != NULL;
}

static void comment_is_in_the_file(void **state) {
    (void)state;
    gw_bytes plain = png_bytes("gazewall sim --frames 8");
    assert_true(contains(&plain, "tEXtComment"));
    assert_true(contains(&plain, "gazewall sim --frames 8"));
    gw_bytes_finish(&plain);
    gw_bytes accented = png_bytes("sc\xc3\xa8ne");
    assert_true(contains(&accented, "iTXtComment"));
    assert_true(contains(&accented, "sc\xc3\xa8ne"));
    gw_bytes_finish(&accented);
}

static void png_that_cannot_be_written_is_said(void **state) {
    (void)state;
    gw_image image = make_picture();
    check_fails(gw_image_write_png("/nowhere/x.png", &image, NULL, &error), GW_NO_OUTPUT, "/nowhere/x.png");
    gw_image_finish(&image);
}

static void transparency_stays_straight(void **state) {
    (void)state;
    png_image png;
    memset(&png, 0, sizeof png);
    png.version = PNG_IMAGE_VERSION;
    png.width = png.height = 2;
    png.format = PNG_FORMAT_RGBA;
    const uint8_t pixels[16] = {200, 100, 50, 0, 200, 100, 50, 128, 1, 2, 3, 255, 9, 9, 9, 1};
    uint8_t file[1024];
    png_alloc_size_t size = sizeof file;
    assert_true(png_image_write_to_memory(&png, file, &size, 0, pixels, 0, NULL));
    gw_image image;
    check_ok(gw_image_decode(file, size, "alpha.png", 100, &image, &error));
    assert_memory_equal(image.rgba, pixels, sizeof pixels);
    gw_image_finish(&image);
}

static unsigned long jpeg_bytes(unsigned char **out) {
    gw_image image = make_picture();
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        image.rgba[4 * i + 2] = 128; /* smooth, so that the loss is small */
    }
    tjhandle encoder = tjInitCompress();
    unsigned long size = 0;
    *out = NULL;
    assert_int_equal(
        tjCompress2(encoder, image.rgba, WIDTH, 0, HEIGHT, TJPF_RGBA, out, &size, TJSAMP_444, 95, 0), 0);
    tjDestroy(encoder);
    gw_image_finish(&image);
    return size;
}

static void jpeg_is_decoded(void **state) {
    (void)state;
    unsigned char *file = NULL;
    unsigned long size = jpeg_bytes(&file);
    gw_image image;
    check_ok(gw_image_decode(file, size, "photo.jpg", 10000, &image, &error));
    assert_int_equal(image.width, WIDTH);
    assert_int_equal(image.height, HEIGHT);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        assert_in_range(image.rgba[4 * i] + 8 - i % WIDTH * 4, 0, 16);
        assert_int_equal(image.rgba[4 * i + 3], 255);
    }
    gw_image_finish(&image);
    check_fails(gw_image_decode(file, size / 2, "cut.jpg", 10000, &image, &error), GW_BAD_INPUT,
                "cut.jpg: broken JPEG");
    check_fails(gw_image_decode(file, size, "photo.jpg", 2000, &image, &error), GW_BAD_INPUT,
                "61 x 37 pixels are more than the limit of 2000");
    tjFree(file);
}

static void large_pictures_are_refused_before_decoding(void **state) {
    (void)state;
    gw_bytes bytes = png_bytes(NULL);
    gw_image image;
    check_fails(gw_image_decode(bytes.data, bytes.size, "p.png", WIDTH * HEIGHT - 1, &image, &error),
                GW_BAD_INPUT, "p.png: 61 x 37 pixels are more than the limit of 2256");
    assert_null(image.rgba);
    gw_bytes_finish(&bytes);
    check_fails(gw_image_create(0, 5, &image, &error), GW_BAD_INPUT, "0 x 5");
    check_fails(gw_image_create(40000, 5, &image, &error), GW_BAD_INPUT, "40000 x 5");
}

static void other_files_are_no_pictures(void **state) {
    (void)state;
    gw_image image;
    check_fails(gw_image_decode("GIF89a..", 8, "x.gif", 100, &image, &error), GW_BAD_INPUT,
                "x.gif: neither a PNG nor a JPEG");
    check_fails(gw_image_decode("", 0, "empty", 100, &image, &error), GW_BAD_INPUT, "empty: neither");
    check_fails(gw_image_decode("\x89PNG\r\n\x1a\n", 8, "x.png", 100, &image, &error), GW_BAD_INPUT,
                "x.png: broken PNG");
}

/* Every cut and every bent byte gives a picture within the limit or an error, never a crash. */
static void hostile_bytes_never_crash(void **state) {
    (void)state;
    gw_bytes png = png_bytes("x");
    unsigned char *jpeg = NULL;
    unsigned long jpeg_size = jpeg_bytes(&jpeg);
    size_t refused = 0;
    for (int kind = 0; kind < 2; kind++) {
        uint8_t *data = kind ? jpeg : png.data;
        size_t size = kind ? jpeg_size : png.size;
        for (size_t i = 0; i<size; i += size> 2000 ? 3 : 1) {
            gw_image image;
            gw_error error = {0};
            uint8_t kept = data[i];
            data[i] = (uint8_t)(kept ^ (1u << i % 8));
            refused += gw_image_decode(data, size, "bent", 1 << 20, &image, &error) != GW_OK;
            gw_image_finish(&image);
            data[i] = kept;
            refused += gw_image_decode(data, i, "cut", 1 << 20, &image, &error) != GW_OK;
            gw_image_finish(&image);
        }
    }
    assert_true(refused > 1000);
    tjFree(jpeg);
    gw_bytes_finish(&png);
}

static void placing_cuts_at_every_border(void **state) {
    (void)state;
    gw_image small, large;
    check_ok(gw_image_create(3, 2, &small, &error));
    memset(small.rgba, 9, 3 * 2 * 4);
    for (int y = -3; y <= 5; y++) {
        for (int x = -4; x <= 6; x++) {
            check_ok(gw_image_create(5, 4, &large, &error));
            gw_image_place(&large, &small, x, y);
            for (int v = 0; v < 4; v++) {
                for (int u = 0; u < 5; u++) {
                    int inside = u >= x && u < x + 3 && v >= y && v < y + 2;
                    assert_int_equal(large.rgba[4 * (v * 5 + u) + 3], inside ? 9 : 0);
                }
            }
            gw_image_finish(&large);
        }
    }
    gw_image_finish(&small);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(png_round_trip_keeps_every_pixel),
        cmocka_unit_test(comment_is_in_the_file),
        cmocka_unit_test(png_that_cannot_be_written_is_said),
        cmocka_unit_test(transparency_stays_straight),
        cmocka_unit_test(jpeg_is_decoded),
        cmocka_unit_test(large_pictures_are_refused_before_decoding),
        cmocka_unit_test(other_files_are_no_pictures),
        cmocka_unit_test(hostile_bytes_never_crash),
        cmocka_unit_test(placing_cuts_at_every_border),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
