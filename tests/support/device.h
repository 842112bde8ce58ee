/* The GL device of a test program, opened before its first test and closed after its last one. Header only.
 */
#ifndef GW_TESTS_SUPPORT_DEVICE_H
#define GW_TESTS_SUPPORT_DEVICE_H

#include "tests/support/check.h"

#include "base/gl.h"

static gw_gl *device;

static inline int open_device(void **state) {
    gw_gl_options options = {0};
    (void)state;
    check_ok(gw_gl_create(&options, &device, &error));
    return 0;
}

static inline int close_device(void **state) {
    (void)state;
    gw_gl_destroy(&device);
    return 0;
}

#endif
