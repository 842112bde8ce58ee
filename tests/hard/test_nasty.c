/* Random scenes biased to nastiness, with rays at their features: the octree finds what brute force finds
 * with the same test, to the bit, contracted or not, and nothing is wrong in double precision. What fails is
 * shrunk to the ray and the triangles that it takes, and printed with its seed; GW_TEST_SEED=n runs one scene
 * again, GW_NASTY_SCENES=n more of them. */
#include "tests/support/device.h"

#include "tests/support/cases.h"
#include "tests/support/double_hits.h"
#include "tests/support/meshes.h"
#include "tests/support/nasty.h"
#include "tests/support/rays.h"

#include <float.h>
#include <math.h>

enum { SCENES = 10, RAYS = 1500 };

/* What is to hold of hits; NULL: of the shipped kernel against brute force and double. */
typedef struct property {
    const char *name, *defines;
} property;

static const property properties[] = {{"shipped", NULL}, {"contracted", "#define CONTRACTED 1\n"}};
/* One that does not hold, to see that what fails is found and shrunk. */
static const property broken = {"weighted depths", "#define WEIGHTED_DEPTHS 1\n"};

static int depth_of(uint64_t seed) {
    return seed % 2 ? 7 : 4;
}

/* Components that are all subnormal are no direction: devices may take them for zero. */
static int has_direction(const gw_ray *ray) {
    return fmaxf(fabsf(ray->direction[0]), fmaxf(fabsf(ray->direction[1]), fabsf(ray->direction[2]))) >=
           FLT_MIN;
}

/* The first of the rays for which the property does not hold of this mesh; count if it holds for all. A mesh
 * of which nothing is left to draw holds. */
static size_t first_failure(const gw_mesh *mesh, int depth, const property *p, const gw_ray *rays,
                            size_t count) {
    gw_error nothing = {0};
    gw_scene *scene = NULL;
    if (gw_mesh_scene(mesh, &scene, &nothing))
        return count;
    gw_case c;
    gw_case_open(&c, device, scene, depth);
    gw_hit *brute = gw_case_brute(&c, rays, count), *hits = gw_case_trace(&c, p->defines, rays, count);
    size_t first = count;
    for (size_t i = 0; i < count && first == count; ++i)
        if (memcmp(&brute[i], &hits[i], sizeof *hits) ||
            (has_direction(&rays[i]) ? gw_double_judge(c.scene, &rays[i], &hits[i]).verdict == GW_DOUBLE_WRONG
                                     : hits[i].triangle != GW_NO_TRIANGLE))
            first = i;
    free(brute);
    free(hits);
    gw_case_close(&c);
    return first;
}

/* Drops triangles, half of what is left at a time and then less, as long as the ray still fails. Two that
 * span the box stay, so that cells stay where they are. */
static void shrink(gw_mesh *mesh, int depth, const property *p, const gw_ray *ray) {
    const size_t anchors = 2;
    uint32_t(*kept)[3] = malloc(mesh->triangle_count * sizeof *kept);
    assert_non_null(kept);
    for (size_t step = mesh->triangle_count / 2; step > 0; step /= 2)
        for (size_t at = anchors; at < mesh->triangle_count;) {
            size_t count = mesh->triangle_count, end = at + step < count ? at + step : count;
            memcpy(kept, mesh->triangles, count * sizeof *kept);
            memmove(mesh->triangles + at, mesh->triangles + end, (count - end) * sizeof *kept);
            mesh->triangle_count = count - (end - at);
            if (first_failure(mesh, depth, p, ray, 1) == 0)
                continue;
            memcpy(mesh->triangles, kept, count * sizeof *kept);
            mesh->triangle_count = count;
            at = end;
        }
    free(kept);
}

static void print_case(const gw_mesh *mesh, int depth, const property *p, const gw_ray *ray) {
    gw_case c;
    gw_scene *scene = NULL;
    check_ok(gw_mesh_scene(mesh, &scene, &error));
    gw_case_open(&c, device, scene, depth);
    gw_hit *brute = gw_case_brute(&c, ray, 1), *hit = gw_case_trace(&c, p->defines, ray, 1);
    gw_double_result wanted = gw_double_judge(scene, ray, hit);
    print_message("%s: triangle %d at %a; brute force %d at %a; in double %d at %a\n", p->name,
                  (int)hit->triangle, (double)hit->t, (int)brute->triangle, (double)brute->t,
                  (int)wanted.nearest, wanted.t);
    print_message("ray from %a %a %a along %a %a %a\n", (double)ray->origin[0], (double)ray->origin[1],
                  (double)ray->origin[2], (double)ray->direction[0], (double)ray->direction[1],
                  (double)ray->direction[2]);
    for (uint32_t t = 0; t < scene->triangle_count && t < 12; ++t)
        for (int k = 0; k < 3; ++k) {
            const float *at = scene->positions + (size_t)scene->triangles[t][k] * 3;
            print_message("  triangle %u corner %d: %a %a %a\n", t, k, (double)at[0], (double)at[1],
                          (double)at[2]);
        }
    free(brute);
    free(hit);
    gw_case_close(&c);
}

/* Rays at what the seed's scene is made of. */
static gw_ray *rays_of(const gw_mesh *mesh, uint64_t seed) {
    gw_scene *scene = NULL;
    check_ok(gw_mesh_scene(mesh, &scene, &error));
    gw_ray *rays = gw_test_rays(scene, RAYS, seed);
    gw_scene_destroy(&scene);
    return rays;
}

/* Whether the property fails of the seed's scene; left in *mesh and *ray, shrunk. */
static int fails(uint64_t seed, const property *p, gw_mesh *mesh, gw_ray *ray) {
    uint64_t random = seed * 7919;
    gw_mesh_add_nasty(mesh, &random);
    gw_ray *rays = rays_of(mesh, seed);
    size_t at = first_failure(mesh, depth_of(seed), p, rays, RAYS);
    *ray = rays[at < RAYS ? at : 0];
    free(rays);
    if (at == RAYS)
        return 0;
    shrink(mesh, depth_of(seed), p, ray);
    return 1;
}

static void check_seed(uint64_t seed) {
    for (size_t i = 0; i < sizeof properties / sizeof *properties; ++i) {
        gw_mesh mesh = {0};
        gw_ray ray;
        if (fails(seed, &properties[i], &mesh, &ray)) {
            print_case(&mesh, depth_of(seed), &properties[i], &ray);
            fail_msg(
                "GW_TEST_SEED=%llu, depth %d, %s: the octree differs from brute force, or is wrong in double",
                (unsigned long long)seed, depth_of(seed), properties[i].name);
        }
        gw_mesh_finish(&mesh);
    }
}

static void nasty_scenes_hold(void **state) {
    (void)state;
    const char *chosen = getenv("GW_TEST_SEED"), *more = getenv("GW_NASTY_SCENES");
    uint64_t first = chosen ? strtoull(chosen, NULL, 10) : 1;
    uint64_t scenes = chosen ? 1 : more ? strtoull(more, NULL, 10) : SCENES;
    print_message("seeds %llu to %llu\n", (unsigned long long)first,
                  (unsigned long long)(first + scenes - 1));
    for (uint64_t seed = first; seed < first + scenes; ++seed)
        check_seed(seed);
}

static void what_fails_is_shrunk(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed < 20; ++seed) {
        gw_mesh mesh = {0};
        gw_ray ray;
        int failed = fails(seed, &broken, &mesh, &ray);
        size_t left = mesh.triangle_count;
        if (failed)
            print_case(&mesh, depth_of(seed), &broken, &ray);
        gw_mesh_finish(&mesh);
        if (failed) {
            print_message("%s: seed %llu fails, and still does with %zu triangles\n", broken.name,
                          (unsigned long long)seed, left);
            assert_true(left <= 4);
            return;
        }
    }
    fail_msg("t from weighted depths is never wrong: the scenes are not nasty enough");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nasty_scenes_hold),
        cmocka_unit_test(what_fails_is_shrunk),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
