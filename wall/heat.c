#include "wall/heat.h"

#include "base/memory.h"
#include "render/flip.h"

#include <stdlib.h>

gw_code gw_heat_picture(const gw_image *reference, const gw_image *picture, double pixels_per_degree,
                        gw_image *out, double *mean, gw_error *error) {
    size_t pixels = (size_t)picture->width * picture->height;
    float *map = NULL;
    gw_code code = gw_allocate((void **)&map, pixels, sizeof *map, "differences", error);
    if (!code)
        code = gw_image_create(picture->width, picture->height, out, error);
    if (!code)
        code = gw_flip(reference, picture, pixels_per_degree, map, mean, error);
    for (size_t i = 0; i < pixels && !code; i++)
        gw_flip_color(map[i], out->rgba + i * 4);
    free(map);
    return code;
}
