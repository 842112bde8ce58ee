#include "build/tangent.h"

#include "build/gpu_types.h"
#include "build/matrix.h"

#include <math.h>

static const double largest = (double)GW_TANGENT_LARGEST;

static uint32_t code_of(double coordinate) {
    return (uint32_t)floor((coordinate + 1.0) * largest + 0.5);
}

static double fold(double of, double other) {
    return (1.0 - fabs(other)) * (of >= 0.0 ? 1.0 : -1.0);
}

uint32_t gw_tangent_pack(const double direction[3], double side) {
    const double sum = fabs(direction[0]) + fabs(direction[1]) + fabs(direction[2]);
    if (!(sum > 0.0) || !isfinite(sum) || !(side > 0.0 || side < 0.0))
        return 0;
    double x = direction[0] / sum, y = direction[1] / sum;
    if (direction[2] < 0.0) {
        const double folded = fold(x, y);
        y = fold(y, x);
        x = folded;
    }
    return GW_TANGENT_GIVEN | (side < 0.0 ? GW_TANGENT_LEFT : 0u) | code_of(x) |
           code_of(y) << GW_TANGENT_BITS;
}

int gw_tangent_unpack(uint32_t word, double direction[3]) {
    const uint32_t mask = (1u << GW_TANGENT_BITS) - 1u;
    if (!(word & GW_TANGENT_GIVEN))
        return 0;
    double x = (word & mask) / largest - 1.0, y = (word >> GW_TANGENT_BITS & mask) / largest - 1.0;
    const double z = 1.0 - fabs(x) - fabs(y);
    if (z < 0.0) {
        const double unfolded = fold(x, y);
        y = fold(y, x);
        x = unfolded;
    }
    const double length = sqrt(x * x + y * y + z * z);
    direction[0] = x / length;
    direction[1] = y / length;
    direction[2] = z / length;
    return word & GW_TANGENT_LEFT ? -1 : 1;
}

uint32_t gw_tangent_transform(const double m[3][4], uint32_t word) {
    double from[3], to[3];
    const int side = gw_tangent_unpack(word, from);
    if (!side)
        return 0;
    for (int i = 0; i < 3; i++)
        to[i] = m[i][0] * from[0] + m[i][1] * from[1] + m[i][2] * from[2];
    return gw_tangent_pack(to, gw_matrix_determinant(m) < 0.0 ? -side : side);
}
