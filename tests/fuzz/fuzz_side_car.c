/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I. tests/fuzz/fuzz_side_car.c
 * out/release/libgazewall.a ... */
#include "tests/fuzz/side_car_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_side_car(data, size, "/dev/shm/fuzz-side-car.json");
    return 0;
}
