/* Dust: thousands of triangles a millionth of the scene wide, in one long list. Seen from far, the edge
 * products of a triangle far beside the ray are nothing but rounding and may agree in sign by chance: the
 * watertight test alone (Woop, Benthin and Wald 2013) then reports hits where nothing is. Ours must not. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { GRAINS = 20000, RAYS = 256 };
static const double grain = 1e-6;

static gw_stage stage;
static gw_ray rays[RAYS];

static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    uint64_t random = 5;
    for (int i = 0; i < GRAINS; ++i) {
        uint32_t corners[3];
        double middle[3];
        for (int k = 0; k < 3; ++k)
            middle[k] = 0.05 + 0.85 * gw_test_random(&random);
        for (int c = 0; c < 3; ++c) {
            double p[3];
            for (int k = 0; k < 3; ++k)
                p[k] = middle[k] + grain * (gw_test_random(&random) - 0.5);
            corners[c] = gw_mesh_point(&mesh, p[0], p[1], p[2]);
        }
        gw_mesh_triangle(&mesh, corners[0], corners[1], corners[2]);
    }
    gw_mesh_add_tetrahedron(&mesh, (const double[]){-0.95, -0.95, -0.95}, 0.01);
    gw_mesh_add_tetrahedron(&mesh, (const double[]){0.97, 0.97, 0.97}, 0.01);
    return gw_mesh_take(&mesh);
}

static int open_stage(void **state) {
    (void)state;
    check_ok(gw_stage_open(&stage, make_scene(), NULL,
                           (const char *const[]){"octree_depth=1", "dense_leaf=0", NULL}, &error));
    uint64_t random = 17;
    for (int i = 0; i < RAYS; ++i) {
        for (int k = 0; k < 3; ++k) {
            rays[i].origin[k] = (float)(-0.5 + 0.4 * gw_test_random(&random));
            rays[i].direction[k] = (float)(0.1 + 0.8 * gw_test_random(&random)) - rays[i].origin[k];
        }
        rays[i].maximum = INFINITY;
    }
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_stage_close(&stage);
    return 0;
}

/* The sheared corner: what is left of the three when the ray is the axis. */
static void shear_corner(const gw_ray *ray, const float *p, int axis, float out[2]) {
    int x = (axis + 1) % 3, y = (axis + 2) % 3;
    float z = p[axis] - ray->origin[axis];
    float slope_x = ray->direction[x] / ray->direction[axis],
          slope_y = ray->direction[y] / ray->direction[axis];
    out[0] = (p[x] - ray->origin[x]) - slope_x * z;
    out[1] = (p[y] - ray->origin[y]) - slope_y * z;
}

/* Signs of the edge products alone. */
static int naive_hit(const gw_ray *ray, uint32_t triangle) {
    float q[3][2], e[3];
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        axis = fabsf(ray->direction[k]) > fabsf(ray->direction[axis]) ? k : axis;
    for (int c = 0; c < 3; ++c)
        shear_corner(ray, stage.scene->positions + (size_t)stage.scene->triangles[triangle][c] * 3, axis,
                     q[c]);
    for (int c = 0; c < 3; ++c) {
        const float *a = q[(c + 1) % 3], *b = q[(c + 2) % 3];
        e[c] = a[0] * b[1] - a[1] * b[0];
    }
    int positive = e[0] >= 0 && e[1] >= 0 && e[2] >= 0, negative = e[0] <= 0 && e[1] <= 0 && e[2] <= 0;
    return (positive || negative) && (e[0] != 0 || e[1] != 0 || e[2] != 0);
}

/* Distance of the ray's line from the triangle's first corner, rebased units. */
static double distance_beside(const gw_ray *ray, uint32_t triangle) {
    const float *p = stage.scene->positions + (size_t)stage.scene->triangles[triangle][0] * 3;
    double along = 0, length = 0, square = 0;
    for (int k = 0; k < 3; ++k) {
        along += ((double)p[k] - (double)ray->origin[k]) * (double)ray->direction[k];
        length += (double)ray->direction[k] * (double)ray->direction[k];
    }
    for (int k = 0; k < 3; ++k) {
        double beside = (double)p[k] - (double)ray->origin[k] - along / length * (double)ray->direction[k];
        square += beside * beside;
    }
    return sqrt(square);
}

static void signs_alone_see_what_is_not_there(void **state) {
    (void)state;
    size_t far_hits = 0;
    for (int i = 0; i < RAYS; ++i)
        for (uint32_t t = 0; t < stage.scene->triangle_count; ++t)
            far_hits += naive_hit(&rays[i], t) && distance_beside(&rays[i], t) > 0.1;
    print_message("signs alone: %zu hits on grains that lie 100,000 grains beside the ray\n", far_hits);
    assert_true(far_hits > RAYS);
}

static void rays_pass_between_the_grains(void **state) {
    (void)state;
    const gw_trace_method methods[] = {GW_TRACE_OCTREE, GW_TRACE_BRUTE_FORCE};
    gw_renderer *renderer = NULL;
    gw_hit hits[RAYS];
    assert_true(stage.octree->statistics.longest_list >= GRAINS);
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, NULL, &renderer, &error));
    for (int m = 0; m < 2; ++m) {
        check_ok(gw_renderer_trace(renderer, methods[m], rays, RAYS, hits, NULL, &error));
        for (int i = 0; i < RAYS; ++i)
            assert_true(hits[i].triangle == GW_NO_TRIANGLE ||
                        distance_beside(&rays[i], hits[i].triangle) < 10 * grain);
    }
    gw_renderer_destroy(&renderer);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_alone_see_what_is_not_there),
        cmocka_unit_test(rays_pass_between_the_grains),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
