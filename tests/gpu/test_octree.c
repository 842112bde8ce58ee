/* The octree build: structure, determinism, stopping rules, payload. */
#include "tests/support/device.h"

#include "build/octree.h"
#include "tests/support/meshes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static gw_octree *build(const gw_scene *scene, const gw_settings *settings, uint64_t part_limit) {
    gw_error error = {0};
    gw_octree *octree = NULL;
    gw_octree_options options = {.settings = settings, .part_limit = part_limit};
    if (gw_octree_build(device, scene, &options, &octree, &error) != GW_OK)
        fail_msg("%s", error.text);
    return octree;
}

static void validate(const gw_scene *scene, const gw_octree *octree) {
    gw_error error = {0};
    if (gw_octree_validate(device, scene, octree, &error) != GW_OK)
        fail_msg("%s", error.text);
}

static gw_scene *sphere_scene(uint32_t around) {
    gw_mesh mesh = {0};
    const double centre[3] = {3, -2, 1};
    gw_mesh_add_sphere(&mesh, centre, 0.5, 0.1, around, around / 2);
    return gw_mesh_take(&mesh);
}

static double area_of(gw_payload payload) {
    double root = GW_PAYLOAD_AREA_CODE(payload.surface) / 4095.0;
    return GW_PAYLOAD_AREA_MOST * root * root;
}

/* Every depth from 1 to the limit gives a sound tree. */
static void test_structure_at_every_depth(void **state) {
    gw_settings settings;
    gw_scene *scene = sphere_scene(48);
    (void)state;
    gw_settings_init(&settings);
    for (int depth = 1; depth <= GW_OCTREE_MAXIMUM_DEPTH; ++depth) {
        settings.octree_depth = depth;
        gw_octree *octree = build(scene, &settings, 0);
        validate(scene, octree);
        assert_true(octree->statistics.deepest <= (uint32_t)depth);
        assert_int_equal(octree->statistics.inner + octree->statistics.leaves, octree->node_count);
        gw_octree_destroy(&octree);
    }
    gw_scene_destroy(&scene);
}

/* Cut into many parts, the build gives the same bytes. */
static void test_parts_give_the_same_bytes(void **state) {
    gw_settings settings;
    gw_scene *scene = sphere_scene(80);
    const uint64_t limits[] = {(uint64_t)scene->triangle_count * 3, (uint64_t)scene->triangle_count * 2,
                               (uint64_t)scene->triangle_count * 6 / 5};
    (void)state;
    gw_settings_init(&settings);
    gw_octree *whole = build(scene, &settings, 0);
    assert_int_equal(whole->statistics.parts, 1);
    for (size_t i = 0; i < sizeof limits / sizeof *limits; ++i) {
        gw_octree *parts = build(scene, &settings, limits[i]);
        assert_true(parts->statistics.parts > 1);
        assert_int_equal(parts->node_count, whole->node_count);
        assert_memory_equal(parts->nodes, whole->nodes, gw_octree_node_bytes(whole));
        assert_memory_equal(parts->payloads, whole->payloads, gw_octree_payload_bytes(whole));
        assert_memory_equal(parts->references, whole->references, gw_octree_reference_bytes(whole));
        assert_true(gw_hash_equal(parts->hash, whole->hash));
        gw_octree_destroy(&parts);
    }
    gw_octree_destroy(&whole);
    gw_scene_destroy(&scene);
}

static void test_too_small_a_limit_is_refused_with_numbers(void **state) {
    gw_settings settings;
    gw_error error = {0};
    gw_octree *octree = NULL;
    gw_scene *scene = sphere_scene(48);
    gw_octree_options options = {.settings = &settings, .part_limit = 100};
    (void)state;
    gw_settings_init(&settings);
    assert_int_equal(gw_octree_build(device, scene, &options, &octree, &error), GW_MACHINE);
    assert_null(octree);
    assert_non_null(strstr(error.text, "100"));
    gw_scene_destroy(&scene);
}

/* The order of triangles and points in the input does not reach the bytes. */
static void test_input_order_does_not_matter(void **state) {
    gw_settings settings;
    gw_mesh mesh = {0}, shuffled = {0};
    const double centre[3] = {0, 0, 0};
    uint64_t seed = 7;
    (void)state;
    gw_settings_init(&settings);
    gw_mesh_add_sphere(&mesh, centre, 1, 0.2, 40, 20);
    for (size_t i = mesh.point_count; i-- > 0;)
        gw_mesh_point(&shuffled, mesh.points[i * 3], mesh.points[i * 3 + 1], mesh.points[i * 3 + 2]);
    for (size_t i = 0; i < mesh.triangle_count; ++i) {
        uint32_t last = (uint32_t)mesh.point_count - 1;
        gw_mesh_triangle(&shuffled, last - mesh.triangles[i][0], last - mesh.triangles[i][1],
                         last - mesh.triangles[i][2]);
    }
    for (size_t i = shuffled.triangle_count; i-- > 1;) {
        size_t j = (size_t)(gw_test_random(&seed) * (double)(i + 1));
        uint32_t keep[3];
        memcpy(keep, shuffled.triangles[i], sizeof keep);
        memcpy(shuffled.triangles[i], shuffled.triangles[j], sizeof keep);
        memcpy(shuffled.triangles[j], keep, sizeof keep);
    }
    gw_scene *a = gw_mesh_take(&mesh), *b = gw_mesh_take(&shuffled);
    gw_octree *first = build(a, &settings, 0), *second = build(b, &settings, 0);
    assert_true(gw_hash_equal(first->hash, second->hash));
    gw_octree_destroy(&first);
    gw_octree_destroy(&second);
    gw_scene_destroy(&a);
    gw_scene_destroy(&b);
}

/* The paper's plain K = 2 refines round every vertex to the depth limit; the fan rule stops that. */
static void test_fan_rule_bounds_the_tree(void **state) {
    gw_settings settings;
    gw_scene *scene = sphere_scene(64);
    (void)state;
    gw_settings_init(&settings);
    settings.leaf_triangles = 2;
    gw_octree *with = build(scene, &settings, 0);
    settings.fan_rule = 0;
    gw_octree *without = build(scene, &settings, 0);
    validate(scene, without);
    assert_true(with->statistics.stopped_fan > 0);
    assert_int_equal(without->statistics.stopped_fan, 0);
    /* The two poles are fans of 64, beyond the cap of 32: some cells still run to the limit. */
    assert_true(without->statistics.leaves > 4 * with->statistics.leaves);
    assert_true(without->statistics.stopped_depth > 20 * with->statistics.stopped_depth);
    gw_octree_destroy(&with);
    gw_octree_destroy(&without);
    gw_scene_destroy(&scene);
}

/* Deepest node of the branch that holds a point, in levels. */
static uint32_t depth_at(const gw_octree *octree, const float point[3]) {
    uint32_t node = 0;
    for (uint32_t level = 0;; ++level) {
        gw_node n = octree->nodes[node];
        uint32_t child = 0;
        if (GW_NODE_KIND(n.bits) != GW_KIND_INNER)
            return level;
        for (int k = 0; k < 3; ++k)
            child |= (uint32_t)(((uint32_t)floor((point[k] + 1.0) * ldexp(1, (int)level))) & 1u) << k;
        if (!(GW_NODE_VALID(n.bits) >> child & 1u))
            return level;
        node = n.link + (uint32_t)__builtin_popcount(GW_NODE_VALID(n.bits) & ((1u << child) - 1u));
    }
}

/* A tetrahedron of a thousandth of the scene, alone, gets cells of about its own size; without the rule one
 * of the first cells swallows it. */
static void test_isolation_rule_gives_small_things_a_voxel(void **state) {
    gw_settings settings;
    gw_mesh mesh = {0};
    const double corner[3] = {-1, -1, -1}, u[3] = {2, 0, 0}, v[3] = {0, 0, 2}, place[3] = {0.31, 0.57, 0.23};
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 13;
    gw_mesh_add_grid(&mesh, corner, u, v, 2, 2);
    gw_mesh_add_tetrahedron(&mesh, place, 0.0005);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_octree *with = build(scene, &settings, 0);
    settings.isolation_rule = 0;
    gw_octree *without = build(scene, &settings, 0);
    validate(scene, with);
    const float *p = NULL;
    for (uint32_t i = 0; i < scene->vertex_count; ++i)
        if (!p || scene->positions[i * 3 + 1] > p[1])
            p = scene->positions + (size_t)i * 3;
    float scale = (float)ldexp(1, -scene->exponent);
    float extent = 0.001f * scale, cell = ldexpf(2, -(int)depth_at(with, p));
    assert_true(with->statistics.refined_isolated > 0);
    assert_true(cell <= 2.01f * extent);
    assert_true(ldexpf(2, -(int)depth_at(without, p)) > 50 * extent);
    gw_octree_destroy(&with);
    gw_octree_destroy(&without);
    gw_scene_destroy(&scene);
}

/* The root's payload knows the whole surface: its area, whatever the depth, and its colour. */
static void test_payload_conserves_area_and_color(void **state) {
    gw_settings settings;
    gw_mesh mesh = {0};
    const double corner[3] = {-1, -0.3, -1}, u[3] = {2, 0, 0}, v[3] = {0, 0.37, 2};
    (void)state;
    gw_settings_init(&settings);
    gw_mesh_add_grid(&mesh, corner, u, v, 37, 23);
    gw_scene *scene = gw_mesh_take(&mesh);
    double scale = ldexp(1, -scene->exponent);
    double area = 2 * sqrt(0.37 * 0.37 + 4) * scale * scale / 4; /* over the root's face */
    for (int depth = 2; depth <= 10; depth += 4) {
        settings.octree_depth = depth;
        gw_octree *octree = build(scene, &settings, 0);
        validate(scene, octree);
        double stored = area_of(octree->payloads[0]);
        assert_true(fabs(stored - area) < 2e-3 * area); /* half a step of the stored code */
        /* linear 0.5 is 0.7354 in sRGB, 752 of 1023 */
        for (int channel = 0; channel < 3; ++channel)
            assert_in_range(octree->payloads[0].color >> (10 * channel) & 0x3ffu, 751, 753);
        assert_true(GW_PAYLOAD_HAS_NORMAL(octree->payloads[0].normal));
        gw_octree_destroy(&octree);
    }
    gw_scene_destroy(&scene);
}

/* Area of a scene over the root's face, as its root voxel knows it. */
static double stored_area(const gw_scene *scene, int depth) {
    gw_settings settings;
    gw_settings_init(&settings);
    settings.leaf_triangles = 1;
    settings.fan_rule = 0;
    settings.octree_depth = depth;
    gw_octree *octree = build(scene, &settings, 0);
    double stored = area_of(octree->payloads[0]);
    validate(scene, octree);
    gw_octree_destroy(&octree);
    return stored;
}

/* Rectangles that lie in cell planes count once, along each axis. */
static void test_triangles_in_cell_faces_count_once(void **state) {
    (void)state;
    for (int axis = 0; axis < 3; ++axis) {
        gw_mesh mesh = {0};
        for (int sheet = -1; sheet <= 1; ++sheet) {
            double corner[3] = {-0.5, -0.5, -0.5}, u[3] = {0}, v[3] = {0};
            corner[axis] = 0.5 * sheet;
            u[(axis + 1) % 3] = 1;
            v[(axis + 2) % 3] = 1;
            gw_mesh_add_grid(&mesh, corner, u, v, 8u << (sheet + 1), 8);
        }
        gw_scene *scene = gw_mesh_take(&mesh);
        double scale = ldexp(1, -scene->exponent);
        assert_true(fabs(stored_area(scene, 6) - 3 * scale * scale / 4) < 1e-3);
        gw_scene_destroy(&scene);
    }
}

/* Planes through edges and corners of cells: the cut along a shared edge counts once. */
static void test_planes_through_cell_edges_count_once(void **state) {
    static const double normals[][3] = {{1, 1, 0},  {1, 0, -1}, {0, 1, 1}, {1, 1, 1},
                                        {1, -1, 1}, {1, 2, 0},  {1, 2, 4}};
    (void)state;
    for (size_t i = 0; i < sizeof normals / sizeof *normals; ++i) {
        gw_mesh mesh = {0};
        const double *n = normals[i];
        /* Two directions in the plane with small integer components. */
        double u[3] = {n[1], -n[0], 0}, v[3], corner[3];
        if (n[0] == 0 && n[1] == 0)
            u[0] = 1;
        v[0] = u[1] * n[2] - u[2] * n[1];
        v[1] = u[2] * n[0] - u[0] * n[2];
        v[2] = u[0] * n[1] - u[1] * n[0];
        for (int k = 0; k < 3; ++k)
            corner[k] = -0.5 * (u[k] + v[k]);
        gw_mesh_add_grid(&mesh, corner, u, v, 3, 5);
        double length_u = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        double length_v = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        gw_scene *scene = gw_mesh_take(&mesh);
        double scale = ldexp(1, -scene->exponent);
        double area = length_u * length_v * scale * scale / 4;
        for (int depth = 1; depth <= 7; depth += 2) {
            double stored = stored_area(scene, depth);
            if (fabs(stored - area) > 4e-3 * area) /* half a step of the stored code */
                fail_msg("plane %zu at depth %d has area %g, not %g", i, depth, stored, area);
        }
        gw_scene_destroy(&scene);
    }
}

/* Random triangles from a hundredth of a cell to all of the scene: the sums meet the areas in double, at
 * every depth. */
static void test_random_triangles_keep_their_area(void **state) {
    uint64_t seed = 2026;
    gw_mesh mesh = {0};
    double area = 0;
    (void)state;
    for (int i = 0; i < 400; ++i) {
        double p[3][3], e[2][3], size = pow(10, -4 * gw_test_random(&seed));
        uint32_t v[3];
        for (int k = 0; k < 3; ++k)
            p[0][k] = 2 * gw_test_random(&seed) - 1;
        for (int j = 1; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                p[j][k] = p[0][k] + size * (2 * gw_test_random(&seed) - 1);
        for (int j = 0; j < 3; ++j)
            v[j] = gw_mesh_point(&mesh, p[j][0], p[j][1], p[j][2]);
        gw_mesh_triangle(&mesh, v[0], v[1], v[2]);
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 3; ++k)
                e[j][k] = p[j + 1][k] - p[0][k];
        double x = e[0][1] * e[1][2] - e[0][2] * e[1][1], y = e[0][2] * e[1][0] - e[0][0] * e[1][2],
               z = e[0][0] * e[1][1] - e[0][1] * e[1][0];
        area += 0.5 * sqrt(x * x + y * y + z * z);
    }
    print_message("seed 2026\n");
    gw_scene *scene = gw_mesh_take(&mesh);
    double scale = ldexp(1, -scene->exponent), expected = area * scale * scale / 4;
    assert_true(expected < 15); /* below saturation, so the comparison means something */
    for (int depth = 2; depth <= 11; depth += 3) {
        double stored = stored_area(scene, depth);
        if (fabs(stored - expected) > 2e-3 * expected)
            fail_msg("at depth %d the area is %g, not %g", depth, stored, expected);
    }
    gw_scene_destroy(&scene);
}

/* Opposed normals are flagged, never averaged away. */
static void test_opposed_normals_are_two_sided(void **state) {
    gw_settings settings;
    gw_mesh mesh = {0};
    const double a[3] = {-1, -1, 0.1}, b[3] = {-1, -1, 0.1001}, u[3] = {2, 0, 0}, v[3] = {0, 2, 0};
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 5;
    gw_mesh_add_grid(&mesh, a, u, v, 8, 8);
    gw_mesh_add_grid(&mesh, b, v, u, 8, 8);
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_octree *octree = build(scene, &settings, 0);
    validate(scene, octree);
    assert_true(octree->payloads[0].color & GW_PAYLOAD_TWO_SIDED);
    assert_true(GW_PAYLOAD_HAS_NORMAL(octree->payloads[0].normal));
    assert_true(octree->payloads[0].normal >> 24 > 240);
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
}

static void test_one_triangle(void **state) {
    gw_settings settings;
    gw_mesh mesh = {0};
    (void)state;
    gw_settings_init(&settings);
    gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, 0, 0, 0), gw_mesh_point(&mesh, 1, 0, 0),
                     gw_mesh_point(&mesh, 0, 1, 0));
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_octree *octree = build(scene, &settings, 0);
    validate(scene, octree);
    assert_int_equal(octree->statistics.longest_list, 1);
    assert_int_equal(octree->reference_count, 1);
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
}

/* 10,000 copies of one triangle but for steps of float, and lists far beyond one pass of the payload kernel.
 */
static void test_coincident_triangles(void **state) {
    gw_settings settings;
    gw_mesh mesh = {0};
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 5;
    uint32_t a = gw_mesh_point(&mesh, 0, 0, 0), b = gw_mesh_point(&mesh, 1, 0, 0.2);
    for (int i = 0; i < 10000; ++i)
        gw_mesh_triangle(&mesh, a, b, gw_mesh_point(&mesh, 0, 1, 0.3 + i * 0x1p-22));
    gw_scene *scene = gw_mesh_take(&mesh);
    gw_octree *octree = build(scene, &settings, 0);
    validate(scene, octree);
    assert_int_equal(octree->statistics.longest_list, 10000);
    assert_int_equal(GW_PAYLOAD_AREA_CODE(octree->payloads[0].surface), 4095); /* saturated, not wrapped */
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
}

/* The validator finds what is broken. */
static void test_validator_finds_damage(void **state) {
    gw_settings settings;
    gw_error error = {0};
    gw_scene *scene = sphere_scene(32);
    (void)state;
    gw_settings_init(&settings);
    gw_octree *octree = build(scene, &settings, 0);
    uint32_t inner = 1, list = 0;
    while (GW_NODE_KIND(octree->nodes[inner].bits) != GW_KIND_INNER)
        inner++;
    while (GW_NODE_KIND(octree->nodes[list].bits) != GW_LEAF_LIST)
        list++;
    const gw_node good_inner = octree->nodes[inner], good_list = octree->nodes[list];
    const struct {
        gw_node inner, list;
        const char *text;
    } damages[] = {
        {{good_inner.link + 1, good_inner.bits}, good_list, "octree node"},
        {{good_inner.link, good_inner.bits & ~0xffffu}, good_list, "masks"},
        {{octree->node_count, good_inner.bits}, good_list, "children outside"},
        {good_inner, {good_list.link, good_list.bits | 0xf0000u}, "kind"},
        {good_inner, {octree->reference_count, good_list.bits}, "reference array"},
    };
    for (size_t i = 0; i < sizeof damages / sizeof *damages; ++i) {
        octree->nodes[inner] = damages[i].inner;
        octree->nodes[list] = damages[i].list;
        assert_int_equal(gw_octree_validate(device, scene, octree, &error), GW_MACHINE);
        assert_non_null(strstr(error.text, damages[i].text));
    }
    octree->nodes[inner] = good_inner;
    octree->nodes[list] = good_list;
    octree->payloads[0].surface ^= 0x40u;
    assert_int_equal(gw_octree_validate(device, scene, octree, &error), GW_MACHINE);
    assert_non_null(strstr(error.text, "area"));
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
}

/* Boxes over long lists change neither lists nor voxels, whatever the parts, and the validator knows them. */
static void test_dense_leaves_keep_their_lists(void **state) {
    gw_settings settings;
    gw_error error = {0};
    gw_scene *scene = sphere_scene(48);
    (void)state;
    gw_settings_init(&settings);
    settings.octree_depth = 3;
    settings.dense_leaf = 0;
    gw_octree *plain = build(scene, &settings, 0);
    settings.dense_leaf = 20;
    gw_octree *dense = build(scene, &settings, 0);
    gw_octree *parts = build(scene, &settings, (uint64_t)scene->triangle_count * 3 / 2);
    validate(scene, dense);
    assert_true(parts->statistics.parts > 1);
    assert_true(gw_hash_equal(parts->hash, dense->hash));
    assert_true(dense->statistics.dense_leaves > 10);
    assert_int_equal(plain->box_count, 0);
    assert_memory_equal(plain->references, dense->references, gw_octree_reference_bytes(plain));
    assert_memory_equal(plain->payloads, dense->payloads, gw_octree_payload_bytes(plain));
    for (uint32_t i = 0; i < plain->node_count; ++i)
        if (GW_NODE_KIND(dense->nodes[i].bits) == GW_LEAF_DENSE)
            assert_int_equal(gw_octree_first_reference(dense, &dense->nodes[i]), plain->nodes[i].link);
        else
            assert_memory_equal(&dense->nodes[i], &plain->nodes[i], sizeof plain->nodes[i]);
    gw_box *box = &dense->boxes[dense->box_count / 2], good = *box;
    for (int damage = 0; damage < 4; ++damage) {
        *box = good;
        if (damage == 0)
            box->low[0] = 0.5f * (good.low[0] + good.high[0]);
        else if (damage == 1)
            box->high[2] = NAN;
        else if (damage == 2)
            box->link++;
        else
            box->triangles ^= GW_BOX_LAST;
        assert_int_equal(gw_octree_validate(device, scene, dense, &error), GW_MACHINE);
        assert_non_null(strstr(error.text, "octree node"));
    }
    gw_octree_destroy(&plain);
    gw_octree_destroy(&dense);
    gw_octree_destroy(&parts);
    gw_scene_destroy(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_structure_at_every_depth),
        cmocka_unit_test(test_parts_give_the_same_bytes),
        cmocka_unit_test(test_dense_leaves_keep_their_lists),
        cmocka_unit_test(test_too_small_a_limit_is_refused_with_numbers),
        cmocka_unit_test(test_input_order_does_not_matter),
        cmocka_unit_test(test_fan_rule_bounds_the_tree),
        cmocka_unit_test(test_isolation_rule_gives_small_things_a_voxel),
        cmocka_unit_test(test_payload_conserves_area_and_color),
        cmocka_unit_test(test_triangles_in_cell_faces_count_once),
        cmocka_unit_test(test_planes_through_cell_edges_count_once),
        cmocka_unit_test(test_random_triangles_keep_their_area),
        cmocka_unit_test(test_opposed_normals_are_two_sided),
        cmocka_unit_test(test_one_triangle),
        cmocka_unit_test(test_coincident_triangles),
        cmocka_unit_test(test_validator_finds_damage),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
