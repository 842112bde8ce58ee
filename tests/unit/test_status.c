/* Error values, memory, log, clock, hash and suggestions: the small parts of base/. */
#include "tests/support/check.h"

#include "base/clock.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/suggest.h"

static void failure_has_code_and_text(void **state) {
    (void)state;
    gw_error error = {0};
    assert_int_equal(gw_fail(&error, GW_BAD_INPUT, "line %d of %s", 7, "x.yaml"), GW_BAD_INPUT);
    assert_int_equal(error.code, GW_BAD_INPUT);
    assert_string_equal(error.text, "line 7 of x.yaml");
    assert_int_equal(gw_fail(NULL, GW_MACHINE, "nobody listens"), GW_MACHINE);
}

static void context_goes_before(void **state) {
    (void)state;
    gw_error error = {0};
    gw_fail(&error, GW_NO_OUTPUT, "disk full");
    assert_int_equal(gw_context(&error, "writing %s", "a.png"), GW_NO_OUTPUT);
    assert_string_equal(error.text, "writing a.png: disk full");
}

static void long_texts_are_cut_visibly(void **state) {
    (void)state;
    gw_error error = {0};
    char text[5000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    gw_fail(&error, GW_BAD_INPUT, "%s", text);
    assert_int_equal(strlen(error.text), sizeof error.text - 1);
    assert_string_equal(error.text + sizeof error.text - 4, "...");
    gw_context(&error, "before");
    assert_memory_equal(error.text, "before: xxx", 11);
    assert_string_equal(error.text + sizeof error.text - 4, "...");
    gw_context(&error, "%s", text);
    assert_int_equal(strlen(error.text), sizeof error.text - 1);
    assert_string_equal(error.text + sizeof error.text - 4, "...");
}

static void nothing_steers_a_terminal(void **state) {
    (void)state;
    gw_error error = {0};
    gw_fail(&error, GW_BAD_INPUT, "column '%s'\n\tline", "\x1b[2J\x7f\xc3\xa4");
    assert_string_equal(error.text, "column '?[2J?\xc3\xa4'\n\tline");
    gw_context(&error, "%s", "\r");
    assert_memory_equal(error.text, "?: column", 9);
}

static void products_that_overflow_are_refused(void **state) {
    (void)state;
    void *memory = NULL;
    check_fails(gw_allocate(&memory, SIZE_MAX / 2, 16, "triangles", &error), GW_MACHINE, "triangles");
    assert_null(memory);
    size_t capacity = 0;
    check_fails(gw_grow(&memory, &capacity, SIZE_MAX / 8, 16, "nodes", &error), GW_MACHINE, "nodes");
    assert_int_equal(capacity, 0);
}

static void growth_keeps_contents_and_is_geometric(void **state) {
    (void)state;
    void *array = NULL;
    size_t capacity = 0, moves = 0, before = 0;
    for (size_t i = 0; i < 100000; i++) {
        check_ok(gw_grow(&array, &capacity, i + 1, sizeof(uint32_t), "numbers", &error));
        moves += capacity != before;
        before = capacity;
        ((uint32_t *)array)[i] = (uint32_t)i;
    }
    for (uint32_t i = 0; i < 100000; i++) {
        assert_int_equal(((uint32_t *)array)[i], i);
    }
    assert_true(moves < 40);
    free(array);
}

static void allocation_is_zeroed(void **state) {
    (void)state;
    void *memory = NULL;
    check_ok(gw_allocate(&memory, 1000, 3, "bytes", &error));
    for (int i = 0; i < 3000; i++) {
        assert_int_equal(((uint8_t *)memory)[i], 0);
    }
    free(memory);
    check_ok(gw_allocate(&memory, 0, 3, "bytes", &error));
    assert_null(memory);
}

typedef struct heard {
    int lines;
    char last[4096];
    double fraction;
} heard;

static void on_line(void *context, gw_log_level level, const char *text) {
    heard *ear = context;
    ear->lines++;
    snprintf(ear->last, sizeof ear->last, "%s: %s", gw_log_level_name(level), text);
}

static void on_progress(void *context, const char *what, double fraction) {
    (void)what;
    ((heard *)context)->fraction = fraction;
}

static void log_drops_what_is_above_its_threshold(void **state) {
    (void)state;
    heard ear = {0};
    gw_log log = {.threshold = GW_LOG_WARNING, .context = &ear, .line = on_line, .progress = on_progress};
    gw_log_write(&log, GW_LOG_INFO, "unheard");
    assert_int_equal(ear.lines, 0);
    gw_log_write(&log, GW_LOG_WARNING, "%d tiles late", 3);
    assert_int_equal(ear.lines, 1);
    assert_string_equal(ear.last, "warning: 3 tiles late");
    gw_log_write(NULL, GW_LOG_ERROR, "no log");
    gw_log_progress(&log, "building", 7.0);
    assert_true(ear.fraction == 1.0);
    gw_log_progress(&log, "without an end", -0.5);
    assert_true(ear.fraction < 0);
}

static void level_names_round_trip(void **state) {
    (void)state;
    for (int i = GW_LOG_ERROR; i <= GW_LOG_DEBUG; i++) {
        gw_log_level level = GW_LOG_ERROR;
        assert_true(gw_log_level_parse(gw_log_level_name((gw_log_level)i), &level));
        assert_int_equal(level, i);
    }
    gw_log_level level = GW_LOG_INFO;
    assert_false(gw_log_level_parse("loud", &level));
    assert_int_equal(level, GW_LOG_INFO);
}

static void hash_depends_on_order_and_borders(void **state) {
    (void)state;
    gw_hash none = {0};
    gw_hash a_bc = gw_hash_bytes(gw_hash_bytes(none, "a", 1), "bc", 2);
    gw_hash ab_c = gw_hash_bytes(gw_hash_bytes(none, "ab", 2), "c", 1);
    gw_hash bc_a = gw_hash_bytes(gw_hash_bytes(none, "bc", 2), "a", 1);
    assert_false(gw_hash_equal(a_bc, ab_c));
    assert_false(gw_hash_equal(a_bc, bc_a));
    assert_true(gw_hash_equal(a_bc, gw_hash_bytes(gw_hash_bytes(none, "a", 1), "bc", 2)));
    assert_false(gw_hash_equal(none, gw_hash_bytes(none, "", 0)));
}

static void hash_text_is_32_digits_and_stable(void **state) {
    (void)state;
    char text[33];
    gw_hash_text((gw_hash){.high = 1, .low = 0xabcu}, text);
    assert_string_equal(text, "00000000000000010000000000000abc");
    /* Caches and reports name things by it: this value may only change together with their format. */
    gw_hash_text(gw_hash_bytes((gw_hash){0}, "gazewall", 8), text);
    assert_string_equal(text, "2e4e6affc66267235d8f55107c527511");
}

static void clock_rises(void **state) {
    (void)state;
    int64_t before = gw_now_ns();
    for (int i = 0; i < 1000; i++) {
        int64_t now = gw_now_ns();
        assert_true(now >= before);
        before = now;
    }
    assert_true(before > 0);
}

static void near_names_are_suggested(void **state) {
    (void)state;
    const char *const names[] = {"tau", "tau_inside", "gaze_margin", "octree_depth", "level_blend"};
    assert_string_equal(gw_suggest("octre_depth", names, 5), "octree_depth");
    assert_string_equal(gw_suggest("octree_dpeth", names, 5), "octree_depth");
    assert_string_equal(gw_suggest("tua", names, 5), "tau");
    assert_string_equal(gw_suggest("tau_insid", names, 5), "tau_inside");
    assert_string_equal(gw_suggest("tau", names, 5), "tau");
}

static void far_names_are_not(void **state) {
    (void)state;
    const char *const names[] = {"tau", "gaze_margin", "octree_depth"};
    assert_null(gw_suggest("brightness", names, 3));
    assert_null(gw_suggest("xy", names, 3));
    assert_null(gw_suggest("", names, 3));
    assert_null(gw_suggest("tau", names, 0));
    char long_word[500];
    memset(long_word, 'a', sizeof long_word - 1);
    long_word[sizeof long_word - 1] = '\0';
    assert_null(gw_suggest(long_word, names, 3));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(failure_has_code_and_text),
        cmocka_unit_test(context_goes_before),
        cmocka_unit_test(long_texts_are_cut_visibly),
        cmocka_unit_test(nothing_steers_a_terminal),
        cmocka_unit_test(products_that_overflow_are_refused),
        cmocka_unit_test(growth_keeps_contents_and_is_geometric),
        cmocka_unit_test(allocation_is_zeroed),
        cmocka_unit_test(log_drops_what_is_above_its_threshold),
        cmocka_unit_test(level_names_round_trip),
        cmocka_unit_test(hash_depends_on_order_and_borders),
        cmocka_unit_test(hash_text_is_32_digits_and_stable),
        cmocka_unit_test(clock_rises),
        cmocka_unit_test(near_names_are_suggested),
        cmocka_unit_test(far_names_are_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
