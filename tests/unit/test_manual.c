/* The man page names the verbs that --help names, with the same words, and the version. */
#include "tests/support/check.h"

#include "base/file.h"
#include "wall/verbs.h"

static void the_man_page_tells_every_verb(void **state) {
    gw_bytes page;
    (void)state;
    check_ok(gw_file_read("docs/gazewall.1", 1 << 20, &page, &error));
    char *text = (char *)page.data, entry[512];
    char *verbs = strstr(text, ".SH VERBS\n"), *end = verbs ? strstr(verbs + 1, "\n.SH ") : NULL;
    assert_true(verbs && end);
    assert_non_null(strstr(text, "\"gazewall " GW_VERSION "\""));
    *end = '\0';
    size_t told = 0, wanted = 0;
    for (char *at = verbs; (at = strstr(at, "\n.TP\n")); at++)
        told++;
    for (size_t i = 0; i < gw_verb_count; i++) {
        if (!gw_verbs[i].summary)
            continue;
        wanted++;
        snprintf(entry, sizeof entry, "\n.TP\n.B %s\n%s", gw_verbs[i].name, gw_verbs[i].summary);
        if (!strstr(verbs, entry))
            fail_msg("docs/gazewall.1 lacks, under VERBS:%s", entry);
    }
    assert_int_equal(told, wanted);
    gw_bytes_finish(&page);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_man_page_tells_every_verb)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
