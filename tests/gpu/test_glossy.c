/* Nearly smooth surfaces: they show what stands round them, blurred as their roughness says, at no gain of
 * light, and the same in any split. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/features.h"
#include "render/gloss.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 32, PIXELS = SIDE * SIDE };
enum { FLOOR, WALL };

/* A floor of that metalness, and a wall behind it that glows in stripes, or without stripes a furnace: rough
 * white metal, light of radiance 1 / pi from everywhere. */
static gw_scene *floor_and_wall(float roughness, float metalness, int stripes) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){2, 0, 0}, (const double[]){0, 0, 2},
                     8, 8);
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0.02, -1}, (const double[]){2, 0, 0},
                     (const double[]){0, 1, 0}, stripes ? (uint32_t)stripes : 16, 4);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->materials = realloc(scene->materials, 3 * sizeof *scene->materials);
    assert_non_null(scene->materials);
    scene->material_count = 3;
    const gw_material black = {.base_color = {0, 0, 0, 1}, .roughness = 1, .base_color_texture = -1};
    scene->materials[FLOOR] = scene->materials[WALL] = scene->materials[2] = black;
    scene->materials[FLOOR].roughness = roughness;
    scene->materials[FLOOR].metalness = metalness;
    scene->materials[WALL].metalness = stripes ? 0 : 1;
    for (int i = 0; i < 3; ++i) {
        const float light = (float)(1 / 3.14159265358979);
        scene->materials[FLOOR].base_color[i] = 1;
        scene->materials[WALL].emissive[i] = stripes ? 0.8f : 0;
        scene->materials[WALL].base_color[i] = stripes ? 0 : 1;
        scene->ambient[i] = stripes ? 0.2f : 1;
        scene->background[i] = stripes ? 0.1f : light;
    }
    /* A scene's triangles stand in an order of its own. */
    const double metres = ldexp(1, scene->exponent);
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        const float *a = &scene->positions[3 * (size_t)scene->triangles[t][0]],
                    *b = &scene->positions[3 * (size_t)scene->triangles[t][1]],
                    *c = &scene->positions[3 * (size_t)scene->triangles[t][2]];
        const int on_wall = fabsf(a[1] - b[1]) + fabsf(a[1] - c[1]) > 1e-4f;
        const int stripe =
            (int)floor(((double)a[0] + (double)b[0] + (double)c[0]) / 3 * metres * stripes / 2);
        scene->material_of[t] = on_wall ? (stripes && stripe & 1 ? 2 : WALL) : FLOOR;
    }
    return scene;
}

static const char *const settings[] = {"octree_depth=6", "emissive_lights=0", "tau_inside=0",
                                       "glossy_roughness=0.4", NULL};

static void open_at(gw_stage *stage, gw_camera *camera, gw_scene *scene, const char *shaders) {
    check_ok(gw_stage_open(stage, scene, shaders, settings, &error));
    gw_camera_look(camera, stage, (const double[]){0.1, 0.5, 1.6}, (const double[]){0, 0.1, -0.3}, 40, SIDE);
}

/* Under light that is the same from everywhere, met or not, nothing reflects more than arrives, and white
 * metal no less: at roughness 0 to the limit, in one sample and in many. */
static void a_furnace_keeps_its_light(void **state) {
    static const float roughnesses[] = {0.03f, 0.15f, 0.3f};
    (void)state;
    for (size_t r = 0; r < 3; ++r) {
        gw_stage stage;
        gw_camera camera;
        gw_counters counters = {0};
        open_at(&stage, &camera, floor_and_wall(roughnesses[r], 1, 0), NULL);
        uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, &counters);
        int least = 255, most = 0;
        for (size_t i = 0; i < PIXELS; ++i) {
            least = rgba[i * 4] < least ? rgba[i * 4] : least;
            most = rgba[i * 4] > most ? rgba[i * 4] : most;
        }
        print_message("# roughness %g: %u rays, radiance %.4f to %.4f of %.4f\n", (double)roughnesses[r],
                      (unsigned)counters.glossy_rays, gw_srgb_code_to_linear((uint8_t)least),
                      gw_srgb_code_to_linear((uint8_t)most), 0.3183);
        assert_true(counters.glossy_rays > PIXELS / 4);
        assert_int_equal(counters.nan_pixels + counters.step_cap_hits + counters.mirror_rays, 0);
        assert_true(gw_srgb_code_to_linear((uint8_t)most) <= 0.3183 * 1.015); /* 1 % and half a code */
        assert_true(gw_srgb_code_to_linear((uint8_t)least) >= 0.3183 * 0.97);
        free(rgba);
        gw_stage_close(&stage);
    }
}

/* Mean difference of patches of 4 x 4, 1/255, in which single samples are no more than noise. */
static double difference_to(const uint8_t *picture, const uint8_t *reference) {
    double sum = 0;
    for (int patch = 0; patch < PIXELS / 16; ++patch) {
        int difference = 0;
        for (int k = 0; k < 16; ++k) {
            const int x = patch % (SIDE / 4) * 4 + k % 4, y = patch / (SIDE / 4) * 4 + k / 4;
            difference += picture[(y * SIDE + x) * 4] - reference[(y * SIDE + x) * 4];
        }
        sum += abs(difference) / 16.0;
    }
    return sum * 16 / PIXELS;
}

/* Samples of a still view come near the lobe; where all take its middle they never do. */
static void samples_fill_the_lobe(void **state) {
    char folder[512];
    gw_stage stage;
    gw_camera camera;
    (void)state;
    uint8_t *pictures[4];
    open_at(&stage, &camera, floor_and_wall(0.25f, 1, 16), NULL);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    static const uint16_t counts[] = {1, 16, 64};
    for (size_t i = 0; i < 3; ++i) {
        camera.state.accumulate = counts[i];
        pictures[i] = gw_camera_take(&camera, renderer, NULL);
    }
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    open_at(&stage, &camera, floor_and_wall(0.25f, 1, 16),
            gw_naive_shaders(folder, "middles", "shade/glossy_ray.glsl", "LOBE_MIDDLES"));
    camera.state.accumulate = 16;
    pictures[3] = gw_stage_take(&stage, &camera, NULL, NULL);
    gw_stage_close(&stage);
    const double one = difference_to(pictures[0], pictures[2]),
                 some = difference_to(pictures[1], pictures[2]),
                 middles = difference_to(pictures[3], pictures[2]);
    print_message("# off 64 samples by: one %.2f/255, 16 %.2f, the lobe's middle %.2f\n", one, some, middles);
    assert_true(some < 0.5 * one);
    assert_true(middles > 2 * some); /* the naive rule fails */
    for (size_t i = 0; i < 4; ++i)
        free(pictures[i]);
}

/* What makes a black floor reflect: its own dielectric, or over one that reflects nothing a clearcoat as
 * smooth. */
enum { BARE, COATED };
enum { FLOOR_PIXELS = PIXELS / 2, FLOOR_ROWS = FLOOR_PIXELS * 4 }; /* the lower half of the picture */

static gw_scene *black_floor(int finish, float roughness) {
    gw_scene *scene = floor_and_wall(finish == BARE ? roughness : 1, 0, 16);
    scene->extensions = malloc(scene->material_count * sizeof *scene->extensions);
    assert_non_null(scene->extensions);
    for (uint32_t i = 0; i < scene->material_count; ++i)
        scene->extensions[i] = gw_material_extension_none();
    scene->extensions[FLOOR].specular = finish == BARE;
    scene->extensions[FLOOR].clearcoat = finish == COATED;
    scene->extensions[FLOOR].clearcoat_roughness = roughness;
    for (int i = 0; i < 3; ++i) {
        scene->materials[FLOOR].base_color[i] = 0;
        scene->materials[WALL].emissive[i] = 2;
    }
    return scene;
}

static uint8_t *black_floor_picture(int finish, float roughness, int lights, const char *shaders,
                                    gw_counters *counters) {
    const char *const with_lights[] = {"octree_depth=6", "emissive_lights=4", "tau_inside=0",
                                       "glossy_roughness=0.4", NULL};
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, black_floor(finish, roughness), shaders, lights ? with_lights : settings,
                           &error));
    gw_camera_look(&camera, &stage, (const double[]){0.1, 0.5, 1.6}, (const double[]){0, 0.1, -0.3}, 40,
                   SIDE);
    camera.state.accumulate = 16;
    uint8_t *picture = gw_stage_take(&stage, &camera, NULL, counters);
    gw_stage_close(&stage);
    return picture;
}

/* A coat shows what stands round it as a bare surface of its roughness does, whatever lies below. */
static void coats_reflect_as_they_are_rough(void **state) {
    static const float roughnesses[] = {0, 0.2f};
    char folder[512];
    (void)state;
    const char *dull = gw_naive_shaders(folder, "dull-coats", "shade/glossy_share.glsl", "DULL_COATS");
    for (int r = 0; r < 2; ++r) {
        gw_counters counters = {0};
        uint8_t *bare = black_floor_picture(BARE, roughnesses[r], 0, NULL, NULL),
                *coated = black_floor_picture(COATED, roughnesses[r], 0, NULL, &counters),
                *naive = black_floor_picture(COATED, roughnesses[r], 0, dull, NULL);
        const double off = gw_mean_difference(coated, bare, PIXELS),
                     off_dull = gw_mean_difference(naive, bare, PIXELS);
        print_message("# roughness %g, coat beside bare: %.2f/255 off, without rays %.2f\n",
                      (double)roughnesses[r], off, off_dull);
        assert_true(counters.glossy_rays > 4 * PIXELS && counters.mirror_rays == 0);
        assert_true(off < 1 && off_dull > 4);
        free(bare);
        free(coated);
        free(naive);
    }
}

/* What rays bring of surfaces that emit light has no highlight of their lights besides, in coats either. */
static void coats_show_lamps_once(void **state) {
    char folder[512];
    (void)state;
    const char *twice = gw_naive_shaders(folder, "coats-twice", "shade/shade.comp", "COATS_LIT_TWICE");
    uint8_t *by_rays = black_floor_picture(COATED, 0.2f, 0, NULL, NULL),
            *with_lights = black_floor_picture(COATED, 0.2f, 1, NULL, NULL),
            *naive = black_floor_picture(COATED, 0.2f, 1, twice, NULL);
    const double light = gw_mean_linear(by_rays + FLOOR_ROWS, FLOOR_PIXELS),
                 once = gw_mean_linear(with_lights + FLOOR_ROWS, FLOOR_PIXELS),
                 lit_twice = gw_mean_linear(naive + FLOOR_ROWS, FLOOR_PIXELS);
    print_message(
        "# glowing wall in a coat: %.4f by rays, %.4f where it is a light too, %.4f with its highlights\n",
        light, once, lit_twice);
    assert_true(fabs(once - light) < 0.005 * light);
    assert_true(lit_twice > 1.05 * light); /* the naive rule fails */
    free(by_rays);
    free(with_lights);
    free(naive);
}

/* A wall that reflects by its smooth coat only, between sky and ground: how much of the change between both,
 * mirrored in it, lies within three rows. */
static double sharpness_of_coat(const char *shaders) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-2, -2, 0}, (const double[]){4, 0, 0}, (const double[]){0, 4, 0},
                     4, 4);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->extensions = malloc(sizeof *scene->extensions);
    assert_non_null(scene->extensions);
    scene->extensions[0] = gw_material_extension_none();
    scene->extensions[0].specular = 0;
    scene->extensions[0].clearcoat = 1;
    scene->materials[0].roughness = 1;
    scene->materials[0].metalness = 0;
    for (int i = 0; i < 3; ++i)
        scene->materials[0].base_color[i] = scene->ambient[i] = scene->background[i] = 0;
    gw_give_sky(scene, 0);
    gw_stage stage;
    gw_camera camera;
    double row[SIDE] = {0}, jump = 0;
    check_ok(gw_stage_open(&stage, scene, shaders, settings, &error));
    gw_camera_look(&camera, &stage, (const double[]){0, 0, 2}, (const double[]){0, 0, 0}, 50, SIDE);
    uint8_t *picture = gw_stage_take(&stage, &camera, NULL, NULL);
    for (int i = 0; i < PIXELS; ++i)
        row[i / SIDE] += gw_srgb_code_to_linear(picture[4 * i]) / SIDE;
    for (int y = 0; y + 2 < SIDE; ++y)
        jump = fmax(jump, fabs(row[y] - row[y + 2]));
    free(picture);
    gw_stage_close(&stage);
    return jump / 0.01; /* 4 % of the difference of sky and ground */
}

static void smooth_coats_mirror_sharply(void **state) {
    char folder[512];
    (void)state;
    const char *as_base = gw_naive_shaders(folder, "coat-as-base", "shade/environment.glsl", "COAT_AS_BASE");
    const double sharp = sharpness_of_coat(NULL), naive = sharpness_of_coat(as_base);
    print_message(
        "# horizon in a coat over a rough base: %.2f of it in three rows, as blurred as the base %.2f\n",
        sharp, naive);
    assert_true(sharp > 0.8 && naive < 0.3);
}

/* A metal floor under sky and sun, where it mirrors the sun; beneath a sheet of glass of index 1, or in the
 * open. */
static double metal_in_sun(int beneath, int with_sun, const char *shaders) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){2, 0, 0}, (const double[]){0, 0, 2},
                     4, 4);
    gw_mesh_add_grid(&mesh, (const double[]){-20, beneath ? 1 : -1, -20}, (const double[]){40, 0, 0},
                     (const double[]){0, 0, 40}, 4, 4);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->materials = realloc(scene->materials, 2 * sizeof *scene->materials);
    scene->extensions = malloc(2 * sizeof *scene->extensions);
    assert_true(scene->materials && scene->extensions);
    scene->material_count = 2;
    for (int i = 0; i < 2; ++i) {
        scene->extensions[i] = gw_material_extension_none();
        scene->materials[i] = (gw_material){.base_color = {0.1f, 0.1f, 0.1f, 1}, .base_color_texture = -1};
    }
    scene->materials[FLOOR].metalness = 1;
    scene->materials[FLOOR].roughness = 0.36f;
    for (int i = 0; i < 3; ++i) {
        scene->materials[1].base_color[i] = 1;
        scene->ambient[i] = scene->background[i] = 0;
    }
    scene->extensions[1].transmission = 1;
    scene->extensions[1].ior = 1;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        const float height = scene->positions[3 * (size_t)scene->triangles[t][0] + 1]; /* about the middle */
        scene->material_of[t] = beneath ? height > 0 : height < 0;
    }
    gw_give_sky(scene, with_sun);
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, scene, shaders,
                           (const char *const[]){"octree_depth=6", "tau_inside=0", "glossy_roughness=0.6",
                                                 "accumulate=64", NULL},
                           &error));
    gw_camera_look(&camera, &stage, (const double[]){-0.8, 0.8, 0}, (const double[]){0, 0, 0}, 40, SIDE);
    uint8_t *picture = gw_stage_take(&stage, &camera, NULL, NULL);
    const double light = gw_mean_linear(picture, PIXELS);
    free(picture);
    gw_stage_close(&stage);
    return light;
}

/* Lights taken from the environment shine through glass, and have their highlights on what is rough: rays of
 * its lobe that go on through glass must not see them again. */
static void lobes_see_suns_through_glass_once(void **state) {
    char folder[512];
    (void)state;
    const char *twice = gw_naive_shaders(folder, "lamps-in-lobes", "shade/glossy_ray.glsl", "LAMPS_IN_LOBES");
    const double sky = metal_in_sun(0, 0, NULL), open = metal_in_sun(0, 1, NULL),
                 beneath = metal_in_sun(1, 1, NULL), naive = metal_in_sun(1, 1, twice);
    print_message(
        "# rough metal under sky %.4f, under sky and sun %.4f, beneath glass %.4f, seen by rays too %.4f\n",
        sky, open, beneath, naive);
    assert_true(fabs(beneath - open) < 0.06 * (open - sky));
    assert_true(naive > open + 0.5 * (open - sky)); /* the naive rule fails */
}

/* How far single samples are off the mean of many, pixel by pixel on the floor: the footprint takes in the
 * lobe, so that voxels average what one ray would pick at random. */
static double grain_of_lobes(const char *shaders) {
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, floor_and_wall(0.3f, 1, 64), shaders,
                           (const char *const[]){"octree_depth=8", "emissive_lights=0", "tau_inside=1",
                                                 "glossy_roughness=0.4", NULL},
                           &error));
    gw_camera_look(&camera, &stage, (const double[]){0, 0.8, 0.8}, (const double[]){0, 0, -0.2}, 4, SIDE);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    uint8_t *one = gw_camera_take(&camera, renderer, NULL);
    camera.state.accumulate = 64;
    uint8_t *many = gw_camera_take(&camera, renderer, NULL);
    const double grain = gw_mean_difference(one, many, PIXELS);
    free(one);
    free(many);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return grain;
}

static void lobes_are_footprints(void **state) {
    char folder[512];
    (void)state;
    const char *shaders = gw_naive_shaders(folder, "narrow", "shade/glossy_ray.glsl", "NARROW_LOBES");
    const double wide = grain_of_lobes(NULL), narrow = grain_of_lobes(shaders);
    print_message("# one sample is off 64 samples by %.2f/255, with rays as wide as a mirror's %.2f\n", wide,
                  narrow);
    assert_true(wide < 0.6 * narrow); /* the naive footprint fails */
}

/* A gaze, voxels, sparse samples: counted, suspended, with all effects and in pieces. */
static void however_it_is_drawn_pixels_are_the_same(void **state) {
    gw_stage stage;
    gw_camera camera;
    (void)state;
    open_at(&stage, &camera, floor_and_wall(0.2f, 0, 16), NULL);
    camera.state.tau = 3;
    camera.state.least_throughput = 0;
    gw_camera_gaze(&camera, SIDE / 3, SIDE / 2, 4.0);
    gw_counters counters = {0};
    uint8_t *whole = gw_stage_take(&stage, &camera, NULL, &counters);
    assert_true(counters.glossy_rays > 100);
    const gw_renderer_options suspended = {.loop_budget = 32, .force_features = GW_ALL_FEATURES};
    gw_renderer *other = gw_stage_renderer_with(&stage, &suspended);
    uint8_t *again = gw_camera_take(&camera, other, NULL);
    assert_memory_equal(whole, again, PIXELS * 4);
    uint8_t *part = calloc(PIXELS, 4);
    assert_non_null(part);
    static const gw_rectangle parts[] = {{0, 0, 13, 20}, {13, 3, 19, 29}, {5, 20, 8, 12}};
    for (size_t p = 0; p < 3; ++p) {
        const gw_rectangle *r = &parts[p];
        check_ok(
            gw_renderer_frame(other, &camera.placement, &camera.plane, r, &camera.state, part, NULL, &error));
        for (uint32_t y = 0; y < r->height; ++y)
            assert_memory_equal(part + (size_t)y * r->width * 4,
                                whole + ((size_t)(r->y + (int)y) * SIDE + (size_t)r->x) * 4,
                                (size_t)r->width * 4);
    }
    free(part);
    free(whole);
    free(again);
    gw_renderer_destroy(&other);
    gw_stage_close(&stage);
}

static void what_calls_for_it_is_data(void **state) {
    (void)state;
    gw_scene *scene = floor_and_wall(0.2f, 1, 16);
    assert_true(gw_calls_for_gloss(scene, NULL, 0.02f, 0.25f));
    assert_false(gw_calls_for_gloss(scene, NULL, 0.02f, 0.2f));
    assert_false(gw_calls_for_gloss(scene, NULL, 0.2f, 0.25f)); /* a mirror */
    assert_false(gw_calls_for_gloss(scene, NULL, 0.02f, 0));
    gw_scene *coated = black_floor(COATED, 0.2f); /* the coat alone */
    assert_true(gw_calls_for_gloss(coated, NULL, 0.02f, 0.25f));
    assert_false(gw_calls_for_gloss(coated, NULL, 0.02f, 0.2f));
    gw_scene_destroy(&coated);
    for (int i = 0; i < 3; ++i)
        scene->ambient[i] = scene->background[i] = scene->materials[WALL].emissive[i] = 0;
    assert_false(gw_calls_for_gloss(scene, NULL, 0.02f, 0.25f)); /* nothing to reflect */
    gw_scene_destroy(&scene);
}

/* Texels of a map of roughness from 0.5 to 1, times a factor of 0.8: smoother than 0.25 nowhere. */
static void maps_call_for_it_by_their_smoothest_texel(void **state) {
    (void)state;
    uint8_t *smoothest = NULL;
    for (int coat = 0; coat < 2; ++coat) {
        gw_scene *scene = black_floor(coat ? COATED : BARE, 1);
        gw_material_extension *extension = &scene->extensions[FLOOR];
        scene->textures = calloc(1, sizeof *scene->textures);
        assert_non_null(scene->textures);
        scene->texture_count = 1;
        check_ok(gw_image_create(2, 2, &scene->textures[0].image, &error));
        memcpy(scene->textures[0].image.rgba, "\0\xff\0\0\0\x80\0\0\0\xc0\0\0\0\xff\0\0", 16);
        (coat ? &extension->clearcoat_roughness_map : &extension->metallic_roughness)->texture = 0;
        extension->roughness = extension->clearcoat_roughness = 0.8f;
        check_ok(gw_smoothest_texels(scene, &smoothest, &error));
        assert_int_equal(smoothest[0], 0x80);
        assert_true(
            gw_calls_for_gloss(scene, NULL, 0.02f, 0.25f)); /* the naive rule: it may be smooth anywhere */
        assert_false(gw_calls_for_gloss(scene, smoothest, 0.02f, 0.4f));
        assert_true(gw_calls_for_gloss(scene, smoothest, 0.02f, 0.41f));
        free(smoothest);
        gw_scene_destroy(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_calls_for_it_is_data),
        cmocka_unit_test(maps_call_for_it_by_their_smoothest_texel),
        cmocka_unit_test(a_furnace_keeps_its_light),
        cmocka_unit_test(samples_fill_the_lobe),
        cmocka_unit_test(coats_reflect_as_they_are_rough),
        cmocka_unit_test(coats_show_lamps_once),
        cmocka_unit_test(smooth_coats_mirror_sharply),
        cmocka_unit_test(lobes_see_suns_through_glass_once),
        cmocka_unit_test(lobes_are_footprints),
        cmocka_unit_test(however_it_is_drawn_pixels_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
