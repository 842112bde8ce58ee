/* A tile whose process ended while a live wall runs is started again (docs/gate.md): here directly, on
 * another host by the launch agent. It has no place in MPI any more and comes to rank 0's door. */
#include "wall/launcher_internal.h"

#include "base/clock.h"
#include "wall/mpirun_command.h"
#include "wall/spawn.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SPEAK_S = 30 }; /* until a process that was started must have spoken */
static const int64_t second = 1000000000, minute = 60 * INT64_C(1000000000);

static const char *name_of(const gw_launcher *l, uint32_t tile) {
    return l->plan->site->layout.tiles[tile].name;
}

/* --- when
 * -------------------------------------------------------------------------------------------------------- */

/* When the start was that had `back` others after it; 0: there was none. */
static int64_t start_before(const gw_restart *restart, uint32_t back) {
    return restart->start > back ? restart->recent[(restart->start - back) % GW_MAXIMUM_RESTARTS] : 0;
}

void gw_launcher_want_restart(gw_launcher *l, uint32_t tile) {
    gw_restart *restart = &l->restarts[tile];
    const int64_t now = gw_now_ns();
    uint32_t recent = 0;
    if (!l->door[0] || !l->restart_most || tile == 0 || l->interrupted || l->has_result)
        return;
    while (recent < l->restart_most && start_before(restart, recent) > now - minute)
        recent++;
    restart->wanted = 1;
    /* The first time at once; then after 1 s, 2 s, 4 s, ... */
    const uint32_t doubled = recent > 5 ? 5 : recent;
    restart->next = recent ? now + (second << (doubled - 1)) : now;
    if (recent < l->restart_most)
        return;
    const int64_t free = start_before(restart, recent - 1) + minute;
    restart->next = free > restart->next ? free : restart->next;
    gw_log_write(&l->console->log, GW_LOG_ERROR,
                 "tile %s was started again %" PRIu32
                 " times within a minute and ended each time; the next is in "
                 "%.0f s",
                 name_of(l, tile), recent, (double)(restart->next - now) * 1e-9);
}

/* --- how
 * ---------------------------------------------------------------------------------------------------------
 */

static char **here_words(const gw_mpirun_plan *plan, const gw_host *host, const char *place, gw_words *out) {
    gw_rank_words(plan, host, place, out);
    return out->failed ? NULL : out->word;
}

/* gazewall launch PID sh -c "exec AGENT ..." HOST COMMAND: the agent dies with the launcher. */
static char **agent_words(const gw_mpirun_plan *plan, const gw_host *host, const char *place, gw_words *out) {
    const char *agent = plan->agent ? plan->agent : "ssh -o BatchMode=yes";
    gw_words there = {0};
    char *command = NULL, folder[4096] = "/";
    size_t size = 0;
    FILE *text = open_memstream(&command, &size);
    if (!text)
        return NULL;
    if (!getcwd(folder, sizeof folder))
        folder[0] = '\0';
    gw_words_add(&there, "%s", folder);
    fputs("cd ", text);
    gw_words_print(&there, text);
    gw_words_finish(&there);
    /* As mpirun: in the same folder, where there is one. */
    fputs(" 2>/dev/null; exec ", text);
    gw_rank_words(plan, host, place, &there);
    gw_words_print(&there, text);
    const int failed = there.failed | fclose(text);
    gw_words_finish(&there);
    gw_words_add(out, "%s", plan->program);
    gw_words_add(out, "launch");
    gw_words_add(out, "%ld", (long)getpid());
    gw_words_add(out, "/bin/sh");
    gw_words_add(out, "-c");
    gw_words_add(out, "exec %s \"$0\" \"$@\"", agent);
    gw_words_add(out, "%s", host->name);
    gw_words_add(out, "%s", command ? command : "");
    free(command);
    return failed || out->failed ? NULL : out->word;
}

/* The process in a group of its own; on its standard input is the secret of the run, for another host. */
static int spawn(gw_launcher *l, char **words, pid_t *out) {
    int secret[2];
    if (l->restart_output[1] < 0 && pipe2(l->restart_output, O_CLOEXEC))
        return errno;
    fcntl(l->restart_output[0], F_SETFL, O_NONBLOCK);
    if (pipe2(secret, O_CLOEXEC))
        return errno;
    dprintf(secret[1], "%s\n", l->listener.secret);
    close(secret[1]);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, secret[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, l->restart_output[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, l->restart_output[1], STDERR_FILENO);
    int failed = gw_spawn(out, (const char *const *)words, &actions, GW_SPAWN_OWN_GROUP);
    close(secret[0]);
    return failed;
}

static void start(gw_launcher *l, uint32_t tile) {
    const gw_launch_plan *plan = l->plan;
    const gw_host *host = &plan->hosts->host[plan->hosts->of_tile[tile]];
    gw_restart *restart = &l->restarts[tile];
    gw_words words = {0};
    gw_error error = {0};
    char path[4096], place[160];
    gw_code code = gw_launcher_path(path, &error);
    const gw_mpirun_plan how = {.site = plan->site,
                                .hosts = plan->hosts,
                                .listener = &l->listener,
                                .program = path,
                                .verb = plan->verb,
                                .agent = plan->agent,
                                .carried = plan->carried,
                                .argc = plan->argc,
                                .argv = plan->argv};
    restart->wanted = 0;
    restart->since = gw_now_ns();
    restart->recent[++restart->start % GW_MAXIMUM_RESTARTS] = restart->since;
    snprintf(place, sizeof place, "%" PRIu32 ":%" PRIu32 ":%s", tile, restart->start, l->door);
    char **command = code         ? NULL
                     : host->here ? here_words(&how, host, place, &words)
                                  : agent_words(&how, host, place, &words);
    int failed = command ? spawn(l, command, &restart->child) : ENOMEM;
    gw_words_finish(&words);
    restart->pending = !failed;
    gw_log_write(&l->console->log, GW_LOG_WARNING, "tile %s is started again%s%s%s%s", name_of(l, tile),
                 host->here ? "" : " on ", host->here ? "" : host->name, failed ? ", in vain: " : "",
                 failed ? strerror(failed) : "");
    if (!failed)
        return;
    restart->child = 0;
    gw_launcher_want_restart(l, tile);
}

void gw_launcher_restart(gw_launcher *l) {
    const int64_t now = gw_now_ns();
    for (uint32_t tile = 1; tile < l->tile_count && l->door[0]; tile++) {
        gw_restart *restart = &l->restarts[tile];
        /* What is left of the start before, or does not come, makes room; it is taken note of when it has
         * ended. */
        if (restart->child &&
            (restart->wanted || (restart->pending && now - restart->since > SPEAK_S * second)))
            kill(-restart->child, SIGKILL);
        else if (restart->wanted && now >= restart->next && !l->has_result && !l->interrupted)
            start(l, tile);
    }
}

void gw_launcher_restart_ended(gw_launcher *l, pid_t child) {
    for (uint32_t tile = 1; tile < l->tile_count; tile++) {
        gw_restart *restart = &l->restarts[tile];
        if (restart->child != child)
            continue;
        restart->child = 0;
        if (!restart->pending)
            return;
        restart->pending = 0;
        if (!l->has_result && !l->interrupted)
            gw_log_write(&l->console->log, GW_LOG_WARNING, "tile %s could not be started again",
                         name_of(l, tile));
        gw_launcher_want_restart(l, tile);
        return;
    }
}
