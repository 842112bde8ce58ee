/* Tangents of vertices: packed into a word, placed, and read from glTF files, friendly and hostile. */
#include "tests/support/check.h"

#include "base/file.h"
#include "build/import.h"
#include "build/scene.h"
#include "build/tangent.h"
#include "tests/support/meshes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degrees = 180.0 / 3.14159265358979;

static double angle_between(const double a[3], const double b[3]) {
    double dot = 0, aa = 0, bb = 0;
    for (int i = 0; i < 3; i++) {
        dot += a[i] * b[i];
        aa += a[i] * a[i];
        bb += b[i] * b[i];
    }
    return acos(fmin(dot / sqrt(aa * bb), 1.0)) * degrees;
}

static void a_word_holds_a_direction_and_a_side(void **state) {
    (void)state;
    uint64_t seed = 5;
    double worst = 0;
    for (int i = 0; i < 20000; i++) {
        double given[3], back[3];
        for (int k = 0; k < 3; k++) /* axes, too */
            given[k] = i < 27 ? (double)(i /
                                             (k == 0   ? 1
                                              : k == 1 ? 3
                                                       : 9) %
                                             3 -
                                         1)
                              : gw_test_random(&seed) - 0.5;
        if (i == 13)
            continue; /* no direction */
        const double side = i % 2 ? 1 : -0.25;
        assert_true(gw_tangent_unpack(gw_tangent_pack(given, side), back) == (i % 2 ? 1 : -1));
        worst = fmax(worst, angle_between(given, back));
    }
    print_message("a word is off by at most %.4f degrees\n", worst);
    assert_true(worst < 0.008);
}

static void what_is_no_tangent_is_none(void **state) {
    (void)state;
    static const double bad[][4] = {{0, 0, 0, 1},   {NAN, 0, 1, 1},        {1, INFINITY, 0, 1}, {1, 0, 0, 0},
                                    {1, 0, 0, NAN}, {0, -INFINITY, 0, -1}, {1e308, 1e308, 0, 1}};
    double none[3] = {7, 7, 7};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_int_equal(gw_tangent_pack(bad[i], bad[i][3]), 0);
    assert_int_equal(gw_tangent_unpack(0, none), 0);
    assert_true(none[0] == 7);
    for (uint32_t word = 0; word < 4096; word++) { /* whatever stands in a word is a unit direction */
        double any[3] = {0, 0, 0};
        if (gw_tangent_unpack(word * 1048583u, any))
            assert_true(fabs(any[0] * any[0] + any[1] * any[1] + any[2] * any[2] - 1) < 1e-9);
    }
}

/* --- files --- */

typedef struct file {
    float tangents[4][4]; /* of three vertices, and one that is too many */
    const char *accessor, *node, *normal, *more;
} file;

static const file usual = {.tangents = {{1, 0, 0, 1}, {0.6f, 0.8f, 0, -1}, {0, 1, 0, 1}},
                           .accessor = "\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"",
                           .node = "",
                           .normal = "\"NORMAL\":1,",
                           .more = ""};

/* A triangle in the plane of x and y with a normal map, as files beside the test's. */
static gw_scene *import(const file *f) {
    static const float rest[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 1, 1, 0, 0};
    static const char frame[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"mesh\":0%s}],%s"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,%s\"TEXCOORD_0\":2,\"TANGENT\":3},"
        "\"material\":0}]}],\"materials\":[{\"normalTexture\":{\"index\":0}}],"
        "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"tangents.png\"}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
        "\"min\":[0,0,0],\"max\":[1,1,0]},"
        "{\"bufferView\":0,\"byteOffset\":36,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":72,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"},"
        "{\"bufferView\":0,\"byteOffset\":96,%s}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":160}],"
        "\"buffers\":[{\"byteLength\":160,\"uri\":\"tangents.bin\"}]}";
    char text[4096], path[512];
    float numbers[40];
    gw_bytes picture = {0};
    gw_scene *scene = NULL;
    memcpy(numbers, rest, sizeof rest);
    memcpy(numbers + 24, f->tangents, sizeof f->tangents);
    check_ok(gw_file_read("tests/data/checker.png", 1 << 20, &picture, &error));
    check_ok(gw_file_write(scratch_path(path, "tangents.png"), picture.data, picture.size, &error));
    gw_bytes_finish(&picture);
    check_ok(gw_file_write(scratch_path(path, "tangents.bin"), numbers, sizeof numbers, &error));
    snprintf(text, sizeof text, frame, f->node, f->more, f->normal, f->accessor);
    check_ok(gw_file_write(scratch_path(path, "tangents.gltf"), text, strlen(text), &error));
    const char *program = getenv("GAZEWALL");
    const gw_import_options options = {.program = program ? program : "out/release/gazewall"};
    check_ok(gw_import(path, &options, &scene, &error));
    return scene;
}

static int has_note(const gw_scene *scene, const char *part) {
    for (size_t i = 0; i < scene->note_count; i++)
        if (strstr(scene->notes[i], part))
            return 1;
    return 0;
}

/* Of the vertex whose texture coordinates these are. */
static int tangent_at(const gw_scene *scene, float u, float v, double direction[3]) {
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        if (scene->texcoords[i * 2] == u && scene->texcoords[i * 2 + 1] == v)
            return gw_tangent_unpack(scene->tangents[i], direction);
    fail();
    return 0;
}

static void check_tangent(const gw_scene *scene, float u, float v, const double wanted[4]) {
    double direction[3] = {0, 0, 0};
    const int side = tangent_at(scene, u, v, direction);
    if (side != (int)wanted[3] || (side && angle_between(direction, wanted) > 0.008))
        fail_msg("(%g, %g): %g %g %g, side %d", (double)u, (double)v, direction[0], direction[1],
                 direction[2], side);
}

static void files_are_read(void **state) {
    (void)state;
    gw_scene *scene = import(&usual);
    check_tangent(scene, 0, 1, (const double[]){1, 0, 0, 1});
    check_tangent(scene, 1, 1, (const double[]){0.6, 0.8, 0, -1});
    check_tangent(scene, 0, 0, (const double[]){0, 1, 0, 1});
    assert_false(has_note(scene, "angents"));
    const gw_hash hash = scene->hash;
    gw_scene_destroy(&scene);
    file other = usual;
    other.tangents[2][3] = -1; /* reaches pixels, so it must reach the hash */
    scene = import(&other);
    assert_false(gw_hash_equal(hash, scene->hash));
    gw_scene_destroy(&scene);
}

/* A quarter turn about z; a mirror, which turns sides over: the bumps are mirrored with their surface. */
static void nodes_place_them(void **state) {
    (void)state;
    file f = usual;
    f.node = ",\"rotation\":[0,0,0.70710678,0.70710678],\"scale\":[2,2,2]";
    gw_scene *scene = import(&f);
    check_tangent(scene, 0, 1, (const double[]){0, 1, 0, 1});
    check_tangent(scene, 1, 1, (const double[]){-0.8, 0.6, 0, -1});
    gw_scene_destroy(&scene);
    f.node = ",\"scale\":[-1,1,1]";
    scene = import(&f);
    check_tangent(scene, 0, 1, (const double[]){-1, 0, 0, -1});
    check_tangent(scene, 1, 1, (const double[]){-0.6, 0.8, 0, 1});
    gw_scene_destroy(&scene);
}

static void bad_ones_are_told_and_left_out(void **state) {
    (void)state;
    static const float bad[][4] = {
        {0, 0, 0, 1}, {NAN, 0, 0, 1}, {1, INFINITY, 0, 1}, {1, 0, 0, 0}, {0, 0, 1, 1}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        file f = usual;
        memcpy(f.tangents[1], bad[i], sizeof bad[i]);
        gw_scene *scene = import(&f);
        check_tangent(scene, 0, 1, (const double[]){1, 0, 0, 1});
        check_tangent(scene, 1, 1, (const double[]){0, 0, 0, 0});
        assert_true(has_note(scene, "1 tangents were zero-length"));
        gw_scene_destroy(&scene);
    }
}

static void what_does_not_fit_is_told_and_left_out(void **state) {
    (void)state;
    static const char moves[] = "\"skins\":[{\"joints\":[0]}],", shape[] = "not a vec4 of floats";
    const struct {
        const char *accessor, *normal, *more, *note;
    } rows[] = {
        {"\"componentType\":5126,\"count\":2,\"type\":\"VEC4\"", usual.normal, "", shape},
        {"\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"", usual.normal, "", shape},
        {"\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"", usual.normal, "", shape},
        {"\"componentType\":5120,\"normalized\":true,\"count\":3,\"type\":\"VEC4\"", usual.normal, "", shape},
        {usual.accessor, "", "", shape},
        {usual.accessor, usual.normal, moves, "where something moves"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        file f = usual;
        f.accessor = rows[i].accessor;
        f.normal = rows[i].normal;
        f.more = rows[i].more;
        gw_scene *scene = import(&f);
        assert_null(scene->tangents);
        if (!has_note(scene, rows[i].note))
            fail_msg("row %zu: no note of '%s'", i, rows[i].note);
        gw_scene_destroy(&scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_word_holds_a_direction_and_a_side),
        cmocka_unit_test(what_is_no_tangent_is_none),
        cmocka_unit_test(files_are_read),
        cmocka_unit_test(nodes_place_them),
        cmocka_unit_test(bad_ones_are_told_and_left_out),
        cmocka_unit_test(what_does_not_fit_is_told_and_left_out),
    };
    return cmocka_run_group_tests_name("tangents", tests, NULL, NULL);
}
