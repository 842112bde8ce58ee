/* Where soft shadows and lamps that are surfaces go wrong: emitters in their own light, on curved surfaces a
 * thousand kilometres from the origin, at contacts; lights that lie in a surface or stand half in it; lamps
 * in closed boxes of voxels; rings about a gaze. */
#include "tests/support/check.h"

#include "base/image.h"
#include "base/srgb.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>
#include <string.h>

enum { SIDE = 40, PIXELS = SIDE * SIDE };

/* Takes the mesh; white, its first triangles dull, the others glow. Lights are copied. */
static gw_scene *make_scene(gw_mesh *mesh, const double from[3], const double to[3], float glow,
                            const gw_light *lights, uint32_t count) {
    gw_scene *scene = gw_mesh_take(mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    scene->lights = calloc(count + 1, sizeof *scene->lights);
    assert_true(materials && scene->lights);
    if (count > 0)
        memcpy(scene->lights, lights, count * sizeof *lights);
    scene->light_count = count;
    for (int i = 0; i < 2; ++i)
        materials[i] =
            (gw_material){.base_color = {0.8f, 0.8f, 0.8f, 1}, .roughness = 1, .base_color_texture = -1};
    for (int i = 0; i < 3; ++i) {
        materials[1].emissive[i] = glow;
        materials[1].base_color[i] = 0.0f;
        scene->ambient[i] = scene->background[i] = 0.0f;
    }
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    /* What lies in the box glows. */
    for (uint32_t t = 0; from && t < scene->triangle_count; ++t) {
        int inside = 1;
        for (int k = 0; k < 9; ++k) {
            const double x = ldexp((double)scene->positions[scene->triangles[t][k / 3] * 3 + (uint32_t)k % 3],
                                   scene->exponent) +
                             scene->centre[k % 3];
            inside &= x > from[k % 3] && x < to[k % 3];
        }
        scene->material_of[t] = (uint32_t)inside;
    }
    return scene;
}

/* Pixels that shadows change, and the share of light that they take. */
typedef struct changed {
    size_t pixels, lit;
    double lost;
    gw_counters counters;
} changed;

static changed by_shadows(const gw_stage *stage, const gw_camera *camera, const gw_renderer_options *how) {
    gw_renderer_options without = {.forbid_features = GW_FEATURE_SHADOWS};
    changed found = {0};
    uint8_t *with = gw_stage_take(stage, camera, how, &found.counters),
            *all = gw_stage_take(stage, camera, &without, NULL);
    for (size_t i = 0; i < PIXELS; ++i) {
        found.pixels += memcmp(with + 4 * i, all + 4 * i, 4) != 0;
        found.lit += all[4 * i] > 0 && all[4 * i] < 255;
    }
    found.lost = 1.0 - gw_mean_linear(with, PIXELS) / gw_mean_linear(all, PIXELS);
    assert_int_equal(found.counters.step_cap_hits + found.counters.nan_pixels, 0);
    free(with);
    free(all);
    return found;
}

static const char *const exact[] = {"octree_depth=8", "tau=0", "tau_inside=0", "emissive_least=0", NULL};
static const double far_away[3] = {1e6, -2e6, 1.5e6};

/* A ball that glows, on a floor that it touches. Everything that shines on the floor is seen from there. */
static changed glowing_ball(const char *shaders) {
    const double *o = far_away, middle[3] = {o[0], o[1] + 0.25, o[2]};
    gw_mesh mesh = {0};
    gw_stage stage;
    gw_camera camera;
    gw_mesh_add_grid(&mesh, (const double[]){o[0] - 1, o[1], o[2] - 1}, (const double[]){0, 0, 2},
                     (const double[]){2, 0, 0}, 1, 1);
    gw_mesh_add_sphere(&mesh, middle, 0.25, 0.0, 24, 12);
    gw_scene *scene = make_scene(&mesh, (const double[]){o[0] - 0.6, o[1] - 0.1, o[2] - 0.6},
                                 (const double[]){o[0] + 0.6, o[1] + 0.6, o[2] + 0.6}, 3.0f, NULL, 0);
    check_ok(gw_stage_open(&stage, scene, shaders, exact, &error));
    gw_camera_look(&camera, &stage, (const double[]){o[0] + 0.8, o[1] + 0.5, o[2] + 1},
                   (const double[]){o[0], o[1] + 0.05, o[2]}, 40, SIDE);
    const changed found = by_shadows(&stage, &camera, NULL);
    gw_stage_close(&stage);
    return found;
}

static void emitters_stand_not_in_their_own_light(void **state) {
    (void)state;
    char folder[512];
    const changed ours = glowing_ball(NULL),
                  naive = glowing_ball(
                      gw_naive_shaders(folder, "on-the-emitter", "shade/area_light.glsl", "ON_THE_EMITTER"));
    print_message("a ball that glows: shadows change %zu of %zu lit pixels; of rays that end on it %zu\n",
                  ours.pixels, ours.lit, naive.pixels);
    assert_true(ours.lit > PIXELS / 4 && ours.counters.shadow_rays > PIXELS);
    assert_int_equal(ours.pixels, 0);
    assert_true(naive.pixels > 10); /* the naive rule fails */
}

/* A dull ball under a wide sun and a panel that glows. */
static void curved_surfaces_far_away_have_no_acne(void **state) {
    (void)state;
    const double *o = far_away;
    const gw_light sun = {
        .kind = GW_LIGHT_DIRECTIONAL, .vector = {-0.8, -0.6, 0}, .color = {1, 1, 1}, .extent = 0.4f};
    gw_mesh mesh = {0};
    gw_stage stage;
    gw_camera camera;
    gw_mesh_add_sphere(&mesh, o, 0.5, 0.0, 48, 32);
    gw_mesh_add_grid(&mesh, (const double[]){o[0] - 0.5, o[1] + 0.1, o[2] + 1.2}, (const double[]){0, 1, 0},
                     (const double[]){1, 0, 0}, 1, 1);
    gw_scene *scene = make_scene(&mesh, (const double[]){o[0] - 1, o[1] - 1, o[2] + 1},
                                 (const double[]){o[0] + 1, o[1] + 2, o[2] + 2}, 3.0f, &sun, 1);
    check_ok(gw_stage_open(&stage, scene, NULL, exact, &error));
    gw_camera_look(&camera, &stage, (const double[]){o[0] + 1.6, o[1] + 0.7, o[2] + 0.6}, o, 36, SIDE);
    const changed found = by_shadows(&stage, &camera, NULL);
    camera.state.tau_inside = 2;
    const changed coarse = by_shadows(&stage, &camera, NULL);
    print_message("ball: shadows change %zu of %zu lit pixels; at tau 2 they take %.4f of the light\n",
                  found.pixels, found.lit, coarse.lost);
    assert_true(found.lit > PIXELS / 8);
    assert_int_equal(found.pixels, 0);
    assert_true(fabs(coarse.lost) < 0.02);
    gw_stage_close(&stage);
}

/* --- lights in surfaces --- */

static void look_from_above(gw_camera *camera, const gw_stage *stage, double fov) {
    gw_camera_look(camera, stage, (const double[]){0, 4, 0.001}, (const double[]){0, 0, 0}, fov, SIDE);
}

/* A ball of light of radius r whose middle lies on the floor: half of it is seen, which lights the floor at
 * the distance d with 2 I r / (3 pi d^3) where d is much larger than r (half a disc of light at the horizon).
 */
static void a_light_may_stand_half_in_a_floor(void **state) {
    (void)state;
    const double radius = 0.05, intensity = 30.0, pi = 3.14159265358979;
    const gw_light ball = {.kind = GW_LIGHT_POINT, .color = {30, 30, 30}, .extent = 0.05f};
    gw_mesh mesh = {0};
    gw_stage stage;
    gw_camera camera;
    gw_mesh_add_grid(&mesh, (const double[]){-2, 0, -2}, (const double[]){0, 0, 4}, (const double[]){4, 0, 0},
                     3, 3);
    check_ok(gw_stage_open(&stage, make_scene(&mesh, NULL, NULL, 0, &ball, 1), NULL, exact, &error));
    look_from_above(&camera, &stage, 28);
    camera.state.shadow_samples = 2;
    uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, NULL);
    double seen = 0.0, wanted = 0.0;
    for (int i = 0; i < PIXELS; ++i) {
        double aim[3];
        gw_camera_ray(&camera, (uint32_t)i % SIDE, (uint32_t)i / SIDE, aim);
        const double d = 4.0 * sqrt(aim[0] * aim[0] + aim[2] * aim[2]) / -aim[1];
        if (d < 0.6 || d > 0.95)
            continue;
        seen += (double)gw_srgb_code_to_linear(rgba[4 * i]);
        wanted += 0.8 / pi * 2.0 * intensity * radius / (3.0 * pi * d * d * d);
    }
    const changed shaded = by_shadows(&stage, &camera, NULL);
    print_message("half a ball of light on the floor: %.3f of what it gives; shadows change %zu pixels\n",
                  seen / wanted, shaded.pixels);
    assert_true(fabs(seen / wanted - 1.0) < 0.08);
    assert_int_equal(shaded.pixels, 0);
    free(rgba);
    gw_stage_close(&stage);
}

/* A rectangle in the very plane of a ceiling lights the floor and, at grazing angles, the wall. */
static changed flush_rectangle(const char *shaders) {
    const gw_light panel = {.kind = GW_LIGHT_RECTANGLE,
                            .vector = {0.1, 1.03, 0},
                            .color = {2, 2, 2},
                            .sides = {{0.7f, 0.21f, 0}, {0, 0, 0.9f}}};
    gw_mesh mesh = {0};
    gw_stage stage;
    gw_camera camera;
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){0, 0, 2}, (const double[]){2, 0, 0},
                     3, 3);
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0.7, -1}, (const double[]){2, 0.6, 0},
                     (const double[]){0, 0, 2}, 7, 7);
    gw_mesh_add_grid(&mesh, (const double[]){1, 0, -1}, (const double[]){0, 0, 2},
                     (const double[]){0, 1.3, 0}, 3, 3);
    check_ok(gw_stage_open(&stage, make_scene(&mesh, NULL, NULL, 0, &panel, 1), shaders, exact, &error));
    gw_camera_look(&camera, &stage, (const double[]){-0.8, 0.4, 0.6}, (const double[]){1, 0.9, -0.2}, 60,
                   SIDE);
    const changed found = by_shadows(&stage, &camera, NULL);
    gw_stage_close(&stage);
    return found;
}

static void a_lamp_may_lie_in_a_ceiling(void **state) {
    (void)state;
    char folder[512];
    const changed ours = flush_rectangle(NULL),
                  naive = flush_rectangle(
                      gw_naive_shaders(folder, "in-the-plane", "shade/area_light.glsl", "ON_THE_EMITTER"));
    print_message(
        "a rectangle in a ceiling: shadows change %zu of %zu lit pixels; of rays that end in its plane "
        "%zu\n",
        ours.pixels, ours.lit, naive.pixels);
    assert_true(ours.lit > PIXELS / 4);
    assert_int_equal(ours.pixels, 0);
    assert_true(naive.pixels > 0); /* the naive rule fails */
}

/* --- walls --- */

/* A box on a floor, closed, and in it a ball of light and one that glows. Share of their light that is seen
 * outside. */
static void open_box(gw_stage *stage, gw_camera *camera, const char *shaders) {
    const gw_light ball = {
        .kind = GW_LIGHT_POINT, .vector = {0.1, 0.4, 0.2}, .color = {3, 3, 3}, .extent = 0.1f};
    const double least[3] = {-0.45, 0.05, -0.45}, most[3] = {0.45, 0.95, 0.45};
    gw_mesh mesh = {0};
    for (int axis = 0; axis < 3; ++axis)
        for (int far = 0; far < 2; ++far) {
            double corner[3] = {-0.5, 0, -0.5}, u[3] = {0}, v[3] = {0};
            corner[axis] += far;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1.0;
            gw_mesh_add_grid(&mesh, corner, u, v, 12, 12);
        }
    gw_mesh_add_grid(&mesh, (const double[]){-1.5, 0, -1.5}, (const double[]){3, 0, 0},
                     (const double[]){0, 0, 3}, 20, 20);
    gw_mesh_add_sphere(&mesh, (const double[]){-0.2, 0.5, -0.1}, 0.1, 0.0, 10, 6);
    check_ok(gw_stage_open(stage, make_scene(&mesh, least, most, 20.0f, &ball, 1), shaders,
                           (const char *const[]){"octree_depth=7", NULL}, &error));
    gw_camera_look(camera, stage, (const double[]){1.6, 1.4, 2.1}, (const double[]){0, 0.3, 0}, 50, SIDE);
}

static void little_soft_light_leaves_a_closed_box(void **state) {
    (void)state;
    static const float taus[] = {0, 1, 3};
    char folder[512];
    gw_stage stage;
    gw_camera camera;
    open_box(&stage, &camera, NULL);
    for (size_t t = 0; t < 3; ++t) {
        camera.state.tau_inside = taus[t];
        const double leak = 1.0 - by_shadows(&stage, &camera, NULL).lost;
        print_message("tau %g: %.5f of the light leaves the box\n", (double)taus[t], leak);
        assert_true(leak < 1e-4);
    }
    gw_stage_close(&stage);
    /* Triangles that are dropped because a voxel shows their place. */
    open_box(&stage, &camera,
             gw_naive_shaders(folder, "soft-dropping", "blend/opacity.glsl", "SHADOW_LEAF_BLEND"));
    camera.state.tau_inside = 1;
    const double naive = 1.0 - by_shadows(&stage, &camera, NULL).lost;
    print_message("hits dropped: %.5f\n", naive);
    gw_stage_close(&stage);
    assert_true(naive > 1e-3); /* the naive rule fails */
}

/* --- gaze --- */

/* Signed mean of what a gaze changes, in codes: within its ellipse, while voxels come in, and beyond. */
static void bands_about_gaze(const char *shaders, double bands[3]) {
    const double half = 6.0;
    const gw_light lights[2] = {
        {.kind = GW_LIGHT_DIRECTIONAL, .vector = {-0.6, -0.3, 0.2}, .color = {2, 2, 2}, .extent = 0.2f},
        {.kind = GW_LIGHT_POINT, .vector = {0.3, 1.5, 0.4}, .color = {2, 2, 2}, .extent = 0.2f}};
    gw_mesh mesh = {0};
    gw_stage stage;
    gw_camera camera;
    size_t counts[3] = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-2, -0.3, -2}, (const double[]){0, 0.2, 4},
                     (const double[]){4, 0.3, 0}, 90, 90);
    gw_scene *scene = make_scene(&mesh, NULL, NULL, 0, lights, 2);
    for (int i = 0; i < 3; ++i)
        scene->lights[0].vector[i] /= 0.7;
    check_ok(gw_stage_open(
        &stage, scene, shaders,
        (const char *const[]){"octree_depth=8", "sample_block=1", "tau=3", "gaze_margin=0", NULL}, &error));
    gw_camera_look(&camera, &stage, (const double[]){0.4, 2.6, 2.2}, (const double[]){0, 0, 0}, 44, SIDE);
    uint8_t *sharp = gw_stage_take(&stage, &camera, NULL, NULL);
    gw_camera_gaze(&camera, SIDE / 2, SIDE / 2, half);
    uint8_t *gazed = gw_stage_take(&stage, &camera, NULL, NULL);
    double middle[3];
    gw_camera_ray(&camera, SIDE / 2, SIDE / 2, middle);
    bands[0] = bands[1] = bands[2] = 0.0;
    for (int i = 0; i < PIXELS; ++i) {
        double aim[3];
        gw_camera_ray(&camera, (uint32_t)i % SIDE, (uint32_t)i / SIDE, aim);
        const double cosine = aim[0] * middle[0] + aim[1] * middle[1] + aim[2] * middle[2];
        const double angle = acos(fmin(cosine, 1.0)) * 57.29578;
        const int band = angle < half - 1.0 ? 0 : angle < half + 4.0 ? 1 : 2;
        if (sharp[4 * i] == 0 || sharp[4 * i] == 255)
            continue;
        bands[band] += (double)gazed[4 * i] - (double)sharp[4 * i];
        ++counts[band];
    }
    for (int b = 0; b < 3; ++b) {
        assert_true(counts[b] > 40);
        bands[b] /= (double)counts[b];
    }
    free(sharp);
    free(gazed);
    gw_stage_close(&stage);
}

static void no_ring_follows_the_gaze(void **state) {
    (void)state;
    char folder[512];
    double ours[3], naive[3];
    bands_about_gaze(NULL, ours);
    bands_about_gaze(gw_naive_shaders(folder, "soft-no-reach", "shade/secondary_start.glsl", "NO_REACH"),
                     naive);
    print_message(
        "a gaze changes its middle by %.2f, its border by %.2f, what lies beyond by %.2f codes; without "
        "reach %.2f, %.2f, %.2f\n",
        ours[0], ours[1], ours[2], naive[0], naive[1], naive[2]);
    assert_true(fabs(ours[0]) < 0.1 && fabs(ours[1] - ours[2]) < 2.0 && fabs(ours[2]) < 4.0);
    assert_true(naive[1] < -20.0); /* the naive rule fails */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(emitters_stand_not_in_their_own_light),
        cmocka_unit_test(curved_surfaces_far_away_have_no_acne),
        cmocka_unit_test(a_light_may_stand_half_in_a_floor),
        cmocka_unit_test(a_lamp_may_lie_in_a_ceiling),
        cmocka_unit_test(little_soft_light_leaves_a_closed_box),
        cmocka_unit_test(no_ring_follows_the_gaze),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
