/* The predicted error against a direct computation in wall millimetres, and against the squares that are
 * drawn. */
#include "tests/support/check.h"

#include "base/srgb.h"
#include "build/demo_scene.h"
#include "build/gpu_types.h"
#include "render/predicted_error.h"
#include "tests/support/renders.h"
#include "tests/support/sample_lists.h"

#include <math.h>

enum { SIDE = 160 };
static const double HALF_ANGLE = 5, DEGREES = 57.29577951308232;

static gw_stage stage;
static gw_renderer *renderer;
static gw_camera camera; /* acuity that falls so fast that all squares occur in a small picture */

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(
        &stage, scene, NULL,
        (const char *const[]){"octree_depth=7", "acuity_slope=0.15", "gaze_margin=4", "sample_block=4", NULL},
        &error));
    renderer = gw_stage_renderer(&stage);
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    gw_camera_look(&camera, &stage, view->eye, view->look_at, 60, SIDE);
    gw_camera_gaze(&camera, 30, 40, HALF_ANGLE);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

typedef struct seen {
    double outside; /* deg beyond the ellipse, here a circle */
    double spacing; /* px that the viewer resolves */
} seen;

/* From the wall's millimetres, the eye's and the formulas of docs/rendering.md. */
static seen look(const gw_frame_state *s, double slope, double margin, double x, double y) {
    double towards[3], direction[3], widest = 0;
    for (int i = 0; i < 3; i++) {
        towards[i] =
            camera.plane.corner[i] + x * camera.plane.step_x[i] + y * camera.plane.step_y[i] - s->eye[i];
        direction[i] = (double)s->gazes[0].direction[i];
    }
    const double distance = sqrt(dot(towards, towards));
    const double angle = acos(dot(towards, direction) / distance / sqrt(dot(direction, direction))) * DEGREES;
    const double *steps[2] = {camera.plane.step_x, camera.plane.step_y};
    for (int axis = 0; axis < 2; axis++) {
        const double along = dot(steps[axis], towards) / distance;
        widest = fmax(widest, sqrt(dot(steps[axis], steps[axis]) - along * along));
    }
    const double period = 1.0 / 48 + slope * fmax(0, angle - HALF_ANGLE - margin);
    return (seen){angle - HALF_ANGLE, fmin(period / 2 / DEGREES, 1) * distance / widest};
}

static double direct_side(const gw_frame_state *s, double x, double y) {
    static const int corners[5][2] = {{0, 0}, {8, 0}, {0, 8}, {8, 8}, {4, 4}};
    const double slope = (double)s->acuity_slope * (double)s->strain,
                 margin = (double)s->gaze_margin / (double)s->strain;
    const int most = 4 * (s->strain >= 2 ? 2 : 1) * (s->strain >= 4 ? 2 : 1);
    double least[4] = {1e9, 1e9, 1e9, 1e9}, own = 1e9, all;
    for (int block = 0; block < 4; block++) /* of the square of 16 pixels */
        for (int i = 0; i < 5; i++) {
            const double at[2] = {floor(x / 16) * 16 + 8 * (block & 1) + corners[i][0],
                                  floor(y / 16) * 16 + 8 * (block >> 1) + corners[i][1]};
            least[block] = fmin(least[block], look(s, slope, margin, at[0], at[1]).spacing);
        }
    own = least[(fmod(x, 16) >= 8) + 2 * (fmod(y, 16) >= 8)];
    all = fmin(fmin(least[0], least[1]), fmin(least[2], least[3]));
    return all >= 16 && most >= 16 ? 16 : own >= 8 && most >= 8 ? 8 : own >= 4 ? 4 : own >= 2 ? 2 : 1;
}

static double direct_error(const gw_frame_state *s, double x, double y) {
    const double strain = (double)s->strain;
    const double limit = fmax(1, look(s, (double)s->acuity_slope, (double)s->gaze_margin, x, y).spacing);
    const seen drawn = look(s, (double)s->acuity_slope * strain, (double)s->gaze_margin / strain, x, y);
    const double side = direct_side(s, x, y), ramp = fmin(fmax(drawn.outside / (double)s->gaze_blend, 0), 1);
    const double tau = (double)s->tau * pow(strain, 0.25) * ramp * ramp * (3 - 2 * ramp);
    return fmax(1, fmax(side, tau * fmax(1, (double)s->gaze_footprint * drawn.spacing)) / limit);
}

static void it_is_what_the_formula_says(void **state) {
    static const float strains[] = {1, 1.5f, 2, 4, 16};
    (void)state;
    double before = 0;
    for (size_t k = 0; k < sizeof strains / sizeof strains[0]; k++) {
        gw_camera strained = camera;
        strained.state.gaze_footprint = k == 3 ? 1 : 0.5f;
        const gw_rectangle all = {0, 0, SIDE, SIDE};
        gw_predicted_error sum = {0};
        strained.state.strain = strains[k];
        check_ok(gw_predict_error(stage.scene, stage.octree, &strained.placement, &strained.plane, &all,
                                  &strained.state, &sum, &error));
        double worst = 0, mean = 0;
        for (int y = 16; y < SIDE; y += 32)
            for (int x = 16; x < SIDE; x += 32) {
                const double here = direct_error(&strained.state, x, y);
                worst = fmax(worst, here);
                mean += here / (SIDE / 32 * (SIDE / 32));
            }
        print_message("# strain %g: error %.3f at worst, %.3f on average\n", (double)strains[k], sum.worst,
                      gw_predicted_error_mean(&sum));
        assert_int_equal(sum.places, SIDE / 32 * (SIDE / 32));
        assert_true(fabs(sum.worst - worst) < 1e-3 * worst);
        assert_true(fabs(gw_predicted_error_mean(&sum) - mean) < 1e-3 * mean);
        assert_true(k > 0 || sum.worst == 1); /* nothing that a viewer could resolve is missing */
        assert_true(sum.sum > before);
        before = sum.sum;
    }
}

/* Distance on the wall, mm, from the circle about the gaze towards its centre, found by halving. */
static double distance_on_the_wall(const gw_frame_state *s, double x, double y) {
    static const double middle[2] = {30, 40};
    const double *steps[2] = {camera.plane.step_x, camera.plane.step_y};
    double inside = 0, outside = 1, far[3];
    if (look(s, 0, 0, x, y).outside <= 0)
        return 0;
    for (int step = 0; step < 60; ++step) {
        const double half = (inside + outside) / 2;
        if (look(s, 0, 0, middle[0] + half * (x - middle[0]), middle[1] + half * (y - middle[1])).outside <=
            0)
            inside = half;
        else
            outside = half;
    }
    for (int i = 0; i < 3; i++)
        far[i] = (x - middle[0]) * steps[0][i] + (y - middle[1]) * steps[1][i];
    return (1 - inside) * sqrt(dot(far, far));
}

/* The rule of Weier et al. knows nothing of what eyes resolve: the error by acuity says how wrong it is. */
static void the_seed_rule_is_told(void **state) {
    static const double distances[] = {1e6, 400, 40};
    const gw_rectangle all = {0, 0, SIDE, SIDE};
    gw_predicted_error by_acuity = {0};
    (void)state;
    check_ok(gw_predict_error(stage.scene, stage.octree, &camera.placement, &camera.plane, &all,
                              &camera.state, &by_acuity, &error));
    for (int k = 0; k < 6; k++) {
        gw_camera ruled = camera;
        gw_frame_state *s = &ruled.state;
        gw_predicted_error sum = {0};
        s->gaze_rule = GW_GAZE_SEED;
        s->seed_distance = (float)distances[k % 3];
        s->tau = k < 3 ? 1 : 0;
        s->samples = k < 3 ? 2 : 0; /* four rays a pixel */
        check_ok(gw_predict_error(stage.scene, stage.octree, &ruled.placement, &ruled.plane, &all, s, &sum,
                                  &error));
        double worst = 0, mean = 0;
        for (int y = 16; y < SIDE; y += 32)
            for (int x = 16; x < SIDE; x += 32) {
                const double limit =
                    fmax(1, look(s, (double)s->acuity_slope, (double)s->gaze_margin, x, y).spacing);
                const double levels = log2(1 + distance_on_the_wall(s, x, y) / distances[k % 3]);
                const double blur = exp2(fmin(fmax(2 * levels - 1, 0), 1)),
                             voxel = k < 3 ? exp2(levels) / 2 : 0;
                const double here = fmax(1, fmax(blur > 1 ? blur : 0, voxel) / limit);
                worst = fmax(worst, here);
                mean += here / (SIDE / 32 * (SIDE / 32));
            }
        print_message("# seed_distance %g mm, tau %g: error %.3f at worst, %.3f on average\n",
                      distances[k % 3], (double)s->tau, sum.worst, gw_predicted_error_mean(&sum));
        assert_true(fabs(sum.worst - worst) < 1e-3 * worst);
        assert_true(fabs(gw_predicted_error_mean(&sum) - mean) < 1e-3 * mean);
        assert_true(k % 3 > 0 || sum.worst == 1);
        assert_true(k != 2 || sum.worst > 2 * by_acuity.worst);
    }
}

/* Without a gaze all is sharp however strained, and tau where nobody looks away from it is told. */
static void special_cases(void **state) {
    const gw_rectangle all = {0, 0, SIDE, SIDE};
    gw_camera strained = camera;
    gw_predicted_error blind = {0}, coarse = {0}, fine = {0};
    (void)state;
    strained.state.strain = 8;
    strained.state.gaze_count = 0;
    check_ok(gw_predict_error(stage.scene, stage.octree, &strained.placement, &strained.plane, &all,
                              &strained.state, &blind, &error));
    assert_true(blind.worst == 1);
    strained.state.tau_inside = 3;
    check_ok(gw_predict_error(stage.scene, stage.octree, &strained.placement, &strained.plane, &all,
                              &strained.state, &coarse, &error));
    assert_true(fabs(coarse.worst - 3) < 1e-6);
    strained.state.samples = 2;
    strained.state.geometry = GW_GEOMETRY_TRIANGLES;
    check_ok(gw_predict_error(stage.scene, stage.octree, &strained.placement, &strained.plane, &all,
                              &strained.state, &fine, &error));
    assert_true(fine.worst == 1);
}

/* Places belong to the wall: cut in any way, they are the same and add up. */
static void splits_add_up(void **state) {
    static const gw_rectangle parts[3] = {{-70, -40, 107, 300}, {37, -40, 123, 56}, {37, 16, 123, 244}};
    const gw_rectangle all = {-70, -40, 230, 300};
    gw_camera strained = camera;
    gw_predicted_error whole = {0}, sum = {0};
    (void)state;
    strained.state.strain = 3;
    check_ok(gw_predict_error(stage.scene, stage.octree, &strained.placement, &strained.plane, &all,
                              &strained.state, &whole, &error));
    for (int i = 0; i < 3; i++)
        check_ok(gw_predict_error(stage.scene, stage.octree, &strained.placement, &strained.plane, &parts[i],
                                  &strained.state, &sum, &error));
    assert_int_equal(sum.places, whole.places);
    assert_true(sum.worst == whole.worst && fabs(sum.sum - whole.sum) < 1e-9 * whole.sum);
}

/* What a map shows at a pixel beside half of the picture, as a colour of shaders/shade/debug_view.glsl; how
 * far it is from that of c. */
static double colour_error(const uint8_t *map, const uint8_t *picture, size_t at, double c) {
    const double red = 2 * gw_srgb_code_to_linear(map[at]) - gw_srgb_code_to_linear(picture[at]),
                 blue = 2 * gw_srgb_code_to_linear(map[at + 2]) - gw_srgb_code_to_linear(picture[at + 2]);
    c = fmin(fmax(c, 0), 1);
    return fmax(fabs(red - fmin(fmax(3 * c - 1, 0), 1)), fabs(blue - fmin(fmax(1 - 2 * c, 0), 1)));
}

/* Squares and footprints as they are drawn, from the maps of rates and of footprints. */
static void they_are_those_that_are_drawn(void **state) {
    gw_camera plain = camera, rates = camera, footprints = camera;
    size_t compared = 0, other[2] = {0}, kinds[5] = {0};
    (void)state;
    plain.state.strain = rates.state.strain = footprints.state.strain = 4;
    rates.state.debug = GW_DEBUG_RATES;
    footprints.state.debug = GW_DEBUG_FOOTPRINT;
    uint8_t *picture = gw_camera_take(&plain, renderer, NULL),
            *sides = gw_camera_take(&rates, renderer, NULL),
            *widths = gw_camera_take(&footprints, renderer, NULL);
    const gw_frame_state *s = &plain.state;
    for (int y = 4; y < SIDE; y += 16)
        for (int x = 4; x < SIDE; x += 16) {
            const size_t at = ((size_t)y * SIDE + (size_t)x) * 4;
            const double side = direct_side(s, x, y);
            const double spacing =
                look(s, (double)s->acuity_slope * 4, (double)s->gaze_margin / 4, x, y).spacing;
            const double width = fmax(side, (double)s->gaze_footprint * spacing);
            compared++;
            kinds[(int)log2(side)]++;
            other[0] += colour_error(sides, picture, at, 1 - log2(side) / 3) > 0.15;
            other[1] += colour_error(widths, picture, at, 1 - log2(width) / 4) > 0.15;
        }
    print_message("# %zu places, %zu and %zu blended with others; of side 1 to 16: %zu %zu %zu %zu %zu\n",
                  compared, other[0], other[1], kinds[0], kinds[1], kinds[2], kinds[3], kinds[4]);
    assert_true(other[0] * 10 < compared && other[1] * 10 < compared);
    assert_true(kinds[0] > 0 && kinds[1] > 0 && kinds[2] > 0 && kinds[3] > 0);
    free(picture);
    free(sides);
    free(widths);
}

/* A strained state draws what the settings that it stands for draw. */
static void strain_is_its_settings(void **state) {
    gw_camera strained = camera, settled = camera;
    gw_counters few = {0}, many = {0};
    (void)state;
    strained.state.strain = 5;
    settled.state = gw_frame_state_in_force(&strained.state);
    uint8_t *a = gw_camera_take(&strained, renderer, &few), *b = gw_camera_take(&settled, renderer, NULL),
            *sharp = gw_camera_take(&camera, renderer, &many);
    assert_memory_equal(a, b, (size_t)SIDE * SIDE * 4);
    assert_memory_not_equal(a, sharp, (size_t)SIDE * SIDE * 4);
    assert_true(few.rays < many.rays / 2);
    free(a);
    free(b);
    free(sharp);
}

/* --- what a frame really has ------------------------------------------------------------------------------
 */

typedef struct measured {
    double worst, mean;
} measured;

static uint32_t level_of(uint32_t node) {
    uint32_t level = 0;
    while (level < stage.octree->depth && node >= stage.octree->level_begin[level + 1])
        level++;
    return level;
}

/* Cell of what the ray met, in pixels as wide as they are there; 0 for triangles. */
static double cell_in_pixels(const gw_camera *from, uint32_t id, double depth, double x, double y) {
    double towards[3], widest = 0;
    if (id == GW_NO_TRIANGLE || !(id & 0x80000000u))
        return 0;
    for (int i = 0; i < 3; i++)
        towards[i] = from->plane.corner[i] + x * from->plane.step_x[i] + y * from->plane.step_y[i] -
                     from->state.eye[i];
    const double distance = sqrt(dot(towards, towards));
    const double *steps[2] = {from->plane.step_x, from->plane.step_y};
    for (int axis = 0; axis < 2; axis++) {
        const double along = dot(steps[axis], towards) / distance;
        widest = fmax(widest, sqrt(dot(steps[axis], steps[axis]) - along * along));
    }
    const double side =
        ldexp(from->placement.scale, stage.scene->exponent + 1 - (int)level_of(id & 0x7fffffffu));
    return side / (widest * depth / distance);
}

/* The voxels that rays met and the squares that were listed, against what the viewer resolves. */
static measured measure(const gw_camera *from) {
    const gw_frame_state drawn = gw_frame_state_in_force(&from->state);
    const gw_rectangle all = {0, 0, SIDE, SIDE};
    static uint32_t ids[SIDE * SIDE];
    static float depths[SIDE * SIDE];
    const gw_geometry geometry = {.ids = ids, .depths = depths};
    gw_sample_list list = {0};
    measured out = {0, 0};
    check_ok(gw_renderer_geometry(renderer, &from->placement, &from->plane, &all, &from->state, &geometry,
                                  &error));
    const int sparse = drawn.gaze_count > 0 && drawn.sample_block > 0 && drawn.gaze_rule == GW_GAZE_ACUITY;
    if (sparse)
        list = gw_sample_list_take(from, renderer, all);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int row = i / SIDE, column = i % SIDE;
        const double x = column + 0.5, y = row + 0.5;
        const double limit = from->state.gaze_count
                                 ? fmax(1, look(&from->state, (double)from->state.acuity_slope,
                                                (double)from->state.gaze_margin, x, y)
                                               .spacing)
                                 : 1;
        const double side =
            sparse ? (double)(1u << GW_BLOCK_RATE(gw_sample_list_block(&list, column / 8, row / 8))) : 1;
        const double here =
            fmax(1, fmax(side, cell_in_pixels(from, ids[i], (double)depths[i], x, y)) / limit);
        out.worst = fmax(out.worst, here);
        out.mean += here / (SIDE * SIDE);
    }
    if (sparse)
        gw_sample_list_finish(&list);
    return out;
}

/* Knobs that the model knows. The last one looks through a tube: what would be voxels of 4 pixels are less
 * than the octree's smallest cells there, so all is triangles, which the model must know, too. */
static void it_is_within_a_factor_of_two_of_the_frame(void **state) {
    enum { TAU, TAU_INSIDE, STRAIN, SEED_DISTANCE, FAR };
    static const struct {
        const char *knob;
        int which;
        double value, least; /* of the worst error: so that the test has something to compare */
    } points[] = {{"tau", TAU, 2, 1.5},
                  {"tau", TAU, 8, 6},
                  {"tau_inside", TAU_INSIDE, 4, 3},
                  {"strain", STRAIN, 2, 1.5},
                  {"strain", STRAIN, 16, 12},
                  {"seed_distance", SEED_DISTANCE, 100, 2},
                  {"tau_inside of far things", FAR, 4, 1}};
    const gw_viewpoint *view = &stage.scene->viewpoints[0];
    const gw_rectangle all = {0, 0, SIDE, SIDE};
    (void)state;
    for (size_t k = 0; k < sizeof points / sizeof *points; k++) {
        gw_camera one = camera;
        gw_frame_state *s = &one.state;
        const float value = (float)points[k].value;
        gw_predicted_error told = {0};
        if (points[k].which == FAR)
            gw_camera_look(&one, &stage, view->eye, view->look_at, 5, SIDE);
        if (points[k].which == TAU)
            s->tau = value;
        if (points[k].which == STRAIN)
            s->strain = value;
        if (points[k].which == SEED_DISTANCE)
            s->seed_distance = value, s->gaze_rule = GW_GAZE_SEED;
        if (points[k].which == TAU_INSIDE || points[k].which == FAR)
            s->tau_inside = value, s->gaze_count = 0;
        check_ok(
            gw_predict_error(stage.scene, stage.octree, &one.placement, &one.plane, &all, s, &told, &error));
        const measured is = measure(&one);
        const double worst = is.worst / told.worst, mean = is.mean / gw_predicted_error_mean(&told);
        print_message("# %s %g: worst %.2f, measured %.2f; mean %.2f, measured %.2f\n", points[k].knob,
                      (double)value, told.worst, is.worst, gw_predicted_error_mean(&told), is.mean);
        assert_true(is.worst >= points[k].least);
        assert_true(worst > 0.5 && worst < 2 && mean > 0.5 && mean < 2);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_what_the_formula_says),
        cmocka_unit_test(the_seed_rule_is_told),
        cmocka_unit_test(special_cases),
        cmocka_unit_test(splits_add_up),
        cmocka_unit_test(they_are_those_that_are_drawn),
        cmocka_unit_test(strain_is_its_settings),
        cmocka_unit_test(it_is_within_a_factor_of_two_of_the_frame),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
