/* libFuzzer: make fuzz ONLY=gaze_datagram */
#include "tests/fuzz/gaze_datagram_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_gaze_datagram(data, size);
    return 0;
}
