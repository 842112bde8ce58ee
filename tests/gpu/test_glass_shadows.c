/* Shadows of glass: colours of its surfaces, absorption along the way through it, edges that count once. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 24, PIXELS = SIDE * SIDE };
enum { WHITE, GLASS };

typedef struct look {
    double eye[3], target[3], fov;
} look;

/* What lies in a plane y = 0 or z = 0 is white, all else glass of index 1; no light yet. */
static gw_scene *white_and_glass(gw_mesh *mesh) {
    gw_scene *scene = gw_mesh_take(mesh);
    free(scene->materials);
    scene->materials = calloc(2, sizeof *scene->materials);
    scene->extensions = calloc(2, sizeof *scene->extensions);
    assert_true(scene->materials && scene->extensions);
    scene->material_count = 2;
    for (int i = WHITE; i <= GLASS; ++i) {
        scene->materials[i] =
            (gw_material){.base_color = {1, 1, 1, 1}, .roughness = i == WHITE, .base_color_texture = -1};
        scene->extensions[i] = gw_material_extension_none();
    }
    scene->extensions[GLASS].transmission = scene->extensions[GLASS].thickness = 1;
    scene->extensions[GLASS].ior = 1;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        int flat[3] = {1, 1, 1};
        for (int k = 0; k < 9; ++k)
            flat[k % 3] &=
                fabs(ldexp((double)scene->positions[scene->triangles[t][k / 3] * 3 + (uint32_t)k % 3],
                           scene->exponent) +
                     scene->centre[k % 3]) < 1e-5;
        scene->material_of[t] = flat[1] || flat[2] ? WHITE : GLASS;
    }
    for (int i = 0; i < 3; ++i)
        scene->ambient[i] = scene->background[i] = 0;
    return scene;
}

static void open_stage(gw_stage *stage, gw_camera *camera, gw_scene *scene, const look *from,
                       const char *shaders) {
    check_ok(gw_stage_open(stage, scene, shaders,
                           (const char *const[]){"octree_depth=7", "tau_inside=0", NULL}, &error));
    gw_camera_look(camera, stage, from->eye, from->target, from->fov, SIDE);
}

/* A floor under a closed box of coloured glass that a sun's rays cross straight, or with a lamp above or in
 * it: what is left is what its two surfaces let through and what the way in it absorbs. */
static void shadows_of_glass_have_its_color(void **state) {
    (void)state;
    static const look down = {{0, 1.2, 0.01}, {0, 0, 0}, 12};
    static const double tint[3] = {0.9, 0.5, 0.2}, left[3] = {0.8, 0.6, 0.3};
    static const double thick = 0.4, low = 1.4;
    static const struct {
        const char *what;
        int lamp;
        double height; /* of the lamp */
        double way;    /* in glass, m */
        int surfaces;
    } rows[] = {{"sun", 0, 0, 0.4, 2}, {"lamp above", 1, 3, 0.4, 2}, {"lamp in the glass", 1, 1.6, 0.2, 1}};
    for (size_t r = 0; r < sizeof rows / sizeof rows[0]; ++r) {
        double light[2][3];
        for (int box = 0; box < 2; ++box) {
            gw_mesh m = {0};
            gw_mesh_add_grid(&m, (const double[]){-1, 0, -1}, (const double[]){0, 0, 2},
                             (const double[]){2, 0, 0}, 1, 1);
            if (box) {
                gw_mesh_add_box(&m, (const double[]){-0.81, low, -0.83},
                                (const double[]){0.84, low + thick, 0.82});
            }
            gw_scene *scene = white_and_glass(&m);
            gw_material_extension *e = &scene->extensions[GLASS];
            e->ior = 1;
            e->attenuation_distance = 0.5f;
            scene->lights = calloc(1, sizeof *scene->lights);
            assert_non_null(scene->lights);
            scene->light_count = 1;
            gw_light *l = scene->lights;
            l->kind = rows[r].lamp ? GW_LIGHT_POINT : GW_LIGHT_DIRECTIONAL;
            l->vector[1] = rows[r].lamp ? rows[r].height : -1;
            for (int c = 0; c < 3; ++c) {
                scene->materials[GLASS].base_color[c] = (float)tint[c];
                e->attenuation_color[c] = (float)left[c];
                l->color[c] = rows[r].lamp ? (float)(2 * rows[r].height * rows[r].height) : 2;
            }
            gw_stage stage;
            gw_camera camera;
            gw_counters counters = {0};
            open_stage(&stage, &camera, scene, &down, NULL);
            uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, &counters);
            const gw_renderer_options suspended = {.loop_budget = 16};
            uint8_t *again = gw_stage_take(&stage, &camera, &suspended, NULL);
            assert_memory_equal(rgba, again, PIXELS * 4);
            for (int c = 0; c < 3; ++c)
                light[box][c] = gw_srgb_code_to_linear(rgba[(PIXELS / 2 + SIDE / 2) * 4 + c]);
            free(rgba);
            free(again);
            gw_stage_close(&stage);
        }
        for (int c = 0; c < 3; ++c) {
            const double wanted = pow(tint[c], 0.5 * rows[r].surfaces) * pow(left[c], rows[r].way / 0.5),
                         got = light[1][c] / light[0][c];
            print_message("# %s: channel %d %.4f, wanted %.4f\n", rows[r].what, c, got, wanted);
            assert_true(fabs(got - wanted) < 0.012);
        }
    }
}

/* Of a wall behind a slab of glass, under a sun whose rays meet the slab's edges exactly: pixels unlike the
 * first. */
static size_t uneven_pixels(const char *shaders) {
    static const look at_wall = {{0, 0, 0.9}, {0, 0, 0}, 30};
    gw_mesh m = {0};
    gw_mesh_add_grid(&m, (const double[]){-1, -1, 0}, (const double[]){2, 0, 0}, (const double[]){0, 2, 0}, 1,
                     1);
    gw_mesh_add_box(&m, (const double[]){-1, -1, 1}, (const double[]){1, 1, 2});
    gw_scene *scene = white_and_glass(&m);
    scene->extensions[GLASS].attenuation_distance = 1;
    scene->lights = calloc(1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    scene->light_count = 1;
    scene->lights[0].kind = GW_LIGHT_DIRECTIONAL;
    scene->lights[0].vector[2] = -1;
    for (int c = 0; c < 3; ++c) {
        scene->extensions[GLASS].attenuation_color[c] = 0.5f;
        scene->lights[0].color[c] = 2;
    }
    gw_stage stage;
    gw_camera camera;
    size_t uneven = 0;
    open_stage(&stage, &camera, scene, &at_wall, shaders);
    uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, NULL);
    for (size_t i = 0; i < PIXELS * 4; ++i)
        uneven += abs(rgba[i] - rgba[i % 4 + 8]) > 6;
    assert_true(rgba[8] > 60 && rgba[8] < 220);
    free(rgba);
    gw_stage_close(&stage);
    return uneven;
}

static void edges_in_the_light_count_once(void **state) {
    (void)state;
    char folder[512];
    const size_t even = uneven_pixels(NULL),
                 naive = uneven_pixels(
                     gw_naive_shaders(folder, "twice", "shade/shadow_tint.glsl", "EDGES_COUNT_TWICE"));
    print_message("# light through the edges of a slab: %zu channels uneven, %zu if both triangles count\n",
                  even, naive);
    assert_int_equal(even, 0);
    assert_true(naive > 0); /* the naive rule fails */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shadows_of_glass_have_its_color),
        cmocka_unit_test(edges_in_the_light_count_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
