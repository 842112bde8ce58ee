/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I.
 * tests/fuzz/fuzz_input_script.c wall/input_script.c wall/controls.c base/x.c ... */
#include "tests/fuzz/input_script_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_input_script(data, size);
    return 0;
}
