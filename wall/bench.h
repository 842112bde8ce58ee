/* Benches: what they share. Each bench prints a summary, and writes NAME.csv and NAME.json into a folder if
 * asked. */
#ifndef GW_WALL_BENCH_H
#define GW_WALL_BENCH_H

#include "base/status.h"
#include "render/renderer.h"
#include "wall/console.h"
#include "wall/model.h"
#include "wall/options.h"
#include "wall/plot.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

enum { GW_BENCH_BOUNDS = 8 };

typedef struct gw_bench {
    gw_draw_options draw;
    const char *out;  /* folder, or NULL */
    int quick;        /* fewer repeats and rays, for tests */
    uint32_t repeats; /* 0: the bench's own number */
    uint32_t frames;  /* of benches that follow a camera path; 0: the bench's own number, of accuracy one */
    const char *path; /* its name or number; NULL: the scene's first */
    double density;  /* of modes: px a degree at the middle of the path's pictures; 0: the path's own angle */
    int times_only;  /* of modes: no errors, no flicker */
    int point_light; /* of modes: one point light instead of the scene's lights, as in the paper */
    uint64_t rays;   /* of precision, in each family; 0: its own number */
    uint32_t size[2]; /* px, of benches that trace a picture; 0: the bench's own */
    size_t knob_count;
    const char *knobs[64]; /* of accuracy: names; none: all */
    size_t bound_count;
    const char *max_errors[GW_BENCH_BOUNDS]; /* of accuracy: "[METRIC=]VALUE", look for the cheapest settings
                                                within all of them */
    const char *max_cost;                    /* or "COST=VALUE": for the best */
    const char *save_profile;                /* file for what was found, or NULL */
    size_t scene_count;
    const char *scenes[64]; /* of benches that take several; none: draw.scene */
    gw_console console;
    gw_model model; /* scene imported, device open, octree built; only the device where a bench has scenes of
                       its own */
    json_t *report; /* gw_report_create's, with device, scene, octree, settings */
} gw_bench;

/* Builds the octree again and again. Fails if two builds differ. */
gw_code gw_bench_build(gw_bench *bench, gw_error *error);
/* The same primary rays through this octree and through Embree. GW_MACHINE when Embree is not installed. */
gw_code gw_bench_peers(gw_bench *bench, gw_error *error);
/* The same primary rays through the octree in other forms of nodes, fetches, stacks and traversals. Fails
 * when one gives another hit than the shipped form. */
gw_code gw_bench_layouts(gw_bench *bench, gw_error *error);

/* Options of a renderer of pictures: the effects that the command line forces and forbids. count: of work. */
gw_renderer_options gw_bench_rendering(const gw_bench *bench, int count);

/* Size of the picture whose rays they are: bench->size or the benches' default. */
void gw_bench_ray_size(const gw_bench *bench, uint32_t size[2]);
/* The rays of the default wall's pixels, in rebased space; free() them. */
gw_code gw_bench_rays(const gw_bench *bench, gw_ray **rays, size_t *count, gw_error *error);

/* Builds against rebuilds of an animated scene, pose after pose. Fails if they differ. */
gw_code gw_bench_rebuild(gw_bench *bench, gw_error *error);

/* A camera path in the modes of Weier et al. 2014, Table 3, and how much of their error is seen. */
gw_code gw_bench_modes_run(gw_bench *bench, gw_error *error);

/* Walls of 1 to 35 panels, full against foveated; rays in scenes of 10 thousand to 10 million triangles. */
gw_code gw_bench_scale(gw_bench *bench, gw_error *error);

/* Figure 5 of Weier et al. 2014: error and flicker of a scene seen whole, one ray a pixel. */
gw_code gw_bench_aliasing(gw_bench *bench, gw_error *error);

/* The price list: each scene with each effect and without, and with effects that nothing calls for. */
gw_code gw_bench_effects(gw_bench *bench, gw_error *error);

/* The ledger: error against cost for every knob of every scene. */
gw_code gw_bench_accuracy(gw_bench *bench, gw_error *error);

/* Failures in a million rays of each rung of the triangle test, and its time; Embree beside. Fails where the
 * shipped rung does. */
gw_code gw_bench_precision(gw_bench *bench, gw_error *error);

/* Many models at once, each with its own octree and renderer on one device. */
gw_code gw_bench_resident(gw_bench *bench, gw_error *error);

/* Table 2 of Weier et al. 2014: bytes of an octree refined everywhere against one that stops early. */
gw_code gw_bench_table2(gw_bench *bench, gw_error *error);

/* Build time and bytes from 10 thousand to 10 million triangles of a scene made by formula. */
gw_code gw_bench_growth(gw_bench *bench, gw_error *error);

/* The rasterised voxeliser of Weier et al. 2014 against the refinement of pairs. */
gw_code gw_bench_voxelise(gw_bench *bench, gw_error *error);

/* Lag against jitter of the tracker's filters, and what a sample costs. No device, no scene. */
gw_code gw_bench_tracking(gw_bench *bench, gw_error *error);

/* One octree's work, bytes and times. */
typedef struct gw_built {
    uint32_t depth, triangles;
    gw_octree_statistics statistics; /* of the fastest build */
    uint64_t node_bytes, reference_bytes, payload_bytes,
        triangle_bytes; /* boxes of dense leaves: references */
    double total_ms;    /* of the fastest build, uploads and hash included */
    gw_hash hash;
} gw_built;

/* Builds `repeats` times with these settings and keeps the fastest. Fails if two builds differ. */
gw_code gw_bench_measure(const gw_bench *bench, const gw_scene *scene, const gw_settings *settings,
                         uint32_t repeats, gw_built *out, gw_error *error);

/* Writes FOLDER/NAME.csv from text and FOLDER/NAME.json from the report, if there is a folder. */
gw_code gw_bench_write(const gw_bench *bench, const char *name, const char *rows, size_t size,
                       gw_error *error);

/* Writes FOLDER/NAME.svg: a text, or a plot. */
gw_code gw_bench_svg(const gw_bench *bench, const char *name, const char *svg, size_t size, gw_error *error);
gw_code gw_bench_plot(const gw_bench *bench, const char *name, const gw_plot *plot, gw_error *error);

#endif
