/* `gazewall bench effects`: the price list. Each scene is drawn with each effect that it calls for and
 * without, at full quality and foveated: rays, work, bytes, time, and the error of leaving the effect out;
 * and with effects compiled in that nothing calls for. */
#include "wall/bench_effects.h"

#include "base/clock.h"
#include "base/memory.h"
#include "render/flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char demo_name[] = "demo";

/* Of one scene in one quality. */
typedef struct pricing {
    gw_effect_prices *prices;
    gw_bench_view view;
    gw_frame_state state;
    const char *scene, *quality;
    gw_features called_for, forced, forbidden; /* the last two: by the command line */
    gw_renderer *counting, *timed;             /* with all that is called for; quick: one renderer */
    gw_counters counters;
    gw_image picture, other; /* with all; of the variant */
    uint32_t timings;
} pricing;

static gw_code open_renderer(const pricing *p, gw_features forced, gw_features forbidden, int count,
                             gw_renderer **out, gw_error *error) {
    const gw_bench *bench = p->prices->bench;
    gw_renderer_options options = gw_bench_rendering(bench, count);
    options.force_features |= forced;
    options.forbid_features |= forbidden;
    return gw_renderer_create(bench->model.device, bench->model.scene, bench->model.octree, &options, out,
                              error);
}

static gw_code draw(const pricing *p, gw_renderer *renderer, gw_image *out, gw_counters *counters,
                    gw_error *error) {
    return gw_renderer_frame(renderer, &p->view.placement, &p->view.plane, &p->view.rectangle, &p->state,
                             out->rgba, counters, error);
}

static int by_size(const void *a, const void *b) {
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* Sorts. */
static double quantile(double *values, uint32_t count, double share) {
    qsort(values, count, sizeof *values, by_size);
    return values[(uint32_t)lround(share * (count - 1))];
}

/* The eye goes to and fro by less than any float can tell, so that no frame is a still view's, which would be
 * there already where samples accumulate. It does not go on: what is drawn later is compared with what was
 * drawn first. */
static gw_code time_frame(pricing *p, gw_renderer *renderer, gw_image *scratch, double *ms, gw_error *error) {
    const int processor = p->prices->by_processor;
    const double eye = p->state.eye[0];
    p->state.eye[0] += (1 + p->timings++ / 2 % 2) * 1e-9 * fmax(fabs(eye), 1);
    const int64_t begin = processor ? gw_processor_ns() : gw_now_ns();
    gw_code code = draw(p, renderer, scratch, NULL, error);
    *ms = (double)((processor ? gw_processor_ns() : gw_now_ns()) - begin) * 1e-6;
    p->state.eye[0] = eye;
    return code;
}

/* In turns, so that what else the machine does hits both alike. */
static gw_code time_both(pricing *p, gw_renderer *variant, gw_effect_price *row, gw_error *error) {
    double mine[GW_EFFECTS_ROUNDS], theirs[GW_EFFECTS_ROUNDS], ratios[GW_EFFECTS_ROUNDS];
    const uint32_t rounds = p->prices->rounds;
    double warm_up;
    gw_code code = time_frame(p, p->timed, &p->other, &warm_up, error);
    if (!code)
        code = time_frame(p, variant, &p->other, &warm_up, error);
    for (uint32_t i = 0; i < rounds && !code; i++) {
        code = time_frame(p, p->timed, &p->other, &mine[i], error);
        if (!code)
            code = time_frame(p, variant, &p->other, &theirs[i], error);
        ratios[i] = row->used ? mine[i] / theirs[i] : theirs[i] / mine[i];
    }
    if (code)
        return code;
    double *with = row->used ? mine : theirs, *without = row->used ? theirs : mine;
    row->ms_with = quantile(with, rounds, 0.5);
    row->spread = (quantile(with, rounds, 0.75) - quantile(with, rounds, 0.25)) / 2;
    row->ms_without = quantile(without, rounds, 0.5);
    row->cost = quantile(ratios, rounds, 0.5) - 1;
    return GW_OK;
}

static gw_code compare(const pricing *p, gw_effect_price *row, gw_error *error) {
    const size_t bytes = (size_t)p->picture.width * p->picture.height * 4;
    double sum = 0;
    for (size_t i = 0; i < bytes; i++)
        sum += abs(p->picture.rgba[i] - p->other.rgba[i]);
    row->mean = sum / ((double)bytes * 3 / 4);
    row->changed = memcmp(p->picture.rgba, p->other.rgba, bytes) != 0;
    return row->changed ? gw_flip(&p->picture, &p->other, p->view.pixels_per_degree, NULL, &row->flip, error)
                        : GW_OK;
}

/* The frame with `bits` left out, or compiled in without need. */
static gw_code price(pricing *p, const char *name, gw_features bits, int used, gw_error *error) {
    gw_effect_prices *prices = p->prices;
    gw_effect_price row = {.scene = p->scene, .quality = p->quality, .name = name, .used = used};
    const gw_features forced = used ? 0 : bits, forbidden = used ? bits : 0;
    gw_renderer *counting = NULL, *timed = NULL;
    gw_counters counters = {0};
    gw_code code = open_renderer(p, forced, forbidden, 1, &counting, error);
    if (!code)
        code = draw(p, counting, &p->other, &counters, error);
    if (!code)
        code = compare(p, &row, error);
    row.with = used ? p->counters : counters;
    row.without = used ? counters : p->counters;
    if (!code)
        row.bytes_with = gw_renderer_bytes(used ? p->counting : counting);
    if (!code)
        row.bytes_without = gw_renderer_bytes(used ? counting : p->counting);
    if (!code && p->timed != p->counting) {
        gw_renderer_destroy(&counting);
        code = open_renderer(p, forced, forbidden, 0, &timed, error);
    }
    if (!code)
        code = time_both(p, timed ? timed : counting, &row, error);
    gw_renderer_destroy(&counting);
    gw_renderer_destroy(&timed);
    if (!code)
        code = gw_grow((void **)&prices->rows, &prices->capacity, prices->count + 1, sizeof row, "prices",
                       error);
    if (!code)
        prices->rows[prices->count++] = row;
    return code;
}

/* Effects that are called for one by one; the others one by one too, or quick: all at once. */
static gw_code price_all(pricing *p, double begin, double share, gw_error *error) {
    const gw_bench *bench = p->prices->bench;
    const gw_features set = p->forced | p->forbidden | GW_NEEDED_FEATURES;
    gw_features unused = 0;
    gw_code code = GW_OK;
    for (size_t i = 0; i < gw_feature_count && !code; i++) {
        const gw_feature_row *row = &gw_feature_rows[i];
        const int used = (p->called_for & row->bit) != 0;
        gw_log_progress(&bench->console.log, "pricing effects",
                        begin + share * (double)i / (double)gw_feature_count);
        if (!used && !(row->bit & (p->forced | p->forbidden)))
            unused |= row->bit;
        if (row->bit & set || (!used && bench->quick))
            continue;
        code = price(p, row->name, row->bit, used, error);
        if (code)
            return gw_context(error, "the effect '%s' of %s", row->name, p->scene);
    }
    /* Either alone still traces the cones of the other. */
    if (!code && (p->called_for & GW_CONE_FEATURES & ~set) == GW_CONE_FEATURES)
        code = price(p, "cones", GW_CONE_FEATURES, 1, error);
    return code || !bench->quick || !unused ? code : price(p, "all unused", unused, 0, error);
}

static gw_code open_pricing(pricing *p, gw_error *error) {
    gw_effect_prices *prices = p->prices;
    gw_code code = gw_image_create(prices->size[0], prices->size[1], &p->picture, error);
    if (!code)
        code = gw_image_create(prices->size[0], prices->size[1], &p->other, error);
    if (!code)
        code = open_renderer(p, 0, 0, 1, &p->counting, error);
    p->timed = p->counting;
    if (!code && !prices->bench->quick)
        code = open_renderer(p, 0, 0, 0, &p->timed, error);
    if (!code)
        code = draw(p, p->counting, &p->picture, &p->counters, error);
    if (!code)
        p->called_for = gw_renderer_features(p->counting);
    return code;
}

static void close_pricing(pricing *p) {
    if (p->timed != p->counting)
        gw_renderer_destroy(&p->timed);
    gw_renderer_destroy(&p->counting);
    gw_image_finish(&p->picture);
    gw_image_finish(&p->other);
}

static gw_code price_quality(gw_effect_prices *prices, const gw_bench_view *view, const char *scene,
                             int foveated, double begin, double share, gw_error *error) {
    pricing p = {.prices = prices,
                 .view = *view,
                 .state = gw_bench_state(prices->bench, view, foveated),
                 .scene = scene,
                 .quality = foveated ? "foveated" : "full",
                 .forced = prices->bench->draw.force_effects,
                 .forbidden = prices->bench->draw.forbid_effects};
    if (!foveated)
        p.state.tau = p.state.tau_inside = 0;
    gw_code code = open_pricing(&p, error);
    if (!code)
        code = price_all(&p, begin, share, error);
    close_pricing(&p);
    return code;
}

static gw_code price_scene(gw_effect_prices *prices, const char *path, double begin, double share,
                           gw_error *error) {
    gw_bench *bench = prices->bench;
    gw_bench_path along;
    gw_bench_view view;
    bench->draw.scene = path;
    gw_code code = gw_model_import(&bench->model, &bench->draw, &bench->console.log, error);
    if (!code)
        code = gw_model_build(&bench->model, &bench->draw, &bench->console.log, error);
    if (!code)
        code = gw_bench_path_open(bench, bench->quick ? 96 : 384, &along, error);
    if (!code) {
        memcpy(prices->size, along.size, sizeof prices->size);
        code = gw_bench_view_at(&along, along.path ? GW_PATH_FRAMES / 2 : 0, &view, error);
    }
    for (int foveated = 0; foveated < 2 && !code; foveated++)
        code = price_quality(prices, &view, path ? path : demo_name, foveated, begin + share * foveated / 2,
                             share / 2, error);
    gw_model_drop(&bench->model);
    return code;
}

gw_code gw_bench_effects(gw_bench *bench, gw_error *error) {
    gw_effect_prices prices = {.bench = bench,
                               .rounds = bench->repeats ? bench->repeats
                                         : bench->quick ? 2
                                                        : 7,
                               .by_processor = gw_gl_limits_of(bench->model.device)->software};
    const size_t count = bench->scene_count ? bench->scene_count : 1;
    gw_code code = GW_OK;
    if (prices.rounds > GW_EFFECTS_ROUNDS)
        code = gw_fail(error, GW_BAD_INPUT, "--repeats: bench effects draws a frame %d times at most",
                       GW_EFFECTS_ROUNDS);
    for (size_t i = 0; i < count && !code; i++) {
        code = price_scene(&prices, bench->scene_count ? bench->scenes[i] : bench->draw.scene,
                           (double)i / (double)count, 1.0 / (double)count, error);
        /* What is there so far, so that a long run that is ended has told something. */
        if (!code)
            code = gw_effects_write(&prices, error);
    }
    if (!code && !bench->draw.quiet) {
        gw_console_finish(&bench->console);
        gw_effects_print(&prices);
    }
    free(prices.rows);
    return code;
}
