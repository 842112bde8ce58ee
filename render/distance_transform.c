/* See distance_transform.h. The lower envelope of one parabola a marked pixel, along columns, then along
 * rows. */
#include "render/distance_transform.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Room for one line. */
typedef struct envelope {
    double *values;     /* of the line, before */
    double *borders;    /* where the parabola of `vertices` begins to be the lowest; one more than those */
    uint32_t *vertices; /* places of the parabolas, left to right */
} envelope;

/* Where the parabolas of places p < q meet. */
static double crossing(const double *values, uint32_t p, uint32_t q) {
    return ((values[q] + (double)q * q) - (values[p] + (double)p * p)) / (2.0 * ((double)q - p));
}

/* One line of `length` values that stand `stride` apart. */
static void transform_line(envelope *e, float *line, uint32_t length, size_t stride) {
    uint32_t count = 0;
    for (uint32_t q = 0; q < length; ++q) {
        e->values[q] = (double)line[q * stride];
        if (isinf(e->values[q]))
            continue;
        double border = -INFINITY;
        while (count > 0) {
            border = crossing(e->values, e->vertices[count - 1], q);
            if (border > e->borders[count - 1])
                break;
            --count;
            border = -INFINITY;
        }
        e->vertices[count] = q;
        e->borders[count++] = border;
    }
    for (uint32_t q = 0, k = 0; q < length && count > 0; ++q) {
        while (k + 1 < count && e->borders[k + 1] < q)
            ++k;
        const double away = (double)q - e->vertices[k];
        line[q * stride] = (float)(away * away + e->values[e->vertices[k]]);
    }
}

gw_code gw_distance_transform(const uint8_t *marked, uint32_t width, uint32_t height, float *squares,
                              gw_error *error) {
    const size_t longest = width > height ? width : height;
    envelope e = {0};
    gw_code code = gw_allocate((void **)&e.values, longest, sizeof *e.values, "distances", error);
    if (!code)
        code = gw_allocate((void **)&e.borders, longest, sizeof *e.borders, "distances", error);
    if (!code)
        code = gw_allocate((void **)&e.vertices, longest, sizeof *e.vertices, "distances", error);
    for (size_t i = 0; !code && i < (size_t)width * height; ++i)
        squares[i] = marked[i] ? 0 : INFINITY;
    for (uint32_t x = 0; !code && x < width; ++x)
        transform_line(&e, squares + x, height, width);
    for (uint32_t y = 0; !code && y < height; ++y)
        transform_line(&e, squares + (size_t)y * width, width, 1);
    free(e.values);
    free(e.borders);
    free(e.vertices);
    return code;
}
