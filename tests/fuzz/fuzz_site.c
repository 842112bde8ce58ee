/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I. tests/fuzz/fuzz_site.c
 * wall/site*.c wall/layout*.c wall/stereo.c wall/svg.c base/x.c ... -lyaml
 * -Wl,--unresolved-symbols=ignore-all (wall/stereo.c also draws; nothing here does) */
#include "tests/fuzz/site_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_site(data, size);
    return 0;
}
