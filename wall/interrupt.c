#include "wall/interrupt.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

/* Only lock-free atomics: the handler may run on any thread of MPI's or the GL driver's. */
static atomic_int held;
static atomic_int pending;
static atomic_int has_path;
static char path_to_unlink[128];

static void leave(int number) {
    if (atomic_load(&has_path))
        unlink(path_to_unlink);
    _exit(128 + number);
}

static void on_signal(int number) {
    if (atomic_load(&held) > 0)
        atomic_store(&pending, number);
    else
        leave(number);
}

void gw_interrupt_install(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    /* A reader that goes away (gazewall inspect | head) is an error of the write, not of the process. */
    signal(SIGPIPE, SIG_IGN);
}

void gw_interrupt_hold(void) {
    atomic_fetch_add(&held, 1);
}

void gw_interrupt_release(void) {
    if (atomic_fetch_sub(&held, 1) == 1 && atomic_load(&pending))
        leave(atomic_load(&pending));
}

int gw_interrupt_pending(void) {
    return atomic_load(&pending);
}

void gw_interrupt_unlink(const char *path) {
    atomic_store(&has_path, 0);
    if (!path)
        return;
    snprintf(path_to_unlink, sizeof path_to_unlink, "%s", path);
    atomic_store(&has_path, 1);
}

int gw_interrupt_follow_parent(pid_t expected) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    /* A parent that died before the request was made has been replaced by init or a subreaper. */
    return expected == 0 || getppid() == expected;
}
