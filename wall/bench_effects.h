/* What the two halves of `bench effects` share: measuring (bench_effects.c) and telling
 * (bench_effects_report.c). */
#ifndef GW_WALL_BENCH_EFFECTS_H
#define GW_WALL_BENCH_EFFECTS_H

#include "render/features.h"
#include "wall/bench_view.h"

enum { GW_EFFECTS_ROUNDS = 64 /* most times that a frame is drawn */ };

/* One frame of one scene in one quality, drawn with and without one effect. */
typedef struct gw_effect_price {
    const char *scene;   /* its file, or the demo's name */
    const char *quality; /* "full" or "foveated" */
    const char *name;    /* of the effect */
    int used;            /* 1: called for, and left out for comparison; 0: compiled in without need */
    gw_counters with, without;
    uint64_t bytes_with, bytes_without; /* on the GPU */
    double ms_with, ms_without;         /* medians */
    double spread;                      /* half of what lies between the quartiles, of ms_with */
    double cost;                        /* median of the rounds' ms_with / ms_without, less 1 */
    double flip, mean;                  /* of leaving it out: mean FLIP, mean difference in 1/255 */
    int changed;                        /* 1: pixels differ; of an unused effect a fault */
} gw_effect_price;

typedef struct gw_effect_prices {
    gw_bench *bench;
    gw_effect_price *rows;
    size_t count, capacity;
    uint32_t rounds, size[2]; /* px */
    int by_processor;         /* 1: times are the process's: software GL runs there, and so may others */
} gw_effect_prices;

/* Below it, an effect is listed as cheap. */
#define GW_CHEAP_EFFECT 0.02

/* Fills bench->report's "bench", writes effects.csv, effects.json and effects.svg, if there is a folder. */
gw_code gw_effects_write(const gw_effect_prices *prices, gw_error *error);
void gw_effects_print(const gw_effect_prices *prices);

#endif
