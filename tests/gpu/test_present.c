/* The panel's correction: what the kernel makes of every code is what the formulas say, and a panel that asks
 * for nothing gets its picture untouched, without a kernel. */
#include "tests/support/device.h"

#include "wall/panel_correction.h"
#include "wall/present.h"

#include <math.h>

/* Every code of the three channels, in different orders, so that channels cannot be mixed up. */
static void make_codes(uint8_t rgba[256 * 4]) {
    for (int i = 0; i < 256; i++) {
        rgba[4 * i] = (uint8_t)i;
        rgba[4 * i + 1] = (uint8_t)(255 - i);
        rgba[4 * i + 2] = (uint8_t)(i ^ 0x55);
        rgba[4 * i + 3] = 255;
    }
}

static void correct(const gw_panel *panel, const uint8_t *codes, uint8_t *out) {
    const uint32_t size[2] = {64, 4};
    gw_present_image picture = {0};
    gw_panel_correction correction;
    const gw_present_image *shown = NULL;
    check_ok(gw_present_image_create(size, &picture, &error));
    gw_present_image_write(&picture, codes);
    check_ok(gw_panel_correction_create(device, panel, size, &correction, &error));
    assert_int_equal(correction.program != 0, gw_panel_is_corrected(panel));
    check_ok(gw_panel_correction_apply(device, &correction, &picture, &shown, &error));
    assert_int_equal(shown == &picture, !gw_panel_is_corrected(panel));
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glGetTextureImage(shown->texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, 256 * 4, out);
    check_ok(gw_gl_check("reading", &error));
    gw_panel_correction_finish(&correction);
    gw_present_image_finish(&picture);
}

static gw_panel panel_of(double gamma, double red, double green, double blue, double brightness) {
    return (gw_panel){.gamma = gamma, .white = {red, green, blue}, .brightness = brightness};
}

static void every_code_is_the_formulas(void **state) {
    const gw_panel panels[] = {panel_of(2.2, 1, 1, 1, 1), panel_of(1, 1, 1, 1, 1),
                               panel_of(0, 1, 0.97, 0.9, 0.8), panel_of(2.4, 0.5, 1, 0.25, 0.9),
                               panel_of(4, 0.1, 0.1, 1, 0.1)};
    uint8_t codes[256 * 4], got[256 * 4];
    (void)state;
    make_codes(codes);
    for (size_t p = 0; p < sizeof panels / sizeof panels[0]; p++) {
        correct(&panels[p], codes, got);
        for (int i = 0; i < 256 * 4; i++) {
            const double wanted = i % 4 < 3 ? gw_panel_code(&panels[p], i % 4, codes[i]) : 255;
            /* Half a code of rounding, and what pow() of a GPU may be off. */
            if (fabs(got[i] - wanted) > 0.52)
                fail_msg("panel %zu, channel %d, code %d: %d, wanted %.3f", p, i % 4, codes[i], got[i],
                         wanted);
        }
    }
}

static void nothing_asked_nothing_done(void **state) {
    const gw_panel panel = panel_of(0, 1, 1, 1, 1);
    uint8_t codes[256 * 4], got[256 * 4];
    (void)state;
    make_codes(codes);
    correct(&panel, codes, got);
    assert_memory_equal(codes, got, sizeof codes);
}

/* Numbers from outside this code: half the light of white is sRGB code 187.5; a panel of gamma 2 wants the
 * code 255 / sqrt(2) = 180.3 for it; a quarter of it code 127.5. */
static void known_numbers(void **state) {
    gw_panel half = panel_of(0, 1, 1, 1, 0.5), two = panel_of(2, 0.5, 0.25, 1, 1);
    (void)state;
    assert_true(fabs(gw_panel_code(&half, 1, 255) - 187.516) < 0.01);
    assert_true(fabs(gw_panel_code(&two, 0, 255) - 180.312) < 0.01);
    assert_true(fabs(gw_panel_code(&two, 1, 255) - 127.5) < 0.01);
    assert_true(fabs(gw_panel_code(&two, 2, 255) - 255) < 1e-9 && gw_panel_code(&two, 2, 0) == 0);
}

/* The twin of a headless tile takes every call. */
static void a_headless_tile_shows_nothing(void **state) {
    const gw_panel panel = panel_of(2.2, 1, 1, 1, 1);
    const uint8_t pixel[4] = {1, 2, 3, 255};
    gw_present *present = NULL;
    (void)state;
    check_ok(gw_present_open(device, &panel, 1, 1, &present, &error));
    assert_false(gw_present_is_seen(present));
    check_ok(gw_present_stage(present, pixel, &error));
    check_ok(gw_present_take_panel(present, &panel, &error));
    check_ok(gw_present_take_panel(NULL, &panel, &error));
    assert_true(gw_present_show(present) > 0);
    gw_present_close(&present);
    assert_null(present);
    assert_true(gw_present_show(NULL) > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_is_the_formulas),
        cmocka_unit_test(nothing_asked_nothing_done),
        cmocka_unit_test(known_numbers),
        cmocka_unit_test(a_headless_tile_shows_nothing),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
