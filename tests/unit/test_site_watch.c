/* A watched file: nothing while it stands still or is written to, once for each change, whether it is
 * rewritten or replaced; a file that is gone for a moment is no change, for longer it is told. */
#include "tests/support/check.h"

#include "wall/site_watch.h"

#include <unistd.h>

static const int64_t second = 1000000000;

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void changes_are_seen_once(void **state) {
    (void)state;
    char path[512], other[512];
    gw_site_watch watch;
    int64_t now = second;
    scratch_path(path, "watched.yaml");
    scratch_path(other, "watched.new");
    write_file(path, "one");
    gw_site_watch_begin(&watch, path);
    for (int i = 0; i < 5; i++)
        assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
    write_file(path, "another"); /* rewritten */
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
    write_file(path, "another one"); /* before it was quiet */
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += 1000));
    assert_int_equal(GW_SITE_CHANGED, gw_site_watch_look(&watch, now += second));
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
    write_file(other, "replaced one"); /* replaced by one of the same size */
    unlink(path);
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
    assert_int_equal(rename(other, path), 0);
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
    assert_int_equal(GW_SITE_CHANGED, gw_site_watch_look(&watch, now += second));
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
    unlink(path); /* for good: told once, and again when it was there meanwhile */
    for (int turn = 0; turn < 2; turn++) {
        int told = 0;
        assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
        for (int i = 0; i < 9; i++)
            told += gw_site_watch_look(&watch, now += second) == GW_SITE_GONE;
        assert_int_equal(told, 1);
        write_file(path, "one that was written anew");
        assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, now += second));
        assert_int_equal(GW_SITE_CHANGED, gw_site_watch_look(&watch, now += second));
        unlink(path);
    }
}

static void what_is_no_file_is_not_watched(void **state) {
    (void)state;
    gw_site_watch watch;
    gw_site_watch_begin(&watch, NULL);
    assert_int_equal(GW_SITE_AS_IT_WAS, gw_site_watch_look(&watch, second));
    gw_site_watch_begin(&watch, "/proc");
    assert_null(watch.path);
    gw_site_watch_begin(&watch, "a-site-inside-the-program");
    assert_null(watch.path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changes_are_seen_once),
        cmocka_unit_test(what_is_no_file_is_not_watched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
