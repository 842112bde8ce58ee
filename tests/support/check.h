/* What every test program includes first: cmocka with the headers that it wants before it, and checks for
 * results that are error values. Header only. */
#ifndef GW_TESTS_SUPPORT_CHECK_H
#define GW_TESTS_SUPPORT_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/status.h"

/* A call that takes `&error` last must succeed; otherwise its sentence is shown. */
#define check_ok(call)                                                                                       \
    do {                                                                                                     \
        gw_error error = {0};                                                                                \
        if ((call) != GW_OK) {                                                                               \
            fail_msg("%s: %s", #call, error.text);                                                           \
        }                                                                                                    \
    } while (0)

/* A call that takes `&error` last must fail with this code, and its sentence must contain `part`. */
#define check_fails(call, wanted, part)                                                                      \
    do {                                                                                                     \
        gw_error error = {0};                                                                                \
        gw_code got = (call);                                                                                \
        if (got != (wanted) || error.code != (wanted)) {                                                     \
            fail_msg("%s: code %d (error %d: %s), expected %d", #call, (int)got, (int)error.code,            \
                     error.text, (int)(wanted));                                                             \
        }                                                                                                    \
        if (!strstr(error.text, (part))) {                                                                   \
            fail_msg("%s: \"%s\" does not contain \"%s\"", #call, error.text, (part));                       \
        }                                                                                                    \
    } while (0)

/* The folder that the runner gave this test, or /tmp when it is run by hand. Returns `path`. */
static inline const char *scratch_path(char path[512], const char *name) {
    const char *folder = getenv("GW_TEST_FOLDER");
    snprintf(path, 512, "%s/%s", folder ? folder : "/tmp", name);
    return path;
}

#endif
