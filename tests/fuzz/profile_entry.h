/* What a fuzzer and the unit test do with the bytes of a profile: read it, check the settings that came out.
 * Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_PROFILE_ENTRY_H
#define GW_TESTS_FUZZ_PROFILE_ENTRY_H

#include "wall/profile.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static inline void fuzz_profile_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_profile(const uint8_t *data, size_t size) {
    static gw_profile profile;
    gw_settings settings;
    gw_error error = {0};
    gw_settings_init(&settings);
    gw_profile_init(&profile);
    gw_code code = gw_profile_parse((const char *)data, size, "fuzz", &settings, &profile, &error);
    fuzz_profile_require((code == GW_OK) == (error.text[0] == '\0'));
    if (code != GW_OK)
        return;
    fuzz_profile_require(profile.figure_count <= sizeof profile.figures / sizeof profile.figures[0]);
    fuzz_profile_require(strlen(profile.about) < sizeof profile.about &&
                         strlen(profile.measured_by) < sizeof profile.measured_by);
    for (size_t i = 0; i < gw_setting_count; i++) {
        const double value = gw_setting_value(&settings, &gw_setting_rows[i]);
        fuzz_profile_require(value == GW_SETTING_AUTO ||
                             (value >= gw_setting_rows[i].minimum && value <= gw_setting_rows[i].maximum));
    }
}

#endif
