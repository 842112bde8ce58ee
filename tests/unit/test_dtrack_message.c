/* DTrack's datagrams: the vectors of the vendor's manual, both ways, and senders that break every rule. */
#include "tests/support/check.h"

#include "tests/fuzz/dtrack_entry.h"
#include "tests/support/mangle.h"
#include "tracking/decimal.h"

#include <locale.h>
#include <math.h>

#define BODY                                                                                                 \
    "[0 1.000][326.848 -187.216 109.503 -160.4704 -3.6963 -7.0913][-0.940508 -0.339238 -0.019025 "           \
    "0.333599 -0.932599 0.137735 -0.064467 0.123194 0.990286]"
#define FLYSTICK                                                                                             \
    "[0 1.000 2][261.103 116.520 41.085 19.6522 -57.3530 116.5992][-0.241543 0.968868 -0.054332 "            \
    "-0.482366 -0.168461 -0.859619 -0.842010 -0.181427 0.508039]"
#define PLAIN "[1.0 2.0 3.0][1 0 0 0 1 0 0 0 1]"

static gw_dtrack_frame frame;

static int read_text(const char *text) {
    return gw_dtrack_read((const uint8_t *)text, strlen(text), &frame);
}

static void near(const double *got, const double *wanted, int count, double within) {
    for (int i = 0; i < count; i++)
        if (!(fabs(got[i] - wanted[i]) <= within))
            fail_msg("number %d is %.9g, wanted %.9g", i, got[i], wanted[i]);
}

static void the_manual_s_vectors_are_read(void **state) {
    (void)state;
    assert_true(
        read_text("fr 21753\r\nts 39596.024831\r\n6dcal 3\r\n6d 1 " BODY "\r\n6df 1 " FLYSTICK "\r\n"));
    assert_true(frame.has_frame && frame.frame == 21753 && frame.has_day_time);
    assert_true(frame.day_time == INT64_C(39596024831000));
    assert_int_equal(frame.calibrated, 2); /* the old Flystick was counted in */
    assert_true(frame.has_bodies && frame.body_count == 1 && frame.bodies[0].tracked);
    near(frame.bodies[0].position, (const double[]){326.848, -187.216, 109.503}, 3, 0);
    near(frame.bodies[0].orientation, (const double[]){0.021239, -0.066376, -0.982776, 0.171157}, 4, 1e-6);
    assert_int_equal(frame.flystick_count, 1);
    assert_true(frame.flysticks[0].pose.tracked && frame.flysticks[0].buttons == 2);
    near(frame.flysticks[0].pose.orientation, (const double[]){-0.323605, -0.375847, 0.692467, 0.523936}, 4,
         1e-6);
    assert_true(frame.malformed == 0 && frame.not_finite == 0 && frame.lines_unknown == 0);
}

/* What is written, angles and all, is what the manual's Flystick shows; its body's angles are another
 * order's.
 */
static void what_is_written_is_the_manual_s_line(void **state) {
    (void)state;
    char text[4096];
    assert_true(read_text("fr 21753\r\nts 39596.024831\r\n6dcal 1\r\n6d 1 [0 1.000]" /* its pose as a body */
                          "[261.103 116.520 41.085 19.6522 -57.3530 116.5992][-0.241543 0.968868 -0.054332 "
                          "-0.482366 -0.168461 -0.859619 -0.842010 -0.181427 0.508039]\r\n"));
    const size_t size = gw_dtrack_write(&frame, text, sizeof text - 1);
    assert_true(size > 0);
    text[size] = '\0';
    /* The last digit of the manual's numbers is rounded before the quaternion is made of them. */
    static const char start[] =
        "fr 21753\r\nts 39596.024831\r\n6dcal 1\r\n6d 1 [0 1.000][261.103 116.520 41.085 19.652";
    assert_memory_equal(text, start, sizeof start - 1);
    const gw_dtrack_pose wanted = frame.bodies[0];
    assert_true(gw_dtrack_read((const uint8_t *)text, size, &frame));
    near(frame.bodies[0].position, wanted.position, 3, 0);
    near(frame.bodies[0].orientation, wanted.orientation, 4, 1e-6);
    const char *angles = strstr(text, "41.085 ");
    double written[3];
    assert_int_equal(sscanf(angles, "41.085 %lf %lf %lf]", &written[0], &written[1], &written[2]), 3);
    near(written, (const double[]){19.6522, -57.3530, 116.5992}, 3, 2e-4);
}

static void flysticks_and_hybrids(void **state) {
    (void)state;
    assert_true(read_text("fr 5\r\nts2 1700000000 250000 4000\r\n6dcal 2\r\n"
                          "6di 2 [0 2 0.00]" PLAIN " [1 0 3.5]" PLAIN "\r\n"
                          "6df2 2 2 [0 1.000 6 2]" PLAIN "[37 0.50 -1.00] "
                          "[1 -1.000 4 2][0 0 0][0 0 0 0 0 0 0 0 0][1 0.00 0.25]\r\n"));
    assert_true(frame.has_unix_time && frame.unix_time == INT64_C(1700000000250000000));
    assert_true(frame.latency == 4000000 && frame.calibrated == 2 && frame.body_count == 2);
    assert_true(frame.bodies[0].tracked && frame.bodies[1].listed && !frame.bodies[1].tracked);
    const gw_dtrack_flystick *f = frame.flysticks;
    assert_true(f[0].pose.tracked && f[0].button_count == 6 && f[0].buttons == 37 && f[0].axis_count == 2);
    assert_true(f[0].axes[0] == 0.5 && f[0].axes[1] == -1);
    assert_true(!f[1].pose.tracked && f[1].pose.listed && f[1].buttons == 1 && f[1].axes[1] == 0.25);
    assert_int_equal(frame.malformed, 0);
    assert_true(read_text("fr 6\r\n6df 1 [0 1.0 97]" PLAIN "\r\n")); /* the hat to the left and up */
    assert_true(f[0].buttons == 97 && f[0].axis_count == 2 && f[0].axes[0] == -1 && f[0].axes[1] == 1);
}

static void hostile_datagrams(void **state) {
    (void)state;
    static const struct {
        const char *text;
        uint32_t malformed, not_finite;
        int tracked;
    } rows[] = {
        {"fr 1\r\n6d 0 \r\n", 0, 0, 0},
        {"fr 1\r\n6d 1 [0 1.000][1 2 3][0 0 0 0 0 0 0 0 0]\r\n", 0, 0, 0}, /* not tracked */
        {"fr 1\r\n6d 1 [0 -1.000]" PLAIN "\r\n", 0, 0, 0},
        {"6d 1 [0 1.000]" PLAIN "\r\n", 0, 0, 1},          /* without fr */
        {"fr 1\r\n6d 1 [64 1.000]" PLAIN "\r\n", 1, 0, 0}, /* beyond the table */
        {"fr 1\r\n6d 1 [0.5 1.000]" PLAIN "\r\n", 1, 0, 0},
        {"fr 1\r\n6d 1 [-1 1.000]" PLAIN "\r\n", 1, 0, 0},
        {"fr 1\r\n6d 3 [0 1.0]" PLAIN " [1 1.0]" PLAIN "\r\n", 1, 0, 2}, /* says three, has two */
        {"fr 1\r\n6d 4294967295 [0 1.0]" PLAIN "\r\n", 1, 0, 1},
        {"fr 1\r\n6d -1 [0 1.0]" PLAIN "\r\n", 1, 0, 0},
        {"fr 1\r\n6d 1 [0 1,0]" PLAIN "\r\n", 1, 0, 0}, /* a comma */
        {"fr 1\r\n6d 1 [0 1.0][1,5 2 3][1 0 0 0 1 0 0 0 1]\r\n", 1, 0, 0},
        {"fr 1\n6d 1 [0 1.0]" PLAIN "\n", 0, 0, 1},                                    /* no CR */
        {"fr 1\r\n6d 1 [0 1.0]" PLAIN "[9 9][7]\r\n", 0, 0, 1},                        /* more blocks */
        {"fr 1\r\n6d 1 [0 1.0 7 8][1 2 3 4 5 6 7][1 0 0 0 1 0 0 0 1 5]\r\n", 0, 0, 1}, /* more numbers */
        {"fr 1\r\n6d 1 [0 1.0][1 2][1 0 0 0 1 0 0 0 1]\r\n", 1, 0, 0},
        {"fr 1\r\n6d 1 [0 1.0][1 2 3][1 0 0 0 1 0 0 0]\r\n", 1, 0, 0},
        {"fr 1\r\n6d 1 [0 1.0][1 2 3][1 0 0 0 1 0 0 0 -1]\r\n", 0, 1, 0}, /* a mirror */
        {"fr 1\r\n6d 1 [0 1.0][1 2 3][2 0 0 0 2 0 0 0 2]\r\n", 0, 1, 0},
        {"fr 1\r\n6d 1 [0 1.0][1e300 2 3][1 0 0 0 1 0 0 0 1]\r\n", 0, 1, 0},
        {"fr 1\r\n6d 1 [0 1.0][nan 2 3][1 0 0 0 1 0 0 0 1]\r\n", 1, 0, 0},
        {"fr -1\r\n6d 1 [0 1.0]" PLAIN "\r\n", 1, 0, 1},
        {"fr 1 \r\n6d 1 [0 1.0]" PLAIN, 0, 0, 1}, /* the last line has no end */
        {"fr 1\r\n6df2 1 1 [0 1.000 200 0]" PLAIN "[1]\r\n", 1, 0, 0},
        {"fr 1\r\n6df2 1 1 [0 1.000 8 2]" PLAIN "[1 0.5]\r\n", 1, 0, 0}, /* two axes, but one is there */
        {"fr 1\r\nts 90000\r\n", 1, 0, 0},
        {"fr 1\r\nts2 1 -5 0\r\n", 1, 0, 0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        read_text(rows[i].text);
        int tracked = 0;
        for (int k = 0; k < GW_DTRACK_BODIES; k++)
            tracked += frame.bodies[k].tracked;
        if (frame.malformed != rows[i].malformed || frame.not_finite != rows[i].not_finite ||
            tracked != rows[i].tracked)
            fail_msg("row %zu: malformed %u, not finite %u, tracked %d", i, frame.malformed, frame.not_finite,
                     tracked);
    }
    static const char zero_inside[] = "fr 7\0\r\n6d 1 [0 1.0]" PLAIN "\r\n";
    gw_dtrack_read((const uint8_t *)zero_inside, sizeof zero_inside, &frame);
    assert_true(frame.malformed == 1 && frame.bodies[0].tracked);
    assert_false(read_text("SSH-2.0-OpenSSH_9.2p1\r\n"));
    assert_false(read_text(""));
}

static void midnight(void **state) {
    (void)state;
    const int64_t second = 1000000000, day = 86400 * second, midnight = 19000 * day;
    /* Sent before midnight and here after it, and the other way round. */
    assert_true(gw_dtrack_unix_time(day - second, midnight + second) == midnight - second);
    assert_true(gw_dtrack_unix_time(second, midnight - second) == midnight + second);
    assert_true(gw_dtrack_unix_time(12345, midnight + 5) == midnight + 12345);
}

static void decimals(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double value;
        int read;
    } rows[] = {{"12.5", 12.5, 4}, {"-0.001", -0.001, 6}, {"+3", 3, 2},  {".5", 0.5, 2}, {"5.", 5, 2},
                {"1e3", 1000, 3},  {"1e", 1, 1},          {"1,5", 1, 1}, {"", 0, 0},     {"-", 0, 0},
                {".", 0, 0},       {"nan", 0, 0},         {"inf", 0, 0}, {"0x10", 0, 1}, {"2e-2", 0.02, 4},
                {"-1e-400", 0, 7}, {"1e999", INFINITY, 5}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const char *at = rows[i].text;
        double value = 0;
        const int read = gw_decimal_read(&at, rows[i].text + strlen(rows[i].text), &value);
        assert_int_equal(read, rows[i].read > 0);
        assert_int_equal(at - rows[i].text, rows[i].read);
        assert_true(value == rows[i].value);
    }
    char text[32];
    assert_int_equal(gw_decimal_write(-0.0004, 3, text), 5);
    assert_string_equal(text, "0.000");
    gw_decimal_write(-187.2155, 3, text);
    assert_string_equal(text, "-187.216");
    gw_decimal_write(7, 0, text);
    assert_string_equal(text, "7");
}

/* A German locale has a comma; where it is not installed the test still reads dots. */
static void the_locale_does_not_matter(void **state) {
    (void)state;
    char *before = strdup(setlocale(LC_ALL, NULL));
    if (!setlocale(LC_ALL, "de_DE.UTF-8"))
        print_message("# no German locale here\n");
    the_manual_s_vectors_are_read(NULL);
    what_is_written_is_the_manual_s_line(NULL);
    setlocale(LC_ALL, before);
    free(before);
}

static void mangled_datagrams_never_break_the_reader(void **state) {
    (void)state;
    static const char good[] =
        "fr 1\r\nts 5.5\r\n6dcal 2\r\n6d 1 " BODY "\r\n6df2 1 1 [0 1.0 4 2]" PLAIN "[3 0.5 1]\r\n";
    mangle(fuzz_dtrack, (const uint8_t *)good, sizeof good - 1, 1000);
    uint8_t *long_one = malloc(40000);
    assert_non_null(long_one);
    memset(long_one, '[', 40000);
    fuzz_dtrack(long_one, 40000);
    memset(long_one, '9', 40000);
    fuzz_dtrack(long_one, 40000);
    free(long_one);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_manual_s_vectors_are_read),
        cmocka_unit_test(what_is_written_is_the_manual_s_line),
        cmocka_unit_test(flysticks_and_hybrids),
        cmocka_unit_test(hostile_datagrams),
        cmocka_unit_test(midnight),
        cmocka_unit_test(decimals),
        cmocka_unit_test(the_locale_does_not_matter),
        cmocka_unit_test(mangled_datagrams_never_break_the_reader),
    };
    return cmocka_run_group_tests_name("dtrack_message", tests, NULL, NULL);
}
