/* Other programs started from this one, with nothing of its signals: what is blocked or ignored here is
 * neither there. Any thread. */
#ifndef GW_WALL_SPAWN_H
#define GW_WALL_SPAWN_H

#include <spawn.h>
#include <sys/types.h>

typedef enum gw_spawn_group {
    GW_SPAWN_SAME_GROUP, /* Ctrl-C in the terminal reaches it as it does this program */
    GW_SPAWN_OWN_GROUP   /* Ctrl-C comes to this program alone, which ends the other in its order */
} gw_spawn_group;

/* words: the path of a program and its arguments, ended by NULL; actions: of its descriptors, destroyed here.
 * Returns 0, or errno. */
int gw_spawn(pid_t *out, const char *const *words, posix_spawn_file_actions_t *actions, gw_spawn_group group);

#endif
