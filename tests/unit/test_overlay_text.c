/* Text over pictures: every glyph is itself, scales are whole, nothing is drawn outside. */
#include "tests/support/check.h"

#include "wall/overlay_text.h"

static const uint8_t white[4] = {255, 255, 255, 255};

static gw_image blank(uint32_t width, uint32_t height) {
    gw_image image;
    gw_error error = {0};
    assert_int_equal(gw_image_create(width, height, &image, &error), GW_OK);
    return image;
}

static int lit(const gw_image *image, uint32_t x, uint32_t y) {
    return image->rgba[((size_t)y * image->width + x) * 4] == 255;
}

static uint32_t count_lit(const gw_image *image) {
    uint32_t count = 0;
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++)
            count += (uint32_t)lit(image, x, y);
    return count;
}

static void an_l_looks_like_one(void **state) {
    (void)state;
    gw_image image = blank(GW_TEXT_ADVANCE, GW_TEXT_LINE);
    gw_text_draw(&image, 0, 0, 1, white, "L");
    for (uint32_t y = 0; y < GW_TEXT_LINE; y++)
        for (uint32_t x = 0; x < GW_TEXT_ADVANCE; x++)
            assert_int_equal(lit(&image, x, y), (x == 0 && y < 7) || (y == 6 && x < 5));
    gw_image_finish(&image);
}

/* All printable characters differ from each other, and only the blank is empty. */
static void characters_differ(void **state) {
    (void)state;
    gw_image images[95];
    for (int i = 0; i < 95; i++) {
        images[i] = blank(GW_TEXT_ADVANCE, GW_TEXT_LINE);
        const char text[2] = {(char)(' ' + i), '\0'};
        gw_text_draw(&images[i], 0, 0, 1, white, text);
        assert_int_equal(count_lit(&images[i]) == 0, i == 0);
        for (int other = 0; other < i; other++)
            assert_memory_not_equal(images[i].rgba, images[other].rgba,
                                    (size_t)GW_TEXT_ADVANCE * GW_TEXT_LINE * 4);
    }
    for (int i = 0; i < 95; i++)
        gw_image_finish(&images[i]);
}

static void scale_makes_squares(void **state) {
    (void)state;
    enum { SCALE = 3 };
    const char *text = "Ag\nq~";
    uint32_t width, height;
    gw_text_measure(text, 1, &width, &height);
    assert_int_equal(width, 2 * GW_TEXT_ADVANCE);
    assert_int_equal(height, 2 * GW_TEXT_LINE);
    gw_image small = blank(width, height), large = blank(width * SCALE, height * SCALE);
    gw_text_draw(&small, 0, 0, 1, white, text);
    gw_text_draw(&large, 0, 0, SCALE, white, text);
    assert_true(count_lit(&small) > 40);
    for (uint32_t y = 0; y < large.height; y++)
        for (uint32_t x = 0; x < large.width; x++)
            assert_int_equal(lit(&large, x, y), lit(&small, x / SCALE, y / SCALE));
    gw_image_finish(&small);
    gw_image_finish(&large);
}

/* Half outside on every side, the same dots as in a larger picture; far outside, none. */
static void text_is_cut_at_the_border(void **state) {
    (void)state;
    enum { SIDE = 40, MARGIN = 30 };
    gw_image roomy = blank(SIDE + 2 * MARGIN, SIDE + 2 * MARGIN);
    static const int64_t places[][2] = {{-7, -5}, {SIDE - 9, 4}, {3, SIDE - 6}, {-300, 2}, {2, 300}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        gw_image tight = blank(SIDE, SIDE);
        memset(roomy.rgba, 0, (size_t)roomy.width * roomy.height * 4);
        gw_text_draw(&tight, places[i][0], places[i][1], 2, white, "W@\n\x80\t");
        gw_text_draw(&roomy, places[i][0] + MARGIN, places[i][1] + MARGIN, 2, white, "W@\n??");
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++)
                assert_int_equal(lit(&tight, x, y), lit(&roomy, x + MARGIN, y + MARGIN));
        gw_image_finish(&tight);
    }
    gw_image_finish(&roomy);
}

static void boxes_let_the_picture_through(void **state) {
    (void)state;
    gw_image image = blank(4, 2);
    gw_box_draw(&image, -1, -1, 3, 9, (const uint8_t[4]){200, 100, 0, 255});
    gw_box_draw(&image, 1, 0, 2, 1, (const uint8_t[4]){0, 200, 100, 128});
    static const uint8_t wanted[2][4][4] = {
        {{200, 100, 0, 255}, {100, 150, 50, 255}, {0, 100, 50, 255}, {0, 0, 0, 0}},
        {{200, 100, 0, 255}, {200, 100, 0, 255}, {0, 0, 0, 0}, {0, 0, 0, 0}}};
    assert_memory_equal(image.rgba, wanted, sizeof wanted);
    gw_image_finish(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_l_looks_like_one),           cmocka_unit_test(characters_differ),
        cmocka_unit_test(scale_makes_squares),           cmocka_unit_test(text_is_cut_at_the_border),
        cmocka_unit_test(boxes_let_the_picture_through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
