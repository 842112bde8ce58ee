/* What the rays of pixels met, against the traced rays themselves, and the metrics of it: errors grow with
 * tau and vanish with it. */
#include "tests/support/check.h"

#include "build/demo_scene.h"
#include "render/metrics.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 72, PIXELS = SIDE * SIDE };

typedef struct met {
    uint32_t ids[PIXELS];
    float depths[PIXELS], normals[PIXELS * 3];
} met;

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera camera;
static met reference, other;

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL, (const char *const[]){"octree_depth=8", NULL}, &error));
    renderer = gw_stage_renderer(&stage);
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    gw_camera_look(&camera, &stage, view->eye, view->look_at, 60, SIDE);
    camera.state.tau_inside = 0;
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static void take(const gw_camera *from, const gw_rectangle *part, met *out) {
    const gw_geometry arrays = {out->ids, out->depths, out->normals};
    check_ok(
        gw_renderer_geometry(renderer, &from->placement, &from->plane, part, &from->state, &arrays, &error));
}

static const gw_rectangle all = {0, 0, SIDE, SIDE};

static gw_metric_frame frame_of(const met *m) {
    return (gw_metric_frame){
        .width = SIDE, .height = SIDE, .ids = m->ids, .depths = m->depths, .normals = m->normals};
}

static void it_is_what_the_rays_meet(void **state) {
    gw_ray *rays = calloc(PIXELS, sizeof *rays);
    gw_hit *hits = calloc(PIXELS, sizeof *hits);
    double rebased_eye[3];
    size_t met_something = 0, other_triangle = 0;
    (void)state;
    assert_true(rays && hits);
    gw_wall_to_rebased(&camera.placement, stage.scene, camera.state.eye, rebased_eye);
    for (uint32_t i = 0; i < PIXELS; ++i) {
        double direction[3], point[3], rebased[3];
        gw_camera_ray(&camera, i % SIDE, i / SIDE, direction);
        for (int k = 0; k < 3; ++k) /* a metre of wall space */
            point[k] = camera.state.eye[k] + 1000 * direction[k];
        gw_wall_to_rebased(&camera.placement, stage.scene, point, rebased);
        for (int k = 0; k < 3; ++k) {
            rays[i].origin[k] = (float)rebased_eye[k];
            rays[i].direction[k] = (float)(rebased[k] - rebased_eye[k]);
        }
        rays[i].maximum = 1e6f;
    }
    check_ok(gw_renderer_trace(renderer, GW_TRACE_OCTREE, rays, PIXELS, hits, NULL, &error));
    take(&camera, &all, &reference);
    for (uint32_t i = 0; i < PIXELS; ++i) {
        const int met_here = hits[i].triangle != GW_NO_TRIANGLE;
        met_something += (size_t)met_here;
        if ((reference.ids[i] != GW_NO_TRIANGLE) != met_here ||
            (met_here && reference.ids[i] != hits[i].triangle)) {
            other_triangle++; /* the rays are rounded differently: at edges another one may be met */
            continue;
        }
        if (!met_here)
            continue;
        const double depth = 1000 * (double)hits[i].t;
        if (!(fabs((double)reference.depths[i] / depth - 1) < 1e-4))
            fail_msg("pixel %u, %u: %g mm, the ray %g", i % SIDE, i / SIDE, (double)reference.depths[i],
                     depth);
        double length = 0;
        for (int k = 0; k < 3; ++k)
            length +=
                (double)(reference.normals[i * 3 + (uint32_t)k] * reference.normals[i * 3 + (uint32_t)k]);
        assert_true(fabs(length - 1) < 1e-4);
    }
    print_message("# %zu of %d pixels hit, %zu differ by rounding\n", met_something, PIXELS, other_triangle);
    assert_true(met_something > PIXELS / 4 && met_something < PIXELS);
    assert_true(other_triangle < PIXELS / 500);
    free(rays);
    free(hits);
}

/* Sparse sampling, light and how the frame is split are no matter of geometry. */
static void splits_and_samples_change_nothing(void **state) {
    const gw_rectangle parts[2] = {{0, 0, SIDE, 29}, {0, 29, SIDE, SIDE - 29}};
    gw_camera gazed = camera;
    static met part;
    (void)state;
    gw_camera_gaze(&gazed, 20, 30, 5);
    gazed.state.tau = 2;
    take(&gazed, &all, &reference);
    gazed.state.samples = 2;
    gazed.state.bounces = 0;
    for (int p = 0; p < 2; ++p) {
        take(&gazed, &parts[p], &part);
        const size_t first = (size_t)parts[p].y * SIDE, count = (size_t)parts[p].height * SIDE;
        assert_memory_equal(part.ids, reference.ids + first, count * sizeof *part.ids);
        assert_memory_equal(part.depths, reference.depths + first, count * sizeof *part.depths);
        assert_memory_equal(part.normals, reference.normals + first * 3, count * 3 * sizeof *part.normals);
    }
}

static gw_metrics error_of_tau(double tau) {
    const gw_metric_view view = {.pixels_per_degree = SIDE / 60.0};
    gw_camera coarse = camera;
    gw_metrics out;
    coarse.state.tau_inside = (float)tau;
    take(&coarse, &all, &other);
    const gw_metric_frame a = frame_of(&reference), b = frame_of(&other);
    check_ok(gw_metrics_compare(&a, &b, &view, &out, &error));
    return out;
}

static void errors_grow_with_tau(void **state) {
    static const gw_metric shown[] = {GW_METRIC_HIT_MISMATCH, GW_METRIC_DEPTH_MEAN, GW_METRIC_NORMAL_MEAN,
                                      GW_METRIC_SILHOUETTE_MEAN};
    double before[4] = {0, 0, 0, 0};
    (void)state;
    take(&camera, &all, &reference);
    for (int k = 0; k < 5; ++k) {
        const double tau = k == 0 ? 0 : 0.5 * (1 << (k - 1));
        const gw_metrics m = error_of_tau(tau);
        print_message("# tau %g: hits %.4f, depth %.3f px (95 %%: %.3f, bias %+.3f), normal %.2f deg, "
                      "silhouette %.2f px\n",
                      tau, m.values[GW_METRIC_HIT_MISMATCH], m.values[GW_METRIC_DEPTH_MEAN],
                      m.values[GW_METRIC_DEPTH_95], m.values[GW_METRIC_DEPTH_BIAS],
                      m.values[GW_METRIC_NORMAL_MEAN], m.values[GW_METRIC_SILHOUETTE_MEAN]);
        for (int i = 0; i < 4; ++i) {
            const double here = m.values[shown[i]];
            if (k == 0 ? here > 0 : here < 0.95 * before[i])
                fail_msg("%s falls from %g to %g at tau %g", gw_metric_table[shown[i]].name, before[i], here,
                         tau);
            before[i] = here;
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(it_is_what_the_rays_meet),
                                       cmocka_unit_test(splits_and_samples_change_nothing),
                                       cmocka_unit_test(errors_grow_with_tau)};
    return cmocka_run_group_tests_name("geometry", tests, open_stage, close_stage);
}
