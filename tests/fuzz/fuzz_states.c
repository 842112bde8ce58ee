/* libFuzzer: make fuzz ONLY=states */
#include "tests/fuzz/states_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_states(data, size, "/dev/shm/fuzz-states.jsonl");
    return 0;
}
