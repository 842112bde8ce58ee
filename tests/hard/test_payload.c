/* What voxels keep of their contents: colours by area, normals that do not turn aside. The rules that fail
 * here are kept as settings (payload_rule = seed) or as pictures taken with them. */
#include "tests/support/check.h"

#include "base/memory.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE };

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
    gw_mesh_add_tetrahedron(mesh, (const double[]){0.9, 0.9, -0.41}, 0.001);
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
    gw_scene *scene = gw_mesh_take(&mesh);
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
    gw_scene *scene = gw_mesh_take(&mesh);
    set_grey(scene->ambient, 0.0f);
    void *light = NULL;
    check_ok(gw_allocate(&light, 1, sizeof *scene->lights, "light", &error));
    scene->lights = light;
    scene->lights[0] = (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0, 0, -1}, .color = {2, 2, 2}};
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

/* A pair of oblique parallel sheets. */
static void add_sheets(gw_mesh *mesh, double distance) {
    add_ballast(mesh);
    for (int i = 0; i < 2; ++i)
        gw_mesh_add_grid(mesh, (const double[]){-0.9, -0.9, -0.3 + i * distance},
                         (const double[]){1.8, 0, 0.4}, (const double[]){0, 1.8, 0.3}, 64, 64);
}

/* Share of the nodes of a level whose surface is flagged as separated. */
static double separated_share(double distance, int level) {
    gw_mesh mesh = {0};
    add_sheets(&mesh, distance);
    gw_stage stage;
    check_ok(gw_stage_open(&stage, gw_mesh_take(&mesh), NULL, (const char *const[]){"octree_depth=8", NULL},
                           &error));
    const gw_octree *octree = stage.octree;
    uint32_t flagged = 0, first = octree->level_begin[level], last = octree->level_begin[level + 1];
    for (uint32_t i = first; i < last; ++i)
        flagged += (octree->payloads[i].color & GW_PAYLOAD_SEPARATED) != 0;
    double share = (double)flagged / (last - first);
    print_message("sheets %.4f apart, level %d: %.3f of %u nodes are separated\n", distance, level, share,
                  last - first);
    gw_stage_close(&stage);
    return share;
}

/* Sheets that are apart within a cell of 1/16 m (level 5 of 2 m), and sheets that one plane stands for. */
static void sheets_apart_are_flagged(void **state) {
    (void)state;
    assert_true(separated_share(0.03, 5) > 0.3); /* the others hold one sheet only */
    assert_true(separated_share(0.003, 5) < 0.05);
}

/* A white carpet over a black floor: from above, voxels that hold both are grey. */
static void a_floor_does_not_shine_through_its_carpet(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    add_sheets(&mesh, 0.03);
    gw_stage stage;
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_material *materials = material_from_z(scene, INFINITY);
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        double at[3] = {0};
        for (int k = 0; k < 9; ++k)
            at[k % 3] += (double)scene->positions[scene->triangles[t][k / 3] * 3 + (uint32_t)k % 3] / 3.0;
        for (int k = 0; k < 3; ++k)
            at[k] = ldexp(at[k], scene->exponent) + scene->centre[k];
        double floor_z = -0.3 + 0.4 * (at[0] + 0.9) / 1.8 + 0.3 * (at[1] + 0.9) / 1.8;
        scene->material_of[t] = at[2] > floor_z + 0.015;
    }
    set_grey(materials[0].base_color, 0.0f);
    set_grey(materials[1].base_color, 0.8f);
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0, 0, 3}, (const double[]){0, 0, 0}, 10, SIDE);
    double light[3];
    for (int i = 0; i < 3; ++i) {
        camera.state.tau_inside = i == 0 ? 0.0f : 6.0f;
        camera.state.separated_tau = i == 1 ? 0.5f : 1.0f;
        uint8_t *rgba = gw_camera_take(&camera, renderer, NULL);
        light[i] = gw_mean_linear(rgba, PIXELS);
        free(rgba);
    }
    print_message("carpet: %.4f exact, %.4f as voxels, %.4f where separated ones are not refined\n", light[0],
                  light[1], light[2]);
    assert_true(fabs(light[1] - light[0]) < 0.15 * light[0]);
    assert_true(fabs(light[2] - light[0]) > 2.0 * fabs(light[1] - light[0])); /* the naive rule fails */
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

/* Gives every voxel one finish: what a rule that keeps a cell's dominant material would store where it is
 * everywhere the same one. */
static void store_finish(gw_octree *octree, uint32_t roughness, uint32_t metalness) {
    for (uint32_t i = 0; i < octree->node_count; ++i)
        octree->payloads[i].surface =
            (octree->payloads[i].surface & 0xfffffu) | roughness << 20 | metalness << 26;
}

/* Strips of mirror and chalk by turns, finer than voxels, lit from the side: light of triangles, of voxels
 * with mean finish, and of voxels that keep the chalk or the mirror only. */
static void mixed_finishes_keep_their_light(void **state) {
    (void)state;
    gw_mesh mesh = {0};
    add_ballast(&mesh);
    gw_mesh_add_grid(&mesh, (const double[]){-0.9, -0.9, 0.013}, (const double[]){1.8, 0, 0},
                     (const double[]){0, 1.8, 0}, 300, 30);
    gw_stage stage;
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_material *materials = material_from_z(scene, INFINITY);
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        double x = 0.0;
        for (int k = 0; k < 3; ++k)
            x += (double)scene->positions[scene->triangles[t][k] * 3] / 3.0;
        scene->material_of[t] = (int)floor((ldexp(x, scene->exponent) + scene->centre[0] + 0.9) / 0.006) & 1;
    }
    materials[1].metalness = 1.0f;
    materials[1].roughness = 0.2f;
    set_grey(scene->ambient, 0.2f);
    void *light = NULL;
    check_ok(gw_allocate(&light, 1, sizeof *scene->lights, "light", &error));
    scene->lights = light;
    scene->lights[0] = (gw_light){.kind = GW_LIGHT_DIRECTIONAL, .vector = {0.6, 0, -0.8}, .color = {3, 3, 3}};
    scene->light_count = 1;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", NULL}, &error));
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.3, 0.2, 2}, (const double[]){0, 0, 0}, 40, SIDE);
    camera.state.tau_inside = 1.0f;
    double triangles = 0, mean = 0, plain = 0, chalk = 0, mirror = 0;
    light_of(&stage, &camera, &triangles, &mean);
    store_finish(stage.octree, 38, 32); /* both means by area alone */
    light_of(&stage, &camera, &triangles, &plain);
    store_finish(stage.octree, 63, 0);
    light_of(&stage, &camera, &triangles, &chalk);
    store_finish(stage.octree, 13, 63);
    light_of(&stage, &camera, &triangles, &mirror);
    print_message(
        "mirror and chalk: %.4f as triangles; voxels %.4f, of plain mean finish %.4f, of chalk %.4f, "
        "of mirror %.4f\n",
        triangles, mean, plain, chalk, mirror);
    gw_stage_close(&stage);
    assert_true(fabs(mean - triangles) < 0.1 * triangles);
    assert_true(fabs(plain - triangles) > 0.3 * triangles); /* the naive rules fail */
    assert_true(fabs(chalk - triangles) > 0.3 * triangles);
    assert_true(fabs(mirror - triangles) > 0.3 * triangles);
}

/* Share of the light of a white background that comes through: the scene's surfaces are black. */
static void darken(gw_scene *scene) {
    for (uint32_t m = 0; m < scene->material_count; ++m)
        set_grey(scene->materials[m].base_color, 0.0f);
    set_grey(scene->ambient, 0.0f);
    set_grey(scene->background, 1.0f);
}

/* Prints and returns the largest difference of the mean opacity, over accepted errors tau, from that of
 * triangles. */
static double coverage_error(gw_stage *stage, gw_camera *camera, const char *name, float largest_tau) {
    gw_renderer *renderer = gw_stage_renderer(stage);
    double exact = 0.0, most = 0.0;
    for (float tau = 0.0f; tau <= largest_tau; tau = tau > 0.0f ? 2.0f * tau : 1.0f) {
        camera->state.tau_inside = tau;
        uint8_t *rgba = gw_camera_take(camera, renderer, NULL);
        double opacity = 1.0 - gw_mean_linear(rgba, PIXELS);
        free(rgba);
        print_message("%s, tau %g: opacity %.4f\n", name, (double)tau, opacity);
        exact = tau > 0.0f ? exact : opacity;
        most = fmax(most, fabs(opacity - exact));
    }
    gw_renderer_destroy(&renderer);
    return most / exact;
}

/* A finely cut wall, oblique to the cells, larger than the picture. */
static gw_scene *oblique_wall(void) {
    gw_mesh mesh = {0};
    add_ballast(&mesh);
    gw_mesh_add_grid(&mesh, (const double[]){-0.9, -1, -0.3}, (const double[]){1.8, 0, 0.6},
                     (const double[]){0, 2, 0.2}, 96, 96);
    return gw_mesh_take(&mesh);
}

static void look_at_wall(gw_camera *camera, const gw_stage *stage) {
    gw_camera_look(camera, stage, (const double[]){0.4, 0.3, 3}, (const double[]){0, 0, 0}, 20, SIDE);
}

/* Glass of opacity 0.3. */
static void blended_surfaces_keep_their_opacity(void **state) {
    (void)state;
    gw_stage stage;
    gw_scene *scene = oblique_wall();
    darken(scene);
    scene->materials[0].alpha_mode = GW_ALPHA_BLEND;
    scene->materials[0].base_color[3] = 0.3f;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=9", NULL}, &error));
    gw_camera camera;
    look_at_wall(&camera, &stage);
    assert_true(coverage_error(&stage, &camera, "glass", 16.0f) < 0.05);
    gw_stage_close(&stage);
}

/* Discs cut out by a texture's alpha: half of the wall. With the texture left out of the voxels (its side 1:
 * one mean texel would do; cut before it is averaged, or the mean passes or fails the cut-off as a whole). */
static void masked_surfaces_keep_their_opacity(void **state) {
    (void)state;
    enum { TEXELS = 64 };
    gw_stage stage;
    gw_scene *scene = oblique_wall();
    void *memory = NULL;
    check_ok(gw_allocate(&memory, 1, sizeof *scene->textures, "texture", &error));
    scene->textures = memory;
    scene->texture_count = 1;
    check_ok(gw_image_create(TEXELS, TEXELS, &scene->textures[0].image, &error));
    for (int y = 0; y < TEXELS; ++y)
        for (int x = 0; x < TEXELS; ++x) {
            double dx = (x + 0.5) / TEXELS - 0.5, dy = (y + 0.5) / TEXELS - 0.5;
            scene->textures[0].image.rgba[(y * TEXELS + x) * 4 + 3] = dx * dx + dy * dy < 0.16 ? 255 : 0;
        }
    for (uint32_t v = 0; v < scene->vertex_count; ++v)
        for (int k = 0; k < 2; ++k)
            scene->texcoords[v * 2 + (uint32_t)k] = 5.0f * scene->positions[v * 3 + (uint32_t)k];
    darken(scene);
    scene->materials[0].alpha_mode = GW_ALPHA_MASK;
    scene->materials[0].alpha_cutoff = 0.5f;
    scene->materials[0].base_color_texture = 0;
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=9", NULL}, &error));
    gw_camera camera;
    look_at_wall(&camera, &stage);
    assert_true(coverage_error(&stage, &camera, "discs", 16.0f) < 0.05);
    gw_stage_close(&stage);
}

/* A cloud of small leaves, each with two sides as modellers make them: what they hide of each other is
 * chance, and their backs hide nothing. Where all that follows in adjacent cells adds up as one surface does,
 * it closes. */
static double error_of_leaves(const char *separation) {
    gw_mesh mesh = {0};
    uint64_t random = 11;
    for (int i = 0; i < 6000; ++i) {
        double at[3], u[3], v[3];
        for (int k = 0; k < 3; ++k) {
            at[k] = 2.0 * gw_test_random(&random) - 1.0;
            u[k] = 0.09 * (gw_test_random(&random) - 0.5);
            v[k] = 0.09 * (gw_test_random(&random) - 0.5);
        }
        gw_mesh_add_grid(&mesh, at, u, v, 1, 1);
        at[2] += 1e-4;
        gw_mesh_add_grid(&mesh, at, v, u, 1, 1);
    }
    gw_stage stage;
    gw_scene *scene = gw_mesh_take(&mesh);
    darken(scene);
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", separation, NULL},
                           &error));
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.4, 0.3, 5}, (const double[]){0, 0, 0}, 20, SIDE);
    double most = coverage_error(&stage, &camera, separation, 8.0f);
    gw_stage_close(&stage);
    return most;
}

static void leaves_hide_each_other_by_chance(void **state) {
    (void)state;
    double known = error_of_leaves("separation=0.1"), naive = error_of_leaves("separation=1");
    assert_true(known < 0.2);
    assert_true(naive > 2.0 * known); /* the naive rule fails */
}

/* What the area codes of an octree would be with 8 bits, in equal steps. */
static void store_areas_in_bytes(gw_octree *octree) {
    for (uint32_t i = 0; i < octree->node_count; ++i) {
        double root = GW_PAYLOAD_AREA_CODE(octree->payloads[i].surface) / 4095.0;
        double stored = round(root * root * 255.0) / 255.0;
        octree->payloads[i].surface =
            (octree->payloads[i].surface & ~0xfffu) | (uint32_t)(sqrt(stored) * 4095.0 + 0.5);
    }
}

enum { VARIANT_PLAIN, VARIANT_SEED, VARIANT_BYTES };

/* Glowing flat wires, `share` of a finest voxel wide, 5 voxels apart, aslant in a plane that faces the
 * viewer: the light that reaches the picture over the light sent out, least and most over all accepted
 * errors. */
static void light_of_wires(double share, int variant, double range[2]) {
    const double voxel = 2.0 / 256, width = share * voxel, gap = 5 * voxel, radiance = 1.0 / share;
    const double c = cos(0.4), s = sin(0.4);
    gw_mesh mesh = {0};
    add_ballast(&mesh);
    for (int i = -20; i <= 20; ++i)
        gw_mesh_add_grid(&mesh, (const double[]){-0.9 * c - i * gap * s, -0.9 * s + i * gap * c, 0.013},
                         (const double[]){1.8 * c, 1.8 * s, 0}, (const double[]){-width * s, width * c, 0},
                         40, 1);
    gw_stage stage;
    gw_scene *scene = gw_mesh_take(&mesh);
    set_grey(scene->ambient, 0.0f);
    set_grey(scene->materials[0].emissive, (float)radiance);
    check_ok(gw_stage_open(
        &stage, scene, NULL,
        (const char *const[]){"octree_depth=8", "least_remainder=0.0001",
                              variant == VARIANT_SEED ? "payload_rule=seed" : "payload_rule=area", NULL},
        &error));
    if (variant == VARIANT_BYTES)
        store_areas_in_bytes(stage.octree);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.1, 0.1, 3.013}, (const double[]){0.1, 0.1, 0}, 10,
                   SIDE);
    range[0] = INFINITY;
    range[1] = 0.0;
    /* Below 4 some leaves are still triangles, and their hits brighter than white. */
    for (float tau = 4.0f; tau <= 64.0f; tau *= 2.0f) {
        camera.state.tau_inside = tau;
        uint8_t *rgba = gw_camera_take(&camera, renderer, NULL);
        double light = gw_mean_linear(rgba, PIXELS) * (gap / width) / radiance;
        free(rgba);
        range[0] = fmin(range[0], light);
        range[1] = fmax(range[1], light);
    }
    print_message("wires of %g voxels, variant %d: %.3f to %.3f of their light\n", share, variant, range[0],
                  range[1]);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

static void thin_wires_keep_their_light(void **state) {
    (void)state;
    double range[2];
    for (double share = 0.1; share > 0.0005; share *= 0.1) {
        light_of_wires(share, VARIANT_PLAIN, range);
        assert_true(range[0] > 0.9 && range[1] < 1.1);
    }
    /* The naive variants fail: solid voxels thicken, bytes round to nothing. */
    light_of_wires(0.1, VARIANT_SEED, range);
    assert_true(range[1] > 2.0);
    light_of_wires(0.001, VARIANT_BYTES, range);
    assert_true(range[0] < 0.5);
}

static void add_box(gw_mesh *mesh, const double low[3], const double high[3]) {
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            double corner[3], u[3] = {0}, v[3] = {0};
            int a = (axis + 1) % 3, b = (axis + 2) % 3;
            memcpy(corner, low, sizeof corner);
            corner[axis] = side ? high[axis] : low[axis];
            u[side ? a : b] = high[side ? a : b] - low[side ? a : b];
            v[side ? b : a] = high[side ? b : a] - low[side ? b : a];
            gw_mesh_add_grid(mesh, corner, u, v, 60, 60);
        }
}

/* Black plates a tenth of a finest voxel thick, seen edge-on from afar. */
static void plates_seen_edge_on_stay(void **state) {
    (void)state;
    const double voxel = 2.0 / 256;
    gw_mesh mesh = {0};
    add_ballast(&mesh);
    for (int i = -6; i <= 6; ++i)
        add_box(&mesh, (const double[]){(5.3 * i) * voxel, -0.9, -0.21},
                (const double[]){(5.3 * i + 0.1) * voxel, 0.8, 0.29});
    gw_stage stage;
    gw_scene *scene = gw_mesh_take(&mesh);
    darken(scene);
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", NULL}, &error));
    gw_renderer *renderer = gw_stage_renderer(&stage);
    gw_camera camera;
    gw_camera_look(&camera, &stage, (const double[]){0.003, 0.1, 40}, (const double[]){0.003, 0.1, 0}, 0.6,
                   16 * SIDE);
    uint8_t *exact = gw_camera_take(&camera, renderer, NULL);
    double opacity = 1.0 - gw_mean_linear(exact, (size_t)256 * PIXELS);
    free(exact);
    gw_camera_look(&camera, &stage, (const double[]){0.003, 0.1, 40}, (const double[]){0.003, 0.1, 0}, 0.6,
                   SIDE);
    double least = INFINITY, most = 0.0, naive_most = 0.0;
    for (float tau = 1.0f; tau <= 32.0f; tau *= 2.0f)
        for (int naive = 0; naive < 2; ++naive) {
            camera.state.tau_inside = tau;
            camera.state.fold_agreement = naive ? 0.99f : 0.6f;
            uint8_t *rgba = gw_camera_take(&camera, renderer, NULL);
            double seen = (1.0 - gw_mean_linear(rgba, PIXELS)) / opacity;
            free(rgba);
            print_message("plates edge-on, tau %g, %s: %.3f of their opacity\n", (double)tau,
                          naive ? "as folds" : "as plates", seen);
            least = naive ? least : fmin(least, seen);
            most = naive ? most : fmax(most, seen);
            naive_most = naive ? fmax(naive_most, seen) : naive_most;
        }
    assert_true(least > 0.7 && most < 2.8);
    assert_true(naive_most > 3.0); /* their rims thicken, as a fold would */
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_count_by_area),
        cmocka_unit_test(normals_do_not_turn_aside),
        cmocka_unit_test(thin_wires_keep_their_light),
        cmocka_unit_test(plates_seen_edge_on_stay),
        cmocka_unit_test(mixed_finishes_keep_their_light),
        cmocka_unit_test(sheets_apart_are_flagged),
        cmocka_unit_test(a_floor_does_not_shine_through_its_carpet),
        cmocka_unit_test(blended_surfaces_keep_their_opacity),
        cmocka_unit_test(masked_surfaces_keep_their_opacity),
        cmocka_unit_test(leaves_hide_each_other_by_chance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
