/* See bench_accuracy.h: the search for settings. Coordinate descent on measured frames: one knob after the
 * other, those that move most first, takes its best value while all others stand, until a pass changes
 * nothing. Values that the sweep has shown to be beaten by others of their knob are not tried. Nothing is
 * random; where the cost is milliseconds, the clock decides. */
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
    int by_error; /* 1: the error is bounded, work is to be least; 0: a cost is, the error is to be least */
    gw_metric metric;
    gw_ledger_cost cost;
    double bound; /* of the metric's badness, or of the cost */
    char words[96];
} goal;

typedef struct move {
    const gw_accuracy_curve *curve;
    double span; /* shares of work and error that it moves */
} move;

typedef struct search {
    gw_accuracy_scene *scene;
    gw_ledger *ledger;
    goal goal;
    gw_ledger_frame exact;
    gw_settings settings; /* best so far */
    gw_ledger_point point;
    move moves[MOST_KNOBS];
    size_t move_count;
    const gw_knob *binding; /* the knob whose next value would gain most and break the bound */
    char binding_value[GW_KNOB_TEXT];
    double binding_gain;
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

static gw_code parse_error_bound(const char *text, goal *out, gw_error *error) {
    const char *names[GW_METRIC_COUNT], *number;
    char name[64];
    double value;
    for (size_t i = 0; i < GW_METRIC_COUNT; i++)
        names[i] = gw_metric_table[i].name;
    if (!split(text, name, sizeof name, &number))
        return fail_name("--max-error", text, names, GW_METRIC_COUNT, error);
    out->by_error = 1;
    out->metric = GW_METRIC_SEEN_FLIP;
    out->cost = GW_LEDGER_WORK;
    for (size_t i = 0; name[0]; i++) {
        if (i == GW_METRIC_FLICKER) /* those of a track begin here */
            return fail_name("--max-error", name, names, GW_METRIC_FLICKER, error);
        out->metric = (gw_metric)i;
        if (!strcmp(names[i], name))
            break;
    }
    gw_code code = parse_bound("--max-error", number, names[out->metric], &value, error);
    out->bound = code ? 0 : gw_metric_badness(out->metric, value);
    snprintf(out->words, sizeof out->words, "%.40s %s %.6g", names[out->metric],
             gw_metric_table[out->metric].sense == GW_METRIC_DOWN ? "at least" : "at most", code ? 0 : value);
    return code;
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
    out->metric = GW_METRIC_SEEN_FLIP;
    out->cost = (gw_ledger_cost)which;
    gw_code code = parse_bound("--max-cost", number, name, &out->bound, error);
    snprintf(out->words, sizeof out->words, "%.40s at most %.6g", name, out->bound);
    return code;
}

gw_code gw_accuracy_check_goal(const gw_bench *bench, gw_error *error) {
    goal parsed = {0};
    if (bench->max_error && bench->max_cost)
        return gw_fail(error, GW_BAD_INPUT, "--max-error and --max-cost are two goals; leave out one");
    if (bench->save_profile && !bench->max_error && !bench->max_cost)
        return gw_fail(error, GW_BAD_INPUT,
                       "--save-profile writes what a search found; give --max-error or --max-cost, too");
    return bench->max_error  ? parse_error_bound(bench->max_error, &parsed, error)
           : bench->max_cost ? parse_cost_bound(bench->max_cost, &parsed, error)
                             : GW_OK;
}

/* --- comparing */

static double error_of(const goal *g, const gw_ledger_point *p) {
    return gw_metric_badness(g->metric, p->errors.values[g->metric]);
}

static double bounded_of(const goal *g, const gw_ledger_point *p) {
    return g->by_error ? error_of(g, p) : p->costs[g->cost];
}

/* What is to be least. */
static double aim_of(const goal *g, const gw_ledger_point *p) {
    return g->by_error ? p->costs[g->cost] : error_of(g, p);
}

static int is_within(const goal *g, const gw_ledger_point *p) {
    return bounded_of(g, p) <= g->bound;
}

/* Within the bound the aim counts, beyond it first how far. */
static int is_better(const goal *g, const gw_ledger_point *a, const gw_ledger_point *b) {
    if (is_within(g, a) != is_within(g, b))
        return is_within(g, a);
    return is_within(g, a) ? aim_of(g, a) < aim_of(g, b) * (1 - least_gain)
                           : bounded_of(g, a) < bounded_of(g, b) * (1 - least_gain);
}

/* --- the moves */

static int is_searched(const search *s, const gw_accuracy_curve *curve) {
    const gw_knob *knob = curve->knob;
    const int octree = gw_knob_setting(knob)->stage == GW_SETTING_BUILD;
    return !curve->idle && !knob->with && knob->age == 0 && knob->reference == GW_KNOB_EXACT &&
           !knob->over_time && (!octree || s->ledger->bench->knob_count);
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

static gw_code measure(search *s, const gw_settings *settings, gw_ledger_point *out, gw_error *error) {
    const gw_ledger_question question = {.frame = {.settings = *settings}, .exact = s->exact};
    return gw_ledger_measure(s->ledger, &question, out, error);
}

/* What a knob's values that break the bound would gain at most, and which of them breaks it least. */
typedef struct temptation {
    double gain, least;
    const char *value; /* NULL: none */
} temptation;

static void note_bound(const search *s, const gw_accuracy_row *row, const gw_ledger_point *point,
                       temptation *knob) {
    const double gain = aim_of(&s->goal, &s->point) - aim_of(&s->goal, point),
                 bounded = bounded_of(&s->goal, point);
    if (!is_within(&s->goal, &s->point) || is_within(&s->goal, point) || !(gain > 0))
        return;
    if (!knob->value || bounded < knob->least) {
        knob->least = bounded;
        knob->value = row->value;
    }
    knob->gain = fmax(knob->gain, gain);
}

static gw_code try_knob(search *s, const move *m, int *changed, gw_error *error) {
    const gw_setting_row *setting = gw_knob_setting(m->curve->knob);
    temptation beyond = {0};
    for (size_t i = 0; i < m->curve->count; i++) {
        const gw_accuracy_row *row = &s->scene->rows[m->curve->first + i];
        gw_settings tried = s->settings;
        gw_ledger_point point;
        char assignment[2 * GW_KNOB_TEXT];
        snprintf(assignment, sizeof assignment, "%s=%s", setting->name, row->value);
        gw_code code = gw_settings_assign(&tried, assignment, error);
        if (code)
            return code;
        if ((!row->front && !row->standing) ||
            gw_setting_value(&tried, setting) == gw_setting_value(&s->settings, setting))
            continue;
        code = measure(s, &tried, &point, error);
        if (code)
            return code;
        if (is_better(&s->goal, &point, &s->point)) {
            s->settings = tried;
            s->point = point;
            *changed = 1;
        } else {
            note_bound(s, row, &point, &beyond);
        }
    }
    if (beyond.value && beyond.gain > s->binding_gain) {
        s->binding = m->curve->knob;
        s->binding_gain = beyond.gain;
        snprintf(s->binding_value, sizeof s->binding_value, "%s", beyond.value);
    }
    return GW_OK;
}

static gw_code descend(search *s, gw_error *error) {
    int changed = 1;
    gw_code code = GW_OK;
    for (int pass = 0; pass < PASSES && changed && !code; pass++) {
        changed = 0;
        s->binding = NULL;
        s->binding_gain = 0;
        for (size_t i = 0; i < s->move_count && !code; i++) {
            gw_log_progress(&s->ledger->bench->console.log, "looking for settings",
                            ((double)pass + (double)i / (double)s->move_count) / PASSES);
            code = try_knob(s, &s->moves[i], &changed, error);
        }
    }
    return code;
}

/* --- what came of it */

static void add_figure(gw_profile *profile, const char *name, double value) {
    if (!isfinite(value) || profile->figure_count == GW_PROFILE_FIGURES)
        return;
    snprintf(profile->figures[profile->figure_count].name, sizeof profile->figures[0].name, "%s", name);
    profile->figures[profile->figure_count++].value = value;
}

static void make_profile(const search *s, gw_profile *profile) {
    const gw_ledger_point *p = &s->point;
    const char *file = s->ledger->bench->save_profile,
               *command = json_string_value(json_object_get(s->ledger->bench->report, "command"));
    const char *stem = file ? strrchr(file, '/') : NULL;
    gw_profile_init(profile);
    snprintf(profile->name, sizeof profile->name, "%.*s",
             (int)strcspn(file ? stem ? stem + 1 : file : "found", "."),
             file ? stem ? stem + 1 : file : "found");
    snprintf(profile->measured_by, sizeof profile->measured_by, "gazewall %.480s", command ? command : "");
    profile->settings = s->settings;
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
    const gw_ledger_point *p = &s->point;
    const double share = p->costs[GW_LEDGER_WORK] / s->scene->standing.costs[GW_LEDGER_WORK];
    int used = snprintf(text, size, "%s in %s: %s with", s->goal.words, s->scene->name,
                        !is_within(&s->goal, p) ? "not reached; nearest"
                        : s->goal.by_error      ? "least work"
                                                : "least error");
    const int head = used;
    for (size_t i = 0; i < gw_setting_count && used < (int)size; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        char value[64];
        gw_setting_text(&s->settings, row, value);
        if (gw_setting_value(&s->settings, row) != gw_setting_value(&s->ledger->bench->draw.settings, row))
            used += snprintf(text + used, size - (size_t)used, " %s=%s", row->name, value);
    }
    if (used < (int)size)
        used += snprintf(text + used, size - (size_t)used,
                         "%s: FLIP %.4f, as seen %.4f, %.2f times the work of the settings that stood.",
                         used == head ? " those that stood" : "", p->errors.values[GW_METRIC_FLIP],
                         p->errors.values[GW_METRIC_SEEN_FLIP], share);
    if (s->binding && used < (int)size)
        snprintf(text + used, size - (size_t)used, " %s binds: %s=%.40s would break the bound.",
                 s->binding->name, s->binding->name, s->binding_value);
}

static gw_code tell(const search *s, gw_error *error) {
    char text[1024];
    gw_profile profile;
    make_profile(s, &profile);
    describe(s, text, sizeof text);
    snprintf(profile.about, sizeof profile.about, "%.500s", text);
    json_decref(s->scene->found_profile);
    s->scene->found_profile = json_pack(
        "{s:s, s:b, s:s?, s:s?, s:o, s:o}", "sentence", text, "met", is_within(&s->goal, &s->point), "binds",
        s->binding ? s->binding->name : NULL, "next", s->binding ? s->binding_value : NULL, "point",
        gw_ledger_pack(&s->point), "profile", gw_profile_json(&profile, &s->ledger->bench->draw.settings));
    return s->ledger->bench->save_profile ? gw_profile_write(s->ledger->bench->save_profile, &profile, error)
                                          : GW_OK;
}

gw_code gw_accuracy_search(gw_accuracy_scene *scene, gw_ledger *ledger, gw_error *error) {
    const gw_bench *bench = ledger->bench;
    search s = {.scene = scene, .ledger = ledger, .settings = bench->draw.settings, .point = scene->standing};
    gw_code code = bench->max_error ? parse_error_bound(bench->max_error, &s.goal, error)
                                    : parse_cost_bound(bench->max_cost, &s.goal, error);
    if (!code)
        code = gw_ledger_exact(&s.settings, NULL, &s.exact, error);
    if (code)
        return code;
    choose_moves(&s);
    code = descend(&s, error);
    return code ? code : tell(&s, error);
}
