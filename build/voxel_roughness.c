#include "build/voxel_roughness.h"

#include <math.h>

enum { MOST_SAMPLES = 256 }; /* along a side of a map */

/* Length of the mean of a map's normals, with their sideways part scaled. Square roots and quotients of
 * doubles are rounded in one way only, and the order is fixed. */
static double mean_length(const gw_image *image, double scale) {
    const uint32_t step_x = (image->width + MOST_SAMPLES - 1) / MOST_SAMPLES;
    const uint32_t step_y = (image->height + MOST_SAMPLES - 1) / MOST_SAMPLES;
    double sum[3] = {0, 0, 0}, count = 0;
    for (uint32_t y = step_y / 2; y < image->height; y += step_y)
        for (uint32_t x = step_x / 2; x < image->width; x += step_x) {
            const uint8_t *texel = image->rgba + ((uint64_t)y * image->width + x) * 4;
            double n[3], square = 0;
            for (int c = 0; c < 3; c++) {
                n[c] = texel[c] / 127.5 - 1.0;
                n[c] = c == 2 ? fmax(n[c], 1e-3) : n[c] * scale;
                square += n[c] * n[c];
            }
            for (int c = 0; c < 3; c++)
                sum[c] += n[c] / sqrt(square);
            count++;
        }
    return count > 0 ? sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / count : 1.0;
}

float gw_voxel_roughness(const gw_scene *scene, uint32_t material) {
    const float roughness = scene->materials[material].roughness;
    const gw_material_extension *extension = scene->extensions ? &scene->extensions[material] : NULL;
    if (!extension || extension->normal.texture < 0)
        return roughness;
    const double length =
        mean_length(&scene->textures[extension->normal.texture].image, (double)extension->normal_scale);
    /* As widened_roughness() of shaders/shade/brdf.glsl. */
    const double square = (double)roughness * roughness * roughness * roughness;
    const double more = 2.0 * (1.0 - square) * (1.0 - length) / fmax(length, 1e-3);
    return (float)sqrt(sqrt((square + fmax(more, 0.0)) / (1.0 + fmax(more, 0.0))));
}
