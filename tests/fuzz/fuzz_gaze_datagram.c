/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I.
 * tests/fuzz/fuzz_gaze_datagram.c tracking/x.c base/x.c ... */
#include "tests/fuzz/gaze_datagram_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_gaze_datagram(data, size);
    return 0;
}
