/* Hard shadows against double precision, and where rays that leave surfaces go wrong: on themselves (acne),
 * past what they touch (leaks at contacts), through closed walls. */
#include "tests/support/check.h"

#include "base/image.h"
#include "base/srgb.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 80, PIXELS = SIDE * SIDE };

/* Takes the mesh; black but for one light, which is strong enough for the least cosine to show. */
static void open_lit(gw_stage *stage, gw_mesh *mesh, const gw_light *light, const char *shaders,
                     const char *const *settings) {
    gw_scene *scene = gw_mesh_take(mesh);
    scene->lights = calloc(1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    scene->lights[0] = *light;
    scene->light_count = 1;
    for (int i = 0; i < 3; ++i)
        scene->ambient[i] = scene->background[i] = 0.0f;
    check_ok(gw_stage_open(stage, scene, shaders, settings, &error));
}

static gw_light sun(double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z);
    return (gw_light){
        .kind = GW_LIGHT_DIRECTIONAL, .vector = {x / length, y / length, z / length}, .color = {30, 30, 30}};
}

static gw_light lamp(double x, double y, double z) {
    return (gw_light){.kind = GW_LIGHT_POINT, .vector = {x, y, z}, .color = {3, 3, 3}};
}

static uint8_t *take(const gw_stage *stage, const gw_camera *camera, uint32_t forbidden,
                     gw_counters *counters) {
    gw_renderer *renderer = NULL;
    const gw_renderer_options options = {.forbid_features = forbidden};
    check_ok(gw_renderer_create(stage->device, stage->scene, stage->octree, &options, &renderer, &error));
    uint8_t *rgba = gw_camera_take(camera, renderer, counters);
    gw_renderer_destroy(&renderer);
    return rgba;
}

static size_t lit_pixels(const uint8_t *rgba) {
    size_t count = 0;
    for (size_t i = 0; i < PIXELS; ++i)
        count += rgba[i * 4] > 0;
    return count;
}

/* --- double precision --- */

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; ++i)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void corner_of(const gw_scene *scene, uint32_t triangle, int k, double out[3]) {
    const float *p = scene->positions + (size_t)scene->triangles[triangle][k] * 3;
    for (int i = 0; i < 3; ++i)
        out[i] = ldexp((double)p[i], scene->exponent) + scene->centre[i];
}

/* t of the nearest triangle in (least, most), or most; normal not normalised. */
static double nearest(const gw_scene *scene, const double origin[3], const double direction[3], double least,
                      double most, double normal[3]) {
    for (uint32_t id = 0; id < scene->triangle_count; ++id) {
        double a[3], b[3], c[3], ab[3], ac[3], n[3], from[3], q[3];
        corner_of(scene, id, 0, a);
        corner_of(scene, id, 1, b);
        corner_of(scene, id, 2, c);
        for (int i = 0; i < 3; ++i) {
            ab[i] = b[i] - a[i];
            ac[i] = c[i] - a[i];
            from[i] = origin[i] - a[i];
        }
        cross(ab, ac, n);
        double d = -dot(direction, n);
        cross(from, direction, q);
        double t = dot(from, n) / d, u = dot(ac, q) / d, v = -dot(ab, q) / d;
        if (!(u <= 0.0) && !(v <= 0.0) && !(u + v >= 1.0) && t > least && t < most) {
            most = t;
            memcpy(normal, n, sizeof n);
        }
    }
    return most;
}

/* 1: the light reaches what the camera sees there, 0: not, -1: nothing is seen. */
static int is_lit(const gw_scene *scene, const gw_camera *camera, double x, double y) {
    double eye[3], direction[3], normal[3] = {0, 0, 0}, unused[3], point[3], towards[3];
    for (int i = 0; i < 3; ++i) {
        eye[i] = camera->state.eye[i] / 1000.0;
        direction[i] =
            (camera->plane.corner[i] + camera->plane.step_x[i] * x + camera->plane.step_y[i] * y) / 1000.0 -
            eye[i];
    }
    double t = nearest(scene, eye, direction, 0.0, 1e9, normal);
    if (t == 1e9)
        return -1;
    const gw_light *light = &scene->lights[0];
    for (int i = 0; i < 3; ++i) {
        point[i] = eye[i] + t * direction[i];
        towards[i] = light->kind == GW_LIGHT_POINT ? light->vector[i] - point[i] : -light->vector[i];
    }
    if (dot(normal, towards) * dot(normal, direction) >= 0.0)
        return 0;
    double most = light->kind == GW_LIGHT_POINT ? 1.0 : 1e9;
    return nearest(scene, point, towards, 1e-9, most, unused) == most;
}

/* A finely cut ball above a floor, and a thin plate that stands on it. */
static gw_mesh ball_and_plate(void) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-2, 0, -2}, (const double[]){4, 0, 0}, (const double[]){0, 0, 4},
                     2, 2);
    gw_mesh_add_sphere(&mesh, (const double[]){-0.4, 0.8, 0.1}, 0.5, 0.0, 20, 12);
    gw_mesh_add_grid(&mesh, (const double[]){0.5, 0, -0.6}, (const double[]){0.3, 0, 0.9},
                     (const double[]){0, 0.7, 0}, 1, 1);
    return mesh;
}

static void shadows_end_where_double_precision_says(void **state) {
    (void)state;
    const gw_light lights[] = {lamp(0.9, 2.2, 0.7), sun(-0.5, -0.8, 0.3), sun(-1, -0.08, -0.2)};
    static const double places[5][2] = {{0.5, 0.5}, {0.48, 0.5}, {0.52, 0.5}, {0.5, 0.48}, {0.5, 0.52}};
    for (size_t l = 0; l < sizeof lights / sizeof lights[0]; ++l) {
        gw_stage stage;
        gw_camera camera;
        gw_counters counters = {0};
        gw_mesh mesh = ball_and_plate();
        open_lit(&stage, &mesh, &lights[l], NULL,
                 (const char *const[]){"octree_depth=7", "tau_inside=0", NULL});
        gw_camera_look(&camera, &stage, (const double[]){1.5, 3.2, 3.4}, (const double[]){0, 0.2, 0}, 40,
                       SIDE);
        uint8_t *rgba = take(&stage, &camera, 0, &counters);
        size_t unclear = 0, wrong = 0, dark = 0;
        for (int i = 0; i < PIXELS; ++i) {
            int votes[3] = {0};
            for (int p = 0; p < 5; ++p)
                ++votes[1 + is_lit(stage.scene, &camera, i % SIDE + places[p][0], i / SIDE + places[p][1])];
            unclear += votes[0] % 5 || votes[1] % 5 || votes[2] % 5;
            wrong += (votes[2] == 5 && rgba[i * 4] == 0) || (votes[1] == 5 && rgba[i * 4] > 0);
            dark += votes[1] == 5;
        }
        print_message("light %zu: %zu pixels in the dark, %zu wrong, %zu on an edge; %u shadow rays\n", l,
                      dark, wrong, unclear, (unsigned)counters.shadow_rays);
        assert_int_equal(wrong, 0);
        assert_true(dark > PIXELS / 20 && unclear < PIXELS / 20);
        assert_true(counters.shadow_rays > 0 && counters.shadow_rays < counters.rays);
        assert_int_equal(counters.step_cap_hits, 0);
        free(rgba);
        gw_stage_close(&stage);
    }
}

/* --- acne: what is convex casts no shadow on what faces the light --- */

typedef struct acne {
    size_t pixels; /* that shadows change */
    double lost;   /* share of the light */
} acne;

static acne changed_by_shadows(gw_mesh mesh, const gw_light *light, const double eye[3], const double at[3],
                               float tau, const char *shaders) {
    gw_stage stage;
    gw_camera camera;
    open_lit(&stage, &mesh, light, shaders, (const char *const[]){"octree_depth=9", NULL});
    gw_camera_look(&camera, &stage, eye, at, 40, SIDE);
    camera.state.tau_inside = tau;
    uint8_t *with = take(&stage, &camera, 0, NULL),
            *without = take(&stage, &camera, GW_FEATURE_SHADOWS, NULL);
    acne found = {0, 1.0 - gw_mean_linear(with, PIXELS) / gw_mean_linear(without, PIXELS)};
    for (size_t i = 0; i < PIXELS; ++i)
        found.pixels += memcmp(with + i * 4, without + i * 4, 4) != 0;
    assert_true(lit_pixels(without) > PIXELS / 8);
    free(with);
    free(without);
    gw_stage_close(&stage);
    return found;
}

/* Far from the origin, under a sun from the side. */
static acne acne_of_ball(float tau, const char *shaders) {
    const double centre[3] = {148376, 1234, -223423}, eye[3] = {148378, 1235.4, -223421};
    gw_light light = sun(-0.7, -0.4, 0.2);
    gw_mesh mesh = {0};
    gw_mesh_add_sphere(&mesh, centre, 1.0, 0.0, 48, 32);
    return changed_by_shadows(mesh, &light, eye, centre, tau, shaders);
}

/* A floor oblique to the cells, under a low sun (rad), seen from close by. */
static acne acne_of_floor(uint32_t cuts, double height_of_sun, float tau, const char *shaders) {
    const double tilt = 0.3, c = cos(tilt), s = sin(tilt),
                 eye[3] = {0.31, cuts > 1 ? 3.3 : 0.33, cuts > 1 ? 4.1 : 0.41}, at[3] = {0.3, 0.1, 0.2};
    gw_light light = {.kind = GW_LIGHT_DIRECTIONAL,
                      .vector = {c * cos(height_of_sun) + s * sin(height_of_sun),
                                 s * cos(height_of_sun) - c * sin(height_of_sun), 0},
                      .color = {0, 0, 0}};
    for (int i = 0; i < 3; ++i)
        light.color[i] = (float)(3.0 / sin(height_of_sun));
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-c, -s, -1}, (const double[]){2 * c, 2 * s, 0},
                     (const double[]){0, 0, 2}, cuts, cuts);
    return changed_by_shadows(mesh, &light, eye, at, tau, shaders);
}

static void surfaces_cast_no_shadow_on_themselves(void **state) {
    (void)state;
    char folder[512];
    const char *none = gw_naive_shaders(folder, "no-offset", "common/surface_offset.glsl", "NO_OFFSET");
    assert_int_equal(acne_of_ball(0.0f, NULL).pixels, 0);
    assert_int_equal(acne_of_floor(1, 1e-2, 0.0f, NULL).pixels, 0);
    assert_int_equal(acne_of_floor(1, 1e-3, 0.0f, NULL).pixels, 0);
    size_t ball = acne_of_ball(0.0f, none).pixels, floor = acne_of_floor(1, 1e-2, 0.0f, none).pixels;
    print_message("without offset: ball %zu wrong pixels, floor %zu\n", ball, floor);
    assert_true(ball > PIXELS / 100 && floor > PIXELS / 100); /* the naive rule fails */
}

/* What a voxel holds must not stand in its own light, nor what is as wide as the ray before the triangle that
 * it leaves. */
static void voxels_cast_no_shadow_on_themselves(void **state) {
    (void)state;
    static const float taus[] = {0.5f, 1.0f, 2.0f, 4.0f};
    char folder[512];
    const char *naive = gw_naive_shaders(folder, "no-reach", "shade/secondary_start.glsl", "NO_REACH");
    for (size_t i = 0; i < sizeof taus / sizeof taus[0]; ++i) {
        acne ball = acne_of_ball(taus[i], NULL), steep = acne_of_floor(200, 0.5, taus[i], NULL),
             low = acne_of_floor(200, 1e-2, taus[i], NULL);
        acne naive_ball = acne_of_ball(taus[i], naive), naive_low = acne_of_floor(200, 1e-2, taus[i], naive);
        print_message(
            "tau %g: light lost on the ball %.5f, on the floor %.5f and %.5f; without reach %.3f, %.3f\n",
            (double)taus[i], ball.lost, steep.lost, low.lost, naive_ball.lost, naive_low.lost);
        assert_true(ball.lost < 0.01 && steep.lost < 1e-4 && low.lost < 1e-4);
        assert_true(naive_low.lost > 0.004); /* the naive rule fails */
    }
}

/* --- contacts --- */

/* Pixels that are lit where a ledge, 1 mm high on a floor of 2 m, keeps a sun of 45 degrees away. */
static size_t lit_behind_ledge(const char *shaders) {
    const gw_light light = sun(-1, -1, 0);
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){2, 0, 0}, (const double[]){0, 0, 2},
                     3, 3);
    gw_mesh_add_grid(&mesh, (const double[]){0, 0, -1}, (const double[]){0, 1e-3, 0},
                     (const double[]){0, 0, 2}, 1, 40);
    gw_stage stage;
    gw_camera camera;
    open_lit(&stage, &mesh, &light, shaders, (const char *const[]){"octree_depth=10", "tau_inside=0", NULL});
    gw_camera_look(&camera, &stage, (const double[]){-0.6e-3, 0.1, 0}, (const double[]){-0.6e-3, 0, 0}, 1.0,
                   SIDE);
    uint8_t *rgba = take(&stage, &camera, 0, NULL);
    size_t lit = 0, shaded = 0;
    for (int i = 0; i < PIXELS; ++i) {
        double x = camera.plane.corner[0] + camera.plane.step_x[0] * (i % SIDE + 0.5) +
                   camera.plane.step_y[0] * (i / SIDE + 0.5);
        double eye_x = camera.state.eye[0], height = camera.state.eye[1] - camera.plane.corner[1];
        double on_floor = eye_x + (x - eye_x) * camera.state.eye[1] / height; /* mm */
        if (on_floor > -0.93 && on_floor < -0.02) {
            ++shaded;
            lit += rgba[i * 4] > 0;
        } else if (on_floor < -1.07) {
            assert_true(rgba[i * 4] > 0);
        }
    }
    assert_true(shaded > PIXELS / 4);
    free(rgba);
    gw_stage_close(&stage);
    return lit;
}

static void contacts_do_not_leak(void **state) {
    (void)state;
    char folder[512];
    const char *wide = gw_naive_shaders(folder, "wide-offset", "common/surface_offset.glsl", "WIDE_OFFSET");
    size_t lit = lit_behind_ledge(NULL), naive = lit_behind_ledge(wide);
    print_message("behind the ledge: %zu pixels lit; offset 1e-3: %zu\n", lit, naive);
    assert_int_equal(lit, 0);
    assert_true(naive > PIXELS / 10); /* the naive rule fails */
}

/* A closed box with a lamp in it, on a floor: from outside nothing is lit. Sides of 1 lie in planes of cells.
 */
static gw_mesh box_on_floor(double side) {
    gw_mesh mesh = {0};
    for (int axis = 0; axis < 3; ++axis)
        for (int far = 0; far < 2; ++far) {
            double corner[3] = {-0.5 * side, 0, -0.5 * side}, u[3] = {0}, v[3] = {0};
            corner[axis] += far * side;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = side;
            gw_mesh_add_grid(&mesh, corner, u, v, 20, 20);
        }
    gw_mesh_add_grid(&mesh, (const double[]){-1.5, 0, -1.5}, (const double[]){3, 0, 0},
                     (const double[]){0, 0, 3}, 30, 30);
    return mesh;
}

/* Share of the light that would be there without walls. */
static double leak_of_box(double side, float tau, float shadow_tau, int near_light, const char *shaders) {
    const gw_light light = lamp(0.1, 0.4, 0.2);
    gw_stage stage;
    gw_camera camera;
    gw_mesh mesh = box_on_floor(side);
    open_lit(&stage, &mesh, &light, shaders, (const char *const[]){"octree_depth=8", NULL});
    gw_camera_look(&camera, &stage, (const double[]){1.6, 1.4, 2.1}, (const double[]){0, 0.3, 0}, 50, SIDE);
    camera.state.tau_inside = tau;
    camera.state.shadow_tau = shadow_tau;
    camera.state.near_light = (uint8_t)near_light;
    uint8_t *rgba = take(&stage, &camera, 0, NULL),
            *without = take(&stage, &camera, GW_FEATURE_SHADOWS, NULL);
    double leak = gw_mean_linear(rgba, PIXELS) / gw_mean_linear(without, PIXELS);
    free(rgba);
    free(without);
    gw_stage_close(&stage);
    return leak;
}

/* None with shadows as coarse as the picture, unless rays towards the lamp, which is near, start where voxels
 * of the walls reach. Where shadows are finer than voxels, those at the box's edges, through which coarse
 * rays see into it, show the light that is in there. */
static void little_light_leaves_a_closed_box(void **state) {
    (void)state;
    static const float taus[] = {0, 1, 2, 4};
    static const double most[] = {0, 0.01, 0.015, 0.05};
    double leaks[4];
    for (size_t i = 0; i < 4; ++i) {
        leaks[i] = leak_of_box(1.0, taus[i], 1.0f, 32, NULL);
        double beside = leak_of_box(0.97, taus[i], 0.25f, 32, NULL);
        print_message("tau %g: %.4f and %.4f of the light leave the box\n", (double)taus[i], leaks[i],
                      beside);
        assert_true(leaks[i] < 1e-4 && beside <= most[i]);
    }
    /* Triangles that are dropped because a voxel shows their place. */
    char folder[512];
    double naive = leak_of_box(
        1.0, 1.0f, 1.0f, 32, gw_naive_shaders(folder, "dropping", "blend/opacity.glsl", "SHADOW_LEAF_BLEND"));
    print_message("hits dropped: %.4f of the light leaves the box\n", naive);
    assert_true(naive > leaks[1] + 0.001); /* the naive rule fails */
    naive = leak_of_box(1.0, 1.0f, 1.0f, 0, NULL);
    print_message("near_light 0: %.4f of the light leaves the box\n", naive);
    assert_true(naive > leaks[1] + 0.001);
}

/* Rays that reach a lamp in the open have met nothing, also where voxels may stand in between: a lamp lights
 * as much with them as without. */
static void a_lamp_is_reached_among_voxels(void **state) {
    (void)state;
    static const float taus[] = {0, 0.02f, 1};
    const gw_light light = lamp(0.6, 0.7, 0.5);
    double light_seen[3];
    gw_stage stage;
    gw_camera camera;
    gw_mesh mesh = ball_and_plate();
    open_lit(&stage, &mesh, &light, NULL, (const char *const[]){"octree_depth=8", NULL});
    gw_camera_look(&camera, &stage, (const double[]){1.6, 1.4, 2.1}, (const double[]){0, 0.3, 0}, 50, SIDE);
    for (size_t i = 0; i < 3; ++i) {
        camera.state.tau_inside = taus[i];
        uint8_t *rgba = take(&stage, &camera, 0, NULL);
        light_seen[i] = gw_mean_linear(rgba, PIXELS);
        free(rgba);
    }
    gw_stage_close(&stage);
    print_message("mean of the picture at tau 0, 0.02, 1: %.4f %.4f %.4f\n", light_seen[0], light_seen[1],
                  light_seen[2]);
    assert_true(light_seen[0] > 0.02);
    assert_true(fabs(light_seen[1] / light_seen[0] - 1) < 0.01);
    assert_true(fabs(light_seen[2] / light_seen[0] - 1) < 0.1);
}

/* --- alpha --- */

/* A floor under a plate whose texture is clear for x < 0 and has `alpha` beyond; seen from below the plate,
 * lit from above. Mean light of the floor on both sides of x = 0. */
static void under_texture(gw_alpha_mode mode, uint8_t alpha, float tau, double sides[2]) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){2, 0, 0}, (const double[]){0, 0, 2},
                     20, 20);
    gw_mesh_add_grid(&mesh, (const double[]){-1, 1, -1}, (const double[]){2, 0, 0}, (const double[]){0, 0, 2},
                     20, 20);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    scene->textures = calloc(1, sizeof *scene->textures);
    scene->lights = calloc(1, sizeof *scene->lights);
    assert_true(materials && scene->textures && scene->lights);
    check_ok(gw_image_create(16, 16, &scene->textures[0].image, &error));
    for (int i = 0; i < 256; ++i)
        memcpy(scene->textures[0].image.rgba + (size_t)i * 4,
               (const uint8_t[]){255, 255, 255, i % 16 < 8 ? 0 : alpha}, 4);
    scene->texture_count = scene->light_count = 1;
    scene->lights[0] = (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0, -1, 0}, .color = {2, 2, 2}};
    for (int m = 0; m < 2; ++m)
        materials[m] = (gw_material){.base_color = {1, 1, 1, 1}, .roughness = 1, .base_color_texture = m - 1};
    materials[1].alpha_mode = mode;
    materials[1].alpha_cutoff = 0.5f;
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    for (uint32_t i = 0; i < scene->triangle_count; ++i)
        scene->material_of[i] = scene->positions[scene->triangles[i][0] * 3 + 1] > 0.0f;
    for (uint32_t v = 0; v < scene->vertex_count; ++v)
        scene->texcoords[v * 2] =
            (float)(0.5 * (ldexp((double)scene->positions[v * 3], scene->exponent) + scene->centre[0]) + 0.5);
    for (int i = 0; i < 3; ++i)
        scene->ambient[i] = scene->background[i] = 0.0f;
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=6", NULL}, &error));
    gw_camera_look(&camera, &stage, (const double[]){0.01, 0.9, 0.02}, (const double[]){0, 0, 0}, 80, SIDE);
    camera.state.tau_inside = tau;
    uint8_t *rgba = take(&stage, &camera, 0, NULL);
    double sum[2] = {0, 0};
    for (int y = SIDE / 4; y < SIDE * 3 / 4; ++y)
        for (int x = 0; x < SIDE * 3 / 8; ++x) {
            sum[1] += gw_srgb_code_to_linear(rgba[(y * SIDE + x) * 4]); /* +x is on the picture's left */
            sum[0] += gw_srgb_code_to_linear(rgba[(y * SIDE + SIDE - 1 - x) * 4]);
        }
    for (int i = 0; i < 2; ++i)
        sides[i] = sum[i] / (SIDE / 2 * (SIDE * 3 / 8)) * (3.14159265 / 2.0);
    free(rgba);
    gw_stage_close(&stage);
}

static void leaves_cast_shadows_in_their_shape(void **state) {
    (void)state;
    for (int t = 0; t < 2; ++t) {
        const float tau = t ? 0.01f : 0.0f; /* the kernel with voxels where none is coarse enough */
        double opaque[2], masked[2], blended[2];
        under_texture(GW_ALPHA_OPAQUE, 255, tau, opaque);
        under_texture(GW_ALPHA_MASK, 255, tau, masked);
        under_texture(GW_ALPHA_BLEND, 128, tau, blended);
        print_message("light under a plate, on its clear side and on the other: opaque %.3f %.3f, masked "
                      "%.3f %.3f, blended %.3f %.3f\n",
                      opaque[0], opaque[1], masked[0], masked[1], blended[0], blended[1]);
        /* What the surface has of diffuse and specular reflection, seen from above, is near 1. */
        assert_true(opaque[0] == 0.0 && opaque[1] == 0.0);
        assert_true(fabs(masked[0] - 1.0) < 0.1 && masked[1] == 0.0);
        assert_true(fabs(blended[0] - 1.0) < 0.1 && fabs(blended[1] - 0.5) < 0.06);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shadows_end_where_double_precision_says),
        cmocka_unit_test(surfaces_cast_no_shadow_on_themselves),
        cmocka_unit_test(contacts_do_not_leak),
        cmocka_unit_test(little_light_leaves_a_closed_box),
        cmocka_unit_test(a_lamp_is_reached_among_voxels),
        cmocka_unit_test(leaves_cast_shadows_in_their_shape),
        cmocka_unit_test(voxels_cast_no_shadow_on_themselves),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
