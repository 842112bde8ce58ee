/* Pixels of coarse samples: silhouettes stay where they are, nothing gets a fringe, and no border between
 * rates can be found. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/acuity_filter.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"
#include "tests/support/sample_lists.h"

#include <math.h>

enum { SIDE = 240, PIXELS = SIDE * SIDE, FINE_SIDE = 480 };

/* A scene, its renderer, and a camera whose viewer looks at one side of the picture. */
typedef struct view {
    gw_stage stage;
    gw_renderer *renderer;
    gw_camera camera;
} view;

static void open_view(view *v, gw_scene *scene, const char *slope, double fov, uint32_t side, double gaze_x) {
    check_ok(gw_stage_open(
        &v->stage, scene, NULL,
        (const char *const[]){"octree_depth=7", "geometry=triangles", "gaze_margin=0", slope, NULL}, &error));
    v->renderer = gw_stage_renderer(&v->stage);
    gw_camera_look(&v->camera, &v->stage, (const double[]){0, 0, 2}, (const double[]){0, 0, 0}, fov, side);
    gw_camera_gaze(&v->camera, gaze_x, side / 2.0, 2.0);
}

static void close_view(view *v) {
    gw_renderer_destroy(&v->renderer);
    gw_stage_close(&v->stage);
}

static uint8_t *take(const view *v, int reconstruction, int rate_blend) {
    gw_camera camera = v->camera;
    camera.state.reconstruction = (uint8_t)reconstruction;
    camera.state.rate_blend = (uint8_t)rate_blend;
    return gw_camera_take(&camera, v->renderer, NULL);
}

/* Four rays for every pixel. */
static uint8_t *take_full(const view *v) {
    gw_camera camera = v->camera;
    camera.state.sample_block = 0;
    camera.state.samples = 2;
    camera.state.gaze_footprint = 0;
    return gw_camera_take(&camera, v->renderer, NULL);
}

static void add_quad(gw_mesh *mesh, double x, double y, double z, double ux, double uy, double vx,
                     double vy) {
    const double corner[3] = {x, y, z}, u[3] = {ux, uy, 0}, w[3] = {vx, vy, 0};
    gw_mesh_add_grid(mesh, corner, u, w, 1, 1);
}

/* White bars, upright, tilted and nearly level, before a wall of dark red; bars and wall differ only in place
 * and material. */
static gw_scene *bars(void) {
    gw_mesh mesh = {0};
    add_quad(&mesh, -3, -3, -1, 6, 0, 0, 6);
    add_quad(&mesh, -0.55, -0.8, 0, 0.2, 0, 0.25, 1.6);
    add_quad(&mesh, 0.35, -0.7, 0, 0.18, 0, 0.02, 0.8);
    add_quad(&mesh, 0.1, 0.35, 0, 0.7, 0.15, 0, 0.2);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    assert_non_null(materials);
    for (int i = 0; i < 2; ++i)
        materials[i] = (gw_material){.base_color = {0.9f, i ? 0.9f : 0.1f, i ? 0.9f : 0.1f, 1},
                                     .roughness = 1,
                                     .base_color_texture = -1};
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    for (uint32_t i = 0; i < scene->triangle_count; ++i)
        scene->material_of[i] = i >= 2;
    return scene;
}

static double rms_between(const uint8_t *a, const uint8_t *b) {
    double sum = 0;
    for (size_t i = 0; i < PIXELS * 4; ++i) {
        double d = gw_srgb_code_to_linear(a[i]) - gw_srgb_code_to_linear(b[i]);
        sum += d * d;
    }
    return sqrt(sum / (3.0 * PIXELS));
}

/* The same behind what the viewer resolves. */
static double seen_rms_between(const view *v, const uint8_t *a, const uint8_t *b) {
    const gw_camera *c = &v->camera;
    gw_frame_block block;
    gw_image images[2] = {{0}}, seen[2] = {{0}};
    check_ok(gw_frame_block_fill(v->stage.scene, v->stage.octree, &c->placement, &c->plane, &c->state, &block,
                                 NULL, &error));
    for (int i = 0; i < 2; ++i) {
        check_ok(gw_image_create(SIDE, SIDE, &images[i], &error));
        memcpy(images[i].rgba, i ? b : a, PIXELS * 4);
        check_ok(gw_acuity_filter(&images[i], &block, &seen[i], &error));
        gw_image_finish(&images[i]);
    }
    double rms = rms_between(seen[0].rgba, seen[1].rgba);
    gw_image_finish(&seen[0]);
    gw_image_finish(&seen[1]);
    return rms;
}

/* Edge-aware pictures are nearer the full-rate one than tents and cubics are, also in what can be seen. */
static void silhouettes_stay_where_they_are(void **state) {
    static const char *const names[] = {"bilinear", "cubic", "edge-aware"};
    double error_of[3], seen[3];
    view v;
    (void)state;
    open_view(&v, bars(), "acuity_slope=0.1", 50, SIDE, -200);
    uint8_t *full = take_full(&v);
    for (int i = 0; i < 3; ++i) {
        uint8_t *rgba = take(&v, i, 1);
        error_of[i] = rms_between(full, rgba);
        seen[i] = seen_rms_between(&v, full, rgba);
        print_message("# %s: error %.4f, seen %.4f\n", names[i], error_of[i], seen[i]);
        free(rgba);
    }
    const double bound = 0.8 * error_of[0], seen_bound = 0.8 * seen[0];
    assert_true(error_of[2] < bound && error_of[1] > bound);
    assert_true(seen[2] < seen_bound);
    free(full);
    close_view(&v);
}

/* Between wall and bar there is nothing but mixtures of both: no pixel is brighter or darker than both. */
static void nothing_gets_a_fringe(void **state) {
    view v;
    (void)state;
    open_view(&v, bars(), "acuity_slope=0.1", 50, SIDE, -200);
    uint8_t *full = take_full(&v);
    uint8_t least[3] = {255, 255, 255}, most[3] = {0, 0, 0};
    for (size_t i = 0; i < PIXELS * 4; ++i)
        if (i % 4 < 3) {
            least[i % 4] = full[i] < least[i % 4] ? full[i] : least[i % 4];
            most[i % 4] = full[i] > most[i % 4] ? full[i] : most[i % 4];
        }
    for (int kind = 0; kind < 3; ++kind) {
        uint8_t *rgba = take(&v, kind, 1);
        for (size_t i = 0; i < PIXELS * 4; ++i)
            assert_true(i % 4 == 3 || (rgba[i] >= least[i % 4] && rgba[i] <= most[i % 4]));
        free(rgba);
    }
    free(full);
    close_view(&v);
}

/* A rough wall: heights at random, so that every pixel has a shade of its own. */
static gw_scene *rough_wall(void) {
    enum { CELLS = 240 };
    gw_mesh mesh = {0};
    uint64_t random = 7;
    for (int j = 0; j <= CELLS; ++j)
        for (int i = 0; i <= CELLS; ++i)
            gw_mesh_point(&mesh, -0.24 + 0.48 * i / CELLS, -0.24 + 0.48 * j / CELLS,
                          0.002 * gw_test_random(&random));
    for (uint32_t j = 0; j < CELLS; ++j)
        for (uint32_t i = 0; i < CELLS; ++i) {
            uint32_t a = j * (CELLS + 1) + i, b = a + 1, c = a + CELLS + 1;
            gw_mesh_triangle(&mesh, a, b, c);
            gw_mesh_triangle(&mesh, b, c + 1, c);
        }
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k)
        scene->ambient[k] = 0.2f;
    gw_light *light = calloc(1, sizeof *light);
    assert_non_null(light);
    *light = (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .color = {3, 3, 3}, .vector = {-0.6, -0.3, -0.74}};
    scene->lights = light;
    scene->light_count = 1;
    return scene;
}

/* How much a pixel differs from its four neighbours: energy of what is sharp. */
static double sharpness_at(const uint8_t *rgba, int x, int y) {
    static const int around[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double sum = 4 * gw_srgb_code_to_linear(rgba[(y * FINE_SIDE + x) * 4]);
    for (int k = 0; k < 4; ++k)
        sum -= gw_srgb_code_to_linear(rgba[((y + around[k][1]) * FINE_SIDE + x + around[k][0]) * 4]);
    return sum * sum;
}

/* Sharpness (root mean square) of the pixels within `reach` px of the borders between two rates, on the finer
 * and on the coarser side. */
static void sharpness_across(const gw_sample_list *list, const uint8_t *rgba, uint32_t finer, double out[2]) {
    enum { REACH = 4 };
    double sum[2] = {0, 0};
    size_t count[2] = {0, 0};
    for (int y = 1; y < FINE_SIDE - 1; ++y)
        for (int x = 1; x < FINE_SIDE - 1; ++x) {
            uint32_t here = GW_BLOCK_RATE(gw_sample_list_block(list, x / 8, y / 8));
            if (here != finer && here != finer + 1)
                continue;
            int beside = 0;
            for (int k = 0; k < 4; ++k) {
                int u = x + (k == 0   ? REACH
                             : k == 1 ? -REACH
                                      : 0),
                    w = y + (k == 2   ? REACH
                             : k == 3 ? -REACH
                                      : 0);
                if (u < 0 || w < 0 || u >= FINE_SIDE || w >= FINE_SIDE)
                    continue;
                uint32_t there = GW_BLOCK_RATE(gw_sample_list_block(list, u / 8, w / 8));
                beside |= there + here == 2 * finer + 1;
            }
            if (!beside)
                continue;
            sum[here - finer] += sharpness_at(rgba, x, y);
            count[here - finer]++;
        }
    for (int i = 0; i < 2; ++i) {
        assert_true(count[i] > 200);
        out[i] = sqrt(sum[i] / (double)count[i]);
    }
}

/* The largest ratio of sharpness across a border of rates. */
static double largest_step(const view *v, int reconstruction, int rate_blend, const char *name) {
    double largest = 1;
    gw_camera camera = v->camera;
    gw_sample_list list =
        gw_sample_list_take(&camera, v->renderer, (gw_rectangle){0, 0, FINE_SIDE, FINE_SIDE});
    uint8_t *rgba = take(v, reconstruction, rate_blend);
    print_message("# %s:", name);
    for (uint32_t rate = 0; rate < 3; ++rate) {
        double side[2];
        sharpness_across(&list, rgba, rate, side);
        double step = side[0] > side[1] ? side[0] / side[1] : side[1] / side[0];
        print_message(" %.4f|%.4f", side[0], side[1]);
        largest = step > largest ? step : largest;
    }
    print_message(" largest step %.2f\n", largest);
    free(rgba);
    gw_sample_list_finish(&list);
    return largest;
}

/* A picture that falls from rate to rate shows a ring at every border; one that is blended does not. */
static void borders_of_rates_cannot_be_found(void **state) {
    view v;
    (void)state;
    open_view(&v, rough_wall(), "acuity_slope=0.05", 12, FINE_SIDE, -80);
    double abrupt = largest_step(&v, GW_RECONSTRUCTION_BILINEAR, 0, "bilinear, abrupt");
    double sharp = largest_step(&v, GW_RECONSTRUCTION_CUBIC, 0, "cubic, abrupt");
    double blended = largest_step(&v, GW_RECONSTRUCTION_EDGE_AWARE, 1, "edge-aware, blended");
    assert_true(abrupt > 2 && sharp > 2);
    assert_true(blended < 1.6);
    close_view(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(silhouettes_stay_where_they_are),
        cmocka_unit_test(nothing_gets_a_fringe),
        cmocka_unit_test(borders_of_rates_cannot_be_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
