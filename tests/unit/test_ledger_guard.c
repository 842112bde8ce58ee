/* The guard of recorded work and errors is itself tested: what is planted in one knob is found in that one.
 */
#include "tests/support/check.h"

#include "base/file.h"
#include "tests/support/ledger_guard.h"

#include <math.h>

static char text[GW_GUARD_TEXT];

/* Two knobs of four values: work halves, the error doubles. */
static gw_guard_table made(void) {
    gw_guard_table table = {0};
    for (int k = 0; k < 2; k++)
        for (int v = 0; v < 4; v++) {
            const uint64_t work = 80000u >> v;
            const gw_counters c = {
                .rays = work / 8, .steps = work, .node_loads = work, .triangle_tests = work / 2};
            gw_metrics errors;
            gw_metrics_clear(&errors);
            errors.values[GW_METRIC_FLIP] = 0.01 * (1 << v);
            errors.values[GW_METRIC_PSNR] = 40 - 3 * v;
            errors.values[GW_METRIC_BIAS] = -0.004;
            table.rows[table.count++] = gw_guard_row_of(k ? "tau" : "slope", v, &c, &errors);
        }
    return table;
}

static void equal_tables_pass(void **state) {
    const gw_guard_table table = made();
    gw_guard_table near = table;
    (void)state;
    for (size_t r = 0; r < near.count; r++)
        for (int i = 0; i < GW_GUARD_NUMBERS; i++)
            near.rows[r].numbers[i] *= 1.009;
    assert_int_equal(gw_guard_compare(&table, &near, text), 0);
    assert_int_equal(gw_guard_fronts(&table, &near, text), 0);
    assert_int_equal(gw_guard_monotone(&table, text), 0);
}

static void a_planted_change_is_found_in_its_knob(void **state) {
    const gw_guard_table table = made();
    (void)state;
    for (int i = 0; i < GW_GUARD_NUMBERS; i++) {
        gw_guard_table other = table;
        if (fabs(table.rows[5].numbers[i]) < 1e-9)
            continue;
        other.rows[5].numbers[i] *= 1.1; /* tau=1 */
        assert_int_equal(gw_guard_compare(&table, &other, text), 1);
        assert_non_null(strstr(text, "tau=1:"));
        assert_non_null(strstr(text, gw_guard_names[i]));
        assert_non_null(strstr(text, "worse"));
        assert_null(strstr(text, "slope"));
    }
    gw_guard_table better = table;
    better.rows[2].numbers[0] *= 0.9;
    assert_int_equal(gw_guard_compare(&table, &better, text), 1);
    assert_non_null(strstr(text, "better"));
}

/* A metric that forgot the sign of the bias. */
static void a_lost_sign_is_found(void **state) {
    const gw_guard_table table = made();
    gw_guard_table other = table;
    (void)state;
    other.rows[3].numbers[GW_GUARD_NUMBERS - 1] *= -1;
    assert_int_equal(gw_guard_compare(&table, &other, text), 1);
    assert_non_null(strstr(text, "bias"));
}

static void a_worse_front_names_its_knob(void **state) {
    const gw_guard_table table = made();
    gw_guard_table dearer = table, poorer = table, wasted = table;
    (void)state;
    for (int r = 4; r < 8; r++) {
        dearer.rows[r].numbers[2] *= 1.05;
        poorer.rows[r].numbers[GW_GUARD_FLIP] *= 1.05;
    }
    assert_int_equal(gw_guard_fronts(&table, &dearer, text), 1);
    assert_non_null(strstr(text, "front of tau"));
    assert_int_equal(gw_guard_fronts(&table, &poorer, text), 1);
    assert_non_null(strstr(text, "front of tau"));
    assert_int_equal(gw_guard_fronts(&dearer, &table, text), 0);
    for (int r = 0; r < 8; r++)
        wasted.rows[r].numbers[3] *= 2;
    assert_int_equal(gw_guard_fronts(&table, &wasted, text), 2);
}

static void an_error_that_falls_is_found(void **state) {
    gw_guard_table table = made();
    (void)state;
    table.rows[6].numbers[GW_GUARD_FLIP] = 0.96 * table.rows[5].numbers[GW_GUARD_FLIP];
    assert_int_equal(gw_guard_monotone(&table, text), 0);
    table.rows[6].numbers[GW_GUARD_FLIP] = 0.9 * table.rows[5].numbers[GW_GUARD_FLIP];
    assert_int_equal(gw_guard_monotone(&table, text), 1);
    assert_non_null(strstr(text, "error of tau"));
}

static void tables_come_back_from_files(void **state) {
    const gw_guard_table table = made();
    gw_guard_table back;
    char path[512];
    (void)state;
    FILE *file = fopen(scratch_path(path, "guard.csv"), "w");
    assert_non_null(file);
    gw_guard_write(file, &table, "made");
    fclose(file);
    check_ok(gw_guard_load(path, &back, &error));
    assert_int_equal(back.count, table.count);
    assert_int_equal(gw_guard_compare(&table, &back, text), 0);
    const gw_guard_table none = {0};
    assert_true(gw_guard_compare(&table, &none, text) > 0);
    check_ok(gw_file_write(path, "knob\ntau,1,2,3\n", 15, &error));
    check_fails(gw_guard_load(path, &back, &error), GW_BAD_INPUT, "line 2");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_tables_pass),
        cmocka_unit_test(a_planted_change_is_found_in_its_knob),
        cmocka_unit_test(a_lost_sign_is_found),
        cmocka_unit_test(a_worse_front_names_its_knob),
        cmocka_unit_test(an_error_that_falls_is_found),
        cmocka_unit_test(tables_come_back_from_files),
    };
    return cmocka_run_group_tests_name("ledger_guard", tests, NULL, NULL);
}
