#include "wall/budget.h"

#include <math.h>
#include <string.h>

enum {
    STEPS_PER_OCTAVE = 8,
    HIGHEST_STEP = 4 * STEPS_PER_OCTAVE, /* 2^4 is GW_MAXIMUM_STRAIN */
    LARGEST_RISE = 2 * STEPS_PER_OCTAVE,
    SHORT_PATIENCE = 4,
    LONG_PATIENCE = 64
};

void gw_budget_init(gw_budget *budget, double milliseconds, double rays, double least) {
    memset(budget, 0, sizeof *budget);
    budget->milliseconds = milliseconds;
    budget->rays = rays;
    budget->least = least > 1 ? least : 1;
    budget->patience = SHORT_PATIENCE;
    budget->before = -1;
}

int gw_budget_is_on(const gw_budget *budget) {
    return budget->milliseconds > 0 || budget->rays > 0;
}

void gw_budget_note(gw_budget *budget, uint32_t tile, const gw_done *done) {
    budget->cost_of[tile] = budget->rays > 0 ? (double)done->counters.rays : (double)done->render_ns * 1e-6;
}

static double cost_of_frame(const gw_budget *budget) {
    double sum = 0, largest = 0;
    for (uint32_t i = 0; i < GW_MAXIMUM_TILES; i++) {
        sum += budget->cost_of[i];
        largest = fmax(largest, budget->cost_of[i]);
    }
    return budget->rays > 0 ? sum : largest;
}

static int has_gaze(const gw_frame_state *state) {
    for (uint32_t i = 0; i < state->gaze_count && i < GW_MAXIMUM_VIEWERS; i++)
        if (state->gazes[i].confidence > 0)
            return 1;
    return 0;
}

static void rise(gw_budget *budget, double excess) {
    const double steps = ceil(STEPS_PER_OCTAVE * log2(excess / GW_BUDGET_AIM));
    const uint32_t up = steps < 1 ? 1 : steps > LARGEST_RISE ? LARGEST_RISE : (uint32_t)steps;
    budget->patience = !budget->fell                          ? SHORT_PATIENCE
                       : 2 * budget->patience < LONG_PATIENCE ? 2 * budget->patience
                                                              : LONG_PATIENCE;
    budget->step = budget->step + up < HIGHEST_STEP ? budget->step + up : HIGHEST_STEP;
    budget->wait = budget->patience;
    budget->fell = 0;
    budget->before = -1;
}

static void fall(gw_budget *budget) {
    if (budget->step == 0)
        return;
    budget->step--;
    budget->fell = 1;
    budget->before = -1;
}

void gw_budget_decide(gw_budget *budget, const gw_frame_state *state) {
    const double budgeted = budget->rays > 0 ? budget->rays : budget->milliseconds;
    const double cost = cost_of_frame(budget);
    if (!has_gaze(state) || state->accumulate > 1 || (budget->rays <= 0 && state->frame == 0))
        return;
    budget->frames++;
    budget->over += cost > budgeted;
    /* A single slow frame, or a single fast one, is somebody else's doing. */
    const double least = budget->rays > 0 ? cost : fmin(cost, budget->before),
                 most = budget->rays > 0 ? cost : fmax(cost, budget->before);
    const int known = budget->rays > 0 || budget->before >= 0;
    budget->before = cost;
    if (!known)
        return;
    if (least > budgeted)
        rise(budget, least / budgeted);
    else if (most >= GW_BUDGET_LOW * budgeted)
        budget->fell = 0;
    else if (budget->wait > 0)
        budget->wait--;
    else
        fall(budget);
}

float gw_budget_strain(const gw_budget *budget) {
    const double strain = budget->least * exp2((double)budget->step / STEPS_PER_OCTAVE);
    return (float)fmin(strain, GW_MAXIMUM_STRAIN);
}

json_t *gw_budget_json(const gw_budget *budget) {
    if (!gw_budget_is_on(budget))
        return json_null();
    return json_pack("{s:f, s:I, s:I}", budget->rays > 0 ? "rays" : "ms",
                     budget->rays > 0 ? budget->rays : budget->milliseconds, "frames",
                     (json_int_t)budget->frames, "over", (json_int_t)budget->over);
}
