/* A scene, its octree and a renderer for tests of pictures and rays, and cameras for them. One thread. */
#ifndef GW_TESTS_SUPPORT_RENDERS_H
#define GW_TESTS_SUPPORT_RENDERS_H

#include "base/gl.h"
#include "build/octree.h"
#include "build/scene.h"
#include "render/renderer.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_stage {
    gw_gl *device;
    gw_scene *scene; /* owned by the stage once opened */
    gw_octree *octree;
    gw_settings settings;
} gw_stage;

/* Takes the scene, also when it fails. assignments are "name=value" settings, ended by NULL; shader_folder
 * may be NULL. */
gw_code gw_stage_open(gw_stage *stage, gw_scene *scene, const char *shader_folder,
                      const char *const *assignments, gw_error *error);
void gw_stage_close(gw_stage *stage);

/* A square virtual wall of pixels looking from eye to target (scene metres, 1 m = 1000 mm of wall). */
typedef struct gw_camera {
    gw_similarity placement;
    gw_plane plane;
    gw_frame_state state; /* the stage's settings, the eye, no gaze */
    uint32_t side;        /* px */
} gw_camera;
void gw_camera_look(gw_camera *camera, const gw_stage *stage, const double eye[3], const double target[3],
                    double fov_degrees, uint32_t side);
/* From the eye through the middle of a pixel, unit. */
void gw_camera_ray(const gw_camera *camera, uint32_t x, uint32_t y, double direction[3]);
/* Gives the camera's first viewer a gaze at the pixel, with these half-angles. */
void gw_camera_gaze(gw_camera *camera, double pixel_x, double pixel_y, double half_degrees);

/* Renders the whole square; rgba has side * side * 4 bytes. */
gw_code gw_camera_picture(const gw_camera *camera, gw_renderer *renderer, uint8_t *rgba,
                          gw_counters *counters, gw_error *error);

/* The same for tests that end when it fails: a picture to be freed, a renderer to be destroyed. */
uint8_t *gw_camera_take(const gw_camera *camera, gw_renderer *renderer, gw_counters *counters);
gw_renderer *gw_stage_renderer(const gw_stage *stage);
/* With options, which may be NULL. */
gw_renderer *gw_stage_renderer_with(const gw_stage *stage, const gw_renderer_options *options);
/* A picture by a renderer of its own. */
uint8_t *gw_stage_take(const gw_stage *stage, const gw_camera *camera, const gw_renderer_options *options,
                       gw_counters *counters);

/* The embedded shaders in a folder of this name, "#define NAME 1" before one of them ("blend/opacity.glsl"):
 * naive variants for tests that show why the shipped one is another. Returns path, the folder. */
const char *gw_naive_shaders(char path[512], const char *folder, const char *file, const char *define);

/* A sky of radiance 0.5 over a ground of 0.25, and a sun at 45 degrees to the right (+x), 1.4 degrees wide.
 */
void gw_give_sky(gw_scene *scene, int with_sun);
/* What the sun gives a floor. */
double gw_sky_irradiance_of_sun(void);

/* Leaves of every texture a corner of at most this side, px: making the levels of large ones takes a second
 * for each renderer. */
void gw_crop_textures(gw_scene *scene, uint32_t side);

/* Mean over pixels and channels of the difference, in 1/255. */
double gw_mean_difference(const uint8_t *a, const uint8_t *b, size_t pixels);
/* Mean linear value of the colour channels, 0..1. */
double gw_mean_linear(const uint8_t *rgba, size_t pixels);

#endif
