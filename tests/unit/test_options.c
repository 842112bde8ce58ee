/* Values and command lines. (Messages of whole verbs: tests/cli/arguments.sh.) */
#include "tests/support/check.h"

#include "wall/options.h"
#include "wall/sim_options.h"

static void pairs(void **state) {
    (void)state;
    uint32_t pair[2];
    check_ok(gw_parse_pair("--size", "960x540", 32768, pair, &error));
    assert_int_equal(pair[0], 960);
    assert_int_equal(pair[1], 540);
    static const char *const bad[] = {
        "",       "x",    "10",    "10x", "x10",  "10x10x10", "10 x10",
        "10x 10", "+1x1", "1.5x2", "0x1", "-1x1", "32769x1",  "99999999999999999999x1",
        "0x10x1", "1e3x1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_fails(gw_parse_pair("--size", bad[i], 32768, pair, &error), GW_BAD_INPUT, "--size");
}

static void numbers(void **state) {
    (void)state;
    double three[3], one;
    check_ok(gw_parse_numbers("--eye", "-1,2.5e1,.5", 3, three, &error));
    assert_true(three[0] == -1 && three[1] == 25 && three[2] == 0.5);
    static const char *const bad[] = {"",     "1",       "1,2",     "1,2,3,4", "1,,3",
                                      "1,2,", "1,2,nan", "1,2,inf", "1,2,x",   "1, 2,3"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_fails(gw_parse_numbers("--eye", bad[i], 3, three, &error), GW_BAD_INPUT, "--eye");
    check_ok(gw_parse_number("--fov", "170", 1, 170, &one, &error));
    check_fails(gw_parse_number("--fov", "170.1", 1, 170, &one, &error), GW_BAD_INPUT, "1 to 170");
    int64_t whole;
    check_ok(gw_parse_integer("--seed", "4294967295", 0, UINT32_MAX, &whole, &error));
    assert_int_equal(whole, 4294967295);
    check_fails(gw_parse_integer("--seed", "1.0", 0, 9, &whole, &error), GW_BAD_INPUT, "not a whole number");
}

static void lists(void **state) {
    (void)state;
    uint32_t parts[4];
    size_t count;
    check_ok(gw_parse_integers("--columns", "500,200,324", 4, 32768, parts, &count, &error));
    assert_int_equal(count, 3);
    assert_int_equal(parts[2], 324);
    check_fails(gw_parse_integers("--columns", "1,2,3,4,5", 4, 9, parts, &count, &error), GW_BAD_INPUT,
                "more than 4");
    check_fails(gw_parse_integers("--columns", "1,,3", 4, 9, parts, &count, &error), GW_BAD_INPUT, "''");
    check_fails(gw_parse_integers("--columns", "1,10", 4, 9, parts, &count, &error), GW_BAD_INPUT, "'10'");
}

/* Words of a command line as main() gets them: writable. */
static gw_code parse(gw_sim_options *options, gw_error *error, const char *line) {
    static char text[512];
    char *argv[32];
    int argc = 0, helped = 0;
    snprintf(text, sizeof text, "sim %s", line);
    for (char *word = strtok(text, " "); word && argc < 31; word = strtok(NULL, " "))
        argv[argc++] = word;
    argv[argc] = NULL;
    memset(error, 0, sizeof *error);
    return gw_sim_options_parse(argc, argv, options, &helped, error);
}

static void a_command_line(void **state) {
    (void)state;
    gw_sim_options options;
    gw_error error;
    assert_int_equal(parse(&options, &error, ""), GW_OK);
    assert_int_equal(options.wall.tiles[0], 2);
    assert_null(options.draw.scene);
    assert_int_equal(options.gaze, GW_GAZE_FROM_TRACK);
    assert_int_equal(
        parse(&options, &error,
              "--tiles=3x1 --size 300x100 --scene a.obj --set tau=2 --tau 3 --set fan_rule=off --gaze 5,6 "
              "--frames 9 --step 0.5 --debug levels --seed 7 --time 2.5 --quiet --log debug"),
        GW_OK);
    assert_int_equal(options.wall.tiles[0], 3);
    assert_string_equal(options.draw.scene, "a.obj");
    assert_true(options.draw.settings.tau == 3); /* the last one holds */
    assert_int_equal(options.draw.settings.fan_rule, 0);
    assert_int_equal(options.gaze, GW_GAZE_AT_PIXEL);
    assert_true(options.gaze_pixel[1] == 6 && options.step == 0.5 && options.draw.time == 2.5);
    assert_int_equal(options.frames, 9);
    assert_int_equal(options.draw.debug, GW_DEBUG_LEVELS);
    assert_int_equal(options.draw.seed, 7);
    assert_true(options.draw.quiet && options.draw.level == GW_LOG_DEBUG);
}

static void wrong_command_lines(void **state) {
    (void)state;
    gw_sim_options options;
    gw_error error;
    assert_int_equal(parse(&options, &error, "--tile 3x1"), GW_BAD_INPUT);
    assert_non_null(strstr(error.text, "did you mean '--tiles'?"));
    assert_int_equal(parse(&options, &error, "--quiet=yes"), GW_BAD_INPUT);
    assert_int_equal(parse(&options, &error, "--frames"), GW_BAD_INPUT);
    assert_int_equal(parse(&options, &error, "-q"), GW_BAD_INPUT);
    assert_int_equal(parse(&options, &error, "picture.png"), GW_BAD_INPUT);
    assert_int_equal(parse(&options, &error, "-- picture.png"), GW_BAD_INPUT);
    assert_int_equal(parse(&options, &error, "--set nonsense=1"), GW_BAD_INPUT);
    /* A value may look like an option, and an error does not stick to the next command line. */
    assert_int_equal(parse(&options, &error, "--scene --odd-name"), GW_OK);
    assert_string_equal(options.draw.scene, "--odd-name");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pairs),
        cmocka_unit_test(numbers),
        cmocka_unit_test(lists),
        cmocka_unit_test(a_command_line),
        cmocka_unit_test(wrong_command_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
