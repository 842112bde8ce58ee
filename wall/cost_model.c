/* See cost_model.h. */
#include "wall/cost_model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct kind_text {
    const char *unit;
    double in_unit; /* a price in ms or bytes times this is in the unit */
    const char *terms[GW_COST_TERMS];
} kind_text;
static const kind_text kinds[] = {
    [GW_COST_TIME] = {"ns", 1e6, {"ray", "node", "test", "further_ray"}},
    [GW_COST_MEMORY] = {"bytes", 1, {"octree_byte", "triangle", "pixel", "renderer"}},
};

gw_cost_sample gw_cost_of_frame(const gw_counters *c, double ms) {
    return (gw_cost_sample){{(double)c->rays, (double)(c->node_loads + c->voxels), (double)c->triangle_tests,
                             (double)gw_secondary_rays(c)},
                            ms};
}

gw_cost_sample gw_cost_of_memory(const gw_octree *octree, const gw_scene *scene, uint64_t pixels,
                                 uint64_t bytes) {
    const double octree_bytes =
        (double)octree->node_count * (sizeof *octree->nodes + sizeof *octree->payloads) +
        (double)octree->reference_count * sizeof *octree->references +
        (double)octree->box_count * sizeof *octree->boxes;
    return (gw_cost_sample){{octree_bytes, scene->triangle_count, (double)pixels, 1}, (double)bytes};
}

double gw_cost_predict(const gw_cost_model *model, const gw_cost_sample *sample) {
    double sum = 0;
    for (int i = 0; i < GW_COST_TERMS; ++i)
        sum += model->prices[i] * sample->amounts[i];
    return sum;
}

/* --- fit -------------------------------------------------------------------------------------------------
 */

/* The normal equations of relative errors: rows a_i / m, right side 1. Terms are scaled to a diagonal of 1,
 * because a frame has a thousand times more tests than rays. */
typedef struct equations {
    double products[GW_COST_TERMS][GW_COST_TERMS], sides[GW_COST_TERMS], scales[GW_COST_TERMS];
    size_t count;
} equations;

static gw_code gather(const gw_cost_sample *samples, size_t count, equations *e, gw_error *error) {
    memset(e, 0, sizeof *e);
    e->count = count;
    for (size_t s = 0; s < count; ++s) {
        const double measured = samples[s].measured;
        if (!(measured > 0) || !isfinite(measured))
            return gw_fail(error, GW_BAD_INPUT, "sample %zu of a cost model measured %g; it must be above 0",
                           s, measured);
        for (int i = 0; i < GW_COST_TERMS; ++i) {
            const double amount = samples[s].amounts[i];
            if (!(amount >= 0) || !isfinite(amount))
                return gw_fail(error, GW_BAD_INPUT, "sample %zu of a cost model has an amount of %g", s,
                               amount);
            e->sides[i] += amount / measured;
            for (int j = 0; j < GW_COST_TERMS; ++j)
                e->products[i][j] += amount / measured * (samples[s].amounts[j] / measured);
        }
    }
    for (int i = 0; i < GW_COST_TERMS; ++i)
        e->scales[i] = e->products[i][i] > 0 ? 1 / sqrt(e->products[i][i]) : 0;
    for (int i = 0; i < GW_COST_TERMS; ++i) {
        e->sides[i] *= e->scales[i];
        for (int j = 0; j < GW_COST_TERMS; ++j)
            e->products[i][j] *= e->scales[i] * e->scales[j];
    }
    return GW_OK;
}

/* Gaussian elimination with the diagonal as pivots (the matrix is symmetric, not negative). Returns 0 when
 * the terms of the subset depend on each other. */
static int solve(const equations *e, unsigned subset, double out[GW_COST_TERMS]) {
    static const double least_pivot = 1e-10;
    double m[GW_COST_TERMS][GW_COST_TERMS + 1];
    int terms[GW_COST_TERMS] = {0}, count = 0;
    for (int i = 0; i < GW_COST_TERMS; ++i) {
        out[i] = 0;
        if (subset >> i & 1)
            terms[count++] = i;
    }
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j)
            m[i][j] = e->products[terms[i]][terms[j]];
        m[i][count] = e->sides[terms[i]];
    }
    for (int p = 0; p < count; ++p) {
        if (!(m[p][p] > least_pivot))
            return 0;
        for (int i = p + 1; i < count; ++i) {
            const double factor = m[i][p] / m[p][p];
            for (int j = p; j <= count; ++j)
                m[i][j] -= factor * m[p][j];
        }
    }
    for (int p = count - 1; p >= 0; --p) {
        double value = m[p][count];
        for (int j = p + 1; j < count; ++j)
            value -= m[p][j] * out[terms[j]];
        out[terms[p]] = value / m[p][p];
    }
    return 1;
}

/* Sum of squares of model / measured - 1, in scaled prices. */
static double residual(const equations *e, const double prices[GW_COST_TERMS]) {
    double sum = (double)e->count;
    for (int i = 0; i < GW_COST_TERMS; ++i) {
        sum -= 2 * prices[i] * e->sides[i];
        for (int j = 0; j < GW_COST_TERMS; ++j)
            sum += prices[i] * e->products[i][j] * prices[j];
    }
    return fmax(sum, 0);
}

gw_code gw_cost_fit(gw_cost_kind kind, const gw_cost_sample *samples, size_t count, gw_cost_model *out,
                    gw_error *error) {
    equations e;
    *out = (gw_cost_model){.kind = kind, .samples = count};
    if (count == 0)
        return gw_fail(error, GW_BAD_INPUT, "a cost model needs at least one measurement");
    gw_code code = gather(samples, count, &e, error);
    double least = INFINITY;
    for (unsigned subset = 1; subset < 1U << GW_COST_TERMS && !code; ++subset) {
        double prices[GW_COST_TERMS];
        if (!solve(&e, subset, prices))
            continue;
        int allowed = 1;
        for (int i = 0; i < GW_COST_TERMS; ++i)
            allowed = allowed && prices[i] >= 0;
        const double here = allowed ? residual(&e, prices) : (double)INFINITY;
        if (here < least - 1e-12 * (double)count) { /* the smaller subset where two explain it alike */
            least = here;
            for (int i = 0; i < GW_COST_TERMS; ++i)
                out->prices[i] = prices[i] * e.scales[i];
        }
    }
    out->error = sqrt(fmin(least, (double)count) / (double)count);
    return code;
}

/* --- verdicts --------------------------------------------------------------------------------------------
 */

gw_cost_verdict gw_cost_judge(const gw_cost_model *model, const gw_cost_sample *sample) {
    const double predicted = gw_cost_predict(model, sample), ratio = predicted / sample->measured;
    return (gw_cost_verdict){predicted, ratio, !(ratio <= GW_COST_FACTOR && ratio >= 1 / GW_COST_FACTOR)};
}

gw_code gw_cost_judge_left_out(gw_cost_kind kind, const gw_cost_sample *samples, size_t count, size_t which,
                               gw_cost_verdict *out, gw_error *error) {
    gw_cost_sample others[64];
    gw_cost_model model;
    size_t kept = 0;
    *out = (gw_cost_verdict){NAN, NAN, 1};
    if (count < 2 || which >= count)
        return GW_OK;
    /* Evenly, when there are more than the room holds. */
    const size_t step = (count + 63) / 64;
    for (size_t i = which % step; i < count && kept < 64; i += step)
        if (i != which)
            others[kept++] = samples[i];
    gw_code code = gw_cost_fit(kind, others, kept, &model, error);
    if (!code)
        *out = gw_cost_judge(&model, &samples[which]);
    return code;
}

/* --- telling ---------------------------------------------------------------------------------------------
 */

const char *gw_cost_term(gw_cost_kind kind, size_t term) {
    return kinds[kind].terms[term];
}

json_t *gw_cost_report(const gw_cost_model *model) {
    const kind_text *text = &kinds[model->kind];
    json_t *prices = json_object();
    for (int i = 0; i < GW_COST_TERMS; ++i)
        json_object_set_new(prices, text->terms[i], json_real(model->prices[i] * text->in_unit));
    return json_pack("{s:s, s:s, s:o, s:f, s:I}", "kind", model->kind == GW_COST_TIME ? "time" : "memory",
                     "unit", text->unit, "prices", prices, "error", model->error, "samples",
                     (json_int_t)model->samples);
}

void gw_cost_describe(const gw_cost_model *model, char *text, size_t size) {
    const kind_text *kind = &kinds[model->kind];
    size_t used = 0;
    if (size)
        text[0] = 0;
    for (int i = 0; i < GW_COST_TERMS && used < size; ++i) {
        const int length = snprintf(text + used, size - used, "%s%s %.3g %s", i ? " + " : "", kind->terms[i],
                                    model->prices[i] * kind->in_unit, kind->unit);
        used += length > 0 ? (size_t)length : 0;
    }
}
