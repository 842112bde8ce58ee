/* Ambient occlusion and one bounce of diffuse light from voxel cones: against many rays through triangles, in
 * closed rooms, in any split. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/features.h"
#include "render/frame_block.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 40, PIXELS = SIDE * SIDE, SCENES = 3, MANY = 144 };
static const double pi = 3.14159265358979323846;
static const float ambient = 2.4f, albedo = 0.8f; /* the light is 0.61 where nothing is covered */

static gw_stage stages[SCENES];
static gw_camera cameras[SCENES];

static void add_box(gw_mesh *mesh, const double low[3], const double high[3], int inside) {
    for (int axis = 0; axis < 3; ++axis)
        for (int end = 0; end < 2; ++end) {
            double corner[3], u[3] = {0}, v[3] = {0};
            const int a = (axis + 1) % 3, b = (axis + 2) % 3, flip = end ^ inside;
            memcpy(corner, low, sizeof corner);
            corner[axis] = end ? high[axis] : low[axis];
            u[flip ? a : b] = high[flip ? a : b] - low[flip ? a : b];
            v[flip ? b : a] = high[flip ? b : a] - low[flip ? b : a];
            gw_mesh_add_grid(mesh, corner, u, v, 4, 4);
        }
}

/* A floor under a ball, a corner of three walls, the inside of a box. */
static gw_scene *make_scene(int which) {
    gw_mesh mesh = {0};
    const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    if (which == 0) {
        gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){0, 0, 2},
                         (const double[]){2, 0, 0}, 8, 8);
        gw_mesh_add_sphere(&mesh, (const double[]){0, 0.35, 0}, 0.3, 0, 40, 20);
    } else if (which == 1) {
        gw_mesh_add_grid(&mesh, low, (const double[]){0, 0, 2}, (const double[]){2, 0, 0}, 6, 6);
        gw_mesh_add_grid(&mesh, low, (const double[]){2, 0, 0}, (const double[]){0, 2, 0}, 6, 6);
        gw_mesh_add_grid(&mesh, low, (const double[]){0, 2, 0}, (const double[]){0, 0, 2}, 6, 6);
    } else {
        add_box(&mesh, low, high, 1);
    }
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k) {
        scene->ambient[k] = ambient;
        scene->background[k] = 0.9f; /* must not be seen by cones */
        scene->materials[0].base_color[k] = albedo;
    }
    scene->materials[0].roughness = 1;
    scene->materials[0].metalness = 0;
    /* What gloss reflects of the light from everywhere is not covered by cones: these surfaces have none. */
    scene->extensions = malloc(sizeof *scene->extensions);
    assert_non_null(scene->extensions);
    scene->extensions[0] = gw_material_extension_none();
    scene->extensions[0].specular = 0;
    return scene;
}

/* One at a time: a stage has a GL device of its own. */
static gw_renderer *enter_with(int which, const char *shaders) {
    static const double eyes[SCENES][3] = {{0.2, 1.1, 2}, {1.1, 0.9, 1.4}, {0.7, 0.4, 0.8}};
    static const double targets[SCENES][3] = {{0, 0.15, 0}, {-0.6, -0.6, -0.6}, {-0.6, -0.5, -0.7}};
    check_ok(
        gw_stage_open(&stages[which], make_scene(which), shaders,
                      (const char *const[]){"octree_depth=7", "occlusion_cones=6", "occlusion_distance=0.25",
                                            "reconstruction=cubic", "sample_block=2", NULL},
                      &error));
    gw_camera_look(&cameras[which], &stages[which], eyes[which], targets[which], 50, SIDE);
    return gw_stage_renderer(&stages[which]);
}

static gw_renderer *enter(int which) {
    return enter_with(which, NULL);
}

static void leave(int which, gw_renderer **renderer) {
    gw_renderer_destroy(renderer);
    gw_stage_close(&stages[which]);
}

/* Share of the light from everywhere that a pixel shows. */
static double openness_of(const uint8_t *pixel) {
    const double light = gw_srgb_code_to_linear(pixel[1]) * pi / (double)ambient;
    return light / (double)albedo;
}

static gw_ray ray_of_pixel(const gw_frame_block *block, uint32_t x, uint32_t y) {
    gw_ray ray = {.maximum = 1e9f};
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = block->eye[k];
        ray.direction[k] =
            block->corner[k] + block->step_x[k] * ((float)x + 0.5f) + block->step_y[k] * ((float)y + 0.5f);
    }
    return ray;
}

static void normal_of(const gw_scene *scene, const gw_ray *ray, uint32_t triangle, double n[3]) {
    const float *p[3];
    double a[3], b[3], towards = 0, size = 0;
    for (int i = 0; i < 3; ++i)
        p[i] = &scene->positions[3 * (size_t)scene->triangles[triangle][i]];
    for (int k = 0; k < 3; ++k) {
        a[k] = (double)p[1][k] - (double)p[0][k];
        b[k] = (double)p[2][k] - (double)p[0][k];
    }
    for (int k = 0; k < 3; ++k) {
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        towards += n[k] * (double)ray->direction[k];
        size += n[k] * n[k];
    }
    for (int k = 0; k < 3; ++k)
        n[k] *= (towards > 0 ? -1 : 1) / sqrt(size);
}

/* Cosine-weighted, evenly spread over the disk below the hemisphere. */
static void fill_bundle(gw_ray *rays, const double at[3], const double n[3], double reach) {
    const int axis = fabs(n[0]) < 0.6 ? 0 : 1;
    double u[3] = {0}, v[3], size = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = (k == axis) - n[axis] * n[k];
        size += u[k] * u[k];
    }
    for (int k = 0; k < 3; ++k)
        u[k] /= sqrt(size);
    for (int k = 0; k < 3; ++k)
        v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
    for (int i = 0; i < MANY; ++i) {
        const double area = (i + 0.5) / MANY, radius = sqrt(area), turn = 2.39996322972865332 * i;
        for (int k = 0; k < 3; ++k) {
            rays[i].origin[k] = (float)(at[k] + 1e-5 * n[k]);
            rays[i].direction[k] =
                (float)(radius * (cos(turn) * u[k] + sin(turn) * v[k]) + sqrt(1 - area) * n[k]);
        }
        rays[i].minimum = 0;
        rays[i].maximum = (float)reach;
    }
}

/* The reference: openness of every pixel by many rays that end at triangles; negative where nothing is. */
static void trace_openness(int which, gw_renderer *renderer, double *openness) {
    const gw_camera *camera = &cameras[which];
    const double reach = 2 * (double)camera->state.occlusion_distance;
    gw_frame_block block;
    gw_ray *first = calloc(PIXELS, sizeof *first), *rays = calloc((size_t)PIXELS * MANY, sizeof *rays);
    gw_hit *met = calloc(PIXELS, sizeof *met), *hits = calloc((size_t)PIXELS * MANY, sizeof *hits);
    assert_true(first && rays && met && hits);
    check_ok(gw_frame_block_fill(stages[which].scene, stages[which].octree, &camera->placement,
                                 &camera->plane, &camera->state, &block, NULL, &error));
    for (uint32_t i = 0; i < PIXELS; ++i)
        first[i] = ray_of_pixel(&block, i % SIDE, i / SIDE);
    check_ok(gw_renderer_trace(renderer, GW_TRACE_OCTREE, first, PIXELS, met, NULL, &error));
    for (uint32_t i = 0; i < PIXELS; ++i) {
        double at[3], n[3];
        if (met[i].triangle == GW_NO_TRIANGLE)
            continue;
        normal_of(stages[which].scene, &first[i], met[i].triangle, n);
        for (int k = 0; k < 3; ++k)
            at[k] = (double)first[i].origin[k] + (double)met[i].t * (double)first[i].direction[k];
        fill_bundle(&rays[(size_t)i * MANY], at, n, reach);
    }
    check_ok(gw_renderer_trace(renderer, GW_TRACE_OCTREE, rays, (size_t)PIXELS * MANY, hits, NULL, &error));
    for (uint32_t i = 0; i < PIXELS; ++i) {
        double covered = 0;
        for (size_t j = (size_t)i * MANY; j < (size_t)(i + 1) * MANY; ++j)
            if (hits[j].triangle != GW_NO_TRIANGLE)
                covered += fmin(1, 2 - 2 * (double)hits[j].t / reach);
        openness[i] = met[i].triangle == GW_NO_TRIANGLE ? -1 : 1 - covered / MANY;
    }
    free(first);
    free(rays);
    free(met);
    free(hits);
}

enum { STEP = 5, ACROSS = SIDE / STEP, POINTS = ACROSS * ACROSS, PATHS = POINTS * MANY };

/* Continues every path that has hit something by one direction, or ends it: minimum > maximum. */
static void next_of_paths(const gw_scene *scene, gw_ray *rays, const gw_hit *hits, uint64_t *random) {
    for (int i = 0; i < PATHS; ++i) {
        gw_ray many[MANY];
        double at[3], n[3];
        if (hits[i].triangle == GW_NO_TRIANGLE) {
            rays[i].maximum = -1;
            continue;
        }
        normal_of(scene, &rays[i], hits[i].triangle, n);
        for (int k = 0; k < 3; ++k)
            at[k] = (double)rays[i].origin[k] + (double)hits[i].t * (double)rays[i].direction[k];
        fill_bundle(many, at, n, 1e9);
        rays[i] = many[(int)(gw_test_random(random) * MANY)];
    }
}

/* The reference: by paths, the light from everywhere that a few pixels have, as a share of what arrives in
 * the open; with so many reflections before. Negative where nothing is. */
static void trace_paths(int which, gw_renderer *renderer, int bounces, double light[POINTS]) {
    const gw_camera *camera = &cameras[which];
    const gw_scene *scene = stages[which].scene;
    gw_frame_block block;
    gw_ray first[POINTS], *rays = calloc(PATHS, sizeof *rays);
    gw_hit met[POINTS], *hits = calloc(PATHS, sizeof *hits);
    uint64_t random = 5;
    assert_true(rays && hits);
    check_ok(gw_frame_block_fill(scene, stages[which].octree, &camera->placement, &camera->plane,
                                 &camera->state, &block, NULL, &error));
    for (uint32_t i = 0; i < POINTS; ++i)
        first[i] = ray_of_pixel(&block, i % ACROSS * STEP, i / ACROSS * STEP);
    check_ok(gw_renderer_trace(renderer, GW_TRACE_OCTREE, first, POINTS, met, NULL, &error));
    for (int i = 0; i < PATHS; ++i) {
        rays[i] = first[i / MANY];
        hits[i] = met[i / MANY];
    }
    for (int i = 0; i < POINTS; ++i)
        light[i] = met[i].triangle == GW_NO_TRIANGLE ? -1 : 0;
    double share = 1;
    for (int bounce = 0; bounce <= bounces; ++bounce, share *= (double)albedo) {
        next_of_paths(scene, rays, hits, &random);
        check_ok(gw_renderer_trace(renderer, GW_TRACE_OCTREE, rays, PATHS, hits, NULL, &error));
        for (int i = 0; i < PATHS; ++i)
            if (rays[i].maximum > 0 && hits[i].triangle == GW_NO_TRIANGLE)
                light[i / MANY] += share / MANY;
    }
    free(rays);
    free(hits);
}

/* Mean light of the points in a picture over what is wanted, and the latter. */
static double light_off(int which, const char *shaders, uint8_t bounce, const double *wanted, double *mean) {
    gw_renderer *renderer = enter_with(which, shaders);
    gw_camera camera = cameras[which];
    double seen = 0;
    int count = 0;
    camera.state.occlusion_distance = 4;
    camera.state.accumulate = 16;
    camera.state.diffuse_bounce = bounce;
    uint8_t *pixels = gw_camera_take(&camera, renderer, NULL);
    *mean = 0;
    for (uint32_t i = 0; i < POINTS; ++i)
        if (wanted[i] >= 0) {
            *mean += wanted[i];
            seen += openness_of(pixels + 4 * (size_t)(i / ACROSS * STEP * SIDE + i % ACROSS * STEP));
            count++;
        }
    *mean /= count;
    free(pixels);
    leave(which, &renderer);
    return seen / count - *mean;
}

/* Light from everywhere that surfaces pass on, once and for ever: what reflects it is as covered as what it
 * shines on. In the room nothing arrives, and all of it would if nothing were covered. */
static void what_is_covered_passes_on_less(void **state) {
    static double once[POINTS], for_ever[POINTS];
    char folder[512];
    (void)state;
    const char *naive =
        gw_naive_shaders(folder, "uncovered", "shade/secondary_light.glsl", "UNCOVERED_BOUNCE");
    for (int which = 0; which < SCENES; ++which) {
        double mean, mean_of_all;
        gw_renderer *renderer = enter(which);
        trace_paths(which, renderer, 1, once);
        trace_paths(which, renderer, 12, for_ever);
        leave(which, &renderer);
        const double covered = light_off(which, NULL, GW_BOUNCE_ONCE, once, &mean),
                     uncovered = light_off(which, naive, GW_BOUNCE_ONCE, once, &mean),
                     all = light_off(which, NULL, GW_BOUNCE_ALL, for_ever, &mean_of_all);
        print_message("# scene %d: light %.3f off by %+.3f, as if nothing were covered %+.3f; all bounces "
                      "%.3f off by %+.3f\n",
                      which, mean, covered, uncovered, mean_of_all, all);
        assert_true(fabs(covered) < 0.02 && fabs(all) < 0.05);
        assert_true(uncovered > 0.03); /* the naive rule fails */
    }
}

typedef struct off {
    double mean, worst, plain; /* of openness; plain: mean without any occlusion */
} off;

static off compare(const gw_camera *camera, gw_renderer *renderer, const double *openness) {
    off result = {0, 0, 0};
    int count = 0;
    uint8_t *pixels = gw_camera_take(camera, renderer, NULL);
    for (size_t i = 0; i < PIXELS; ++i) {
        if (openness[i] < 0)
            continue;
        const double error_here = fabs(openness_of(pixels + 4 * i) - openness[i]);
        result.mean += error_here;
        result.worst = fmax(result.worst, error_here);
        result.plain += 1 - openness[i];
        count++;
    }
    result.mean /= count;
    result.plain /= count;
    free(pixels);
    return result;
}

/* Against the reference; and with the samples of a still view better. The naive variant, light that nothing
 * covers, is `plain`. */
static void cones_come_near_many_rays(void **state) {
    static const uint8_t cones[] = {1, 3, 5, 6};
    static double openness[PIXELS];
    (void)state;
    for (int which = 0; which < 2; ++which) {
        gw_renderer *renderer = enter(which);
        trace_openness(which, renderer, openness);
        gw_camera camera = cameras[which];
        off found = {0, 0, 0}, refined;
        for (size_t c = 0; c < sizeof cones; ++c) {
            camera.state.cones = cones[c];
            found = compare(&camera, renderer, openness);
            print_message("# scene %d, %d cones: openness off by %.3f, at worst %.3f; without %.3f\n", which,
                          cones[c], found.mean, found.worst, found.plain);
        }
        camera.state.accumulate = 16;
        refined = compare(&camera, renderer, openness);
        print_message("# scene %d, 6 cones, 16 samples: off by %.3f, at worst %.3f\n", which, refined.mean,
                      refined.worst);
        assert_true(found.mean < 0.06);
        assert_true(found.mean < 0.6 * found.plain);
        assert_true(refined.mean < 0.03);
        leave(which, &renderer);
    }
}

/* In a closed room all is covered, however far cones reach: no more light comes through its walls than this.
 */
static void a_closed_room_is_dark(void **state) {
    (void)state;
    gw_renderer *renderer = enter(2);
    gw_camera camera = cameras[2];
    camera.state.occlusion_distance = 2;
    for (int coarse = 0; coarse < 2; ++coarse) {
        double worst = 0, sum = 0;
        camera.state.tau_inside = coarse ? 2.0f : 0.0f; /* what cones start from is voxels, too */
        /* Rays of pixels leak at the room's edges where it is voxels: what they see there is no cone's fault.
         */
        for (int k = 0; coarse && k < 3; ++k)
            stages[2].scene->background[k] = 0;
        uint8_t *pixels = gw_camera_take(&camera, renderer, NULL);
        for (size_t i = 0; i < PIXELS; ++i) {
            const double open = openness_of(pixels + 4 * i);
            worst = fmax(worst, open);
            sum += open;
        }
        print_message("# tau %d: openness in a closed room %.4f, at worst %.4f\n", 2 * coarse, sum / PIXELS,
                      worst);
        assert_true(sum / PIXELS < (coarse ? 0.02 : 0.01));
        assert_true(worst < 0.2);
        free(pixels);
    }
    leave(2, &renderer);
}

/* A room whose walls glow evenly and reflect the share a: one bounce adds a times the glow everywhere, all of
 * them a / (1 - a) times. */
static void glowing_walls_light_each_other(void **state) {
    (void)state;
    const float glow = 0.3f;
    gw_scene *scene = make_scene(2);
    gw_stage stage;
    for (int k = 0; k < 3; ++k) {
        scene->ambient[k] = 0;
        scene->materials[0].emissive[k] = glow;
        scene->materials[0].base_color[k] = 0.5f;
    }
    check_ok(gw_stage_open(&stage, scene, NULL,
                           (const char *const[]){"octree_depth=6", "occlusion_cones=5",
                                                 "occlusion_distance=2", "diffuse_bounce=on", NULL},
                           &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.7, 0.4, 0.8}, (const double[]){-0.6, -0.5, -0.7}, 50,
                   SIDE);
    for (uint8_t bounce = GW_BOUNCE_ONCE; bounce <= GW_BOUNCE_ALL; ++bounce) {
        const double wanted = bounce == GW_BOUNCE_ONCE ? 0.45 : 0.6;
        camera.state.diffuse_bounce = bounce;
        uint8_t *pixels = gw_camera_take(&camera, renderer, NULL);
        const double light = gw_mean_linear(pixels, PIXELS);
        print_message("# glow 0.3 of walls that reflect half: %.4f, wanted %.2f\n", light, wanted);
        assert_true(fabs(light - wanted) < 0.01);
        free(pixels);
    }
    /* Nothing comes from everywhere: that effect is not called for, the other one is. */
    json_t *report = json_object();
    const gw_counters counters = {0};
    check_ok(gw_renderer_report(renderer, &counters, report, &error));
    char *run = json_dumps(json_object_get(json_object_get(report, "effects"), "run"), 0);
    assert_non_null(strstr(run, "diffuse-bounce"));
    assert_null(strstr(run, "occlusion"));
    free(run);
    json_decref(report);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

/* Any split, rays that are suspended early, and a gaze: the same bits. */
static void any_split_gives_the_same_bits(void **state) {
    static const gw_rectangle parts[4] = {{0, 0, 17, 24}, {17, 0, 23, 24}, {0, 24, 17, 16}, {17, 24, 23, 16}};
    static uint8_t piece[PIXELS * 4];
    (void)state;
    const gw_renderer_options breath = {.loop_budget = 40};
    gw_renderer *renderer = enter(0), *short_winded = NULL;
    check_ok(gw_renderer_create(stages[0].device, stages[0].scene, stages[0].octree, &breath, &short_winded,
                                &error));
    gw_camera camera = cameras[0];
    gw_camera_gaze(&camera, 12, 20, 4.0);
    camera.state.tau = 3;
    gw_counters counters = {0};
    uint8_t *whole = gw_camera_take(&camera, renderer, &counters);
    assert_int_equal(counters.step_cap_hits + counters.nan_pixels, 0);
    uint8_t *same = gw_camera_take(&camera, short_winded, NULL);
    assert_memory_equal(same, whole, PIXELS * 4);
    for (int p = 0; p < 4; ++p) {
        const gw_rectangle *r = &parts[p];
        check_ok(gw_renderer_frame(renderer, &camera.placement, &camera.plane, r, &camera.state, piece, NULL,
                                   &error));
        for (uint32_t y = 0; y < r->height; ++y)
            assert_memory_equal(piece + (size_t)y * r->width * 4,
                                whole + (((size_t)r->y + y) * SIDE + (size_t)r->x) * 4, (size_t)r->width * 4);
    }
    free(whole);
    free(same);
    gw_renderer_destroy(&short_winded);
    leave(0, &renderer);
}

/* Degrees from the gaze at a pixel. */
static double degrees_from_gaze(const gw_camera *camera, uint32_t pixel, const double gaze[3]) {
    double direction[3], cosine = 0;
    gw_camera_ray(camera, pixel % SIDE, pixel / SIDE, direction);
    for (int k = 0; k < 3; ++k)
        cosine += direction[k] * gaze[k];
    return acos(fmin(cosine, 1)) * 180 / pi;
}

enum { RINGS = 8, RING_WIDTH = 3 /* deg */ };

/* How much more open than without a gaze the corner seems, in rings about it. */
static void change_by_ring(const gw_camera *gazed, gw_renderer *renderer, const double towards[3],
                           const uint8_t *sharp, gw_counters *counters, double change[RINGS]) {
    int count[RINGS] = {0};
    uint8_t *pixels = gw_camera_take(gazed, renderer, counters);
    memset(change, 0, RINGS * sizeof *change);
    for (uint32_t i = 0; i < PIXELS; ++i) {
        const int ring = (int)(degrees_from_gaze(gazed, i, towards) / RING_WIDTH);
        const double open = openness_of(sharp + 4 * i);
        if (ring >= RINGS || open > 1.2) /* the background */
            continue;
        change[ring] += openness_of(pixels + 4 * i) - open;
        count[ring]++;
    }
    free(pixels);
    for (int r = 0; r < RINGS; ++r) {
        change[r] /= count[r];
        print_message("# tau %g, %d to %d degrees: openness %+.4f\n", (double)gazed->state.tau,
                      r * RING_WIDTH, (r + 1) * RING_WIDTH, change[r]);
    }
}

/* By how much a ring differs from those about it, at most. */
static double strongest_ring(const double change[RINGS]) {
    double most = 0;
    for (int r = 1; r + 1 < RINGS; ++r)
        most = fmax(most, fabs(change[r] - 0.5 * (change[r - 1] + change[r + 1])));
    return most;
}

/* Nothing changes inside a gaze, and no ring about it differs from its neighbours. It would where cones start
 * from voxels so coarse that they fill the corner. */
static void no_ring_follows_the_gaze(void **state) {
    double change[RINGS], coarse[RINGS], towards[3];
    (void)state;
    gw_renderer *renderer = enter(1);
    gw_camera camera = cameras[1];
    uint8_t *sharp = gw_camera_take(&camera, renderer, NULL);
    gw_counters counters = {0};
    gw_camera_gaze(&camera, 20, 20, 6);
    gw_camera_ray(&camera, 20, 20, towards);
    camera.state.tau = 1;
    change_by_ring(&camera, renderer, towards, sharp, &counters, change);
    camera.state.tau = 3;
    change_by_ring(&camera, renderer, towards, sharp, NULL, coarse);
    assert_true(fabs(change[0]) < 0.001);
    assert_true(strongest_ring(change) < 0.01);
    assert_true(strongest_ring(coarse) > 0.015);
    assert_true(counters.cone_rays > PIXELS && counters.mirror_rays == 0);
    free(sharp);
    /* What was forecast has room for the cones. */
    gw_settings none = stages[1].settings;
    uint64_t with, without, rays, lists;
    none.occlusion_cones = 0;
    gw_renderer_ray_memory(renderer, &stages[1].settings, &with, &rays, &lists);
    gw_renderer_ray_memory(renderer, &none, &without, &rays, &lists);
    assert_true(with > 2 * without);
    assert_true(gw_renderer_parts_of(renderer).rays < with * rays);
    leave(1, &renderer);
}

/* Nor in a closed room in the light of a lamp, which walls pass on: of its light rings about a gaze change no
 * more than those beside them, wherever the gaze is. */
static void no_ring_follows_the_gaze_in_a_lit_room(void **state) {
    static const double gazes[2][2] = {{20, 20}, {12, 26}};
    (void)state;
    gw_scene *scene = make_scene(2);
    gw_camera camera;
    scene->lights = calloc(1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    scene->light_count = 1;
    scene->lights[0] =
        (gw_light){.kind = GW_LIGHT_POINT, .vector = {0.2, 0.6, 0.1}, .color = {0.6f, 0.6f, 0.6f}};
    for (int k = 0; k < 3; ++k)
        scene->ambient[k] = 0;
    check_ok(gw_stage_open(&stages[2], scene, NULL,
                           (const char *const[]){"octree_depth=7", "occlusion_cones=6",
                                                 "occlusion_distance=2", "diffuse_bounce=all", NULL},
                           &error));
    gw_camera_look(&camera, &stages[2], (const double[]){0.7, 0.4, 0.8}, (const double[]){-0.6, -0.5, -0.7},
                   50, SIDE);
    gw_renderer *renderer = gw_stage_renderer(&stages[2]);
    uint8_t *sharp = gw_camera_take(&camera, renderer, NULL);
    for (int g = 0; g < 2; ++g) {
        double change[RINGS], coarse[RINGS], towards[3];
        gw_camera gazed = camera;
        gw_camera_gaze(&gazed, gazes[g][0], gazes[g][1], 6);
        gw_camera_ray(&gazed, (uint32_t)gazes[g][0], (uint32_t)gazes[g][1], towards);
        gazed.state.tau = 1;
        change_by_ring(&gazed, renderer, towards, sharp, NULL, change);
        gazed.state.tau = 6;
        change_by_ring(&gazed, renderer, towards, sharp, NULL, coarse);
        print_message("# strongest ring %.4f, of coarse voxels %.4f\n", strongest_ring(change),
                      strongest_ring(coarse));
        assert_true(fabs(change[0]) < 0.001);
        assert_true(strongest_ring(change) < 0.01);
        assert_true(strongest_ring(coarse) > 0.015);
    }
    free(sharp);
    leave(2, &renderer);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cones_come_near_many_rays),
        cmocka_unit_test(a_closed_room_is_dark),
        cmocka_unit_test(glowing_walls_light_each_other),
        cmocka_unit_test(any_split_gives_the_same_bits),
        cmocka_unit_test(no_ring_follows_the_gaze),
        cmocka_unit_test(no_ring_follows_the_gaze_in_a_lit_room),
        cmocka_unit_test(what_is_covered_passes_on_less),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
