/* libFuzzer: make fuzz ONLY=dtrack */
#include "tests/fuzz/dtrack_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_dtrack(data, size);
    return 0;
}
