/* Talking with `gazewall examine` on a host: the doctor's eyes there. Requests are lines, answers one JSON
 * object a line; whatever else an agent or a login shell prints is passed over. Main thread. */
#ifndef GW_WALL_EXAMINE_H
#define GW_WALL_EXAMINE_H

#include "base/status.h"
#include "wall/hosts.h"

#include <jansson.h>
#include <sys/types.h>

typedef struct gw_examiner {
    pid_t pid;
    int in, out, errors; /* pipes to it and from it */
    char pending[65536]; /* read and not yet a whole line */
    size_t size;
} gw_examiner;

/* Starts program on the host, by the agent (a command and its options, as for mpirun) unless it is this
 * machine, and waits for its first word. The error tells whether the agent, the way or the program is
 * missing, with the agent's own last words. */
gw_code gw_examiner_start(const gw_host *host, const char *agent, const char *program, gw_examiner *out,
                          gw_error *error);
/* One request, one answer (to be given back by json_decref). The host's own "error" becomes the error. */
gw_code gw_examiner_ask(gw_examiner *examiner, const char *request, int milliseconds, json_t **answer,
                        gw_error *error);
void gw_examiner_stop(gw_examiner *examiner);

#endif
