#include "build/specular_glossiness.h"

#include "base/srgb.h"

#include <math.h>
#include <string.h>

static const float dielectric = 0.04f, least = 1e-6f;

static float brightness(const float color[3]) {
    return sqrtf(0.299f * color[0] * color[0] + 0.587f * color[1] * color[1] + 0.114f * color[2] * color[2]);
}

static float solve_metalness(float diffuse, float specular, float not_reflected) {
    if (specular < dielectric)
        return 0.0f;
    const float a = dielectric;
    const float b = diffuse * not_reflected / (1.0f - dielectric) + specular - 2.0f * dielectric;
    const float c = dielectric - specular;
    const float root = sqrtf(fmaxf(b * b - 4.0f * a * c, 0.0f));
    return fminf(fmaxf((root - b) / (2.0f * a), 0.0f), 1.0f);
}

float gw_specular_to_metal(const float diffuse[3], const float specular[3], float base[3]) {
    const float not_reflected = 1.0f - fmaxf(fmaxf(specular[0], specular[1]), specular[2]);
    const float metalness = solve_metalness(brightness(diffuse), brightness(specular), not_reflected);
    for (int i = 0; i < 3; i++) {
        const float of_diffuse =
            diffuse[i] * not_reflected / ((1.0f - dielectric) * fmaxf(1.0f - metalness, least));
        const float of_specular = (specular[i] - dielectric * (1.0f - metalness)) / fmaxf(metalness, least);
        const float share = metalness * metalness;
        base[i] = fminf(fmaxf(of_diffuse + share * (of_specular - of_diffuse), 0.0f), 1.0f);
    }
    return metalness;
}

static uint8_t byte_of(double value) {
    return (uint8_t)lround(fmin(fmax(value, 0.0), 1.0) * 255.0);
}

/* The nearest pixel of a picture to (x, y) of one of another size; white where there is none. */
static void fetch(const gw_image *image, uint32_t x, uint32_t y, const gw_image *size, uint8_t out[4]) {
    memset(out, 255, 4);
    if (!image)
        return;
    const uint64_t column = (uint64_t)x * image->width / size->width;
    const uint64_t row = (uint64_t)y * image->height / size->height;
    memcpy(out, image->rgba + (row * image->width + column) * 4, 4);
}

gw_code gw_specular_pictures(const gw_image *diffuse, const float diffuse_factor[3], const gw_image *specular,
                             const float factor[4], gw_image *base, gw_image *metallic_roughness,
                             gw_error *error) {
    const gw_image *size = diffuse ? diffuse : specular;
    float decode[256];
    for (int i = 0; i < 256; i++)
        decode[i] = (float)gw_srgb_code_to_linear((uint8_t)i);
    gw_code code = gw_image_create(size->width, size->height, base, error);
    if (code == GW_OK)
        code = gw_image_create(size->width, size->height, metallic_roughness, error);
    for (uint32_t y = 0; code == GW_OK && y < size->height; y++)
        for (uint32_t x = 0; x < size->width; x++) {
            const size_t at = ((size_t)y * size->width + x) * 4;
            uint8_t d[4], s[4];
            float diffuse_color[3], specular_color[3], color[3];
            fetch(diffuse, x, y, size, d);
            fetch(specular, x, y, size, s);
            for (int i = 0; i < 3; i++) {
                diffuse_color[i] = decode[d[i]] * diffuse_factor[i];
                specular_color[i] = decode[s[i]] * factor[i];
            }
            const float metalness = gw_specular_to_metal(diffuse_color, specular_color, color);
            for (int i = 0; i < 3; i++)
                base->rgba[at + (size_t)i] = gw_srgb_code_from_linear((double)color[i]);
            base->rgba[at + 3] = d[3];
            const double roughness = 1.0 - (double)s[3] / 255.0 * (double)factor[3];
            const uint8_t finish[4] = {255, byte_of(roughness), byte_of((double)metalness), 255};
            memcpy(metallic_roughness->rgba + at, finish, sizeof finish);
        }
    return code;
}
