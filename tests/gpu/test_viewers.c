/* Viewers from track to pixels: several, off the wall, late, unsure, unusable; and the sharp region over the
 * borders of tiles: on one plane, with bezels between, and on planes at an angle. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/srgb.h"
#include "build/demo_scene.h"
#include "render/sparse.h"
#include "tests/support/renders.h"
#include "tests/support/tracks.h"
#include "wall/frames.h"
#include "wall/site.h"

#include <math.h>
#include <unistd.h>

enum { WIDE = 160, HIGH = 96, PIXELS = WIDE * HIGH };
static const int64_t second = 1000000000;
static const double DEGREES = 57.29577951308232, PITCH = 10; /* mm a pixel */

static gw_stage stage;
static gw_renderer *renderer;
static gw_similarity placement; /* behind a wall of WIDE x HIGH pixels */
static const gw_plane wall = {{-PITCH * WIDE / 2, PITCH *HIGH / 2, 0}, {PITCH, 0, 0}, {0, -PITCH, 0}};
static const double neutral[3] = {0, 0, 1000};

static int open_stage(void **state) {
    gw_scene *scene = NULL;
    (void)state;
    check_ok(gw_demo_scene(&scene, &error));
    check_ok(gw_stage_open(&stage, scene, NULL,
                           (const char *const[]){"octree_depth=7", "acuity_slope=0.2", "gaze_margin=1",
                                                 "gaze_half_width=7", "gaze_half_height=5", NULL},
                           &error));
    renderer = gw_stage_renderer(&stage);
    check_ok(gw_place_scene(stage.scene, PITCH * WIDE, PITCH * HIGH, (const double[3]){0, 0, 0}, neutral,
                            &placement, &error));
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

static uint8_t *draw(const gw_plane *plane, const gw_rectangle *r, const gw_frame_state *state,
                     gw_counters *counters) {
    uint8_t *rgba = calloc((size_t)r->width * r->height, 4);
    assert_non_null(rgba);
    check_ok(gw_renderer_frame(renderer, &placement, plane, r, state, rgba, counters, &error));
    return rgba;
}

static uint8_t *picture(const gw_frame_state *state, gw_counters *counters) {
    const gw_rectangle all = {0, 0, WIDE, HIGH};
    return draw(&wall, &all, state, counters);
}

/* A pose of a viewer's sensor; a gaze is turned towards a point from where the viewer's head is. */
static test_pose pose(int sensor, int64_t time, const double eye[3], const double *point) {
    test_pose report = {
        .time = time, .sensor = sensor, .position = {eye[0], eye[1], eye[2]}, .orientation = {0, 0, 0, 1}};
    if (point) { /* the shortest turn of (0,0,-1) */
        double d[3], length = 0;
        for (int i = 0; i < 3; i++)
            d[i] = point[i] - eye[i];
        length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        report.orientation[0] = d[1];
        report.orientation[1] = -d[0];
        report.orientation[2] = 0;
        report.orientation[3] = length - d[2];
    }
    return report;
}

/* The state that a track says at a time. */
static gw_frame_state state_of(test_pose *reports, size_t count, int64_t time) {
    gw_recording *read = recording_of(reports, count);
    gw_frame_state state;
    gw_frame_begin(&state, 0, &stage.settings, 0, GW_DEBUG_NONE);
    const gw_tracker_view view = view_of_recording(read, time, neutral, &stage.settings);
    gw_frame_look(&state, &view, &stage.settings);
    gw_recording_destroy(&read);
    return state;
}

static const double eyes[2][3] = {{-200, 30, 1000}, {350, -20, 1300}};
static const double points[2][3] = {{-400, 150, 0}, {500, -200, 0}};

/* The first reports of both viewers, and the last of all when the second one's sensors have long been silent.
 */
static gw_frame_state two_viewers(int64_t time) {
    test_pose reports[6] = {pose(0, 0, eyes[0], NULL),      pose(1, 0, eyes[0], points[0]),
                            pose(2, 0, eyes[1], NULL),      pose(3, 0, eyes[1], points[1]),
                            pose(0, second, eyes[0], NULL), pose(1, second, eyes[0], points[0])};
    reports[4].time = reports[5].time = time > 0 ? time : second;
    return state_of(reports, 6, time);
}

static gw_frame_state one_viewer(int which) {
    test_pose reports[2] = {pose(0, 0, eyes[which], NULL), pose(1, 0, eyes[which], points[which])};
    gw_frame_state state = state_of(reports, 2, 0);
    for (int i = 0; i < 3; i++)
        state.eye[i] = eyes[0][i];
    return state;
}

static gw_frame_state nobody(void) {
    gw_frame_state state = one_viewer(0);
    memset(state.gazes, 0, sizeof state.gazes);
    state.gaze_count = 0;
    return state;
}

/* Degrees that a pixel of a plane lies outside a gaze's ellipse, directly from millimetres. */
static double outside(const gw_plane *plane, const gw_gaze *gaze, const gw_settings *settings, double x,
                      double y) {
    double towards[3], right[3], across = 0, up = 0, forward = 0;
    for (int i = 0; i < 3; i++)
        towards[i] = plane->corner[i] + (x + 0.5) * plane->step_x[i] + (y + 0.5) * plane->step_y[i] -
                     (double)gaze->eye[i];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        right[i] = (double)gaze->direction[j] * (double)gaze->up[k] -
                   (double)gaze->direction[k] * (double)gaze->up[j];
    }
    for (int i = 0; i < 3; i++) {
        across += towards[i] * right[i];
        up += towards[i] * (double)gaze->up[i];
        forward += towards[i] * (double)gaze->direction[i];
    }
    const double w = across / settings->gaze_half_width, h = up / settings->gaze_half_height;
    const double radius = sqrt(across * across + up * up), spread = sqrt(w * w + h * h);
    return atan2(radius, forward) * DEGREES - (spread > 0 ? radius / spread : 0);
}

/* Pixels of the wall inside one of the state's ellipses, and whether all of them equal the picture that is
 * sharp all over. */
static size_t sharp_pixels(const gw_frame_state *state, const uint8_t *rgba, const uint8_t *sharp) {
    size_t inside = 0;
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++)
            for (uint32_t i = 0; i < state->gaze_count; i++) {
                const size_t at = ((size_t)y * WIDE + (size_t)x) * 4;
                if (outside(&wall, &state->gazes[i], &stage.settings, x, y) > -0.01)
                    continue;
                assert_memory_equal(rgba + at, sharp + at, 4);
                inside++;
            }
    return inside;
}

/* Sensors 2 and 3 are a second viewer: sharp where either looks, drawn for the first one's eye. */
static void both_viewers_of_a_track_see_sharp(void **unused) {
    (void)unused;
    gw_frame_state both = two_viewers(0), first = one_viewer(0), second_one = one_viewer(1), none = nobody();
    gw_counters two = {0}, one = {0}, all = {0};
    assert_int_equal(both.gaze_count, 2);
    for (int i = 0; i < 3; i++) {
        assert_true(both.eye[i] == eyes[0][i]);
        assert_true(fabs((double)both.gazes[1].eye[i] - eyes[1][i]) < 1e-3);
    }
    assert_memory_equal(&both.gazes[1], &second_one.gazes[0], sizeof(gw_gaze));
    uint8_t *shown = picture(&both, &two), *alone = picture(&first, &one), *sharp = picture(&none, &all);
    const size_t inside = sharp_pixels(&both, shown, sharp), inside_one = sharp_pixels(&first, alone, sharp);
    assert_true(inside_one > 100 && inside > inside_one + 100);
    assert_true(one.rays < two.rays && two.rays < all.rays);
    assert_memory_not_equal(shown, sharp, PIXELS * 4);
    /* Every place has the rate of whom it is sharper for. */
    gw_frame_block blocks[3];
    const gw_frame_state *states[3] = {&both, &first, &second_one};
    for (int i = 0; i < 3; i++)
        check_ok(gw_frame_block_fill(stage.scene, stage.octree, &placement, &wall, states[i], &blocks[i],
                                     NULL, &error));
    for (int y = 0; y < HIGH; y += 8)
        for (int x = 0; x < WIDE; x += 8)
            assert_true(gw_sparse_spacing(&blocks[0], x, y) ==
                        fmin(gw_sparse_spacing(&blocks[1], x, y), gw_sparse_spacing(&blocks[2], x, y)));
    free(shown);
    free(alone);
    free(sharp);
}

/* A viewer who looks away from the wall leaves it coarse, and takes nothing from another. */
static void a_gaze_off_the_wall_is_coarse(void **unused) {
    const double behind[3] = {-900, 400, 5000};
    test_pose reports[4] = {pose(0, 0, eyes[0], NULL), pose(1, 0, eyes[0], behind), pose(2, 0, eyes[1], NULL),
                            pose(3, 0, eyes[1], points[1])};
    (void)unused;
    gw_frame_state away = state_of(reports, 2, 0), with_other = state_of(reports, 4, 0),
                   other = one_viewer(1), none = nobody();
    gw_counters few = {0}, usual = {0};
    assert_int_equal(away.gaze_count, 1);
    uint8_t *coarse = picture(&away, &few), *shared = picture(&with_other, NULL),
            *alone = picture(&other, &usual), *sharp = picture(&none, NULL);
    assert_int_equal(few.nan_pixels + few.step_cap_hits, 0);
    assert_true(few.rays * 2 < usual.rays);
    assert_true(sharp_pixels(&other, shared, sharp) > 100);
    assert_memory_equal(shared, alone, PIXELS * 4);
    free(coarse);
    free(shared);
    free(alone);
    free(sharp);
}

/* An old gaze widens its ellipse by gaze_growth; one without confidence is nobody's, and then all is sharp.
 */
static void a_late_gaze_grows_until_it_is_nobodys(void **unused) {
    (void)unused;
    gw_frame_state fresh = two_viewers(0), late = two_viewers(second / 5), gone = two_viewers(second),
                   none = nobody();
    assert_int_equal(late.gaze_count, 2);
    assert_true(fabs((double)late.gazes[1].age - 0.2) < 1e-6);
    assert_true(late.gazes[1].confidence > 0 && late.gazes[1].confidence < 1 &&
                late.gazes[0].confidence == 1);
    uint8_t *before = picture(&fresh, NULL), *wider = picture(&late, NULL), *sharp = picture(&none, NULL);
    /* 300 degrees a second beyond 0.05 s, at most 15. */
    gw_settings grown = stage.settings;
    grown.gaze_half_width += 15;
    grown.gaze_half_height += 15;
    size_t inside = 0, blunt = 0;
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++) {
            const size_t at = ((size_t)y * WIDE + (size_t)x) * 4;
            if (outside(&wall, &late.gazes[1], &grown, x, y) > -0.01)
                continue;
            assert_memory_equal(wider + at, sharp + at, 4);
            blunt += memcmp(before + at, sharp + at, 4) != 0;
            inside++;
        }
    assert_true(inside > 1000 && blunt > inside / 20);
    assert_int_equal(gone.gaze_count, 1); /* half a second without a word */
    gw_frame_state first = one_viewer(0);
    uint8_t *left = picture(&gone, NULL), *alone = picture(&first, NULL);
    assert_memory_equal(left, alone, PIXELS * 4);
    test_pose reports[4] = {pose(0, 0, eyes[0], NULL), pose(1, 0, eyes[0], points[0]),
                            pose(0, second, eyes[0], NULL), pose(2, second, eyes[1], NULL)};
    gw_frame_state silent = state_of(reports, 4, second);
    assert_int_equal(silent.gaze_count, 0);
    uint8_t *full = picture(&silent, NULL);
    assert_memory_equal(full, sharp, PIXELS * 4);
    free(before);
    free(wider);
    free(sharp);
    free(left);
    free(alone);
    free(full);
}

/* What is no gaze is left out: the others count as if it were not there, and without any all is sharp. */
static void what_is_no_gaze_counts_for_nobody(void **unused) {
    (void)unused;
    gw_frame_state first = one_viewer(0), none = nobody();
    uint8_t *alone = picture(&first, NULL), *sharp = picture(&none, NULL);
    for (int kind = 0; kind < 5; kind++) {
        gw_frame_state broken = two_viewers(0), only = one_viewer(0);
        gw_gaze *gazes[2] = {&broken.gazes[1], &only.gazes[0]};
        for (int i = 0; i < 2; i++) {
            if (kind == 0)
                gazes[i]->direction[1] = NAN;
            else if (kind == 1)
                gazes[i]->eye[2] = INFINITY;
            else if (kind == 2)
                memset(gazes[i]->direction, 0, sizeof gazes[i]->direction);
            else if (kind == 3)
                gazes[i]->confidence = 0;
            else
                gazes[i]->age = NAN;
        }
        uint8_t *rest = picture(&broken, NULL), *full = picture(&only, NULL);
        assert_memory_equal(rest, alone, PIXELS * 4);
        assert_memory_equal(full, sharp, PIXELS * 4);
        free(rest);
        free(full);
    }
    free(alone);
    free(sharp);
}

static gw_frame_state stare(const double point[3]) {
    gw_frame_state state;
    gw_frame_begin(&state, 0, &stage.settings, 0, GW_DEBUG_NONE);
    gw_frame_stare(&state, eyes[0], point, &stage.settings);
    return state;
}

/* Four tiles whose corners meet where somebody looks have one plane's pixels. */
static void a_gaze_on_a_seam_of_one_plane(void **unused) {
    static const gw_rectangle tiles[4] = {
        {0, 0, 75, 41}, {75, 0, WIDE - 75, 41}, {0, 41, 75, HIGH - 41}, {75, 41, WIDE - 75, HIGH - 41}};
    const double seam[3] = {PITCH * (75 - WIDE / 2), PITCH * (HIGH / 2 - 41), 0};
    (void)unused;
    gw_frame_state state = stare(seam);
    uint8_t *whole = picture(&state, NULL);
    for (int tile = 0; tile < 4; tile++) {
        const gw_rectangle *r = &tiles[tile];
        uint8_t *part = draw(&wall, r, &state, NULL);
        for (uint32_t y = 0; y < r->height; y++)
            assert_memory_equal(part + (size_t)y * r->width * 4,
                                whole + (((size_t)r->y + y) * WIDE + (size_t)r->x) * 4, (size_t)r->width * 4);
        free(part);
    }
    free(whole);
}

/* A bezel of 8 pixels on every side: each tile shows what one great plane behind the bezels would, but for
 * the rounding of rays that are numbered anew. */
static void a_gaze_on_bezels(void **unused) {
    gw_grid grid = {.columns = 2,
                    .rows = 1,
                    .widths = {80, 80},
                    .heights = {HIGH},
                    .pitch = {PITCH, PITCH},
                    .left = 8 * PITCH,
                    .right = 8 * PITCH,
                    .eye = {0, 0, 1000}};
    gw_layout layout;
    (void)unused;
    check_ok(gw_layout_grid(&grid, &layout, &error));
    gw_frame_state state = stare((const double[3]){0, 60, 0});
    const gw_plane *great = &layout.tiles[0].plane;
    for (int tile = 0; tile < 2; tile++) {
        const gw_rectangle own = {0, 0, 80, HIGH}, same = {tile * 96, 0, 80, HIGH};
        uint8_t *shown = draw(&layout.tiles[tile].plane, &own, &state, NULL),
                *wanted = draw(great, &same, &state, NULL);
        size_t different = 0;
        for (size_t i = 0; i < (size_t)80 * HIGH; i++)
            for (int c = 0; c < 3; c++)
                if (abs(shown[4 * i + (size_t)c] - wanted[4 * i + (size_t)c]) > 3) {
                    different++;
                    break;
                }
        print_message("# tile %d: %zu of %d pixels differ by more than 3/255\n", tile, different, 80 * HIGH);
        assert_true(different <= 80 * HIGH / 200);
        free(shown);
        free(wanted);
    }
}

static double channel(const uint8_t *rgba, size_t pixel, int c) {
    return gw_srgb_code_to_linear(rgba[4 * pixel + (size_t)c]);
}

/* Two panels that meet at an angle of 110 degrees, and a gaze on their common edge: on each, tau begins to
 * rise where the true angle from the gaze says, and is full where it says. */
static void a_gaze_on_an_edge_of_two_planes(void **unused) {
    static const char text[] =
        "version: 1\neye: [-200, 30, 1000]\ntiles:\n"
        "  - {name: left, corners: [[-800, 480, 0], [0, 480, 0], [-800, -480, 0]],"
        " pixels: [80, 96], place: [0, 0]}\n"
        "  - {name: right, corners: [[0, 480, 0], [273.616, 480, 751.754], [0, -480, 0]],"
        " pixels: [80, 96], place: [80, 0]}\n";
    char path[512];
    gw_site site;
    const gw_layout *layout = &site.layout;
    (void)unused;
    check_ok(gw_file_write(scratch_path(path, "corner.yaml"), text, strlen(text), &error));
    check_ok(gw_site_load(path, &site, &error));
    unlink(path);
    gw_frame_state plain = stare((const double[3]){0, 40, 0});
    plain.sample_block = 0; /* a ray for each pixel, so that the map can be told from the picture */
    gw_frame_state map = plain;
    map.debug = GW_DEBUG_GAZE;
    for (int t = 0; t < 2; t++) {
        const gw_tile *tile = &layout->tiles[t];
        uint8_t *seen = draw(&tile->plane, &tile->rectangle, &plain, NULL),
                *shown = draw(&tile->plane, &tile->rectangle, &map, NULL);
        size_t kinds[2] = {0, 0};
        for (size_t i = 0; i < (size_t)80 * HIGH; i++) {
            const double away =
                outside(&tile->plane, &plain.gazes[0], &stage.settings, (double)(i % 80), (double)(i / 80));
            const int full = away > stage.settings.gaze_blend + 0.02;
            if (away > -0.02 && !full)
                continue;
            kinds[full]++;
            /* Half the picture, half blue where nothing is accepted and red where all is. */
            const double red = 2 * channel(shown, i, 0) - channel(seen, i, 0),
                         blue = 2 * channel(shown, i, 2) - channel(seen, i, 2);
            if (channel(seen, i, 0) > 0.99 || channel(seen, i, 2) > 0.99)
                continue; /* brighter than a picture can say */
            if (fabs(red - full) > 0.05 || fabs(blue - !full) > 0.05)
                fail_msg("tile %s, pixel %zu,%zu, %.2f degrees outside: red %.2f, blue %.2f", tile->name,
                         i % 80, i / 80, away, red, blue);
        }
        print_message("# tile %s: %zu pixels inside, %zu beyond\n", tile->name, kinds[0], kinds[1]);
        assert_true(kinds[0] > 50 && kinds[1] > 1000);
        free(seen);
        free(shown);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_viewers_of_a_track_see_sharp),
        cmocka_unit_test(a_gaze_off_the_wall_is_coarse),
        cmocka_unit_test(a_late_gaze_grows_until_it_is_nobodys),
        cmocka_unit_test(what_is_no_gaze_counts_for_nobody),
        cmocka_unit_test(a_gaze_on_a_seam_of_one_plane),
        cmocka_unit_test(a_gaze_on_bezels),
        cmocka_unit_test(a_gaze_on_an_edge_of_two_planes),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
