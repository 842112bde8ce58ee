/* The line between the launcher and its ranks: how ranks log, show progress, fail, print and finish.
 *
 * A Unix socket of whole messages in the abstract name space, so that nothing of it is left in the file
 * system however a process ends, and the launcher sees a rank's death at once. It carries no pixels and no
 * frame states: those go by MPI. Each end belongs to one thread. */
#ifndef GW_WALL_LINK_H
#define GW_WALL_LINK_H

#include "base/log.h"
#include "base/status.h"

#include <stdint.h>
#include <sys/types.h>

typedef enum gw_link_kind {
    GW_LINK_HELLO,    /* first: value is the rank, text MPI's number of the run */
    GW_LINK_LOG,      /* value is the gw_log_level */
    GW_LINK_PROGRESS, /* text is what, fraction how much */
    GW_LINK_READY,    /* this rank could draw frame 1 */
    GW_LINK_PROMISE,  /* rank 0: it will be heard again within `fraction` seconds, or it hangs */
    GW_LINK_PRINT,    /* a line for standard output */
    GW_LINK_FAILED,   /* value is a gw_code, text the sentence */
    GW_LINK_LEFT,     /* this rank leaves because it was told to */
    GW_LINK_RESULT    /* rank 0: value is the run's gw_code, text the sentence if it is not 0 */
} gw_link_kind;

typedef struct gw_link_message {
    int32_t kind, value;
    double fraction; /* 0 to 1; of a promise: seconds */
    char text[2048]; /* ends with a zero byte; only the used part travels */
} gw_link_message;

/* Launcher: makes a listening socket with a name that nobody else has. Close *listener with close(). */
gw_code gw_link_listen(char name[64], int *listener, gw_error *error);
/* Takes one connection; refuses other users. *pid is the rank's process. -1 when there is none (any more). */
int gw_link_accept(int listener, pid_t *pid);
/* One message without waiting: 1 message, 0 none yet, -1 the other end is gone. */
int gw_link_receive(int socket, gw_link_message *out);

/* Rank: the line, and a log that speaks through it. */
typedef struct gw_link {
    int socket;
    gw_log log;
    int64_t last_progress; /* ns */
} gw_link;

gw_code gw_link_connect(const char *name, int rank, gw_log_level threshold, gw_link *out, gw_error *error);
/* Log lines, progress and promises are dropped when the launcher does not read; all else waits up to 5 s. */
void gw_link_send(gw_link *line, gw_link_kind kind, int32_t value, const char *text);
void gw_link_promise(gw_link *line, double seconds);

#endif
