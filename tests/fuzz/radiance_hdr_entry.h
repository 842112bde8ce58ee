/* What a fuzzer and the unit test do with the bytes of a Radiance picture: decode them, check what came out.
 * Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_RADIANCE_HDR_ENTRY_H
#define GW_TESTS_FUZZ_RADIANCE_HDR_ENTRY_H

#include "build/radiance_hdr.h"

#include <stdlib.h>

static inline void fuzz_radiance_hdr_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_radiance_hdr(const uint8_t *data, size_t size) {
    gw_image image;
    gw_error error = {0};
    double exposure = 0.0;
    unsigned sum = 0;
    gw_code code = gw_hdr_decode(data, size, &image, &exposure, &error);
    fuzz_radiance_hdr_require(code == GW_OK ? image.rgba && image.width >= 1 && image.height >= 1 &&
                                                  image.width <= GW_HDR_MAXIMUM_SIDE &&
                                                  image.height <= GW_HDR_MAXIMUM_SIDE && exposure > 0.0
                                            : !image.rgba && error.text[0] != '\0');
    for (size_t i = 0; code == GW_OK && i < (size_t)image.width * image.height * 4; i++)
        sum += image.rgba[i];
    fuzz_radiance_hdr_require(sum < ~0u);
    gw_image_finish(&image);
}

#endif
