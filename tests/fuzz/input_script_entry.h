/* What a fuzzer and the unit test do with the bytes of an input script: read it, check what came out. Aborts
 * when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_INPUT_SCRIPT_ENTRY_H
#define GW_TESTS_FUZZ_INPUT_SCRIPT_ENTRY_H

#include "wall/controls.h"
#include "wall/input_script.h"

#include <math.h>
#include <stdlib.h>

static inline void fuzz_input_script(const uint8_t *data, size_t size) {
    gw_error error = {0};
    gw_input_script script;
    gw_controls controls = {0};
    if (gw_input_script_parse("fuzz", (const char *)data, size, &script, &error)) {
        if (!error.text[0] || script.count || script.events)
            abort();
        return;
    }
    for (size_t i = 0; i < script.count; i++) {
        const gw_event *event = &script.events[i].event;
        if ((i && script.events[i].frame < script.events[i - 1].frame) || event->key < 0 ||
            event->key >= GW_KEY_END || !isfinite(event->position[0]) || !isfinite(event->position[1]))
            abort();
        gw_controls_note(&controls, event);
    }
    gw_controls_take(&controls);
    gw_input_script_finish(&script);
}

#endif
