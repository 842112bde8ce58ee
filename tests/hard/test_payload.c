/* What voxels keep of their contents: colours by area, normals that do not turn aside. The rules that fail
 * here are kept as settings (payload_rule = seed) or as pictures taken with them. */
#include "tests/support/check.h"

#include "base/memory.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE };

static gw_scene *scene_of(gw_mesh *mesh) {
    gw_scene *scene = NULL;
    check_ok(gw_mesh_scene(mesh, &scene, &error));
    gw_mesh_finish(mesh);
    return scene;
}

/* Gives the scene a copy of its material for all triangles from the z on, in scene metres. */
static gw_material *material_from_z(gw_scene *scene, double z) {
    void *materials = NULL;
    check_ok(gw_allocate(&materials, 2, sizeof *scene->materials, "materials", &error));
    gw_material *pair = materials;
    pair[0] = pair[1] = scene->materials[0];
    free(scene->materials);
    scene->materials = pair;
    scene->material_count = 2;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        double middle = 0.0;
        for (int k = 0; k < 3; ++k)
            middle += (double)scene->positions[scene->triangles[t][k] * 3 + 2] / 3.0;
        scene->material_of[t] = ldexp(middle, scene->exponent) + scene->centre[2] >= z;
    }
    return pair;
}

static void set_grey(float color[3], float value) {
    for (int k = 0; k < 3; ++k)
        color[k] = value;
}

/* Mean linear light of the picture of triangles and of finest voxels. */
static void light_of(const gw_stage *stage, gw_camera *camera, double *triangles, double *voxels) {
    gw_renderer *renderer = gw_stage_renderer(stage);
    gw_counters counters = {0};
    double *const light[] = {triangles, voxels};
    for (int i = 0; i < 2; ++i) {
        camera->state.geometry = i == 0 ? GW_GEOMETRY_TRIANGLES : GW_GEOMETRY_VOXELS;
        uint8_t *rgba = gw_camera_take(camera, renderer, &counters);
        *light[i] = gw_mean_linear(rgba, PIXELS);
        free(rgba);
    }
    assert_int_equal(counters.nan_pixels, 0);
    gw_renderer_destroy(&renderer);
}

/* A thing outside the picture that moves the octree's middle planes away from what is tested: sheets near z =
 * 0 would fall into different cells. */
static void add_ballast(gw_mesh *mesh) {
    gw_mesh_add_tetrahedron(mesh, (const double[]){0.9, 0.9, -0.41}, 0.02);
}

/* A dark wall of large triangles and on it a small bright patch of 2,048: by area it is less than a hundredth
 * of the picture, by the number of triangles nearly all of its cell. */
static double error_of_patch(const char *rule, int depth) {
    gw_mesh mesh = {0};
    add_ballast(&mesh);
    gw_mesh_add_grid(&mesh, (const double[]){-1, -1, 0.013}, (const double[]){2, 0, 0},
                     (const double[]){0, 2, 0}, 41, 41);
    gw_mesh_add_grid(&mesh, (const double[]){0.02, 0.02, 0.0131}, (const double[]){0.02, 0, 0},
                     (const double[]){0, 0.02, 0}, 32, 32);
    gw_stage stage;
    gw_scene *scene = scene_of(&mesh);
    gw_material *materials = material_from_z(scene, 0.01305);
    set_grey(materials[0].base_color, 0.02f);
    set_grey(materials[1].base_color, 0.9f);
    set_grey(scene->ambient, 3.0f);
    char depth_text[32];
    snprintf(depth_text, sizeof depth_text, "octree_depth=%d", depth);
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){depth_text, rule, NULL}, &error));
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0, 0, 2}, (const double[]){0, 0, 0.013}, 14, SIDE);
    double triangles = 0, voxels = 0;
    light_of(&stage, &camera, &triangles, &voxels);
    print_message("patch, %s, depth %d: %.4f as triangles, %.4f as voxels\n", rule, depth, triangles, voxels);
    gw_stage_close(&stage);
    return fabs(voxels - triangles) / triangles;
}

static void colours_count_by_area(void **state) {
    (void)state;
    for (int depth = 4; depth <= 7; ++depth)
        assert_true(error_of_patch("payload_rule=area", depth) < 0.05);
    assert_true(error_of_patch("payload_rule=seed", 5) > 0.5); /* the naive rule fails */
}

/* Rows of thin wedges that point sideways: their two sheets face the viewer and away from him, and both lean
 * a little to the side. The sum of their normals points to the side, where no surface faces. */
static double error_of_wedges(const char *rule) {
    const double width = 0.02, thickness = 0.002;
    gw_mesh mesh = {0};
    add_ballast(&mesh);
    for (int i = 0; i < 90; ++i) {
        double x = -0.9 + width * i;
        gw_mesh_add_grid(&mesh, (const double[]){x, -0.9, 0.05 + thickness},
                         (const double[]){width, 0, -thickness}, (const double[]){0, 1.8, 0}, 1, 90);
        gw_mesh_add_grid(&mesh, (const double[]){x, -0.9, 0.05 - thickness}, (const double[]){0, 1.8, 0},
                         (const double[]){width, 0, thickness}, 90, 1);
    }
    gw_stage stage;
    gw_scene *scene = scene_of(&mesh);
    set_grey(scene->ambient, 0.0f);
    void *light = NULL;
    check_ok(gw_allocate(&light, 1, sizeof *scene->lights, "light", &error));
    scene->lights = light;
    scene->lights[0] = (gw_light){GW_LIGHT_DIRECTIONAL, {0, 0, -1}, {2, 2, 2}};
    scene->light_count = 1;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=5", rule, NULL}, &error));
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.3, 0.2, 3}, (const double[]){0, 0, 0}, 10, SIDE);
    double triangles = 0, voxels = 0;
    light_of(&stage, &camera, &triangles, &voxels);
    print_message("wedges, %s: %.4f as triangles, %.4f as voxels\n", rule, triangles, voxels);
    gw_stage_close(&stage);
    return fabs(voxels - triangles) / triangles;
}

static void normals_do_not_turn_aside(void **state) {
    (void)state;
    assert_true(error_of_wedges("payload_rule=area") < 0.1);
    assert_true(error_of_wedges("payload_rule=seed") > 0.5); /* the naive rule fails */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_count_by_area),
        cmocka_unit_test(normals_do_not_turn_aside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
