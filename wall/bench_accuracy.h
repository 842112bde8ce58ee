/* What the parts of `bench accuracy` share: sweeping (bench_accuracy.c), judging (accuracy_judge.c),
 * searching (accuracy_search.c) and telling (accuracy_report.c, accuracy_plot.c, accuracy_page.c,
 * accuracy_sheet.c, accuracy_digest.c). */
#ifndef GW_WALL_BENCH_ACCURACY_H
#define GW_WALL_BENCH_ACCURACY_H

#include "wall/cost_model.h"
#include "wall/ledger.h"

/* One value of one knob, all others as they stand. */
typedef struct gw_accuracy_row {
    const gw_knob *knob;
    char value[GW_KNOB_TEXT];
    int standing;   /* 1: as it stands */
    int front;      /* 1: no other value of the knob is at once cheaper and better */
    int best_front; /* 1: nor one of any knob */
    gw_ledger_point point;
} gw_accuracy_row;

enum { GW_ACCURACY_FAULTS = 240 };

/* One knob's curve. */
typedef struct gw_accuracy_curve {
    const gw_knob *knob;
    size_t first, count;            /* rows */
    int idle;                       /* 1: no value changes error or work here */
    double least_work, most_work;   /* shares of the standing value's */
    double least_error, most_error; /* FLIP */
    double model_ratio; /* of the model's growth of error to the measured one, farthest from 1; 0: none */
    char fault[GW_ACCURACY_FAULTS]; /* "": none */
} gw_accuracy_curve;

typedef struct gw_accuracy_scene {
    char name[64];
    char path[512];
    uint32_t size[2], triangles;
    char hash[33];
    double pixels_per_degree;
    gw_ledger_point standing;
    char exact_key[33];
    gw_accuracy_row *rows; /* owned */
    size_t row_count, row_capacity;
    gw_accuracy_curve *curves; /* owned */
    size_t curve_count, curve_capacity;
    gw_cost_model model; /* of time; samples 0: none */
    size_t measured, found;
    json_t *found_profile; /* of the search, or NULL */
} gw_accuracy_scene;

typedef struct gw_accuracy {
    gw_bench *bench;
    const char *clock;         /* "processor" or "wall" */
    int counted;               /* 1: frames were timed while they counted */
    gw_accuracy_scene *scenes; /* owned */
    size_t scene_count;
} gw_accuracy;

/* --- accuracy_judge.c: pure functions of what was measured */

/* Marks what no other row of its knob, and of the scene, beats in both work and FLIP. */
void gw_accuracy_mark_fronts(gw_accuracy_scene *scene);
/* Shares, extremes and faults of a curve: an error that rises towards the knob's exact value, pixels that are
 * no numbers, rays that were cut off. */
void gw_accuracy_judge(const gw_accuracy_scene *scene, gw_accuracy_curve *curve);
/* Faults of all curves. */
size_t gw_accuracy_faults(const gw_accuracy *accuracy);
/* One sentence: what the knob costs. */
void gw_accuracy_sentence(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve, char *text,
                          size_t size);

/* --- accuracy_search.c */

/* What measures a choice of settings against the exact frame. */
typedef struct gw_accuracy_instrument {
    gw_code (*measure)(void *context, const gw_settings *settings, gw_ledger_point *out, gw_error *error);
    void *context;
} gw_accuracy_instrument;

/* Whether bench->max_errors, max_cost and save_profile make a goal. */
gw_code gw_accuracy_check_goal(const gw_bench *bench, gw_error *error);
/* The cheapest settings within bench->max_errors, or the best within bench->max_cost, never worse than a
 * value of one knob that was swept, nor, where they are within the bound, than the exact settings; writes
 * bench->save_profile. */
gw_code gw_accuracy_search(gw_accuracy_scene *scene, const gw_bench *bench,
                           const gw_accuracy_instrument *instrument, gw_error *error);

/* --- accuracy_report.c, accuracy_sheet.c, accuracy_digest.c, accuracy_page.c, accuracy_plot.c */

/* The errors that tables show, in their order; files have all. */
typedef struct gw_accuracy_column {
    gw_metric metric;
    const char *name, *format;
} gw_accuracy_column;
enum { GW_ACCURACY_COLUMNS = 9 };
extern const gw_accuracy_column gw_accuracy_columns[GW_ACCURACY_COLUMNS];
/* 0: of frames in a row, and there were none. */
int gw_accuracy_shows(const gw_accuracy_scene *scene, size_t column);

/* CSV, JSON, plots. */
gw_code gw_accuracy_write(const gw_accuracy *accuracy, gw_error *error);
/* A page of Markdown and a picture of one scene, into its folder. */
gw_code gw_accuracy_sheet(const gw_accuracy *accuracy, const gw_accuracy_scene *scene, gw_error *error);
/* FOLDER/accuracy.md: what each knob costs, in a sentence, and its model beside what was measured, over all
 * scenes. */
gw_code gw_accuracy_digest(const gw_accuracy *accuracy, gw_error *error);
gw_code gw_accuracy_page(const gw_accuracy *accuracy, gw_error *error);
void gw_accuracy_print(const gw_accuracy *accuracy);

/* The plot of a curve, or of all of a scene's (NULL), as SVG text for free(), or as a picture. */
gw_code gw_accuracy_plot(const gw_accuracy_scene *scene, const gw_accuracy_curve *curve, char **svg,
                         size_t *size, gw_image *image, gw_error *error);

#endif
