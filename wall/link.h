/* The line between the launcher and its ranks: how ranks log, show progress, fail, print and finish, and how
 * the launcher says that a tile died or that the run shall end.
 *
 * On the launcher's own machine a Unix socket in the abstract name space, so that nothing of it is left in
 * the file system however a process ends; from other machines TCP, bound to one numeric address. Either way
 * the launcher sees a rank's death at once, and a rank the launcher's. A connection counts for nothing before
 * its first message has told the secret of the run. It carries no pixels and no frame states: those go by
 * the gate (wall/gate.h). Messages are host byte order: both ends are the same program, or the rank is
 * refused. */
#ifndef GW_WALL_LINK_H
#define GW_WALL_LINK_H

#include "base/log.h"
#include "base/status.h"
#include "wall/layout.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

typedef enum gw_link_kind {
    GW_LINK_HELLO,    /* first: value is the rank, text what gw_hello holds */
    GW_LINK_LOG,      /* value is the gw_log_level */
    GW_LINK_PROGRESS, /* text is what, fraction how much */
    GW_LINK_READY,    /* this rank could draw frame 1 */
    GW_LINK_PROMISE,  /* rank 0: it will be heard again within `fraction` seconds, or it hangs */
    GW_LINK_PRINT,    /* a line for standard output */
    GW_LINK_FAILED,   /* value is a gw_code, text the sentence */
    GW_LINK_LEFT,     /* this rank leaves because it was told to */
    GW_LINK_RESULT,   /* rank 0: value is the run's gw_code, text the sentence if it is not 0 */
    GW_LINK_PONG,     /* the answer to a ping; a stopped process gives none */
    GW_LINK_DOOR, /* rank 0: tiles that are started again come in at ADDRESS:PORT, which is the text; value is
                     how often a minute each may be */
    /* from the launcher: */
    GW_LINK_WELCOME, /* the answer to hello: go on; to rank 0: the text is the address for its door */
    GW_LINK_PING,
    GW_LINK_LOST, /* to rank 0: value is a tile whose process is gone, fraction which start of it that was (0:
                     by mpirun), text why, if it said so */
    GW_LINK_STOP, /* to rank 0: end after this frame and write what there is; value is the signal's number */
    GW_LINK_ROOT_LOST, /* to the others: rank 0 is lost, text says how; leave */
    GW_LINK_KINDS
} gw_link_kind;

enum { GW_LINK_TEXT = 2048, GW_SECRET_DIGITS = 32 };

typedef struct gw_link_message {
    int32_t kind, value;
    double fraction;         /* 0 to 1; of a promise: seconds; of progress below 0: no share is known */
    char text[GW_LINK_TEXT]; /* ends with a zero byte; only the used part travels */
} gw_link_message;

/* --- one end of a line (wall/link_line.c) */

typedef struct gw_line {
    int socket; /* -1: closed */
    size_t filled;
    uint8_t bytes[24 + GW_LINK_TEXT]; /* a message that has come in part */
} gw_line;

/* Right after the line stands: sends wait at most `patience` s, and over a network silence ends it. */
void gw_line_prepare(int socket, int network, int patience);
/* One message without waiting: 1 message, 0 none yet, -1 the other end is gone (errno says how: 0 it closed),
 * -2 what came is no message. */
int gw_line_receive(gw_line *line, gw_link_message *out);
/* 0 when the message was sent or the other end is gone; -1 when there is no room now and wait is 0. */
int gw_line_send(gw_line *line, gw_link_kind kind, int32_t value, double fraction, const char *text,
                 int wait);
void gw_line_close(gw_line *line);

/* Who says hello. */
typedef struct gw_hello {
    char secret[GW_SECRET_DIGITS + 1];
    char program[33]; /* hash of the executable file */
    char host[64];
    uint32_t job; /* MPI's number of the run, or 0 */
    pid_t pid;    /* on its own host */
} gw_hello;

/* Of GW_SECRET_DIGITS bytes each, in a time that does not tell where they differ. */
int gw_same_secret(const char *a, const char *b);
/* GW_OK, or GW_MACHINE when /proc/self/exe cannot be read. */
gw_code gw_program_hash(char text[33], gw_error *error);
void gw_hello_write(const gw_hello *hello, char text[GW_LINK_TEXT]);
/* 1 when the text is a hello, all of it. */
int gw_hello_read(const char *text, gw_hello *out);

/* --- the launcher's listeners (wall/link_listener.c) */

typedef struct gw_link_listener {
    int local, network;    /* sockets; -1: none */
    char local_name[64];   /* for ranks on this machine, as gw_link_connect takes it */
    char network_name[96]; /* for others: tcp:ADDRESS:PORT; "" without a network */
    char secret[GW_SECRET_DIGITS + 1];
} gw_link_listener;

/* The environment variable by which ranks are told the secret: the command line would show it to everybody.
 */
#define GW_LINK_SECRET "GAZEWALL_SECRET"

/* address: numeric, of an interface of this machine; NULL: only ranks of this machine will come. */
gw_code gw_link_listen(const char *address, gw_link_listener *out, gw_error *error);
void gw_link_close(gw_link_listener *listener);
/* Takes one connection; refuses other users of this machine. *pid is the process, 0 when it is not on this
 * machine; from[64] names where it came from. -1 when there is none (any more). */
int gw_link_accept(const gw_link_listener *listener, pid_t *pid, char from[64]);

/* --- the rank's end (wall/link.c) */

/* How a tile's process ended, as the launcher saw it. */
typedef struct gw_death {
    uint32_t tile, start; /* which start of the tile it was; 0: mpirun's */
    char how[256];        /* "" when it did not say */
} gw_death;

typedef struct gw_link {
    gw_line line;
    gw_log log;             /* speaks through the line */
    pthread_mutex_t access; /* to sending: the thread that reads answers pings */
    pthread_t reader;
    int64_t last_progress; /* ns */
    atomic_ullong lost;    /* a bit for each tile that the launcher saw die and nobody asked about yet */
    gw_death deaths[GW_MAXIMUM_TILES]; /* of those; under `access` */
    char door[64];                     /* rank 0: numeric address for its door; "": none was told */
    atomic_int stop;                   /* signal's number, or 0 */
    atomic_int root_lost;              /* 1: how is in the text, which does not change any more */
    char root_text[256];
} gw_link;

/* Says hello and waits until the launcher welcomes this rank. From then on a thread of its own listens: when
 * the launcher is gone, the process ends as by SIGTERM, and after 3 s by force. Without a name there is no
 * launcher: log and results go to this process's own standard error and output. */
gw_code gw_link_connect(const char *name, int rank, gw_link *out, gw_error *error);
/* Log lines, progress and promises are dropped when the launcher does not read; all else waits up to 5 s. */
void gw_link_send(gw_link *link, gw_link_kind kind, int32_t value, const char *text);
void gw_link_promise(gw_link *link, double seconds);

/* Rank 0, any time: 1 and a death that the launcher saw, each once; 0: none (any more). */
int gw_link_poll_lost(gw_link *link, gw_death *out);
/* Another rank, any time: how rank 0 was lost, as the launcher saw it; NULL: it was not. */
const char *gw_link_root_lost(gw_link *link);
/* Rank 0, any time: the number of the signal by which the run shall end after this frame, or 0. */
int gw_link_stop(gw_link *link);

#endif
