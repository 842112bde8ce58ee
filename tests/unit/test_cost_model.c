/* The cost model: planted prices are found again, nothing costs less than nothing, and a model that is wrong
 * by 1000 is flagged. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "wall/cost_model.h"

#include <math.h>

enum { SAMPLES = 12 };

/* Frames of different work: rays, nodes, tests and further rays that do not move together. */
static void plant(const double prices[GW_COST_TERMS], double noise, gw_cost_sample samples[SAMPLES]) {
    uint64_t random = 5;
    for (int s = 0; s < SAMPLES; ++s) {
        gw_counters c = {.rays = 10000 + (uint64_t)(1e6 * gw_test_random(&random))};
        c.node_loads = (uint64_t)((double)c.rays * (5 + 20 * gw_test_random(&random)));
        c.triangle_tests = (uint64_t)((double)c.rays * (1 + 8 * gw_test_random(&random)));
        c.shadow_rays = (uint64_t)((double)c.rays * gw_test_random(&random));
        samples[s] = gw_cost_of_frame(&c, 0);
        for (int i = 0; i < GW_COST_TERMS; ++i)
            samples[s].measured += prices[i] * samples[s].amounts[i];
        samples[s].measured *= 1 + noise * (2 * gw_test_random(&random) - 1);
    }
}

static void planted_prices_are_found(void **state) {
    static const double prices[GW_COST_TERMS] = {2e-5, 3e-6, 9e-6, 4e-5};
    gw_cost_sample samples[SAMPLES];
    gw_cost_model model;
    (void)state;
    plant(prices, 0, samples);
    check_ok(gw_cost_fit(GW_COST_TIME, samples, SAMPLES, &model, &error));
    for (int i = 0; i < GW_COST_TERMS; ++i)
        assert_true(fabs(model.prices[i] / prices[i] - 1) < 1e-6);
    assert_true(model.error < 1e-6);
    plant(prices, 0.05, samples);
    check_ok(gw_cost_fit(GW_COST_TIME, samples, SAMPLES, &model, &error));
    assert_true(model.error > 0 && model.error < 0.05);
    for (size_t s = 0; s < SAMPLES; ++s) {
        gw_cost_verdict left_out;
        check_ok(gw_cost_judge_left_out(GW_COST_TIME, samples, SAMPLES, s, &left_out, &error));
        assert_false(left_out.flagged);
        assert_true(fabs(left_out.ratio - 1) < 0.2);
    }
}

/* A term that least squares would give a price below 0 gets none. */
static void nothing_costs_less_than_nothing(void **state) {
    static const double prices[GW_COST_TERMS] = {2e-5, 3e-6, -1e-6, 0};
    gw_cost_sample samples[SAMPLES];
    gw_cost_model model;
    (void)state;
    plant(prices, 0, samples);
    check_ok(gw_cost_fit(GW_COST_TIME, samples, SAMPLES, &model, &error));
    for (int i = 0; i < GW_COST_TERMS; ++i)
        assert_true(model.prices[i] >= 0);
    assert_true(model.prices[2] == 0 && model.error > 1e-4);
}

static void a_model_wrong_by_a_thousand_is_flagged(void **state) {
    static const double prices[GW_COST_TERMS] = {2e-5, 3e-6, 9e-6, 4e-5};
    gw_cost_sample samples[SAMPLES];
    gw_cost_model model;
    (void)state;
    plant(prices, 0.05, samples);
    check_ok(gw_cost_fit(GW_COST_TIME, samples, SAMPLES, &model, &error));
    for (int k = 0; k < 4; ++k) {
        static const double wrong[4] = {1, 1000, 1e-3, NAN};
        gw_cost_model planted = model;
        for (int i = 0; i < GW_COST_TERMS; ++i)
            planted.prices[i] *= wrong[k];
        for (int s = 0; s < SAMPLES; ++s)
            assert_int_equal(gw_cost_judge(&planted, &samples[s]).flagged, k > 0);
    }
    /* One measurement that does not fit the others: they tell, although a fit to all bends towards it. */
    gw_cost_verdict left_out;
    samples[4].measured *= 1000;
    check_ok(gw_cost_judge_left_out(GW_COST_TIME, samples, SAMPLES, 4, &left_out, &error));
    assert_true(left_out.flagged && left_out.ratio < 2e-3);
}

static void few_or_broken_samples(void **state) {
    gw_cost_sample one = {{1000, 0, 0, 0}, 5},
                   broken[] = {{{1, 0, 0, 0}, 0}, {{1, 0, 0, 0}, NAN}, {{-1, 0, 0, 0}, 1}};
    gw_cost_model model;
    gw_cost_verdict verdict;
    (void)state;
    check_ok(gw_cost_fit(GW_COST_TIME, &one, 1, &model, &error));
    assert_true(fabs(model.prices[0] - 5e-3) < 1e-12 && model.prices[1] == 0);
    check_ok(gw_cost_judge_left_out(GW_COST_TIME, &one, 1, 0, &verdict, &error));
    assert_true(verdict.flagged);
    check_fails(gw_cost_fit(GW_COST_TIME, &one, 0, &model, &error), GW_BAD_INPUT, "at least one");
    for (int i = 0; i < 3; ++i)
        check_fails(gw_cost_fit(GW_COST_TIME, &broken[i], 1, &model, &error), GW_BAD_INPUT, "sample 0");
}

static void it_is_told_in_units(void **state) {
    static const double prices[GW_COST_TERMS] = {2e-5, 3e-6, 9e-6, 4e-5};
    const gw_cost_model model = {.kind = GW_COST_TIME,
                                 .prices = {prices[0], prices[1], prices[2], prices[3]}};
    char text[200], cut[20];
    (void)state;
    gw_cost_describe(&model, text, sizeof text);
    assert_string_equal(text, "ray 20 ns + node 3 ns + test 9 ns + further_ray 40 ns");
    gw_cost_describe(&model, cut, sizeof cut);
    assert_int_equal(strlen(cut), sizeof cut - 1);
    json_t *report = gw_cost_report(&model);
    assert_true(fabs(json_number_value(json_object_get(json_object_get(report, "prices"), "test")) - 9) <
                1e-9);
    json_decref(report);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planted_prices_are_found),
        cmocka_unit_test(nothing_costs_less_than_nothing),
        cmocka_unit_test(a_model_wrong_by_a_thousand_is_flagged),
        cmocka_unit_test(few_or_broken_samples),
        cmocka_unit_test(it_is_told_in_units),
    };
    return cmocka_run_group_tests_name("cost_model", tests, NULL, NULL);
}
