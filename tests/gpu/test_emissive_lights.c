/* Emissive surfaces as lights, against the integral over their triangles in double precision, every shadow
 * tested with all triangles. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "render/emissive_lights.h"
#include "render/features.h"
#include "render/light_list.h"
#include "tests/support/double_hits.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>
#include <string.h>

enum { SIDE = 40, PIXELS = SIDE * SIDE, CELLS = 6, FLOOR = 0, LAMP = 1 };

static const char *const exact[] = {"octree_depth=6",   "tau=0", "tau_inside=0", "shadow_samples=16",
                                    "emissive_least=0", NULL};

/* What lies above height 0.02 and not beside x = 10 glows. */
static gw_scene *with_lamps(gw_mesh *mesh, double lowest, float glow, int both) {
    gw_scene *scene = gw_mesh_take(mesh);
    gw_material *materials = calloc(2, sizeof *materials);
    assert_non_null(materials);
    materials[FLOOR] =
        (gw_material){.base_color = {0.8f, 0.8f, 0.8f, 1}, .roughness = 1, .base_color_texture = -1};
    materials[LAMP] = materials[FLOOR];
    for (int i = 0; i < 3; ++i) {
        materials[LAMP].emissive[i] = glow;
        materials[LAMP].base_color[i] = 0.0f;
        scene->ambient[i] = scene->background[i] = 0.0f;
    }
    materials[LAMP].two_sided = both;
    free(scene->materials);
    scene->materials = materials;
    scene->material_count = 2;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        double least = 1e9;
        for (int k = 0; k < 3; ++k)
            least =
                fmin(least, ldexp((double)scene->positions[scene->triangles[t][k] * 3 + 1], scene->exponent) +
                                scene->centre[1]);
        scene->material_of[t] = least > lowest ? LAMP : FLOOR;
    }
    return scene;
}

static void add_floor(gw_mesh *mesh) {
    gw_mesh_add_grid(mesh, (const double[]){-2, 0, -2}, (const double[]){0, 0, 4}, (const double[]){4, 0, 0},
                     4, 4);
}

/* One-sided, 0.9 x 0.7 m, looks down from 1 m. */
static void add_panel(gw_mesh *mesh, double x, double y, double z) {
    gw_mesh_add_grid(mesh, (const double[]){x - 0.45, y, z - 0.35}, (const double[]){0.9, 0, 0},
                     (const double[]){0, 0, 0.7}, 1, 1);
}

static void look_down(gw_camera *camera, const gw_stage *stage, double fov) {
    gw_camera_look(camera, stage, (const double[]){3.5, 2.5, 0.2}, (const double[]){0, 0, 0}, fov, SIDE);
}

/* --- in double precision --- */

static void corner(const gw_scene *scene, uint32_t triangle, int k, double out[3]) {
    for (int i = 0; i < 3; ++i)
        out[i] = (double)scene->positions[(size_t)scene->triangles[triangle][k] * 3 + (size_t)i];
}

/* Rebased; 1: nothing that is dull lies between. */
static int sees(const gw_scene *scene, const double from[3], const double towards[3]) {
    gw_ray ray = {.maximum = 1.0f};
    for (int i = 0; i < 3; ++i) {
        ray.origin[i] = (float)from[i];
        ray.direction[i] = (float)towards[i];
    }
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        const gw_double_crossing met = gw_double_cross(scene, t, &ray);
        if (met.class == GW_DOUBLE_HIT && met.t > 1e-4 && met.t < 0.9999)
            return 0;
    }
    return 1;
}

/* Radiance of a place on the floor: 0.8 / pi times the integral of L cos cos' / d^2, `cuts` squared parts a
 * triangle. */
static double radiance_at(const gw_scene *scene, const double place[3], int cuts) {
    double sum = 0.0;
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        double a[3], b[3], c[3], n[3], from[3];
        const gw_material *material = &scene->materials[scene->material_of[t]];
        if (material->emissive[0] <= 0.0f)
            continue;
        corner(scene, t, 0, a);
        corner(scene, t, 1, b);
        corner(scene, t, 2, c);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            n[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
            from[i] = ldexp(place[i] - scene->centre[i], -scene->exponent);
        }
        for (int part = 0; part < cuts * cuts; ++part) {
            /* Middles of the small triangles, both ways up. */
            const int row = (int)sqrt((double)part), column = part - row * row, down = column & 1;
            const double v = (row + (down ? 1.0 : 2.0) / 3.0) / cuts,
                         w = (column / 2 + (down ? 2.0 : 1.0) / 3.0) / cuts;
            double towards[3], squared = 0.0, facing = 0.0;
            for (int i = 0; i < 3; ++i) {
                towards[i] = a[i] + v * (b[i] - a[i]) + w * (c[i] - b[i]) - from[i];
                squared += towards[i] * towards[i];
                facing -= towards[i] * n[i];
            }
            if (material->two_sided)
                facing = fabs(facing);
            if (facing > 0.0 && towards[1] > 0.0 && sees(scene, from, towards))
                sum += (double)material->emissive[0] * 0.5 * facing * towards[1] / (squared * squared) /
                       (cuts * cuts);
        }
    }
    return sum * 0.8 / 3.14159265358979;
}

/* Where the ray of a pixel meets the floor, metres. */
static void place_on_floor(const gw_camera *camera, double x, double y, double place[3]) {
    const double *eye = camera->state.eye;
    double aim[3];
    for (int i = 0; i < 3; ++i)
        aim[i] = camera->plane.corner[i] + camera->plane.step_x[i] * x + camera->plane.step_y[i] * y - eye[i];
    const double t = -eye[1] / aim[1];
    for (int i = 0; i < 3; ++i)
        place[i] = 1e-3 * (eye[i] + t * aim[i]);
}

/* Whether nothing lies between the eye and the floor in all pixels of the cell. */
static int is_open(const gw_stage *stage, const gw_camera *camera, int left, int top, int cell) {
    const gw_scene *scene = stage->scene;
    for (int p = 0; p < cell * cell; ++p) {
        double place[3], from[3], towards[3];
        place_on_floor(camera, left + p % cell + 0.5, top + p / cell + 0.5, place);
        for (int i = 0; i < 3; ++i) {
            from[i] = ldexp(place[i] - scene->centre[i], -scene->exponent);
            towards[i] = ldexp(1e-3 * camera->state.eye[i] - scene->centre[i], -scene->exponent) - from[i];
        }
        if (!sees(scene, from, towards))
            return 0;
    }
    return 1;
}

typedef struct deviation {
    double mean, worst; /* of cells of the floor from the integral, over its largest value */
    double ratio;       /* of all light */
    int cells;          /* that were compared */
    uint64_t shadow_rays;
} deviation;

/* Means of cells of pixels against the integral at their middles. */
static deviation compare(const gw_stage *stage, const gw_camera *camera, int cuts) {
    enum { CELL = SIDE / CELLS };
    gw_counters counters = {0};
    gw_renderer *renderer = gw_stage_renderer(stage);
    uint8_t *rgba = gw_camera_take(camera, renderer, &counters);
    double seen[CELLS * CELLS] = {0}, given[CELLS * CELLS], most = 0.0, all[2] = {0};
    deviation found = {.shadow_rays = counters.shadow_rays};
    assert_int_equal(counters.step_cap_hits, 0);
    for (int cell = 0; cell < CELLS * CELLS; ++cell) {
        double place[3];
        given[cell] = 0.0;
        const int left = cell % CELLS * CELL, top = cell / CELLS * CELL;
        if (!is_open(stage, camera, left, top, CELL))
            continue;
        ++found.cells;
        for (int p = 0; p < CELL * CELL; ++p)
            seen[cell] +=
                (double)gw_srgb_code_to_linear(rgba[4 * ((top + p / CELL) * SIDE + left + p % CELL)]) /
                (CELL * CELL);
        for (int i = 0; i < 4; ++i) {
            place_on_floor(camera, left + CELL * (0.25 + 0.5 * (i % 2)), top + CELL * (0.25 + 0.5 * (i / 2)),
                           place);
            given[cell] += 0.25 * radiance_at(stage->scene, place, cuts);
        }
        most = fmax(most, given[cell]);
        all[0] += seen[cell];
        all[1] += given[cell];
    }
    for (int cell = 0; cell < CELLS * CELLS; ++cell) {
        const double off = fabs(seen[cell] - given[cell]) / most;
        found.worst = fmax(found.worst, off);
        found.mean += off / found.cells;
    }
    found.ratio = all[0] / all[1];
    free(rgba);
    gw_renderer_destroy(&renderer);
    return found;
}

typedef enum lamps { PANEL, PANEL_BEHIND_PLATE, BALL, STRIP, SEVERAL, LAMPS } lamps;
static const char *const names[LAMPS] = {"panel", "panel behind a plate", "ball", "strip near the floor",
                                         "three lamps"};

static deviation light_of(lamps which, const char *shaders) {
    gw_mesh mesh = {0};
    gw_stage stage;
    gw_camera camera;
    double lowest = 0.3;
    add_floor(&mesh);
    if (which == PANEL || which == PANEL_BEHIND_PLATE || which == SEVERAL)
        add_panel(&mesh, 0, 1, 0);
    if (which == PANEL_BEHIND_PLATE) {
        gw_mesh_add_grid(&mesh, (const double[]){-0.2, 0.5, -0.6}, (const double[]){0, 0, 1.2},
                         (const double[]){1.0, 0, 0}, 1, 1);
        lowest = 0.7;
    }
    if (which == BALL || which == SEVERAL)
        gw_mesh_add_sphere(&mesh, (const double[]){-0.5, 0.8, 0.4}, 0.25, 0.0, 16, 9);
    if (which == STRIP) {
        gw_mesh_add_grid(&mesh, (const double[]){-1, 0.1, -0.02}, (const double[]){2, 0, 0},
                         (const double[]){0, 0, 0.04}, 9, 1);
        lowest = 0.05;
    }
    if (which == SEVERAL)
        gw_mesh_add_tetrahedron(&mesh, (const double[]){0.8, 0.6, -0.8}, 0.1);
    check_ok(gw_stage_open(&stage, with_lamps(&mesh, lowest, which == STRIP ? 1.0f : 2.0f, 0), shaders, exact,
                           &error));
    look_down(&camera, &stage, which == STRIP ? 5 : 24);
    const deviation found = compare(&stage, &camera, which == BALL || which == SEVERAL ? 2 : 10);
    gw_stage_close(&stage);
    return found;
}

static void they_light_as_their_triangles_do(void **state) {
    (void)state;
    char folder[512];
    const char *middles =
        gw_naive_shaders(folder, "emissive-middles", "shade/area_light.glsl", "EMISSIVE_MIDDLES");
    for (lamps which = PANEL; which < LAMPS; ++which) {
        const deviation ours = light_of(which, NULL);
        print_message("%s: %d cells, light %.3f of the integral, off by %.4f in the mean and %.4f at most\n",
                      names[which], ours.cells, ours.ratio, ours.mean, ours.worst);
        assert_true(ours.cells >= 12);
        /* A dielectric mirrors some hundredths elsewhere. */
        assert_true(fabs(ours.ratio - 1.0) < 0.07 && ours.mean < 0.025 && ours.worst < 0.09);
        if (which != BALL && which != SEVERAL)
            continue;
        const deviation naive = light_of(which, middles);
        print_message("    from the middles %.3f, %.4f, %.4f\n", naive.ratio, naive.mean, naive.worst);
        assert_true(naive.mean > 5.0 * ours.mean && naive.worst > 0.2); /* the naive place fails */
    }
}

/* Means of the floor left and right of a panel that stands at x = 0 and looks to the right. */
static void beside_panel(int both, const char *const *settings, double sides[2], uint64_t *shadow_rays) {
    gw_mesh mesh = {0};
    gw_stage stage;
    gw_camera camera;
    gw_counters counters = {0};
    add_floor(&mesh);
    gw_mesh_add_grid(&mesh, (const double[]){0, 0.1, -0.5}, (const double[]){0, 0.6, 0},
                     (const double[]){0, 0, 1}, 1, 1);
    check_ok(gw_stage_open(&stage, with_lamps(&mesh, 0.05, 2.0f, both), NULL, settings, &error));
    gw_camera_look(&camera, &stage, (const double[]){0, 5, 0.001}, (const double[]){0, 0, 0}, 30, SIDE);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    uint8_t *rgba = gw_camera_take(&camera, renderer, &counters);
    sides[0] = sides[1] = 0.0;
    for (int i = 0; i < PIXELS; ++i) {
        const int x = i % SIDE;
        if (x < SIDE / 2 - 2 || x > SIDE / 2 + 1)
            sides[x > SIDE / 2] += (double)gw_srgb_code_to_linear(rgba[4 * i]) / (PIXELS / 2);
    }
    *shadow_rays = counters.shadow_rays;
    free(rgba);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static void fronts_shine_and_backs_of_two_sided_ones(void **state) {
    (void)state;
    static const char *const none[] = {"octree_depth=6", "tau_inside=0", "emissive_lights=0", NULL},
                             *const faint[] = {"octree_depth=6", "tau_inside=0", "emissive_faintest=2.5",
                                               NULL},
                             *const near[] = {"octree_depth=6", "tau_inside=0", "emissive_least=0.5", NULL};
    double front[2], both[2], dark[2];
    uint64_t rays[3];
    beside_panel(0, exact, front, &rays[0]);
    beside_panel(1, exact, both, &rays[1]);
    print_message("left and right of a panel: %.4f %.4f, of one that shines both ways %.4f %.4f\n", front[0],
                  front[1], both[0], both[1]);
    const int bright = front[1] > front[0];
    assert_true(front[!bright] == 0.0 && front[bright] > 0.02);
    assert_true(both[bright] == front[bright] && fabs(both[!bright] / both[bright] - 1.0) < 0.03);
    beside_panel(1, none, dark, &rays[2]);
    assert_true(dark[0] == 0.0 && dark[1] == 0.0 && rays[2] == 0);
    beside_panel(1, faint, dark, &rays[2]);
    assert_true(dark[0] == 0.0 && dark[1] == 0.0 && rays[2] == 0);
    beside_panel(1, near, dark, &rays[2]); /* it ends within half a metre */
    assert_true(dark[bright] > 0.0 && dark[bright] < 0.5 * both[bright] && rays[2] < rays[1] / 8);
}

/* --- the list --- */

static gw_emissive_lights lights_of(const gw_scene *scene, uint32_t most, float faintest) {
    gw_emissive_lights lights;
    check_ok(gw_emissive_lights_make(scene, most, faintest, &lights, &error));
    return lights;
}

static void clusters_keep_all_light(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    uint64_t seed = 7;
    for (int i = 0; i < 40; ++i) { /* lamps of very unequal size */
        const double at[3] = {10 * gw_test_random(&seed), 1 + gw_test_random(&seed),
                              10 * gw_test_random(&seed)};
        gw_mesh_add_sphere(&mesh, at, i % 8 ? 0.01 : 0.2, 0.0, 24, 13);
    }
    add_floor(&mesh);
    gw_scene *scene = with_lamps(&mesh, 0.1, 3.0f, 0);
    double all = 0.0;
    for (uint32_t most = 1; most <= 64; most *= 4) {
        gw_emissive_lights lights = lights_of(scene, most, 0.5f);
        double area = 0.0, folded = 0.0, slots = 0.0;
        for (uint32_t i = 0; i < lights.count; ++i) {
            area += lights.lights[i].area;
            folded += lights.lights[i].folded * lights.lights[i].area;
            for (uint32_t s = 0; s < lights.lights[i].slot_count; ++s) {
                const gw_emissive_slot *slot = &lights.slots[lights.lights[i].first_slot + s];
                slots += (double)slot->light[0] / lights.lights[i].slot_count;
                assert_true(scene->material_of[slot->words[0]] == LAMP);
            }
        }
        all = most == 1 ? area : all;
        print_message("%u lights: %.4f m2, in slots %.4f, %.4f of it folded\n", lights.count, area,
                      slots / 3.0, folded / area);
        assert_true(lights.count <= most && (most > 4 || lights.count == most));
        assert_true(fabs(area / all - 1.0) < 1e-9 && fabs(slots / 3.0 / all - 1.0) < 1e-6);
        assert_true(folded / area < 0.07 && lights.faint == 0.0);
        gw_emissive_lights again = lights_of(scene, most, 0.5f);
        assert_int_equal(again.slot_count, lights.slot_count);
        assert_memory_equal(again.slots, lights.slots, lights.slot_count * sizeof *lights.slots);
        gw_emissive_lights_finish(&again);
        gw_emissive_lights_finish(&lights);
    }
    gw_emissive_lights none = lights_of(scene, 8, 3.5f);
    assert_true(none.count == 0 && none.faint == 1.0 && none.faint_triangles == 40 * 24 * 24);
    gw_emissive_lights_finish(&none);
    gw_scene_destroy(&scene);
}

/* Points of light are gone through in loops whose iterations some drivers count: fewer for each light where
 * there are many, and beyond that lights are left out and counted. */
static void lists_of_lights_are_bounded(void **state) {
    (void)state;
    enum { MANY = 9000 };
    static const uint32_t counts[] = {100, 1000, 5000, MANY}, points[] = {16, 4, 1, 1};
    const gw_light_knobs knobs = {.shadow_samples = 16};
    gw_light *lights = calloc(MANY, sizeof *lights);
    assert_non_null(lights);
    for (uint32_t i = 0; i < MANY; ++i)
        lights[i] = (gw_light){.kind = GW_LIGHT_POINT, .color = {1, 1, 1}, .extent = 0.1f};
    for (size_t k = 0; k < sizeof counts / sizeof counts[0]; ++k) {
        const gw_scene scene = {.lights = lights, .light_count = counts[k]};
        gw_light_list list;
        double sum = 0.0;
        check_ok(gw_light_list_make(&scene, NULL, 0, &knobs, &list, &error));
        for (uint32_t i = 0; i < list.placed; ++i)
            sum += (double)list.rows[i].color[0];
        assert_true(list.placed <= GW_MOST_LIGHTS && list.notes[0].rows == points[k]);
        assert_int_equal(list.left_out, counts[k] > GW_MOST_LIGHTS ? counts[k] - GW_MOST_LIGHTS : 0);
        assert_true(fabs(sum - (counts[k] - list.left_out)) < 1e-6);
        gw_light_list_finish(&list);
    }
    free(lights);
}

/* --- any way --- */

/* A room with every kind of soft light: a sky with a window, a rectangle, a ball of light, two panels that
 * glow. */
static void open_room(gw_stage *stage, gw_camera *camera, uint32_t balls) {
    gw_mesh mesh = {0};
    add_floor(&mesh);
    add_panel(&mesh, 0.3, 1, 0);
    add_panel(&mesh, -0.9, 0.7, 0.5);
    gw_mesh_add_grid(&mesh, (const double[]){-0.6, 0, -0.6}, (const double[]){0.3, 0.2, 0.9},
                     (const double[]){0, 0.25, 0}, 3, 2);
    gw_scene *scene = with_lamps(&mesh, 0.5, 1.5f, 1);
    scene->lights = calloc(balls + 1, sizeof *scene->lights);
    assert_non_null(scene->lights);
    scene->light_count = balls + 1;
    scene->lights[balls] = (gw_light){.kind = GW_LIGHT_RECTANGLE,
                                      .vector = {0, 1.5, 1},
                                      .color = {1, 0.5f, 0.2f},
                                      .sides = {{0.5f, 0, 0}, {0, 0, 0.5f}}};
    for (uint32_t i = 0; i < balls; ++i)
        scene->lights[i] =
            (gw_light){.kind = GW_LIGHT_POINT,
                       .vector = {0.8, 0.9, -0.4},
                       .color = {1.0f / (float)balls, 1.0f / (float)balls, 1.0f / (float)balls},
                       .extent = 0.2f};
    check_ok(gw_image_create(64, 32, &scene->environment.rgbe, &error));
    for (int i = 0; i < 64 * 32; ++i)
        memcpy(scene->environment.rgbe.rgba + 4 * i,
               i / 64 >= 6 && i / 64 < 10 && i % 64 < 9 ? "\x80\x80\x80\x85" : "\x80\x80\x80\x7f", 4);
    scene->environment.scale = 1.0f;
    check_ok(gw_stage_open(stage, scene, NULL,
                           (const char *const[]){"octree_depth=6", "tau=2", "tau_inside=1", NULL}, &error));
    gw_camera_look(camera, stage, (const double[]){2.2, 1.6, 1.9}, (const double[]){0, 0.1, 0}, 44, SIDE);
}

static void any_split_gives_the_same_bits(void **state) {
    (void)state;
    gw_stage stage;
    gw_camera camera;
    static uint8_t piece[PIXELS * 4];
    open_room(&stage, &camera, 1);
    gw_camera_gaze(&camera, 14, 18, 5);
    gw_renderer *renderer = gw_stage_renderer(&stage),
                *short_winded = gw_stage_renderer_with(&stage, &(gw_renderer_options){.loop_budget = 40});
    gw_counters counters = {0};
    uint8_t *whole = gw_camera_take(&camera, renderer, &counters),
            *suspended = gw_camera_take(&camera, short_winded, NULL);
    assert_true(counters.shadow_rays > 10 * PIXELS);
    assert_int_equal(counters.step_cap_hits, 0);
    assert_memory_equal(whole, suspended, PIXELS * 4);
    for (int part = 0; part < 6; ++part) {
        static const int32_t columns[4] = {0, 11, 27, SIDE}, rows[3] = {0, 19, SIDE};
        const int32_t x = columns[part % 3], y = rows[part / 3];
        const gw_rectangle cut = {x, y, (uint32_t)(columns[part % 3 + 1] - x),
                                  (uint32_t)(rows[part / 3 + 1] - y)};
        check_ok(gw_renderer_frame(renderer, &camera.placement, &camera.plane, &cut, &camera.state, piece,
                                   NULL, &error));
        for (uint32_t row = 0; row < cut.height; ++row)
            assert_memory_equal(piece + row * cut.width * 4,
                                whole + 4 * ((size_t)(y + (int32_t)row) * SIDE + (size_t)x), cut.width * 4);
    }
    gw_renderer_destroy(&short_winded);
    gw_renderer_destroy(&renderer);
    free(suspended);
    free(whole);
    gw_stage_close(&stage);
}

/* A light is as bright as the many that it is cut into, with as many points as there may be: 400 of 16
 * points, with 8 fragments a ray beyond 50,000 iterations of an invocation. */
static void many_lights_are_all_there(void **state) {
    (void)state;
    double light[2];
    for (int many = 0; many < 2; ++many) {
        gw_stage stage;
        gw_camera camera;
        gw_counters counters = {0};
        open_room(&stage, &camera, many ? 400 : 1);
        gw_camera_look(&camera, &stage, (const double[]){2.2, 1.6, 1.9}, (const double[]){0, 0.1, 0}, 44, 8);
        camera.state.shadow_samples = 2;
        camera.state.emissive_lights = 0;
        uint8_t *rgba = gw_stage_take(&stage, &camera, NULL, &counters);
        light[many] = gw_mean_linear(rgba, 64);
        assert_int_equal(counters.step_cap_hits, 0);
        free(rgba);
        gw_stage_close(&stage);
    }
    print_message("mean with one ball of light %.4f, cut into 400 %.4f\n", light[0], light[1]);
    assert_true(fabs(light[1] / light[0] - 1.0) < 0.01);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_light_as_their_triangles_do),
        cmocka_unit_test(fronts_shine_and_backs_of_two_sided_ones),
        cmocka_unit_test(clusters_keep_all_light),
        cmocka_unit_test(lists_of_lights_are_bounded),
        cmocka_unit_test(any_split_gives_the_same_bits),
        cmocka_unit_test(many_lights_are_all_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
