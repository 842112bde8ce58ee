/* The registry of knobs: every setting is one, with values to try; and what of the frame state no setting
 * holds is known by name, so that nothing that changes pixels escapes both tables. */
#include "tests/support/check.h"

#include "base/knobs.h"
#include "render/frame_state.h"

#include <math.h>
#include <stddef.h>

static void every_setting_is_a_knob(void **state) {
    (void)state;
    check_ok(gw_knobs_check(gw_setting_rows, gw_setting_count, &error));
    assert_int_equal(gw_knob_count, gw_setting_count);
}

/* A planted setting that nobody registered, and a knob whose setting is gone. */
static void what_is_not_registered_is_named(void **state) {
    (void)state;
    gw_setting_row *rows = calloc(gw_setting_count + 1, sizeof *rows);
    assert_non_null(rows);
    memcpy(rows, gw_setting_rows, gw_setting_count * sizeof *rows);
    rows[gw_setting_count] = rows[0];
    rows[gw_setting_count].name = "planted";
    check_fails(gw_knobs_check(rows, gw_setting_count + 1, &error), GW_BAD_INPUT,
                "the setting 'planted' is no knob");
    check_fails(gw_knobs_check(rows + 1, gw_setting_count - 1, &error), GW_BAD_INPUT,
                "there is no setting 'outlier_extents'");
    free(rows);
}

static void sweeps_hold_the_default(void **state) {
    (void)state;
    gw_settings defaults;
    gw_settings_init(&defaults);
    for (size_t i = 0; i < gw_knob_count; i++) {
        char values[GW_KNOB_VALUES][GW_KNOB_TEXT], initial[64];
        const size_t count = gw_knob_values(&gw_knobs[i], values);
        int found = 0;
        gw_setting_text(&defaults, gw_knob_setting(&gw_knobs[i]), initial);
        for (size_t k = 0; k < count; k++) {
            char assignment[160];
            gw_settings settings;
            gw_settings_init(&settings);
            snprintf(assignment, sizeof assignment, "%s=%s", gw_knobs[i].name, values[k]);
            check_ok(gw_settings_assign(&settings, assignment, &error));
            found += !strcmp(values[k], initial);
        }
        assert_int_equal(found, 1);
    }
}

static void a_sweep_is_made_from_the_default(void **state) {
    (void)state;
    char values[GW_KNOB_VALUES][GW_KNOB_TEXT];
    static const char *const wanted[] = {"8", "16", "32", "64", "128"};
    assert_int_equal(gw_knob_values(gw_knob_find("fan_cap"), values), 5);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(values[i], wanted[i]);
    assert_int_equal(gw_knob_values(gw_knob_find("edge_depth"), values), 4); /* 2 is 1, the most */
    assert_int_equal(gw_knob_values(gw_knob_find("geometry"), values), 3);
    assert_null(gw_knob_find("brightness"));
}

/* Bytes of the frame state that a setting of frames can change. */
static void mark_settings(uint8_t *known) {
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        const double values[] = {row->minimum, row->initial, row->maximum,
                                 row->choices[0] && row->kind == GW_SETTING_REAL ? GW_SETTING_AUTO
                                                                                 : row->initial};
        for (size_t k = 0; k < sizeof values / sizeof values[0] && row->stage == GW_SETTING_FRAME; k++) {
            gw_settings settings;
            gw_frame_state before = {0}, after = {0};
            gw_settings_init(&settings);
            gw_frame_state_apply(&before, &settings);
            gw_setting_store(&settings, row, values[k]);
            gw_frame_state_apply(&after, &settings);
            for (size_t b = 0; b < sizeof before; b++)
                known[b] |= ((const uint8_t *)&before)[b] != ((const uint8_t *)&after)[b];
        }
    }
}

/* What a frame depends on and no knob is: who looks from where at what, and names of frames. Another field
 * that is no setting of frames fails here: make it one, or say here why it is none. */
static void the_frame_state_has_no_other_knob(void **state) {
    (void)state;
#define FIELD(name)                                                                                          \
    { #name, offsetof(gw_frame_state, name), sizeof(((gw_frame_state *)0)->name) }
    static const struct {
        const char *name;
        size_t offset, size;
    } others[] = {FIELD(frame),   FIELD(gaze_count), FIELD(time),       FIELD(eye),   FIELD(gazes),
                  FIELD(debug),   FIELD(seed),       FIELD(reserved),   FIELD(epoch), FIELD(stand),
                  FIELD(look_at), FIELD(eye_offset), FIELD(scene_scale)};
#undef FIELD
    uint8_t known[sizeof(gw_frame_state)] = {0};
    mark_settings(known);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        memset(known + others[i].offset, 1, others[i].size);
    /* Numbers need not use all of their bytes: a field is known when one of them is. */
    for (size_t b = 0; b < sizeof known; b += 4)
        if (!known[b] && !known[b + 1] && !known[b + 2] && !known[b + 3])
            fail_msg("the 4 bytes at offset %zu of gw_frame_state are no setting of frames and not listed "
                     "here as anything else",
                     b);
    static const size_t bytes[][2] = {
        {offsetof(gw_frame_state, geometry), offsetof(gw_frame_state, seed)},
        {offsetof(gw_frame_state, environment_lights), offsetof(gw_frame_state, epoch)},
        {offsetof(gw_frame_state, near_light), offsetof(gw_frame_state, strain)},
        {offsetof(gw_frame_state, tone), offsetof(gw_frame_state, occlusion_distance)},
        {offsetof(gw_frame_state, diffuse_bounce), sizeof(gw_frame_state)},
    };
    for (size_t i = 0; i < sizeof bytes / sizeof bytes[0]; i++)
        for (size_t b = bytes[i][0]; b < bytes[i][1]; b++)
            if (!known[b])
                fail_msg(
                    "the byte at offset %zu of gw_frame_state is no setting of frames and not listed here",
                    b);
}

static void knobs_elsewhere_are_described(void **state) {
    (void)state;
    assert_true(gw_knob_elsewhere_count >= 4);
    for (size_t i = 0; i < gw_knob_elsewhere_count; i++) {
        const gw_knob_elsewhere *knob = &gw_knobs_elsewhere[i];
        assert_true(knob->name[0] && knob->initial[0] && knob->range[0] && knob->trades[0] &&
                    knob->reference[0] && knob->where[0] && knob->measured[0]);
        assert_null(gw_knob_find(knob->name));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_setting_is_a_knob),
        cmocka_unit_test(what_is_not_registered_is_named),
        cmocka_unit_test(sweeps_hold_the_default),
        cmocka_unit_test(a_sweep_is_made_from_the_default),
        cmocka_unit_test(the_frame_state_has_no_other_knob),
        cmocka_unit_test(knobs_elsewhere_are_described),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
