/* Hard cases of rays that start on what others met: inside corners of mirrors, sheets of alpha a float apart,
 * footprints behind glass, and a wall of glass, mirrors and gloss in parts. Each against a formula or a
 * double, each with a naive way that must fail. */
#include "tests/support/check.h"

#include "base/memory.h"
#include "base/srgb.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 48, PIXELS = SIDE * SIDE, BOUNCES = 8 };

/* --- corners of mirrors ----------------------------------------------------------------------------------
 */

static const double albedo = 0.8, behind = 0.75;

/* Three mirrors that share the corner (0, 0, 0). */
typedef struct corner {
    const char *what;
    double side[3][3]; /* of length 1: the mirrors lie between 0 and 1, 1 and 2, 2 and 0 */
} corner;

static const corner corners[] = {
    {"of a box", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    {"of a wedge", {{1, 0, 0}, {0.9, 0, 0.4358898943540674}, {0, 1, 0}}},
};

/* The corner turned out of the axes, scaled and moved. */
typedef struct place {
    double scale, at[3];
} place;

static void put(const place *where, const double local[3], double out[3]) {
    static const double turn[3][3] = {{0.6, -0.64, 0.48}, {0.8, 0.48, -0.36}, {0, 0.6, 0.8}};
    for (int i = 0; i < 3; ++i)
        out[i] = where->at[i] +
                 where->scale * (turn[i][0] * local[0] + turn[i][1] * local[1] + turn[i][2] * local[2]);
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; ++i)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static gw_scene *mirrors(const corner *c, const place *where, uint32_t cuts) {
    gw_mesh mesh = {0};
    for (int i = 0; i < 3; ++i) {
        double at[3], u[3], v[3];
        put(where, (const double[]){0, 0, 0}, at);
        put(where, c->side[i], u);
        put(where, c->side[(i + 1) % 3], v);
        for (int k = 0; k < 3; ++k) {
            u[k] -= at[k];
            v[k] -= at[k];
        }
        gw_mesh_add_grid(&mesh, at, u, v, cuts, cuts);
    }
    gw_scene *scene = gw_mesh_take(&mesh);
    const float grey = (float)albedo;
    scene->materials[0] =
        (gw_material){.base_color = {grey, grey, grey, 1}, .metalness = 1, .base_color_texture = -1};
    for (int i = 0; i < 3; ++i) {
        scene->ambient[i] = 0;
        scene->background[i] = (float)behind;
    }
    return scene;
}

/* What a ray brings by reflection in planes that end where they should, in the corner's own coordinates; -1
 * where it comes too near to an edge for floats to tell: nearer than `unsure`. */
static double radiance_in_corner(const corner *c, double at[3], double d[3], double unsure) {
    double brought = behind;
    int last = -1;
    for (int bounce = 0; bounce <= BOUNCES; ++bounce) {
        double nearest = 1e30, normal[3] = {0};
        int met = -1;
        for (int i = 0; i < 3; ++i) {
            double n[3], cu[3], cv[3], p[3];
            const double *u = c->side[i], *v = c->side[(i + 1) % 3];
            cross(u, v, n);
            const double size = sqrt(dot(n, n)), facing = dot(d, n);
            if (i == last || fabs(facing) < 1e-12)
                continue;
            const double t = -dot(at, n) / facing;
            for (int k = 0; k < 3; ++k)
                p[k] = at[k] + t * d[k];
            cross(p, v, cu);
            cross(u, p, cv);
            const double a = dot(cu, n) / (size * size), b = dot(cv, n) / (size * size);
            const double edge = fmax(fmax(-a, a - 1), fmax(-b, b - 1));
            if (t > 0 && fabs(edge) < unsure)
                return -1;
            if (t > 0 && edge < 0 && t < nearest) {
                nearest = t;
                met = i;
                for (int k = 0; k < 3; ++k)
                    normal[k] = n[k] / size;
            }
        }
        if (met < 0)
            return brought;
        const double cosine = fabs(dot(d, normal)), along = dot(d, normal);
        brought *= albedo + (1 - albedo) * pow(1 - cosine, 5);
        for (int k = 0; k < 3; ++k) {
            at[k] += nearest * d[k];
            d[k] -= 2 * along * normal[k];
        }
        last = met;
    }
    return 0;
}

/* Pixels of a picture of the corner that are not as the double says; the view is `wide` across. */
static size_t wrong_in_corner(const corner *c, const place *where, double wide, float tau, uint32_t cuts,
                              const char *shaders) {
    static const double from[3] = {0.45, 0.12, 0.2};
    const double aim[3] = {0.5 * wide, 0.3 * wide, 0.3 * wide};
    gw_stage stage;
    gw_camera camera;
    gw_counters counters = {0};
    double eye[3], target[3];
    put(where, from, eye);
    put(where, aim, target);
    check_ok(gw_stage_open(&stage, mirrors(c, where, cuts), shaders,
                           (const char *const[]){"octree_depth=8", "bounces=8", "least_throughput=0", NULL},
                           &error));
    gw_camera_look(&camera, &stage, eye, target, 120 * atan(wide), SIDE);
    camera.state.tau_inside = tau;
    uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, &counters);
    assert_int_equal(counters.nan_pixels + counters.step_cap_hits, 0);
    size_t wrong = 0, told = 0;
    for (uint32_t i = 0; i < PIXELS; ++i) {
        double ray[3], at[3] = {from[0], from[1], from[2]}, d[3];
        gw_camera_ray(&camera, i % SIDE, i / SIDE, ray);
        for (int k = 0; k < 3; ++k) { /* back into the corner's coordinates: by the turn's transpose */
            double axis[3] = {k == 0, k == 1, k == 2}, turned[3];
            put(&(const place){1, {0}}, axis, turned);
            d[k] = dot(ray, turned);
        }
        const double wanted = radiance_in_corner(c, at, d, 2e-5);
        told += wanted >= 0;
        wrong += wanted >= 0 && fabs(gw_srgb_code_to_linear(rgba[i * 4]) - wanted) > 0.008;
    }
    assert_true(told > PIXELS / 2);
    free(rgba);
    gw_stage_close(&stage);
    return wrong;
}

static void reflections_reach_into_corners(void **state) {
    (void)state;
    static const place places[] = {
        {1, {0, 0, 0}}, {1, {148376, 1234, -223423}}, {0.37, {1e6, -1e6, 1e6}}, {1000.0 / 3, {5e5, 0, -7e5}}};
    static const double wides[] = {0.5, 0.004};
    char folder[2][512];
    const char *none = gw_naive_shaders(folder[0], "corner-none", "common/surface_offset.glsl", "NO_OFFSET"),
               *wide =
                   gw_naive_shaders(folder[1], "corner-wide", "common/surface_offset.glsl", "WIDE_OFFSET");
    size_t naive[2] = {0};
    for (size_t c = 0; c < sizeof corners / sizeof corners[0]; ++c)
        for (size_t w = 0; w < 2; ++w) {
            for (size_t p = 0; p < sizeof places / sizeof places[0]; ++p) {
                const size_t wrong = wrong_in_corner(&corners[c], &places[p], wides[w], 0, 3, NULL);
                print_message("# corner %s, %g wide, place %zu: %zu pixels wrong\n", corners[c].what,
                              wides[w], p, wrong);
                assert_true(wrong <= PIXELS / 1000);
            }
            naive[0] += wrong_in_corner(&corners[c], &places[1], wides[w], 0, 3, none);
            naive[1] += wrong_in_corner(&corners[c], &places[1], wides[w], 0, 3, wide);
        }
    print_message("# without offset %zu wrong, with 1e-3 %zu\n", naive[0], naive[1]);
    assert_true(naive[0] > PIXELS / 20 && naive[1] > PIXELS / 20); /* the naive rules fail */
}

/* --- sheets of alpha -------------------------------------------------------------------------------------
 */

enum { SHEETS = 6 };

/* What the sheets show, the nearest first; each shines with a colour of its own. */
static void over(const int order[SHEETS], double background, double out[3]) {
    double left = 1;
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < SHEETS; ++i) {
        const int s = order[i];
        const double alpha = 0.3 + 0.08 * s;
        for (int k = 0; k < 3; ++k)
            out[k] += left * alpha * ((s + k) % 3 == 0 ? 0.9 : 0.1 * (double)k);
        left *= 1 - alpha;
    }
    for (int k = 0; k < 3; ++k)
        out[k] += left * background;
}

/* Sheets so far behind 0.5 each, the nearest first. */
static gw_scene *sheets(const double gap[SHEETS]) {
    gw_mesh mesh = {0};
    /* A frame of 2 x 2 x 2 about 0: what is rebased keeps its floats. */
    for (int k = -1; k <= 1; k += 2)
        gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, k, k, k), gw_mesh_point(&mesh, k, 0.9 * k, k),
                         gw_mesh_point(&mesh, 0.9 * k, k, k));
    for (int s = 0; s < SHEETS; ++s)
        gw_mesh_add_grid(&mesh, (const double[]){-0.5, -0.5, 0.5 + gap[s]}, (const double[]){1, 0, 0},
                         (const double[]){0, 1, 0}, 2, 2);
    gw_scene *scene = gw_mesh_take(&mesh);
    free(scene->materials);
    scene->materials = calloc(SHEETS + 1, sizeof *scene->materials);
    assert_non_null(scene->materials);
    scene->material_count = SHEETS + 1;
    for (int s = 0; s <= SHEETS; ++s) {
        gw_material *m = &scene->materials[s];
        *m = (gw_material){.roughness = 1, .base_color_texture = -1, .alpha_mode = GW_ALPHA_BLEND};
        m->base_color[3] = (float)(0.3 + 0.08 * s);
        for (int k = 0; k < 3; ++k)
            m->emissive[k] = (s + k) % 3 == 0 ? 0.9f : 0.1f * (float)k;
    }
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        const double z = ldexp((double)scene->positions[scene->triangles[t][0] * 3 + 2], scene->exponent) +
                         scene->centre[2];
        int best = SHEETS;
        for (int s = 0; s < SHEETS; ++s)
            if (z == 0.5 + gap[s])
                best = s;
        scene->material_of[t] = (uint32_t)best;
    }
    for (int k = 0; k < 3; ++k) {
        scene->ambient[k] = 0;
        scene->background[k] = 0.6f;
    }
    return scene;
}

/* Greatest difference to over() in double, from one side. */
static double off_over(const double gap[SHEETS], int from_behind, const char *shaders) {
    enum { SMALL = 16 };
    gw_stage stage;
    gw_camera camera;
    int order[SHEETS];
    double wanted[3], worst = 0;
    check_ok(gw_stage_open(&stage, sheets(gap), shaders,
                           (const char *const[]){"octree_depth=7", "tau_inside=0", "emissive_lights=0", NULL},
                           &error));
    const double z = from_behind ? 0.5 + gap[SHEETS - 1] + 1.0 / 128 : 0.5 - 1.0 / 128;
    gw_camera_look(&camera, &stage, (const double[]){0.11, 0.07, z}, (const double[]){0.1101, 0.0702, 0.5},
                   50, SMALL);
    uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, NULL);
    for (int i = 0; i < SHEETS; ++i)
        order[i] = from_behind ? SHEETS - 1 - i : i;
    over(order, 0.6, wanted);
    for (int i = 0; i < SMALL * SMALL; ++i)
        for (int k = 0; k < 3; ++k)
            worst = fmax(worst, fabs(gw_srgb_code_to_linear(rgba[i * 4 + k]) - wanted[k]));
    free(rgba);
    gw_stage_close(&stage);
    return worst;
}

static void sheets_lie_over_each_other_in_order(void **state) {
    (void)state;
    const double ulp = ldexp(1, -24);
    const double gaps[3][SHEETS] = {{0, ulp, 2 * ulp, 3 * ulp, 4 * ulp, 5 * ulp},
                                    {0, ulp, 3 * ulp, 7 * ulp, 64 * ulp, 4096 * ulp},
                                    {0, ldexp(1, -14), ldexp(1, -12), 0.001953125, 0.0078125, 0.03125}};
    char folder[512];
    const char *naive = gw_naive_shaders(folder, "sheets", "trace/primary.comp", "SKIP_BEHIND_HIT");
    for (int g = 0; g < 3; ++g)
        for (int side = 0; side < 2; ++side) {
            const double off = off_over(gaps[g], side, NULL), skipped = off_over(gaps[g], side, naive);
            print_message("# sheets %d, side %d: %.4f off; behind an epsilon %.4f\n", g, side, off, skipped);
            assert_true(off < 0.006);
            assert_true(g == 2 || skipped > 0.02); /* the naive rule fails */
        }
}

/* --- footprints behind glass -----------------------------------------------------------------------------
 */

enum { MATT, GLASS, MIRROR, GLOSSY, MATERIALS };

/* Noise behind a slab (or a ball) of glass, and if asked for behind the viewer. */
static gw_scene *glass_before_noise(int ball, int around) {
    enum { TEXELS = 256 };
    uint64_t random = 3;
    void *memory = NULL;
    gw_mesh mesh = {0};
    if (ball)
        gw_mesh_add_sphere(&mesh, (const double[]){0, 0, 0}, 0.4, 0, 48, 24);
    else
        for (int far = -1; far <= 1; far += 2)
            gw_mesh_add_grid(&mesh, (const double[]){-0.6 * far, -0.6, 0.1 * far},
                             (const double[]){1.2 * far, 0, 0}, (const double[]){0, 1.2, 0}, 4, 4);
    gw_mesh_add_grid(&mesh, (const double[]){-8, -8, -3}, (const double[]){16, 0, 0},
                     (const double[]){0, 16, 0}, 8, 8);
    if (around)
        gw_mesh_add_grid(&mesh, (const double[]){-8, -8, 5}, (const double[]){16, 0, 0},
                         (const double[]){0, 16, 0}, 1, 1);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->materials = realloc(scene->materials, MATERIALS * sizeof *scene->materials);
    scene->extensions = calloc(MATERIALS, sizeof *scene->extensions);
    assert_true(scene->materials && scene->extensions);
    scene->material_count = MATERIALS;
    for (int i = 0; i < MATERIALS; ++i)
        scene->extensions[i] = gw_material_extension_none();
    scene->materials[MATT].base_color_texture = 0;
    for (int i = GLASS; i < MATERIALS; ++i)
        scene->materials[i] = (gw_material){.base_color = {1, 1, 1, 1}, .base_color_texture = -1};
    scene->extensions[GLASS].transmission = 1;
    scene->extensions[GLASS].thickness = 1;
    scene->materials[MIRROR].metalness = 1;
    scene->materials[GLOSSY].metalness = 1;
    scene->materials[GLOSSY].roughness = 0.3f;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        const double z = ldexp((double)scene->positions[scene->triangles[t][0] * 3 + 2], scene->exponent) +
                         scene->centre[2];
        scene->material_of[t] = fabs(z) < 1 ? GLASS : MATT;
    }
    for (uint32_t v = 0; v < scene->vertex_count; ++v) {
        const float *p = scene->positions + (size_t)v * 3;
        float from[3], length = 0;
        for (int k = 0; k < 3; ++k) {
            from[k] = (float)(ldexp((double)p[k], scene->exponent) + scene->centre[k]);
            length += from[k] * from[k];
        }
        for (int k = 0; ball && k < 3 && fabsf(from[2]) < 1; ++k)
            scene->normals[v * 3 + (uint32_t)k] = from[k] / sqrtf(length);
        scene->texcoords[v * 2] = from[0];
        scene->texcoords[v * 2 + 1] = from[1];
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

/* Root mean square error of one ray a pixel to eight. */
static double error_behind(int ball, const char *shaders) {
    gw_stage stage;
    gw_camera camera;
    double sum = 0;
    check_ok(gw_stage_open(&stage, glass_before_noise(ball, 0), shaders,
                           (const char *const[]){"octree_depth=7", "bounces=3", NULL}, &error));
    gw_camera_look(&camera, &stage, (const double[]){0.03, 0.02, 3}, (const double[]){0, 0, 0}, 10, SIDE);
    gw_counters counters = {0};
    uint8_t *one = gw_stage_take(&stage, &camera, NULL, &counters);
    camera.state.samples = 4;
    camera.state.accumulate = 2;
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

static void footprints_go_on_behind_glass(void **state) {
    (void)state;
    char folder[512];
    const char *naive = gw_naive_shaders(folder, "forget", "shade/refracted_ray.glsl", "FORGET_FOOTPRINT");
    for (int ball = 0; ball < 2; ++ball) {
        const double kept = error_behind(ball, NULL), forgotten = error_behind(ball, naive);
        print_message("# noise behind a %s: error %.4f, where the footprint begins anew %.4f\n",
                      ball ? "ball" : "slab", kept, forgotten);
        assert_true(forgotten > 2 * kept); /* the naive rule fails */
    }
}

/* --- one wall in parts -----------------------------------------------------------------------------------
 */

/* Stripes of mirror and gloss on the wall behind the ball. */
static gw_scene *glass_mirrors_and_gloss(void) {
    gw_scene *scene = glass_before_noise(1, 1);
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        if (scene->material_of[t] == MATT && scene->positions[scene->triangles[t][0] * 3 + 2] < 0)
            scene->material_of[t] = t % 3 == 0 ? MATT : t % 3 == 1 ? MIRROR : GLOSSY;
    return scene;
}

static void glass_mirrors_and_gloss_know_no_tile(void **state) {
    (void)state;
    enum { COLUMNS = 3, ROWS = 2, WIDE = SIDE / COLUMNS, HIGH = SIDE / ROWS };
    gw_stage stage;
    gw_camera camera;
    gw_counters counters = {0};
    check_ok(gw_stage_open(&stage, glass_mirrors_and_gloss(), NULL,
                           (const char *const[]){"octree_depth=7", "bounces=4", "glossy_roughness=0.5", NULL},
                           &error));
    gw_camera_look(&camera, &stage, (const double[]){0.3, 0.2, 3}, (const double[]){0, 0, -1}, 30, SIDE);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    uint8_t *whole = gw_camera_take(&camera, renderer, &counters), *part = calloc(WIDE * HIGH, 4);
    assert_non_null(part);
    assert_true(counters.mirror_rays > PIXELS / 2);
    size_t off[2] = {0};
    for (int own = 0; own < 2; ++own) /* naive: pixels are counted from the tile's own corner */
        for (int tile = 0; tile < COLUMNS * ROWS; ++tile) {
            const int x = tile % COLUMNS * WIDE, y = tile / COLUMNS * HIGH;
            const gw_rectangle r = {own ? 0 : x, own ? 0 : y, WIDE, HIGH};
            gw_plane plane = camera.plane;
            for (int k = 0; own && k < 3; ++k)
                plane.corner[k] += x * plane.step_x[k] + y * plane.step_y[k];
            check_ok(gw_renderer_frame(renderer, &camera.placement, &plane, &r, &camera.state, part, NULL,
                                       &error));
            for (int i = 0; i < WIDE * HIGH; ++i) {
                const int at = (y + i / WIDE) * SIDE + x + i % WIDE;
                off[own] += memcmp(part + (size_t)i * 4, whole + (size_t)at * 4, 4) != 0;
            }
        }
    print_message("# in %d x %d tiles %zu of %d pixels are others; counted from each tile's corner %zu\n",
                  COLUMNS, ROWS, off[0], PIXELS, off[1]);
    assert_int_equal(off[0], 0);
    assert_true(off[1] > PIXELS / 100); /* the naive rule fails */
    free(part);
    free(whole);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glass_mirrors_and_gloss_know_no_tile),
        cmocka_unit_test(reflections_reach_into_corners),
        cmocka_unit_test(sheets_lie_over_each_other_in_order),
        cmocka_unit_test(footprints_go_on_behind_glass),
    };
    return cmocka_run_group_tests_name("secondary", tests, NULL, NULL);
}
