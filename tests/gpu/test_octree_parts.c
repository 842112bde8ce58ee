/* One octree built in parts by several builders: the same bytes as built alone, balanced, and damage noticed.
 */
#include "tests/support/device.h"

#include "build/demo_scene.h"
#include "build/octree_part.h"
#include "tests/support/meshes.h"

/* Spheres of unlike density, a plane of two large triangles through the split cells, a speck far away: leaves
 * above, at and below every split level. */
static gw_scene *mixed_scene(void) {
    gw_mesh mesh = {0};
    gw_scene *scene = NULL;
    const double dense[3] = {0, 0, 0}, coarse[3] = {1.5, 0.2, -0.3}, speck[3] = {-1.7, 1.1, 0.9};
    const double corner[3] = {-2, -0.6, -1}, u[3] = {4, 0, 0}, v[3] = {0, 0.1, 2};
    gw_mesh_add_sphere(&mesh, dense, 0.5, 0.2, 120, 60);
    gw_mesh_add_sphere(&mesh, coarse, 0.4, 0, 16, 8);
    gw_mesh_add_grid(&mesh, corner, u, v, 1, 1);
    gw_mesh_add_tetrahedron(&mesh, speck, 0.004);
    scene = gw_mesh_take(&mesh);
    return scene;
}

static void make_parts(const gw_scene *scene, const gw_octree_options *options,
                       const gw_octree_division *division, gw_octree_part *parts) {
    for (uint32_t p = 0; p < division->part_count; ++p)
        check_ok(gw_octree_build_part(device, scene, options, division, p, &parts[p], &error));
}

static void drop_parts(gw_octree_part *parts, uint32_t count) {
    for (uint32_t p = 0; p < count; ++p)
        free(parts[p].data);
}

static gw_octree *build_in_parts(const gw_scene *scene, const gw_octree_options *options, uint32_t count) {
    gw_octree_division division;
    gw_octree_part parts[GW_OCTREE_MAXIMUM_PARTS] = {{0}};
    gw_octree *octree = NULL;
    check_ok(gw_octree_divide(scene, options->settings, count, &division, &error));
    make_parts(scene, options, &division, parts);
    check_ok(gw_octree_join(device, scene, options, &division, parts, &octree, &error));
    drop_parts(parts, count);
    return octree;
}

static void check_equal(const gw_octree *a, const gw_octree *b) {
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->reference_count, b->reference_count);
    assert_memory_equal(a->level_begin, b->level_begin, sizeof a->level_begin);
    assert_memory_equal(a->nodes, b->nodes, gw_octree_node_bytes(b));
    assert_memory_equal(a->references, b->references, gw_octree_reference_bytes(b));
    assert_memory_equal(a->payloads, b->payloads, gw_octree_payload_bytes(b));
    assert_int_equal(a->emissions != NULL, b->emissions != NULL);
    if (b->emissions)
        assert_memory_equal(a->emissions, b->emissions, gw_octree_emission_bytes(b));
    assert_true(gw_hash_equal(a->hash, b->hash));
    const gw_octree_statistics *s = &a->statistics, *t = &b->statistics;
    assert_true(s->inner == t->inner && s->leaves == t->leaves && s->single_leaves == t->single_leaves);
    assert_true(s->stopped_small == t->stopped_small && s->stopped_fan == t->stopped_fan &&
                s->stopped_depth == t->stopped_depth && s->refined_isolated == t->refined_isolated);
    assert_true(s->longest_list == t->longest_list && s->deepest == t->deepest);
}

static void check_counts(const gw_scene *scene, const gw_settings *settings, const uint32_t *counts,
                         size_t count) {
    gw_octree *whole = NULL;
    gw_octree_options options = {.settings = settings};
    check_ok(gw_octree_build(device, scene, &options, &whole, &error));
    for (size_t i = 0; i < count; ++i) {
        gw_octree *joined = build_in_parts(scene, &options, counts[i]);
        check_equal(joined, whole);
        gw_octree_destroy(&joined);
    }
    gw_octree_destroy(&whole);
}

static void test_any_number_of_builders_gives_the_same_bytes(void **state) {
    const uint32_t counts[] = {1, 2, 3, 8, 40};
    gw_settings settings;
    gw_scene *scene = mixed_scene();
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 8;
    check_counts(scene, &settings, counts, sizeof counts / sizeof *counts);
    gw_scene_destroy(&scene);
}

/* The demo scene has textures, cut-outs, vertex colours and lights up. */
static void test_the_demo_scene_in_parts(void **state) {
    const uint32_t counts[] = {3};
    gw_settings settings;
    gw_scene *scene = NULL;
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 8;
    check_ok(gw_demo_scene(&scene, &error));
    check_counts(scene, &settings, counts, 1);
    gw_scene_destroy(&scene);
}

/* Depths at which the split level is the last but one, or the root. */
static void test_shallow_trees_in_parts(void **state) {
    const uint32_t counts[] = {2, 5};
    gw_settings settings;
    gw_scene *scene = mixed_scene();
    (void)state;
    gw_settings_init(&settings);
    for (settings.octree_depth = 1; settings.octree_depth <= 5; ++settings.octree_depth)
        check_counts(scene, &settings, counts, 2);
    gw_scene_destroy(&scene);
}

/* A scene of one tetrahedron: most parts have nothing to do. */
static void test_parts_without_work(void **state) {
    const uint32_t counts[] = {2, 8};
    const double centre[3] = {0, 0, 0};
    gw_settings settings;
    gw_mesh mesh = {0};
    gw_scene *scene = NULL;
    (void)state;
    gw_settings_init(&settings);
    gw_mesh_add_tetrahedron(&mesh, centre, 1);
    scene = gw_mesh_take(&mesh);
    check_counts(scene, &settings, counts, 2);
    gw_scene_destroy(&scene);
}

/* Builders whose drivers hold fewer pairs at a time. */
static void test_small_buffers_in_parts(void **state) {
    gw_settings settings;
    gw_scene *scene = mixed_scene();
    gw_octree *whole = NULL;
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 8;
    gw_octree_options options = {.settings = &settings};
    check_ok(gw_octree_build(device, scene, &options, &whole, &error));
    options.part_limit = (uint64_t)scene->triangle_count * 3 / 2;
    gw_octree *joined = build_in_parts(scene, &options, 3);
    assert_true(joined->statistics.parts > 3);
    check_equal(joined, whole);
    gw_octree_destroy(&joined);
    gw_octree_destroy(&whole);
    gw_scene_destroy(&scene);
}

/* The work is divided by pairs: the fullest part has at most a third more overlap tests than the mean, where
 * equal slices of space, the naive division, give one part nearly all of a sphere in a corner. */
static void test_work_is_balanced(void **state) {
    enum { PARTS = 4 };
    const double centre[3] = {1.2, 0.7, 0.9}, corner[3] = {-2, -1, -2}, u[3] = {4, 0, 0}, v[3] = {0, 0, 4};
    gw_mesh mesh = {0};
    gw_settings settings;
    gw_octree_division division;
    gw_octree_part parts[PARTS];
    gw_scene *scene = NULL;
    uint64_t even[PARTS] = {0}, slices[PARTS] = {0};
    (void)state;
    gw_mesh_add_sphere(&mesh, centre, 0.3, 0.1, 160, 80);
    gw_mesh_add_grid(&mesh, corner, u, v, 1, 1);
    scene = gw_mesh_take(&mesh);
    gw_settings_init(&settings);
    settings.octree_depth = 9;
    gw_octree_options options = {.settings = &settings};
    check_ok(gw_octree_divide(scene, &settings, PARTS, &division, &error));
    for (int naive = 0; naive < 2; ++naive) {
        for (uint32_t p = 0; naive && p <= PARTS; ++p)
            division.begin[p] = ((uint64_t)p << (3 * division.level)) / PARTS;
        make_parts(scene, &options, &division, parts);
        for (uint32_t p = 0; p < PARTS; ++p)
            (naive ? slices : even)[p] = gw_octree_part_statistics(&parts[p]).overlap_tests;
        drop_parts(parts, PARTS);
    }
    uint64_t total = 0, most_even = 0, most_slices = 0;
    for (uint32_t p = 0; p < PARTS; ++p) {
        total += even[p];
        most_even = even[p] > most_even ? even[p] : most_even;
        most_slices = slices[p] > most_slices ? slices[p] : most_slices;
    }
    print_message("# fullest part: %.2f of the mean; by slices of space: %.2f\n",
                  (double)most_even * PARTS / (double)total, (double)most_slices * PARTS / (double)total);
    assert_true(most_even * PARTS * 3 < total * 4);
    assert_true(most_slices * PARTS * 2 > total * 3);
    gw_scene_destroy(&scene);
}

static void test_damaged_parts_are_refused(void **state) {
    gw_settings settings;
    gw_octree_division division;
    gw_octree_part parts[3];
    gw_octree *octree = NULL;
    gw_scene *scene = mixed_scene();
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 6;
    gw_octree_options options = {.settings = &settings};
    check_ok(gw_octree_divide(scene, &settings, 3, &division, &error));
    make_parts(scene, &options, &division, parts);

    gw_octree_part swapped[3] = {parts[1], parts[0], parts[2]};
    check_fails(gw_octree_join(device, scene, &options, &division, swapped, &octree, &error), GW_BAD_INPUT,
                "another division");
    gw_octree_part cut[3] = {parts[0], {parts[1].data, parts[1].size - 64}, parts[2]};
    check_fails(gw_octree_join(device, scene, &options, &division, cut, &octree, &error), GW_BAD_INPUT,
                "size");
    /* Every third byte of a head in turn. */
    int refused = 0, tried = 0;
    uint8_t *bytes = parts[0].data;
    for (size_t i = 0; i < 600; i += 3, ++tried) {
        gw_error error = {0};
        bytes[i] ^= 0x11;
        if (gw_octree_join(device, scene, &options, &division, parts, &octree, &error) == GW_OK)
            gw_octree_destroy(&octree);
        else
            refused++;
        bytes[i] ^= 0x11;
    }
    print_message("# %d of %d flips in a part's head are refused, the rest are harmless\n", refused, tried);
    assert_true(refused > tried / 4);
    drop_parts(parts, 3);
    gw_scene_destroy(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_number_of_builders_gives_the_same_bytes),
        cmocka_unit_test(test_the_demo_scene_in_parts),
        cmocka_unit_test(test_shallow_trees_in_parts),
        cmocka_unit_test(test_parts_without_work),
        cmocka_unit_test(test_small_buffers_in_parts),
        cmocka_unit_test(test_work_is_balanced),
        cmocka_unit_test(test_damaged_parts_are_refused),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
