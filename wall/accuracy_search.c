/* See bench_accuracy.h: the search for settings. Coordinate descent on measured frames: one knob after the
 * other, those that move most first, takes its best value while all others stand, until a pass changes
 * nothing. Values that the sweep has shown to be beaten by others of their knob are not tried. A descent ends
 * where no single knob gains, which from one start may be worse than what lies beside another: so there are
 * three, the settings that stand, the best of all values that were swept, and the exact ones; what they come
 * to is compared. Nothing is random; where the cost is milliseconds, the clock decides. */
#include "wall/bench_accuracy.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "wall/profile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PASSES = 4, MOST_KNOBS = 64 };
/* A knob that moves neither error nor work by so much of the standing value's stays as it is. */
static const double least_span = 0.01;
/* What counts as better: less by more than this share. */
static const double least_gain = 1e-3;

/* What is bounded, and what is to be least. */
typedef struct goal {
    int by_error; /* 1: errors are bounded, work is to be least; 0: a cost is, the error is to be least */
    gw_metric metrics[GW_BENCH_BOUNDS];
    double bounds[GW_BENCH_BOUNDS]; /* of the metrics' badness, or of the cost */
    size_t count;
    gw_ledger_cost cost;
    char words[512];
} goal;

typedef struct move {
    const gw_accuracy_curve *curve;
    double span; /* shares of work and error that it moves */
} move;

/* Where a descent is. */
typedef struct place {
    gw_settings settings; /* best so far */
    gw_ledger_point point;
    const gw_knob *binding; /* the knob whose next value would gain most and break the bound */
    char binding_value[GW_KNOB_TEXT];
    double binding_gain;
} place;

typedef struct search {
    gw_accuracy_scene *scene;
    const gw_bench *bench;
    const gw_accuracy_instrument *instrument;
    goal goal;
    move moves[MOST_KNOBS];
    size_t move_count;
    place here, best;
} search;

/* --- the goal */

static gw_code parse_bound(const char *option, const char *text, const char *name, double *out,
                           gw_error *error) {
    gw_code code = gw_parse_number(option, text, 0, 1e18, out, error);
    return code ? gw_context(error, "the bound of %s", name) : GW_OK;
}

/* "NAME=" in front of the number. */
static int split(const char *text, char *name, size_t size, const char **number) {
    const char *equals = strchr(text, '=');
    const size_t length = equals ? (size_t)(equals - text) : 0;
    *number = equals ? equals + 1 : text;
    if (length >= size)
        return 0;
    memcpy(name, text, length);
    name[length] = '\0';
    return 1;
}

static gw_code fail_name(const char *option, const char *name, const char *const *names, size_t count,
                         gw_error *error) {
    const char *near = gw_suggest(name, names, count);
    return gw_fail(error, GW_BAD_INPUT, "%s: '%.60s' is none%s%s%s", option, name,
                   near ? "; did you mean '" : "; see docs/ledger.md", near ? near : "", near ? "'?" : "");
}

/* text: "METRIC=E" or "E". timed: 1 where there are frames in a row. */
static gw_code parse_error_bound(const char *text, int timed, goal *out, gw_error *error) {
    const char *names[GW_METRIC_COUNT], *number;
    char name[64];
    double value;
    size_t which = GW_METRIC_SEEN_FLIP;
    for (size_t i = 0; i < GW_METRIC_COUNT; i++)
        names[i] = gw_metric_table[i].name;
    if (!split(text, name, sizeof name, &number))
        return fail_name("--max-error", text, names, GW_METRIC_COUNT, error);
    if (name[0])
        for (which = 0; which < GW_METRIC_COUNT && strcmp(names[which], name) != 0;)
            which++;
    if (which == GW_METRIC_COUNT)
        return fail_name("--max-error", name, names, GW_METRIC_COUNT, error);
    if (which >= GW_METRIC_FLICKER && !timed)
        return gw_fail(error, GW_BAD_INPUT, "--max-error %s is of frames in a row; add --frames 8, say",
                       names[which]);
    gw_code code = parse_bound("--max-error", number, names[which], &value, error);
    if (code)
        return code;
    const size_t used = strlen(out->words);
    out->metrics[out->count] = (gw_metric)which;
    out->bounds[out->count++] = gw_metric_badness((gw_metric)which, value);
    snprintf(out->words + used, sizeof out->words - used, "%s%.40s %s %.6g", used ? ", " : "", names[which],
             gw_metric_table[which].sense == GW_METRIC_DOWN ? "at least" : "at most", value);
    return GW_OK;
}

static gw_code parse_cost_bound(const char *text, goal *out, gw_error *error) {
    const char *number;
    char name[64];
    size_t which = 0;
    if (!split(text, name, sizeof name, &number))
        name[0] = '\0';
    while (which < GW_LEDGER_COSTS && strcmp(gw_ledger_cost_names[which], name) != 0)
        which++;
    if (which == GW_LEDGER_COSTS)
        return fail_name("--max-cost", name[0] ? name : text, gw_ledger_cost_names, GW_LEDGER_COSTS, error);
    out->metrics[0] = GW_METRIC_SEEN_FLIP;
    out->count = 1;
    out->cost = (gw_ledger_cost)which;
    gw_code code = parse_bound("--max-cost", number, name, &out->bounds[0], error);
    snprintf(out->words, sizeof out->words, "%.40s at most %.6g", name, out->bounds[0]);
    return code;
}

static gw_code parse_goal(const gw_bench *bench, goal *out, gw_error *error) {
    gw_code code = GW_OK;
    *out = (goal){.by_error = !bench->max_cost, .cost = GW_LEDGER_WORK};
    for (size_t i = 0; i < bench->bound_count && !code; i++)
        code = parse_error_bound(bench->max_errors[i], bench->frames > 1, out, error);
    return code || !bench->max_cost ? code : parse_cost_bound(bench->max_cost, out, error);
}

gw_code gw_accuracy_check_goal(const gw_bench *bench, gw_error *error) {
    goal parsed;
    if (bench->bound_count && bench->max_cost)
        return gw_fail(error, GW_BAD_INPUT, "--max-error and --max-cost are two goals; leave out one");
    if (bench->save_profile && !bench->bound_count && !bench->max_cost)
        return gw_fail(error, GW_BAD_INPUT,
                       "--save-profile writes what a search found; give --max-error or --max-cost, too");
    return parse_goal(bench, &parsed, error);
}

/* --- comparing */

static double error_of(const goal *g, size_t which, const gw_ledger_point *p) {
    return gw_metric_badness(g->metrics[which], p->errors.values[g->metrics[which]]);
}

/* How far beyond its bound what is bounded is, the farthest of all: 0 within, else by what share of the
 * bound, of a bound of 0 by how much. What cannot be measured is within no bound. */
static double excess_of(const goal *g, const gw_ledger_point *p) {
    double most = 0;
    for (size_t i = 0; i < g->count; i++) {
        const double value = g->by_error ? error_of(g, i, p) : p->costs[g->cost];
        const double beyond = isnan(value) ? INFINITY : value - g->bounds[i];
        if (beyond > 0)
            most = fmax(most, g->bounds[i] > 0 ? beyond / g->bounds[i] : beyond);
    }
    return most;
}

/* What is to be least. */
static double aim_of(const goal *g, const gw_ledger_point *p) {
    return g->by_error ? p->costs[g->cost] : error_of(g, 0, p);
}

static int is_within(const goal *g, const gw_ledger_point *p) {
    return excess_of(g, p) <= 0;
}

/* Within the bound the aim counts, beyond it first how far. least: what share counts. */
static int is_better(const goal *g, const gw_ledger_point *a, const gw_ledger_point *b, double least) {
    if (is_within(g, a) != is_within(g, b))
        return is_within(g, a);
    return is_within(g, a) ? aim_of(g, a) < aim_of(g, b) * (1 - least)
                           : excess_of(g, a) < excess_of(g, b) * (1 - least);
}

/* --- the moves */

static int is_searched(const search *s, const gw_accuracy_curve *curve) {
    const gw_knob *knob = curve->knob;
    const int octree = gw_knob_setting(knob)->stage == GW_SETTING_BUILD;
    return !curve->idle && !knob->with && knob->age == 0 && knob->reference == GW_KNOB_EXACT &&
           !knob->over_time && (!octree || s->bench->knob_count);
}

static int by_span(const void *a, const void *b) {
    const move *x = a, *y = b;
    return (x->span < y->span) - (x->span > y->span);
}

static void choose_moves(search *s) {
    const gw_accuracy_scene *scene = s->scene;
    const double error = fmax(scene->standing.errors.values[GW_METRIC_FLIP], 1e-3);
    for (size_t c = 0; c < scene->curve_count && s->move_count < MOST_KNOBS; c++) {
        const gw_accuracy_curve *curve = &scene->curves[c];
        const double span =
            curve->most_work - curve->least_work + (curve->most_error - curve->least_error) / error;
        if (is_searched(s, curve) && span >= least_span)
            s->moves[s->move_count++] = (move){curve, span};
    }
    qsort(s->moves, s->move_count, sizeof s->moves[0], by_span);
}

/* --- descending */

/* What a knob's values that break the bound would gain at most, and which of them breaks it least. */
typedef struct temptation {
    double gain, least;
    const char *value; /* NULL: none */
} temptation;

static void note_bound(const search *s, const gw_accuracy_row *row, const gw_ledger_point *point,
                       temptation *knob) {
    const gw_ledger_point *now = &s->here.point;
    const double gain = aim_of(&s->goal, now) - aim_of(&s->goal, point), excess = excess_of(&s->goal, point);
    if (!is_within(&s->goal, now) || !(excess > 0) || !(gain > 0))
        return;
    if (!knob->value || excess < knob->least) {
        knob->least = excess;
        knob->value = row->value;
    }
    knob->gain = fmax(knob->gain, gain);
}

static gw_code assign(const gw_accuracy_row *row, gw_settings *settings, gw_error *error) {
    char assignment[2 * GW_KNOB_TEXT];
    snprintf(assignment, sizeof assignment, "%s=%s", row->knob->name, row->value);
    return gw_settings_assign(settings, assignment, error);
}

static gw_code try_knob(search *s, const move *m, int *changed, gw_error *error) {
    const gw_setting_row *setting = gw_knob_setting(m->curve->knob);
    place *here = &s->here;
    temptation beyond = {0};
    for (size_t i = 0; i < m->curve->count; i++) {
        const gw_accuracy_row *row = &s->scene->rows[m->curve->first + i];
        gw_settings tried = here->settings;
        gw_ledger_point point;
        gw_code code = assign(row, &tried, error);
        if (code)
            return code;
        if ((!row->front && !row->standing) ||
            gw_setting_value(&tried, setting) == gw_setting_value(&here->settings, setting))
            continue;
        code = s->instrument->measure(s->instrument->context, &tried, &point, error);
        if (code)
            return code;
        if (is_better(&s->goal, &point, &here->point, least_gain)) {
            here->settings = tried;
            here->point = point;
            *changed = 1;
        } else {
            note_bound(s, row, &point, &beyond);
        }
    }
    if (beyond.value && beyond.gain > here->binding_gain) {
        here->binding = m->curve->knob;
        here->binding_gain = beyond.gain;
        snprintf(here->binding_value, sizeof here->binding_value, "%s", beyond.value);
    }
    return GW_OK;
}

static gw_code descend(search *s, gw_error *error) {
    int changed = 1;
    gw_code code = GW_OK;
    for (int pass = 0; pass < PASSES && changed && !code; pass++) {
        changed = 0;
        s->here.binding = NULL;
        s->here.binding_gain = 0;
        for (size_t i = 0; i < s->move_count && !code; i++) {
            gw_log_progress(&s->bench->console.log, "looking for settings",
                            ((double)pass + (double)i / (double)s->move_count) / PASSES);
            code = try_knob(s, &s->moves[i], &changed, error);
        }
    }
    return code;
}

static gw_code descend_again(search *s, gw_error *error) {
    gw_code code = descend(s, error);
    if (!code && is_better(&s->goal, &s->here.point, &s->best.point, 0))
        s->best = s->here;
    return code;
}

/* --- where to begin */

/* The best of all values of the knobs that are moved, all others as they stand. */
static gw_code begin_at_row(search *s, gw_error *error) {
    const gw_accuracy_row *best = NULL;
    for (size_t i = 0; i < s->move_count; i++)
        for (size_t k = 0; k < s->moves[i].curve->count; k++) {
            const gw_accuracy_row *row = &s->scene->rows[s->moves[i].curve->first + k];
            if (is_better(&s->goal, &row->point, best ? &best->point : &s->scene->standing, 0))
                best = row;
        }
    if (!best)
        return GW_OK;
    s->here = (place){.settings = s->bench->draw.settings, .point = best->point};
    gw_code code = assign(best, &s->here.settings, error);
    return code ? code : descend_again(s, error);
}

/* Every knob at its exact value, wherever somebody looks. */
static gw_code begin_exact(search *s, gw_error *error) {
    gw_ledger_frame exact;
    gw_code code = gw_ledger_exact(&s->bench->draw.settings, NULL, &exact, error);
    if (!code)
        code = gw_settings_assign_all(&exact.settings,
                                      "gaze_half_width=90 gaze_half_height=90 sample_block=1", error);
    s->here = (place){.settings = exact.settings};
    if (!code)
        code = s->instrument->measure(s->instrument->context, &s->here.settings, &s->here.point, error);
    return code || !is_within(&s->goal, &s->here.point) ? code : descend_again(s, error);
}

static gw_code search_all(search *s, gw_error *error) {
    s->here = (place){.settings = s->bench->draw.settings, .point = s->scene->standing};
    gw_code code = descend(s, error);
    s->best = s->here;
    if (!code)
        code = begin_at_row(s, error);
    return code ? code : begin_exact(s, error);
}

/* --- what came of it */

static void add_figure(gw_profile *profile, const char *name, double value) {
    if (!isfinite(value) || profile->figure_count == GW_PROFILE_FIGURES)
        return;
    snprintf(profile->figures[profile->figure_count].name, sizeof profile->figures[0].name, "%s", name);
    profile->figures[profile->figure_count++].value = value;
}

static void make_profile(const search *s, gw_profile *profile) {
    const gw_ledger_point *p = &s->best.point;
    const char *file = s->bench->save_profile,
               *command = json_string_value(json_object_get(s->bench->report, "command"));
    const char *stem = file ? strrchr(file, '/') : NULL;
    gw_profile_init(profile);
    snprintf(profile->name, sizeof profile->name, "%.*s",
             (int)strcspn(file ? stem ? stem + 1 : file : "found", "."),
             file ? stem ? stem + 1 : file : "found");
    snprintf(profile->measured_by, sizeof profile->measured_by, "gazewall %.480s", command ? command : "");
    profile->settings = s->best.settings;
    add_figure(profile, "flip", p->errors.values[GW_METRIC_FLIP]);
    add_figure(profile, "seen_flip", p->errors.values[GW_METRIC_SEEN_FLIP]);
    add_figure(profile, "psnr", p->errors.values[GW_METRIC_PSNR]);
    add_figure(profile, "predicted_error", p->predicted);
    add_figure(profile, "work", p->costs[GW_LEDGER_WORK]);
    add_figure(profile, "work_of_defaults", s->scene->standing.costs[GW_LEDGER_WORK]);
    add_figure(profile, "rays", p->costs[GW_LEDGER_RAYS]);
    add_figure(profile, "width", s->scene->size[0]);
    add_figure(profile, "height", s->scene->size[1]);
}

static void describe(const search *s, char *text, size_t size) {
    const gw_ledger_point *p = &s->best.point;
    const double share = p->costs[GW_LEDGER_WORK] / s->scene->standing.costs[GW_LEDGER_WORK];
    int used = snprintf(text, size, "%s in %s: %s with", s->goal.words, s->scene->name,
                        !is_within(&s->goal, p) ? "not reached; nearest"
                        : s->goal.by_error      ? "least work"
                                                : "least error");
    const int head = used;
    for (size_t i = 0; i < gw_setting_count && used < (int)size; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        char value[64];
        gw_setting_text(&s->best.settings, row, value);
        if (gw_setting_value(&s->best.settings, row) != gw_setting_value(&s->bench->draw.settings, row))
            used += snprintf(text + used, size - (size_t)used, " %s=%s", row->name, value);
    }
    if (used < (int)size)
        used += snprintf(text + used, size - (size_t)used,
                         "%s: FLIP %.4f, as seen %.4f, %.2f times the work of the settings that stood.",
                         used == head ? " those that stood" : "", p->errors.values[GW_METRIC_FLIP],
                         p->errors.values[GW_METRIC_SEEN_FLIP], share);
    if (s->best.binding && used < (int)size)
        snprintf(text + used, size - (size_t)used, " %s binds: %s=%.40s would break the bound.",
                 s->best.binding->name, s->best.binding->name, s->best.binding_value);
}

static gw_code tell(const search *s, gw_error *error) {
    char text[1024];
    gw_profile profile;
    make_profile(s, &profile);
    describe(s, text, sizeof text);
    snprintf(profile.about, sizeof profile.about, "%.500s", text);
    json_decref(s->scene->found_profile);
    s->scene->found_profile = json_pack(
        "{s:s, s:b, s:s?, s:s?, s:o, s:o}", "sentence", text, "met", is_within(&s->goal, &s->best.point),
        "binds", s->best.binding ? s->best.binding->name : NULL, "next",
        s->best.binding ? s->best.binding_value : NULL, "point", gw_ledger_pack(&s->best.point), "profile",
        gw_profile_json(&profile, &s->bench->draw.settings));
    return s->bench->save_profile ? gw_profile_write(s->bench->save_profile, &profile, error) : GW_OK;
}

static gw_code check_measured(const search *s, gw_error *error) {
    for (size_t i = 0; i < s->goal.count; i++)
        if (isnan(error_of(&s->goal, i, &s->scene->standing)))
            return gw_fail(
                error, GW_BAD_INPUT,
                "--max-error: %s cannot be measured in %s, where nothing is there to compare; leave it "
                "out",
                gw_metric_table[s->goal.metrics[i]].name, s->scene->name);
    return GW_OK;
}

gw_code gw_accuracy_search(gw_accuracy_scene *scene, const gw_bench *bench,
                           const gw_accuracy_instrument *instrument, gw_error *error) {
    search s = {.scene = scene, .bench = bench, .instrument = instrument};
    gw_code code = parse_goal(bench, &s.goal, error);
    if (!code)
        code = check_measured(&s, error);
    if (code)
        return code;
    choose_moves(&s);
    code = search_all(&s, error);
    return code ? code : tell(&s, error);
}
