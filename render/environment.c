/* See environment.h. */
#include "render/environment.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "build/gpu_types.h"
#include "shaders/common/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Parts of less variance of directions, (2 deg / 2)^2 / 2, are not cut further. */
static const double least_variance = 1.5e-4;

void gw_radiance_map_finish(gw_radiance_map *map) {
    free(map->texels);
    memset(map, 0, sizeof *map);
}

static void decode_texel(const uint8_t rgbe[4], float scale, float out[3]) {
    for (int c = 0; c < 3; ++c)
        out[c] = rgbe[3] ? fminf(scale * ldexpf((float)rgbe[c], rgbe[3] - 136), 1e30f) : 0.0f;
}

/* In proportion to the solid angle of its texels. */
static double row_angle(uint32_t row, uint32_t rows) {
    return gw_sin(GW_PI * ((double)row + 0.5) / (double)rows);
}

gw_code gw_radiance_map_decode(const gw_environment *environment, uint32_t most_width, gw_radiance_map *out,
                               gw_error *error) {
    const uint32_t width = environment->rgbe.width, height = environment->rgbe.height;
    uint32_t step = 1;
    memset(out, 0, sizeof *out);
    while (width / step > most_width && height / step > 1)
        step *= 2;
    const uint32_t wide = width / step, high = height / step;
    gw_code code = gw_allocate((void **)&out->texels, (size_t)wide * high, 3 * sizeof(float),
                               "the environment's radiance", error);
    if (code)
        return code;
    out->width = wide;
    out->height = high;
    for (uint32_t y = 0; y < high; ++y)
        for (uint32_t x = 0; x < wide; ++x) {
            double sum[3] = {0}, whole = 0.0;
            for (uint32_t i = 0; i < step * step; ++i) {
                const uint32_t row = y * step + i / step;
                const double angle = step > 1 ? row_angle(row, height) : 1.0;
                float texel[3];
                decode_texel(environment->rgbe.rgba + 4 * ((size_t)row * width + x * step + i % step),
                             environment->scale, texel);
                for (int c = 0; c < 3; ++c)
                    sum[c] += angle * (double)texel[c];
                whole += angle;
            }
            for (int c = 0; c < 3; ++c)
                out->texels[3 * ((size_t)y * wide + x) + (size_t)c] = (float)(sum[c] / whole);
        }
    return GW_OK;
}

void gw_radiance_map_halve(gw_radiance_map *map) {
    const uint32_t wide = map->width > 1 ? map->width / 2 : 1, high = map->height > 1 ? map->height / 2 : 1;
    const uint32_t across = map->width > 1 ? 2 : 1, down = map->height > 1 ? 2 : 1;
    for (uint32_t y = 0; y < high; ++y) {
        const double upper = row_angle(down * y, map->height),
                     lower = row_angle(down * y + down - 1, map->height);
        const double share = lower / (upper + lower); /* of the lower row */
        for (uint32_t x = 0; x < wide; ++x) {
            const float *row = map->texels + 3 * ((size_t)down * y * map->width + across * x),
                        *below = row + (down - 1) * 3 * (size_t)map->width;
            for (size_t c = 0; c < 3; ++c) {
                const size_t right = c + 3 * (size_t)(across - 1);
                const double of_row = 0.5 * ((double)row[c] + (double)row[right]),
                             of_below = 0.5 * ((double)below[c] + (double)below[right]);
                map->texels[3 * ((size_t)y * wide + x) + c] = (float)(of_row + share * (of_below - of_row));
            }
        }
    }
    map->width = wide;
    map->height = high;
}

/* Sines and cosines of the middles of rows and columns, and the solid angle of a texel of each row. */
typedef struct grid {
    double *height, *level, *angle; /* by row: y, length across, steradians */
    double *right, *back;           /* by column: x and z where level is 1 */
} grid;

static gw_code make_grid(const gw_radiance_map *map, double rotation, grid *out, gw_error *error) {
    double *memory = NULL;
    const size_t rows = map->height, columns = map->width;
    gw_code code = gw_allocate((void **)&memory, 3 * rows + 2 * columns, sizeof(double), "directions", error);
    *out = (grid){memory, memory + rows, memory + 2 * rows, memory + 3 * rows, memory + 3 * rows + columns};
    for (size_t y = 0; !code && y < rows; ++y) {
        const double above = GW_PI * (double)y / (double)rows, half = 0.5 * GW_PI / (double)rows;
        out->height[y] = gw_cos(above + half);
        out->level[y] = gw_sin(above + half);
        out->angle[y] = (gw_cos(above) - gw_cos(above + 2.0 * half)) * 2.0 * GW_PI / (double)columns;
    }
    for (size_t x = 0; !code && x < columns; ++x) {
        const double turn = 2.0 * GW_PI * ((double)x + 0.5) / (double)columns - GW_PI + rotation;
        out->right[x] = gw_sin(turn);
        out->back[x] = -gw_cos(turn);
    }
    return code;
}

static void direction_of(const grid *g, size_t x, size_t y, double out[3]) {
    out[0] = g->right[x] * g->level[y];
    out[1] = g->height[y];
    out[2] = g->back[x] * g->level[y];
}

static double luminance(const double rgb[3]) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

void gw_radiance_map_mean(const gw_radiance_map *map, double mean[3]) {
    const double half = 0.5 * GW_PI / map->height;
    double whole = 0.0;
    mean[0] = mean[1] = mean[2] = 0.0;
    for (uint32_t y = 0; y < map->height; ++y) {
        const double angle = gw_cos(2.0 * half * y) - gw_cos(2.0 * half * (y + 1));
        for (uint32_t x = 0; x < map->width; ++x)
            for (size_t c = 0; c < 3; ++c)
                mean[c] += angle * (double)map->texels[3 * ((size_t)y * map->width + x) + c];
        whole += angle * map->width;
    }
    for (int c = 0; c < 3; ++c)
        mean[c] /= whole;
}

void gw_radiance_map_irradiance(const gw_radiance_map *map, double rotation, const double normal[3],
                                double irradiance[3]) {
    const double half = 0.5 * GW_PI / map->height;
    irradiance[0] = irradiance[1] = irradiance[2] = 0.0;
    for (uint32_t y = 0; y < map->height; ++y) {
        const double above = 2.0 * half * y, across = gw_sin(above + half);
        const double angle = (gw_cos(above) - gw_cos(above + 2.0 * half)) * 2.0 * GW_PI / map->width;
        for (uint32_t x = 0; x < map->width; ++x) {
            const double turn = 2.0 * GW_PI * (x + 0.5) / map->width - GW_PI + rotation;
            const double cosine = normal[0] * across * gw_sin(turn) + normal[1] * gw_cos(above + half) -
                                  normal[2] * across * gw_cos(turn);
            for (size_t c = 0; c < 3 && cosine > 0.0; ++c)
                irradiance[c] += cosine * angle * (double)map->texels[3 * ((size_t)y * map->width + x) + c];
        }
    }
}

/* --- lights --- */

/* Power (luminance times solid angle) and its sum over directions. |direction| is 1, so the power times the
 * variance of directions is power - |moment|^2 / power. */
typedef struct bundle {
    double power, moment[3];
} bundle;

typedef struct part {
    uint32_t x[2], y[2]; /* first, past the last */
    bundle light;
} part;

static double spread_of(const bundle *b) {
    const double *m = b->moment;
    return b->power > 0.0 ? fmax(b->power - (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]) / b->power, 0.0) : 0.0;
}

static void add(bundle *to, const bundle *from, double sign) {
    to->power += sign * from->power;
    for (int i = 0; i < 3; ++i)
        to->moment[i] += sign * from->moment[i];
}

/* A row or column of a part. */
static bundle line_of(const double *power, uint32_t width, const grid *g, const part *p, int axis,
                      uint32_t at) {
    bundle sum = {0};
    const uint32_t *other = axis ? p->x : p->y;
    for (uint32_t i = other[0]; i < other[1]; ++i) {
        const uint32_t x = axis ? i : at, y = axis ? at : i;
        const double here = power[(size_t)y * width + x];
        double direction[3];
        if (here <= 0.0)
            continue;
        direction_of(g, x, y, direction);
        const bundle one = {here, {here * direction[0], here * direction[1], here * direction[2]}};
        add(&sum, &one, 1.0);
    }
    return sum;
}

/* Cuts the part where the sum of both spreads is least; 0 where no cut lowers it. */
static int cut_part(const double *power, uint32_t width, const grid *g, part *p, part *second) {
    double least = spread_of(&p->light) * (1.0 - 1e-9);
    int found = 0;
    part best[2] = {*p, *p};
    for (int axis = 0; axis < 2; ++axis) {
        const uint32_t *range = axis ? p->y : p->x;
        bundle before = {0};
        for (uint32_t at = range[0]; at + 1 < range[1]; ++at) {
            const bundle line = line_of(power, width, g, p, axis, at);
            bundle after = p->light;
            add(&before, &line, 1.0);
            add(&after, &before, -1.0);
            const double sum = spread_of(&before) + spread_of(&after);
            if (line.power <= 0.0 || sum >= least)
                continue;
            least = sum;
            found = 1;
            best[0] = best[1] = *p;
            (axis ? best[0].y : best[0].x)[1] = (axis ? best[1].y : best[1].x)[0] = at + 1;
        }
    }
    if (!found)
        return 0;
    for (int k = 0; k < 2; ++k) { /* summed anew: differences lose small parts */
        best[k].light = (bundle){0};
        for (uint32_t x = best[k].x[0]; x < best[k].x[1]; ++x) {
            const bundle line = line_of(power, width, g, &best[k], 0, x);
            add(&best[k].light, &line, 1.0);
        }
    }
    *p = best[0];
    *second = best[1];
    return 1;
}

static uint32_t cut_parts(const double *power, const gw_radiance_map *map, const grid *g, uint32_t most,
                          part parts[GW_MAXIMUM_ENVIRONMENT_LIGHTS]) {
    uint32_t count = 1;
    int closed[GW_MAXIMUM_ENVIRONMENT_LIGHTS] = {0};
    parts[0] = (part){.x = {0, map->width}, .y = {0, map->height}};
    for (uint32_t x = 0; x < map->width; ++x) {
        const bundle line = line_of(power, map->width, g, &parts[0], 0, x);
        add(&parts[0].light, &line, 1.0);
    }
    while (count < most) {
        uint32_t widest = count;
        for (uint32_t i = 0; i < count; ++i)
            if (!closed[i] && spread_of(&parts[i].light) > least_variance * parts[i].light.power &&
                (widest == count || spread_of(&parts[i].light) > spread_of(&parts[widest].light)))
                widest = i;
        if (widest == count)
            break;
        if (cut_part(power, map->width, g, &parts[widest], &parts[count]))
            ++count;
        else
            closed[widest] = 1;
    }
    return count;
}

/* What stands out of the mean is moved from the map to `power`, its luminance times solid angle, and
 * `excess`. */
static void take_excess(gw_radiance_map *map, const grid *g, double *power, float *excess) {
    double mean[3];
    gw_radiance_map_mean(map, mean);
    const double kept = GW_ENVIRONMENT_EXCESS * luminance(mean);
    for (size_t i = 0; i < (size_t)map->width * map->height; ++i) {
        float *texel = map->texels + 3 * i;
        const double rgb[3] = {(double)texel[0], (double)texel[1], (double)texel[2]}, light = luminance(rgb);
        const double share = light > kept ? 1.0 - kept / light : 0.0;
        for (size_t c = 0; c < 3; ++c) {
            excess[3 * i + c] = (float)(share * rgb[c]);
            texel[c] -= excess[3 * i + c];
        }
        power[i] = share * light * g->angle[i / map->width];
    }
}

static void make_light(const part *p, const float *excess, const gw_radiance_map *map, const grid *g,
                       gw_light *out) {
    double sum[3] = {0}, texel = 0.0; /* steradians, mean by power */
    const double *m = p->light.moment;
    const double size = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
    *out = (gw_light){.kind = GW_LIGHT_DIRECTIONAL};
    for (uint32_t y = p->y[0]; y < p->y[1]; ++y)
        for (uint32_t x = p->x[0]; x < p->x[1]; ++x) {
            const float *rgb = excess + 3 * ((size_t)y * map->width + x);
            const double here[3] = {g->angle[y] * (double)rgb[0], g->angle[y] * (double)rgb[1],
                                    g->angle[y] * (double)rgb[2]};
            for (int c = 0; c < 3; ++c)
                sum[c] += here[c];
            texel += g->angle[y] * luminance(here) / p->light.power;
        }
    /* Directions over a disc of half-angle a have a variance of a^2 / 2; so has a texel about its middle. */
    const double variance = spread_of(&p->light) / p->light.power,
                 half_angle = fmin(sqrt(2.0 * variance + texel / GW_PI), 1.2);
    for (int i = 0; i < 3; ++i) {
        out->vector[i] = -m[i] / size;
        out->color[i] = (float)(sum[i] * 0.5 * (1.0 + gw_cos(half_angle))); /* on a surface that faces it */
    }
    out->extent = (float)half_angle;
}

gw_code gw_environment_cut(gw_radiance_map *map, double rotation, uint32_t most_lights,
                           gw_light lights[GW_MAXIMUM_ENVIRONMENT_LIGHTS], uint32_t *count, gw_error *error) {
    const size_t texels = (size_t)map->width * map->height;
    part parts[GW_MAXIMUM_ENVIRONMENT_LIGHTS];
    double *power = NULL;
    float *excess = NULL;
    grid g = {0};
    *count = 0;
    if (most_lights == 0)
        return GW_OK;
    if (most_lights > GW_MAXIMUM_ENVIRONMENT_LIGHTS)
        most_lights = GW_MAXIMUM_ENVIRONMENT_LIGHTS;
    gw_code code = make_grid(map, rotation, &g, error);
    if (!code)
        code = gw_allocate((void **)&power, texels, sizeof *power, "the environment's lights", error);
    if (!code)
        code = gw_allocate((void **)&excess, texels, 3 * sizeof *excess, "the environment's lights", error);
    if (!code) {
        take_excess(map, &g, power, excess);
        const uint32_t found = cut_parts(power, map, &g, most_lights, parts);
        for (uint32_t i = 0; i < found; ++i)
            if (parts[i].light.power > 0.0)
                make_light(&parts[i], excess, map, &g, &lights[(*count)++]);
    }
    free(g.height);
    free(power);
    free(excess);
    return code;
}

/* --- blurred --- */

static const double roughnesses[GW_ENVIRONMENT_LAYERS - 1] = {0.4, 0.6, 0.8, 1.0};

/* Weights of a direction whose cosine to the axis is `cosine`: of each lobe, and of the irradiance. GGX is
 * taken with the surface seen along its normal (Karis, Real Shading in Unreal Engine 4, 2013). */
static void weights_of(double cosine, double weights[GW_ENVIRONMENT_LAYERS]) {
    const double half_squared = 0.5 + 0.5 * cosine;
    for (int layer = 0; layer < GW_ENVIRONMENT_LAYERS - 1; ++layer) {
        const double a = roughnesses[layer] * roughnesses[layer];
        const double spread = half_squared * (a * a - 1.0) + 1.0;
        weights[layer] = cosine / (spread * spread);
    }
    weights[GW_ENVIRONMENT_LAYERS - 1] = cosine;
}

static void blur_texel(const gw_radiance_map *map, const grid *g, const double axis[3], float *out,
                       size_t layer_floats) {
    double sums[GW_ENVIRONMENT_LAYERS][4] = {{0}};
    for (size_t y = 0; y < map->height; ++y)
        for (size_t x = 0; x < map->width; ++x) {
            const float *texel = map->texels + 3 * (y * map->width + x);
            double direction[3], weights[GW_ENVIRONMENT_LAYERS];
            direction_of(g, x, y, direction);
            const double cosine = axis[0] * direction[0] + axis[1] * direction[1] + axis[2] * direction[2];
            if (cosine <= 0.0)
                continue;
            weights_of(cosine, weights);
            for (int layer = 0; layer < GW_ENVIRONMENT_LAYERS; ++layer) {
                const double weight = weights[layer] * g->angle[y];
                for (int c = 0; c < 3; ++c)
                    sums[layer][c] += weight * (double)texel[c];
                sums[layer][3] += weight;
            }
        }
    for (size_t layer = 0; layer < GW_ENVIRONMENT_LAYERS; ++layer)
        for (size_t c = 0; c < 3; ++c)
            out[layer * layer_floats + c] = (float)fmin(sums[layer][c] / sums[layer][3], 1e30);
}

gw_code gw_environment_blur(const gw_radiance_map *map, float *texels, gw_error *error) {
    const gw_radiance_map target = {.width = GW_ENVIRONMENT_WIDTH, .height = GW_ENVIRONMENT_WIDTH / 2};
    const size_t layer_floats = (size_t)target.width * target.height * 4;
    gw_radiance_map small = {0};
    grid from = {0}, to = {0};
    gw_code code = gw_allocate((void **)&small.texels, (size_t)map->width * map->height, 3 * sizeof(float),
                               "the blurred environment", error);
    if (!code) {
        memcpy(small.texels, map->texels, (size_t)map->width * map->height * 3 * sizeof(float));
        small.width = map->width;
        small.height = map->height;
        while (small.width > GW_ENVIRONMENT_WIDTH)
            gw_radiance_map_halve(&small);
        code = make_grid(&small, 0.0, &from, error);
    }
    if (!code)
        code = make_grid(&target, 0.0, &to, error);
    for (size_t y = 0; !code && y < target.height; ++y)
        for (size_t x = 0; x < target.width; ++x) {
            double axis[3];
            direction_of(&to, x, y, axis);
            blur_texel(&small, &from, axis, texels + 4 * (y * target.width + x), layer_floats);
        }
    free(from.height);
    free(to.height);
    gw_radiance_map_finish(&small);
    return code;
}
