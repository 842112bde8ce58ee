/* libFuzzer: make fuzz ONLY=calibrate
 * The first byte says which of both files the rest is. */
#include "tests/fuzz/calibrate_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size > 0 && data[0] & 1)
        fuzz_gazes(data + 1, size - 1);
    else if (size > 0)
        fuzz_marks(data + 1, size - 1);
    return 0;
}
