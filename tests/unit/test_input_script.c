/* Files of recorded input: what they mean, and that every wrong one is refused by file and line. */
#include "tests/support/check.h"

#include "tests/fuzz/input_script_entry.h"

static const char good[] = "# a tour\n"
                           "0 pointer 0.25 0.5\n"
                           "\n"
                           "3 press W   # ahead\n"
                           "3 press shift\r\n"
                           "9 release w\n"
                           "10 button right down\n"
                           "11 scroll -2\n"
                           "12 resize 800 600\n"
                           "99 press f1\n"
                           "99 close";

static void every_event(void **state) {
    gw_input_script s;
    (void)state;
    check_ok(gw_input_script_parse("tour", good, sizeof good - 1, &s, &error));
    assert_int_equal(s.count, 9);
    assert_true(s.events[0].event.kind == GW_EVENT_POINTER && s.events[0].event.position[0] == 0.25);
    assert_true(s.events[1].frame == 3 && s.events[1].event.kind == GW_EVENT_KEY_DOWN &&
                s.events[1].event.key == 'W');
    assert_int_equal(s.events[2].event.key, GW_KEY_SHIFT);
    assert_true(s.events[3].event.kind == GW_EVENT_KEY_UP && s.events[3].event.key == 'W');
    assert_true(s.events[4].event.kind == GW_EVENT_BUTTON_DOWN && s.events[4].event.key == 1);
    assert_true(s.events[5].event.kind == GW_EVENT_SCROLL && s.events[5].event.position[1] == -2);
    assert_true(s.events[6].resizes && s.events[6].event.position[1] == 600 && !s.events[5].resizes);
    assert_int_equal(s.events[7].event.key, GW_KEY_F1);
    assert_true(s.events[8].event.kind == GW_EVENT_CLOSE && s.events[8].frame == 99);
    gw_input_script_finish(&s);
    check_ok(gw_input_script_parse("empty", "", 0, &s, &error));
    assert_int_equal(s.count, 0);
}

static void wrong_lines_are_named(void **state) {
    static const struct {
        const char *text, *wanted;
    } cases[] = {
        {"0 pres W\n", "f:1: unknown event 'pres'; expected press"},
        {"0 wave\n", "f:1: unknown event 'wave'; expected press, release"},
        {"0\n", "f:1: unknown event ''"},
        {"\n\nx press W\n", "f:3: bad frame 'x'"},
        {"1.5 press W\n", "bad frame '1.5'"},
        {"-1 press W\n", "bad frame '-1'"},
        {"4294967296 press W\n", "bad frame"},
        {"5 press W\n4 release W\n",
         "f:2: bad frame '4'; expected a whole number, not below the line before"},
        {"0 press\n", "'press' takes 1 value, not 0"},
        {"0 pointer 0.5\n", "'pointer' takes 2 values, not 1"},
        {"0 close now\n", "'close' takes 0 values, not 1"},
        {"0 pointer 0.5 1.01\n", "bad number '1.01'; expected shares of the wall, 0 to 1"},
        {"0 pointer nan 0\n", "bad number 'nan'"},
        {"0 pointer 0x 0\n", "bad number '0x'"},
        {"0 press shft\n", "unknown key 'shft'; expected shift"},
        {"0 press \xc3\xa4\n", "unknown key"},
        {"0 button side down\n", "unknown button 'side'"},
        {"0 button left dwn\n", "bad state of a button 'dwn'; expected down or up"},
        {"0 resize 0 600\n", "bad number '0'; expected px, 1 to 16384"},
        {"0 scroll 1e9\n", "bad number '1e9'"},
        {"0 press W A S D E F\n", "more than 6 words"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        gw_input_script s;
        check_fails(gw_input_script_parse("f", cases[i].text, strlen(cases[i].text), &s, &error),
                    GW_BAD_INPUT, cases[i].wanted);
        assert_null(s.events);
    }
}

static void no_text_is_refused(void **state) {
    char line[300];
    gw_input_script s;
    (void)state;
    memset(line, '1', sizeof line);
    check_fails(gw_input_script_parse("f", line, sizeof line, &s, &error), GW_BAD_INPUT,
                "longer than 127 bytes");
    check_fails(gw_input_script_parse("f", "0 press W\n0 \0press W", 20, &s, &error), GW_BAD_INPUT, "f:2:");
    check_fails(gw_input_script_load("/nowhere/tour.txt", &s, &error), GW_BAD_INPUT, "/nowhere/tour.txt");
}

/* The entry of the fuzzer on mutations of a good file, in memory of exactly that size. */
static void mutations_break_nothing(void **state) {
    uint32_t random = 1;
    (void)state;
    for (int round = 0; round < 20000; round++) {
        size_t size = sizeof good - 1;
        uint8_t *exact = malloc(size);
        assert_non_null(exact);
        memcpy(exact, good, size);
        for (int change = 0; change < 1 + round % 4; change++) {
            random = random * 1664525u + 1013904223u;
            exact[random % size] = (uint8_t) "0 \n9.-#xWe\0"[random >> 16 & 7 ? (random >> 20) % 11 : 2];
        }
        fuzz_input_script(exact, size - random % 7);
        free(exact);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_event),
        cmocka_unit_test(wrong_lines_are_named),
        cmocka_unit_test(no_text_is_refused),
        cmocka_unit_test(mutations_break_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
