/* Flicker against values that follow from its definition. */
#include "tests/support/check.h"

#include "render/flicker.h"

#include <math.h>

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

static gw_image filled(uint8_t grey) {
    gw_image image = {0};
    check_ok(gw_image_create(WIDTH, HEIGHT, &image, &error));
    memset(image.rgba, grey, (size_t)PIXELS * 4);
    return image;
}

static void paint(gw_image *image, size_t pixel, uint8_t grey) {
    memset(image->rgba + pixel * 4, grey, 3);
}

/* Dark left of x, bright from there on. */
static gw_image edge_at(int x) {
    gw_image image = filled(40);
    for (size_t i = 0; i < PIXELS; ++i)
        paint(&image, i, (int)(i % WIDTH) < x ? 40 : 200);
    return image;
}

static void add(gw_flicker *flicker, gw_image reference, gw_image picture) {
    check_ok(gw_flicker_add(flicker, &reference, &picture, &error));
    gw_image_finish(&reference);
    gw_image_finish(&picture);
}

static void a_still_error_does_not_flicker(void **state) {
    gw_flicker flicker = {0};
    (void)state;
    for (int frame = 0; frame < 3; ++frame)
        add(&flicker, filled(90), edge_at(20));
    gw_flicker_result result = gw_flicker_of(&flicker);
    assert_true(result.mean == 0 && result.percentile == 0 && result.largest == 0 && result.pop == 0);
    gw_flicker_finish(&flicker);
}

/* An edge that runs does not flicker where the reference's runs, too; without that it would: a column of each
 * row changes in every frame. The naive measure, change alone, cannot tell these. */
static void what_moves_with_the_reference_does_not_flicker(void **state) {
    gw_flicker together = {0}, alone = {0};
    (void)state;
    for (int frame = 0; frame < 10; ++frame) {
        add(&together, edge_at(10 + frame), edge_at(10 + frame));
        add(&alone, edge_at(10), edge_at(10 + frame));
    }
    assert_true(gw_flicker_of(&together).mean == 0);
    assert_true(gw_flicker_of(&alone).mean > 0.5 / WIDTH);
    gw_flicker_finish(&together);
    gw_flicker_finish(&alone);
}

/* Black has L* 0 and white 100: one pixel that blinks between them counts 1 in every frame but the first;
 * the mean is 1 / PIXELS, and its patch's mean jumps by 1 / 256. */
static void one_blinking_pixel_has_its_value(void **state) {
    gw_flicker flicker = {0};
    (void)state;
    for (int frame = 0; frame < 5; ++frame) {
        gw_image picture = filled(0);
        paint(&picture, 20 * WIDTH + 30, frame % 2 ? 255 : 0);
        add(&flicker, filled(0), picture);
    }
    gw_flicker_result result = gw_flicker_of(&flicker);
    assert_true(fabs(result.largest - 1) < 1e-6);
    assert_true(fabs(result.mean - 1.0 / PIXELS) < 1e-9);
    assert_true(fabs(result.pop - 1.0 / (GW_FLICKER_PATCH * GW_FLICKER_PATCH)) < 1e-9);
    assert_true(result.percentile == 0);
    gw_flicker_finish(&flicker);
}

/* Grey 119 has luminance 0.1845 and L* 50.03: a picture that blinks against black has that everywhere; two
 * rows of 48 are more than a hundredth of the pixels, so the 99th percentile is theirs. */
static void percentile_and_pop_are_of_what_is_rare(void **state) {
    gw_flicker all = {0}, rows = {0};
    (void)state;
    for (int frame = 0; frame < 2; ++frame) {
        gw_image picture = filled(0);
        for (size_t i = 0; frame && i < 2 * WIDTH; ++i)
            paint(&picture, i, 119);
        add(&rows, filled(0), picture);
        add(&all, filled(0), filled(frame ? 119 : 0));
    }
    gw_flicker_result of_all = gw_flicker_of(&all), of_rows = gw_flicker_of(&rows);
    assert_true(fabs(of_all.mean - 0.5003) < 1e-4 && fabs(of_all.pop - 0.5003) < 1e-4);
    assert_true(fabs(of_rows.percentile - 0.5003) < 1.0 / 1024);
    assert_true(fabs(of_rows.mean - 0.5003 * 2 / HEIGHT) < 1e-4);
    assert_true(fabs(of_rows.pop - 0.5003 * 2 / GW_FLICKER_PATCH) < 1e-4);
    gw_flicker_finish(&all);
    gw_flicker_finish(&rows);
}

/* What differs across a cut is no flicker. */
static void a_cut_is_no_change(void **state) {
    gw_flicker flicker = {0};
    (void)state;
    for (int shot = 0; shot < 3; ++shot) {
        gw_flicker_cut(&flicker);
        for (int frame = 0; frame < 2; ++frame)
            add(&flicker, filled(0), filled((uint8_t)(80 * shot)));
    }
    assert_true(gw_flicker_of(&flicker).mean == 0 && gw_flicker_of(&flicker).pop == 0);
    gw_flicker_finish(&flicker);
}

static void wrong_sequences_are_refused(void **state) {
    gw_flicker flicker = {0};
    gw_image a = filled(1), b = filled(1);
    (void)state;
    b.width /= 2;
    check_fails(gw_flicker_add(&flicker, &a, &b, &error), GW_BAD_INPUT, "cannot be compared");
    check_ok(gw_flicker_add(&flicker, &a, &a, &error));
    check_fails(gw_flicker_add(&flicker, &b, &b, &error), GW_BAD_INPUT, "a sequence has one size");
    gw_flicker_finish(&flicker);
    gw_image_finish(&a);
    gw_image_finish(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_still_error_does_not_flicker),
        cmocka_unit_test(what_moves_with_the_reference_does_not_flicker),
        cmocka_unit_test(one_blinking_pixel_has_its_value),
        cmocka_unit_test(percentile_and_pop_are_of_what_is_rare),
        cmocka_unit_test(a_cut_is_no_change),
        cmocka_unit_test(wrong_sequences_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
