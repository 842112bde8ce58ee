/* Octree files: what is stored comes back, and what is cut, altered or foreign is refused. */
#include "tests/support/check.h"

#include "base/file.h"
#include "build/octree_cache.h"
#include "tests/support/meshes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

static gw_gl *device;
static gw_scene *scene;
static gw_octree *octree;
static gw_settings settings;
static gw_hash key;

static int open_all(void **state) {
    gw_error error = {0};
    gw_gl_options options = {0};
    gw_mesh mesh = {0};
    const double centre[3] = {0, 0, 0};
    gw_octree_options build = {.settings = &settings};
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 4;
    settings.dense_leaf = 6; /* so that there are boxes */
    gw_mesh_add_sphere(&mesh, centre, 1, 0.1, 12, 6);
    if (gw_gl_create(&options, &device, &error) != GW_OK || gw_mesh_scene(&mesh, &scene, &error) != GW_OK ||
        gw_octree_build(device, scene, &build, &octree, &error) != GW_OK) {
        print_error("%s\n", error.text);
        return -1;
    }
    gw_mesh_finish(&mesh);
    key = gw_octree_cache_key(scene, &settings);
    return 0;
}

static int close_all(void **state) {
    (void)state;
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
    gw_gl_destroy(&device);
    return 0;
}

static char *fresh_folder(const char *name) {
    static char folder[512];
    char command[600];
    scratch_path(folder, name);
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    assert_int_equal(system(command), 0);
    return folder;
}

static void test_round_trip(void **state) {
    char *path = gw_octree_cache_path(fresh_folder("cache-round"), key);
    gw_octree *loaded = NULL;
    (void)state;
    check_ok(gw_octree_cache_store(path, key, octree, 0, &error));
    check_ok(gw_octree_cache_load(path, key, scene, &loaded, &error));
    assert_true(gw_hash_equal(loaded->hash, octree->hash));
    assert_int_equal(loaded->node_count, octree->node_count);
    assert_memory_equal(loaded->level_begin, octree->level_begin, sizeof octree->level_begin);
    assert_memory_equal(loaded->nodes, octree->nodes, gw_octree_node_bytes(octree));
    assert_memory_equal(loaded->payloads, octree->payloads, gw_octree_payload_bytes(octree));
    assert_memory_equal(loaded->references, octree->references, gw_octree_reference_bytes(octree));
    assert_true(octree->box_count > 0 && loaded->box_count == octree->box_count);
    assert_memory_equal(loaded->boxes, octree->boxes, gw_octree_box_bytes(octree));
    assert_int_equal(loaded->statistics.dense_leaves, octree->statistics.dense_leaves);
    assert_int_equal(loaded->statistics.leaves, octree->statistics.leaves);
    assert_int_equal(loaded->statistics.longest_list, octree->statistics.longest_list);
    gw_octree_destroy(&loaded);
    free(path);
}

/* Every BUILD setting and the scene are in the key; FRAME settings are not. */
static void test_key_tells_octrees_apart(void **state) {
    (void)state;
    for (size_t i = 0; i < gw_setting_count; ++i) {
        const gw_setting_row *row = &gw_setting_rows[i];
        gw_settings other = settings;
        char text[128];
        double value = gw_setting_value(&settings, row);
        snprintf(text, sizeof text, "%s=%g", row->name, value == row->maximum ? row->minimum : row->maximum);
        if (row->kind == GW_SETTING_CHOICE)
            continue; /* BUILD has none */
        check_ok(gw_settings_assign(&other, text, &error));
        assert_int_equal(gw_hash_equal(gw_octree_cache_key(scene, &other), key),
                         row->stage != GW_SETTING_BUILD);
    }
    gw_scene copy = *scene;
    copy.hash.low ^= 1;
    assert_false(gw_hash_equal(gw_octree_cache_key(&copy, &settings), key));
}

static void test_missing_file_is_refused(void **state) {
    gw_octree *loaded = NULL;
    (void)state;
    check_fails(gw_octree_cache_load("/nonexistent/octree", key, scene, &loaded, &error), GW_BAD_INPUT,
                "/nonexistent");
    assert_null(loaded);
}

/* Every byte flipped in turn, and every length: refused, never a crash. */
static void test_damage_is_refused(void **state) {
    char *path = gw_octree_cache_path(fresh_folder("cache-damage"), key);
    gw_bytes file = {0};
    gw_octree *loaded = NULL;
    (void)state;
    check_ok(gw_octree_cache_store(path, key, octree, 0, &error));
    check_ok(gw_file_read(path, 1 << 24, &file, &error));
    for (size_t i = 0; i < file.size; ++i) {
        file.data[i] ^= 0x40;
        check_ok(gw_file_write(path, file.data, file.size, &error));
        file.data[i] ^= 0x40;
        check_fails(gw_octree_cache_load(path, key, scene, &loaded, &error), GW_BAD_INPUT, "refused");
        assert_null(loaded);
    }
    for (size_t length = 0; length < file.size; length += length < 400 ? 1 : 37) {
        check_ok(gw_file_write(path, file.data, length, &error));
        check_fails(gw_octree_cache_load(path, key, scene, &loaded, &error), GW_BAD_INPUT, "refused");
    }
    gw_bytes_finish(&file);
    free(path);
}

/* A file whose checksum is right but whose contents lie: made by hand, byte after byte. */
static void test_lies_are_refused(void **state) {
    static const struct {
        size_t at;
        uint32_t value;
        const char *text;
    } lies[] = {
        {8, 2, "version"},
        {12, 9, "codec"},
        {16, 1, "another scene"},
        {32, 0x7fffffff, "more than its data"},
        {40, 5, "longer or shorter"},
    };
    char *path = gw_octree_cache_path(fresh_folder("cache-lies"), key);
    gw_bytes file = {0};
    gw_octree *loaded = NULL;
    (void)state;
    check_ok(gw_octree_cache_store(path, key, octree, 0, &error));
    check_ok(gw_file_read(path, 1 << 24, &file, &error));
    for (size_t i = 0; i < sizeof lies / sizeof *lies; ++i) {
        uint8_t keep[4];
        memcpy(keep, file.data + lies[i].at, 4);
        memcpy(file.data + lies[i].at, &lies[i].value, 4);
        gw_hash sum = gw_hash_bytes((gw_hash){0, 0}, file.data, file.size - 16);
        memcpy(file.data + file.size - 16, &sum.high, 8);
        memcpy(file.data + file.size - 8, &sum.low, 8);
        check_ok(gw_file_write(path, file.data, file.size, &error));
        check_fails(gw_octree_cache_load(path, key, scene, &loaded, &error), GW_BAD_INPUT, lies[i].text);
        memcpy(file.data + lies[i].at, keep, 4);
    }
    gw_bytes_finish(&file);
    free(path);
}

/* An octree whose links lie is refused although its hash and checksum are right. */
static void test_bad_links_are_refused(void **state) {
    char *path = gw_octree_cache_path(fresh_folder("cache-links"), key);
    gw_octree bad = *octree;
    gw_octree *loaded = NULL;
    (void)state;
    bad.nodes = malloc(gw_octree_node_bytes(octree));
    assert_non_null(bad.nodes);
    for (uint32_t i = 0; i < octree->node_count; ++i) {
        memcpy(bad.nodes, octree->nodes, gw_octree_node_bytes(octree));
        bad.nodes[i].link = 0xfffffff0u;
        gw_octree_hash(&bad);
        check_ok(gw_octree_cache_store(path, key, &bad, 0, &error));
        check_fails(gw_octree_cache_load(path, key, scene, &loaded, &error), GW_BAD_INPUT, "points outside");
    }
    free(bad.nodes);
    free(path);
}

/* The folder stays within its limit: what was used longest ago goes first, the new file never. */
static void test_folder_is_trimmed(void **state) {
    const char *folder = fresh_folder("cache-trim");
    char *paths[4];
    struct stat status;
    (void)state;
    for (int i = 0; i < 4; ++i) {
        gw_hash other = {key.high, key.low + (uint64_t)i};
        paths[i] = gw_octree_cache_path(folder, other);
        check_ok(gw_octree_cache_store(paths[i], other, octree, 0, &error));
        struct timespec times[2] = {{1000 + i, 0}, {1000 + i, 0}};
        assert_int_equal(utimensat(AT_FDCWD, paths[i], times, 0), 0);
    }
    assert_int_equal(stat(paths[0], &status), 0);
    check_ok(gw_octree_cache_store(paths[0], key, octree, (uint64_t)status.st_size * 5 / 2, &error));
    assert_true(gw_file_exists(paths[0]));
    assert_false(gw_file_exists(paths[1]));
    assert_false(gw_file_exists(paths[2]));
    assert_true(gw_file_exists(paths[3]));
    for (int i = 0; i < 4; ++i)
        free(paths[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_key_tells_octrees_apart),
        cmocka_unit_test(test_missing_file_is_refused),
        cmocka_unit_test(test_damage_is_refused),
        cmocka_unit_test(test_lies_are_refused),
        cmocka_unit_test(test_bad_links_are_refused),
        cmocka_unit_test(test_folder_is_trimmed),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
