/* What lights give a surface, against their formulas: a white floor seen from above. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/features.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>
#include <string.h>

enum { SIDE = 48, PIXELS = SIDE * SIDE };

/* A floor of 4 m at height 0, rough and white, seen from 6 m above; light from everywhere only if the test
 * adds it. */
static void open_floor(gw_stage *stage, const gw_light *lights, uint32_t count, const char *const *settings) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-2, 0, -2}, (const double[]){0, 0, 4}, (const double[]){4, 0, 0},
                     4, 4);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->lights = calloc(count + 1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    memcpy(scene->lights, lights, count * sizeof *lights);
    scene->light_count = count;
    for (int i = 0; i < 3; ++i) {
        scene->ambient[i] = scene->background[i] = 0.0f;
        scene->materials[0].base_color[i] = 0.8f;
    }
    scene->materials[0].roughness = 1.0f;
    check_ok(gw_stage_open(stage, scene, NULL, settings, &error));
}

static const char *const exact[] = {"octree_depth=6", "tau=0", "tau_inside=0", NULL};

static void look_down(gw_camera *camera, const gw_stage *stage) {
    gw_camera_look(camera, stage, (const double[]){0, 6, 0.001}, (const double[]){0, 0, 0}, 36.0, SIDE);
}

/* Where the ray of a pixel meets the floor, metres. */
static void place_on_floor(const gw_camera *camera, int x, int y, double place[3]) {
    const double *eye = camera->state.eye;
    double aim[3];
    for (int i = 0; i < 3; ++i)
        aim[i] = camera->plane.corner[i] + camera->plane.step_x[i] * (x + 0.5) +
                 camera->plane.step_y[i] * (y + 0.5) - eye[i];
    const double t = -eye[1] / aim[1];
    for (int i = 0; i < 3; ++i)
        place[i] = 1e-3 * (eye[i] + t * aim[i]);
}

static uint8_t *take(const gw_stage *stage, const gw_camera *camera, gw_features forced,
                     gw_counters *counters) {
    gw_renderer *renderer = NULL;
    const gw_renderer_options options = {.force_features = forced};
    check_ok(gw_renderer_create(stage->device, stage->scene, stage->octree, &options, &renderer, &error));
    uint8_t *rgba = gw_camera_take(camera, renderer, counters);
    gw_renderer_destroy(&renderer);
    return rgba;
}

/* KHR_lights_punctual: intensity / d^2, times the cone's share, times what the range leaves. */
static double spot_at(const gw_light *light, const double place[3]) {
    double to[3], squared = 0.0, axis = 0.0;
    for (int i = 0; i < 3; ++i) {
        to[i] = light->vector[i] - place[i];
        squared += to[i] * to[i];
    }
    const double distance = sqrt(squared);
    for (int i = 0; i < 3; ++i)
        axis -= (double)light->axis[i] * to[i] / distance;
    const double inner = cos((double)light->cone[0]), outer = cos((double)light->cone[1]);
    const double share = fmin(fmax((axis - outer) / (inner - outer), 0.0), 1.0);
    const double left = fmax(1.0 - pow(distance / (double)light->range, 4.0), 0.0);
    return (double)light->color[0] / squared * share * share * left * to[1] / distance;
}

static void spots_follow_the_standard(void **state) {
    (void)state;
    const gw_light spot = {.kind = GW_LIGHT_SPOT,
                           .vector = {0.4, 2, -0.3},
                           .color = {9, 9, 9},
                           .axis = {0.2425356f, -0.9701425f, 0},
                           .cone = {0.2f, 0.6f},
                           .range = 2.9f};
    gw_stage stage;
    gw_camera camera;
    gw_counters counters = {0};
    open_floor(&stage, &spot, 1, exact);
    look_down(&camera, &stage);
    uint8_t *rgba = take(&stage, &camera, 0, &counters);
    double worst = 0.0;
    size_t lit = 0, dark = 0;
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            double place[3];
            place_on_floor(&camera, x, y, place);
            if (fabs(place[0]) > 1.95 || fabs(place[2]) > 1.95)
                continue;
            const double given = spot_at(&spot, place) * 0.8 / 3.14159265358979;
            const double seen = (double)gw_srgb_code_to_linear(rgba[4 * (y * SIDE + x)]);
            lit += given > 0.05;
            dark += given == 0.0;
            if (given == 0.0)
                assert_true(seen == 0.0);
            if (given < 0.9) /* with what little a rough white surface mirrors */
                worst = fmax(worst, fabs(seen - given) - 0.05 * given);
        }
    print_message("spot: %zu pixels lit, %zu dark, worst beyond its specular part %.4f, %llu shadow rays\n",
                  lit, dark, worst, (unsigned long long)counters.shadow_rays);
    assert_true(lit > 100 && dark > 500 && worst < 0.012);
    assert_true(counters.shadow_rays < PIXELS - dark + 8); /* none where the cone ends */
    free(rgba);
    gw_stage_close(&stage);
}

/* The floor under a sky, with a wall of 1 m along x = 0. */
static void open_sky(gw_stage *stage, int with_sun) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-2, 0, -2}, (const double[]){0, 0, 4}, (const double[]){4, 0, 0},
                     4, 4);
    gw_mesh_add_grid(&mesh, (const double[]){0, 0, -2}, (const double[]){0, 0, 4}, (const double[]){0, 1, 0},
                     4, 4);
    gw_scene *scene = gw_mesh_take(&mesh);
    for (int i = 0; i < 3; ++i) {
        scene->ambient[i] = scene->background[i] = 0.0f;
        scene->materials[0].base_color[i] = 0.2f;
    }
    scene->materials[0].roughness = 1.0f;
    gw_give_sky(scene, with_sun);
    check_ok(gw_stage_open(stage, scene, NULL, exact, &error));
}

/* Mean linear value of the floor's pixels from x to x + 0.3 m. */
static double floor_from(const gw_camera *camera, const uint8_t *rgba, double from) {
    double sum = 0.0;
    size_t count = 0;
    for (int y = SIDE / 4; y < SIDE * 3 / 4; ++y)
        for (int x = 0; x < SIDE; ++x) {
            double place[3];
            place_on_floor(camera, x, y, place);
            if (place[0] < from || place[0] > from + 0.3)
                continue;
            sum += gw_srgb_code_to_linear(rgba[4 * (y * SIDE + x)]);
            ++count;
        }
    assert_true(count > 50);
    return sum / (double)count;
}

static void suns_of_environments_cast_shadows(void **state) {
    (void)state;
    gw_stage stage;
    gw_camera camera;
    open_sky(&stage, 1);
    look_down(&camera, &stage);
    const double pi = 3.14159265358979, sun = gw_sky_irradiance_of_sun(), sky = 0.5 * pi;
    const double lit = (sun + sky) * 0.2 / pi, shaded = sky * 0.2 / pi;
    for (int lights = 0; lights <= 8; lights += 8) {
        gw_counters counters = {0};
        camera.state.environment_lights = (uint8_t)lights;
        uint8_t *rgba = take(&stage, &camera, 0, &counters);
        const double open = floor_from(&camera, rgba, 0.5), behind = floor_from(&camera, rgba, -0.6);
        print_message("%d lights: %.4f in the open (%.4f), %.4f behind the wall (%.4f), %llu shadow rays\n",
                      lights, open, lit, behind, shaded, (unsigned long long)counters.shadow_rays);
        /* a rough surface mirrors 0.04 of what is around, less the sun's grazing light */
        assert_true(open > 0.98 * lit && open < 1.25 * lit);
        assert_true(lights ? behind < 1.25 * shaded && counters.shadow_rays > 0
                           : behind > 0.98 * lit && counters.shadow_rays == 0);
        free(rgba);
    }
    gw_stage_close(&stage);
}

/* Nothing stands out of it: no light, no ray. What a ray sees beside the floor is the ground of the picture.
 */
static void even_skies_need_no_shadow_rays(void **state) {
    (void)state;
    gw_stage stage;
    gw_camera camera;
    gw_counters counters = {0};
    open_sky(&stage, 0);
    gw_camera_look(&camera, &stage, (const double[]){0, 6, 0.001}, (const double[]){0, 0, 0}, 60.0, SIDE);
    camera.state.environment_lights = 64;
    uint8_t *rgba = take(&stage, &camera, 0, &counters);
    assert_true(counters.shadow_rays == 0);
    assert_true(fabs(gw_srgb_code_to_linear(rgba[0]) - 0.25) < 0.005);
    free(rgba);
    gw_camera_look(&camera, &stage, (const double[]){0, -1, 0.001}, (const double[]){0, -2, -3}, 30.0, SIDE);
    rgba = take(&stage, &camera, 0, &counters);
    assert_true(fabs(gw_srgb_code_to_linear(rgba[4 * (SIDE / 2 * SIDE + SIDE / 2)]) - 0.25) < 0.005);
    free(rgba);
    gw_stage_close(&stage);
}

static const double white_of_floor = 0.8;

/* A floor of 2 m; and over it, if `glass` is given, a sheet with this index of refraction as wide as the sky.
 */
static gw_scene *floor_under(float glass, int with_sun) {
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-1, 0, -1}, (const double[]){0, 0, 2}, (const double[]){2, 0, 0},
                     4, 4);
    gw_mesh_add_grid(&mesh, (const double[]){-40, glass > 0 ? 0.5 : -0.5, -40}, (const double[]){0, 0, 80},
                     (const double[]){80, 0, 0}, 8, 8);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->materials = realloc(scene->materials, 2 * sizeof *scene->materials);
    scene->extensions = malloc(2 * sizeof *scene->extensions);
    assert_true(scene->materials && scene->extensions);
    scene->material_count = 2;
    scene->materials[1] = scene->materials[0];
    for (int i = 0; i < 2; ++i) {
        scene->extensions[i] = gw_material_extension_none();
        scene->extensions[i].specular = i == 0 ? 0 : 1;
        scene->materials[i].metalness = 0;
        scene->materials[i].roughness = i == 0 ? 1 : 0;
        for (int k = 0; k < 3; ++k)
            scene->materials[i].base_color[k] = i == 0 ? (float)white_of_floor : 1;
    }
    scene->extensions[1].transmission = 1;
    scene->extensions[1].ior = fmaxf(glass, 1);
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        const float height = scene->positions[3 * (size_t)scene->triangles[t][0] + 1]; /* about the middle */
        scene->material_of[t] = glass > 0 ? height > 0 : height < 0;
    }
    for (int k = 0; k < 3; ++k)
        scene->ambient[k] = scene->background[k] = 0;
    gw_give_sky(scene, with_sun);
    return scene;
}

/* Mean light of the floor's pixels. */
static double light_under(float glass, int with_sun, const char *shaders) {
    gw_stage stage;
    gw_camera camera;
    check_ok(
        gw_stage_open(&stage, floor_under(glass, with_sun), shaders,
                      (const char *const[]){"octree_depth=8", "occlusion_cones=6", "occlusion_distance=2",
                                            "diffuse_bounce=on", "accumulate=16", NULL},
                      &error));
    gw_camera_look(&camera, &stage, (const double[]){0, 0.4, 0.3}, (const double[]){0, 0, 0}, 40, SIDE / 2);
    uint8_t *pixels = gw_stage_take(&stage, &camera, NULL, NULL);
    const double light = gw_mean_linear(pixels, PIXELS / 4);
    free(pixels);
    gw_stage_close(&stage);
    return light;
}

/* Glass of index 1 cannot be seen: what stands beneath it has the light of the open sky, once. Lights stand
 * for the sun, and shine through the glass themselves; where cones see it there, too, it lights twice. */
static void cones_see_no_lamps_through_glass(void **state) {
    char folder[512];
    (void)state;
    const char *twice = gw_naive_shaders(folder, "lamps-twice", "shade/secondary_light.glsl", "LAMPS_TWICE");
    const double share = white_of_floor / 3.14159265358979, sun = share * gw_sky_irradiance_of_sun();
    for (int with_sun = 0; with_sun < 2; ++with_sun) {
        const double wanted = share * 0.5 * 3.14159265358979 + with_sun * sun;
        const double open = light_under(0, with_sun, NULL), beneath = light_under(1, with_sun, NULL);
        print_message("# %s: %.4f wanted, %.4f in the open, %.4f beneath glass\n",
                      with_sun ? "sun" : "even sky", wanted, open, beneath);
        assert_true(fabs(open - wanted) < 0.02 * wanted);
        assert_true(fabs(beneath - wanted) < 0.03 * wanted); /* the picture is blurred across the horizon */
    }
    const double naive = light_under(1, 1, twice), wanted = share * 0.5 * 3.14159265358979 + sun;
    print_message("# sun, seen by cones too: %.4f beneath glass\n", naive);
    assert_true(naive > wanted + 0.5 * sun); /* the naive rule fails */
}

/* Mean over the floor of what is seen over what is given, and the worst pixel's deviation from it. */
static double mean_ratio(const gw_light *light, double (*given)(const gw_light *, const double[3])) {
    gw_stage stage;
    gw_camera camera;
    open_floor(&stage, light, 1, exact);
    look_down(&camera, &stage);
    uint8_t *rgba = take(&stage, &camera, 0, NULL);
    double seen = 0.0, wanted = 0.0;
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            double place[3];
            place_on_floor(&camera, x, y, place);
            if (fabs(place[0]) > 1.9 || fabs(place[2]) > 1.9)
                continue;
            seen += gw_srgb_code_to_linear(rgba[4 * (y * SIDE + x)]);
            wanted += given(light, place) * 0.8 / 3.14159265358979;
        }
    free(rgba);
    gw_stage_close(&stage);
    return seen / wanted;
}

/* A sphere above the horizon gives what its middle would. */
static double sphere_at(const gw_light *light, const double place[3]) {
    double squared = 0.0;
    for (int i = 0; i < 3; ++i)
        squared += (light->vector[i] - place[i]) * (light->vector[i] - place[i]);
    return (double)light->color[0] / squared * light->vector[1] / sqrt(squared);
}

static double sun_at(const gw_light *light, const double place[3]) {
    (void)place;
    return -(double)light->color[0] * light->vector[1];
}

static double rectangle_at(const gw_light *light, const double place[3]) {
    enum { STEPS = 24 };
    double sum = 0.0;
    for (int i = 0; i < STEPS * STEPS; ++i) {
        double to[3], squared = 0.0;
        for (int k = 0; k < 3; ++k) {
            to[k] = light->vector[k] + ((i / STEPS + 0.5) / STEPS - 0.5) * (double)light->sides[0][k] +
                    ((i % STEPS + 0.5) / STEPS - 0.5) * (double)light->sides[1][k] - place[k];
            squared += to[k] * to[k];
        }
        sum += to[1] * to[1] / (squared * squared); /* it looks straight down */
    }
    return (double)light->color[0] * sum / (STEPS * STEPS);
}

static void extents_keep_energy(void **state) {
    (void)state;
    const gw_light sphere = {
        .kind = GW_LIGHT_POINT, .vector = {0.3, 1.2, 0.1}, .color = {1, 1, 1}, .extent = 0.7f};
    const gw_light sun = {
        .kind = GW_LIGHT_DIRECTIONAL, .vector = {0.6, -0.8, 0}, .color = {1.5f, 1.5f, 1.5f}, .extent = 0.5f};
    const gw_light lamp = {.kind = GW_LIGHT_RECTANGLE,
                           .vector = {0.2, 1, -0.2},
                           .color = {1, 1, 1},
                           .sides = {{1, 0, 0}, {0, 0, 1.5f}}};
    const double of_sphere = mean_ratio(&sphere, sphere_at), of_sun = mean_ratio(&sun, sun_at),
                 of_lamp = mean_ratio(&lamp, rectangle_at);
    print_message("seen over given: sphere %.4f, sun %.4f, rectangle %.4f\n", of_sphere, of_sun, of_lamp);
    /* A dielectric takes its mirrored part from the diffuse one and gives it elsewhere: some hundredths. */
    assert_true(fabs(of_sphere - 1.0) < 0.04 && fabs(of_sun - 1.0) < 0.04 && fabs(of_lamp - 1.0) < 0.04);
}

/* Share of a disc of radius 1 on one side of a chord that lies x from its middle. */
static double share_of_disc(double x) {
    const double c = fmin(fmax(x, -1.0), 1.0);
    return 0.5 + (c * sqrt(1.0 - c * c) + asin(c)) / 3.14159265358979;
}

/* The edge of a plate 1 m above the floor under a sun of 20 degrees: worst deviation of the mean of a column
 * from the share of the sun's disc that is seen from there. *grain, if not NULL: what pixels of a row are off
 * their mean (root mean square, worst row). shadow_samples as the frame state has them, samples: log2. */
static double error_of_penumbra(const char *shaders, uint8_t shadow_samples, uint8_t samples, double *grain) {
    const double tangent = 0.17632698;
    gw_mesh mesh = {0};
    gw_mesh_add_grid(&mesh, (const double[]){-2, 0, -2}, (const double[]){0, 0, 4}, (const double[]){4, 0, 0},
                     4, 4);
    gw_mesh_add_grid(&mesh, (const double[]){-2, 1, -2}, (const double[]){0, 0, 4}, (const double[]){2, 0, 0},
                     4, 4);
    gw_scene *scene = gw_mesh_take(&mesh);
    scene->lights = calloc(1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    scene->light_count = 1;
    scene->lights[0] = (gw_light){
        .kind = GW_LIGHT_DIRECTIONAL, .vector = {0, -1, 0}, .color = {2, 2, 2}, .extent = 0.17453293f};
    for (int i = 0; i < 3; ++i)
        scene->ambient[i] = scene->background[i] = 0.0f;
    scene->materials[0].roughness = 1.0f;
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, scene, shaders, exact, &error));
    gw_camera_look(&camera, &stage, (const double[]){3, 4, 0}, (const double[]){0, 0, 0}, 6.0, SIDE);
    camera.state.shadow_samples = shadow_samples;
    camera.state.samples = samples;
    uint8_t *rgba = take(&stage, &camera, 0, NULL);
    double worst = 0.0, full = 0.0, scattered = 0.0;
    for (int pass = 0; pass < 2; ++pass)
        for (int y = 0; y < SIDE; ++y) { /* rows lie along the edge */
            double sum = 0.0, squares = 0.0, wanted = 0.0;
            for (int x = 0; x < SIDE; ++x) {
                double place[3];
                place_on_floor(&camera, x, y, place);
                const double seen = gw_srgb_code_to_linear(rgba[4 * (y * SIDE + x)]);
                sum += seen / SIDE;
                squares += seen * seen / SIDE;
                wanted += share_of_disc(place[0] / tangent) / SIDE;
            }
            if (pass == 0)
                full = fmax(full, sum);
            else
                worst = fmax(worst, fabs(sum / full - wanted));
            scattered = fmax(scattered, sqrt(fmax(squares - sum * sum, 0.0)));
        }
    assert_true(full > 0.1);
    if (grain)
        *grain = scattered / full;
    free(rgba);
    gw_stage_close(&stage);
    return worst;
}

static void penumbrae_are_as_wide_as_the_sun(void **state) {
    (void)state;
    char folder[512];
    const char *middles = gw_naive_shaders(folder, "light-middles", "shade/area_light.glsl", "LIGHT_MIDDLES");
    const double four = error_of_penumbra(NULL, 1, 0, NULL), sixteen = error_of_penumbra(NULL, 2, 0, NULL),
                 naive = error_of_penumbra(middles, 1, 0, NULL);
    print_message(
        "penumbra off by at most %.3f with 4 rays, %.3f with 16; %.3f with the middles of 4 parts\n", four,
        sixteen, naive);
    assert_true(four < 0.08 && sixteen < 0.04 && naive > 2.0 * four); /* the naive places fail */
}

/* The rays of a pixel take points of their own on a light: its penumbrae have the grain of as many shadow
 * rays. */
static void rays_of_a_pixel_see_a_light_in_several_places(void **state) {
    (void)state;
    char folder[512];
    const char *alike = gw_naive_shaders(folder, "light-first", "shade/area_light.glsl", "LIKE_THE_FIRST");
    double one = 0.0, several = 0.0, naive = 0.0;
    error_of_penumbra(NULL, 0, 0, &one);
    error_of_penumbra(NULL, 0, 4, &several);
    error_of_penumbra(alike, 0, 4, &naive);
    print_message(
        "pixels of a penumbra are %.3f off with a ray, %.3f with 16, %.3f if these take one place\n", one,
        several, naive);
    assert_true(several < 0.3 * one && naive > 2.0 * several);
}

/* A lamp one metre above the floor, seen with light_least at `least`, 65535ths; range: its own. */
static uint8_t *under_lamp(float range, uint16_t least, gw_camera *camera, gw_counters *counters) {
    const gw_light lamp = {.kind = GW_LIGHT_POINT, .vector = {-1, 1, 0}, .color = {1, 1, 1}, .range = range};
    gw_stage stage;
    open_floor(&stage, &lamp, 1, exact);
    look_down(camera, &stage);
    camera->state.light_least = least;
    memset(counters, 0, sizeof *counters);
    uint8_t *rgba = take(&stage, camera, 0, counters);
    gw_stage_close(&stage);
    return rgba;
}

/* Far from the lamp: where it ends, and the largest step from a pixel to the next. A light that is cut off at
 * its end has an edge there. */
static void faint_light_of_lamps_ends_without_an_edge(void **state) {
    (void)state;
    gw_camera camera;
    gw_counters all, fewer, near;
    const uint16_t least = 3000;
    const double faintest = least / 65535.0, pi = 3.14159265358979, reach = sqrt(1.0 / (pi * faintest));
    uint8_t *whole = under_lamp(0, 0, &camera, &all), *ends = under_lamp(0, least, &camera, &fewer);
    double worst = 0.0, step = 0.0, cut_off = 0.0, row[2] = {0, 0};
    size_t beyond = 0, lit = 0;
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            double place[3];
            place_on_floor(&camera, x, y, place);
            const double seen = gw_srgb_code_to_linear(ends[4 * (y * SIDE + x)]);
            const double given = gw_srgb_code_to_linear(whole[4 * (y * SIDE + x)]);
            const double away = sqrt((place[0] + 1) * (place[0] + 1) + 1 + place[2] * place[2]);
            const double naive = away < reach ? given : 0.0;
            worst = fmax(worst, given - seen);
            lit += away < reach;
            if (away > reach && fabs(place[0]) < 1.95 && fabs(place[2]) < 1.95) {
                assert_true(seen == 0.0 && given > 0.0);
                ++beyond;
            }
            if (away > 0.8 * reach && x > 0) {
                step = fmax(step, fabs(seen - row[0]));
                cut_off = fmax(cut_off, fabs(naive - row[1]));
            }
            row[0] = seen;
            row[1] = naive;
        }
    print_message(
        "light_least %.4f: off by at most %.4f, %llu shadow rays of %llu; steps %.4f, cut off %.4f\n",
        faintest, worst, (unsigned long long)fewer.shadow_rays, (unsigned long long)all.shadow_rays, step,
        cut_off);
    assert_true(beyond > 200 && worst > 0.1 * faintest && worst < faintest);
    assert_true(fewer.shadow_rays <= lit && fewer.shadow_rays < all.shadow_rays);
    assert_true(step < 0.5 * cut_off);
    free(whole);
    /* A lamp that ends nearer by itself is as it was. */
    whole = under_lamp(1.4f, 0, &camera, &all);
    free(ends);
    ends = under_lamp(1.4f, least, &camera, &near);
    assert_memory_equal(whole, ends, (size_t)PIXELS * 4);
    assert_true(near.shadow_rays == all.shadow_rays && near.shadow_rays < fewer.shadow_rays);
    free(whole);
    free(ends);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faint_light_of_lamps_ends_without_an_edge),
        cmocka_unit_test(spots_follow_the_standard),
        cmocka_unit_test(suns_of_environments_cast_shadows),
        cmocka_unit_test(even_skies_need_no_shadow_rays),
        cmocka_unit_test(cones_see_no_lamps_through_glass),
        cmocka_unit_test(extents_keep_energy),
        cmocka_unit_test(penumbrae_are_as_wide_as_the_sun),
        cmocka_unit_test(rays_of_a_pixel_see_a_light_in_several_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
