/* libFuzzer: make fuzz ONLY=vrpn_message */
#include "tests/fuzz/vrpn_message_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_vrpn_message(data, size);
    return 0;
}
