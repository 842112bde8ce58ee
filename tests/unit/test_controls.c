/* Keys, buttons and pointer: what they ask for, and that nothing stays pressed when the window loses the
 * keys. */
#include "tests/support/check.h"

#include "wall/controls.h"

#include <math.h>

static void note(gw_controls *controls, gw_event_kind kind, int32_t key, double x, double y) {
    const gw_event event = {.kind = kind, .key = key, .position = {x, y}};
    gw_controls_note(controls, &event);
}

static void held_keys_move_until_they_are_released(void **state) {
    gw_controls c = {0};
    const gw_navigation_input nothing = gw_controls_take(&c);
    (void)state;
    assert_false(gw_navigation_is_asked(&nothing));
    note(&c, GW_EVENT_KEY_DOWN, 'W', 0, 0);
    note(&c, GW_EVENT_KEY_DOWN, GW_KEY_SHIFT, 0, 0);
    for (int i = 0; i < 2; i++) {
        const gw_navigation_input input = gw_controls_take(&c);
        assert_true(input.move[2] == 1 && input.move[0] == 0 && input.haste == 4);
    }
    note(&c, GW_EVENT_KEY_DOWN, 'S', 0, 0); /* both: stand */
    assert_true(gw_controls_take(&c).move[2] == 0);
    note(&c, GW_EVENT_KEY_UP, 'W', 0, 0);
    assert_true(gw_controls_take(&c).move[2] == -1);
    note(&c, GW_EVENT_BLUR, 0, 0, 0);
    assert_true(gw_controls_take(&c).move[2] == 0 && gw_controls_take(&c).haste == 1);
}

static void only_dragging_turns(void **state) {
    gw_controls c = {0};
    (void)state;
    note(&c, GW_EVENT_POINTER, 0, 0.5, 0.5);
    note(&c, GW_EVENT_POINTER, 0, 0.6, 0.5);
    assert_true(gw_controls_take(&c).turn[0] == 0);
    note(&c, GW_EVENT_BUTTON_DOWN, 1, 0, 0);
    note(&c, GW_EVENT_POINTER, 0, 0.7, 0.4);
    gw_navigation_input input = gw_controls_take(&c);
    assert_true(input.turn[0] > 0.1 && input.turn[1] > 0.1); /* right and up */
    assert_true(gw_controls_take(&c).turn[0] == 0);          /* once */
    note(&c, GW_EVENT_BUTTON_UP, 1, 0, 0);
    note(&c, GW_EVENT_POINTER, 0, 0.1, 0.1);
    assert_true(gw_controls_take(&c).turn[0] == 0);
    note(&c, GW_EVENT_BUTTON_DOWN, 0, 0, 0); /* the left one is not for turning */
    note(&c, GW_EVENT_POINTER, 0, 0.9, 0.1);
    assert_true(gw_controls_take(&c).turn[0] == 0);
    assert_true(c.pointer[0] == 0.9 && c.pointer_known);
}

static void presses_are_counted_once(void **state) {
    gw_controls c = {0};
    (void)state;
    note(&c, GW_EVENT_KEY_DOWN, 'B', 0, 0);
    note(&c, GW_EVENT_KEY_UP, 'B', 0, 0);
    note(&c, GW_EVENT_KEY_DOWN, 'B', 0, 0);
    assert_int_equal(gw_controls_pressed(&c, 'B'), 2);
    assert_int_equal(gw_controls_pressed(&c, 'B'), 0);
}

static void keys_that_nobody_knows_do_nothing(void **state) {
    gw_controls c = {0}, untouched = {0};
    const int32_t keys[] = {-1, 0, GW_KEY_END, 1 << 30, INT32_MIN};
    (void)state;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        note(&c, GW_EVENT_KEY_DOWN, keys[i], 0, 0);
        note(&c, GW_EVENT_KEY_UP, keys[i], 0, 0);
        if (keys[i])
            note(&c, GW_EVENT_BUTTON_DOWN, keys[i], 0, 0);
    }
    assert_memory_equal(&c, &untouched, sizeof c);
}

static void escape_and_the_window_close(void **state) {
    gw_controls a = {0}, b = {0};
    (void)state;
    note(&a, GW_EVENT_KEY_DOWN, GW_KEY_ESCAPE, 0, 0);
    note(&b, GW_EVENT_CLOSE, 0, 0, 0);
    assert_true(a.close && b.close);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(held_keys_move_until_they_are_released),
        cmocka_unit_test(only_dragging_turns),
        cmocka_unit_test(presses_are_counted_once),
        cmocka_unit_test(keys_that_nobody_knows_do_nothing),
        cmocka_unit_test(escape_and_the_window_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
