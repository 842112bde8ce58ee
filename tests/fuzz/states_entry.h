/* What a fuzzer and the unit test do with the bytes of recorded frame states: read them by way of a file,
 * check what came out. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_STATES_ENTRY_H
#define GW_TESTS_FUZZ_STATES_ENTRY_H

#include "wall/frames.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static inline void fuzz_states_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_states_sound(const gw_frame_state *state) {
    fuzz_states_require(state->gaze_count <= GW_MAXIMUM_VIEWERS && state->sample_block <= 4 &&
                        state->samples <= 4 && state->bounces <= 8);
    fuzz_states_require(isfinite(state->tau) && isfinite(state->strain) && state->strain >= 1);
    for (int i = 0; i < 3; i++)
        fuzz_states_require(isfinite(state->eye[i]) && isfinite(state->stand[i]) &&
                            isfinite(state->look_at[i]) && isfinite(state->eye_offset[i]));
    for (uint32_t g = 0; g < state->gaze_count; g++)
        fuzz_states_require(isfinite(state->gazes[g].half_width) && isfinite(state->gazes[g].half_height) &&
                            isfinite(state->gazes[g].age));
}

static inline void fuzz_states(const uint8_t *data, size_t size, const char *path) {
    gw_states states;
    gw_error error = {0};
    FILE *file = fopen(path, "we");
    fuzz_states_require(file != NULL && fwrite(data, 1, size, file) == size && fclose(file) == 0);
    gw_code code = gw_states_load(path, &states, &error);
    fuzz_states_require((code == GW_OK) == (error.text[0] == '\0'));
    fuzz_states_require(code == GW_OK ? states.count >= 1 && states.count <= GW_MAXIMUM_STATES
                                      : states.count == 0 && states.states == NULL);
    for (size_t i = 0; i < states.count; i++)
        fuzz_states_sound(&states.states[i]);
    gw_states_finish(&states);
}

#endif
