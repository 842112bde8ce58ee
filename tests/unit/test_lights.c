/* Lights from files: every kind of a YAML scene and what each mistake says, and the lights of glTF files,
 * which several nodes may share. Models come from tests/data through the real import child. */
#include "tests/support/check.h"

#include "base/file.h"
#include "build/import.h"

#include <limits.h>
#include <math.h>
#include <unistd.h>

static gw_code load_file(const char *name, const char *text, gw_scene **out, gw_error *error) {
    char path[512];
    const char *program = getenv("GAZEWALL");
    const gw_import_options options = {.program = program ? program : "out/release/gazewall"};
    gw_code code = gw_file_write(scratch_path(path, name), text, strlen(text), error);
    if (code == GW_OK)
        code = gw_import(path, &options, out, error);
    remove(path);
    return code;
}

static gw_code load_lights(const char *lights, gw_scene **out, gw_error *error) {
    char folder[PATH_MAX], text[PATH_MAX + 1024];
    assert_non_null(getcwd(folder, sizeof folder));
    snprintf(text, sizeof text, "version: 1\nmodels:\n  - file: %s/tests/data/tetra.off\nlights:\n%s", folder,
             lights);
    return load_file("lights.yaml", text, out, error);
}

static int near(double a, double b) {
    return fabs(a - b) < 1e-5;
}

static void every_kind_is_read(void **state) {
    (void)state;
    gw_scene *scene = NULL;
    check_ok(load_lights("  - {directional: [0, -2, 0], angle: 0.53, intensity: 3}\n"
                         "  - {point: [1, 2, 3], radius: 0.25, range: 7, color: [1, 0.5, 0], intensity: 4}\n"
                         "  - {spot: [0, 3, 0], direction: [0, -5, 0], cone: [20, 30], range: 9}\n"
                         "  - {rectangle: [0, 2, 0], width: [0, 0, 2], height: [0.5, 0, 0], intensity: 2}\n",
                         &scene, &error));
    assert_int_equal(scene->light_count, 4);
    const gw_light *l = scene->lights;
    assert_true(l[0].kind == GW_LIGHT_DIRECTIONAL && l[0].vector[1] == -1.0);
    assert_true(near((double)l[0].extent, 0.265 * 3.14159265 / 180.0));
    assert_true(l[1].kind == GW_LIGHT_POINT && near((double)l[1].extent, 0.25) &&
                near((double)l[1].range, 7));
    assert_true(near((double)l[1].color[1], 2.0));
    assert_true(l[2].kind == GW_LIGHT_SPOT && near((double)l[2].axis[1], -1.0));
    assert_true(near((double)l[2].cone[0], 0.34906585) && near((double)l[2].cone[1], 0.52359878));
    assert_true(l[3].kind == GW_LIGHT_RECTANGLE && near(gw_light_area(&l[3]), 1.0));
    const gw_hash before = scene->hash;
    scene->lights[2].cone[0] = 0.1f; /* reaches pixels, so it must reach the hash */
    gw_scene_rehash(scene);
    assert_false(gw_hash_equal(before, scene->hash));
    gw_scene_destroy(&scene);
}

static void mistakes_are_named(void **state) {
    (void)state;
    static const char *const rows[][2] = {
        {"  - {intensity: 1}\n", "needs one of 'directional', 'point', 'spot' and 'rectangle'"},
        {"  - {point: [0, 0, 0], spot: [0, 0, 0]}\n", "either 'point' or 'spot'"},
        {"  - {point: [0, 0, 0], cone: [1, 2]}\n", "key 'cone': a light that is 'point' has none"},
        {"  - {spot: [0, 0, 0]}\n", "key 'direction' is missing"},
        {"  - {spot: [0, 0, 0], direction: [0, 0, 0]}\n", "has no length"},
        {"  - {spot: [0, 0, 0], direction: [0, 1, 0], cone: [30, 30]}\n", "0 <= inner < outer <= 90"},
        {"  - {rectangle: [0, 0, 0], width: [1, 0, 0], height: [2, 0, 0]}\n", "has no area"},
        {"  - {directional: [0, -1, 0], angle: 120}\n", "key 'angle'"},
        {"  - {point: [0, 0, 0], radius: -1}\n", "key 'radius'"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        gw_scene *scene = NULL;
        check_fails(load_lights(rows[i][0], &scene, &error), GW_BAD_INPUT, rows[i][1]);
    }
}

/* Two nodes of one name share a spot light; the second is turned and moved. */
static void nodes_share_a_light(void **state) {
    (void)state;
    static const char text[] =
        "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_lights_punctual\"],"
        "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\",\"intensity\":5,\"range\":"
        "12,"
        "\"spot\":{\"innerConeAngle\":0.25,\"outerConeAngle\":0.5}}]}},"
        "\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2]}],\"nodes\":[{\"mesh\":0},"
        "{\"name\":\"lamp\",\"translation\":[1,2,3],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
        "{\"name\":\"lamp\",\"translation\":[-1,0,0],\"rotation\":[-0.70710678,0,0,0.70710678],"
        "\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
        "\"min\":[0,0,0],\"max\":[1,1,0]}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";
    gw_scene *scene = NULL;
    check_ok(load_file("shared.gltf", text, &scene, &error));
    assert_int_equal(scene->light_count, 2);
    for (uint32_t i = 0; i < 2; i++) {
        const gw_light *light = &scene->lights[i];
        assert_int_equal(light->kind, GW_LIGHT_SPOT);
        assert_true(near((double)light->cone[0], 0.25) && near((double)light->cone[1], 0.5));
        assert_true(near((double)light->range, 12) && near((double)light->color[0], 5));
    }
    assert_true(near(scene->lights[0].vector[0], 1) && near((double)scene->lights[0].axis[2], -1));
    assert_true(near(scene->lights[1].vector[0], -1) && near((double)scene->lights[1].axis[1], -1));
    for (size_t i = 0; i < scene->note_count; i++)
        assert_null(strstr(scene->notes[i], "light that another node"));
    gw_scene_destroy(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_is_read),
        cmocka_unit_test(mistakes_are_named),
        cmocka_unit_test(nodes_share_a_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
