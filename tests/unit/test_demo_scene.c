/* The embedded demo scene: what it promises, and that it is the same bits everywhere. */
#include "tests/support/check.h"

#include "base/hash.h"
#include "build/demo_scene.h"

#include <math.h>

static gw_scene *scene;

static int make_scene(void **state) {
    (void)state;
    gw_error error = {0};
    if (gw_demo_scene(&scene, &error) == GW_OK)
        return 0;
    print_error("%s\n", error.text);
    return 1;
}

static int destroy_scene(void **state) {
    (void)state;
    gw_scene_destroy(&scene);
    return scene != NULL;
}

static uint32_t material_named(const char *name) {
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (strcmp(scene->materials[i].name, name) == 0)
            return i;
    fail_msg("no material '%s'", name);
    return 0;
}

static uint32_t triangles_of(const char *name) {
    uint32_t material = material_named(name), count = 0;
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        count += scene->material_of[i] == material;
    return count;
}

static void it_is_large_and_whole(void **state) {
    (void)state;
    assert_true(scene->triangle_count >= 200000);
    assert_true(triangles_of("gold") >= 100000);
    assert_true(triangles_of("leaf") / 4 >= 30000); /* four triangles a leaf */
    assert_int_equal(scene->dropped.non_finite, 0);
    assert_int_equal(scene->dropped.bad_index, 0);
    assert_int_equal(scene->dropped.zero_area, 0);
    assert_int_equal(scene->dropped.collapsed, 0);
    assert_int_equal(scene->dropped.not_triangle, 0);
    assert_int_equal(scene->light_count, 1);
    assert_int_equal(scene->placement.kind, GW_PLACE_VIEWPOINT);
    assert_true(scene->viewpoint_count >= 1);
}

/* Some material is used by no triangle, or a picture is blank: a part went missing. */
static void every_material_and_texture_is_used(void **state) {
    (void)state;
    assert_true(scene->texture_count >= 8);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        assert_true(triangles_of(scene->materials[i].name) > 0);
        assert_true(scene->materials[i].base_color_texture < (int32_t)scene->texture_count);
    }
    for (uint32_t i = 0; i < scene->texture_count; i++) {
        const gw_image *image = &scene->textures[i].image;
        assert_true(image->width >= 256 && image->height >= 256);
        double sum = 0.0, squares = 0.0, count = (double)image->width * image->height;
        for (size_t texel = 0; texel < (size_t)image->width * image->height; texel++) {
            double green = image->rgba[4 * texel + 1];
            sum += green;
            squares += green * green;
            assert_int_equal(image->rgba[4 * texel + 3], 255);
        }
        assert_true(squares / count - (sum / count) * (sum / count) > 4.0);
    }
}

/* The viewer's side of the wall, 1.8 m before the eye, is empty: nothing is cut by the wall's plane. */
static void nothing_stands_before_the_wall(void **state) {
    (void)state;
    const gw_viewpoint *view = &scene->viewpoints[0];
    assert_true(view->eye[1] == view->look_at[1] && view->look_at[2] < view->eye[2]);
    assert_true(scene->bounds[1][2] <= view->eye[2] - 1.8);
    assert_true(view->eye[0] > scene->bounds[0][0] && view->eye[0] < scene->bounds[1][0]);
}

/* Normals are unit and on the side from which their triangle is counter-clockwise. */
static void normals_agree_with_the_winding(void **state) {
    (void)state;
    uint32_t against = 0;
    for (uint32_t i = 0; i < scene->triangle_count; i++) {
        double p[3][3], sum[3] = {0}, flat[3];
        for (int corner = 0; corner < 3; corner++)
            for (int axis = 0; axis < 3; axis++) {
                size_t at = 3 * (size_t)scene->triangles[i][corner] + (size_t)axis;
                p[corner][axis] = scene->positions[at];
                sum[axis] += scene->normals[at];
            }
        for (int axis = 0; axis < 3; axis++) {
            int y = (axis + 1) % 3, z = (axis + 2) % 3;
            flat[axis] =
                (p[1][y] - p[0][y]) * (p[2][z] - p[0][z]) - (p[1][z] - p[0][z]) * (p[2][y] - p[0][y]);
        }
        double agreement = sum[0] * flat[0] + sum[1] * flat[1] + sum[2] * flat[2];
        against += !(agreement > 0.0) && !scene->materials[scene->material_of[i]].two_sided;
    }
    for (size_t i = 0; i < scene->vertex_count; i++) {
        const float *n = scene->normals + 3 * i;
        double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
        assert_true(fabs(length - 1.0) < 1e-5);
    }
    assert_int_equal(against, 0);
}

typedef struct edge {
    uint32_t low, high;
    int32_t rising; /* 1 when its triangle runs from low to high */
} edge;

static int compare_edges(const void *a, const void *b) {
    const edge *x = a, *y = b;
    if (x->low != y->low)
        return x->low < y->low ? -1 : 1;
    if (x->high != y->high)
        return x->high < y->high ? -1 : 1;
    return (x->rising > y->rising) - (x->rising < y->rising);
}

/* Every edge of the knot belongs to exactly two triangles, which run along it in opposite directions. */
static void the_statue_is_closed(void **state) {
    (void)state;
    uint32_t gold = material_named("gold"), count = 0;
    edge *edges = calloc(3 * (size_t)triangles_of("gold"), sizeof *edges);
    assert_non_null(edges);
    for (uint32_t i = 0; i < scene->triangle_count; i++)
        for (int side = 0; scene->material_of[i] == gold && side < 3; side++) {
            uint32_t a = scene->welded[scene->triangles[i][side]];
            uint32_t b = scene->welded[scene->triangles[i][(side + 1) % 3]];
            assert_true(a != b);
            edges[count++] = a < b ? (edge){a, b, 1} : (edge){b, a, 0};
        }
    qsort(edges, count, sizeof *edges, compare_edges);
    assert_int_equal(count % 2, 0);
    for (uint32_t i = 0; i < count; i += 2) {
        assert_true(edges[i].low == edges[i + 1].low && edges[i].high == edges[i + 1].high);
        assert_true(edges[i].rising == 0 && edges[i + 1].rising == 1);
        if (i > 0)
            assert_true(compare_edges(&edges[i - 1], &edges[i]) != 0 &&
                        (edges[i - 1].low != edges[i].low || edges[i - 1].high != edges[i].high));
    }
    free(edges);
}

/* Bits that do not depend on the machine, the library or the compiler. A change of the scene changes them:
 * then look at the picture, and record the new ones. */
static void it_is_the_same_everywhere(void **state) {
    (void)state;
    gw_hash hash = {0, 0};
    size_t vertices = scene->vertex_count, triangles = scene->triangle_count;
    hash = gw_hash_bytes(hash, scene->positions, vertices * 3 * sizeof *scene->positions);
    hash = gw_hash_bytes(hash, scene->normals, vertices * 3 * sizeof *scene->normals);
    hash = gw_hash_bytes(hash, scene->texcoords, vertices * 2 * sizeof *scene->texcoords);
    hash = gw_hash_bytes(hash, scene->colors, vertices * 4);
    hash = gw_hash_bytes(hash, scene->triangles, triangles * sizeof *scene->triangles);
    hash = gw_hash_bytes(hash, scene->material_of, triangles * sizeof *scene->material_of);
    for (uint32_t i = 0; i < scene->texture_count; i++) {
        const gw_image *image = &scene->textures[i].image;
        hash = gw_hash_bytes(hash, image->rgba, 4 * (size_t)image->width * image->height);
    }
    char text[33];
    gw_hash_text(hash, text);
    assert_string_equal(text, "f0a83f908d30ec3ab0cb4d88b39a8530");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_large_and_whole),
        cmocka_unit_test(every_material_and_texture_is_used),
        cmocka_unit_test(nothing_stands_before_the_wall),
        cmocka_unit_test(normals_agree_with_the_winding),
        cmocka_unit_test(the_statue_is_closed),
        cmocka_unit_test(it_is_the_same_everywhere),
    };
    return cmocka_run_group_tests_name("demo_scene", tests, make_scene, destroy_scene);
}
