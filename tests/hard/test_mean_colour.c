/* Voxels keep the mean colour of what they stand for: small closed things - bars, boxes, balls - whose fronts
 * and backs lie in different cells, and leaves, that have no back of their own. Everything shines alike
 * before black, so the picture's mean is what is covered. Counting backs breaks the bounds.
 * And of leaves under a sun over the viewer's shoulder: what is seen of them faces the light more than the
 * mean of all their normals, and they stand in each other's light within a voxel, too. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE, RAYS_FACTOR = 4 }; /* 16 rays have a quarter of a pixel's footprint */

static double between(uint64_t *random, double least, double most) {
    return least + (most - least) * gw_test_random(random);
}

/* Three sides at right angles, turned at random. */
static void turned(uint64_t *random, const double sizes[3], double sides[3][3]) {
    double length, along;
    for (int a = 0; a < 2; ++a) {
        do {
            length = along = 0;
            for (int k = 0; k < 3; ++k)
                sides[a][k] = between(random, -1, 1);
            for (int k = 0; a == 1 && k < 3; ++k)
                along += sides[0][k] * sides[1][k];
            for (int k = 0; k < 3; ++k) {
                sides[a][k] -= a == 1 ? along * sides[0][k] : 0;
                length += sides[a][k] * sides[a][k];
            }
        } while (length > 1 || length < 0.01);
        for (int k = 0; k < 3; ++k)
            sides[a][k] /= sqrt(length);
    }
    for (int k = 0; k < 3; ++k)
        sides[2][k] =
            sides[0][(k + 1) % 3] * sides[1][(k + 2) % 3] - sides[0][(k + 2) % 3] * sides[1][(k + 1) % 3];
    for (int a = 0; a < 3; ++a)
        for (int k = 0; k < 3; ++k)
            sides[a][k] *= sizes[a];
}

static void add_box(gw_mesh *mesh, const double at[3], double sides[3][3]) {
    for (int a = 0; a < 3; ++a) {
        const double *u = sides[(a + 1) % 3], *v = sides[(a + 2) % 3];
        const double beyond[3] = {at[0] + sides[a][0], at[1] + sides[a][1], at[2] + sides[a][2]};
        gw_mesh_add_grid(mesh, at, v, u, 3, 3);
        gw_mesh_add_grid(mesh, beyond, u, v, 3, 3);
    }
}

typedef enum thing { BARS, BOXES, BALLS, LEAVES, THINGS } thing;
static const char *const names[] = {"bars", "boxes", "balls", "leaves"};

static gw_scene *make(thing what) {
    static const double box[3] = {0.05, 0.05, 0.05};
    gw_mesh mesh = {0};
    uint64_t random = 5;
    for (int i = 0; i < (what == LEAVES ? 6000 : what == BARS ? 30 : 300); ++i) {
        double at[3], sides[3][3];
        for (int k = 0; k < 3; ++k)
            at[k] = between(&random, -0.95, 0.95);
        turned(&random, box, sides);
        if (what == BALLS)
            gw_mesh_add_sphere(&mesh, at, 0.03, 0, 10, 8);
        else if (what == BOXES)
            add_box(&mesh, at, sides);
        else if (what == LEAVES)
            gw_mesh_add_grid(&mesh, at, sides[0], sides[1], 1, 1);
        else {
            double bar[3][3] = {{0.019, 0.002, 0}, {0.001, 1.9, 0.03}, {-0.002, 0, 0.019}};
            gw_mesh_add_grid(&mesh, (const double[]){-0.95 + 0.0633 * i, -0.95, 0.01}, bar[1], bar[0], 90, 1);
            gw_mesh_add_grid(&mesh, (const double[]){-0.95 + 0.0633 * i, -0.95, 0.01}, bar[2], bar[1], 1, 90);
            for (int a = 0; a < 2; ++a) {
                double corner[3] = {-0.95 + 0.0633 * i, -0.95, 0.01};
                for (int k = 0; k < 3; ++k)
                    corner[k] += bar[a ? 0 : 2][k];
                gw_mesh_add_grid(&mesh, corner, a ? bar[1] : bar[0], a ? bar[2] : bar[1], a ? 90 : 1,
                                 a ? 1 : 90);
            }
        }
    }
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k) {
        scene->ambient[k] = scene->background[k] = scene->materials[0].base_color[k] = 0;
        scene->materials[0].emissive[k] = 0.5f;
    }
    return scene;
}

/* Error of the mean in 1/255 of the sRGB scale, at tau 1 and 2. */
static void errors_of(thing what, const char *shaders, double errors[2]) {
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, make(what), shaders,
                           (const char *const[]){"octree_depth=9", "samples=16", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera_look(&camera, &stage, (const double[]){0.4, 0.3, 5}, (const double[]){0, 0, 0}, 13, SIDE);
    uint8_t *exact = gw_camera_take(&camera, renderer, NULL);
    const double wanted = gw_mean_linear(exact, PIXELS);
    for (int i = 0; i < 2; ++i) {
        camera.state.tau_inside = (float)((i + 1) * RAYS_FACTOR);
        uint8_t *coarse = gw_camera_take(&camera, renderer, NULL);
        errors[i] = 255 * 1.055 * (pow(gw_mean_linear(coarse, PIXELS), 1 / 2.4) - pow(wanted, 1 / 2.4));
        free(coarse);
    }
    print_message("# %s%s: %.1f %% covered, mean off by %+.2f/255 at tau 1, %+.2f at tau 2\n", names[what],
                  shaders ? ", backs counted" : "", 200 * wanted, errors[0], errors[1]);
    free(exact);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static void what_is_covered_stays(void **state) {
    static const double bounds[THINGS][2] = {{15, 21}, {5.5, 10}, {4, 12}, {1, 1}};
    double naive[2], most = 0;
    char folder[512];
    (void)state;
    for (int what = 0; what < THINGS; ++what) {
        double errors[2];
        errors_of((thing)what, NULL, errors);
        for (int i = 0; i < 2; ++i)
            assert_true(fabs(errors[i]) <= bounds[what][i]);
    }
    errors_of(BARS, gw_naive_shaders(folder, "backs", "blend/opacity.glsl", "BACKS_COUNT"), naive);
    for (int i = 0; i < 2; ++i)
        most = fmax(most, naive[i] / bounds[BARS][i]);
    assert_true(most > 1.5);
}

static double mean_of_channel(const uint8_t *rgba, int channel) {
    double sum = 0;
    for (size_t i = 0; i < PIXELS; ++i)
        sum += gw_srgb_code_to_linear(rgba[i * 4 + (size_t)channel]);
    return sum / PIXELS;
}

/* Light that what is covered reflects, over that at tau 0, less 1: without and with shadows. The sun is red,
 * and green light from everywhere tells how much is covered. */
static void errors_of_light(thing what, const char *shaders, const char *name, double errors[2]) {
    enum { TAU = 4 };
    gw_scene *scene = make(what);
    scene->lights = calloc(1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    scene->light_count = 1;
    scene->lights[0] =
        (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.3, -0.27, -0.914}, .color = {2, 0, 0}};
    scene->ambient[1] = 1;
    for (int k = 0; k < 3; ++k) {
        scene->materials[0].base_color[k] = 0.6f;
        scene->materials[0].emissive[k] = 0;
    }
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, scene, shaders,
                           (const char *const[]){"octree_depth=9", "samples=16", NULL}, &error));
    gw_camera_look(&camera, &stage, (const double[]){0.4, 0.3, 5}, (const double[]){0, 0, 0}, 13, SIDE);
    for (int shadows = 0; shadows < 2; ++shadows) {
        const gw_renderer_options options = {.forbid_features = shadows ? 0 : GW_FEATURE_SHADOWS};
        gw_renderer *renderer = NULL;
        double light[2];
        check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &renderer, &error));
        for (int i = 0; i < 2; ++i) {
            camera.state.tau_inside = (float)(TAU * i * RAYS_FACTOR);
            uint8_t *picture = gw_camera_take(&camera, renderer, NULL);
            light[i] = mean_of_channel(picture, 0) / mean_of_channel(picture, 1);
            free(picture);
        }
        errors[shadows] = light[1] / light[0] - 1;
        gw_renderer_destroy(&renderer);
    }
    print_message("# light on %s%s at tau %d: off by %+.3f without shadows, %+.3f with them\n", names[what],
                  name, TAU, errors[0], errors[1]);
    gw_stage_close(&stage);
}

static void light_stays(void **state) {
    double balls[2], leaves[2], unseen[2], far[2];
    char folder[512];
    (void)state;
    errors_of_light(BALLS, NULL, "", balls);
    errors_of_light(LEAVES, NULL, "", leaves);
    errors_of_light(BALLS, gw_naive_shaders(folder, "unseen", "shade/brdf.glsl", "UNSEEN_NORMALS"),
                    ", normals that are not seen", unseen);
    assert_true(fabs(balls[0]) < 0.05 && fabs(balls[1]) < 0.08 && unseen[0] < -0.08);
    errors_of_light(
        LEAVES, gw_naive_shaders(folder, "out-of-reach", "shade/secondary_start.glsl", "ALWAYS_OUT_OF_REACH"),
        ", shadows from out of reach", far);
    assert_true(fabs(leaves[0]) < 0.02 && fabs(leaves[1]) < 0.06 && far[1] > 0.2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_covered_stays),
        cmocka_unit_test(light_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
