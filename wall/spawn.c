#include "wall/spawn.h"

#include <signal.h>
#include <stdint.h>
#include <unistd.h>

int gw_spawn(pid_t *out, const char *const *words, posix_spawn_file_actions_t *actions,
             gw_spawn_group group) {
    const short signals = POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes,
                             group == GW_SPAWN_OWN_GROUP ? signals | POSIX_SPAWN_SETPGROUP : signals);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    /* The words of a program's command line are not const for old reasons. */
    int failed = posix_spawn(out, words[0], actions, &attributes, (char **)(uintptr_t)words, environ);
    posix_spawn_file_actions_destroy(actions);
    posix_spawnattr_destroy(&attributes);
    return failed;
}
