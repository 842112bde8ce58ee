#include "build/scene_outliers.h"

#include "base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DIGIT_BITS = 16, DIGITS = 1 << DIGIT_BITS };

typedef struct search {
    gw_scene *scene;
    const double *world;
    double *values;    /* [triangle_count] */
    size_t *histogram; /* [DIGITS] */
    double middle[3];
} search;

/* Doubles in the order of unsigned integers. */
static uint64_t ordered_bits(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & UINT64_C(1) << 63 ? ~bits : bits | UINT64_C(1) << 63;
}

static double value_of_bits(uint64_t ordered) {
    uint64_t bits = ordered & UINT64_C(1) << 63 ? ordered & ~(UINT64_C(1) << 63) : ~ordered;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The value that stands at `rank` among the values in rising order: radix selection, highest digit first. */
static double select_rank(const search *self, size_t rank) {
    uint64_t prefix = 0, mask = 0;
    for (int shift = 64 - DIGIT_BITS; shift >= 0; shift -= DIGIT_BITS) {
        size_t digit = 0;
        memset(self->histogram, 0, DIGITS * sizeof *self->histogram);
        for (uint32_t t = 0; t < self->scene->triangle_count; t++) {
            const uint64_t bits = ordered_bits(self->values[t]);
            if ((bits & mask) == prefix)
                self->histogram[bits >> shift & (DIGITS - 1)]++;
        }
        while (rank >= self->histogram[digit])
            rank -= self->histogram[digit++];
        prefix |= (uint64_t)digit << shift;
        mask |= (uint64_t)(DIGITS - 1) << shift;
    }
    return value_of_bits(prefix);
}

static const double *corner(const search *self, uint32_t triangle, int k) {
    return self->world + (size_t)self->scene->triangles[triangle][k] * 3;
}

static void find_middle(search *self) {
    const uint32_t count = self->scene->triangle_count;
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t t = 0; t < count; t++) {
            const double a = corner(self, t, 0)[axis], b = corner(self, t, 1)[axis],
                         c = corner(self, t, 2)[axis];
            /* Halves first, so that nothing overflows; + 0.0: no negative zero. */
            self->values[t] = 0.5 * fmin(a, fmin(b, c)) + 0.5 * fmax(a, fmax(b, c)) + 0.0;
        }
        self->middle[axis] = select_rank(self, count / 2);
    }
}

/* How far triangles reach from the middle; infinity where the difference overflows. */
static void measure_reach(search *self) {
    for (uint32_t t = 0; t < self->scene->triangle_count; t++) {
        double reach = 0.0;
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                reach = fmax(reach, fabs(corner(self, t, k)[axis] - self->middle[axis]));
        self->values[t] = reach;
    }
}

static gw_code drop_beyond(search *self, double limit, double extent, gw_error *error) {
    gw_scene *scene = self->scene;
    uint32_t kept = 0;
    double farthest = 0.0;
    for (uint32_t t = 0; t < scene->triangle_count; t++) {
        if (self->values[t] > limit) {
            farthest = fmax(farthest, self->values[t]);
            continue;
        }
        memmove(scene->triangles[kept], scene->triangles[t], sizeof *scene->triangles);
        scene->material_of[kept++] = scene->material_of[t];
    }
    const uint32_t dropped = scene->triangle_count - kept;
    scene->dropped.outlier += dropped;
    scene->triangle_count = kept;
    if (dropped == 0)
        return GW_OK;
    return gw_scene_note(scene, error,
                         "%" PRIu32 " triangle%s up to %.3g m away from a scene of about %.3g m %s dropped: "
                         "with %s the rest would be a point (--set outlier_extents=0 keeps all)",
                         dropped, dropped == 1 ? "" : "s", farthest, 2.0 * extent,
                         dropped == 1 ? "is" : "are", dropped == 1 ? "it" : "them");
}

gw_code gw_scene_drop_outliers(gw_scene *scene, const double *world, gw_error *error) {
    search self = {.scene = scene, .world = world};
    const size_t count = scene->triangle_count;
    if (scene->outlier_extents <= 0.0)
        return GW_OK;
    gw_code code =
        gw_allocate((void **)&self.values, count, sizeof *self.values, "triangle distances", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self.histogram, DIGITS, sizeof *self.histogram, "triangle distances",
                           error);
    if (code == GW_OK) {
        find_middle(&self);
        measure_reach(&self);
        const double extent = select_rank(&self, (count * 7 + 7) / 8 - 1);
        code = drop_beyond(&self, extent * scene->outlier_extents, extent, error);
    }
    free(self.values);
    free(self.histogram);
    return code;
}
