/* The frame code: drawn and read back, also scaled, dimmed and tinted; a wall whose tiles show two frames is
 * told from one that shows one, and what is no code is none. */
#include "tests/support/check.h"

#include "wall/frame_code.h"

static gw_image noise(uint32_t width, uint32_t height) {
    gw_image image;
    gw_error error = {0};
    assert_int_equal(gw_image_create(width, height, &image, &error), GW_OK);
    uint32_t random = 1;
    for (size_t i = 0; i < (size_t)width * height * 4; i++) {
        random = random * 1664525 + 1013904223;
        image.rgba[i] = (uint8_t)(random >> 24);
    }
    return image;
}

static gw_code_reading read_all(const gw_image *image, uint32_t *frame) {
    const double whole[4] = {0, 0, image->width, image->height};
    return gw_frame_code_read(image, whole, image->width, image->height, frame);
}

static void every_number_comes_back(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1920, 1080}, {160, 90}, {64, 200}, {61, 53}};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        gw_image image = noise(sizes[s][0], sizes[s][1]);
        uint32_t frame;
        assert_int_equal(read_all(&image, &frame), GW_CODE_NONE);
        for (uint32_t number = 0; number < 2 * GW_CODE_PERIOD; number += s ? 1 : 37) {
            gw_frame_code_draw(&image, number);
            assert_int_equal(read_all(&image, &frame), GW_CODE_READ);
            assert_int_equal(frame, number % GW_CODE_PERIOD);
        }
        gw_image_finish(&image);
    }
}

/* A photograph: another size, by the mean of what falls into a pixel, darker and tinted. */
static gw_image photograph(const gw_image *image, uint32_t width, uint32_t height) {
    gw_image out = noise(width, height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            for (int channel = 0; channel < 3; channel++) {
                uint32_t sum = 0, count = 0;
                const uint32_t top = y * image->height / height, left = x * image->width / width;
                for (uint32_t v = top; v < top + 2 && v < image->height; v++)
                    for (uint32_t u = left; u < left + 2 && u < image->width; u++, count++)
                        sum += image->rgba[((size_t)v * image->width + u) * 4 + (size_t)channel];
                out.rgba[((size_t)y * width + x) * 4 + (size_t)channel] =
                    (uint8_t)(20 + (uint32_t)channel * 10 + sum / count * 150 / 255);
            }
    return out;
}

static void photographs_can_be_read(void **state) {
    (void)state;
    gw_image image = noise(480, 270);
    for (uint32_t number = 0; number < GW_CODE_PERIOD; number += 5) {
        gw_frame_code_draw(&image, number);
        static const uint32_t sizes[][2] = {{480, 270}, {301, 170}, {953, 531}};
        for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
            gw_image photo = photograph(&image, sizes[s][0], sizes[s][1]);
            const double whole[4] = {0, 0, photo.width, photo.height};
            uint32_t frame;
            assert_int_equal(gw_frame_code_read(&photo, whole, 480, 270, &frame), GW_CODE_READ);
            assert_int_equal(frame, number);
            gw_image_finish(&photo);
        }
    }
    gw_image_finish(&image);
}

/* Open while the frame changed: the mean of two frames is neither of them, nor a third. */
static void a_change_is_no_third_frame(void **state) {
    (void)state;
    gw_image before = noise(320, 180), after = noise(320, 180);
    for (uint32_t number = 0; number < GW_CODE_PERIOD; number++) {
        gw_frame_code_draw(&before, number);
        gw_frame_code_draw(&after, number + 1);
        for (size_t i = 0; i < (size_t)320 * 180 * 4; i++)
            after.rgba[i] = (uint8_t)((before.rgba[i] + after.rgba[i]) / 2);
        uint32_t frame;
        assert_int_equal(read_all(&after, &frame), GW_CODE_CHANGED);
    }
    gw_image_finish(&before);
    gw_image_finish(&after);
}

/* Two tiles beside each other in one picture, the right one a frame behind. */
static void a_tile_that_is_behind_is_seen(void **state) {
    (void)state;
    gw_image wall = noise(400, 100), tile = noise(200, 100);
    for (uint32_t i = 0; i < 2; i++) {
        gw_frame_code_draw(&tile, 300 - i);
        gw_image_place(&wall, &tile, 200 * i, 0);
    }
    uint32_t frames[2];
    for (uint32_t i = 0; i < 2; i++) {
        const double rectangle[4] = {200.0 * i, 0, 200, 100};
        assert_int_equal(gw_frame_code_read(&wall, rectangle, 200, 100, &frames[i]), GW_CODE_READ);
    }
    assert_int_equal(frames[0], 300 % GW_CODE_PERIOD);
    assert_int_equal(frames[1], 299 % GW_CODE_PERIOD);
    gw_image_finish(&wall);
    gw_image_finish(&tile);
}

/* Damage: a cell that was painted over makes the code unreadable or is seen by its parity; a rectangle beyond
 * the picture is none. */
static void damage_is_no_frame(void **state) {
    (void)state;
    gw_image image = noise(240, 240);
    const gw_code_place at = gw_frame_code_place(240, 240);
    for (uint32_t cell = 0; cell < 12; cell++) {
        gw_frame_code_draw(&image, 77);
        for (uint32_t y = 0; y < at.cell; y++)
            for (uint32_t x = 0; x < at.cell; x++) {
                uint8_t *pixel = image.rgba + ((size_t)(at.y + (1 + cell / 4) * at.cell + y) * 240 + at.x +
                                               (1 + cell % 4) * at.cell + x) *
                                                  4;
                for (int i = 0; i < 3; i++)
                    pixel[i] = (uint8_t)(255 - pixel[i]);
            }
        uint32_t frame;
        assert_int_not_equal(read_all(&image, &frame), GW_CODE_READ);
    }
    gw_frame_code_draw(&image, 77);
    uint32_t frame;
    static const double beyond[][4] = {{-100, 0, 240, 240}, {50, 0, 240, 240}, {0, 1e9, 240, 240}};
    for (size_t i = 0; i < 3; i++)
        assert_int_equal(gw_frame_code_read(&image, beyond[i], 240, 240, &frame), GW_CODE_NONE);
    gw_image_finish(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_comes_back),    cmocka_unit_test(photographs_can_be_read),
        cmocka_unit_test(a_change_is_no_third_frame), cmocka_unit_test(a_tile_that_is_behind_is_seen),
        cmocka_unit_test(damage_is_no_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
