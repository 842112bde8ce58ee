/* The ledger's instrument: one scene in one view, drawn with any settings and compared with the exact frame.
 *
 * A point is what one choice of settings costs and how wrong it is. It is named by a hash of all that it
 * depends on (scene, view, settings, shaders, version), kept with its pictures in a folder of the scene's own
 * as soon as it is measured, and never measured twice: a run that was ended goes on where it was. The view is
 * that of a viewer who stands near a wide wall and looks near its left end, so that the frame has all that a
 * gaze brings. Geometry (hits, depths, normals, silhouettes) is compared in it, too; flicker over several
 * views in a row, if bench->frames says so. One thread, the device's. */
#ifndef GW_WALL_LEDGER_H
#define GW_WALL_LEDGER_H

#include "base/knobs.h"
#include "render/metrics.h"
#include "wall/bench_view.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

enum { GW_LEDGER_MOMENTS = 64 };

/* Deterministic costs, all doubles so that tables, files and searches treat them alike. */
typedef enum gw_ledger_cost {
    GW_LEDGER_WORK,  /* rays of all kinds, node loads, voxels and triangle tests, added up */
    GW_LEDGER_RAYS,  /* of pixels and secondary */
    GW_LEDGER_MS,    /* median of the frame; of the processor where GL is software */
    GW_LEDGER_BYTES, /* on the GPU */
    GW_LEDGER_BUILD, /* overlap tests of the octree's build */
    GW_LEDGER_COSTS
} gw_ledger_cost;
extern const char *const gw_ledger_cost_names[GW_LEDGER_COSTS];

typedef struct gw_ledger_point {
    char key[33];
    gw_metrics errors; /* against the exact frame */
    double own;        /* FLIP against the same settings but with the knob's exact value; NAN: it has none */
    gw_counters counters;
    double costs[GW_LEDGER_COSTS];
    double spread_ms;        /* half of what lies between the quickest and the 95th percentile */
    double predicted, worst; /* predicted error (render/predicted_error.h): mean and worst */
    uint64_t octree_bytes, nodes, pairs;
} gw_ledger_point;

/* Everything that names a frame of the ledger beside scene and views. */
typedef struct gw_ledger_frame {
    gw_settings settings;
    double age;      /* s, of the gaze */
    int exact;       /* 1: nobody looks: sharp everywhere */
    uint32_t moment; /* of the views; 0: the still one that errors are told of */
} gw_ledger_frame;

/* A picture of which frame. */
typedef struct gw_ledger_slot {
    gw_image image;
    char key[33]; /* "": none yet */
} gw_ledger_slot;

/* What is seen in a moment, and by whom. */
typedef struct gw_ledger_view {
    gw_bench_view view;
    double gaze_eye[3], gaze_at[3]; /* mm */
} gw_ledger_view;

/* A frame, and what it is compared with. */
typedef struct gw_ledger_question {
    gw_ledger_frame frame, exact;
    const gw_ledger_frame *own; /* of a knob: the frame with its exact value, or NULL */
} gw_ledger_question;

typedef struct gw_ledger {
    gw_bench *bench;
    const char *path; /* of the scene, NULL: the demo */
    char name[64];    /* of its folder */
    char *folder;     /* owned; NULL: nothing is kept */
    gw_ledger_view views[GW_LEDGER_MOMENTS];
    uint32_t moments; /* at least 1; more: flicker is told, too */
    uint32_t size[2], repeats;
    int by_processor;  /* 1: times are the process's: software GL runs there */
    gw_hash identity;  /* of scene, view and program */
    gw_settings built; /* what the open octree was built with */
    gw_renderer *counting, *timed;
    gw_ledger_slot exact[GW_LEDGER_MOMENTS], own; /* what frames are compared with */
    gw_geometry exact_geometry, geometry;
    char exact_geometry_key[33]; /* "": none yet */
    gw_image picture, moving;    /* of the still view, and of later moments */
    gw_ledger_point *known;      /* measured so far */
    size_t known_count, known_capacity;
    int torn;               /* the file of points ends in the middle of a line */
    size_t measured, found; /* in this run; of earlier ones */
} gw_ledger;

/* Imports the scene into the bench's model, and reads what is known of it. name: of the folder. */
gw_code gw_ledger_open(gw_ledger *ledger, gw_bench *bench, const char *path, const char *name,
                       gw_error *error);
void gw_ledger_close(gw_ledger *ledger);

/* The frame against the exact one, with pictures; or what is known of it. */
gw_code gw_ledger_measure(gw_ledger *ledger, const gw_ledger_question *question, gw_ledger_point *out,
                          gw_error *error);

/* The exact frame to settings: those with every knob's exact value, and of those of their own only `swept`'s
 * (may be NULL). */
gw_code gw_ledger_exact(const gw_settings *settings, const gw_knob *swept, gw_ledger_frame *out,
                        gw_error *error);

/* Where a point's picture or difference lies; free() it. NULL: nowhere, or memory is out. */
char *gw_ledger_picture(const gw_ledger *ledger, const char *key, int difference);

/* --- ledger_store.c */

/* The key of a question, and of a frame by itself. */
void gw_ledger_key(const gw_ledger *ledger, const gw_ledger_question *question, char key[33]);
void gw_ledger_frame_key(const gw_ledger *ledger, const gw_ledger_frame *frame, char key[33]);
gw_code gw_ledger_load(gw_ledger *ledger, gw_error *error);
const gw_ledger_point *gw_ledger_find(const gw_ledger *ledger, const char *key);
/* Adds it to what is known, and to the file. */
gw_code gw_ledger_keep(gw_ledger *ledger, const gw_ledger_point *point, gw_error *error);
/* Hash of the shaders in use: embedded, or those of a folder. */
gw_code gw_ledger_hash_shaders(const char *folder, gw_hash *hash, gw_error *error);
/* A point as JSON, and back; 0 when it is not one. */
json_t *gw_ledger_pack(const gw_ledger_point *point);
int gw_ledger_take(const json_t *object, gw_ledger_point *out);

#endif
