/* YAML scenes: what the keys do, and what each mistake says. Models come from tests/data through the real
 * import child. */
#include "tests/support/check.h"

#include "build/import.h"

#include <limits.h>
#include <math.h>
#include <unistd.h>

static gw_code load(const char *text, gw_scene **out, gw_error *error) {
    char path[512], folder[PATH_MAX];
    const char *program = getenv("GAZEWALL");
    const gw_import_options options = {.program = program ? program : "out/release/gazewall"};
    FILE *file = fopen(scratch_path(path, "scene.yaml"), "w");
    assert_non_null(file);
    assert_non_null(getcwd(folder, sizeof folder));
    for (; *text; text++) /* DATA stands for the folder of the test models */
        if (strncmp(text, "DATA", 4) == 0) {
            fprintf(file, "%s/tests/data", folder);
            text += 3;
        } else {
            fputc(*text, file);
        }
    fclose(file);
    gw_code code = gw_import(path, &options, out, error);
    remove(path);
    return code;
}

static gw_scene *load_good(const char *text) {
    gw_scene *scene = NULL;
    check_ok(load(text, &scene, &error));
    return scene;
}

static int near(double a, double b) {
    return fabs(a - b) < 1e-5;
}

static int has_note(const gw_scene *scene, const char *part) {
    for (size_t i = 0; i < scene->note_count; i++)
        if (strstr(scene->notes[i], part))
            return 1;
    return 0;
}

static void a_bare_scene_has_defaults(void **state) {
    (void)state;
    gw_scene *scene = load_good("version: 1\nmodels:\n  - file: DATA/tetra.off\n");
    assert_int_equal(scene->triangle_count, 4);
    assert_int_equal(scene->light_count, 1);
    assert_int_equal(scene->viewpoint_count, 1);
    assert_int_equal(scene->placement.kind, GW_PLACE_FIT_BEHIND_WALL);
    assert_true(has_note(scene, "no light") && has_note(scene, "metres and y up"));
    gw_scene_destroy(&scene);
}

static void units_and_axes_turn_models(void **state) {
    (void)state;
    gw_scene *scene = load_good("version: 1\nmodels:\n  - {file: DATA/tetra.off, unit: cm, up: z, scale: 2, "
                                "rotate: [0, 90, 0], translate: [1, 2, 3]}\n");
    /* The edge along z becomes y; x becomes -z after the turn about y; z = -y before it becomes -x. */
    assert_true(near(scene->bounds[0][0], 1.0 - 0.02) && near(scene->bounds[1][0], 1.0));
    assert_true(near(scene->bounds[0][1], 2.0) && near(scene->bounds[1][1], 2.02));
    assert_true(near(scene->bounds[0][2], 3.0 - 0.02) && near(scene->bounds[1][2], 3.0));
    assert_false(has_note(scene, "metres and y up"));
    gw_scene_destroy(&scene);
    scene = load_good(
        "version: 1\nmodels:\n  - {file: DATA/tetra.off, unit: 0.5, matrix: [1,0,0,0, 0,1,0,0, 0,0,-3,0]}\n");
    assert_true(near(scene->bounds[0][2], -1.5) && near(scene->bounds[1][2], 0.0) &&
                near(scene->bounds[1][0], 0.5));
    gw_scene_destroy(&scene);
}

static void models_are_merged(void **state) {
    (void)state;
    gw_scene *scene = load_good(
        "version: 1\nmodels:\n  - file: DATA/tetra.ply\n  - {file: DATA/poster.glb, translate: [0, 0, 5]}\n"
        "  - {file: DATA/box.obj, translate: [9, 0, 0]}\n");
    assert_int_equal(scene->triangle_count, 4 + 4 + 12);
    assert_int_equal(scene->texture_count, 3);
    assert_true(scene->colors != NULL);
    assert_int_equal(scene->light_count, 3); /* the poster's */
    assert_true(near(scene->lights[1].vector[2], 8.0));
    assert_int_equal(scene->viewpoint_count, 1);
    assert_true(near(scene->viewpoints[0].eye[2], 10.0));
    int textured = 0;
    for (uint32_t t = 0; t < scene->triangle_count; t++) {
        const gw_material *material = &scene->materials[scene->material_of[t]];
        const double x =
            scalbn((double)scene->positions[scene->triangles[t][0] * 3], scene->exponent) + scene->centre[0];
        assert_int_equal(strcmp(material->name, "poster") == 0, material->alpha_cutoff == 0.25f);
        assert_int_equal(x > 8.5, strcmp(material->name, "wood") == 0 ||
                                      strcmp(material->name, "leaf") == 0 ||
                                      strcmp(material->name, "glass") == 0);
        textured += material->base_color_texture >= 0;
    }
    assert_int_equal(textured, 4 + 10);
    gw_scene_destroy(&scene);
}

static void views_lights_and_paths_are_read(void **state) {
    (void)state;
    gw_scene *scene = load_good(
        "version: 1\nmodels: [{file: DATA/poster.gltf}]\n"
        "placement: {viewpoint: true, scale: 0.5}\n"
        "lights:\n  - {directional: [0, -2, 0], color: [1, 0.5, 0], intensity: 4}\n  - {point: [1, 2, 3]}\n"
        "ambient: [0.1, 0.2, 0.3]\nbackground: [0, 0, 1]\n"
        "viewpoints:\n  - {name: hall, eye: [0, 1, 2], look_at: [0, 1, 0], fov: 30}\n"
        "paths:\n  - name: walk\n    keys:\n      - {time: 0, eye: [0, 0, 5], look_at: [0, 0, 0]}\n"
        "      - {time: 2.5, eye: [1, 0, 5], look_at: [0, 0, 0]}\n");
    assert_int_equal(scene->light_count, 2); /* the file's replace the model's */
    assert_true(scene->lights[0].vector[1] == -1.0 && scene->lights[0].color[1] == 2.0f);
    assert_true(scene->lights[1].kind == GW_LIGHT_POINT && scene->lights[1].color[0] == 1.0f);
    assert_true(scene->ambient[2] == 0.3f && scene->background[2] == 1.0f);
    assert_int_equal(scene->viewpoint_count, 2); /* the file's come first */
    assert_string_equal(scene->viewpoints[0].name, "hall");
    assert_true(scene->viewpoints[0].fov == 30.0 && scene->viewpoints[0].up[1] == 1.0);
    assert_string_equal(scene->viewpoints[1].name, "door");
    assert_int_equal(scene->path_count, 1);
    assert_int_equal(scene->paths[0].key_count, 2);
    assert_true(scene->paths[0].keys[1].time == 2.5 && scene->paths[0].keys[1].eye[0] == 1.0);
    assert_true(scene->placement.kind == GW_PLACE_VIEWPOINT && scene->placement.scale == 0.5);
    assert_false(has_note(scene, "no light") || has_note(scene, "no ambient") ||
                 has_note(scene, "no background"));
    gw_scene_destroy(&scene);
    scene = load_good("version: 1\nmodels: [{file: DATA/tetra.off}]\nlights: []\n"
                      "placement: {matrix: [0,0,1000,5, 0,1000,0,6, -1000,0,0,7]}\n");
    assert_int_equal(scene->light_count, 0); /* wanted dark */
    assert_true(scene->placement.kind == GW_PLACE_MATRIX && scene->placement.matrix[2][0] == -1000.0);
    gw_scene_destroy(&scene);
}

static void the_demo_can_be_part_of_a_scene(void **state) {
    (void)state;
    gw_scene *scene =
        load_good("version: 1\nmodels:\n  - file: demo\n  - {file: DATA/tetra.off, translate: [0, 1, 0]}\n");
    assert_true(scene->triangle_count > 200000);
    assert_true(scene->texture_count > 0 && scene->viewpoint_count > 0);
    assert_false(has_note(scene, "no ambient"));
    gw_scene_destroy(&scene);
}

static void mistakes_are_named(void **state) {
    (void)state;
#define MODEL "models: [{file: DATA/tetra.off}]\n"
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"models: [{file: demo}]\n", "'version' is missing"},
        {"version: 2\nmodels: [{file: demo}]\n", "version"},
        {"version: 1\n", "'models' is missing"},
        {"version: 1\nmodels: []\n", "the list is empty"},
        {"version: 1\nmodels: {file: demo}\n", "models"},
        {"version: 1\nmodles: []\n", "models"}, /* the nearest known key */
        {"version: 1\nmodels: [{fil: demo}]\n", "file"},
        {"version: 1\nmodels: [{up: y}]\n", "'file' is missing"},
        {"version: 1\nmodels: [{file: DATA/not_there.ply}]\n", "not_there.ply: the file cannot be opened"},
        {"version: 1\nmodels: [{file: other.yaml}]\n", "scenes cannot contain scenes"},
        {"version: 1\nmodels: [{file: DATA/tetra.off, unit: furlong}]\n", "'furlong' is not mm"},
        {"version: 1\nmodels: [{file: DATA/tetra.off, up: x}]\n", "neither y nor z"},
        {"version: 1\nmodels: [{file: DATA/tetra.off, scale: 0}]\n", "scale"},
        {"version: 1\nmodels: [{file: DATA/tetra.off, rotate: [0, 1]}]\n", "rotate"},
        {"version: 1\nmodels: [{file: DATA/tetra.off, matrix: [1,0,0,0, 0,1,0,0, 0,0,0,0]}]\n",
         "flattens the model"},
        {"version: 1\nmodels: [{file: DATA/tetra.off, scale: 1, matrix: [1,0,0,0, 0,1,0,0, 0,0,1,0]}]\n",
         "cannot stand beside"},
        {"version: 1\n" MODEL "lights: [{color: [1, 1, 1]}]\n", "needs one of 'directional', 'point'"},
        {"version: 1\n" MODEL "lights: [{directional: [0, 0, 0]}]\n", "has no length"},
        {"version: 1\n" MODEL "lights: [{point: [0, 0, 0], color: [-1, 0, 0]}]\n", "not in 0..1e9"},
        {"version: 1\n" MODEL "ambient: [1, 1]\n", "ambient"},
        {"version: 1\n" MODEL "placement: {fit: inside}\n", "'inside' is not known"},
        {"version: 1\n" MODEL "placement: {fit: behind-wall, viewpoint: true}\n", "exactly one of"},
        {"version: 1\n" MODEL "placement: {fit: behind-wall, scale: 2}\n", "belongs to 'viewpoint: true'"},
        {"version: 1\n" MODEL "placement: {matrix: [1,0,0,0, 0,2,0,0, 0,0,1,0]}\n", "one positive factor"},
        {"version: 1\n" MODEL "placement: {matrix: [1,0,0,0, 0,1,0,0, 0,0,-1,0]}\n", "without mirroring"},
        {"version: 1\n" MODEL "viewpoints: [{eye: [0, 0, 1]}]\n", "'look_at' is missing"},
        {"version: 1\n" MODEL "viewpoints: [{eye: [0, 0, 1], look_at: [0, 0, 1]}]\n", "the same point"},
        {"version: 1\n" MODEL "viewpoints: [{eye: [0, 1, 0], look_at: [0, 0, 0]}]\n",
         "points along the view"},
        {"version: 1\n" MODEL "viewpoints: [{eye: [0, 0, 1], look_at: [0, 0, 0], fov: 200}]\n", "fov"},
        {"version: 1\n" MODEL "paths: [{keys: [{time: 0, eye: [0, 0, 1], look_at: [0, 0, 0]}]}]\n",
         "at least two keys"},
        {"version: 1\n" MODEL "paths:\n  - keys:\n    - {time: 1, eye: [0, 0, 1], look_at: [0, 0, 0]}\n"
         "    - {time: 1, eye: [0, 0, 2], look_at: [0, 0, 0]}\n",
         "does not come after"},
    };
#undef MODEL
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        gw_scene *scene = NULL;
        check_fails(load(cases[i].text, &scene, &error), GW_BAD_INPUT, cases[i].part);
        gw_error sentence = {0};
        load(cases[i].text, &scene, &sentence);
        assert_non_null(strstr(sentence.text, "scene.yaml:")); /* file and line come first */
        assert_null(scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bare_scene_has_defaults),
        cmocka_unit_test(units_and_axes_turn_models),
        cmocka_unit_test(models_are_merged),
        cmocka_unit_test(views_lights_and_paths_are_read),
        cmocka_unit_test(the_demo_can_be_part_of_a_scene),
        cmocka_unit_test(mistakes_are_named),
    };
    return cmocka_run_group_tests_name("yaml_scene", tests, NULL, NULL);
}
