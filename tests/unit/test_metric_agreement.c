/* The metrics against other people's programs, on a stored pair: 96 x 64 px of the demo scene, exact and
 * foveated. The values were taken with ffmpeg 5.1.7 (filters psnr and ssim on planes of RGB), ImageMagick
 * 6.9.11 (compare -metric PSNR, RMSE) and scikit-image 0.19.3 (structural_similarity with gaussian_weights,
 * sigma 1.5, data_range 255, without sample covariance: Wang et al.'s settings). tests/cli/compare.sh asks
 * the first two again where they are installed. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/image.h"
#include "render/metrics.h"

#include <math.h>

static gw_image pictures[2];
static gw_metrics metrics;

static int open_pair(void **state) {
    static const char *const files[2] = {"tests/data/pair_exact.png", "tests/data/pair_approximate.png"};
    (void)state;
    for (int i = 0; i < 2; ++i) {
        gw_bytes bytes = {0};
        check_ok(gw_file_read(files[i], 1 << 20, &bytes, &error));
        check_ok(gw_image_decode(bytes.data, bytes.size, files[i], 1 << 20, &pictures[i], &error));
        gw_bytes_finish(&bytes);
    }
    const gw_metric_frame reference = {pictures[0].width, pictures[0].height, .picture = &pictures[0]},
                          test = {pictures[1].width, pictures[1].height, .picture = &pictures[1]};
    const gw_metric_view view = {.pixels_per_degree = 67};
    check_ok(gw_metrics_compare(&reference, &test, &view, &metrics, &error));
    return 0;
}

static int close_pair(void **state) {
    (void)state;
    gw_image_finish(&pictures[0]);
    gw_image_finish(&pictures[1]);
    return 0;
}

static void agrees(gw_metric metric, double theirs, double within) {
    const double ours = metrics.values[metric];
    print_message("# %s: %.7f, theirs %.7f\n", gw_metric_table[metric].name, ours, theirs);
    assert_true(fabs(ours - theirs) < within);
}

static void psnr_is_that_of_ffmpeg_and_imagemagick(void **state) {
    (void)state;
    agrees(GW_METRIC_PSNR_RED, 23.136969, 1e-6);
    agrees(GW_METRIC_PSNR_GREEN, 23.512653, 1e-6);
    agrees(GW_METRIC_PSNR_BLUE, 23.038317, 1e-6);
    agrees(GW_METRIC_PSNR, 23.224550, 1e-6);
    agrees(GW_METRIC_PSNR, -20 * log10(0.0689878), 1e-5); /* ImageMagick's RMSE */
}

static void ssim_is_that_of_scikit_image(void **state) {
    (void)state;
    agrees(GW_METRIC_SSIM, 0.7578069462, 1e-9);
    agrees(GW_METRIC_SSIM_RED, 0.7706359703, 1e-9);
    agrees(GW_METRIC_SSIM_GREEN, 0.7492273501, 1e-9);
    agrees(GW_METRIC_SSIM_BLUE, 0.7528823772, 1e-9);
}

/* ffmpeg's filter is another SSIM: windows are boxes of 8 x 8 px that lie 4 px apart, and variances are those
 * of samples. Computed that way here, the same pair has its values; so what is left between the two is the
 * window. */
static double ssim_of_boxes(int channel) {
    const double c1 = 0.01 * 0.01 * 255 * 255 * 64, c2 = 0.03 * 0.03 * 255 * 255 * 64 * 63;
    const uint32_t width = pictures[0].width, height = pictures[0].height;
    double total = 0;
    for (uint32_t y = 0; y + 8 <= height; y += 4)
        for (uint32_t x = 0; x + 8 <= width; x += 4) {
            double a = 0, b = 0, squares = 0, products = 0;
            for (uint32_t i = 0; i < 64; ++i) {
                const size_t at = ((y + i / 8) * width + x + i % 8) * 4 + (size_t)channel;
                const double p = pictures[0].rgba[at], q = pictures[1].rgba[at];
                a += p;
                b += q;
                squares += p * p + q * q;
                products += p * q;
            }
            total += (2 * a * b + c1) * (2 * (products * 64 - a * b) + c2) /
                     ((a * a + b * b + c1) * (squares * 64 - a * a - b * b + c2));
        }
    return total / ((width / 4 - 1) * (height / 4 - 1));
}

static void ssim_in_boxes_is_that_of_ffmpeg(void **state) {
    static const double theirs[3] = {0.794429, 0.784970, 0.781905};
    (void)state;
    for (int c = 0; c < 3; ++c) {
        print_message("# channel %d: %.6f, theirs %.6f\n", c, ssim_of_boxes(c), theirs[c]);
        assert_true(fabs(ssim_of_boxes(c) - theirs[c]) < 2e-6);
        assert_true(fabs(metrics.values[GW_METRIC_SSIM_RED + c] - theirs[c]) < 0.05);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(psnr_is_that_of_ffmpeg_and_imagemagick),
                                       cmocka_unit_test(ssim_is_that_of_scikit_image),
                                       cmocka_unit_test(ssim_in_boxes_is_that_of_ffmpeg)};
    return cmocka_run_group_tests_name("metric_agreement", tests, open_pair, close_pair);
}
