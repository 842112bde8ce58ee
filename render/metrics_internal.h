/* What the parts of gw_metrics_compare() share. Each fills its own values and leaves the others alone. */
#ifndef GW_RENDER_METRICS_INTERNAL_H
#define GW_RENDER_METRICS_INTERNAL_H

#include "render/metrics.h"

/* Mean, 95th percentile and largest of values that are gathered one by one. */
typedef struct gw_metric_gather {
    float *values; /* owned */
    size_t count;
    double sum, largest;
} gw_metric_gather;
gw_code gw_metric_gather_open(gw_metric_gather *gather, size_t most, gw_error *error);
void gw_metric_gather_add(gw_metric_gather *gather, double value);
/* NAN each when nothing was gathered. The percentile is the value that at most 5 % lie above; sorts. */
double gw_metric_gather_mean(const gw_metric_gather *gather);
double gw_metric_gather_95(gw_metric_gather *gather);
double gw_metric_gather_largest(const gw_metric_gather *gather);
void gw_metric_gather_finish(gw_metric_gather *gather);

gw_code gw_metric_geometry(const gw_metric_frame *reference, const gw_metric_frame *test,
                           const gw_metric_view *view, gw_metrics *out, gw_error *error);
void gw_metric_codes(const gw_image *reference, const gw_image *test, gw_metrics *out);
gw_code gw_metric_ssim(const gw_image *reference, const gw_image *test, gw_metrics *out, gw_error *error);
/* light: [pixels][3] each. */
void gw_metric_light(const float *reference, const float *test, size_t pixels, gw_metrics *out);
/* Root mean square difference of codes, as a share of 255; channel 0 to 2, or 3: all. */
double gw_metric_rms(const gw_image *reference, const gw_image *test, int channel);
double gw_metric_decibels(double rms); /* INFINITY for 0 */

#endif
