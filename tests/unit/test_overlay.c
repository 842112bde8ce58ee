/* The overlay: bars are as high as their times, the newest at the right; what was missed is told; small tiles
 * are safe; what lies outside it stays as it is. */
#include "tests/support/check.h"

#include "wall/overlay.h"

static gw_image grey(uint32_t width, uint32_t height) {
    gw_image image;
    gw_error error = {0};
    assert_int_equal(gw_image_create(width, height, &image, &error), GW_OK);
    memset(image.rgba, 100, (size_t)width * height * 4);
    return image;
}

static const gw_overlay_text someone = {
    .tile = "c0r0", .host = "node7", .rank = 3, .frame = 41, .rays_per_second = 2e6, .pose_age = 0.012};

/* px of a colour in a column. */
static uint32_t count_color(const gw_image *image, uint32_t column, const uint8_t color[3]) {
    uint32_t count = 0;
    for (uint32_t y = 0; y < image->height; y++)
        count += !memcmp(image->rgba + ((size_t)y * image->width + column) * 4, color, 3);
    return count;
}

static const uint8_t trace_color[3] = {86, 180, 233}, gate_color[3] = {230, 159, 0};

/* The rightmost column that shows a colour; -1: none. */
static int64_t last_column(const gw_image *image, const uint8_t color[3], uint32_t *most) {
    int64_t last = -1;
    *most = 0;
    for (uint32_t x = image->width / 4; x < image->width; x++) {
        const uint32_t count = count_color(image, x, color);
        last = count ? (int64_t)x : last;
        *most = count > *most ? count : *most;
    }
    return last;
}

static void bars_are_as_high_as_their_times(void **state) {
    (void)state;
    gw_image image = grey(960, 540);
    gw_lanes lanes = {0};
    gw_lanes_note(&lanes, (const float[GW_LANES]){0, 9000, 0, 0, 0}); /* kernels are compiled: left out */
    gw_lanes_note(&lanes, (const float[GW_LANES]){0, 40, 0, 0, 0});
    gw_lanes_note(&lanes, (const float[GW_LANES]){0, 20, 0, 30, 0});
    gw_overlay_draw(&image, &lanes, &someone);
    uint32_t trace, gate;
    const int64_t trace_end = last_column(&image, trace_color, &trace),
                  gate_end = last_column(&image, gate_color, &gate);
    assert_true(trace_end > 0 && trace_end == gate_end); /* the newest has both */
    const double newest = count_color(&image, (uint32_t)trace_end, trace_color);
    assert_true(newest > 5);
    assert_true(trace >= 2 * newest - 1 && trace <= 2 * newest + 1); /* the one before: 40 ms */
    assert_true(gate >= 1.5 * newest - 1 && gate <= 1.5 * newest + 1);
    gw_image_finish(&image);
}

/* A ring: the oldest go, and nothing is read beyond what was noted. */
static void old_frames_go(void **state) {
    (void)state;
    gw_image image = grey(960, 540), fresh = grey(960, 540);
    gw_lanes lanes = {0}, young = {0};
    for (uint32_t i = 0; i < 3 * GW_OVERLAY_FRAMES; i++)
        gw_lanes_note(&lanes, (const float[GW_LANES]){0, i < GW_OVERLAY_FRAMES ? 400.0f : 10.0f, 0, 0, 0});
    for (uint32_t i = 0; i <= GW_OVERLAY_FRAMES; i++)
        gw_lanes_note(&young, (const float[GW_LANES]){0, 10, 0, 0, 0});
    gw_overlay_draw(&image, &lanes, &someone);
    gw_overlay_draw(&fresh, &young, &someone);
    assert_memory_equal(image.rgba, fresh.rgba, (size_t)960 * 540 * 4);
    gw_image_finish(&image);
    gw_image_finish(&fresh);
}

/* The way from motion to photons has lines of its own, in which nothing stands when nobody is tracked. */
static void latency_is_told(void **state) {
    (void)state;
    gw_lanes lanes = {0};
    gw_image nobody = grey(960, 540), one = grey(960, 540), other = grey(960, 540);
    gw_overlay_text tracked = someone;
    tracked.latency = (gw_latency){1, {3, 0, 8, 40, 24, 8}, 20};
    gw_overlay_draw(&nobody, &lanes, &someone);
    gw_overlay_draw(&one, &lanes, &tracked);
    tracked.latency.ms[GW_LATENCY_WAIT] = 17;
    gw_overlay_draw(&other, &lanes, &tracked);
    const size_t bytes = (size_t)960 * 540 * 4;
    assert_memory_not_equal(nobody.rgba, one.rgba, bytes);
    assert_memory_not_equal(one.rgba, other.rgba, bytes);
    assert_true(gw_latency_total(&tracked.latency) == 92);
    gw_image_finish(&nobody);
    gw_image_finish(&one);
    gw_image_finish(&other);
}

static void what_was_missed_is_told(void **state) {
    (void)state;
    gw_lanes lanes = {0};
    gw_image good = grey(480, 270), bad = grey(480, 270);
    gw_overlay_text missed = someone;
    missed.late = 2;
    gw_overlay_draw(&good, &lanes, &someone);
    gw_overlay_draw(&bad, &lanes, &missed);
    const uint8_t alarm_color[3] = {255, 96, 72};
    uint32_t seen[2] = {0, 0};
    for (uint32_t x = 0; x < 480; x++) {
        seen[0] += count_color(&good, x, alarm_color);
        seen[1] += count_color(&bad, x, alarm_color);
    }
    assert_int_equal(seen[0], 0);
    assert_true(seen[1] > 20);
    /* The far corner is the picture's own. */
    assert_int_equal(good.rgba[(480 * 270 - 1) * 4], 100);
    gw_image_finish(&good);
    gw_image_finish(&bad);
}

static void any_size_is_safe(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {2, 900}, {900, 2}, {37, 41}, {3840, 2160}};
    gw_lanes lanes = {0};
    gw_lanes_note(&lanes, (const float[GW_LANES]){1e9f, -5, 0, 3, 1e-9f});
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        gw_image image = grey(sizes[i][0], sizes[i][1]);
        gw_overlay_draw(&image, &lanes, &someone);
        gw_image_finish(&image);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bars_are_as_high_as_their_times),
        cmocka_unit_test(old_frames_go),
        cmocka_unit_test(what_was_missed_is_told),
        cmocka_unit_test(latency_is_told),
        cmocka_unit_test(any_size_is_safe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
