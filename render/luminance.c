#include "render/luminance.h"

#include <math.h>

void gw_luminance_add(gw_luminance *to, const gw_luminance *from) {
    for (int i = 0; i < GW_LUMINANCE_BINS; i++) {
        const uint32_t room = UINT32_MAX - to->counts[i];
        to->counts[i] += from->counts[i] < room ? from->counts[i] : room;
    }
}

uint64_t gw_luminance_pixels(const gw_luminance *luminance) {
    uint64_t sum = 0;
    for (int i = 0; i < GW_LUMINANCE_BINS; i++)
        sum += luminance->counts[i];
    return sum;
}

/* Of the middle of a bin. */
static double log2_of_bin(int bin) {
    const int word = bin + GW_LUMINANCE_FIRST;
    return (word >> 2) - 127 + log2(1.125 + 0.25 * (word & 3));
}

int gw_luminance_mean(const gw_luminance *luminance, double *mean) {
    const double dark = 0.1, bright = 0.05;
    const double all = (double)(gw_luminance_pixels(luminance) - luminance->counts[0]);
    double before = 0, weight = 0, sum = 0;
    for (int i = 1; i < GW_LUMINANCE_BINS; i++) {
        /* What of the bin lies between both shares: so a pixel that comes or goes moves the mean a little
         * only. */
        const double end = before + luminance->counts[i];
        const double part = fmin(end, (1 - bright) * all) - fmax(before, dark * all);
        if (part > 0) {
            sum += part * log2_of_bin(i);
            weight += part;
        }
        before = end;
    }
    if (!(weight > 0))
        return 0;
    *mean = sum / weight;
    return 1;
}
