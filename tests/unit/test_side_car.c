/* Side-cars of pictures: everything comes back, bit for bit; another scene, another version and broken files
 * are told; hostile ones never crash. */
#include "tests/support/check.h"

#include "base/file.h"
#include "tests/fuzz/side_car_entry.h"
#include "tests/support/meshes.h"
#include "wall/frames.h"

#include <unistd.h>

static gw_site site;
static gw_settings settings;
static gw_frame_state state;
static const int missing[GW_MAXIMUM_TILES] = {0, 1};

static const char *write_one(char path[512], const char *scene_hash) {
    gw_grid grid = {.columns = 2,
                    .rows = 2,
                    .widths = {50, 31},
                    .heights = {20, 30},
                    .pitch = {1.0 / 3, 0.7},
                    .left = 1.1,
                    .eye = {0.1, 2, 1800.000001}};
    gw_site_defaults(&site);
    check_ok(gw_layout_grid(&grid, &site.layout, &error));
    site.panels[2].stereo = GW_STEREO_ANAGLYPH;
    gw_settings_init(&settings);
    settings.tau = 1.0 / 3;
    settings.octree_depth = 7;
    gw_frame_begin(&state, 9, &settings, 77, GW_DEBUG_LEVELS);
    gw_frame_stare(&state, grid.eye, (const double[3]){1, 2, 0}, &settings);
    gw_frame_part_eyes(&state, NULL, 63.7);
    state.accumulate = 1;
    const gw_side_car_picture picture = {.site = &site,
                                         .settings = &settings,
                                         .state = &state,
                                         .force_effects = 4,
                                         .forbid_effects = 2,
                                         .scene = "/proc/self/exe",
                                         .animation = "walk",
                                         .scene_hash = scene_hash,
                                         .image = gw_hash_bytes((gw_hash){0}, "x", 1),
                                         .missing = missing};
    check_ok(gw_side_car_write(scratch_path(path, "picture.json"), &picture, &error));
    return path;
}

static void everything_comes_back(void **unused) {
    (void)unused;
    static gw_side_car back;
    char path[512], hash[33];
    check_ok(gw_side_car_read(write_one(path, "0123456789abcdef0123456789abcdef"), &back, &error));
    assert_memory_equal(&back.site.layout, &site.layout, sizeof site.layout);
    assert_int_equal(back.site.panels[2].stereo, GW_STEREO_ANAGLYPH);
    assert_memory_equal(&back.settings, &settings, sizeof settings);
    assert_memory_equal(&back.state, &state, sizeof state);
    assert_int_equal(back.force_effects, 4);
    assert_int_equal(back.forbid_effects, 2);
    assert_int_equal(back.scene[0], '/');
    assert_null(strstr(back.scene, "self")); /* an absolute path, resolved */
    assert_string_equal(back.animation, "walk");
    assert_string_equal(back.scene_hash, "0123456789abcdef0123456789abcdef");
    gw_hash_text(gw_hash_bytes((gw_hash){0}, "x", 1), hash);
    assert_string_equal(back.image_hash, hash);
    gw_side_car_finish(&back);
    unlink(path);
}

static void another_scene_is_told(void **unused) {
    (void)unused;
    static gw_side_car back;
    gw_mesh mesh = {0};
    gw_mesh_add_tetrahedron(&mesh, (const double[3]){0, 0, 0}, 1);
    gw_scene *scene = gw_mesh_take(&mesh);
    char path[512], hash[33];
    gw_hash_text(scene->hash, hash);
    check_ok(gw_side_car_read(write_one(path, hash), &back, &error));
    check_ok(gw_side_car_check_scene(&back, scene, &error));
    back.scene_hash[5] = back.scene_hash[5] == 'a' ? 'b' : 'a';
    check_fails(gw_side_car_check_scene(&back, scene, &error), GW_BAD_INPUT,
                "is not the one that the picture was made from");
    gw_side_car_finish(&back);
    gw_scene_destroy(&scene);
    unlink(path);
}

/* Replaces the first `from` of the good file by `to`. */
static gw_code read_changed(const char *from, const char *to, gw_error *error) {
    static gw_side_car back;
    char path[512];
    gw_bytes bytes;
    write_one(path, NULL);
    assert_int_equal(gw_file_read(path, 1 << 20, &bytes, error), GW_OK);
    const char *text = (const char *)bytes.data, *at = strstr(text, from);
    assert_non_null(at);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    fclose(file);
    gw_bytes_finish(&bytes);
    gw_code code = gw_side_car_read(path, &back, error);
    gw_side_car_finish(&back);
    unlink(path);
    return code;
}

static void broken_files_are_told(void **unused) {
    (void)unused;
    static const struct {
        const char *from, *to, *part;
    } cases[] = {
        {"\"gazewall_picture\": 1", "\"gazewall_picture\": 2", "is no side-car of a picture"},
        {"\"name\": \"c0r0\"", "\"name\": \"../c0r0\"", "'name' is missing or not 1 to 31 letters"},
        {"\"name\": \"c1r0\"", "\"name\": \"c0r0\"", "each once"},
        {"\"rectangle\": [\n     0,\n     0,\n     50", "\"rectangle\": [0, 0, 82",
         "inside the wall's pictures"},
        {"\"octree_depth\": \"7\"", "\"octree_depth\": \"99\"", "octree_depth"},
        {"\"octree_depth\"", "\"octree_deep\"", "made by another version"},
        {"\"tau\": 0.3333", "\"tau\": \"x\", \"t\": 0.3333", "'tau' is missing or not a number"},
        {"\"stereo\": \"anaglyph\"", "\"stereo\": \"4d\"", "'stereo' is missing"},
        {"\"forced\": 4", "\"forced\": 6", "none in both"},
        {"\"pattern\": \"none\"", "\"pattern\": 7", "'pattern' is missing"},
        {"{", "[", "not a JSON object"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_fails(read_changed(cases[i].from, cases[i].to, &error), GW_BAD_INPUT, cases[i].part);
}

/* The fuzzer's entry on mutations of a good file. */
static void hostile_bytes_never_crash(void **unused) {
    (void)unused;
    char path[512];
    gw_bytes bytes;
    check_ok(gw_file_read(write_one(path, NULL), 1 << 20, &bytes, &error));
    uint64_t random = 5;
    uint8_t *copy = malloc(bytes.size);
    for (int round = 0; round < 300; round++) {
        memcpy(copy, bytes.data, bytes.size);
        for (int change = 0; change < 3; change++)
            copy[(size_t)(gw_test_random(&random) * (double)bytes.size)] =
                (uint8_t) "0123456789-e.,[]{}\"n"[(size_t)(gw_test_random(&random) * 20)];
        fuzz_side_car(copy, round % 3 ? bytes.size : (size_t)(gw_test_random(&random) * (double)bytes.size),
                      path);
    }
    free(copy);
    gw_bytes_finish(&bytes);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_comes_back),
        cmocka_unit_test(another_scene_is_told),
        cmocka_unit_test(broken_files_are_told),
        cmocka_unit_test(hostile_bytes_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
