/* What effects got to do: how many rays and fragments, frame by frame, and what reports tell of it. Effects
 * of materials are counted by material, so that this knows of every effect that a material calls for. */
#include "render/renderer_internal.h"

#include "base/memory.h"

#include <stddef.h>
#include <stdlib.h>

/* Effects whose rays are counted in every frame, and voxels. */
static const struct {
    gw_features bit;
    size_t counter;
    int counting; /* 1: only where work is counted */
} own_counters[] = {{GW_FEATURE_SHADOWS, offsetof(gw_counters, shadow_rays), 0},
                    {GW_FEATURE_MIRROR, offsetof(gw_counters, mirror_rays), 0},
                    {GW_FEATURE_GLOSSY, offsetof(gw_counters, glossy_rays), 0},
                    {GW_FEATURE_TRANSMISSION, offsetof(gw_counters, refracted_rays), 0},
                    {GW_FEATURE_OCCLUSION, offsetof(gw_counters, cone_rays), 0},
                    {GW_FEATURE_DIFFUSE, offsetof(gw_counters, cone_rays), 0}, /* the same cones */
                    {GW_FEATURE_LOD, offsetof(gw_counters, voxels), 1}};

static uint64_t own_count(size_t row, const gw_counters *counters) {
    return *(const uint64_t *)(const void *)((const char *)counters + own_counters[row].counter);
}

uint64_t gw_secondary_rays(const gw_counters *counters) {
    return counters->shadow_rays + counters->mirror_rays + counters->glossy_rays + counters->refracted_rays +
           counters->cone_rays;
}

static const size_t tail_begin = GW_TOTAL_WORDS * sizeof(uint32_t);

static size_t tail_size(const gw_renderer *renderer) {
    return renderer->scene->material_count * sizeof(uint32_t);
}

gw_code gw_effects_begin(gw_frame_job *job, gw_error *error) {
    gw_renderer *renderer = job->renderer;
    void *zeros = NULL;
    if (!job->key.count || tail_size(renderer) == 0)
        return GW_OK;
    gw_code code = gw_allocate(&zeros, tail_size(renderer), 1, "counts of materials", error);
    if (!code)
        code = gw_gl_buffer_write(&renderer->totals, tail_begin, tail_size(renderer), zeros, error);
    free(zeros);
    return code;
}

/* Fragments of the materials that call for each effect; *known: effects that some material calls for. */
static gw_code count_materials(gw_frame_job *job, gw_features *known, uint64_t met[GW_MOST_FEATURES],
                               gw_error *error) {
    gw_renderer *renderer = job->renderer;
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, tail_size(renderer), 1, "counts of materials", error);
    if (!code)
        code = gw_gl_buffer_read(&renderer->totals, tail_begin, tail_size(renderer), memory, error);
    const uint32_t *fragments = memory;
    for (uint32_t m = 0; !code && m < renderer->scene->material_count; ++m) {
        const gw_features bits =
            gw_features_of_material(&renderer->scene->materials[m], renderer->mirror_roughness);
        *known |= bits;
        for (size_t i = 0; i < GW_MOST_FEATURES; ++i)
            met[i] += bits & GW_FEATURE_BIT(i) ? fragments[m] : 0;
    }
    free(memory);
    return code;
}

gw_code gw_effects_end(gw_frame_job *job, gw_error *error) {
    const gw_features called_for = job->renderer->scene_features | job->renderer->last_features;
    gw_features known = 0;
    uint64_t met[GW_MOST_FEATURES] = {0};
    gw_code code = job->key.count ? count_materials(job, &known, met, error) : GW_OK;
    for (size_t i = 0; i < sizeof own_counters / sizeof *own_counters; ++i) {
        if (own_counters[i].counting && !job->key.count)
            continue;
        known |= own_counters[i].bit;
        for (size_t k = 0; k < GW_MOST_FEATURES; ++k)
            if (own_counters[i].bit == GW_FEATURE_BIT(k))
                met[k] = own_count(i, &job->counters);
    }
    known &= called_for;
    for (size_t i = 0; !code && i < GW_MOST_FEATURES; ++i) {
        if (!(known & GW_FEATURE_BIT(i)))
            continue;
        gw_effect_use *use = &job->counters.effects[i];
        use->frames = 1;
        use->idle = met[i] == 0;
        use->met = met[i];
    }
    return code;
}

gw_features gw_renderer_features(const gw_renderer *renderer) {
    return (renderer->scene_features | renderer->last_features) & ~renderer->forbidden_features;
}

/* {name: {met, frames, idle}} of the effects whose use is known. */
static json_t *met_by_effects(const gw_counters *counters) {
    json_t *object = json_object();
    for (size_t i = 0; i < gw_feature_count && object; ++i)
        for (size_t k = 0; k < GW_MOST_FEATURES; ++k) {
            const gw_effect_use *use = &counters->effects[k];
            if (gw_feature_rows[i].bit == GW_FEATURE_BIT(k) && use->frames > 0)
                json_object_set_new(object, gw_feature_rows[i].name,
                                    json_pack("{s:I, s:I, s:I}", "met", (json_int_t)use->met, "frames",
                                              (json_int_t)use->frames, "idle", (json_int_t)use->idle));
        }
    return object;
}

static json_t *skipped_feature(const gw_renderer *renderer, const gw_feature_row *row) {
    const int open = !renderer->has_drawn && (row->bit & GW_FRAME_FEATURES);
    return json_pack("{s:s, s:s}", "name", row->name, "why",
                     open ? "each frame decides; none was drawn" : row->absent);
}

/* Of the device's specialised kernels; and of those that this renderer had made in the background. */
static json_t *variants_json(const gw_renderer *renderer) {
    const gw_gl_variant_counts counts = gw_gl_variant_counts_of(renderer->device);
    const gw_gl_program_counts programs = gw_gl_program_counts_of(renderer->device);
    uint32_t made, failed;
    int busy;
    gw_background_count(renderer->background, &made, &failed, &busy);
    return json_pack("{s:i, s:I, s:I, s:I, s:I, s:I, s:s, s:i, s:i, s:b, s:i}", "alive", (int)counts.alive,
                     "programs", (json_int_t)counts.programs, "deleted", (json_int_t)counts.deleted,
                     "compiled", (json_int_t)programs.compiled, "read", (json_int_t)programs.read, "refused",
                     (json_int_t)programs.refused, "making",
                     gw_makes_in_background(renderer) ? "background" : "at once", "background", (int)made,
                     "failed", (int)failed, "pending", busy, "stand_in_frames", (int)renderer->stood_in);
}

gw_code gw_renderer_report(const gw_renderer *renderer, const gw_counters *counters, json_t *report,
                           gw_error *error) {
    json_t *run = json_array(), *skipped = json_array(), *forced = json_array(), *forbidden = json_array();
    json_t *met = counters ? met_by_effects(counters) : json_object();
    int failed = !run || !skipped || !forced || !forbidden || !met;
    gw_features called_for = renderer->scene_features | renderer->last_features;
    for (size_t i = 0; i < gw_feature_count && !failed; ++i) {
        const gw_feature_row *row = &gw_feature_rows[i];
        if (renderer->forbidden_features & row->bit)
            failed = json_array_append_new(forbidden, json_string(row->name));
        else if (called_for & row->bit)
            failed = json_array_append_new(run, json_string(row->name));
        else if (renderer->forced_features & row->bit)
            failed = json_array_append_new(forced, json_string(row->name));
        else
            failed = json_array_append_new(skipped, skipped_feature(renderer, row));
    }
    json_t *effects =
        failed ? NULL
               : json_pack("{s:O, s:O, s:O, s:O, s:O, s:o}", "run", run, "skipped", skipped, "forced", forced,
                           "forbidden", forbidden, "met", met, "variants", variants_json(renderer));
    json_t *rebuild = effects && renderer->moving ? gw_moving_report(renderer->moving) : NULL;
    if (effects && renderer->moving)
        failed = json_object_set_new(report, "rebuild", rebuild);
    json_decref(met);
    json_decref(run);
    json_decref(skipped);
    json_decref(forced);
    json_decref(forbidden);
    if (!effects || failed || json_object_set_new(report, "effects", effects))
        return gw_fail(error, GW_MACHINE, "no memory for the report of effects");
    return gw_renderer_report_lights(renderer, report, error);
}
