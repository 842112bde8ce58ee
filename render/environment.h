/* Pictures of all directions as light: radiance by direction, the brightest of it as lights that cast
 * shadows, and the rest blurred for surfaces. Host only, the same bits on every machine; any thread.
 *
 * Pictures are equirectangular: rows from straight up (y) to straight down, columns turn to the right, the
 * middle one looks along -z. */
#ifndef GW_RENDER_ENVIRONMENT_H
#define GW_RENDER_ENVIRONMENT_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

enum { GW_MAXIMUM_ENVIRONMENT_LIGHTS = 64 };
/* What is that many times as bright as the mean over all directions casts shadows, above that. */
#define GW_ENVIRONMENT_EXCESS 3.0

/* Linear radiance, width = 2 height, 3 floats a texel; owned. */
typedef struct gw_radiance_map {
    uint32_t width, height;
    float *texels;
} gw_radiance_map;

/* The picture, each side halved as often as it is wider than most_width. */
gw_code gw_radiance_map_decode(const gw_environment *environment, uint32_t most_width, gw_radiance_map *out,
                               gw_error *error);
/* Each texel the mean of four, by solid angle; of odd sides the last row or column is left out. Sides stay at
 * least 1. */
void gw_radiance_map_halve(gw_radiance_map *map);
void gw_radiance_map_finish(gw_radiance_map *map);

/* Mean over the sphere. */
void gw_radiance_map_mean(const gw_radiance_map *map, double mean[3]);
/* Irradiance on a surface with this unit normal, by all texels. */
void gw_radiance_map_irradiance(const gw_radiance_map *map, double rotation, const double normal[3],
                                double irradiance[3]);

/* A light of GW_LIGHT_DIRECTIONAL with an extent for each of at most most_lights (0 to
 * GW_MAXIMUM_ENVIRONMENT_LIGHTS) compact parts of what is above GW_ENVIRONMENT_EXCESS times the mean; what
 * they give is taken out of the map, so light is neither lost nor made. Parts: what is left over is cut along
 * rows or columns where that lowers the variance of directions most (after Viriyothai and Debevec,
 * Variance Minimization Light Probe Sampling, 2009), always the part with the most, until there are
 * most_lights or all are narrower than two degrees. Only parts with light are told. */
gw_code gw_environment_cut(gw_radiance_map *map, double rotation, uint32_t most_lights,
                           gw_light lights[GW_MAXIMUM_ENVIRONMENT_LIGHTS], uint32_t *count, gw_error *error);

/* Layers of GW_ENVIRONMENT_WIDTH x half as many texels: the mean radiance over the lobe of GGX of roughness
 * 0.4, 0.6, 0.8 and 1 seen along its axis, and the irradiance over pi. texels:
 * [GW_ENVIRONMENT_LAYERS][h][w][4]. */
gw_code gw_environment_blur(const gw_radiance_map *map, float *texels, gw_error *error);

#endif
