/* Reading command lines: glibc argp, without its exits and messages, so that every error is one sentence of
 * ours that names the nearest known option; and the options that all drawing verbs share. Main thread only
 * (getopt keeps global state). */
#ifndef GW_WALL_OPTIONS_H
#define GW_WALL_OPTIONS_H

#include "base/log.h"
#include "base/settings.h"
#include "base/status.h"
#include "render/features.h"
#include "render/frame_state.h"
#include "render/renderer.h"
#include "wall/profile.h"

#include <argp.h>
#include <stdint.h>

enum { GW_CARRIED_PROFILES = 4 };

/* The options common to all drawing verbs. Texts point into argv. */
typedef struct gw_draw_options {
    gw_error *error;       /* where the parser leaves its sentence; set before parsing */
    const char *scene;     /* NULL: the embedded demo scene */
    const char *animation; /* of the scene's models: a name, a number, "all", "none"; NULL: the first */
    const char *report;    /* file for the JSON report, or NULL */
    const char *shaders;   /* folder of shaders instead of the embedded ones, or NULL */
    const char *cache;     /* folder where octrees are kept from run to run; "none"; NULL: not said */
    uint64_t cache_limit;  /* bytes that the folder may hold */
    int keeps;             /* the verb keeps octrees unless told otherwise */
    gw_settings settings;
    gw_profile profile; /* that they started from */
    size_t carried_count;
    const char *carried[GW_CARRIED_PROFILES]; /* "WORD\nTEXT": files that --profile WORD names, read where the
                                                 wall was launched */
    size_t profile_count;
    const char *profiles[GW_CARRIED_PROFILES]; /* the words of --profile, for the ranks to be given */
    uint32_t seed;
    double time; /* s */
    gw_debug_view debug;
    gw_features force_effects, forbid_effects; /* gw_feature bits, never both of one */
    int choose_gpu;                            /* 1: on the EGL device `gpu` and no other */
    int32_t gpu;
    gw_kernel_making kernels;
    gw_log_level level;
    int quiet;
    int count; /* count steps, node loads and triangle tests (slower, same pixels) */
} gw_draw_options;

void gw_draw_options_init(gw_draw_options *options, gw_error *error);

/* As a child of a verb's argp; its input is a gw_draw_options. */
extern const struct argp gw_draw_argp;
/* The part of it that says which octree, for verbs that draw nothing. */
extern const struct argp gw_scene_argp;

/* GW_BAD_INPUT, naming it, if the options change anything that recorded frame states hold: a setting of
 * frames, seed, time, debug view. */
gw_code gw_draw_options_decide_frames(const gw_draw_options *options, gw_error *error);

/* Parses argv with argp. GW_OK with *helped = 1 when --help was asked for and has been printed. The parsers
 * of argp return EINVAL after gw_fail() on `error`. */
gw_code gw_arguments_parse(const struct argp *argp, int argc, char **argv, void *input, int *helped,
                           gw_error *error);

/* "960x540": two integers in 1..maximum. name is the option's name for the message. */
gw_code gw_parse_pair(const char *name, const char *text, uint32_t maximum, uint32_t out[2], gw_error *error);
/* Exactly count comma-separated finite numbers. */
gw_code gw_parse_numbers(const char *name, const char *text, size_t count, double *out, gw_error *error);
/* 1..limit comma-separated integers in 1..maximum. */
gw_code gw_parse_integers(const char *name, const char *text, size_t limit, uint32_t maximum, uint32_t *out,
                          size_t *count, gw_error *error);
/* One finite number / integer in [minimum, maximum]. */
gw_code gw_parse_number(const char *name, const char *text, double minimum, double maximum, double *out,
                        gw_error *error);
gw_code gw_parse_integer(const char *name, const char *text, int64_t minimum, int64_t maximum, int64_t *out,
                         gw_error *error);

/* The folder that a drawing verb keeps octrees in: what was asked for, else gazewall/ in the user's cache
 * folder (XDG base directories); free() it. NULL: nothing is kept. */
char *gw_cache_folder(const gw_draw_options *options);

/* A file or folder to write: GW_BAD_INPUT when its name is empty. option is "--out". */
gw_code gw_parse_name(const char *option, const char *argument, const char **out, gw_error *error);

/* The mistake of a word that belongs to no option. */
gw_code gw_stray_argument(const char *argument, gw_error *error);

#endif
