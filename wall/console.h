/* The program's voice: log lines, progress and the closing error go to standard error; results to standard
 * output.
 *
 * The only place below main() that prints log and errors. A console belongs to one thread; lower layers see
 * its gw_log. Progress is a live line on a terminal, one plain line per 5 s elsewhere. */
#ifndef GW_WALL_CONSOLE_H
#define GW_WALL_CONSOLE_H

#include "base/log.h"
#include "base/status.h"

#include <stdint.h>

typedef struct gw_console {
    gw_log log;         /* give this to the layers below */
    const char *verb;   /* for the "gazewall VERB:" in front of lines */
    int quiet;          /* no progress, no summary */
    int terminal;       /* standard error is a terminal */
    int live;           /* a progress line without newline stands there */
    int64_t last_shown; /* ns */
} gw_console;

/* verb must outlive the console. quiet lowers the threshold to errors. */
void gw_console_init(gw_console *console, const char *verb, gw_log_level threshold, int quiet);
/* Ends a live progress line. */
void gw_console_finish(gw_console *console);

/* Prints "gazewall VERB: text" (verb may be NULL) and returns the error's code, for `return
 * gw_console_fail(...)`. */
int gw_console_fail(const char *verb, const gw_error *error);

#endif
