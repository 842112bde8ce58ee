/* tau = 0 is exact: hits of the shipped traversal against brute force with the same shader code, to the bit,
 * and against double precision, within derived bounds; whole pictures show what brute force hits. Rays are
 * primary ones, random and hard ones (tests/support/rays.h), from a printed seed. */
#include "tests/support/check.h"

#include "base/memory.h"
#include "base/srgb.h"
#include "render/features.h"
#include "render/frame_block.h"
#include "tests/support/double_hits.h"
#include "tests/support/meshes.h"
#include "tests/support/rays.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 56, PIXELS = SIDE * SIDE, HARD = 6000, SEED = 20261123, LISTED = 12 };

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera camera;

/* Every triangle glows in one of 1,000 colours of codes that sRGB keeps, and nothing else gives light. */
static void colour_of(uint32_t triangle, uint8_t codes[3]) {
    uint32_t which = triangle * 7u % 1000u;
    for (int k = 0; k < 3; ++k, which /= 10)
        codes[k] = (uint8_t)(20 + 24 * (which % 10));
}

static void make_glow(gw_scene *scene) {
    void *memory = NULL;
    check_ok(gw_allocate(&memory, 1000, sizeof *scene->materials, "materials", &error));
    free(scene->materials);
    scene->materials = memory;
    scene->material_count = 1000;
    for (uint32_t m = 0; m < 1000; ++m) {
        uint32_t triangle = m * 143u % 1000u; /* 143 * 7 = 1 modulo 1000 */
        uint8_t codes[3];
        scene->materials[m] =
            (gw_material){.roughness = 1, .base_color = {0, 0, 0, 1}, .base_color_texture = -1};
        colour_of(triangle, codes);
        for (int k = 0; k < 3; ++k)
            scene->materials[m].emissive[k] = (float)gw_srgb_code_to_linear(codes[k]);
    }
    for (uint32_t t = 0; t < scene->triangle_count; ++t)
        scene->material_of[t] = t * 7u % 1000u;
    for (int k = 0; k < 3; ++k) {
        scene->ambient[k] = 0;
        scene->background[k] = 0;
    }
}

static int open_stage(void **state) {
    (void)state;
    print_message("seed %d\n", SEED);
    gw_scene *scene = gw_test_scene(SEED);
    make_glow(scene);
    check_ok(gw_stage_open(
        &stage, scene, NULL,
        (const char *const[]){"octree_depth=9", "dense_leaf=6", "tau=0", "emissive_lights=0", NULL}, &error));
    renderer = gw_stage_renderer(&stage);
    gw_camera_look(&camera, &stage, (const double[]){1.1, 0.7, 1.9}, (const double[]){0, -0.1, 0}, 38, SIDE);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

/* The camera's rays, by the kernel's own expression in the same arithmetic. */
static gw_ray *primary_rays(void) {
    gw_frame_block block;
    gw_ray *rays = calloc(PIXELS, sizeof *rays);
    assert_non_null(rays);
    check_ok(gw_frame_block_fill(stage.scene, stage.octree, &camera.placement, &camera.plane, &camera.state,
                                 &block, NULL, &error));
    for (int i = 0; i < PIXELS; ++i) {
        float x = (float)(i % SIDE) + 0.5f, y = (float)(i / SIDE) + 0.5f;
        for (int k = 0; k < 3; ++k) {
            float across = block.step_x[k] * x, down = block.step_y[k] * y;
            rays[i].origin[k] = block.eye[k];
            rays[i].direction[k] = block.corner[k] + across + down;
        }
        rays[i].maximum = INFINITY;
    }
    return rays;
}

static gw_hit *hits_of(gw_trace_method method, const gw_ray *rays, size_t count) {
    gw_hit *hits = calloc(count, sizeof *hits);
    assert_non_null(hits);
    check_ok(gw_renderer_trace(renderer, method, rays, count, hits, NULL, &error));
    return hits;
}

/* To the bit, without exception: both test the same candidates in the same arithmetic, and equal t go to the
 * same triangle. */
static void compare_with_brute_force(const char *name, const gw_ray *rays, size_t count) {
    gw_hit *octree = hits_of(GW_TRACE_OCTREE, rays, count),
           *brute = hits_of(GW_TRACE_BRUTE_FORCE, rays, count);
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) {
        found += brute[i].triangle != GW_NO_TRIANGLE;
        if (memcmp(&octree[i], &brute[i], sizeof *octree))
            fail_msg("%s ray %zu: triangle %u at %a, brute force %u at %a", name, i, octree[i].triangle,
                     (double)octree[i].t, brute[i].triangle, (double)brute[i].t);
    }
    print_message("%s: %zu rays, %zu hits, all as brute force finds them\n", name, count, found);
    assert_true(found > count / 5 && found < count);
    free(octree);
    free(brute);
}

/* In double: none wrong; those that name another triangle than double's nearest are counted and listed. */
static void compare_with_double(const char *name, const gw_ray *rays, size_t count) {
    gw_hit *hits = hits_of(GW_TRACE_OCTREE, rays, count);
    size_t close = 0, wrong = 0, compared = 0;
    double most_error = 0, most_share = 0;
    for (size_t i = 0; i < count; ++i) {
        gw_double_result r = gw_double_judge(stage.scene, &rays[i], &hits[i]);
        compared += hits[i].triangle != GW_NO_TRIANGLE;
        most_error = r.verdict == GW_DOUBLE_SAME ? fmax(most_error, r.error) : most_error;
        most_share = r.verdict == GW_DOUBLE_WRONG ? most_share : fmax(most_share, r.share);
        close += r.verdict == GW_DOUBLE_CLOSE;
        wrong += r.verdict == GW_DOUBLE_WRONG;
        if (r.verdict == GW_DOUBLE_WRONG || (r.verdict == GW_DOUBLE_CLOSE && close <= LISTED))
            print_message("%s ray %zu: %s: triangle %u at %.9g, in double %u at %.17g\n", name, i,
                          r.verdict == GW_DOUBLE_WRONG ? "wrong" : "within the bounds", hits[i].triangle,
                          (double)hits[i].t, r.nearest, r.t);
    }
    print_message(
        "%s: %zu hits of %zu rays against double: %zu within the bounds of another, %zu wrong; t off by "
        "%.2g of itself at most, %.2g of its bound\n",
        name, compared, count, close, wrong, most_error, most_share);
    assert_int_equal(wrong, 0);
    assert_true(most_share <= 1.0);
    free(hits);
}

static void primary_rays_are_exact(void **state) {
    (void)state;
    gw_ray *rays = primary_rays();
    compare_with_brute_force("primary", rays, PIXELS);
    compare_with_double("primary", rays, PIXELS);
    free(rays);
}

static void hard_rays_are_exact(void **state) {
    (void)state;
    gw_ray *rays = gw_test_rays(stage.scene, HARD, SEED + 1);
    compare_with_brute_force("hard", rays, HARD);
    compare_with_double("hard", rays, HARD);
    free(rays);
}

/* The judge itself: hits moved by more than their bound, to the next triangle or to nothing are wrong. */
static void wrong_hits_are_found(void **state) {
    (void)state;
    gw_ray *rays = primary_rays();
    gw_hit *hits = hits_of(GW_TRACE_OCTREE, rays, PIXELS);
    size_t tried = 0, found = 0;
    for (size_t i = 0; i < PIXELS; i += 37)
        for (int how = 0; how < 4; ++how) {
            gw_hit bad = hits[i];
            if (bad.triangle == GW_NO_TRIANGLE)
                continue;
            if (how == 0)
                bad.t *= 1.0001f;
            if (how == 1)
                bad.t *= 0.9999f;
            if (how == 2)
                bad.triangle = (bad.triangle + 11) % stage.scene->triangle_count;
            if (how == 3)
                bad = (gw_hit){INFINITY, GW_NO_TRIANGLE};
            tried++;
            found += gw_double_judge(stage.scene, &rays[i], &bad).verdict == GW_DOUBLE_WRONG;
        }
    print_message("%zu of %zu wrong hits found\n", found, tried);
    assert_true(tried > 100 && found > tried * 97 / 100); /* rays that pass an edge may go either way */
    free(hits);
    free(rays);
}

/* Pictures at tau 0 have the colours of what brute force hits, with whatever kernel. */
static void pictures_show_what_brute_force_hits(void **state) {
    (void)state;
    gw_ray *rays = primary_rays();
    gw_hit *brute = hits_of(GW_TRACE_BRUTE_FORCE, rays, PIXELS);
    gw_renderer *voxels = NULL;
    gw_renderer_options options = {.force_features = GW_FEATURE_LOD | GW_FEATURE_GAZE};
    check_ok(gw_renderer_create(stage.device, stage.scene, stage.octree, &options, &voxels, &error));
    gw_camera gazed = camera;
    gw_camera_gaze(&gazed, 20, 30, 4);
    gazed.state.sample_block = 0;
    gazed.state.acuity_slope = 0; /* no width beyond a pixel's: a sparse ray would not be this ray */
    const struct {
        const gw_camera *camera;
        gw_renderer *by;
        const char *name;
    } frames[] = {{&camera, renderer, "exact kernel"},
                  {&camera, voxels, "kernel with voxels"},
                  {&gazed, voxels, "gaze"}};
    for (size_t f = 0; f < 3; ++f) {
        uint8_t *rgba = gw_camera_take(frames[f].camera, frames[f].by, NULL);
        for (size_t i = 0; i < PIXELS; ++i) {
            uint8_t wanted[3] = {0, 0, 0};
            if (brute[i].triangle != GW_NO_TRIANGLE)
                colour_of(brute[i].triangle, wanted);
            if (memcmp(rgba + i * 4, wanted, 3))
                fail_msg("%s: pixel (%zu, %zu) is %d %d %d, triangle %u is %d %d %d", frames[f].name,
                         i % SIDE, i / SIDE, rgba[i * 4], rgba[i * 4 + 1], rgba[i * 4 + 2], brute[i].triangle,
                         wanted[0], wanted[1], wanted[2]);
        }
        free(rgba);
    }
    gw_renderer_destroy(&voxels);
    free(brute);
    free(rays);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(primary_rays_are_exact),
        cmocka_unit_test(hard_rays_are_exact),
        cmocka_unit_test(wrong_hits_are_found),
        cmocka_unit_test(pictures_show_what_brute_force_hits),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
