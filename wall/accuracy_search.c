#include "wall/bench_accuracy.h"

gw_code gw_accuracy_search(gw_accuracy_scene *scene, gw_ledger *ledger, gw_error *error) {
    (void)scene;
    (void)ledger;
    return gw_fail(error, GW_BAD_INPUT, "not yet");
}
