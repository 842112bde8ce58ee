/* libFuzzer: make fuzz ONLY=site */
#include "tests/fuzz/site_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_site(data, size);
    return 0;
}
