#include "render/albedo_table.h"

#include "base/portable_math.h"

#include <math.h>
#include <stdint.h>

enum { SAMPLES = 160, SHEEN_STEPS = 24 };

static const double least_alpha = 2e-3, least_cosine = 1e-3, least_sheen = 0.1; /* as brdf.glsl has them */

/* The bits of i mirrored about the binary point (van der Corput). */
static double mirrored_bits(uint32_t i) {
    double value = 0.0, half = 0.5;
    for (; i > 0; i >>= 1, half *= 0.5)
        value += i & 1 ? half : 0.0;
    return value;
}

/* One of the normals that are seen from (sine, 0, cosine), by two numbers 0..1, the second as its cosine and
 * sine (Heitz, Sampling the GGX Distribution of Visible Normals, JCGT 7(4), 2018). */
static void visible_normal(double alpha, double cosine, double radius, const double angle[2], double out[3]) {
    const double sine = sqrt(1.0 - cosine * cosine);
    const double size = sqrt(alpha * alpha * sine * sine + cosine * cosine);
    const double x = alpha * sine / size, z = cosine / size;
    const double first = radius * angle[0], upper = sqrt(fmax(1.0 - first * first, 0.0));
    const double second = (0.5 - 0.5 * z) * upper + (0.5 + 0.5 * z) * radius * angle[1];
    const double third = sqrt(fmax(1.0 - first * first - second * second, 0.0));
    const double n[3] = {alpha * (third * x - second * z), alpha * first, fmax(second * x + third * z, 1e-9)};
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        out[i] = n[i] / length;
}

static double smith_lambda(double alpha, double cosine) {
    const double slope = (1.0 - cosine * cosine) / (cosine * cosine);
    return 0.5 * (sqrt(1.0 + alpha * alpha * slope) - 1.0);
}

static void integrate(double roughness, double view, const double angles[SAMPLES][2], float out[2]) {
    const double alpha = fmax(roughness * roughness, least_alpha), cosine = fmax(view, least_cosine);
    const double sine = sqrt(1.0 - cosine * cosine);
    double all = 0.0, edge = 0.0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        double normal[3];
        visible_normal(alpha, cosine, sqrt((i + 0.5) / SAMPLES), angles[i], normal);
        const double v_h = sine * normal[0] + cosine * normal[2];
        const double light = 2.0 * v_h * normal[2] - cosine;
        if (light <= 0.0)
            continue;
        const double masked = 1.0 + smith_lambda(alpha, cosine);
        const double weight = masked / (masked + smith_lambda(alpha, light));
        const double grazing = 1.0 - v_h, square = grazing * grazing;
        all += weight;
        edge += weight * square * square * grazing;
    }
    out[0] = (float)(all / SAMPLES);
    out[1] = (float)(edge / SAMPLES);
}

static double step(int i) {
    return i / (GW_ALBEDO_SIDE - 1.0);
}

void gw_albedo_table_fill(float table[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE][2]) {
    double angles[SAMPLES][2];
    for (uint32_t i = 0; i < SAMPLES; i++) {
        const double angle = 2.0 * GW_PI * mirrored_bits(i);
        angles[i][0] = gw_cos(angle);
        angles[i][1] = gw_sin(angle);
    }
    for (int r = 0; r < GW_ALBEDO_SIDE; r++)
        for (int c = 0; c < GW_ALBEDO_SIDE; c++)
            integrate(step(r), step(c) * step(c), (const double(*)[2])angles, table[r][c]);
}

/* x^y for 0 < x <= 1, by squaring and roots: y in 1/64. */
static double power(double x, double y) {
    const uint64_t steps = (uint64_t)(y * 64.0 + 0.5);
    double root = x, result = 1.0;
    for (int i = 0; i < 6; i++)
        root = sqrt(root);
    for (uint64_t bits = steps; bits > 0; bits >>= 1, root *= root)
        result *= bits & 1 ? root : 1.0;
    return result;
}

/* Light over the hemisphere; the half of it on one side of the plane of view counts twice. */
static float integrate_sheen(double roughness, double view) {
    const double r = fmax(roughness, least_sheen), inverse = 1.0 / (r * r), cosine = fmax(view, least_cosine);
    const double sine = sqrt(1.0 - cosine * cosine);
    double sum = 0.0;
    for (int i = 0; i < SHEEN_STEPS; i++) {
        const double at = (i + 0.5) / SHEEN_STEPS, light = at * at; /* finer towards grazing light */
        const double light_sine = sqrt(1.0 - light * light);
        for (int k = 0; k < SHEEN_STEPS; k++) {
            const double angle = GW_PI * (k + 0.5) / SHEEN_STEPS;
            const double x = sine + light_sine * gw_cos(angle), y = light_sine * gw_sin(angle),
                         z = cosine + light;
            const double sine_squared = (x * x + y * y) / (x * x + y * y + z * z);
            const double distribution = (2.0 + inverse) * power(sine_squared, 0.5 * inverse) / (2.0 * GW_PI);
            const double visibility = 0.25 / (light + cosine - light * cosine);
            sum += distribution * visibility * light * 2.0 * at; /* d light = 2 at d at */
        }
    }
    return (float)(sum * 2.0 * GW_PI / (SHEEN_STEPS * SHEEN_STEPS));
}

void gw_sheen_table_fill(float table[GW_ALBEDO_SIDE][GW_ALBEDO_SIDE]) {
    for (int r = 0; r < GW_ALBEDO_SIDE; r++)
        for (int c = 0; c < GW_ALBEDO_SIDE; c++)
            table[r][c] = integrate_sheen(step(r), step(c) * step(c));
}

GLuint gw_albedo_table_texture(GLenum format, GLenum layout, const void *texels) {
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, GW_ALBEDO_SIDE, GW_ALBEDO_SIDE);
    glTextureSubImage2D(texture, 0, 0, 0, GW_ALBEDO_SIDE, GW_ALBEDO_SIDE, layout, GL_FLOAT, texels);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}
