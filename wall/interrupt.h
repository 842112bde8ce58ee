/* SIGINT, SIGTERM and SIGHUP: the process ends at once, leaving nothing behind.
 *
 * The handler unlinks the shared-memory segment that this process holds by name, if any, and exits with 128 +
 * the signal's number. Work that must not be cut (a file between its temporary name and its own) is bracketed
 * by hold/release. Process-wide; call from the main thread. */
#ifndef GW_WALL_INTERRUPT_H
#define GW_WALL_INTERRUPT_H

#include <sys/types.h>

void gw_interrupt_install(void);

/* Defers signals that come between the two calls to the outermost release. Without a release they only wait:
 * for work that ends itself in good order. */
void gw_interrupt_hold(void);
void gw_interrupt_release(void);
/* The signal that waits for the release; 0: none. */
int gw_interrupt_pending(void);

/* The path of a file that must not outlive this process ("/dev/shm/gazewall-..."); NULL: none any more.
 * Copied. */
void gw_interrupt_unlink(const char *path);

/* Asks the kernel to send SIGTERM to this process when its parent dies, however that happens. expected is the
 * parent's process id (0: not known); returns 0 when that parent is dead already. */
int gw_interrupt_follow_parent(pid_t expected);

#endif
