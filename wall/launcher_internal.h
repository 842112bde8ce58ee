/* What the files of the launcher share: wall/launcher.c starts, watches and ends, launcher_ranks.c listens to
 * the ranks. */
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
    pid_t pid;     /* on its own machine */
    int here;      /* that is this machine */
    char host[64]; /* its own name for it */
    int greeted;   /* it has been there */
    int ready, left;
    int64_t asked; /* ns, when it was pinged and has not answered yet; 0: it has answered */
    int silent;    /* and that is long ago: it has been told */
} gw_rank_line;

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
static inline int gw_launcher_all_ready(const gw_launcher *l) {
    return l->ready_count == l->tile_count;
}

#endif
