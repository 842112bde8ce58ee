#include "wall/latency.h"

#include "base/memory.h"
#include "wall/report.h"

#include <math.h>
#include <stdlib.h>

const char *const gw_latency_names[GW_LATENCY_STAGES] = {"age",   "filter", "wait",
                                                         "trace", "gate",   "scan_out"};

gw_latency gw_latency_of(const gw_viewer_view *viewer) {
    const int head = viewer->has_head;
    const int64_t age = head ? viewer->head_arrival : viewer->gaze_arrival,
                  filter = head ? viewer->head_delay : viewer->gaze_delay,
                  wait = head ? viewer->head_wait : viewer->gaze_wait;
    gw_latency out = {.tracked = viewer->has_head || viewer->has_gaze};
    if (!out.tracked)
        return out;
    out.ms[GW_LATENCY_AGE] = (float)((double)age * 1e-6);
    out.ms[GW_LATENCY_FILTER] = (float)((double)filter * 1e-6);
    out.ms[GW_LATENCY_WAIT] = (float)((double)wait * 1e-6);
    out.predicted = (float)((double)viewer->predicted * 1e-6);
    return out;
}

void gw_latency_complete(gw_latency *latency, double slowest, double whole, double refresh) {
    latency->ms[GW_LATENCY_TRACE] = (float)slowest;
    latency->ms[GW_LATENCY_GATE] = (float)fmax(whole - slowest, 0);
    latency->ms[GW_LATENCY_SCAN_OUT] = (float)(500 / refresh);
}

double gw_latency_total(const gw_latency *latency) {
    double sum = 0;
    for (int i = 0; i < GW_LATENCY_STAGES; i++)
        sum += (double)latency->ms[i];
    return sum;
}

static json_t *spread_of(const double *values, size_t count) {
    const gw_spread spread = gw_spread_of(values, count);
    return json_pack("{s:f, s:f, s:f}", "median", spread.median, "p95", spread.p95, "max", spread.maximum);
}

json_t *gw_latency_json(const gw_latency *frames, size_t count) {
    void *memory = NULL;
    size_t known = 0;
    if (gw_allocate(&memory, count, sizeof(double), "latencies", NULL))
        return json_null();
    double *values = memory;
    json_t *out = json_object();
    for (int stage = 0; stage < GW_LATENCY_STAGES + 2; stage++) {
        known = 0;
        for (size_t i = 0; i < count; i++)
            if (frames[i].tracked)
                values[known++] = stage < GW_LATENCY_STAGES    ? (double)frames[i].ms[stage]
                                  : stage == GW_LATENCY_STAGES ? gw_latency_total(&frames[i])
                                                               : (double)frames[i].predicted;
        json_object_set_new(out,
                            stage < GW_LATENCY_STAGES    ? gw_latency_names[stage]
                            : stage == GW_LATENCY_STAGES ? "total"
                                                         : "predicted",
                            spread_of(values, known));
    }
    free(values);
    if (known)
        return out;
    json_decref(out);
    return json_null();
}
