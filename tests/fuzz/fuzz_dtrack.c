/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I. tests/fuzz/fuzz_dtrack.c
 * tracking/x.c base/x.c ... */
#include "tests/fuzz/dtrack_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_dtrack(data, size);
    return 0;
}
