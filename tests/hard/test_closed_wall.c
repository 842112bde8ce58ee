/* A closed opaque wall stops every ray, whatever stands for it: seen at 1 to 89 degrees, at every octree
 * level and between levels, along the axes and aslant, cut fine, coarse or both, of one sheet or two, flat
 * and round. Walls are black and the background white: what is bright came through. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 24, PIXELS = SIDE * SIDE, DEPTH = 8, COARSEST = 4 };

static const double angles[] = {1, 2, 5, 10, 20, 45, 70, 89};
enum { ANGLES = sizeof angles / sizeof angles[0] };
/* Accepted error over a level's voxels: where they begin to show, and on the way to the next level. */
static const double shares[] = {0.5, 0.65, 0.8, 0.95};
static const double radians = 3.14159265358979 / 180;

/* Two directions along a wall and its normal. Aslant: at no angle to the axes that cells would notice. */
typedef struct directions {
    double of[3][3];
} directions;

static directions turned(int aslant) {
    const double a = aslant ? 0.37 : 0, b = aslant ? 0.61 : 0, c = aslant ? 1.13 : 0;
    return (directions){{{cos(b) * cos(c), sin(a) * sin(b) * cos(c) + cos(a) * sin(c),
                          -cos(a) * sin(b) * cos(c) + sin(a) * sin(c)},
                         {-cos(b) * sin(c), -sin(a) * sin(b) * sin(c) + cos(a) * cos(c),
                          cos(a) * sin(b) * sin(c) + sin(a) * cos(c)},
                         {sin(b), -sin(a) * cos(b), cos(a) * cos(b)}}};
}

/* A point by its place along the wall and its height above it. */
static void place(const directions *d, double u, double v, double height, double out[3]) {
    static const double middle[3] = {0.003, -0.002, 0.013};
    for (int k = 0; k < 3; ++k)
        out[k] = middle[k] + d->of[0][k] * u + d->of[1][k] * v + d->of[2][k] * height;
}

/* A square sheet; back: seen from below. */
static void add_sheet(gw_mesh *mesh, const directions *d, const double at[3], double wide, uint32_t cuts,
                      int back) {
    double corner[3], right[3], up[3];
    place(d, at[0], at[1], at[2], corner);
    for (int k = 0; k < 3; ++k) {
        right[k] = d->of[back ? 1 : 0][k] * wide;
        up[k] = d->of[back ? 0 : 1][k] * wide;
    }
    gw_mesh_add_grid(mesh, corner, right, up, cuts, cuts);
}

typedef enum wall_kind { FINE, MIXED, CLUTTERED, THIN, THICK, THICKER, BALL } wall_kind;

/* What a kind of wall may let through: of one pixel's light, of the picture's. */
typedef struct wall {
    wall_kind kind;
    int aslant;
    const char *name;
    double thickness, most, mean;
} wall;

static const double radius = 0.9; /* of the ball; walls reach as far */

static void add_wall(gw_mesh *mesh, const wall *w, const directions *d) {
    uint64_t random = 5;
    if (w->kind == BALL) {
        gw_mesh_add_sphere(mesh, (const double[]){0.003, -0.002, 0.013}, radius, 0, 200, 100);
    } else if (w->kind == MIXED) {
        for (int i = 0; i < 64; ++i)
            add_sheet(mesh, d, (const double[]){-radius + 0.225 * (i % 8), -radius + 0.225 * (i / 8), 0},
                      0.225, (i + i / 8) % 2 ? 1 : 24, 0);
    } else {
        const double at[3] = {-radius, -radius, 0}, behind[3] = {-radius, -radius, -w->thickness};
        add_sheet(mesh, d, at, 2 * radius, w->kind == CLUTTERED ? 1 : 180, 0);
        if (w->thickness > 0)
            add_sheet(mesh, d, behind, 2 * radius, 180, 1);
    }
    for (int i = 0; w->kind == CLUTTERED && i < 300; ++i) {
        double at[3], u = 1.6 * (gw_test_random(&random) - 0.5), v = 1.6 * (gw_test_random(&random) - 0.5);
        place(d, u, v, -0.02 - 0.1 * gw_test_random(&random), at);
        gw_mesh_add_tetrahedron(mesh, at, 0.02 * gw_test_random(&random));
    }
}

static gw_scene *wall_scene(const wall *w) {
    gw_mesh mesh = {0};
    const directions d = turned(w->aslant);
    add_wall(&mesh, w, &d);
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int k = 0; k < 3; ++k) {
        scene->materials[0].base_color[k] = 0.0f;
        scene->ambient[k] = 0.0f;
        scene->background[k] = 1.0f;
    }
    return scene;
}

/* A camera whose line of sight meets the wall at this angle; the picture shows nothing but wall. Returns how
 * far the eye is from any wall, m, and a pixel's width where the line of sight ends. */
static double look_at_wall(gw_camera *camera, const gw_stage *stage, const wall *w, double degrees,
                           double *pixel) {
    const directions d = turned(w->aslant || w->kind == BALL);
    double eye[3], target[3], angle = degrees * radians, distance = 2.4, view;
    if (w->kind == BALL) { /* from inside: half a chord away, or nearer */
        distance = fmin(radius * sin(angle), 0.8);
        view = fmin(8, 0.8 * degrees);
        place(&d, 0, 0, radius, target);
        place(&d, distance * cos(angle), 0, radius - distance * sin(angle), eye);
    } else {
        double nearest = atan2(sin(angle) * distance, distance * cos(angle) + 0.45) / radians;
        view = fmin(8, 2 * (degrees - nearest));
        place(&d, 0, 0, 0, target);
        place(&d, distance * cos(angle) * cos(0.7), distance * cos(angle) * sin(0.7), distance * sin(angle),
              eye);
    }
    gw_camera_look(camera, stage, eye, target, view, SIDE);
    *pixel = 2 * tan(view / 2 * radians) / SIDE * distance;
    return w->kind == BALL ? radius - radius * cos(fmin(angle, 60 * radians)) : distance;
}

/* Light through one wall: worst pixel and mean of the worst picture, by angle, over all levels. */
typedef struct leak {
    double worst[ANGLES], mean[ANGLES];
} leak;

static void take_leak(const gw_camera *camera, gw_renderer *renderer, double *worst, double *mean) {
    gw_counters counters = {0};
    uint8_t *rgba = gw_camera_take(camera, renderer, &counters);
    *mean = fmax(*mean, gw_mean_linear(rgba, PIXELS));
    for (size_t i = 0; i < PIXELS; ++i)
        *worst = fmax(*worst, gw_mean_linear(rgba + i * 4, 1));
    free(rgba);
    assert_int_equal(counters.nan_pixels, 0);
    assert_int_equal(counters.step_cap_hits, 0);
}

static leak leak_of(const wall *w, const char *shaders, const char *setting) {
    leak out = {0};
    gw_stage stage;
    check_ok(gw_stage_open(&stage, wall_scene(w), shaders,
                           (const char *const[]){"octree_depth=8", setting, NULL}, &error));
    assert_int_equal(stage.settings.octree_depth, DEPTH);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    for (int a = 0; a < ANGLES; ++a) {
        gw_camera camera;
        double pixel, away = look_at_wall(&camera, &stage, w, angles[a], &pixel);
        for (int level = DEPTH; level >= COARSEST; --level)
            for (int s = 0; s < 4; ++s) {
                double voxel = ldexp(2, stage.scene->exponent - level);
                if (voxel > 0.5 * away)
                    continue; /* the eye would stand in it */
                camera.state.tau_inside = (float)(shares[s] * voxel / pixel);
                take_leak(&camera, renderer, &out.worst[a], &out.mean[a]);
            }
    }
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return out;
}

static double most_of(const double values[ANGLES]) {
    double most = 0;
    for (int a = 0; a < ANGLES; ++a)
        most = fmax(most, values[a]);
    return most;
}

static void print_leak(const char *name, const leak *l) {
    char line[256];
    int used = 0;
    for (int a = 0; a < ANGLES; ++a)
        used += snprintf(line + used, sizeof line - (size_t)used, " %g: %.4f %.3f;", angles[a], l->mean[a],
                         l->worst[a]);
    print_message("%s, degrees: mean, worst pixel:%s\n", name, line);
}

static void closed_walls_stop_every_ray(void **state) {
    static const wall walls[] = {
        {FINE, 0, "cut fine", 0, 0.01, 0.001},
        {FINE, 1, "cut fine, aslant", 0, 0.01, 0.001},
        {MIXED, 0, "fine beside coarse", 0, 0.01, 0.001},
        {MIXED, 1, "fine beside coarse, aslant", 0, 0.03, 0.001},
        {BALL, 0, "ball from inside", 0, 0.03, 0.01},
        {THIN, 1, "sheets 0.012 m apart, aslant", 0.012, 0.4, 0.01},
        {THICK, 1, "sheets 0.03 m apart, aslant", 0.03, 0.2, 0.015},
        {THICKER, 1, "sheets 0.08 m apart, aslant", 0.08, 0.3, 0.001},
        /* Voxels that hold the wall and things behind it: what is known to be weak. */
        {CLUTTERED, 0, "two triangles, clutter behind", 0, 0.75, 0.03},
        {CLUTTERED, 1, "two triangles, clutter behind, aslant", 0, 0.9, 0.1},
    };
    (void)state;
    for (size_t i = 0; i < sizeof walls / sizeof walls[0]; ++i) {
        leak l = leak_of(&walls[i], NULL, "tau=1");
        print_leak(walls[i].name, &l);
        assert_true(most_of(l.worst) <= walls[i].most);
        assert_true(most_of(l.mean) <= walls[i].mean);
    }
}

/* Opacities multiplied, clouds instead of slabs, slabs that know nothing of the cells before, sheets that are
 * never known as a wall's: each lets light through. */
static void naive_walls_leak(void **state) {
    char folder[512];
    (void)state;
    static const wall fine = {FINE, 1, "", 0, 0, 0}, mixed = {MIXED, 0, "", 0, 0, 0};
    leak multiplied = leak_of(
        &fine, gw_naive_shaders(folder, "multiplied", "blend/opacity.glsl", "MULTIPLY_OPACITY"), "tau=1");
    leak alone =
        leak_of(&mixed, gw_naive_shaders(folder, "alone", "trace/traverse_lod.glsl", "SLABS_ALONE"), "tau=1");
    leak clouds = leak_of(&mixed, NULL, "voxel_flatness=1.2");
    print_leak("multiplied", &multiplied);
    print_leak("slabs alone", &alone);
    print_leak("clouds", &clouds);
    assert_true(most_of(multiplied.worst) > 0.1);
    assert_true(most_of(alone.worst) > 0.5);
    assert_true(most_of(clouds.worst) > 0.5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_walls_stop_every_ray),
        cmocka_unit_test(naive_walls_leak),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
