/* libFuzzer: clang -fsanitize=fuzzer,address -D_GNU_SOURCE -ffp-contract=off -I. tests/fuzz/fuzz_rejoin.c
 * wall/wire_tcp.c wall/rejoin_message.c wall/gate_message.c base/hash.c base/memory.c base/status.c -lxxhash
 */
#include "tests/fuzz/rejoin_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_rejoin(data, size);
    return 0;
}
