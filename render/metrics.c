/* See metrics.h. */
#include "render/metrics.h"

#include "base/portable_math.h"
#include "render/acuity_filter.h"
#include "render/flip.h"
#include "render/metrics_internal.h"
#include "render/vector3.h"

#include <math.h>
#include <string.h>

/* clang-format off */
const gw_metric_row gw_metric_table[GW_METRIC_COUNT] = {
    [GW_METRIC_HIT_MISMATCH] = {"hit_mismatch", "share", "pixels of which one hits and the other does not", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_DEPTH_MEAN] = {"depth", "px", "depth difference in the reference's footprints, mean", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_DEPTH_95] = {"depth_95", "px", "the same, 95th percentile", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_DEPTH_LARGEST] = {"depth_largest", "px", "the same, largest", GW_METRIC_UP, GW_METRIC_SUM_WORST},
    [GW_METRIC_DEPTH_BIAS] = {"depth_bias", "px", "the same with its sign, mean: + is farther", GW_METRIC_SIGNED, GW_METRIC_SUM_MEAN},
    [GW_METRIC_PARALLAX_MEAN] = {"parallax", "px", "what the depth difference moves for the other eye, mean", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_PARALLAX_LARGEST] = {"parallax_largest", "px", "the same, largest", GW_METRIC_UP, GW_METRIC_SUM_WORST},
    [GW_METRIC_NORMAL_MEAN] = {"normal", "deg", "angle between the normals, mean", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_NORMAL_95] = {"normal_95", "deg", "the same, 95th percentile", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_NORMAL_LARGEST] = {"normal_largest", "deg", "the same, largest", GW_METRIC_UP, GW_METRIC_SUM_WORST},
    [GW_METRIC_SILHOUETTE_MEAN] = {"silhouette", "px", "distance between silhouettes, mean of the worse direction", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_SILHOUETTE_LARGEST] = {"silhouette_hausdorff", "px", "Hausdorff distance between silhouettes", GW_METRIC_UP, GW_METRIC_SUM_WORST},
    [GW_METRIC_CHANGED] = {"changed", "share", "pixels whose codes differ", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_LARGEST] = {"largest", "1/255", "largest difference of a channel's codes", GW_METRIC_UP, GW_METRIC_SUM_WORST},
    [GW_METRIC_PSNR] = {"psnr", "dB", "peak signal-to-noise ratio of codes, all channels", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_PSNR_RED] = {"psnr_red", "dB", "the same, red", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_PSNR_GREEN] = {"psnr_green", "dB", "the same, green", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_PSNR_BLUE] = {"psnr_blue", "dB", "the same, blue", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_SSIM] = {"ssim", "", "structural similarity of luma, mean", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_SSIM_RED] = {"ssim_red", "", "the same, red", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_SSIM_GREEN] = {"ssim_green", "", "the same, green", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_SSIM_BLUE] = {"ssim_blue", "", "the same, blue", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_RELATIVE_SQUARE] = {"relative_square", "", "relative mean square error of light of any size", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_BIAS] = {"bias", "white", "luminance minus the reference's, mean: + is brighter", GW_METRIC_SIGNED, GW_METRIC_SUM_MEAN},
    [GW_METRIC_BIAS_RED] = {"bias_red", "white", "linear light minus the reference's, red", GW_METRIC_SIGNED, GW_METRIC_SUM_MEAN},
    [GW_METRIC_BIAS_GREEN] = {"bias_green", "white", "the same, green", GW_METRIC_SIGNED, GW_METRIC_SUM_MEAN},
    [GW_METRIC_BIAS_BLUE] = {"bias_blue", "white", "the same, blue", GW_METRIC_SIGNED, GW_METRIC_SUM_MEAN},
    [GW_METRIC_NOT_FINITE] = {"not_finite", "values", "pixels left out because a value is no number", GW_METRIC_UP, GW_METRIC_SUM_WORST},
    [GW_METRIC_FLIP] = {"flip", "", "FLIP, mean", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_SEEN_FLIP] = {"seen_flip", "", "FLIP behind the viewers' acuity, mean", GW_METRIC_UP, GW_METRIC_SUM_MEAN},
    [GW_METRIC_SEEN_PSNR] = {"seen_psnr", "dB", "PSNR behind the viewers' acuity", GW_METRIC_DOWN, GW_METRIC_SUM_MEAN},
    [GW_METRIC_FLICKER] = {"flicker", "white", "change of lightness that the reference does not have, mean", GW_METRIC_UP, GW_METRIC_SUM_OF_TRACK},
    [GW_METRIC_FLICKER_99] = {"flicker_99", "white", "the same, 99th percentile", GW_METRIC_UP, GW_METRIC_SUM_OF_TRACK},
    [GW_METRIC_POP] = {"pop", "white", "largest such step of the mean of 16 x 16 px", GW_METRIC_UP, GW_METRIC_SUM_OF_TRACK},
    [GW_METRIC_SEEN_FLICKER] = {"seen_flicker", "white", "flicker behind the viewers' acuity, mean", GW_METRIC_UP, GW_METRIC_SUM_OF_TRACK},
    [GW_METRIC_SEEN_POP] = {"seen_pop", "white", "pop behind the viewers' acuity", GW_METRIC_UP, GW_METRIC_SUM_OF_TRACK},
};
/* clang-format on */

void gw_metrics_clear(gw_metrics *metrics) {
    for (int i = 0; i < GW_METRIC_COUNT; ++i)
        metrics->values[i] = NAN;
}

static int is_similarity(gw_metric metric) {
    return metric >= GW_METRIC_SSIM && metric <= GW_METRIC_SSIM_BLUE;
}

double gw_metric_badness(gw_metric metric, double value) {
    if (gw_metric_table[metric].sense != GW_METRIC_DOWN)
        return fabs(value);
    return is_similarity(metric) ? 1 - value : pow(10, -value / 20);
}

double gw_pixels_per_degree(const gw_plane *plane, const double eye[3], uint32_t width, uint32_t height) {
    double along[3];
    for (int k = 0; k < 3; ++k)
        along[k] =
            plane->corner[k] + 0.5 * width * plane->step_x[k] + 0.5 * height * plane->step_y[k] - eye[k];
    const double pitch = sqrt(gw_dot(plane->step_x, plane->step_x));
    return fmin(fmax(sqrt(gw_dot(along, along)) * tan(GW_PI / 180) / pitch, 1), 1000);
}

/* --- one frame -------------------------------------------------------------------------------------------
 */

static int has_picture_of_size(const gw_metric_frame *frame) {
    return !frame->picture ||
           (frame->picture->width == frame->width && frame->picture->height == frame->height);
}

static gw_code check(const gw_metric_frame *reference, const gw_metric_frame *test,
                     const gw_metric_view *view, gw_error *error) {
    if (reference->width != test->width || reference->height != test->height)
        return gw_fail(error, GW_BAD_INPUT,
                       "pictures of %u x %u and %u x %u pixels cannot be compared; scale or cut one of them",
                       reference->width, reference->height, test->width, test->height);
    if (!has_picture_of_size(reference) || !has_picture_of_size(test) || !test->width || !test->height)
        return gw_fail(error, GW_BAD_INPUT,
                       "a frame of %u x %u pixels has a picture of another size, or no pixels", test->width,
                       test->height);
    if (!(view->pixels_per_degree >= 1 && view->pixels_per_degree <= 1000))
        return gw_fail(error, GW_BAD_INPUT, "%g pixels per degree; metrics take 1 to 1000",
                       view->pixels_per_degree);
    return GW_OK;
}

/* The acuity filter needs a gaze. */
static int is_seen(const gw_metric_view *view) {
    return view->block && view->block->counts[0] > 0;
}

/* Both behind the viewers' acuity, into out[2]. */
static gw_code filter(const gw_metric_frame *reference, const gw_metric_frame *test,
                      const gw_metric_view *view, gw_image out[2], gw_error *error) {
    gw_code code = gw_acuity_filter(reference->picture, view->block, &out[0], error);
    return code ? code : gw_acuity_filter(test->picture, view->block, &out[1], error);
}

/* seen: both pictures behind the viewers' acuity, or NULL. */
static gw_code compare(const gw_metric_frame *reference, const gw_metric_frame *test,
                       const gw_metric_view *view, const gw_image *seen, gw_metrics *out, gw_error *error) {
    gw_metrics_clear(out);
    out->values[GW_METRIC_NOT_FINITE] = 0;
    gw_code code = gw_metric_geometry(reference, test, view, out, error);
    if (!code && reference->picture && test->picture) {
        gw_metric_codes(reference->picture, test->picture, out);
        code = gw_metric_ssim(reference->picture, test->picture, out, error);
        if (!code)
            code = gw_flip(reference->picture, test->picture, view->pixels_per_degree, NULL,
                           &out->values[GW_METRIC_FLIP], error);
    }
    if (!code && seen) {
        out->values[GW_METRIC_SEEN_PSNR] = gw_metric_decibels(gw_metric_rms(&seen[0], &seen[1], 3));
        code = gw_flip(&seen[0], &seen[1], view->pixels_per_degree, NULL, &out->values[GW_METRIC_SEEN_FLIP],
                       error);
    }
    if (!code && reference->light && test->light)
        gw_metric_light(reference->light, test->light, (size_t)test->width * test->height, out);
    return code;
}

static gw_code compare_as_seen(const gw_metric_frame *reference, const gw_metric_frame *test,
                               const gw_metric_view *view, gw_image seen[2], gw_metrics *out,
                               gw_error *error) {
    gw_code code = check(reference, test, view, error);
    const int filtered = is_seen(view) && reference->picture && test->picture;
    if (!code && filtered)
        code = filter(reference, test, view, seen, error);
    return code ? code : compare(reference, test, view, filtered ? seen : NULL, out, error);
}

gw_code gw_metrics_compare(const gw_metric_frame *reference, const gw_metric_frame *test,
                           const gw_metric_view *view, gw_metrics *out, gw_error *error) {
    gw_image seen[2] = {{0}, {0}};
    gw_code code = compare_as_seen(reference, test, view, seen, out, error);
    gw_image_finish(&seen[0]);
    gw_image_finish(&seen[1]);
    return code;
}

/* --- a track ---------------------------------------------------------------------------------------------
 */

static void sum_up(gw_metric_track *track, const gw_metrics *frame) {
    for (int i = 0; i < GW_METRIC_COUNT; ++i) {
        const double value = frame->values[i];
        if (isnan(value))
            continue;
        if (gw_metric_table[i].sum == GW_METRIC_SUM_WORST)
            track->sums[i] = fmax(track->sums[i], value);
        else if (i == GW_METRIC_SEEN_PSNR || (i >= GW_METRIC_PSNR && i <= GW_METRIC_PSNR_BLUE))
            track->sums[i] +=
                pow(10, -value / 10); /* of mean squares: one equal frame is not infinitely good */
        else
            track->sums[i] += value;
        track->measured[i]++;
    }
    track->frames++;
}

gw_code gw_metric_track_add(gw_metric_track *track, const gw_metric_frame *reference,
                            const gw_metric_frame *test, const gw_metric_view *view, gw_metrics *out,
                            gw_error *error) {
    gw_image seen[2] = {{0}, {0}};
    gw_metrics frame;
    gw_code code = compare_as_seen(reference, test, view, seen, &frame, error);
    if (!code && reference->picture && test->picture)
        code = gw_flicker_add(&track->plain, reference->picture, test->picture, error);
    if (!code && seen[0].rgba)
        code = gw_flicker_add(&track->seen, &seen[0], &seen[1], error);
    if (!code)
        sum_up(track, &frame);
    if (!code && out)
        *out = frame;
    gw_image_finish(&seen[0]);
    gw_image_finish(&seen[1]);
    return code;
}

void gw_metric_track_cut(gw_metric_track *track) {
    gw_flicker_cut(&track->plain);
    gw_flicker_cut(&track->seen);
}

void gw_metric_track_of(const gw_metric_track *track, gw_metrics *out) {
    gw_metrics_clear(out);
    for (int i = 0; i < GW_METRIC_COUNT; ++i) {
        if (!track->measured[i])
            continue;
        const double mean = track->sums[i] / track->measured[i];
        out->values[i] = gw_metric_table[i].sum == GW_METRIC_SUM_WORST ? track->sums[i]
                         : gw_metric_table[i].sense == GW_METRIC_DOWN && !is_similarity((gw_metric)i)
                             ? gw_metric_decibels(sqrt(mean))
                             : mean;
    }
    if (track->plain.error) {
        const gw_flicker_result plain = gw_flicker_of(&track->plain);
        out->values[GW_METRIC_FLICKER] = plain.mean;
        out->values[GW_METRIC_FLICKER_99] = plain.percentile;
        out->values[GW_METRIC_POP] = plain.pop;
    }
    if (track->seen.error) {
        const gw_flicker_result seen = gw_flicker_of(&track->seen);
        out->values[GW_METRIC_SEEN_FLICKER] = seen.mean;
        out->values[GW_METRIC_SEEN_POP] = seen.pop;
    }
}

void gw_metric_track_finish(gw_metric_track *track) {
    gw_flicker_finish(&track->plain);
    gw_flicker_finish(&track->seen);
    memset(track, 0, sizeof *track);
}
