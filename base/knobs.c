#include "base/knobs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char predicted[] = "predicted_error", cones[] = "occlusion_cones=3";

/* In the order of the table of settings. */
const gw_knob gw_knobs[] = {
    /* Of the octree. */
    {.name = "outlier_extents", .sweep = "10 1000000 0"},
    {.name = "octree_depth", .sweep = "6 8 9 10 11 12"},
    {.name = "leaf_triangles"},
    {.name = "fan_rule"},
    {.name = "fan_cap"},
    {.name = "isolation_rule"},
    {.name = "octree_memory", .sweep = "0 4 8 16 32 64"},
    {.name = "dense_leaf", .sweep = "0 16 32 64 128 256"},
    {.name = "payload_texture_side", .sweep = "16 64 128 256 512 1024"},
    {.name = "payload_rule"},
    {.name = "separation"},
    /* Of a frame. */
    {.name = "geometry"},
    {.name = "tau", .sweep = "0 0.25 0.5 1 2 4", .exact = "0", .model = predicted, .quick = 1},
    {.name = "tau_inside", .sweep = "0 0.25 0.5 1 2 4", .exact = "0", .model = predicted, .quick = 1},
    {.name = "gaze_half_width", .sweep = "2 4 8 16 32 90", .quick = 1, .over_time = 1},
    {.name = "gaze_half_height", .sweep = "1.5 3 6 12 24 90", .over_time = 1},
    {.name = "gaze_margin", .sweep = "0 0.75 1.5 3 6 12 45", .over_time = 1},
    {.name = "gaze_blend", .sweep = "0 0.5 1 2 4 8 45", .over_time = 1},
    {.name = "gaze_growth", .age = 0.08},
    {.name = "gaze_latency", .sweep = "0 0.0125 0.025 0.05 0.1", .age = 0.08},
    {.name = "gaze_growth_limit", .age = 0.2},
    {.name = "acuity_slope", .sweep = "0 0.0055 0.011 0.022 0.044 0.088", .quick = 1},
    {.name = "gaze_rule"},
    {.name = "seed_distance", .with = "gaze_rule=seed"},
    {.name = "gaze_footprint", .sweep = "0 0.125 0.25 0.5 1 2"},
    {.name = "sample_block", .quick = 1},
    {.name = "coarse_samples"},
    {.name = "reconstruction"},
    {.name = "rate_blend", .over_time = 1},
    {.name = "edge_depth"},
    {.name = "edge_normal"},
    {.name = "samples", .exact = "16", .quick = 1},
    {.name = "accumulate", .sweep = "1 4 16", .over_time = 1},
    {.name = "strain", .sweep = "1 2 4 8 16", .exact = "1", .model = predicted},
    {.name = "level_blend", .over_time = 1},
    {.name = "leaf_blend", .over_time = 1},
    {.name = "voxel_slab"},
    {.name = "voxel_flatness", .sweep = "0.2 0.5 0.8 0.95 1.2"},
    {.name = "fold_agreement"},
    {.name = "separated_tau", .sweep = "0 0.125 0.25 0.5 1"},
    {.name = "least_remainder"},
    {.name = "shadow_tau", .sweep = "0 0.25 0.5 1 2 4", .exact = "0", .quick = 1},
    {.name = "near_light"},
    {.name = "shadow_samples", .exact = "16"},
    {.name = "environment_lights", .sweep = "0 2 4 8 16 32", .exact = "64"},
    {.name = "light_least", .sweep = "0 0.00048828125 0.001953125 0.0078125 0.03125", .exact = "0"},
    {.name = "emissive_lights", .sweep = "0 1 2 4 8 16 32", .exact = "64"},
    {.name = "emissive_least", .exact = "0"},
    {.name = "emissive_faintest", .sweep = "0 0.125 0.25 0.5 1 2", .exact = "0"},
    {.name = "mirror_roughness", .sweep = "0 0.01 0.02 0.04 0.08"},
    {.name = "glossy_roughness", .sweep = "0 0.125 0.25 0.375 0.5"},
    {.name = "bounces", .sweep = "0 1 2 4 8", .exact = "8"},
    {.name = "least_throughput", .exact = "0"},
    {.name = "occlusion_cones", .exact = "6", .reference = GW_KNOB_OWN},
    {.name = "occlusion_distance", .exact = "2", .with = cones, .reference = GW_KNOB_OWN},
    {.name = "diffuse_bounce", .exact = "all", .with = cones, .reference = GW_KNOB_OWN},
    {.name = "exposure", .sweep = "-2 -1 0 1 2", .exact = "0", .reference = GW_KNOB_OWN},
    {.name = "tone", .exact = "linear", .reference = GW_KNOB_OWN},
    {.name = "dither", .exact = "off", .reference = GW_KNOB_OWN},
    /* Of what rank 0 decides. */
    {.name = "exposure_key", .with = "exposure=auto"},
    {.name = "exposure_speed", .with = "exposure=auto"},
    {.name = "head_filter"},
    {.name = "head_cutoff", .with = "head_filter=one-euro"},
    {.name = "head_cutoff_growth", .with = "head_filter=one-euro"},
    {.name = "head_noise", .with = "head_filter=kalman"},
    {.name = "head_acceleration", .with = "head_filter=kalman"},
    {.name = "turn_cutoff", .with = "head_filter=one-euro"},
    {.name = "turn_cutoff_growth", .with = "head_filter=one-euro"},
    {.name = "gaze_filter"},
    {.name = "gaze_cutoff", .with = "gaze_filter=one-euro"},
    {.name = "gaze_cutoff_growth", .with = "gaze_filter=one-euro"},
    {.name = "saccade_speed"},
    {.name = "saccade_growth_limit"},
    {.name = "gaze_prediction"},
    {.name = "prediction"},
    {.name = "prediction_limit"},
    {.name = "hold_time"},
    {.name = "glide_speed"},
    {.name = "gaze_fade"},
    {.name = "added_latency", .sweep = "0 0.0125 0.025 0.05 0.1"},
    /* Of a frame again. */
    {.name = "texture_filter", .exact = "trilinear"},
    {.name = "triangle_precision", .exact = "double"},
};
const size_t gw_knob_count = sizeof gw_knobs / sizeof gw_knobs[0];

const gw_knob_elsewhere gw_knobs_elsewhere[] = {
    {"frame_budget", "ms or rays", "none", "above 0",
     "what the acuity model calls invisible against the frame's time", "no budget (strain 1)",
     "--budget and --budget-rays of sim and wall; it moves the setting strain",
     "knob strain; frames.csv of a run"},
    {"frame_deadline", "s", "the site's", "0.001 to 3600",
     "tiles that show an older frame against a wall that waits", "lock-step: every frame waits for all tiles",
     "times.frame of the site, --frame-deadline", "swap_skew_ms and late tiles in the report of a run"},
    {"death_deadline", "s", "the site's", "0.01 to 3600", "a lost tile's picture against a wall that waits",
     "lock-step", "times.death of the site, --death-deadline", "tests/mpi"},
    {"still", "mm, deg", "0,0", "0 to 1000",
     "a view that stands although the eye moved against samples that add up", "0,0",
     "--still of sim and wall, with accumulate", "tests/unit/test_frames.c"},
    {"forbidden_effects", "", "none", "any effect", "what the scene calls for against time", "none",
     "--forbid-effect of all that draw", "gazewall bench effects"},
    {"voxel_colour_bits", "bits a channel", "10", "fixed", "bands in the colour of voxels against bytes",
     "tau 0", "shaders/common/shared.h", "knob tau: no voxel, no rounding"},
    {"light_bits", "bits a channel", "8", "fixed", "bands in smooth shades against bytes", "linear light",
     "the picture's codes", "knob dither"},
};
const size_t gw_knob_elsewhere_count = sizeof gw_knobs_elsewhere / sizeof gw_knobs_elsewhere[0];

const gw_knob *gw_knob_find(const char *name) {
    for (size_t i = 0; i < gw_knob_count; i++)
        if (!strcmp(gw_knobs[i].name, name))
            return &gw_knobs[i];
    return NULL;
}

static const gw_setting_row *row_of(const gw_setting_row *rows, size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(rows[i].name, name))
            return &rows[i];
    return NULL;
}

const gw_setting_row *gw_knob_setting(const gw_knob *knob) {
    return row_of(gw_setting_rows, gw_setting_count, knob->name);
}

/* The next of several words with blanks between; 0 when there is none, or it is too long. */
static int next_word(const char **rest, char *word, size_t size) {
    *rest += strspn(*rest, " ");
    const size_t length = strcspn(*rest, " ");
    if (length == 0 || length >= size)
        return 0;
    memcpy(word, *rest, length);
    word[length] = '\0';
    *rest += length;
    return 1;
}

gw_code gw_settings_assign_all(gw_settings *settings, const char *assignments, gw_error *error) {
    char word[2 * GW_KNOB_TEXT];
    while (next_word(&assignments, word, sizeof word)) {
        gw_code code = gw_settings_assign(settings, word, error);
        if (code)
            return code;
    }
    return *assignments ? gw_fail(error, GW_BAD_INPUT, "the assignment '%.80s' is too long", assignments)
                        : GW_OK;
}

/* --- sweeps */

typedef struct values {
    size_t count;
    double value[GW_KNOB_VALUES];
} values;

static void add_value(values *v, double value) {
    for (size_t i = 0; i < v->count; i++)
        if (v->value[i] == value)
            return;
    if (v->count < GW_KNOB_VALUES)
        v->value[v->count++] = value;
}

static int ascending(const void *a, const void *b) {
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* A quarter to four times the default; d is set to a value rounded as the setting holds it. */
static void add_powers(values *v, const gw_setting_row *row) {
    for (double factor = 0.25; factor <= 4; factor *= 2) {
        double value = fmin(fmax(row->initial * factor, row->minimum), row->maximum);
        add_value(v, row->kind == GW_SETTING_INTEGER ? round(value) : value);
    }
}

/* 0 when the sweep holds what the row does not take. */
static int add_own(values *v, const gw_setting_row *row, const char *sweep, gw_error *error) {
    char word[GW_KNOB_TEXT], assignment[2 * GW_KNOB_TEXT];
    gw_settings settings;
    gw_settings_init(&settings);
    while (next_word(&sweep, word, sizeof word)) {
        snprintf(assignment, sizeof assignment, "%.60s=%s", row->name, word);
        if (gw_settings_assign(&settings, assignment, error))
            return 0;
        add_value(v, gw_setting_value(&settings, row));
    }
    return 1;
}

static int sweep_of(const gw_knob *knob, const gw_setting_row *row, values *v, gw_error *error) {
    if (knob->sweep && !add_own(v, row, knob->sweep, error))
        return 0;
    if (!knob->sweep && (row->kind == GW_SETTING_SWITCH || row->kind == GW_SETTING_CHOICE))
        for (int i = 0; i <= (int)row->maximum; i++)
            add_value(v, i);
    else if (!knob->sweep)
        add_powers(v, row);
    add_value(v, row->initial);
    qsort(v->value, v->count, sizeof v->value[0], ascending);
    return 1;
}

size_t gw_knob_values(const gw_knob *knob, char out[GW_KNOB_VALUES][GW_KNOB_TEXT]) {
    const gw_setting_row *row = gw_knob_setting(knob);
    values v = {0};
    if (!row || !sweep_of(knob, row, &v, NULL))
        return 0;
    for (size_t i = 0; i < v.count; i++) {
        gw_settings settings;
        gw_settings_init(&settings);
        gw_setting_store(&settings, row, v.value[i]);
        gw_setting_text(&settings, row, out[i]);
    }
    return v.count;
}

/* --- what is not registered */

static gw_code check_knob(const gw_knob *knob, const gw_setting_row *row, gw_error *error) {
    values v = {0};
    char exact[2 * GW_KNOB_TEXT];
    gw_settings settings;
    gw_settings_init(&settings);
    if (!sweep_of(knob, row, &v, error))
        return gw_context(error, "base/knobs.c: the sweep of '%s'", knob->name);
    if (v.count < 2)
        return gw_fail(error, GW_BAD_INPUT,
                       "base/knobs.c: the sweep of '%s' is one value; give it a list of its own", knob->name);
    snprintf(exact, sizeof exact, "%.60s=%.60s", knob->name, knob->exact ? knob->exact : "");
    if (knob->exact && gw_settings_assign(&settings, exact, error))
        return gw_context(error, "base/knobs.c: the exact value");
    return knob->with && gw_settings_assign_all(&settings, knob->with, error)
               ? gw_context(error, "base/knobs.c: what '%s' goes with", knob->name)
               : GW_OK;
}

gw_code gw_knobs_check(const gw_setting_row *rows, size_t count, gw_error *error) {
    for (size_t i = 0; i < count; i++)
        if (!gw_knob_find(rows[i].name))
            return gw_fail(error, GW_BAD_INPUT,
                           "the setting '%s' is no knob; register in base/knobs.c which values the ledger is "
                           "to try and where it is exact",
                           rows[i].name);
    for (size_t i = 0; i < gw_knob_count; i++) {
        const gw_setting_row *row = row_of(rows, count, gw_knobs[i].name);
        gw_code code =
            row ? check_knob(&gw_knobs[i], row, error)
                : gw_fail(error, GW_BAD_INPUT, "base/knobs.c: there is no setting '%s'", gw_knobs[i].name);
        if (code)
            return code;
    }
    return GW_OK;
}
