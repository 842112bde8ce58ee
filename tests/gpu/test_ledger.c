/* The ledger's guard: work and errors of the demo scene at some settings, against those recorded in
 * tests/data/ledger.csv. `make record-ledger` records them anew, after a change that was meant. */
#include "tests/support/check.h"

#include "build/demo_scene.h"
#include "render/frame_block.h"
#include "tests/support/ledger_guard.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 48, PIXELS = SIDE * SIDE };
static const char recorded_path[] = "tests/data/ledger.csv";

typedef struct drawn {
    uint8_t *rgba;
    uint32_t ids[PIXELS];
    float depths[PIXELS], normals[PIXELS * 3];
} drawn;

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera camera;
static drawn exact, coarse;
static gw_guard_table measured;
static char text[GW_GUARD_TEXT];

enum { VALUES = 3 };
/* 16 rays a pixel on both sides: aliasing would hide what knobs do. */
static const struct {
    const char *knob;
    double values[VALUES];
} sweeps[] = {
    {"tau_inside", {1, 2, 4}}, {"tau", {1, 2, 4}}, {"acuity_slope", {0.05, 0.2, 0.4}}, {"strain", {2, 4, 8}}};

static gw_camera camera_of(const char *knob, double value) {
    gw_camera one = camera;
    gw_frame_state *s = &one.state;
    if (!strcmp(knob, "tau_inside"))
        s->tau_inside = (float)value, s->gaze_count = 0;
    else if (!strcmp(knob, "tau"))
        s->tau = (float)value;
    else if (!strcmp(knob, "acuity_slope"))
        s->acuity_slope = (float)value;
    else
        s->strain = (float)value;
    return one;
}

static void draw(const gw_camera *from, drawn *out, gw_counters *counters) {
    const gw_rectangle all = {0, 0, SIDE, SIDE};
    const gw_geometry geometry = {out->ids, out->depths, out->normals};
    free(out->rgba);
    out->rgba = gw_camera_take(from, renderer, counters);
    check_ok(gw_renderer_geometry(renderer, &from->placement, &from->plane, &all, &from->state, &geometry,
                                  &error));
}

static gw_guard_row measure(const char *knob, double value) {
    const gw_camera one = camera_of(knob, value);
    gw_camera viewer = one;
    gw_counters counters = {0};
    gw_frame_block block;
    gw_metrics metrics;
    draw(&one, &coarse, &counters);
    viewer.state.strain = 1;
    check_ok(gw_frame_block_fill(stage.scene, stage.octree, &viewer.placement, &viewer.plane, &viewer.state,
                                 &block, NULL, &error));
    const gw_image pictures[2] = {{SIDE, SIDE, exact.rgba}, {SIDE, SIDE, coarse.rgba}};
    const gw_metric_frame reference = {SIDE,      SIDE,         &pictures[0], NULL,
                                       exact.ids, exact.depths, exact.normals},
                          test = {SIDE, SIDE, &pictures[1], NULL, coarse.ids, coarse.depths, coarse.normals};
    /* Denser than the camera sees them, where FLIP would have nothing to blur. */
    const gw_metric_view view = {.pixels_per_degree = 12, .block = &block};
    check_ok(gw_metrics_compare(&reference, &test, &view, &metrics, &error));
    return gw_guard_row_of(knob, value, &counters, &metrics);
}

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL,
                           (const char *const[]){"octree_depth=8", "acuity_slope=0.1", "gaze_margin=2",
                                                 "samples=16", "tau=1", NULL},
                           &error));
    gw_renderer_options counting = {.count = 1};
    renderer = gw_stage_renderer_with(&stage, &counting);
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    gw_camera_look(&camera, &stage, view->eye, view->look_at, 60, SIDE);
    gw_camera_gaze(&camera, 20, 28, 4);
    gw_camera sharp = camera_of("tau_inside", 0);
    sharp.state.tau = 0;
    draw(&sharp, &exact, NULL);
    for (size_t k = 0; k < sizeof sweeps / sizeof *sweeps; k++)
        for (size_t v = 0; v < VALUES; v++)
            measured.rows[measured.count++] = measure(sweeps[k].knob, sweeps[k].values[v]);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    free(exact.rgba);
    free(coarse.rgba);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static void work_and_errors_are_those_recorded(void **state) {
    static gw_guard_table recorded;
    (void)state;
    if (getenv("GW_RECORD_LEDGER")) {
        char remark[320];
        const gw_gl_limits *limits = gw_gl_limits_of(stage.device);
        snprintf(remark, sizeof remark, "recorded by `make record-ledger` on %s", limits->renderer);
        FILE *file = fopen(recorded_path, "w");
        assert_non_null(file);
        gw_guard_write(file, &measured, remark);
        assert_int_equal(fclose(file), 0);
    }
    check_ok(gw_guard_load(recorded_path, &recorded, &error));
    const size_t faults = gw_guard_compare(&recorded, &measured, text);
    if (faults)
        fail_msg("%zu numbers are not those of %s: %s; if that was meant, `make record-ledger`", faults,
                 recorded_path, text);
    if (gw_guard_fronts(&recorded, &measured, text))
        fail_msg("%s", text);
}

static void errors_grow_with_coarseness(void **state) {
    (void)state;
    if (gw_guard_monotone(&measured, text))
        fail_msg("%s", text);
    for (size_t i = 0; i < measured.count; i++)
        print_message("# %s=%g: %.0f loads, FLIP %.4f, seen %.4f, bias %+.5f\n", measured.rows[i].knob,
                      measured.rows[i].value, measured.rows[i].numbers[2],
                      measured.rows[i].numbers[GW_GUARD_FLIP], measured.rows[i].numbers[GW_GUARD_FLIP + 1],
                      measured.rows[i].numbers[GW_GUARD_NUMBERS - 1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(work_and_errors_are_those_recorded),
                                       cmocka_unit_test(errors_grow_with_coarseness)};
    return cmocka_run_group_tests_name("ledger", tests, open_stage, close_stage);
}
