/* gw_scene_finish: what is dropped and counted, and that nothing depends on the order in the file. */
#include "tests/support/check.h"

#include "build/exact.h"
#include "build/scene.h"
#include "tests/support/meshes.h"

#include <float.h>
#include <math.h>

/* A scene whose arrays are filled from plain lists; NULL normals and texcoords stay NULL. */
static gw_scene *make_scene(const uint32_t (*triangles)[3], uint32_t triangle_count, uint32_t vertex_count) {
    gw_scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    scene->vertex_count = vertex_count;
    scene->triangle_count = triangle_count;
    scene->triangles = malloc(triangle_count * sizeof *scene->triangles + 1);
    scene->material_of = calloc(triangle_count + 1, sizeof *scene->material_of);
    scene->materials = calloc(2, sizeof *scene->materials);
    assert_non_null(scene->triangles);
    assert_non_null(scene->material_of);
    assert_non_null(scene->materials);
    if (triangle_count)
        memcpy(scene->triangles, triangles, triangle_count * sizeof *scene->triangles);
    scene->material_count = 2;
    scene->materials[0].base_color_texture = scene->materials[1].base_color_texture = -1;
    scene->materials[1].roughness = 0.5f;
    return scene;
}

static const double corners[8][3] = {{0, 0, 0}, {1, 0, 0},   {0, 1, 0},        {1, 1, 0},
                                     {2, 0, 0}, {NAN, 0, 0}, {0, INFINITY, 0}, {0, 0, 0}};

static void counts_what_it_drops(void **state) {
    (void)state;
    static const uint32_t triangles[][3] = {
        {0, 1, 2}, {1, 3, 2},                     /* good */
        {0, 1, 5}, {6, 1, 2},          {5, 6, 5}, /* not finite */
        {0, 1, 8}, {0xffffffff, 1, 2},            /* out of range */
        {0, 0, 1}, {0, 7, 1},          {0, 1, 4}, /* repeated index, repeated position, collinear */
    };
    gw_scene *scene = make_scene(triangles, 10, 8);
    scene->material_of[1] = 1;
    check_ok(gw_scene_finish(scene, corners[0], &error));
    assert_int_equal(scene->triangle_count, 2);
    assert_int_equal(scene->vertex_count, 4);
    assert_int_equal(scene->welded_count, 4);
    assert_int_equal(scene->dropped.non_finite, 3);
    assert_int_equal(scene->dropped.bad_index, 2);
    assert_int_equal(scene->dropped.repeated_vertex, 2);
    assert_int_equal(scene->dropped.zero_area, 1);
    assert_int_equal(scene->dropped.collapsed, 0);
    gw_scene_destroy(&scene);
}

static void rejects_materials_out_of_range(void **state) {
    (void)state;
    static const uint32_t triangles[][3] = {{0, 1, 2}, {1, 3, 2}};
    gw_scene *scene = make_scene(triangles, 2, 8);
    scene->material_of[1] = 2;
    check_ok(gw_scene_finish(scene, corners[0], &error));
    assert_int_equal(scene->triangle_count, 1);
    assert_int_equal(scene->dropped.bad_index, 1);
    gw_scene_destroy(&scene);
    scene = make_scene(triangles, 2, 8);
    scene->materials[1].base_color_texture = 0;
    check_fails(gw_scene_finish(scene, corners[0], &error), GW_BAD_INPUT, "names texture 0");
    gw_scene_destroy(&scene);
    scene = make_scene(triangles, 2, 8);
    scene->materials[0].roughness = NAN;
    check_fails(gw_scene_finish(scene, corners[0], &error), GW_BAD_INPUT, "not a finite number");
    gw_scene_destroy(&scene);
}

static void fails_when_nothing_is_left(void **state) {
    (void)state;
    static const uint32_t triangles[][3] = {{0, 0, 1}, {0, 1, 4}};
    gw_scene *scene = make_scene(triangles, 2, 8);
    check_fails(gw_scene_finish(scene, corners[0], &error), GW_BAD_INPUT,
                "1 with a repeated vertex, 1 without area");
    gw_scene_destroy(&scene);
    scene = make_scene(triangles, 0, 0);
    check_fails(gw_scene_finish(scene, corners[0], &error), GW_BAD_INPUT, "no triangles at all");
    gw_scene_destroy(&scene);
}

static void collapses_what_float_cannot_hold(void **state) {
    (void)state;
    /* A sliver thinner than a float's step beside a triangle a metre wide. */
    static const double world[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-12, 1e-13, 0}, {2e-12, 0, 0}};
    static const uint32_t triangles[][3] = {{0, 1, 2}, {0, 3, 4}};
    gw_scene *scene = make_scene(triangles, 2, 5);
    check_ok(gw_scene_finish(scene, world[0], &error));
    assert_int_equal(scene->triangle_count, 1);
    assert_int_equal(scene->dropped.collapsed, 1);
    assert_int_equal(scene->dropped.zero_area, 0);
    gw_scene_destroy(&scene);
}

static void rebases_to_one_power_of_two(void **state) {
    (void)state;
    static const double sizes[] = {1e-30, 1e-5, 0.75, 1.0, 1.5, 2.0, 3.0, 1e5, 1e30, 1e200, 1e-200};
    static const uint32_t triangles[][3] = {{0, 1, 2}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const double s = sizes[i];
        const double world[][3] = {{0, 0, 0}, {s, 0, 0}, {0, s / 2, s / 4}};
        gw_scene *scene = make_scene(triangles, 1, 3);
        check_ok(gw_scene_finish(scene, world[0], &error));
        const double side = scalbn(s, -scene->exponent);
        assert_true(side >= 1.0 && side < 2.0);
        assert_true(scene->centre[0] == s / 2 && scene->centre[1] == s / 4 && scene->centre[2] == s / 8);
        for (uint32_t v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++)
                assert_true(fabsf(scene->positions[v * 3 + (uint32_t)axis]) <= 1.0f);
        /* Back to metres: within one float step of the largest coordinate. */
        double error_seen = 0.0;
        for (uint32_t v = 0; v < 3; v++) {
            const double x = scalbn((double)scene->positions[v * 3], scene->exponent) + scene->centre[0];
            error_seen = fmax(error_seen, fmin(fabs(x), fabs(x - s)));
        }
        assert_true(error_seen <= s * 0x1p-23);
        gw_scene_destroy(&scene);
    }
}

static void refuses_absurd_sizes(void **state) {
    (void)state;
    static const uint32_t triangles[][3] = {{0, 1, 2}};
    static const double sizes[] = {1e300, 1e-300, 5e-324, DBL_MAX};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const double s = sizes[i];
        const double world[][3] = {{-s, 0, 0}, {s, 0, 0}, {0, s, 0}};
        gw_scene *scene = make_scene(triangles, 1, 3);
        check_fails(gw_scene_finish(scene, world[0], &error), GW_BAD_INPUT, "check its units");
        gw_scene_destroy(&scene);
    }
}

static void stays_in_the_cube_far_from_the_origin(void **state) {
    (void)state;
    /* Sides of a few steps of double at 2^52: the centre itself is rounded. */
    static const double far = 0x1p52;
    static const double world[][3] = {{far, far, 0}, {far + 1, far, 0}, {far, far + 3, 0}};
    static const uint32_t triangles[][3] = {{0, 1, 2}};
    gw_scene *scene = make_scene(triangles, 1, 3);
    check_ok(gw_scene_finish(scene, world[0], &error));
    for (uint32_t i = 0; i < 9; i++)
        assert_true(fabsf(scene->positions[i]) <= 1.0f);
    gw_scene_destroy(&scene);
}

static void welds_by_position_alone(void **state) {
    (void)state;
    /* Two triangles along the line x = y = 0 given with -0 and +0, and different texture coordinates. */
    static const double world[][3] = {{0.0, 0.0, -1},  {0.0, 0.0, 1},  {1, 0, 0},
                                      {-0.0, 0.0, -1}, {0.0, -0.0, 1}, {-1, 0, 0}};
    static const uint32_t triangles[][3] = {{0, 1, 2}, {4, 3, 5}};
    static const float texcoords[][2] = {{0, 0}, {0, 1}, {1, 0}, {0.5f, 0}, {-0.0f, 1}, {1, 1}};
    gw_scene *scene = make_scene(triangles, 2, 6);
    scene->texcoords = malloc(sizeof texcoords);
    assert_non_null(scene->texcoords);
    memcpy(scene->texcoords, texcoords, sizeof texcoords);
    check_ok(gw_scene_finish(scene, world[0], &error));
    assert_int_equal(scene->welded_count, 4);
    assert_int_equal(scene->vertex_count,
                     5); /* (0, 0, 1) is equal in everything, -0 included; (0, 0, -1) is not */
    for (uint32_t a = 0; a < scene->vertex_count; a++)
        for (uint32_t b = 0; b < scene->vertex_count; b++) {
            const int same = memcmp(scene->positions + a * 3, scene->positions + b * 3, 12) == 0;
            assert_int_equal(same, scene->welded[a] == scene->welded[b]);
        }
    for (uint32_t i = 0; i < scene->vertex_count * 3; i++)
        assert_false(scene->positions[i] == 0.0f && signbit(scene->positions[i]));
    gw_scene_destroy(&scene);
}

static void repairs_attributes_and_says_so(void **state) {
    (void)state;
    static const uint32_t triangles[][3] = {{0, 1, 2}};
    static const float normals[][3] = {{0, 0, 4}, {NAN, 0, 0}, {0, 0, 0}};
    static const float texcoords[][2] = {{INFINITY, 0}, {1, 0}, {0, 1}};
    gw_scene *scene = make_scene(triangles, 1, 3);
    scene->normals = malloc(sizeof normals);
    scene->texcoords = malloc(sizeof texcoords);
    assert_non_null(scene->normals);
    assert_non_null(scene->texcoords);
    memcpy(scene->normals, normals, sizeof normals);
    memcpy(scene->texcoords, texcoords, sizeof texcoords);
    check_ok(gw_scene_finish(scene, corners[0], &error));
    int unit = 0, zero = 0;
    for (uint32_t v = 0; v < 3; v++) {
        const float *n = scene->normals + v * 3;
        unit += n[0] == 0.0f && n[1] == 0.0f && n[2] == 1.0f;
        zero += n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f;
    }
    assert_int_equal(unit, 1);
    assert_int_equal(zero, 2);
    assert_int_equal(scene->note_count, 2);
    assert_non_null(strstr(scene->notes[0], "1 normals"));
    assert_non_null(strstr(scene->notes[1], "1 texture coordinates"));
    gw_scene_destroy(&scene);
}

/* --- independence of the file's order --- */

enum { GRID = 12, GRID_VERTICES = (GRID + 1) * (GRID + 1), GRID_TRIANGLES = GRID * GRID * 2, EXTRA = 40 };

typedef struct soup {
    double world[GRID_VERTICES][3];
    float normals[GRID_VERTICES][3], texcoords[GRID_VERTICES][2];
    uint8_t colors[GRID_VERTICES][4];
    uint32_t triangles[GRID_TRIANGLES + EXTRA][3], material_of[GRID_TRIANGLES + EXTRA];
} soup;

/* A wavy grid with every attribute, some triangles twice, some twice with another material, some turned over.
 */
static void make_soup(soup *out) {
    uint64_t random = 7;
    for (uint32_t v = 0; v < GRID_VERTICES; v++) {
        out->world[v][0] = (double)(v % (GRID + 1));
        out->world[v][1] = (double)(v / (GRID + 1));
        out->world[v][2] = gw_test_random(&random);
        for (int i = 0; i < 3; i++)
            out->normals[v][i] = (float)gw_test_random(&random) - 0.5f;
        for (int i = 0; i < 2; i++)
            out->texcoords[v][i] = (float)gw_test_random(&random);
        for (int i = 0; i < 4; i++)
            out->colors[v][i] = (uint8_t)(gw_test_random(&random) * 256.0);
    }
    for (uint32_t i = 0; i < GRID_TRIANGLES; i++) {
        const uint32_t cell = i / 2, v = cell / GRID * (GRID + 1) + cell % GRID;
        const uint32_t halves[2][3] = {{v, v + 1, v + GRID + 1}, {v + 1, v + GRID + 2, v + GRID + 1}};
        memcpy(out->triangles[i], halves[i % 2], sizeof *out->triangles);
        out->material_of[i] = i % 3 == 0;
    }
    for (uint32_t i = 0; i < EXTRA; i++) {
        uint32_t *copy = out->triangles[GRID_TRIANGLES + i];
        memcpy(copy, out->triangles[i * 5], sizeof *out->triangles);
        if (i % 4 == 3) {
            copy[0] = out->triangles[i * 5][1];
            copy[1] = out->triangles[i * 5][0];
        }
        out->material_of[GRID_TRIANGLES + i] =
            i % 4 == 1 ? 1 - out->material_of[i * 5] : out->material_of[i * 5];
    }
}

static uint32_t below(uint64_t *random, uint32_t count) {
    return (uint32_t)(gw_test_random(random) * count);
}

/* Shuffles triangles and vertices, rotates corners; turn 0 changes nothing. */
static gw_scene *finish_shuffled(const soup *from, uint64_t turn) {
    enum { COUNT = GRID_TRIANGLES + EXTRA };
    uint64_t random = turn * 977 + 1;
    uint32_t place[GRID_VERTICES], order[COUNT];
    static double world[GRID_VERTICES][3];
    gw_scene *scene = make_scene(from->triangles, COUNT, GRID_VERTICES);
    scene->normals = malloc(sizeof from->normals);
    scene->texcoords = malloc(sizeof from->texcoords);
    scene->colors = malloc(sizeof from->colors);
    assert_true(scene->normals && scene->texcoords && scene->colors);
    for (uint32_t i = 0; i < GRID_VERTICES; i++)
        place[i] = i;
    for (uint32_t i = 0; i < COUNT; i++)
        order[i] = i;
    for (uint32_t i = GRID_VERTICES; turn && i > 1; i--) {
        const uint32_t k = below(&random, i), swap = place[i - 1];
        place[i - 1] = place[k];
        place[k] = swap;
    }
    for (uint32_t i = COUNT; turn && i > 1; i--) {
        const uint32_t k = below(&random, i), swap = order[i - 1];
        order[i - 1] = order[k];
        order[k] = swap;
    }
    for (uint32_t v = 0; v < GRID_VERTICES; v++) {
        memcpy(world[place[v]], from->world[v], sizeof *world);
        memcpy(scene->normals + place[v] * 3, from->normals[v], sizeof *from->normals);
        memcpy(scene->texcoords + place[v] * 2, from->texcoords[v], sizeof *from->texcoords);
        memcpy(scene->colors + place[v] * 4, from->colors[v], sizeof *from->colors);
    }
    for (uint32_t i = 0; i < COUNT; i++) {
        const uint32_t first = turn ? below(&random, 3) : 0;
        for (uint32_t k = 0; k < 3; k++)
            scene->triangles[i][k] = place[from->triangles[order[i]][(first + k) % 3]];
        scene->material_of[i] = from->material_of[order[i]];
    }
    check_ok(gw_scene_finish(scene, world[0], &error));
    return scene;
}

static void check_same_bytes(const gw_scene *a, const gw_scene *b) {
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_int_equal(a->welded_count, b->welded_count);
    assert_memory_equal(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles);
    assert_memory_equal(a->material_of, b->material_of, a->triangle_count * sizeof *a->material_of);
    assert_memory_equal(a->positions, b->positions, a->vertex_count * 12);
    assert_memory_equal(a->normals, b->normals, a->vertex_count * 12);
    assert_memory_equal(a->texcoords, b->texcoords, a->vertex_count * 8);
    assert_memory_equal(a->colors, b->colors, a->vertex_count * 4);
    assert_memory_equal(a->welded, b->welded, a->vertex_count * 4);
    assert_true(gw_hash_equal(a->hash, b->hash));
}

static void does_not_depend_on_the_order_in_the_file(void **state) {
    (void)state;
    static soup from;
    make_soup(&from);
    gw_scene *reference = finish_shuffled(&from, 0);
    /* Of four copies one has another material and one is turned over; the other two are dropped. */
    assert_int_equal(reference->dropped.duplicate, EXTRA / 2);
    assert_int_equal(reference->triangle_count, GRID_TRIANGLES + EXTRA / 2);
    for (uint64_t turn = 1; turn <= 20; turn++) {
        gw_scene *scene = finish_shuffled(&from, turn);
        check_same_bytes(reference, scene);
        gw_scene_destroy(&scene);
    }
    gw_scene_destroy(&reference);
}

static void hash_sees_every_part(void **state) {
    (void)state;
    static soup from;
    make_soup(&from);
    gw_scene *reference = finish_shuffled(&from, 0);
    from.colors[5][1] ^= 1;
    gw_scene *changed = finish_shuffled(&from, 0);
    assert_false(gw_hash_equal(reference->hash, changed->hash));
    gw_scene_destroy(&changed);
    from.colors[5][1] ^= 1;
    from.texcoords[7][0] += 0.25f;
    changed = finish_shuffled(&from, 0);
    assert_false(gw_hash_equal(reference->hash, changed->hash));
    gw_scene_destroy(&changed);
    const gw_hash before = reference->hash;
    reference->ambient[1] = 0.5f;
    gw_scene_rehash(reference);
    assert_false(gw_hash_equal(reference->hash, before));
    reference->ambient[1] = 0.0f;
    snprintf(reference->materials[0].name, sizeof reference->materials[0].name, "renamed");
    gw_scene_rehash(reference);
    assert_true(gw_hash_equal(reference->hash, before)); /* names reach no pixel */
    gw_scene_destroy(&reference);
}

static void collinearity_is_exact(void **state) {
    (void)state;
    static const double a[3] = {0.1, 0.1, 0.1}, b[3] = {0.2, 0.2, 0.2}, c[3] = {0.4, 0.4, 0.4};
    assert_true(gw_collinear(a, b, c));
    double moved[3] = {c[0], c[1], nextafter(c[2], 1.0)}; /* one step of double off the line */
    assert_false(gw_collinear(a, b, moved));
    assert_true(gw_collinear(a, a, moved));
    /* The rounded cross product of these is zero, the true one is not. */
    const double p[3] = {0, 0, 0}, q[3] = {1 + 0x1p-52, 1, 0}, r[3] = {1, 1 - 0x1p-52, 0};
    assert_true(q[0] * r[1] - q[1] * r[0] == 0.0);
    assert_false(gw_collinear(p, q, r));
    const double big[3] = {1e300, 1e300, 0}, small[3] = {1e-300, 1e-300, 0}, off[3] = {1e300, -1e300, 0};
    assert_true(gw_collinear(p, big, small));
    assert_false(gw_collinear(p, big, off));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_what_it_drops),
        cmocka_unit_test(rejects_materials_out_of_range),
        cmocka_unit_test(fails_when_nothing_is_left),
        cmocka_unit_test(collapses_what_float_cannot_hold),
        cmocka_unit_test(rebases_to_one_power_of_two),
        cmocka_unit_test(refuses_absurd_sizes),
        cmocka_unit_test(stays_in_the_cube_far_from_the_origin),
        cmocka_unit_test(welds_by_position_alone),
        cmocka_unit_test(repairs_attributes_and_says_so),
        cmocka_unit_test(does_not_depend_on_the_order_in_the_file),
        cmocka_unit_test(hash_sees_every_part),
        cmocka_unit_test(collinearity_is_exact),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, NULL);
}
