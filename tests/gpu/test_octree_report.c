/* The octree's report and pictures against the octree itself, and what buffers the build leaves behind. */
#include "build/octree_picture.h"
#include "build/octree_report.h"
#include "tests/support/device.h"
#include "tests/support/meshes.h"

#include <math.h>

static gw_scene *sphere_scene(void) {
    const double centre[3] = {1, 2, 3};
    gw_mesh mesh = {0};
    gw_scene *scene = NULL;
    gw_mesh_add_sphere(&mesh, centre, 0.8, 0.2, 60, 30);
    gw_mesh_add_tetrahedron(&mesh, (const double[]){3, 2, 3}, 0.02);
    for (int i = 0; i < 200; i++) /* a dense place: a leaf with boxes */
        gw_mesh_triangle(&mesh, gw_mesh_point(&mesh, 0, 2, 3), gw_mesh_point(&mesh, 0.001, 2, 3),
                         gw_mesh_point(&mesh, 0, 2.001, 3 + i * 1e-5));

    scene = gw_mesh_take(&mesh);
    return scene;
}

static gw_octree *build(const gw_scene *scene, int depth) {
    gw_settings settings;
    gw_octree *octree = NULL;
    gw_settings_init(&settings);
    settings.octree_depth = depth;
    gw_octree_options options = {.settings = &settings};
    check_ok(gw_octree_build(device, scene, &options, &octree, &error));
    return octree;
}

static void sums_agree_with_the_octree(void **state) {
    gw_scene *scene = sphere_scene();
    gw_octree *octree = build(scene, 7);
    gw_octree_report r;
    uint64_t inner = 0, leaves = 0, triangles = 0, in_lists = 0;
    (void)state;

    assert_true(octree->statistics.dense_leaves > 0);
    gw_octree_report_make(octree, &r);

    for (uint32_t l = 0; l < r.level_count; l++) {
        inner += r.levels[l].inner;
        leaves += r.levels[l].leaves;
        triangles += r.levels[l].triangles;
        assert_int_equal(r.levels[l].inner + r.levels[l].leaves,
                         octree->level_begin[l + 1] - octree->level_begin[l]);
    }
    for (uint32_t i = 0; i < r.list_classes; i++)
        in_lists += r.lists[i];
    assert_int_equal(r.level_count, octree->statistics.deepest + 1);
    assert_int_equal(inner, octree->statistics.inner);
    assert_int_equal(leaves, octree->statistics.leaves);
    assert_int_equal(in_lists, leaves);
    assert_int_equal(r.lists[0], octree->statistics.single_leaves);
    assert_int_equal(triangles, octree->reference_count - 1 + octree->statistics.single_leaves);
    uint32_t range[2], next = 1;
    for (uint32_t i = 0; i < r.list_classes; i++) {
        gw_list_class_range(i, range);
        assert_int_equal(range[0], next);
        next = range[1] + 1;
    }
    assert_in_range(octree->statistics.longest_list, range[0], range[1]);
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
}

/* The level of the leaf at a point, or -1 for an empty cell. */
static int level_at(const gw_octree *octree, const double point[3]) {
    uint32_t node = 0;
    for (int level = 0;; level++) {
        const gw_node n = octree->nodes[node];
        uint32_t octant = 0;
        if (GW_NODE_KIND(n.bits) != GW_KIND_INNER)
            return level;
        for (int k = 0; k < 3; k++)
            octant |= ((uint32_t)floor((point[k] + 1) * ldexp(1, level)) & 1u) << k;
        if (!(GW_NODE_VALID(n.bits) >> octant & 1u))
            return -1;
        node = n.link + (uint32_t)__builtin_popcount(GW_NODE_VALID(n.bits) & ((1u << octant) - 1u));
    }
}

static uint32_t color_at(const gw_image *image, uint32_t x, uint32_t y) {
    const uint8_t *p = image->rgba + ((size_t)y * image->width + x) * 4;
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

/* All neighbours have the same colour: neither an outline nor a cell of few pixels. */
static int is_plain(const gw_image *image, uint32_t x, uint32_t y) {
    int plain = 1;
    for (uint32_t j = y - 1; j <= y + 1; j++)
        for (uint32_t i = x - 1; i <= x + 1; i++)
            plain &= color_at(image, i, j) == color_at(image, x, y);
    return plain;
}

enum { SIDE = 400, SLICES = 64 };

typedef struct view {
    int axis, right, up;
    double half[3], step; /* of the scene and of a pixel, root units */
    uint32_t width, height;
    gw_image image;
} view;

static view view_along(const gw_scene *scene, const gw_octree *octree, int axis) {
    view v = {.axis = axis, .right = axis == 0 ? 2 : 0, .up = axis == 1 ? 2 : 1};
    for (int k = 0; k < 3; k++) {
        v.half[k] = 0.5 * ldexp(scene->bounds[1][k] - scene->bounds[0][k], -scene->exponent);
        v.step = fmax(v.step, 2 * v.half[k] / SIDE);
    }
    v.width = (uint32_t)ceil(2 * v.half[v.right] / v.step);
    v.height = (uint32_t)ceil(2 * v.half[v.up] / v.step);
    check_ok(gw_octree_picture(scene, octree, axis, SIDE, &v.image, &error));
    return v;
}

/* Every plain pixel of the picture's cut is black where the plane has no leaf, and else has the colour of the
 * leaf's level, one for each. */
static int is_cut_at(const view *v, const gw_octree *octree, int slice) {
    uint32_t color_of[SLICES] = {0}, filled = 0;
    for (uint32_t y = 1; y + 1 < v->height; y += 3)
        for (uint32_t x = 1; x + 1 < v->width; x += 3) {
            double point[3];
            point[v->axis] = 2 * (slice + 0.5) / SLICES - 1;
            point[v->right] = (x + 0.5) * v->step - v->half[v->right];
            point[v->up] = (v->height - y - 0.5) * v->step - v->half[v->up];
            const int level = level_at(octree, point);
            const uint32_t color = color_at(&v->image, x, y);
            if (!is_plain(&v->image, x, y))
                continue;
            if (level >= 0 && color_of[level] == 0)
                color_of[level] = color;
            if (color != (level < 0 ? 0 : color_of[level]) || (level >= 0 && color == 0))
                return 0;
            filled += level >= 0;
        }
    return filled > 20;
}

static void the_cut_shows_the_levels(void **state) {
    gw_scene *scene = sphere_scene();
    gw_octree *octree = build(scene, 6); /* 2^6 slices */
    (void)state;
    for (int axis = 0; axis < 3; axis++) {
        view v = view_along(scene, octree, axis);
        int fitting = 0;
        for (int slice = 0; slice < SLICES; slice++)
            fitting += is_cut_at(&v, octree, slice);
        assert_in_range(fitting, 1, 2); /* its own, and one beside it that happens to look the same */
        gw_image_finish(&v.image);
    }
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
}

static void the_build_gives_its_buffers_back(void **state) {
    gw_scene *scene = sphere_scene();
    const uint64_t before = gw_gl_usage_of(device).bytes;
    gw_gl_buffer buffer;
    (void)state;
    gw_gl_reset_peak(device);
    gw_octree *octree = build(scene, 7);
    assert_int_equal(gw_gl_usage_of(device).bytes, before);
    assert_true(gw_gl_usage_of(device).peak > before + scene->triangle_count * 64);
    gw_gl_reset_peak(device);
    check_ok(gw_gl_buffer_create(device, "counted", 1000, NULL, 0, &buffer, &error));
    assert_int_equal(gw_gl_usage_of(device).bytes, before + 1000);
    gw_gl_buffer_finish(&buffer);
    gw_gl_buffer_finish(&buffer);
    assert_int_equal(gw_gl_usage_of(device).bytes, before);
    assert_int_equal(gw_gl_usage_of(device).peak, before + 1000);
    gw_octree_destroy(&octree);
    gw_scene_destroy(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_agree_with_the_octree),
        cmocka_unit_test(the_cut_shows_the_levels),
        cmocka_unit_test(the_build_gives_its_buffers_back),
    };
    return cmocka_run_group_tests_name("octree_report", tests, open_device, close_device);
}
