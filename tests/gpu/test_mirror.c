/* Perfect mirrors: they show what the mirrored scene shows, from triangles and from voxels, in any split. */
#include "tests/support/check.h"

#include "base/memory.h"
#include "base/srgb.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 96, PIXELS = SIDE * SIDE };
enum { MATT, MIRROR };

/* A ball and a block beside it above y = 0, or below with up = -1; with a floor that is a mirror, or without.
 */
static gw_scene *room(double up, int floor) {
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){-0.3, 0.5, -0.2}, 0.35, 0.0, 40, 24);
    gw_mesh_add_tetrahedron(&mesh, (const double[]){0.5, 0.45, 0.0}, 0.25);
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0.02, -0.9}, (const double[]){2, 0, 0},
                     (const double[]){0, 1, 0}, 30, 15);
    for (size_t i = 0; i < mesh.point_count; ++i)
        mesh.points[i * 3 + 1] *= up;
    if (floor)
        gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){2, 0, 0},
                         (const double[]){0, 0, 2}, 40, 40);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    gw_light *light = calloc(1, sizeof *light);
    assert_non_null(materials);
    assert_non_null(light);
    materials[MATT] =
        (gw_material){.base_color = {0.7f, 0.4f, 0.2f, 1}, .roughness = 1, .base_color_texture = -1};
    materials[MIRROR] = (gw_material){.base_color = {1, 1, 1, 1}, .metalness = 1, .base_color_texture = -1};
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    for (uint32_t i = 0; i < scene->triangle_count; ++i) {
        int on_floor = 1;
        for (int k = 0; k < 3; ++k) {
            double y = ldexp((double)scene->positions[scene->triangles[i][k] * 3 + 1], scene->exponent) +
                       scene->centre[1];
            on_floor &= fabs(y) < 1e-6;
        }
        scene->material_of[i] = on_floor ? MIRROR : MATT;
    }
    *light = (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.48, -0.8 * up, -0.36}, .color = {2, 2, 2}};
    scene->lights = light;
    scene->light_count = 1;
    for (int i = 0; i < 3; ++i) {
        scene->ambient[i] = 0.5f;
        scene->background[i] = i == 2 ? 0.6f : 0.3f;
    }
    return scene;
}

static void look(gw_camera *camera, const gw_stage *stage, float tau) {
    gw_camera_look(camera, stage, (const double[]){0.1, 0.9, 2.6}, (const double[]){0, -0.1, 0}, 34, SIDE);
    camera->state.tau_inside = tau;
}

static int furthest(const uint8_t *a, const uint8_t *b) {
    int most = 0;
    for (int c = 0; c < 3; ++c)
        most = abs(a[c] - b[c]) > most ? abs(a[c] - b[c]) : most;
    return most;
}

static void a_mirror_shows_the_mirrored_scene(void **state) {
    (void)state;
    static const struct {
        float tau;
        double mean; /* at most, in 1/255 */
    } rows[] = {{0, 0.02}, {0.5f, 0.1}, {1, 0.7}, {2, 4}};
    const gw_renderer_options dull = {.forbid_features = GW_FEATURE_MIRROR};
    gw_stage with, image;
    check_ok(gw_stage_open(&with, room(1, 1), NULL, (const char *const[]){"octree_depth=9", NULL}, &error));
    check_ok(gw_stage_open(&image, room(-1, 0), NULL, (const char *const[]){"octree_depth=9", NULL}, &error));
    for (size_t r = 0; r < sizeof rows / sizeof rows[0]; ++r) {
        gw_camera camera;
        gw_counters counters = {0};
        look(&camera, &with, rows[r].tau);
        uint8_t *a = gw_stage_take(&with, &camera, NULL, &counters),
                *without = gw_stage_take(&with, &camera, &dull, NULL);
        look(&camera, &image, rows[r].tau);
        uint8_t *b = gw_stage_take(&image, &camera, NULL, NULL);
        size_t seen = 0, off = 0;
        double mean = 0;
        for (size_t i = 0; i < PIXELS * 4; i += 4)
            if (memcmp(a + i, without + i, 4)) {
                ++seen;
                off += furthest(a + i, b + i) > 4;
                mean += furthest(a + i, b + i);
            }
        mean /= (double)seen;
        print_message(
            "tau %g: %zu pixels of mirror, mean difference %.3f/255, %zu by more than 4; %u rays reflected\n",
            (double)rows[r].tau, seen, mean, off, (unsigned)counters.mirror_rays);
        assert_true(seen > PIXELS / 4 && mean <= rows[r].mean);
        assert_true(counters.mirror_rays >= seen);
        assert_int_equal(counters.nan_pixels + counters.step_cap_hits, 0);
        free(a);
        free(b);
        free(without);
    }
    gw_stage_close(&with);
    gw_stage_close(&image);
}

/* Mean difference that a gaze whose border crosses the mirror makes to the exact picture. */
static double error_of_gaze(const char *shaders) {
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, room(1, 1), shaders,
                           (const char *const[]){"octree_depth=9", "sample_block=1", "tau=2", NULL}, &error));
    look(&camera, &stage, 0);
    uint8_t *exact = gw_stage_take(&stage, &camera, NULL, NULL);
    gw_camera_gaze(&camera, SIDE / 2, SIDE / 2, 3.0);
    gw_counters counters = {0};
    uint8_t *gazed = gw_stage_take(&stage, &camera, NULL, &counters);
    double difference = gw_mean_difference(exact, gazed, PIXELS);
    assert_int_equal(counters.nan_pixels, 0);
    free(exact);
    free(gazed);
    gw_stage_close(&stage);
    return difference;
}

static void voxels_of_a_mirror_reflect_too(void **state) {
    (void)state;
    char folder[512];
    double reflecting = error_of_gaze(NULL),
           dull = error_of_gaze(gw_naive_shaders(folder, "dull", "shade/mirror_share.glsl", "DULL_VOXELS"));
    print_message("a gaze across the mirror changes pixels by %.2f/255; were its voxels dull: %.2f\n",
                  reflecting, dull);
    assert_true(reflecting < 1.5);
    assert_true(dull > 4.0 * reflecting); /* the naive rule fails */
}

/* A polished ball, seen by somebody behind whom a wall of noise stands: in the ball the wall is small. */
static gw_scene *ball_before_noise(void) {
    enum { TEXELS = 256, AROUND = 48, RINGS = 24 };
    void *memory = NULL;
    uint64_t random = 3;
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 0.4, 0, AROUND, RINGS);
    const size_t of_ball = mesh.point_count, faces_of_ball = mesh.triangle_count;
    gw_mesh_add_grid(&mesh, (const double[]){-8, -8, 4}, (const double[]){16, 0, 0},
                     (const double[]){0, 16, 0}, 8, 8);
    gw_scene *scene = gw_mesh_take(&mesh);
    assert_int_equal(scene->vertex_count, of_ball + 81);
    scene->materials = realloc(scene->materials, 2 * sizeof *scene->materials);
    assert_non_null(scene->materials);
    scene->materials[1] = scene->materials[0];
    scene->materials[MATT].base_color_texture = 0;
    scene->materials[MIRROR] =
        (gw_material){.base_color = {1, 1, 1, 1}, .metalness = 1, .base_color_texture = -1};
    scene->material_count = 2;
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        scene->material_of[t] = t < faces_of_ball ? MIRROR : MATT;
    for (uint32_t v = 0; v < scene->vertex_count; ++v) {
        const float *p = scene->positions + (size_t)v * 3;
        float from[3], length = 0;
        for (int k = 0; k < 3; ++k) {
            from[k] = (float)(ldexp((double)p[k], scene->exponent) + scene->centre[k]);
            length += from[k] * from[k];
        }
        for (int k = 0; k < 3 && v < of_ball; ++k)
            scene->normals[v * 3 + (uint32_t)k] = from[k] / sqrtf(length);
        scene->texcoords[v * 2] = from[0] / 8;
        scene->texcoords[v * 2 + 1] = from[1] / 8;
    }
    check_ok(gw_allocate(&memory, 1, sizeof *scene->textures, "texture", &error));
    scene->textures = memory;
    scene->texture_count = 1;
    check_ok(gw_image_create(TEXELS, TEXELS, &scene->textures[0].image, &error));
    for (size_t i = 0; i < TEXELS * TEXELS * 4; ++i)
        scene->textures[0].image.rgba[i] = i % 4 == 3 ? 255 : (uint8_t)(255 * gw_test_random(&random));
    for (int i = 0; i < 3; ++i)
        scene->ambient[i] = 3;
    return scene;
}

/* Root mean square error in linear light of one ray a pixel to many, triangles only, so that nothing but the
 * footprint of the reflected ray is seen. */
static double error_in_the_ball(const char *shaders) {
    gw_stage stage;
    gw_camera camera;
    double sum = 0;
    check_ok(gw_stage_open(&stage, ball_before_noise(), shaders,
                           (const char *const[]){"octree_depth=7", NULL}, &error));
    gw_camera_look(&camera, &stage, (const double[]){0, 0, 3}, (const double[]){0, 0, 0}, 10, SIDE);
    gw_counters counters = {0};
    uint8_t *one = gw_stage_take(&stage, &camera, NULL, &counters);
    camera.state.samples = 4;
    camera.state.accumulate = 4;
    uint8_t *many = gw_stage_take(&stage, &camera, NULL, NULL);
    assert_true(counters.mirror_rays > PIXELS / 2);
    for (size_t i = 0; i < PIXELS * 4; ++i) {
        const double d = gw_srgb_code_to_linear(one[i]) - gw_srgb_code_to_linear(many[i]);
        sum += d * d;
    }
    free(one);
    free(many);
    gw_stage_close(&stage);
    return sqrt(sum / (3.0 * PIXELS));
}

static void curvature_widens_what_a_mirror_sees(void **state) {
    char folder[512];
    (void)state;
    const double curved = error_in_the_ball(NULL),
                 flat = error_in_the_ball(
                     gw_naive_shaders(folder, "flat", "shade/secondary_ray.glsl", "FLAT_MIRRORS"));
    print_message("# a ball that mirrors noise: error %.4f, as if it were flat %.4f\n", curved, flat);
    assert_true(curved < 0.03);
    assert_true(flat > 3 * curved); /* the naive rule fails */
}

/* Up to mirror_roughness metal is a mirror; a frame's state may change it. */
static void roughness_decides_what_is_a_mirror(void **state) {
    static const struct {
        float roughness, limit;
        int mirrors;
    } rows[] = {{0.1f, 0.02f, 0}, {0.1f, 0.15f, 1}, {0.02f, 0.02f, 1}, {0.02f, 0.01f, 0}, {0, 0, 1}};
    (void)state;
    for (int tau = 0; tau < 2; ++tau) {
        gw_stage stage;
        gw_camera camera;
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
            if (i == 0 || rows[i].roughness != rows[i - 1].roughness) {
                gw_scene *scene = room(1, 1);
                scene->materials[MIRROR].roughness = rows[i].roughness;
                check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=6", NULL},
                                       &error));
            }
            gw_counters counters = {0};
            look(&camera, &stage, (float)(4 * tau));
            camera.state.mirror_roughness = rows[i].limit;
            free(gw_stage_take(&stage, &camera, NULL, &counters));
            if (rows[i].mirrors)
                assert_true(counters.mirror_rays > PIXELS / 8);
            else
                assert_int_equal(counters.mirror_rays, 0);
            if (i + 1 == sizeof rows / sizeof rows[0] || rows[i + 1].roughness != rows[i].roughness)
                gw_stage_close(&stage);
        }
    }
}

/* A gaze, voxels, sparse samples, shadows, a curved mirror and a flat one. */
static void however_it_is_drawn_pixels_are_the_same(void **state) {
    (void)state;
    gw_stage stage;
    gw_camera camera;
    gw_scene *scene = room(1, 1);
    for (uint32_t i = 0; i < scene->triangle_count; i += 3)
        scene->material_of[i] = MIRROR;
    check_ok(
        gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", "tau=3", NULL}, &error));
    look(&camera, &stage, 0);
    gw_camera_gaze(&camera, SIDE / 3, SIDE / 2, 4.0);
    gw_counters counters = {0};
    uint8_t *whole = gw_stage_take(&stage, &camera, NULL, NULL);
    static const struct {
        const char *what;
        gw_renderer_options options;
    } ways[] = {{"counted", {.count = 1}},
                {"suspended", {.loop_budget = 32}},
                {"all effects", {.force_features = GW_ALL_FEATURES}}};
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; ++w) {
        uint8_t *other = gw_stage_take(&stage, &camera, &ways[w].options, w == 1 ? &counters : NULL);
        if (memcmp(whole, other, PIXELS * 4))
            fail_msg("%s: other pixels", ways[w].what);
        free(other);
    }
    assert_true(counters.resumed > PIXELS);
    assert_true(counters.mirror_rays > PIXELS / 4 && counters.shadow_rays > counters.mirror_rays / 4);

    gw_renderer *renderer = gw_stage_renderer(&stage);
    uint8_t *part = calloc(PIXELS, 4);
    assert_non_null(part);
    static const gw_rectangle parts[] = {{0, 0, 41, 57}, {41, 3, 55, 93}, {7, 57, 34, 39}};
    for (size_t p = 0; p < sizeof parts / sizeof parts[0]; ++p) {
        const gw_rectangle *r = &parts[p];
        check_ok(gw_renderer_frame(renderer, &camera.placement, &camera.plane, r, &camera.state, part, NULL,
                                   &error));
        for (uint32_t y = 0; y < r->height; ++y)
            assert_memory_equal(part + (size_t)y * r->width * 4,
                                whole + ((size_t)(r->y + (int)y) * SIDE + (size_t)r->x) * 4,
                                (size_t)r->width * 4);
    }
    /* Samples of a still view, one by one and at once. */
    gw_camera still = camera;
    still.state.epoch = 1;
    for (uint16_t n = 1; n <= 3; ++n) {
        still.state.accumulate = n;
        check_ok(gw_camera_picture(&still, renderer, part, NULL, &error));
    }
    uint8_t *at_once = gw_stage_take(&stage, &still, &ways[1].options, NULL);
    assert_memory_equal(part, at_once, PIXELS * 4);
    assert_memory_not_equal(part, whole, PIXELS * 4);
    free(at_once);
    free(part);
    free(whole);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

enum { CORRIDOR = 32 };

/* Two mirrors that face each other, x = -0.5 and 0.5, from -1 to 1; nothing shines but what is behind their
 * ends. */
static gw_scene *corridor(float color) {
    gw_mesh mesh = {0};
    for (int side = -1; side <= 1; side += 2)
        gw_mesh_add_grid(&mesh, (const double[]){0.5 * side, -1, -1}, (const double[]){0, 2, 0},
                         (const double[]){0, 0, 2}, 8, 8);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->materials[0] =
        (gw_material){.base_color = {color, color, color, 1}, .metalness = 1, .base_color_texture = -1};
    for (int i = 0; i < 3; ++i) {
        scene->ambient[i] = 0;
        scene->background[i] = 0.75f;
    }
    return scene;
}

/* What a ray of the corridor brings after so many bounces at most, -1 where it ends too near to an edge to
 * tell. */
static double radiance_in_corridor(const double eye[3], const double direction[3], double color,
                                   int bounces) {
    double leaves = 1e30;
    for (int k = 1; k < 3; ++k)
        if (direction[k] != 0)
            leaves = fmin(leaves, ((direction[k] > 0 ? 1 : -1) - eye[k]) / direction[k]);
    const double walls = (eye[0] * (direction[0] > 0 ? 1 : -1) + leaves * fabs(direction[0])) + 0.5;
    if (fabs(walls - floor(walls + 0.5)) < 0.01)
        return -1;
    const int met = (int)floor(walls);
    const double schlick = color + (1 - color) * pow(1 - fabs(direction[0]), 5);
    return met > bounces ? 0 : 0.75 * pow(schlick, met);
}

static void a_corridor_of_mirrors_ends(void **state) {
    static const int bounces[] = {0, 1, 4, 8};
    static const double eye[3] = {0.2, 0.1, 0.6};
    const double color = 0.8;
    (void)state;
    gw_stage stage;
    gw_camera camera;
    uint64_t rays[4] = {0};
    check_ok(gw_stage_open(&stage, corridor((float)color), NULL,
                           (const char *const[]){"octree_depth=6", NULL}, &error));
    gw_camera_look(&camera, &stage, eye, (const double[]){-0.5, 0.1, 0.55}, 40, CORRIDOR);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    for (size_t b = 0; b < 4; ++b) {
        gw_counters counters = {0};
        camera.state.bounces = (uint8_t)bounces[b];
        camera.state.least_throughput = 0;
        uint8_t *rgba = gw_camera_take(&camera, renderer, &counters);
        size_t wrong = 0;
        for (uint32_t i = 0; i < CORRIDOR * CORRIDOR; ++i) {
            double direction[3];
            gw_camera_ray(&camera, i % CORRIDOR, i / CORRIDOR, direction);
            const double wanted = radiance_in_corridor(eye, direction, color, bounces[b]);
            wrong += wanted >= 0 && fabs(gw_srgb_code_to_linear(rgba[i * 4]) - wanted) > 0.005;
        }
        assert_int_equal(wrong, 0);
        assert_int_equal(counters.nan_pixels + counters.step_cap_hits, 0);
        rays[b] = counters.mirror_rays;
        free(rgba);
    }
    print_message("# a corridor, rays for 0, 1, 4 and 8 bounces: %u, %u, %u, %u\n", (unsigned)rays[0],
                  (unsigned)rays[1], (unsigned)rays[2], (unsigned)rays[3]);
    assert_true(rays[0] == 0 && rays[1] < rays[2] && rays[2] < rays[3]);
    /* What hardly counts is cut: after two mirrors of 0.8 less than 0.7 depends on a ray. */
    gw_counters cut = {0};
    camera.state.least_throughput = 0.7f;
    free(gw_camera_take(&camera, renderer, &cut));
    assert_true(cut.mirror_rays < rays[2] && cut.mirror_rays > rays[1]);
    /* Voxels, suspended rays: no pixel is brighter than what shines, and budgets change nothing. */
    camera.state.tau_inside = 1;
    uint8_t *whole = gw_camera_take(&camera, renderer, NULL);
    const gw_renderer_options short_of = {.loop_budget = 32};
    uint8_t *suspended = gw_stage_take(&stage, &camera, &short_of, NULL);
    assert_memory_equal(whole, suspended, CORRIDOR * CORRIDOR * 4);
    for (size_t i = 0; i < CORRIDOR * CORRIDOR; ++i)
        assert_true(whole[i * 4] <= 225); /* 0.75 */
    free(whole);
    free(suspended);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

/* What nothing calls for has no rays and no room. */
static void without_lights_and_mirrors_there_is_nothing(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 1.0, 0.1, 20, 12);
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, gw_mesh_take(&mesh), NULL, (const char *const[]){"octree_depth=6", NULL},
                           &error));
    look(&camera, &stage, 0);
    const gw_renderer_options forced = {.force_features = GW_FEATURE_MIRROR | GW_FEATURE_SHADOWS};
    gw_renderer *plain = gw_stage_renderer(&stage), *more = gw_stage_renderer_with(&stage, &forced);
    gw_counters counters = {0};
    uint8_t *a = gw_camera_take(&camera, plain, &counters), *b = gw_camera_take(&camera, more, &counters);
    assert_memory_equal(a, b, PIXELS * 4);
    assert_int_equal(counters.mirror_rays + counters.shadow_rays, 0);
    assert_true(gw_renderer_parts_of(plain).rays < gw_renderer_parts_of(more).rays);
    free(a);
    free(b);
    gw_renderer_destroy(&plain);
    gw_renderer_destroy(&more);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mirror_shows_the_mirrored_scene),
        cmocka_unit_test(voxels_of_a_mirror_reflect_too),
        cmocka_unit_test(curvature_widens_what_a_mirror_sees),
        cmocka_unit_test(roughness_decides_what_is_a_mirror),
        cmocka_unit_test(however_it_is_drawn_pixels_are_the_same),
        cmocka_unit_test(a_corridor_of_mirrors_ends),
        cmocka_unit_test(without_lights_and_mirrors_there_is_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
