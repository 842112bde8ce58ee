/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I.
 * tests/fuzz/fuzz_model_stream.c build/x.c base/x.c ... */
#include "tests/fuzz/import_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_model_stream(data, size);
    return 0;
}
