/* What the two halves of `bench scale` share: walls of more and more tiles (bench_scale.c) and scenes of more
 * and more triangles (bench_scale_growth.c). */
#ifndef GW_WALL_BENCH_SCALE_H
#define GW_WALL_BENCH_SCALE_H

#include "wall/bench.h"

/* Work per ray of the same picture of a rock of 10 thousand to 10 million triangles, against the logarithm of
 * their number. Prints a summary unless quiet, writes scale-growth.csv and scale-growth.svg if there is a
 * folder, and adds to bench->report's "bench". */
gw_code gw_scale_growth(gw_bench *bench, gw_error *error);

#endif
