/* See renders.h. */
#include "tests/support/renders.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/image.h"
#include "base/srgb.h"
#include "tests/support/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

gw_code gw_stage_open(gw_stage *stage, gw_scene *scene, const char *shader_folder,
                      const char *const *assignments, gw_error *error) {
    memset(stage, 0, sizeof *stage);
    stage->scene = scene;
    gw_settings_init(&stage->settings);
    gw_code code = GW_OK;
    for (; !code && assignments && *assignments; ++assignments)
        code = gw_settings_assign(&stage->settings, *assignments, error);
    gw_gl_options gl = {.shader_folder = shader_folder};
    if (!code)
        code = gw_gl_create(&gl, &stage->device, error);
    gw_octree_options options = {.settings = &stage->settings};
    if (!code)
        code = gw_octree_build(stage->device, scene, &options, &stage->octree, error);
    if (code)
        gw_stage_close(stage);
    return code;
}

void gw_stage_close(gw_stage *stage) {
    gw_octree_destroy(&stage->octree);
    gw_scene_destroy(&stage->scene);
    gw_gl_destroy(&stage->device);
}

static void normalise(double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; ++i)
        v[i] /= length;
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void gw_camera_look(gw_camera *camera, const gw_stage *stage, const double eye[3], const double target[3],
                    double fov_degrees, uint32_t side) {
    memset(camera, 0, sizeof *camera);
    camera->side = side;
    camera->placement.scale = 1000.0;
    for (int i = 0; i < 3; ++i)
        camera->placement.rotation[i][i] = 1.0;
    double forward[3], right[3], up[3];
    for (int i = 0; i < 3; ++i)
        forward[i] = target[i] - eye[i];
    normalise(forward);
    double helper[3] = {0.0, fabs(forward[1]) < 0.9 ? 1.0 : 0.0, fabs(forward[1]) < 0.9 ? 0.0 : 1.0};
    cross(forward, helper, right);
    normalise(right);
    cross(right, forward, up);
    double half = tan(fov_degrees / 360.0 * 3.14159265358979) * 1000.0, pitch = 2.0 * half / side;
    for (int i = 0; i < 3; ++i) {
        camera->state.eye[i] = eye[i] * 1000.0;
        camera->plane.corner[i] = eye[i] * 1000.0 + forward[i] * 1000.0 - right[i] * half + up[i] * half;
        camera->plane.step_x[i] = right[i] * pitch;
        camera->plane.step_y[i] = -up[i] * pitch;
    }
    gw_frame_state_apply(&camera->state, &stage->settings);
}

void gw_camera_ray(const gw_camera *camera, uint32_t x, uint32_t y, double direction[3]) {
    for (int i = 0; i < 3; ++i)
        direction[i] = camera->plane.corner[i] + (x + 0.5) * camera->plane.step_x[i] +
                       (y + 0.5) * camera->plane.step_y[i] - camera->state.eye[i];
    normalise(direction);
}

void gw_camera_gaze(gw_camera *camera, double pixel_x, double pixel_y, double half_degrees) {
    gw_gaze *gaze = &camera->state.gazes[0];
    double direction[3];
    for (int i = 0; i < 3; ++i) {
        direction[i] = camera->plane.corner[i] + pixel_x * camera->plane.step_x[i] +
                       pixel_y * camera->plane.step_y[i] - camera->state.eye[i];
        gaze->eye[i] = (float)camera->state.eye[i];
        gaze->up[i] = (float)-camera->plane.step_y[i];
    }
    normalise(direction);
    for (int i = 0; i < 3; ++i)
        gaze->direction[i] = (float)direction[i];
    gaze->half_width = gaze->half_height = (float)half_degrees;
    gaze->confidence = 1.0f;
    camera->state.gaze_count = 1;
}

gw_code gw_camera_picture(const gw_camera *camera, gw_renderer *renderer, uint8_t *rgba,
                          gw_counters *counters, gw_error *error) {
    gw_rectangle all = {0, 0, camera->side, camera->side};
    return gw_renderer_frame(renderer, &camera->placement, &camera->plane, &all, &camera->state, rgba,
                             counters, error);
}

static void must(gw_code code, const gw_error *error) {
    if (code == GW_OK)
        return;
    fprintf(stderr, "%s\n", error->text);
    abort();
}

uint8_t *gw_camera_take(const gw_camera *camera, gw_renderer *renderer, gw_counters *counters) {
    gw_error error = {0};
    uint8_t *rgba = calloc((size_t)camera->side * camera->side, 4);
    must(rgba ? GW_OK : gw_fail(&error, GW_MACHINE, "no memory for a picture"), &error);
    must(gw_camera_picture(camera, renderer, rgba, counters, &error), &error);
    return rgba;
}

gw_renderer *gw_stage_renderer_with(const gw_stage *stage, const gw_renderer_options *options) {
    gw_error error = {0};
    gw_renderer *renderer = NULL;
    must(gw_renderer_create(stage->device, stage->scene, stage->octree, options, &renderer, &error), &error);
    return renderer;
}

gw_renderer *gw_stage_renderer(const gw_stage *stage) {
    return gw_stage_renderer_with(stage, NULL);
}

uint8_t *gw_stage_take(const gw_stage *stage, const gw_camera *camera, const gw_renderer_options *options,
                       gw_counters *counters) {
    gw_renderer *renderer = gw_stage_renderer_with(stage, options);
    uint8_t *rgba = gw_camera_take(camera, renderer, counters);
    gw_renderer_destroy(&renderer);
    return rgba;
}

const char *gw_naive_shaders(char path[512], const char *folder, const char *file, const char *define) {
    char line[64], name[128];
    size_t line_size = (size_t)snprintf(line, sizeof line, "#define %s 1\n", define);
    snprintf(name, sizeof name, "shaders/%s", file);
    scratch_path(path, folder);
    for (size_t i = 0; i < gw_embedded_count; ++i) {
        const gw_embedded_file *embedded = &gw_embedded_files[i];
        if (strncmp(embedded->name, "shaders/", 8))
            continue;
        char *target = gw_path_join(path, embedded->name + 8), *parent = gw_path_folder(target);
        size_t extra = strcmp(embedded->name, name) ? 0 : line_size;
        char *text = malloc(embedded->size + extra + 1);
        assert_non_null(text);
        memcpy(text, line, extra);
        memcpy(text + extra, embedded->data, embedded->size);
        check_ok(gw_make_directories(parent, &error));
        check_ok(gw_file_write(target, text, embedded->size + extra, &error));
        free(text);
        free(target);
        free(parent);
    }
    return path;
}

enum { SKY_WIDE = 256, SKY_HIGH = 128, SUN_X = 192, SUN_Y = 32 };

void gw_give_sky(gw_scene *scene, int with_sun) {
    gw_image *image = &scene->environment.rgbe;
    gw_error error = {0};
    must(gw_image_create(SKY_WIDE, SKY_HIGH, image, &error), &error);
    for (int i = 0; i < SKY_WIDE * SKY_HIGH; ++i)
        memcpy(image->rgba + 4 * i, i < SKY_WIDE * SKY_HIGH / 2 ? "\x80\x80\x80\x80" : "\x40\x40\x40\x80", 4);
    if (with_sun)
        memcpy(image->rgba + 4 * (SUN_Y * SKY_WIDE + SUN_X), "\x80\x80\x80\x8c", 4); /* 2048 */
    scene->environment.scale = 1.0f;
}

double gw_sky_irradiance_of_sun(void) {
    const double pi = 3.14159265358979, row = pi / SKY_HIGH;
    const double texel = (cos(row * SUN_Y) - cos(row * (SUN_Y + 1))) * 2 * pi / SKY_WIDE;
    return 2048.0 * texel * cos(row * (SUN_Y + 0.5));
}

void gw_crop_textures(gw_scene *scene, uint32_t side) {
    for (uint32_t i = 0; i < scene->texture_count; ++i) {
        gw_image *image = &scene->textures[i].image;
        const uint32_t width = image->width < side ? image->width : side;
        const uint32_t height = image->height < side ? image->height : side;
        for (size_t y = 0; y < height; ++y)
            memmove(image->rgba + y * width * 4, image->rgba + y * image->width * 4, (size_t)width * 4);
        image->width = width;
        image->height = height;
    }
}

double gw_mean_difference(const uint8_t *a, const uint8_t *b, size_t pixels) {
    double sum = 0.0;
    for (size_t i = 0; i < pixels * 4; ++i)
        sum += abs(a[i] - b[i]);
    return sum / (double)(pixels * 3);
}

double gw_mean_linear(const uint8_t *rgba, size_t pixels) {
    double sum = 0.0;
    for (size_t i = 0; i < pixels; ++i)
        for (int c = 0; c < 3; ++c)
            sum += gw_srgb_code_to_linear(rgba[i * 4 + (size_t)c]);
    return sum / (double)(pixels * 3);
}
