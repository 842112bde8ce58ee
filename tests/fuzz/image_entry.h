/* What a fuzzer and the unit test do with the bytes of a PNG or JPEG picture. Aborts when an invariant does
 * not hold. */
#ifndef GW_TESTS_FUZZ_IMAGE_ENTRY_H
#define GW_TESTS_FUZZ_IMAGE_ENTRY_H

#include "base/image.h"

#include <stdint.h>
#include <stdlib.h>

static inline void fuzz_image_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_image(const uint8_t *data, size_t size) {
    enum { MOST_PIXELS = 1 << 16 };
    gw_image image = {0};
    gw_error error = {0};
    gw_code code = gw_image_decode(data, size, "fuzz", MOST_PIXELS, &image, &error);
    fuzz_image_require((code == GW_OK) == (error.text[0] == '\0'));
    fuzz_image_require((code == GW_OK) == (image.rgba != NULL));
    if (code == GW_OK) {
        const uint64_t pixels = (uint64_t)image.width * image.height;
        unsigned sum = 0;
        fuzz_image_require(pixels >= 1 && pixels <= MOST_PIXELS);
        for (uint64_t i = 0; i < 4 * pixels; i++)
            sum += image.rgba[i];
        fuzz_image_require(sum <= 4 * 255 * pixels);
    }
    gw_image_finish(&image);
}

#endif
