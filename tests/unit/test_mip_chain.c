/* Resizing and mip levels of textures in linear light. */
#include "tests/support/check.h"

#include "render/mip_chain.h"

static gw_texel_curve curve;

static gw_texture texture_of(uint32_t width, uint32_t height, uint8_t *rgba) {
    return (gw_texture){.name = "test", .image = {width, height, rgba}};
}

static void equal_sizes_come_back_byte_for_byte(void **state) {
    (void)state;
    uint8_t rgba[16 * 16 * 4], back[sizeof rgba];
    for (size_t i = 0; i < sizeof rgba; ++i)
        rgba[i] = (uint8_t)(i * 37 + i / 256 * 11);
    gw_texture texture = texture_of(16, 16, rgba);
    gw_linear_image image;
    check_ok(gw_linear_image_init(&curve, &texture, 16, &image, &error));
    gw_linear_image_encode(&curve, &image, back);
    assert_memory_equal(rgba, back, sizeof rgba);
    gw_linear_image_finish(&image);
}

static void every_byte_survives_decoding_and_encoding(void **state) {
    (void)state;
    uint8_t rgba[16 * 16 * 4], back[sizeof rgba];
    for (size_t i = 0; i < 256; ++i)
        memset(rgba + i * 4, (int)i, 4);
    gw_texture texture = texture_of(16, 16, rgba);
    gw_linear_image image;
    check_ok(gw_linear_image_init(&curve, &texture, 16, &image, &error));
    gw_linear_image_encode(&curve, &image, back);
    assert_memory_equal(rgba, back, sizeof rgba);
    gw_linear_image_finish(&image);
}

static void means_are_taken_in_linear_light(void **state) {
    (void)state;
    /* Half black, half white is 188 of 255 in sRGB, not 128. */
    uint8_t rgba[2 * 2 * 4] = {0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255}, back[4];
    gw_texture texture = texture_of(2, 2, rgba);
    gw_linear_image image;
    check_ok(gw_linear_image_init(&curve, &texture, 2, &image, &error));
    gw_linear_image_halve(&image);
    assert_int_equal(image.side, 1);
    gw_linear_image_encode(&curve, &image, back);
    const uint8_t wanted[4] = {188, 188, 188, 255};
    assert_memory_equal(back, wanted, 4);
    gw_linear_image_finish(&image);
}

static void transparent_texels_do_not_bleed(void **state) {
    (void)state;
    uint8_t rgba[2 * 2 * 4] = {200, 10, 10, 255, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0}, back[4];
    gw_texture texture = texture_of(2, 2, rgba);
    gw_linear_image image;
    check_ok(gw_linear_image_init(&curve, &texture, 2, &image, &error));
    gw_linear_image_halve(&image);
    gw_linear_image_encode(&curve, &image, back);
    const uint8_t wanted[4] = {200, 10, 10, 64};
    assert_memory_equal(back, wanted, 4);
    gw_linear_image_finish(&image);
}

static void resizing_keeps_flat_colour_and_the_mean(void **state) {
    (void)state;
    uint8_t flat[12 * 20 * 4], back[16 * 16 * 4];
    for (size_t i = 0; i < sizeof flat; ++i)
        flat[i] = (uint8_t)(i % 4 == 3 ? 255 : 90 + 20 * (i % 4));
    static const gw_wrap wraps[] = {GW_WRAP_REPEAT, GW_WRAP_CLAMP, GW_WRAP_MIRROR};
    for (int w = 0; w < 3; ++w) {
        gw_texture texture = texture_of(12, 20, flat); /* grows across, shrinks down */
        texture.wrap_u = texture.wrap_v = wraps[w];
        gw_linear_image image;
        check_ok(gw_linear_image_init(&curve, &texture, 16, &image, &error));
        gw_linear_image_encode(&curve, &image, back);
        for (size_t i = 0; i < sizeof back; ++i)
            assert_int_equal(back[i], flat[i % 4]);
        gw_linear_image_finish(&image);
    }
    /* One white row in sixty: shrunk to one texel, it is a sixtieth of the light. */
    uint8_t line[60 * 4] = {0}, one[4];
    for (size_t i = 0; i < 60; ++i)
        line[i * 4 + 3] = 255;
    memset(line + 7 * 4, 255, 4);
    gw_texture texture = texture_of(1, 60, line);
    gw_linear_image image;
    check_ok(gw_linear_image_init(&curve, &texture, 1, &image, &error));
    assert_in_range(image.texels[0][0], 1091, 1093);
    gw_linear_image_encode(&curve, &image, one);
    assert_int_equal(one[3], 255);
    gw_linear_image_finish(&image);
}

int main(void) {
    gw_texel_curve_init(&curve);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_sizes_come_back_byte_for_byte),
        cmocka_unit_test(every_byte_survives_decoding_and_encoding),
        cmocka_unit_test(means_are_taken_in_linear_light),
        cmocka_unit_test(transparent_texels_do_not_bleed),
        cmocka_unit_test(resizing_keeps_flat_colour_and_the_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
