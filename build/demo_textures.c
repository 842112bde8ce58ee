/* Textures of the demo scene, painted texel by texel in sRGB-encoded values, so that no power function is
 * needed. Each painter gives the colour at (x, y), 0..1 across the picture, y downwards; all but leaf and
 * landscape repeat. */
#include "base/portable_math.h"
#include "build/demo_parts.h"

#include <math.h>
#include <stdio.h>

typedef struct paint {
    double r, g, b; /* 0..1, sRGB-encoded */
} paint;

static paint mix(paint a, paint b, double t) {
    return (paint){a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}

static paint times(paint a, double factor) {
    return (paint){a.r * factor, a.g * factor, a.b * factor};
}

static double fraction(double x) {
    return x - floor(x);
}

/* Thin dark or light lines where warped noise crosses its middle: marble's veins. 0..1. */
static double veins(double x, double y, uint32_t period, uint32_t seed) {
    double warp = demo_fractal(x, y, period, 4, seed);
    double n = demo_fractal(x + 0.9 * warp, y - 0.7 * warp, period, 4, seed + 40) - 0.5;
    double distance = n < 0.0 ? -n : n;
    return demo_smooth(0.05, 0.0, distance);
}

/* Distance to the border of a tile whose own coordinates are s, t in 0..1. */
static double to_border(double s, double t) {
    double a = s < 1.0 - s ? s : 1.0 - s, b = t < 1.0 - t ? t : 1.0 - t;
    return a < b ? a : b;
}

/* Two by two slabs, chequered, with a small lozenge where four corners meet. */
static paint paint_floor(double x, double y) {
    double s = fraction(2.0 * x), t = fraction(2.0 * y);
    uint32_t tile = (uint32_t)(2.0 * x) + 2u * (uint32_t)(2.0 * y);
    int dark = tile == 1 || tile == 2;
    double vein = veins(8.0 * x, 8.0 * y, 8, 100 + 7 * tile),
           cloud = demo_fractal(6.0 * x, 6.0 * y, 6, 4, 11 + tile);
    paint stone = dark ? mix((paint){0.27, 0.17, 0.14}, (paint){0.40, 0.24, 0.18}, cloud)
                       : mix((paint){0.80, 0.76, 0.68}, (paint){0.90, 0.87, 0.80}, cloud);
    stone = mix(stone, dark ? (paint){0.66, 0.55, 0.47} : (paint){0.56, 0.50, 0.44}, 0.55 * vein);
    double corner = (s < 0.5 ? s : 1.0 - s) + (t < 0.5 ? t : 1.0 - t);
    if (corner < 0.16)
        stone = mix((paint){0.20, 0.30, 0.30}, (paint){0.30, 0.42, 0.40}, cloud);
    double joint = demo_smooth(0.006, 0.003, to_border(s, t)) * (corner < 0.16 ? 0.0 : 1.0);
    joint = fmax(joint, demo_smooth(0.006, 0.003, fabs(corner - 0.16)));
    return mix(stone, (paint){0.42, 0.38, 0.33}, 0.8 * joint);
}

/* Limestone blocks in four courses. */
static paint paint_ashlar(double x, double y) {
    double course = floor(4.0 * y), t = fraction(4.0 * y);
    double shifted = fraction(x + 0.25 * (course - 2.0 * floor(course / 2.0)));
    double s = fraction(2.0 * shifted),
           border = fmin(0.5 * (s < 0.5 ? s : 1.0 - s), 0.25 * (t < 0.5 ? t : 1.0 - t));
    uint32_t block = (uint32_t)course * 2u + (uint32_t)(2.0 * shifted);
    double tone = demo_hash(block, 3, 9) * (1.0 / 4294967296.0);
    double grain = demo_fractal(24.0 * x, 24.0 * y, 24, 5, 21),
           stain = demo_fractal(4.0 * x, 4.0 * y, 4, 4, 31);
    paint stone = mix((paint){0.76, 0.68, 0.55}, (paint){0.84, 0.77, 0.64}, tone);
    stone = times(stone, 0.86 + 0.2 * grain);
    stone = mix(stone, (paint){0.66, 0.57, 0.44}, 0.5 * demo_smooth(0.5, 0.75, stain));
    return mix(stone, (paint){0.55, 0.48, 0.38}, 0.75 * demo_smooth(0.006, 0.002, border));
}

static paint paint_plaster(double x, double y) {
    double grain = demo_fractal(32.0 * x, 32.0 * y, 32, 5, 51),
           cloud = demo_fractal(3.0 * x, 3.0 * y, 3, 5, 61);
    paint wall = mix((paint){0.80, 0.55, 0.39}, (paint){0.90, 0.69, 0.51}, cloud);
    double crack = veins(5.0 * x, 5.0 * y, 5, 71) * demo_smooth(0.45, 0.6, cloud);
    return times(mix(wall, (paint){0.60, 0.40, 0.29}, 0.35 * crack), 0.9 + 0.14 * grain);
}

static paint paint_marble(double x, double y) {
    double cloud = demo_fractal(4.0 * x, 4.0 * y, 4, 5, 81),
           fine = demo_fractal(40.0 * x, 40.0 * y, 40, 3, 83);
    paint stone = mix((paint){0.84, 0.82, 0.78}, (paint){0.95, 0.94, 0.91}, cloud);
    stone = mix(stone, (paint){0.60, 0.60, 0.61}, 0.5 * veins(5.0 * x, 5.0 * y, 5, 85));
    stone = mix(stone, (paint){0.78, 0.70, 0.58}, 0.35 * veins(3.0 * x, 3.0 * y, 3, 95));
    return times(stone, 0.95 + 0.06 * fine);
}

/* Night blue with a gilded rosette of eight petals and a beaded frame. */
static paint paint_vault(double x, double y) {
    double dx = 2.0 * x - 1.0, dy = 2.0 * y - 1.0, r = sqrt(dx * dx + dy * dy), turn = gw_atan2(dy, dx);
    double cloud = demo_fractal(8.0 * x, 8.0 * y, 8, 4, 111);
    paint blue = mix((paint){0.10, 0.17, 0.38}, (paint){0.16, 0.27, 0.52}, cloud);
    paint gold = times((paint){0.86, 0.66, 0.30}, 0.85 + 0.3 * demo_fractal(30.0 * x, 30.0 * y, 30, 3, 121));
    double petal = 0.34 + 0.24 * gw_cos(8.0 * turn), inner = 0.17 + 0.06 * gw_cos(8.0 * turn + GW_PI);
    double cover =
        demo_smooth(petal + 0.012, petal - 0.012, r) * demo_smooth(inner - 0.012, inner + 0.012, r);
    cover = fmax(cover, demo_smooth(0.11, 0.09, r));
    double border = to_border(x, y);
    cover = fmax(cover, demo_smooth(0.05, 0.044, border) * demo_smooth(0.02, 0.026, border));
    double bx = fraction(24.0 * x) - 0.5, by = fraction(24.0 * y) - 0.5;
    if (border > 1.0 / 24.0 + 0.012 && border < 2.0 / 24.0 + 0.002)
        cover = fmax(cover, demo_smooth(0.38, 0.3, sqrt(bx * bx + by * by)));
    double sx = fraction(6.0 * x) - 0.5, sy = fraction(6.0 * y) - 0.5; /* small stars between */
    if (r > 0.66 && border > 0.1)
        cover = fmax(cover, demo_smooth(0.022, 0.012, fabs(sx * sy) + 0.02 * (sx * sx + sy * sy)) *
                                demo_smooth(0.3, 0.2, sqrt(sx * sx + sy * sy)));
    return mix(blue, gold, cover);
}

static paint paint_wood(double x, double y) {
    double board = floor(4.0 * y), t = fraction(4.0 * y);
    uint32_t b = (uint32_t)board;
    double rings = demo_fractal(3.0 * x, 24.0 * y, 24, 4, 131 + b) * 9.0 +
                   0.4 * demo_fractal(6.0 * x, 96.0 * y, 96, 2, 141);
    double grain = 0.5 + 0.5 * gw_sin(2.0 * GW_PI * rings);
    double tone = demo_hash(b, 1, 5) * (1.0 / 4294967296.0);
    paint wood = mix((paint){0.36, 0.22, 0.12}, (paint){0.52, 0.34, 0.19}, 0.35 * tone + 0.65 * grain);
    return mix(wood, (paint){0.12, 0.07, 0.04}, demo_smooth(0.03, 0.01, t < 0.5 ? t : 1.0 - t));
}

/* A runner: deep red, a golden border along both edges, lozenges and small blossoms; threads show from near.
 * The wall sees x from -0.5 to 0.5 of the picture's repeat, so the middle of the runner is at x = 0. */
static paint paint_carpet(double x, double y) {
    double across = x < 0.5 ? x : 1.0 - x; /* 0 in the middle, 0.5 at the edge */
    paint red = {0.50, 0.07, 0.09}, dark = {0.30, 0.03, 0.07}, gold = {0.83, 0.63, 0.29},
          blue = {0.12, 0.17, 0.36};
    double lozenge = fabs(fraction(2.0 * y) - 0.5) * 0.6 + across;
    paint cloth = lozenge < 0.24 ? dark : red;
    double ring = fmin(fabs(lozenge - 0.24), fabs(lozenge - 0.17));
    cloth = mix(cloth, gold, demo_smooth(0.012, 0.008, ring));
    double bx = across, by = (fraction(2.0 * y) - 0.5) * 0.5, r = sqrt(bx * bx + by * by),
           turn = gw_atan2(by, bx);
    double petal = 0.062 + 0.03 * gw_cos(6.0 * turn);
    cloth = mix(cloth, gold, demo_smooth(petal + 0.004, petal - 0.004, r));
    cloth = mix(cloth, blue, demo_smooth(0.026, 0.02, r));
    double small = fraction(16.0 * y) - 0.5, edge = (across - 0.435) * 16.0;
    if (across > 0.39) {
        cloth = across < 0.405 || across > 0.465 ? gold : blue;
        cloth = mix(cloth, gold, demo_smooth(0.34, 0.28, fabs(small) + fabs(edge)));
        cloth = across > 0.485 ? dark : cloth;
    }
    double thread = 0.5 + 0.25 * gw_sin(2.0 * GW_PI * 128.0 * x) + 0.25 * gw_sin(2.0 * GW_PI * 128.0 * y);
    return times(cloth, 0.78 + 0.22 * thread + 0.15 * (demo_fractal(16.0 * x, 16.0 * y, 16, 4, 151) - 0.5));
}

/* Clouded evening sky, brighter towards the horizon. */
static paint paint_sky(double x, double y) {
    double cloud = demo_fractal(5.0 * x + 1.0, 14.0 * y, 64, 6, 161);
    paint sky = mix((paint){0.36, 0.56, 0.84}, (paint){0.98, 0.90, 0.76}, demo_smooth(0.05, 0.66, y));
    return mix(sky, (paint){1.0, 0.97, 0.92}, 0.85 * demo_smooth(0.5, 0.72, cloud));
}

/* Four ridges of hills, the nearer the greener, with trees and meadows; y = 0.67 is the eye's height. */
static paint paint_landscape(double x, double y) {
    static const paint tones[4] = {
        {0.60, 0.69, 0.80}, {0.44, 0.57, 0.62}, {0.33, 0.48, 0.38}, {0.20, 0.34, 0.14}};
    static const paint meadows[4] = {
        {0.66, 0.74, 0.80}, {0.54, 0.66, 0.58}, {0.55, 0.63, 0.36}, {0.62, 0.62, 0.26}};
    static const double heights[4] = {0.12, 0.10, 0.09, 0.08};
    for (int i = 3; i >= 0; i--) {
        double highest = 0.60 + 0.075 * i - heights[i];
        if (y < highest - 0.01)
            continue;
        double ridge =
            highest + heights[i] * (1.0 - demo_fractal((3.0 + i) * x, 0.5, 64, 5, 171 + 10 * (uint32_t)i));
        double grain = 40.0 + 30.0 * i, leafy = demo_fractal(grain * x, grain * y, 256, 3, 211 + (uint32_t)i);
        if (y < ridge - 0.006 * i * leafy)
            continue;
        double field = demo_fractal(9.0 * x, 26.0 * y, 64, 3, 231 + (uint32_t)i);
        paint land =
            mix(tones[i], meadows[i], demo_smooth(0.5, 0.58, field) * demo_smooth(ridge, ridge + 0.03, y));
        return times(land, 1.0 + 0.16 * i * (leafy - 0.55));
    }
    return paint_sky(x, y);
}

static paint paint_pedestal(double x, double y) {
    double cloud = demo_fractal(5.0 * x, 5.0 * y, 5, 5, 221);
    paint stone = mix((paint){0.07, 0.16, 0.14}, (paint){0.16, 0.32, 0.27}, cloud);
    stone = mix(stone, (paint){0.62, 0.74, 0.66}, 0.6 * veins(6.0 * x, 6.0 * y, 6, 231));
    return mix(stone, (paint){0.34, 0.45, 0.38}, 0.4 * veins(14.0 * x, 14.0 * y, 14, 241));
}

/* Fired clay with a scratched wave and pale bloom. */
static paint paint_terracotta(double x, double y) {
    double cloud = demo_fractal(6.0 * x, 6.0 * y, 6, 5, 251),
           grain = demo_fractal(64.0 * x, 64.0 * y, 64, 3, 255);
    paint clay = mix((paint){0.66, 0.32, 0.19}, (paint){0.80, 0.45, 0.29}, cloud);
    clay = mix(clay, (paint){0.86, 0.72, 0.62},
               0.4 * demo_smooth(0.55, 0.75, demo_fractal(3.0 * x, 3.0 * y, 3, 4, 261)));
    double wave = fabs(fraction(y) - 0.5 - 0.1 * gw_sin(2.0 * GW_PI * 4.0 * x));
    clay = mix(clay, (paint){0.45, 0.20, 0.12}, 0.7 * demo_smooth(0.022, 0.014, wave));
    return times(clay, 0.85 + 0.2 * grain);
}

/* A leaf from stalk (y = 1) to tip (y = 0): midrib, side veins that run forward, paler towards the rim. */
static paint paint_leaf(double x, double y) {
    double across = fabs(2.0 * x - 1.0), along = 1.0 - y;
    double grain = demo_fractal(24.0 * x, 24.0 * y, 24, 4, 271);
    paint green = mix((paint){0.17, 0.38, 0.09}, (paint){0.34, 0.56, 0.14}, 0.6 * grain + 0.4 * across);
    double vein = fabs(fraction(9.0 * (along - 0.35 * across)) - 0.5);
    green = mix(green, (paint){0.52, 0.68, 0.28},
                0.55 * demo_smooth(0.12, 0.05, vein) * demo_smooth(0.95, 0.5, across));
    return mix(green, (paint){0.66, 0.77, 0.38}, 0.8 * demo_smooth(0.08, 0.03, across));
}

static const struct {
    const char *name;
    uint32_t width, height;
    gw_wrap wrap;
    paint (*painter)(double x, double y);
} recipes[DEMO_TEXTURES] = {
    [DEMO_TEXTURE_FLOOR] = {"floor", 1024, 1024, GW_WRAP_REPEAT, paint_floor},
    [DEMO_TEXTURE_ASHLAR] = {"ashlar", 512, 512, GW_WRAP_REPEAT, paint_ashlar},
    [DEMO_TEXTURE_PLASTER] = {"plaster", 512, 512, GW_WRAP_REPEAT, paint_plaster},
    [DEMO_TEXTURE_MARBLE] = {"marble", 512, 512, GW_WRAP_REPEAT, paint_marble},
    [DEMO_TEXTURE_VAULT] = {"vault", 512, 512, GW_WRAP_REPEAT, paint_vault},
    [DEMO_TEXTURE_WOOD] = {"wood", 512, 512, GW_WRAP_REPEAT, paint_wood},
    [DEMO_TEXTURE_CARPET] = {"carpet", 1024, 1024, GW_WRAP_REPEAT, paint_carpet},
    [DEMO_TEXTURE_LANDSCAPE] = {"landscape", 1024, 512, GW_WRAP_CLAMP, paint_landscape},
    [DEMO_TEXTURE_PEDESTAL] = {"pedestal", 512, 512, GW_WRAP_REPEAT, paint_pedestal},
    [DEMO_TEXTURE_TERRACOTTA] = {"terracotta", 512, 512, GW_WRAP_REPEAT, paint_terracotta},
    [DEMO_TEXTURE_LEAF] = {"leaf", 256, 256, GW_WRAP_CLAMP, paint_leaf},
};

static uint8_t quantise(double value) {
    return (uint8_t)(demo_clamp(value, 0.0, 1.0) * 255.0 + 0.5);
}

gw_code demo_make_texture(int index, gw_texture *out, gw_error *error) {
    gw_code code = gw_image_create(recipes[index].width, recipes[index].height, &out->image, error);
    if (code != GW_OK)
        return code;
    snprintf(out->name, sizeof out->name, "%s", recipes[index].name);
    out->wrap_u = out->wrap_v = recipes[index].wrap;
    uint8_t *texel = out->image.rgba;
    for (uint32_t y = 0; y < out->image.height; y++)
        for (uint32_t x = 0; x < out->image.width; x++, texel += 4) {
            paint color = recipes[index].painter((x + 0.5) / out->image.width, (y + 0.5) / out->image.height);
            texel[0] = quantise(color.r);
            texel[1] = quantise(color.g);
            texel[2] = quantise(color.b);
            texel[3] = 255;
        }
    return GW_OK;
}
