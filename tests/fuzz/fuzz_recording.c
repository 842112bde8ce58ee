/* libFuzzer: recordings - VRPN logs, CSV, gzip - as their bytes have it. */
#include "tests/fuzz/recording_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_recording(data, size);
    return 0;
}
