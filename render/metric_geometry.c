/* See metrics.h: what was hit, where, and how it faces. */
#include "render/metrics_internal.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "build/gpu_types.h"
#include "render/distance_transform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- gathering -------------------------------------------------------------------------------------------
 */

gw_code gw_metric_gather_open(gw_metric_gather *gather, size_t most, gw_error *error) {
    memset(gather, 0, sizeof *gather);
    return gw_allocate((void **)&gather->values, most, sizeof *gather->values, "differences", error);
}

void gw_metric_gather_add(gw_metric_gather *gather, double value) {
    gather->values[gather->count++] = (float)value;
    gather->sum += value;
    gather->largest = fmax(gather->largest, value);
}

double gw_metric_gather_mean(const gw_metric_gather *gather) {
    return gather->count ? gather->sum / (double)gather->count : NAN;
}

static int compare_floats(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

double gw_metric_gather_95(gw_metric_gather *gather) {
    if (!gather->count)
        return NAN;
    qsort(gather->values, gather->count, sizeof *gather->values, compare_floats);
    return (double)gather->values[(gather->count * 19 + 19) / 20 - 1];
}

double gw_metric_gather_largest(const gw_metric_gather *gather) {
    return gather->count ? gather->largest : NAN;
}

void gw_metric_gather_finish(gw_metric_gather *gather) {
    free(gather->values);
    memset(gather, 0, sizeof *gather);
}

/* --- silhouettes -----------------------------------------------------------------------------------------
 */

/* Pixels that hit and have a neighbour, of four, that does not; the picture's border is no silhouette. */
static size_t mark_silhouette(const gw_metric_frame *frame, uint8_t *marks) {
    const uint32_t width = frame->width, height = frame->height;
    size_t count = 0;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t *id = frame->ids + (size_t)y * width + x;
            const int outline =
                *id != GW_NO_TRIANGLE &&
                ((x > 0 && id[-1] == GW_NO_TRIANGLE) || (x + 1 < width && id[1] == GW_NO_TRIANGLE) ||
                 (y > 0 && id[-(ptrdiff_t)width] == GW_NO_TRIANGLE) ||
                 (y + 1 < height && id[width] == GW_NO_TRIANGLE));
            marks[(size_t)y * width + x] = (uint8_t)outline;
            count += (size_t)outline;
        }
    return count;
}

/* From each marked pixel to what squares tell the distance of. */
static void directed(const uint8_t *marks, const float *squares, size_t pixels, double *mean,
                     double *largest) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < pixels; ++i)
        if (marks[i]) {
            const double distance = sqrt((double)squares[i]);
            sum += distance;
            ++count;
            *largest = fmax(*largest, distance);
        }
    *mean = fmax(*mean, sum / (double)count);
}

/* Hausdorff distance, and with means in place of the outer maxima that of Dubuisson & Jain (A Modified
 * Hausdorff Distance for Object Matching, 1994). */
static gw_code compare_silhouettes(const gw_metric_frame *reference, const gw_metric_frame *test,
                                   gw_metrics *out, gw_error *error) {
    const size_t pixels = (size_t)reference->width * reference->height;
    const gw_metric_frame *frames[2] = {reference, test};
    uint8_t *marks[2] = {NULL, NULL};
    float *squares = NULL;
    size_t counts[2] = {0, 0};
    double mean = 0, largest = 0;
    gw_code code = gw_allocate((void **)&squares, pixels, sizeof *squares, "distances", error);
    for (int i = 0; i < 2 && !code; ++i) {
        code = gw_allocate((void **)&marks[i], pixels, 1, "silhouette", error);
        if (!code)
            counts[i] = mark_silhouette(frames[i], marks[i]);
    }
    for (int i = 0; i < 2 && !code && counts[0] && counts[1]; ++i) {
        code = gw_distance_transform(marks[i], reference->width, reference->height, squares, error);
        if (!code)
            directed(marks[1 - i], squares, pixels, &mean, &largest);
    }
    if (!code && !counts[0] != !counts[1]) /* one has no silhouette: as far off as the picture allows */
        mean = largest = hypot(reference->width, reference->height);
    if (!code && (counts[0] || counts[1])) {
        out->values[GW_METRIC_SILHOUETTE_MEAN] = mean;
        out->values[GW_METRIC_SILHOUETTE_LARGEST] = largest;
    }
    free(marks[0]);
    free(marks[1]);
    free(squares);
    return code;
}

/* --- pixel by pixel --------------------------------------------------------------------------------------
 */

static int both_hit(const gw_metric_frame *a, const gw_metric_frame *b, size_t i) {
    return !a->ids || !b->ids || (a->ids[i] != GW_NO_TRIANGLE && b->ids[i] != GW_NO_TRIANGLE);
}

static void compare_hits(const gw_metric_frame *reference, const gw_metric_frame *test, gw_metrics *out) {
    const size_t pixels = (size_t)reference->width * reference->height;
    size_t missed = 0;
    for (size_t i = 0; i < pixels; ++i)
        missed += (reference->ids[i] == GW_NO_TRIANGLE) != (test->ids[i] == GW_NO_TRIANGLE);
    out->values[GW_METRIC_HIT_MISMATCH] = (double)missed / (double)pixels;
}

/* Depth in footprints: a difference d at distance t of the reference would, seen from the side, cover
 * d / (t w) pixels of angle w. Parallax: by how many pixels the point moves against the reference's for an
 * eye that stands the baseline b aside: b (1/t' - 1/t) / w. */
static gw_code compare_depths(const gw_metric_frame *reference, const gw_metric_frame *test,
                              const gw_metric_view *view, gw_metrics *out, double *not_finite,
                              gw_error *error) {
    const size_t pixels = (size_t)reference->width * reference->height;
    const double per_radian = view->pixels_per_degree * 180 / GW_PI;
    double signs = 0, moved = 0, farthest = 0;
    gw_metric_gather depths;
    gw_code code = gw_metric_gather_open(&depths, pixels, error);
    for (size_t i = 0; i < pixels && !code; ++i) {
        const double t = (double)reference->depths[i], other = (double)test->depths[i];
        if (!both_hit(reference, test, i))
            continue;
        if (!(t > 0 && isfinite(t) && other > 0 && isfinite(other))) {
            ++*not_finite;
            continue;
        }
        const double difference = (other - t) / t * per_radian;
        const double parallax = fabs(view->baseline * (1 / other - 1 / t)) * per_radian;
        gw_metric_gather_add(&depths, fabs(difference));
        signs += difference;
        moved += parallax;
        farthest = fmax(farthest, parallax);
    }
    if (!code && depths.count) {
        out->values[GW_METRIC_DEPTH_BIAS] = signs / (double)depths.count;
        out->values[GW_METRIC_DEPTH_MEAN] = gw_metric_gather_mean(&depths);
        out->values[GW_METRIC_DEPTH_LARGEST] = gw_metric_gather_largest(&depths);
        out->values[GW_METRIC_DEPTH_95] = gw_metric_gather_95(&depths);
        if (view->baseline > 0) {
            out->values[GW_METRIC_PARALLAX_MEAN] = moved / (double)depths.count;
            out->values[GW_METRIC_PARALLAX_LARGEST] = farthest;
        }
    }
    gw_metric_gather_finish(&depths);
    return code;
}

/* Between two vectors, deg; exact for small angles, too, where the cosine is not. NAN for no direction. */
static double angle_between(const float *a, const float *b) {
    double dot = 0, cross = 0, lengths[2] = {0, 0};
    for (int k = 0; k < 3; ++k) {
        const double part =
            (double)a[(k + 1) % 3] * (double)b[(k + 2) % 3] - (double)a[(k + 2) % 3] * (double)b[(k + 1) % 3];
        cross += part * part;
        dot += (double)a[k] * (double)b[k];
        lengths[0] += (double)a[k] * (double)a[k];
        lengths[1] += (double)b[k] * (double)b[k];
    }
    return lengths[0] > 0 && lengths[1] > 0 ? atan2(sqrt(cross), dot) * 180 / GW_PI : NAN;
}

static gw_code compare_normals(const gw_metric_frame *reference, const gw_metric_frame *test, gw_metrics *out,
                               double *not_finite, gw_error *error) {
    const size_t pixels = (size_t)reference->width * reference->height;
    gw_metric_gather angles;
    gw_code code = gw_metric_gather_open(&angles, pixels, error);
    for (size_t i = 0; i < pixels && !code; ++i) {
        if (!both_hit(reference, test, i))
            continue;
        const double angle = angle_between(reference->normals + i * 3, test->normals + i * 3);
        if (isfinite(angle))
            gw_metric_gather_add(&angles, angle);
        else
            ++*not_finite;
    }
    if (!code && angles.count) {
        out->values[GW_METRIC_NORMAL_MEAN] = gw_metric_gather_mean(&angles);
        out->values[GW_METRIC_NORMAL_LARGEST] = gw_metric_gather_largest(&angles);
        out->values[GW_METRIC_NORMAL_95] = gw_metric_gather_95(&angles);
    }
    gw_metric_gather_finish(&angles);
    return code;
}

gw_code gw_metric_geometry(const gw_metric_frame *reference, const gw_metric_frame *test,
                           const gw_metric_view *view, gw_metrics *out, gw_error *error) {
    double not_finite = 0;
    gw_code code = GW_OK;
    if (reference->ids && test->ids) {
        compare_hits(reference, test, out);
        code = compare_silhouettes(reference, test, out, error);
    }
    if (!code && reference->depths && test->depths)
        code = compare_depths(reference, test, view, out, &not_finite, error);
    if (!code && reference->normals && test->normals)
        code = compare_normals(reference, test, out, &not_finite, error);
    if (!code)
        out->values[GW_METRIC_NOT_FINITE] += not_finite;
    return code;
}
