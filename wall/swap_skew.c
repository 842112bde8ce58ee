#include "wall/swap_skew.h"

#include "base/memory.h"
#include "wall/report.h"

#include <stdlib.h>

gw_code gw_swap_skew_create(uint32_t frame_count, gw_swap_skew *out, gw_error *error) {
    *out = (gw_swap_skew){.frame_count = frame_count};
    return gw_allocate((void **)&out->frames, frame_count, sizeof *out->frames, "swap times", error);
}

void gw_swap_skew_finish(gw_swap_skew *skew) {
    free(skew->frames);
    *skew = (gw_swap_skew){0};
}

void gw_swap_skew_note(gw_swap_skew *skew, uint32_t number, int64_t when, int64_t clock_error) {
    gw_swap_frame *frame = &skew->frames[number % skew->frame_count];
    if (frame->number != number)
        *frame = (gw_swap_frame){.number = number};
    if (!frame->tiles || when < frame->first)
        frame->first = when;
    if (!frame->tiles || when > frame->last)
        frame->last = when;
    frame->tiles++;
    skew->clock_error = clock_error > skew->clock_error ? clock_error : skew->clock_error;
}

json_t *gw_swap_skew_json(const gw_swap_skew *skew, double *median, double *maximum) {
    double *milliseconds = NULL;
    size_t count = 0;
    *median = *maximum = 0;
    if (gw_allocate((void **)&milliseconds, skew->frame_count, sizeof *milliseconds, "swap times", NULL))
        return json_null();
    for (uint32_t i = 0; i < skew->frame_count; i++)
        if (skew->frames[i].tiles > 1)
            milliseconds[count++] = (double)(skew->frames[i].last - skew->frames[i].first) * 1e-6;
    const gw_spread spread = gw_spread_of(milliseconds, count);
    free(milliseconds);
    if (!count)
        return json_null();
    *median = spread.median;
    *maximum = spread.maximum;
    return json_pack("{s:f, s:f, s:f, s:I, s:f}", "median", spread.median, "p95", spread.p95, "max",
                     spread.maximum, "frames", (json_int_t)count, "clock_error",
                     (double)skew->clock_error * 1e-6);
}
