/* Two eyes: what lies in the wall stands still between them, what lies behind moves as similar triangles say,
 * along the head's own axis; and every format shows the pixels of the two eyes, whatever the split. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"
#include "tests/support/tracks.h"
#include "wall/frames.h"
#include "wall/stereo.h"

#include <math.h>

enum { WIDE = 200, HIGH = 160 };
static const double PITCH = 2, EYES = 63, EYE_DEPTH = 1000, BEHIND = 600; /* mm */

static gw_stage stage;
static gw_renderer *renderer;
static const gw_similarity placement = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1000, {0, 0, 0}};
static const gw_tile wall = {
    .name = "wall",
    .plane = {{-PITCH * WIDE / 2, PITCH *HIGH / 2, 0}, {PITCH, 0, 0}, {0, -PITCH, 0}},
    .rectangle = {0, 0, WIDE, HIGH}};

/* A square in the wall's plane in its upper half, and one behind it in the lower half. */
static int open_stage(void **state) {
    gw_mesh mesh = {0};
    (void)state;
    const double u[3] = {0.04, 0, 0}, v[3] = {0, 0.04, 0};
    const double in_wall[3] = {-0.02, 0.06, 0}, behind[3] = {-0.02, -0.12, -BEHIND * 1e-3};
    gw_mesh_add_grid(&mesh, in_wall, u, v, 4, 4);
    gw_mesh_add_grid(&mesh, behind, u, v, 4, 4);
    check_ok(gw_stage_open(&stage, gw_mesh_take(&mesh), NULL, (const char *const[]){"octree_depth=6", NULL},
                           &error));
    renderer = gw_stage_renderer(&stage);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

/* A head before the wall's middle, turned about the wall's normal. */
static gw_frame_state look(double degrees) {
    const double half = degrees * 3.14159265358979 / 360;
    test_pose report = {.position = {0, 0, EYE_DEPTH}, .orientation = {0, 0, sin(half), cos(half)}};
    gw_recording *track = recording_of(&report, 1);
    const double neutral[3] = {9, 9, 999};
    gw_frame_state state;
    gw_frame_begin(&state, 0, &stage.settings, 0, GW_DEBUG_NONE);
    const gw_tracker_view view = view_of_recording(track, 0, neutral, &stage.settings);
    gw_frame_look(&state, &view, &stage.settings);
    gw_frame_part_eyes(&state, &view, EYES);
    gw_recording_destroy(&track);
    return state;
}

static uint8_t *draw(const gw_tile *tile, gw_stereo stereo, const gw_frame_state *state) {
    const size_t scratch_bytes = gw_stereo_scratch(stereo, tile);
    uint8_t *pixels = calloc((size_t)tile->rectangle.width * tile->rectangle.height, 4),
            *scratch = scratch_bytes ? malloc(scratch_bytes) : NULL;
    assert_non_null(pixels);
    check_ok(gw_stereo_draw(renderer, &placement, stereo, tile, state, scratch, pixels, NULL, &error));
    free(scratch);
    return pixels;
}

/* Middle of what is not background in the upper (0) or lower (1) half, mm of wall space. */
static void middle(const uint8_t *pixels, int half, double out[2]) {
    double count = 0;
    out[0] = out[1] = 0;
    for (int y = half * HIGH / 2; y < (half + 1) * HIGH / 2; y++)
        for (int x = 0; x < WIDE; x++)
            if (memcmp(pixels + 4 * (y * WIDE + x), pixels, 3) != 0) {
                out[0] += wall.plane.corner[0] + (x + 0.5) * PITCH;
                out[1] += wall.plane.corner[1] - (y + 0.5) * PITCH;
                count++;
            }
    assert_true(count > 100);
    out[0] /= count;
    out[1] /= count;
}

/* From where the left eye sees a square to where the right one does. */
static void disparity(double degrees, int half, double out[2]) {
    gw_frame_state state = look(degrees);
    uint8_t *left = draw(&wall, GW_STEREO_LEFT, &state), *right = draw(&wall, GW_STEREO_RIGHT, &state);
    double a[2], b[2];
    middle(left, half, a);
    middle(right, half, b);
    out[0] = b[0] - a[0];
    out[1] = b[1] - a[1];
    free(left);
    free(right);
}

static void disparity_follows_depth_and_head(void **unused) {
    (void)unused;
    const double wanted = EYES * BEHIND / (EYE_DEPTH + BEHIND);
    double moved[2];
    for (int degrees = 0; degrees <= 180; degrees += 90) {
        const double angle = degrees * 3.14159265358979 / 180;
        disparity(degrees, 0, moved);
        assert_true(hypot(moved[0], moved[1]) < 0.25 * PITCH);
        disparity(degrees, 1, moved);
        assert_true(fabs(moved[0] - wanted * cos(angle)) < PITCH);
        assert_true(fabs(moved[1] - wanted * sin(angle)) < PITCH);
    }
    assert_true(wanted > 10 * PITCH); /* so that a head that is not heeded fails */
}

static void an_anaglyph_is_both_pictures(void **unused) {
    (void)unused;
    gw_frame_state state = look(20);
    uint8_t *left = draw(&wall, GW_STEREO_LEFT, &state), *right = draw(&wall, GW_STEREO_RIGHT, &state),
            *both = draw(&wall, GW_STEREO_ANAGLYPH, &state);
    int differ = 0;
    for (size_t i = 0; i < (size_t)WIDE * HIGH * 4; i += 4) {
        assert_int_equal(both[i], left[i]);
        assert_memory_equal(both + i + 1, right + i + 1, 3);
        differ += left[i] != right[i];
    }
    assert_true(differ > 100);
    free(left);
    free(right);
    free(both);
}

/* What a format shows to an eye is what that eye alone sees of a wall with half the pixels. */
static void halves_are_pictures_of_their_own(void **unused) {
    (void)unused;
    gw_frame_state state = look(0);
    for (int axis = 0; axis < 2; axis++) {
        gw_tile half = wall;
        for (int i = 0; i < 3; i++)
            *(axis ? &half.plane.step_y[i] : &half.plane.step_x[i]) *= 2;
        *(axis ? &half.rectangle.height : &half.rectangle.width) /= 2;
        uint8_t *shown = draw(&wall, axis ? GW_STEREO_TOP_BOTTOM : GW_STEREO_SIDE_BY_SIDE, &state);
        for (size_t eye = 0; eye < 2; eye++) {
            uint8_t *alone = draw(&half, eye ? GW_STEREO_RIGHT : GW_STEREO_LEFT, &state);
            const size_t wide = half.rectangle.width, high = half.rectangle.height;
            for (size_t y = 0; y < high; y++)
                assert_memory_equal(shown +
                                        ((y + (axis ? eye * high : 0)) * WIDE + (axis ? 0 : eye * wide)) * 4,
                                    alone + y * wide * 4, wide * 4);
            free(alone);
        }
        free(shown);
    }
}

/* Rows of a wall, whichever tile they stand in; also where tiles begin with odd rows. */
static void interlaced_rows_do_not_know_the_split(void **unused) {
    (void)unused;
    gw_frame_state state = look(10);
    uint8_t *whole = draw(&wall, GW_STEREO_ROW_INTERLACE, &state);
    static const uint32_t cuts[] = {0, 33, 70, HIGH};
    for (size_t i = 0; i + 1 < sizeof cuts / sizeof cuts[0]; i++) {
        gw_tile part = wall;
        part.rectangle.y = (int32_t)(part.picture[1] = cuts[i]);
        part.rectangle.height = cuts[i + 1] - cuts[i];
        uint8_t *pixels = draw(&part, GW_STEREO_ROW_INTERLACE, &state);
        assert_memory_equal(pixels, whole + (size_t)cuts[i] * WIDE * 4,
                            (size_t)part.rectangle.height * WIDE * 4);
        free(pixels);
    }
    /* The left eye's rows show the lower square left of where the right eye's show it. */
    double count[2] = {0}, sum[2] = {0};
    for (int y = HIGH / 2; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++)
            if (memcmp(whole + 4 * (y * WIDE + x), whole, 3) != 0) {
                sum[y & 1] += x;
                count[y & 1]++;
            }
    assert_true(count[0] > 50 && count[1] > 50);
    assert_true(sum[1] / count[1] - sum[0] / count[0] > 5);
    free(whole);
}

/* Samples of a still view add up for each eye by itself: the same as drawn at once. */
static void accumulation_keeps_eyes_apart(void **unused) {
    (void)unused;
    gw_frame_state state = look(0);
    state.epoch = 1;
    state.accumulate = 3;
    uint8_t *at_once = draw(&wall, GW_STEREO_ANAGLYPH, &state);
    gw_frame_state other = look(0); /* forget */
    free(draw(&wall, GW_STEREO_ANAGLYPH, &other));
    uint64_t rays = 0;
    for (uint16_t n = 1; n <= 3; n++) {
        gw_counters counters = {0};
        uint8_t *scratch = malloc(gw_stereo_scratch(GW_STEREO_ANAGLYPH, &wall)),
                *pixels = malloc((size_t)WIDE * HIGH * 4);
        state.accumulate = n;
        check_ok(gw_stereo_draw(renderer, &placement, GW_STEREO_ANAGLYPH, &wall, &state, scratch, pixels,
                                &counters, &error));
        if (n == 1)
            rays = counters.rays;
        else
            assert_int_equal(counters.rays, rays); /* one further sample of both, nothing again */
        if (n == 3)
            assert_memory_equal(pixels, at_once, (size_t)WIDE * HIGH * 4);
        free(scratch);
        free(pixels);
    }
    free(at_once);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(disparity_follows_depth_and_head),
        cmocka_unit_test(an_anaglyph_is_both_pictures),
        cmocka_unit_test(halves_are_pictures_of_their_own),
        cmocka_unit_test(interlaced_rows_do_not_know_the_split),
        cmocka_unit_test(accumulation_keeps_eyes_apart),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
