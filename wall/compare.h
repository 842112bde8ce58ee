/* The parts of `gazewall compare`: two pictures (verb_compare.c), or the frames of a recorded run against
 * what they would have been without approximations (compare_states.c). One thread. */
#ifndef GW_WALL_COMPARE_H
#define GW_WALL_COMPARE_H

#include "render/metrics.h"
#include "wall/console.h"
#include "wall/sim_options.h"

#include <jansson.h>
#include <stdio.h>

typedef struct gw_compare {
    gw_draw_options draw;
    gw_wall_options wall;
    const char *pictures[2]; /* reference, test; both NULL with states */
    const char *states, *out, *csv;
    int64_t frames;           /* of the states, from the first on; 0: all */
    double pixels_per_degree; /* of pictures; 0: FLIP's own */
    int gazed;                /* of pictures: somebody looks at gaze, px */
    double gaze[2];
    double luminance; /* cd/m^2 of white, for who reads the pairs */
    gw_console console;
    json_t *report;
} gw_compare;

/* Draws every state and its exact counterpart, and compares them. *out: of the whole run. rows: CSV, a line
 * for each frame. */
gw_code gw_compare_states(gw_compare *compare, FILE *rows, gw_metrics *out, gw_error *error);

/* "name,name,..." and "value,value,..." of all metrics; what was not measured is empty. */
void gw_compare_write_names(FILE *file);
void gw_compare_write_values(FILE *file, const gw_metrics *metrics);

/* Where a run's pairs of frames go that FovVideoVDP reads (docs/metrics.md). */
typedef struct gw_pair_folder {
    const char *folder;
    uint32_t width, height, frames;
    double pitch;            /* mm per pixel */
    double distances, least; /* mm from the eye to the plane: sum, nearest */
    FILE *fixations;         /* owned */
    char *text;
    size_t size;
} gw_pair_folder;
gw_code gw_pair_folder_open(gw_pair_folder *pairs, const char *folder, const gw_plane *plane, uint32_t width,
                            uint32_t height, gw_error *error);
/* gaze: px, NULL: nobody's is known. */
gw_code gw_pair_folder_add(gw_pair_folder *pairs, const gw_image *reference, const gw_image *test,
                           const gw_plane *plane, const gw_frame_state *state, const double *gaze,
                           gw_error *error);
/* Writes fixations.csv and display_models.json; luminance: cd/m^2 of white. */
gw_code gw_pair_folder_close(gw_pair_folder *pairs, double luminance, gw_error *error);
void gw_pair_folder_finish(gw_pair_folder *pairs);

#endif
