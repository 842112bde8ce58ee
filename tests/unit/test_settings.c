/* The table of settings: rows and fields agree, assignments are checked, texts round-trip, the page is
 * current. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/settings.h"
#include "base/settings_page.h"

static const gw_setting_row *find_row(const char *name) {
    for (size_t i = 0; i < gw_setting_count; i++) {
        if (strcmp(gw_setting_rows[i].name, name) == 0) {
            return &gw_setting_rows[i];
        }
    }
    fail_msg("no row '%s'", name);
    return NULL;
}

static void rows_are_complete_and_in_range(void **state) {
    (void)state;
    assert_true(gw_setting_count >= 15);
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        assert_true(row->name[0] && row->help[0] && row->trades[0] && row->reference[0]);
        assert_true(row->minimum < row->maximum);
        assert_true(row->initial >= row->minimum && row->initial <= row->maximum);
        assert_true(row->offset < sizeof(gw_settings));
        for (size_t j = 0; j < i; j++) {
            assert_string_not_equal(row->name, gw_setting_rows[j].name);
            assert_int_not_equal(row->offset, gw_setting_rows[j].offset);
        }
        if (row->kind == GW_SETTING_CHOICE) {
            int bars = 0;
            for (const char *c = row->choices; *c; c++) {
                bars += *c == '|';
            }
            assert_int_equal(bars, (int)row->maximum);
        } else {
            assert_true(!row->choices[0] ||
                        (row->kind == GW_SETTING_REAL && strcmp(row->choices, "auto") == 0));
        }
    }
}

static void defaults_reach_the_fields(void **state) {
    (void)state;
    gw_settings settings;
    memset(&settings, 0xab, sizeof settings);
    gw_settings_init(&settings);
    assert_int_equal(settings.octree_depth, (int)find_row("octree_depth")->initial);
    assert_true(settings.tau == find_row("tau")->initial);
    assert_int_equal(settings.geometry, GW_GEOMETRY_HYBRID);
    for (size_t i = 0; i < gw_setting_count; i++) {
        assert_true(gw_setting_value(&settings, &gw_setting_rows[i]) == gw_setting_rows[i].initial);
    }
}

/* Writing one row changes its field and no other. */
static void every_row_has_its_own_field(void **state) {
    (void)state;
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        gw_settings settings;
        gw_settings_init(&settings);
        double wanted = row->initial == row->maximum ? row->minimum : row->maximum;
        gw_settings other = settings;
        char assignment[160], text[64];
        if (row->kind == GW_SETTING_REAL) {
            memcpy((char *)&other + row->offset, &wanted, sizeof wanted);
        } else {
            int32_t whole = (int32_t)wanted;
            memcpy((char *)&other + row->offset, &whole, sizeof whole);
        }
        gw_setting_text(&other, row, text);
        snprintf(assignment, sizeof assignment, "%s=%s", row->name, text);
        check_ok(gw_settings_assign(&settings, assignment, &error));
        for (size_t j = 0; j < gw_setting_count; j++) {
            double expected = i == j ? wanted : gw_setting_rows[j].initial;
            assert_true(gw_setting_value(&settings, &gw_setting_rows[j]) == expected);
        }
    }
}

static void texts_read_back_as_the_same_value(void **state) {
    (void)state;
    static const double values[] = {0, 1, 0.022, 0.1, 1.0 / 3.0, 10, 12.5, 63.999999999999993};
    const gw_setting_row *row = find_row("tau");
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        gw_settings settings;
        gw_settings_init(&settings);
        settings.tau = values[i];
        char text[64], assignment[80];
        gw_setting_text(&settings, row, text);
        snprintf(assignment, sizeof assignment, "tau=%s", text);
        settings.tau = 7;
        check_ok(gw_settings_assign(&settings, assignment, &error));
        assert_true(settings.tau == values[i]);
    }
    gw_settings settings;
    gw_settings_init(&settings);
    char text[64];
    check_ok(gw_settings_assign(&settings, "exposure=auto", &error));
    assert_true(settings.exposure == GW_SETTING_AUTO);
    gw_setting_text(&settings, find_row("exposure"), text);
    assert_string_equal(text, "auto");
    settings.tau = 10;
    gw_setting_text(&settings, row, text);
    assert_string_equal(text, "10");
    gw_setting_text(&settings, find_row("geometry"), text);
    assert_string_equal(text, "hybrid");
    gw_setting_text(&settings, find_row("fan_rule"), text);
    assert_string_equal(text, "on");
}

static void bad_assignments_say_what_is_allowed(void **state) {
    (void)state;
    static const struct {
        const char *text, *message;
    } table[] = {
        {"tau", "expected name=value"},
        {"=1", "expected name=value"},
        {"", "expected name=value"},
        {"tua=1", "unknown setting 'tua'; did you mean 'tau'?"},
        {"octre_depth=3", "did you mean 'octree_depth'?"},
        {"brightness=3", "unknown setting 'brightness'; docs/settings.md"},
        {"tau=", "'' is not a number"},
        {"tau=abc", "'abc' is not a number"},
        {"tau=auto", "'auto' is not a number"},
        {"exposure=automatic", "'automatic' is not a number nor auto"},
        {"tau=1x", "'1x' is not a number"},
        {"tau=nan", "'nan' is not a number"},
        {"tau=inf", "'inf' is not a number"},
        {"tau=0x10", "'0x10' is not a number"},
        {"tau= 1", "' 1' is not a number"},
        {"tau=-1", "-1 is outside 0 to 64 footprints"},
        {"tau=65", "65 is outside 0 to 64 footprints"},
        {"tau=1e999", "1e999 is outside"},
        {"octree_depth=3.5", "'3.5' is not a whole number"},
        {"octree_depth=16", "16 is outside 1 to 15 levels"},
        {"fan_rule=2", "'2' is neither on nor off"},
        {"geometry=voxel", "'voxel' is not one of hybrid|triangles|voxels"},
        {"geometry=", "'' is not one of"},
        {"geometry=hybrid|triangles", "is not one of"},
    };
    gw_settings settings, untouched;
    gw_settings_init(&settings);
    untouched = settings;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        check_fails(gw_settings_assign(&settings, table[i].text, &error), GW_BAD_INPUT, table[i].message);
        assert_memory_equal(&settings, &untouched, sizeof settings);
    }
}

static void the_page_is_what_the_table_says(void **state) {
    (void)state;
    gw_bytes page;
    check_ok(gw_file_read("docs/settings.md", 1 << 20, &page, &error));
    char *wanted = gw_settings_page();
    assert_non_null(wanted);
    if (strcmp((const char *)page.data, wanted) != 0) {
        fail_msg("docs/settings.md is not what the table says; `make docs` writes it anew");
    }
    for (size_t i = 0; i < gw_setting_count; i++) {
        char cell[80];
        snprintf(cell, sizeof cell, "| `%s` |", gw_setting_rows[i].name);
        assert_non_null(strstr((const char *)page.data, cell));
    }
    free(wanted);
    gw_bytes_finish(&page);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_complete_and_in_range),
        cmocka_unit_test(defaults_reach_the_fields),
        cmocka_unit_test(every_row_has_its_own_field),
        cmocka_unit_test(texts_read_back_as_the_same_value),
        cmocka_unit_test(bad_assignments_say_what_is_allowed),
        cmocka_unit_test(the_page_is_what_the_table_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
