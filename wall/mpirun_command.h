/* The command that starts the ranks: mpirun with one part for every run of tiles that share a host and a
 * display, in the order of the tiles, so that rank i owns tile i without a host file or a rank file. */
#ifndef GW_WALL_MPIRUN_COMMAND_H
#define GW_WALL_MPIRUN_COMMAND_H

#include "base/log.h"
#include "base/status.h"
#include "wall/hosts.h"
#include "wall/link.h"
#include "wall/site.h"

#include <stddef.h>
#include <stdio.h>

/* A list of words that ends with NULL, each owned. */
typedef struct gw_words {
    char **word;
    size_t count, room;
    int failed; /* memory was out: word is not to be used */
} gw_words;

void gw_words_add(gw_words *words, const char *format, ...) __attribute__((format(printf, 2, 3)));
void gw_words_finish(gw_words *words);

typedef struct gw_mpirun_plan {
    const gw_site *site;
    const gw_hosts *hosts;
    const gw_link_listener *listener; /* NULL: ranks that speak for themselves */
    const char *program;              /* path of this program, the same on every host */
    const char *verb;                 /* "sim" or "wall" */
    const char *agent;                /* command in place of ssh, or NULL */
    const gw_words *carried;          /* words before the user's: files that not every host may have */
    int argc;                         /* the user's words, which the ranks read again; argv[0] is the verb */
    char **argv;
} gw_mpirun_plan;

/* Adds mpirun and its words. Why some of them are there is told to the log, which may be NULL. */
void gw_mpirun_words(const gw_mpirun_plan *plan, const gw_log *log, gw_words *out);
/* Adds what starts one rank on the host; rejoin: the place that it takes when it is started again, or NULL.
 */
void gw_rank_words(const gw_mpirun_plan *plan, const gw_host *host, const char *rejoin, gw_words *out);
/* The words as a shell takes them. */
void gw_words_print(const gw_words *words, FILE *out);

#endif
