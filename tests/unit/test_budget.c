/* Budget mode without a wall: how strain answers to costs, and what it is made of. */
#include "tests/support/check.h"

#include "wall/budget.h"

#include <math.h>

static gw_frame_state looking(uint32_t frame) {
    gw_frame_state state = {.frame = frame, .gaze_count = 1, .accumulate = 1};
    state.gazes[0].confidence = 1;
    return state;
}

/* A frame of a wall of two tiles. */
static void spend(gw_budget *budget, uint32_t frame, double cost) {
    const gw_frame_state state = looking(frame);
    for (uint32_t tile = 0; tile < 2; tile++) {
        gw_done done = {.render_ns = (int64_t)((tile ? 1 : 0.4) * cost * 1e6)};
        done.counters.rays = (uint64_t)(cost * (tile ? 0.7 : 0.3));
        gw_budget_note(budget, tile, &done);
    }
    gw_budget_decide(budget, &state);
}

/* Costs that fall with strain as some power of it: within the band after five frames, and then without
 * moving. */
static void strain_settles(void **state) {
    static const double powers[] = {0.5, 1, 2};
    (void)state;
    for (int kind = 0; kind < 2; kind++)
        for (size_t p = 0; p < sizeof powers / sizeof powers[0]; p++) {
            gw_budget budget;
            gw_budget_init(&budget, kind ? 10000 : 0, kind ? 0 : 10000, 1);
            float last = 1;
            for (uint32_t frame = 0; frame < 200; frame++) {
                const double cost = 38000 * pow((double)gw_budget_strain(&budget), -powers[p]);
                if (frame > (kind ? 16u : 8u))
                    assert_true(cost <= 10000.01);
                spend(&budget, frame, cost);
                if (frame > 150) {
                    assert_true(gw_budget_strain(&budget) == last);
                    assert_true(cost >= 0.6 * 10000);
                }
                last = gw_budget_strain(&budget);
            }
        }
}

/* A jump of the cost is answered within three frames, its end slowly, step by step and down to nothing. */
static void a_jump_is_answered_at_once_and_left_slowly(void **state) {
    gw_budget budget;
    (void)state;
    gw_budget_init(&budget, 0, 10000, 1);
    for (uint32_t frame = 0; frame < 10; frame++)
        spend(&budget, frame, 8000);
    assert_true(gw_budget_strain(&budget) == 1);
    for (uint32_t frame = 10; frame < 13; frame++)
        spend(&budget, frame, 50000 / (double)gw_budget_strain(&budget));
    const float high = gw_budget_strain(&budget);
    assert_true(50000 / (double)high <= 10000);
    uint32_t frames = 0;
    for (float last = high; gw_budget_strain(&budget) > 1; frames++) {
        spend(&budget, 13 + frames, 5000 / (double)gw_budget_strain(&budget));
        assert_true((double)last / (double)gw_budget_strain(&budget) < 1.1);
        last = gw_budget_strain(&budget);
    }
    assert_true(frames > 15 && frames < 60);
}

/* A cost that leaps when strain falls below 2, as where the block cap changes: falling is tried ever more
 * seldom. */
static void a_leap_does_not_make_it_swing(void **state) {
    gw_budget budget;
    (void)state;
    gw_budget_init(&budget, 0, 10000, 1);
    for (uint32_t frame = 0; frame < 400; frame++)
        spend(&budget, frame, gw_budget_strain(&budget) < 2 ? 15000 : 6500);
    assert_true(budget.over > 1 && budget.over < 16);
}

/* One slow frame among others is somebody else's doing; two are not; nor is the first frame's compiling. */
static void a_single_slow_frame_counts_for_nothing(void **state) {
    gw_budget budget;
    (void)state;
    gw_budget_init(&budget, 16, 0, 1);
    spend(&budget, 0, 4000);
    for (uint32_t frame = 1; frame < 20; frame++)
        spend(&budget, frame, frame % 5 == 3 ? 200 : 14);
    assert_true(gw_budget_strain(&budget) == 1);
    spend(&budget, 20, 30);
    spend(&budget, 21, 30);
    assert_true(gw_budget_strain(&budget) > 1.5f);
}

/* Frames without a gaze or of a still view decide nothing; a tile that says nothing keeps its last count. */
static void some_frames_do_not_count(void **state) {
    gw_budget budget;
    gw_frame_state blind = looking(5), still = looking(6);
    gw_done most = {.counters = {.rays = 9000}}, few = {.counters = {.rays = 3000}};
    (void)state;
    gw_budget_init(&budget, 0, 10000, 2);
    assert_true(gw_budget_strain(&budget) == 2);
    gw_budget_note(&budget, 0, &most);
    gw_budget_note(&budget, 1, &most);
    blind.gaze_count = 0;
    gw_budget_decide(&budget, &blind);
    blind.gaze_count = 1;
    blind.gazes[0].confidence = 0;
    gw_budget_decide(&budget, &blind);
    still.accumulate = 2;
    gw_budget_decide(&budget, &still);
    assert_true(gw_budget_strain(&budget) == 2 && budget.frames == 0);
    gw_budget_note(&budget, 1, &few);
    still.accumulate = 1;
    gw_budget_decide(&budget, &still); /* 9000 of the first tile stand */
    assert_true(gw_budget_strain(&budget) > 2);
    for (uint32_t frame = 0; frame < 100; frame++)
        spend(&budget, frame, 1e9);
    assert_true(gw_budget_strain(&budget) == GW_MAXIMUM_STRAIN);
    gw_budget_init(&budget, 0, 0, 1);
    assert_false(gw_budget_is_on(&budget));
}

/* The knobs of a strain, and no strain that is none. */
static void strain_moves_the_knobs_together(void **state) {
    gw_settings settings;
    gw_frame_state given = looking(0);
    (void)state;
    gw_settings_init(&settings);
    gw_frame_state_apply(&given, &settings);
    given.strain = 16;
    gw_frame_state drawn = gw_frame_state_in_force(&given);
    assert_true(drawn.tau == 2 * given.tau && drawn.gaze_margin == given.gaze_margin / 16);
    assert_true(drawn.acuity_slope == 16 * given.acuity_slope);
    assert_int_equal(drawn.sample_block, 4);
    assert_true(drawn.tau_inside == given.tau_inside && drawn.strain == 1);
    given.sample_block = 0;
    given.strain = 3.9f;
    assert_int_equal(gw_frame_state_in_force(&given).sample_block, 1);
    given.strain = 1000;
    assert_true(gw_frame_state_in_force(&given).tau == 2 * given.tau);
    static const float none[] = {0, 1, -3, NAN};
    for (int i = 0; i < 4; i++) {
        given.strain = none[i];
        drawn = gw_frame_state_in_force(&given);
        drawn.strain = given.strain;
        assert_memory_equal(&drawn, &given, sizeof drawn);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strain_settles),
        cmocka_unit_test(a_jump_is_answered_at_once_and_left_slowly),
        cmocka_unit_test(a_leap_does_not_make_it_swing),
        cmocka_unit_test(a_single_slow_frame_counts_for_nothing),
        cmocka_unit_test(some_frames_do_not_count),
        cmocka_unit_test(strain_moves_the_knobs_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
