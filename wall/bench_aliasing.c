/* `gazewall bench aliasing`: what Weier et al. 2014 show in their Figure 5 and do not measure. A scene seen
 * whole in a small picture, so that most triangles are smaller than a pixel, from a camera that moves by a
 * fraction of a pixel a frame: triangles only, voxels only and both by footprint, one ray a pixel, against 64
 * rays a pixel: how wrong each frame is, and how much it flickers where the reference does not. */
#include "wall/bench.h"

#include "base/memory.h"
#include "base/portable_math.h"
#include "base/srgb.h"
#include "build/import.h"
#include "render/flicker.h"
#include "render/flip.h"
#include "render/vector3.h"
#include "wall/bench_view.h"
#include "wall/city.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REFERENCE_RAYS = 64, WIDTH = 300, HEIGHT = 200 /* px, as the figure's */ };

typedef enum way { WAY_TRIANGLES, WAY_VOXELS, WAY_HYBRID, WAYS } way;
static const char *const way_names[WAYS] = {"triangles", "voxels", "hybrid"};

typedef struct outcome {
    double rms; /* linear light; mean over frames of the frame's root mean square */
    double flip, voxel_share;
    gw_flicker flicker;
    gw_flicker_result flickers;
    gw_counters counters;
} outcome;

typedef struct aliasing {
    gw_bench *bench;
    gw_scene *scene;
    gw_octree *octree;
    gw_renderer *renderer;
    uint32_t size[2], frames;
    double radius, away; /* m: of the scene; of the camera from its middle */
    gw_image reference, picture;
    outcome outcomes[WAYS];
} aliasing;

/* The camera stands 35 degrees above the scene, on a circle round its middle. */
static const double fov = 40, elevation = 35, first_angle = 0.6; /* deg; rad */

static gw_code camera_at(const aliasing *a, double angle, double away, gw_perspective *out, gw_error *error) {
    static const double up[3] = {0, 1, 0};
    const double height = elevation * GW_PI / 180;
    const double direction[3] = {sin(angle) * cos(height), sin(height), cos(angle) * cos(height)};
    double centre[3], eye[3];
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * (a->scene->bounds[0][k] + a->scene->bounds[1][k]);
        eye[k] = centre[k] + away * direction[k];
    }
    return gw_perspective_of(eye, centre, up, fov, a->size, out, error);
}

/* Whether every corner of the scene's box is in the picture. */
static int sees_all(const aliasing *a, const gw_perspective *camera) {
    for (int corner = 0; corner < 8; corner++) {
        double along[3], forward[3], x = 0, y = 0, pitch = gw_dot(camera->plane.step_x, camera->plane.step_x);
        for (int k = 0; k < 3; k++) {
            along[k] = 1000 * a->scene->bounds[corner >> k & 1][k] - camera->eye[k];
            forward[k] = camera->centre[k] - camera->eye[k];
        }
        double depth = gw_dot(along, forward) / gw_dot(forward, forward);
        x = gw_dot(along, camera->plane.step_x) / (depth * pitch);
        y = gw_dot(along, camera->plane.step_y) / (depth * pitch);
        if (!(depth > 0) || fabs(x) > 0.5 * a->size[0] || fabs(y) > 0.5 * a->size[1])
            return 0;
    }
    return 1;
}

/* As near as the box fits into the picture: metres from its middle. */
static gw_code fit_distance(aliasing *a, gw_error *error) {
    double square = 0;
    gw_perspective camera;
    gw_code code = GW_OK;
    for (int k = 0; k < 3; k++)
        square += pow(0.5 * (a->scene->bounds[1][k] - a->scene->bounds[0][k]), 2);
    a->radius = sqrt(square);
    a->away = 8 * a->radius;
    for (double nearer = 0.98 * a->away; !code; nearer *= 0.98) {
        code = camera_at(a, first_angle, nearer, &camera, error);
        if (code || !sees_all(a, &camera))
            return code;
        a->away = nearer;
    }
    return code;
}

/* What lies a radius from the middle moves by a quarter of a pixel a frame. */
static gw_code look(const aliasing *a, uint32_t frame, gw_bench_view *out, gw_error *error) {
    const double pixel = 2 * a->away * tan(0.5 * fov * GW_PI / 180) / a->size[1];
    gw_perspective camera;
    *out = (gw_bench_view){.rectangle = {.width = a->size[0], .height = a->size[1]}};
    gw_code code = camera_at(a, first_angle + 0.25 * pixel / a->radius * frame, a->away, &camera, error);
    if (code)
        return code;
    out->placement = camera.placement;
    out->plane = camera.plane;
    memcpy(out->eye, camera.eye, sizeof out->eye);
    return GW_OK;
}

static gw_code draw(const aliasing *a, const gw_bench_view *view, const gw_frame_state *state, gw_image *out,
                    gw_counters *counters, gw_error *error) {
    return gw_renderer_frame(a->renderer, &view->placement, &view->plane, &view->rectangle, state, out->rgba,
                             counters, error);
}

static double rms_of(const gw_image *reference, const gw_image *picture) {
    size_t pixels = (size_t)picture->width * picture->height;
    double sum = 0;
    for (size_t i = 0; i < pixels * 4; i++) {
        double difference =
            gw_srgb_code_to_linear(reference->rgba[i]) - gw_srgb_code_to_linear(picture->rgba[i]);
        sum += i % 4 == 3 ? 0 : difference * difference;
    }
    return sqrt(sum / (3.0 * (double)pixels));
}

static gw_code measure_way(aliasing *a, way which, const gw_bench_view *view, gw_error *error) {
    outcome *o = &a->outcomes[which];
    double flip = 0;
    gw_frame_state state = gw_bench_state(a->bench, view, 0);
    state.tau_inside = state.tau;
    state.samples = 0;
    state.accumulate = 1;
    state.geometry = which == WAY_TRIANGLES ? GW_GEOMETRY_TRIANGLES
                     : which == WAY_VOXELS  ? GW_GEOMETRY_VOXELS
                                            : GW_GEOMETRY_HYBRID;
    gw_code code = draw(a, view, &state, &a->picture, &o->counters, error);
    if (!code)
        code = gw_flip(&a->reference, &a->picture, GW_FLIP_PIXELS_PER_DEGREE, NULL, &flip, error);
    if (!code)
        code = gw_flicker_add(&o->flicker, &a->reference, &a->picture, error);
    o->rms += rms_of(&a->reference, &a->picture) / a->frames;
    o->flip += flip / a->frames;
    return code;
}

static gw_code measure(aliasing *a, gw_error *error) {
    gw_code code = GW_OK;
    for (uint32_t frame = 0; frame < a->frames && !code; frame++) {
        gw_bench_view view;
        code = look(a, frame, &view, error);
        gw_frame_state full = gw_bench_state(a->bench, &view, 0);
        full.tau = full.tau_inside = 0;
        full.samples = 0;
        full.accumulate = REFERENCE_RAYS;
        if (!code)
            code = draw(a, &view, &full, &a->reference, NULL, error);
        for (int i = 0; i < WAYS && !code; i++)
            code = measure_way(a, (way)i, &view, error);
        gw_log_progress(&a->bench->console.log, "drawing frames", (double)(frame + 1) / a->frames);
    }
    for (int i = 0; i < WAYS; i++) {
        outcome *o = &a->outcomes[i];
        o->flickers = gw_flicker_of(&o->flicker);
        o->voxel_share = o->counters.rays ? (double)o->counters.voxel_rays / (double)o->counters.rays : 0;
    }
    return code;
}

/* --- one scene --- */

static gw_code open_scene(aliasing *a, const char *path, gw_error *error) {
    gw_bench *bench = a->bench;
    const gw_import_options import = {.outlier_extents = bench->draw.settings.outlier_extents,
                                      .animation = bench->draw.animation,
                                      .log = &bench->console.log};
    const gw_octree_options how = {.settings = &bench->draw.settings, .log = &bench->console.log};
    const gw_renderer_options counting = gw_bench_rendering(bench, 1);
    gw_gl *device = bench->model.device;
    gw_code code = path ? gw_import(path, &import, &a->scene, error)
                        : gw_city_scene(bench->quick ? 10 : 24, &a->scene, error);
    if (!code)
        code = gw_octree_build(device, a->scene, &how, &a->octree, error);
    if (!code)
        code = gw_renderer_create(device, a->scene, a->octree, &counting, &a->renderer, error);
    if (!code)
        code = gw_image_create(a->size[0], a->size[1], &a->reference, error);
    return code ? code : gw_image_create(a->size[0], a->size[1], &a->picture, error);
}

static void close_scene(aliasing *a) {
    for (int i = 0; i < WAYS; i++)
        gw_flicker_finish(&a->outcomes[i].flicker);
    gw_renderer_destroy(&a->renderer);
    gw_octree_destroy(&a->octree);
    gw_scene_destroy(&a->scene);
    gw_image_finish(&a->reference);
    gw_image_finish(&a->picture);
}

/* Error is that of the light: FLIP counts blur beside it, and is told. */
static int is_met(const aliasing *a) {
    const outcome *triangles = &a->outcomes[WAY_TRIANGLES], *hybrid = &a->outcomes[WAY_HYBRID];
    return hybrid->rms < triangles->rms && hybrid->flickers.mean < triangles->flickers.mean;
}

static void print_scene(const aliasing *a) {
    printf("%s: %" PRIu32 " triangles, depth %" PRIu32 ", %" PRIu32 "x%" PRIu32 " px, %" PRIu32
           " frames a quarter of a pixel apart, against %d rays a pixel\n",
           a->scene->path, a->scene->triangle_count, a->octree->depth, a->size[0], a->size[1], a->frames,
           REFERENCE_RAYS);
    printf("              voxel           error            flicker\n");
    printf("  one ray      rays       RMS    FLIP       mean     99 %%     pop\n");
    for (int i = 0; i < WAYS; i++) {
        const outcome *o = &a->outcomes[i];
        printf("  %-10s  %4.0f%%    %.4f  %.4f     %.4f   %.4f  %.4f\n", way_names[i], 100 * o->voxel_share,
               o->rms, o->flip, o->flickers.mean, o->flickers.percentile, o->flickers.pop);
    }
    const outcome *triangles = &a->outcomes[WAY_TRIANGLES], *hybrid = &a->outcomes[WAY_HYBRID];
    printf("  hybrid below triangles only in error and flicker: %s (RMS %.2f, FLIP %.2f, flicker %.2f of "
           "theirs)\n",
           is_met(a) ? "met" : "not met", hybrid->rms / triangles->rms, hybrid->flip / triangles->flip,
           hybrid->flickers.mean / triangles->flickers.mean);
}

static json_t *scene_json(const aliasing *a, FILE *csv) {
    json_t *entries = json_array();
    for (int i = 0; i < WAYS; i++) {
        const outcome *o = &a->outcomes[i];
        const gw_flicker_result *f = &o->flickers;
        json_array_append_new(entries, json_pack("{s:s, s:f, s:f, s:f, s:{s:f, s:f, s:f, s:f}}", "name",
                                                 way_names[i], "voxel_share", o->voxel_share, "rms", o->rms,
                                                 "flip", o->flip, "flicker", "mean", f->mean, "percentile_99",
                                                 f->percentile, "largest", f->largest, "pop", f->pop));
        fprintf(csv, "%s,%s,%.4f,%.5f,%.5f,%.5f,%.5f,%.5f\n", a->scene->path, way_names[i], o->voxel_share,
                o->rms, o->flip, f->mean, f->percentile, f->pop);
    }
    return json_pack("{s:s, s:I, s:i, s:o, s:b}", "scene", a->scene->path, "triangles",
                     (json_int_t)a->scene->triangle_count, "frames", (int)a->frames, "modes", entries, "met",
                     is_met(a));
}

static gw_code measure_scene(gw_bench *bench, const char *path, FILE *csv, json_t *list, gw_error *error) {
    aliasing a = {.bench = bench,
                  .size = {bench->size[0] ? bench->size[0]
                           : bench->quick ? WIDTH / 2
                                          : WIDTH,
                           bench->size[0] ? bench->size[1]
                           : bench->quick ? HEIGHT / 2
                                          : HEIGHT},
                  .frames = bench->frames  ? bench->frames
                            : bench->quick ? 3
                                           : 12};
    gw_code code = open_scene(&a, path, error);
    if (!code)
        code = fit_distance(&a, error);
    if (!code)
        code = measure(&a, error);
    if (!code)
        json_array_append_new(list, scene_json(&a, csv));
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        print_scene(&a);
    }
    close_scene(&a);
    return code;
}

gw_code gw_bench_aliasing(gw_bench *bench, gw_error *error) {
    char *text = NULL;
    size_t size = 0, count = bench->scene_count ? bench->scene_count : 1;
    FILE *csv = open_memstream(&text, &size);
    json_t *list = json_array();
    if (!csv || !list)
        return gw_fail(error, GW_MACHINE, "memory is out while writing results");
    fputs("scene,mode,voxel_share,rms,flip,flicker,flicker_99,pop\n", csv);
    gw_code code = GW_OK;
    for (size_t i = 0; i < count && !code; i++)
        code =
            measure_scene(bench, bench->scene_count ? bench->scenes[i] : bench->draw.scene, csv, list, error);
    fclose(csv);
    json_object_set_new(bench->report, "bench", json_pack("{s:s, s:o}", "name", "aliasing", "scenes", list));
    if (!code)
        code = gw_bench_write(bench, "aliasing", text, size, error);
    free(text);
    return code;
}
