/* libFuzzer: make fuzz ONLY=profile */
#include "tests/fuzz/profile_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_profile(data, size);
    return 0;
}
