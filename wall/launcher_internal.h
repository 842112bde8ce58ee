/* What the files of the launcher share: wall/launcher.c starts, watches and ends, launcher_ranks.c listens to
 * the ranks, launcher_restart.c starts tiles again. */
#ifndef GW_WALL_LAUNCHER_INTERNAL_H
#define GW_WALL_LAUNCHER_INTERNAL_H

#include "wall/launcher.h"
#include "wall/link.h"

#include <stdint.h>
#include <sys/types.h>

enum { GW_LAUNCHER_STRANGERS = 32, GW_LAUNCHER_NOISE = 8192 };

/* A connection that has not yet said who it is. */
typedef struct gw_stranger {
    gw_line line;
    pid_t pid; /* 0: not on this machine */
    char from[64];
    int64_t since; /* ns */
} gw_stranger;

/* The line of a rank; closed before its hello and after its end. */
typedef struct gw_rank_line {
    gw_line line;
    pid_t pid;      /* on its own machine */
    int here;       /* that is this machine */
    uint32_t start; /* which start of its tile this is; 0: mpirun's */
    char host[64];  /* its own name for it */
    int greeted;    /* it has been there */
    int ready, left;
    char failed[256]; /* why it leaves, if it said so; "": it did not */
    int64_t asked;    /* ns, when it was pinged and has not answered yet; 0: it has answered */
    int silent;       /* and that is long ago: it has been told */
} gw_rank_line;

enum { GW_MAXIMUM_RESTARTS = 60 }; /* a minute */

/* How a tile is started again. */
typedef struct gw_restart {
    pid_t child;    /* the rank itself, or the agent that runs it on another host; 0: none */
    uint32_t start; /* number of the last start; 0: mpirun's */
    int wanted;     /* it is to be started again at `next` (ns) */
    int pending;    /* it was, at `since` (ns), and has not spoken yet */
    int64_t next, since;
    int64_t recent[GW_MAXIMUM_RESTARTS]; /* ns, of the last starts, by number modulo */
} gw_restart;

typedef struct gw_launcher {
    const gw_launch_plan *plan;
    uint32_t tile_count;
    gw_console *console; /* the plan's */
    gw_link_listener listener;
    char program[33];    /* hash of this program */
    int signals, output; /* socket and the pipe from mpirun */
    pid_t mpirun;
    int mpirun_ended, mpirun_status;
    gw_rank_line ranks[GW_MAXIMUM_TILES]; /* by their numbers */
    gw_restart restarts[GW_MAXIMUM_TILES];
    char door[96];         /* where tiles that are started again come in; "": none is */
    uint32_t restart_most; /* starts of one tile in a minute */
    int restart_output[2]; /* pipe from those processes; -1: none yet */
    gw_stranger strangers[GW_LAUNCHER_STRANGERS];
    uint32_t stranger_count, greeted_count, ready_count;
    int64_t pinged;                /* ns */
    int64_t promised;              /* ns, when rank 0 must have been heard again; 0: it has not begun */
    uint32_t job;                  /* MPI's number of this run, or 0 */
    int has_result;                /* how the run ended is known */
    int interrupted;               /* signal number, or 0 */
    int64_t patience;              /* ns, until when rank 0 may take to finish after an interruption */
    gw_error *result;              /* code GW_OK until something else is known */
    char noise[GW_LAUNCHER_NOISE]; /* what mpirun printed last, for when it fails to start */
    size_t noise_size;
} gw_launcher;

/* The first failure stays: what follows is its consequence. */
void gw_launcher_conclude(gw_launcher *l, gw_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Takes the ends of child processes, without waiting. */
void gw_launcher_reap(gw_launcher *l);
/* 1 when it was, which is then how the run ended. */
int gw_launcher_mpirun_killed(gw_launcher *l);
/* Takes what has come from ranks and strangers, without waiting. */
void gw_launcher_listen(gw_launcher *l);
/* Once a second: asks every rank for a sign of life, and tells who gives none before the first frame. */
void gw_launcher_ping(gw_launcher *l);
/* "rank 2 (tile c0r1, process 4711)", for up to three that give no sign of life; "" when all do. */
void gw_launcher_silent(const gw_launcher *l, char text[512]);
/* Path of this program. */
gw_code gw_launcher_path(char path[4096], gw_error *error);

/* --- launcher_restart.c */

/* The tile's process has ended: it is to be started again, at once or after a while. */
void gw_launcher_want_restart(gw_launcher *l, uint32_t tile);
/* Starts those whose time has come, and ends those that do not come. */
void gw_launcher_restart(gw_launcher *l);
/* A child process has ended that may be one of these. */
void gw_launcher_restart_ended(gw_launcher *l, pid_t child);

static inline int gw_launcher_all_ready(const gw_launcher *l) {
    return l->ready_count == l->tile_count;
}

#endif
