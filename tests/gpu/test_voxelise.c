/* The rasterised voxeliser of the bench: its pairs against those of refinement, explained; and without the
 * enlargement that makes it conservative. */
#include "base/gl.h"
#include "build/octree.h"
#include "tests/support/check.h"
#include "wall/rock.h"
#include "wall/splat_build.h"
#include "wall/voxel_pairs.h"
#include "wall/voxelise.h"

enum { DEPTH = 6, RESOLUTION = 1 << DEPTH };

static gw_gl *device;
static gw_scene *rock;
static gw_pairs refined;
static double subpixel;

static gw_pairs refine(const gw_scene *scene) {
    gw_octree *octree = NULL;
    gw_settings settings;
    gw_pairs pairs;
    gw_settings_init(&settings);
    settings.octree_depth = DEPTH;
    settings.leaf_triangles = settings.fan_rule = settings.isolation_rule = settings.dense_leaf = 0;
    gw_octree_options options = {.settings = &settings};
    check_ok(gw_octree_build(device, scene, &options, &octree, &error));
    check_ok(gw_pairs_of_octree(octree, &pairs, &error));
    gw_octree_destroy(&octree);
    return pairs;
}

static gw_pairs rasterise(const gw_scene *scene, int enlarge, uint32_t limit, uint32_t *draws) {
    gw_voxelised voxelised;
    gw_pairs pairs;
    check_ok(gw_voxelise(device, scene, RESOLUTION, enlarge, limit, &voxelised, &error));
    check_ok(gw_pairs_of_fragments(&voxelised, &pairs, &error));
    assert_int_equal(pairs.count, voxelised.count); /* a triangle writes a voxel once */
    *draws = voxelised.draws;
    subpixel = voxelised.subpixel;
    assert_int_equal(voxelised.buffer.id != 0, voxelised.draws == 1);
    gw_voxelised_finish(&voxelised);
    return pairs;
}

static int open_all(void **state) {
    (void)state;
    gw_error error = {0};
    gw_gl_options options = {0};
    if (gw_gl_create(&options, &device, &error) || gw_rock_scene(3000, &rock, &error)) {
        print_error("%s\n", error.text);
        return 1;
    }
    refined = refine(rock);
    return 0;
}

static int close_all(void **state) {
    (void)state;
    gw_pairs_finish(&refined);
    gw_scene_destroy(&rock);
    gw_gl_destroy(&device);
    return 0;
}

static void differences_are_explained(void **state) {
    (void)state;
    uint32_t draws;
    gw_pair_differences d;
    gw_pairs rasterised = rasterise(rock, 1, 0, &draws);
    check_ok(gw_pairs_compare(rock, RESOLUTION, subpixel, &refined, &rasterised, &d, &error));
    assert_int_equal(draws, 1);
    assert_true(d.both > rock->triangle_count);
    assert_int_equal(d.both + d.other_depth + d.thinner + d.no_fragment + d.touching, refined.count);
    assert_int_equal(d.both + d.beside + d.unexplained, rasterised.count);
    assert_int_equal(d.unexplained, 0); /* refinement misses nothing */
    assert_int_equal(d.no_fragment, 0); /* nor does the enlarged rasteriser miss a column */
    assert_true(d.other_depth > 0);     /* but it keeps one voxel of a pixel only */
    gw_pairs_finish(&rasterised);
}

/* What only the centres of pixels see: most small triangles have none. */
static void without_enlargement_columns_are_missed(void **state) {
    (void)state;
    uint32_t draws;
    gw_pair_differences d;
    gw_pairs rasterised = rasterise(rock, 0, 0, &draws);
    check_ok(gw_pairs_compare(rock, RESOLUTION, subpixel, &refined, &rasterised, &d, &error));
    assert_true(d.no_fragment > refined.count / 4);
    gw_pairs_finish(&rasterised);
}

static void slices_give_the_same_pairs(void **state) {
    (void)state;
    uint32_t draws;
    gw_pairs whole = rasterise(rock, 1, 0, &draws);
    gw_pairs sliced = rasterise(rock, 1, (uint32_t)(whole.count / 5), &draws);
    assert_true(draws > 5);
    assert_int_equal(sliced.count, whole.count);
    assert_memory_equal(sliced.keys, whole.keys, whole.count * sizeof *whole.keys);
    gw_pairs_finish(&whole);
    gw_pairs_finish(&sliced);
}

static void a_triangle_that_does_not_fit_is_an_error(void **state) {
    (void)state;
    gw_voxelised voxelised;
    check_fails(gw_voxelise(device, rock, RESOLUTION, 1, 1, &voxelised, &error), GW_MACHINE, "alone has");
    check_fails(gw_voxelise(device, rock, 2048, 1, 0, &voxelised, &error), GW_BAD_INPUT, "1024");
}

static int by_value(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* What the paper's loop must come to, level by level from the pairs alone: a cell of more than two triangles
 * is inner, at the finest level it has a list. */
static gw_splat_counts expected_counts(const gw_pairs *pairs) {
    gw_splat_counts expected = {.nodes = 1};
    uint64_t *keys = malloc(pairs->count * sizeof *keys), *inner = NULL;
    size_t inner_count = 0;
    assert_non_null(keys);
    for (uint32_t level = 0; level <= DEPTH; level++) {
        uint64_t *next_inner = malloc(pairs->count * sizeof *next_inner);
        size_t next_count = 0;
        assert_non_null(next_inner);
        for (size_t i = 0; i < pairs->count; i++)
            keys[i] = (pairs->keys[i] >> 32 >> 3 * (DEPTH - level)) << 32 | (uint32_t)pairs->keys[i];
        qsort(keys, pairs->count, sizeof *keys, by_value);
        for (size_t i = 0, end; i < pairs->count; i = end) {
            uint64_t cell = keys[i] >> 32, parent = cell >> 3, triangles = 1;
            for (end = i + 1; end < pairs->count && keys[end] >> 32 == cell; end++)
                triangles += keys[end] != keys[end - 1];
            if (level > 0 && !bsearch(&parent, inner, inner_count, sizeof parent, by_value))
                continue;
            if (triangles > 2 && level < DEPTH) {
                next_inner[next_count++] = cell;
                expected.nodes += 8;
                expected.inner++;
            } else {
                expected.leaves++;
                expected.pair_entries += triangles == 2 ? 2 : 0;
                expected.list_entries += triangles > 2 ? triangles : 0;
            }
        }
        free(inner);
        inner = next_inner;
        inner_count = next_count;
    }
    expected.empty = expected.nodes - expected.inner - expected.leaves;
    free(inner);
    free(keys);
    return expected;
}

static void the_papers_loop_builds_the_tree_of_its_fragments(void **state) {
    (void)state;
    gw_voxelised voxelised;
    gw_pairs pairs;
    gw_splat_counts counts;
    check_ok(gw_voxelise(device, rock, RESOLUTION, 1, 0, &voxelised, &error));
    check_ok(gw_pairs_of_fragments(&voxelised, &pairs, &error));
    check_ok(gw_splat_build(device, &voxelised, DEPTH, rock->triangle_count, &counts, &error));
    gw_splat_counts expected = expected_counts(&pairs);
    assert_int_equal(counts.nodes, expected.nodes);
    assert_int_equal(counts.inner, expected.inner);
    assert_int_equal(counts.leaves, expected.leaves);
    assert_int_equal(counts.empty, expected.empty);
    assert_int_equal(counts.pair_entries, expected.pair_entries);
    assert_int_equal(counts.list_entries, expected.list_entries);
    assert_true(counts.pair_entries > 0 && counts.list_entries > 0 && counts.inner > 1000);
    gw_pairs_finish(&pairs);
    gw_voxelised_finish(&voxelised);
    check_ok(gw_voxelise(device, rock, RESOLUTION, 1, 5000, &voxelised, &error));
    check_fails(gw_splat_build(device, &voxelised, DEPTH, rock->triangle_count, &counts, &error), GW_MACHINE,
                "in one buffer");
    gw_voxelised_finish(&voxelised);
}

static void boxes_and_triangles(void **state) {
    (void)state;
    static const double flat[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    static const struct {
        double centre[3];
        int meets;
    } cases[] = {
        {{1, 1, 0}, 1},     /* the middle */
        {{1, 1, 0.5}, 1},   /* it lies in the box's face */
        {{1, 1, 0.51}, 0},  /* a face's axis tells them apart */
        {{-0.5, 1, 0}, 1},  /* contact at an edge */
        {{2.6, 2.3, 0}, 1}, /* the slanted edge cuts a corner */
        {{2.6, 2.6, 0}, 0}, /* inside the triangle's box, beyond its slanted edge: an edge's axis tells */
        {{4.6, -0.1, 0}, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(gw_triangle_meets_box(flat, cases[i].centre, 0.5), cases[i].meets);
    static const double slanted[3][3] = {{3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
    static const double near_plane[3] = {0.6, 0.6, 0.6}, far_plane[3] = {0.4, 0.4, 0.4};
    assert_int_equal(gw_triangle_meets_box(slanted, near_plane, 0.45), 1);
    assert_int_equal(gw_triangle_meets_box(slanted, far_plane, 0.45), 0); /* the triangle's own axis tells */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(differences_are_explained),
        cmocka_unit_test(without_enlargement_columns_are_missed),
        cmocka_unit_test(slices_give_the_same_pairs),
        cmocka_unit_test(a_triangle_that_does_not_fit_is_an_error),
        cmocka_unit_test(the_papers_loop_builds_the_tree_of_its_fragments),
        cmocka_unit_test(boxes_and_triangles),
    };
    return cmocka_run_group_tests_name("voxelise", tests, open_all, close_all);
}
