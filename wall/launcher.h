/* The launcher: starts one rank per tile under mpirun, here or on the site's hosts, speaks for them on the
 * terminal, ends what does not end by itself, and alone decides the exit code - from what the ranks said,
 * because mpirun with --enable-recovery reports success after a loss and never ends while a hung rank lives.
 * The main thread of the process that the user started; once per process. */
#ifndef GW_WALL_LAUNCHER_H
#define GW_WALL_LAUNCHER_H

#include "base/status.h"
#include "wall/console.h"
#include "wall/hosts.h"
#include "wall/mpirun_command.h"
#include "wall/site.h"

typedef struct gw_launch_plan {
    const gw_site *site; /* a rank for each tile */
    const gw_hosts *hosts;
    gw_console *console;
    double load_deadline;    /* s until all ranks must be ready */
    const char *verb;        /* "sim" or "wall" */
    const char *agent;       /* command that starts programs on other hosts in place of ssh, or NULL */
    const gw_words *carried; /* words for the ranks, before the user's */
    int argc;                /* the user's words, which the ranks read again; argv[0] is the verb */
    char **argv;
} gw_launch_plan;

/* Runs the wall to its end. result tells how it ended, and is what the process exits with. */
gw_code gw_launch(const gw_launch_plan *plan, gw_error *result);
/* Prints the command that gw_launch would run, but for the line to the launcher: ranks that are started by
 * hand speak for themselves. */
gw_code gw_launch_show(const gw_launch_plan *plan, gw_error *error);

#endif
