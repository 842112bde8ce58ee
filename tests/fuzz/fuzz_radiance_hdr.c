/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I.
 * tests/fuzz/fuzz_radiance_hdr.c out/release/libgazewall.a ... */
#include "tests/fuzz/radiance_hdr_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_radiance_hdr(data, size);
    return 0;
}
