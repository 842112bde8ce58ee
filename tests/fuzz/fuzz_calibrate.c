/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I. tests/fuzz/fuzz_calibrate.c
 * wall/calibrate_file.c tracking/calibrate.c tracking/room.c base/yaml.c base/suggest.c ... -lyaml
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
