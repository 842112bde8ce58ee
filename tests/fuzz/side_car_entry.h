/* What a fuzzer and the unit test do with the bytes of a picture's side-car: read it by way of a file, check
 * what came out. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_SIDE_CAR_ENTRY_H
#define GW_TESTS_FUZZ_SIDE_CAR_ENTRY_H

#include "wall/side_car.h"

#include <stdio.h>
#include <stdlib.h>

static inline void fuzz_side_car_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_side_car(const uint8_t *data, size_t size, const char *path) {
    static gw_side_car side_car;
    gw_error error = {0};
    FILE *file = fopen(path, "we");
    fuzz_side_car_require(file != NULL && fwrite(data, 1, size, file) == size && fclose(file) == 0);
    gw_code code = gw_side_car_read(path, &side_car, &error);
    fuzz_side_car_require(code == GW_OK || error.text[0] != '\0');
    const gw_layout *layout = &side_car.site.layout;
    for (uint32_t i = 0; code == GW_OK && i < layout->tile_count; i++) {
        const gw_tile *tile = &layout->tiles[i];
        fuzz_side_car_require(tile->picture[0] + tile->rectangle.width <= layout->picture[0] &&
                              tile->framed[1] + tile->rectangle.height <= layout->framed[1] &&
                              tile->rectangle.width >= 1 && tile->rectangle.height >= 1);
    }
    fuzz_side_car_require(code != GW_OK ||
                          (layout->tile_count >= 1 && layout->tile_count <= GW_MAXIMUM_TILES));
    gw_side_car_finish(&side_car);
}

#endif
