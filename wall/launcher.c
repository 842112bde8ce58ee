#include "wall/launcher_internal.h"

#include "base/clock.h"
#include "wall/interrupt.h"
#include "wall/mpirun_command.h"
#include "wall/mpirun_sweep.h"
#include "wall/share.h"
#include "wall/spawn.h"
#include "wall/verbs.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* mpirun takes 2 s to end what runs on other hosts, and more on machines with much else to do; killed before
 * it is done, it may leave a daemon there. */
enum { GRACE_MS = 2000, TERMINATION_MS = 15000, POLL_MS = 200, FINISH_S = 15, ECHO_MS = 300 };

/* --- starting
 * ---------------------------------------------------------------------------------------------------- */

gw_code gw_launcher_path(char path[4096], gw_error *error) {
    ssize_t length = readlink("/proc/self/exe", path, 4095);
    if (length < 0)
        return gw_fail(error, GW_MACHINE, "the program's own path cannot be read from /proc/self/exe: %s",
                       strerror(errno));
    path[length] = '\0';
    return GW_OK;
}

/* gazewall launch PID mpirun ... gazewall rank --link=NAME, the user's words; without a listener from mpirun
 * on. */
static gw_code make_command(const gw_launch_plan *plan, const gw_link_listener *listener, const gw_log *log,
                            gw_words *out, gw_error *error) {
    char path[4096];
    gw_code code = gw_launcher_path(path, error);
    if (code)
        return code;
    const gw_mpirun_plan how = {.site = plan->site,
                                .hosts = plan->hosts,
                                .listener = listener,
                                .program = path,
                                .verb = plan->verb,
                                .agent = plan->agent,
                                .carried = plan->carried,
                                .argc = plan->argc,
                                .argv = plan->argv};
    if (listener) {
        gw_words_add(out, "%s", path);
        gw_words_add(out, "launch");
        gw_words_add(out, "%ld", (long)getpid());
    }
    gw_mpirun_words(&how, log, out);
    return out->failed ? gw_fail(error, GW_MACHINE, "memory is out while making the command") : GW_OK;
}

gw_code gw_launch_show(const gw_launch_plan *plan, gw_error *error) {
    gw_words words = {0};
    gw_code code = make_command(plan, NULL, NULL, &words, error);
    if (!code) {
        gw_words_print(&words, stdout);
        putchar('\n');
    }
    gw_words_finish(&words);
    return code;
}

static gw_code spawn(gw_launcher *l, char **command, gw_error *error) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC))
        return gw_fail(error, GW_MACHINE, "no pipe to mpirun: %s", strerror(errno));
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    int failed = gw_spawn(&l->mpirun, (const char *const *)command, &actions, GW_SPAWN_OWN_GROUP);
    close(ends[1]);
    l->output = ends[0];
    return failed ? gw_fail(error, GW_MACHINE, "%s cannot be started: %s", command[0], strerror(failed))
                  : GW_OK;
}

int gw_verb_launch(int argc, char **argv) {
    long expected = argc > 2 ? strtol(argv[1], NULL, 10) : 0;
    if (expected < 1 || !gw_interrupt_follow_parent((pid_t)expected))
        return GW_ENDED_EARLY;
    execvp(argv[2], argv + 2);
    fprintf(stderr, "%s cannot be started: %s; install openmpi-bin\n", argv[2], strerror(errno));
    return GW_MACHINE;
}

static gw_code take_signals(gw_launcher *l, gw_error *error) {
    /* From here on signals are read from a descriptor, in order with everything else that happens. */
    sigset_t taken;
    sigemptyset(&taken);
    sigaddset(&taken, SIGINT);
    sigaddset(&taken, SIGTERM);
    sigaddset(&taken, SIGHUP);
    sigaddset(&taken, SIGCHLD);
    sigprocmask(SIG_BLOCK, &taken, NULL);
    l->signals = signalfd(-1, &taken, SFD_CLOEXEC | SFD_NONBLOCK);
    /* What mpirun leaves when it is killed - agents that speak to other hosts - becomes ours to end. */
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    return l->signals < 0 ? gw_fail(error, GW_MACHINE, "no descriptor for signals: %s", strerror(errno))
                          : GW_OK;
}

static gw_code start(gw_launcher *l, gw_error *error) {
    const gw_hosts *hosts = l->plan->hosts;
    gw_words words = {0};
    gw_code code = take_signals(l, error);
    if (!code)
        code = gw_hosts_check(hosts, error);
    if (!code)
        code = gw_program_hash(l->program, error);
    if (!code)
        code = gw_link_listen(hosts->remote ? hosts->listen : NULL, &l->listener, error);
    if (!code && setenv(GW_LINK_SECRET, l->listener.secret, 1))
        code = gw_fail(error, GW_MACHINE, "memory is out while starting the ranks");
    if (!code)
        code = make_command(l->plan, &l->listener, &l->console->log, &words, error);
    if (!code)
        code = spawn(l, words.word, error);
    gw_words_finish(&words);
    return code;
}

/* --- watching
 * ---------------------------------------------------------------------------------------------------- */

/* A line that mpirun printed, or a tile that was started again. MPI's noise about ranks that left without
 * MPI_Finalize, as ours do, is for those who look for trouble; anything else comes from a library or a
 * sanitizer inside a rank, or from the agent, and is worth seeing. */
static void show_noise(gw_launcher *l, const char *who, const char *text, int length) {
    if (length > 0)
        gw_log_write(&l->console->log,
                     memmem(text, (size_t)length, "PMIX ERROR", 10) ? GW_LOG_DEBUG : GW_LOG_WARNING,
                     "%s: %.*s", who, length, text);
}

static void read_output(gw_launcher *l, int *from, const char *who) {
    char buffer[1024];
    ssize_t size = -1;
    while (*from >= 0 && (size = read(*from, buffer, sizeof buffer)) > 0) {
        /* Before any rank has spoken it is mpirun itself: kept for blame_mpirun(). */
        if (l->greeted_count == 0) {
            size_t room = sizeof l->noise - 1 - l->noise_size,
                   take = (size_t)size < room ? (size_t)size : room;
            memcpy(l->noise + l->noise_size, buffer, take);
            l->noise_size += take;
            continue;
        }
        for (char *at = buffer, *end = buffer + size; at < end;) {
            char *stop = memchr(at, '\n', (size_t)(end - at));
            stop = stop ? stop : end;
            show_noise(l, who, at, (int)(stop - at));
            at = stop + 1;
        }
    }
    if (size == 0) {
        close(*from);
        *from = -1;
    }
}

/* While frames are drawn, rank 0 is asked to end after this one and to write what there is; a second signal,
 * or one before the first frame, ends everything at once. One that comes with the first is the same:
 * timeout(1) and terminals send theirs to the process and to its group. */
static void interrupt(gw_launcher *l, int number) {
    if (l->interrupted && gw_now_ns() < l->patience - (FINISH_S * INT64_C(1000) - ECHO_MS) * 1000000)
        return;
    if (!l->interrupted && gw_launcher_all_ready(l) && !l->has_result) {
        l->interrupted = number;
        l->patience = gw_now_ns() + FINISH_S * INT64_C(1000000000);
        gw_line_send(&l->ranks[0].line, GW_LINK_STOP, number, 0, "", 0);
        return;
    }
    l->interrupted = number;
    gw_launcher_conclude(l, (gw_code)(128 + number), "interrupted");
}

void gw_launcher_reap(gw_launcher *l) {
    /* Of others only those are ours that became it when their parent died. */
    int status;
    for (pid_t ended; (ended = waitpid(-1, &status, WNOHANG)) > 0;)
        if (ended == l->mpirun) {
            l->mpirun_ended = 1;
            l->mpirun_status = status;
        } else
            gw_launcher_restart_ended(l, ended);
}

static void read_signals(gw_launcher *l) {
    struct signalfd_siginfo info;
    while (read(l->signals, &info, sizeof info) == (ssize_t)sizeof info)
        if (info.ssi_signo != SIGCHLD)
            interrupt(l, (int)info.ssi_signo);
    gw_launcher_reap(l);
}

static void step(gw_launcher *l, int timeout) {
    struct pollfd wait[GW_MAXIMUM_TILES + GW_LAUNCHER_STRANGERS + 5];
    nfds_t count = 0;
    /* A negative descriptor is one that poll() passes over. */
    const int room = l->stranger_count < GW_LAUNCHER_STRANGERS;
    wait[count++] = (struct pollfd){.fd = room ? l->listener.local : -1, .events = POLLIN};
    wait[count++] = (struct pollfd){.fd = room ? l->listener.network : -1, .events = POLLIN};
    wait[count++] = (struct pollfd){.fd = l->signals, .events = POLLIN};
    wait[count++] = (struct pollfd){.fd = l->output, .events = POLLIN};
    wait[count++] = (struct pollfd){.fd = l->restart_output[0], .events = POLLIN};
    for (uint32_t i = 0; i < l->stranger_count; i++)
        wait[count++] = (struct pollfd){.fd = l->strangers[i].line.socket, .events = POLLIN};
    for (uint32_t i = 0; i < l->tile_count; i++)
        wait[count++] = (struct pollfd){.fd = l->ranks[i].line.socket, .events = POLLIN};
    if (poll(wait, count, timeout) < 0)
        return;
    /* First, because what the ranks say may be a consequence. */
    read_signals(l);
    gw_launcher_listen(l);
    gw_launcher_ping(l);
    gw_launcher_restart(l);
    read_output(l, &l->output, "mpirun");
    read_output(l, &l->restart_output[0], "a tile that was started again");
}

/* mpirun ended and nobody told why: it was killed, could not start the ranks, or MPI ended them. */
static void blame_mpirun(gw_launcher *l) {
    enum { SHOWN = 1500 };
    if (gw_launcher_mpirun_killed(l))
        return;
    while (l->noise_size > 0 && (l->noise[l->noise_size - 1] == '\n' || l->noise[l->noise_size - 1] == ' '))
        l->noise_size--;
    int shown = l->noise_size > SHOWN ? SHOWN : (int)l->noise_size;
    gw_launcher_conclude(l, l->greeted_count < l->tile_count ? GW_MACHINE : GW_ENDED_EARLY,
                         "mpirun ended before the run did%s%.*s",
                         shown ? "; its last words:\n" : " and said nothing", shown,
                         l->noise + l->noise_size - shown);
}

static void blame_the_late(gw_launcher *l) {
    char silent[512];
    gw_launcher_silent(l, silent);
    gw_launcher_conclude(l, GW_ENDED_EARLY,
                         "only %" PRIu32 " of %" PRIu32 " ranks were ready after %.0f s; %s%s",
                         l->ready_count, l->tile_count, l->plan->load_deadline,
                         silent[0] ? "no sign of life from " : "raise --load-deadline", silent);
}

static void watch(gw_launcher *l) {
    int64_t deadline = gw_now_ns() + (int64_t)(l->plan->load_deadline * 1e9);
    while (!l->has_result) {
        step(l, POLL_MS);
        int64_t now = gw_now_ns();
        if (l->mpirun_ended && !l->has_result) {
            step(l, 0); /* what the ranks said last may still be in their lines */
            blame_mpirun(l);
        }
        if (l->interrupted && now > l->patience)
            break;
        if (l->promised && now > l->promised)
            gw_launcher_conclude(l, GW_ENDED_EARLY,
                                 "rank 0 (tile %s) hangs: it was not heard when it should have been",
                                 l->plan->site->layout.tiles[0].name);
        if (!gw_launcher_all_ready(l) && now > deadline)
            blame_the_late(l);
    }
    if (l->interrupted) {
        *l->result = (gw_error){0};
        l->has_result = 0;
        gw_launcher_conclude(l, (gw_code)(128 + l->interrupted), "interrupted");
    }
}

/* --- ending
 * ------------------------------------------------------------------------------------------------------ */

static int all_gone(const gw_launcher *l) {
    for (uint32_t i = 0; i < l->tile_count; i++)
        if (l->ranks[i].line.socket >= 0 || l->restarts[i].child)
            return 0;
    return l->mpirun_ended;
}

static void signal_all(gw_launcher *l, int number) {
    /* mpirun puts every rank in a process group of its own, so each is told by itself. A closed line means
     * that the rank is gone and its number perhaps somebody else's. One on another machine ends when its line
     * does. */
    for (uint32_t i = 0; i < l->tile_count; i++) {
        gw_rank_line *r = &l->ranks[i];
        if (r->line.socket >= 0 && r->here)
            kill(r->pid, number);
        else if (r->line.socket >= 0)
            shutdown(r->line.socket, SHUT_WR);
        if (l->restarts[i].child)
            kill(-l->restarts[i].child, number);
    }
    if (!l->mpirun_ended)
        kill(-l->mpirun, number);
}

static void wait_until_gone(gw_launcher *l, int milliseconds) {
    int64_t deadline = gw_now_ns() + milliseconds * INT64_C(1000000);
    while (!all_gone(l) && gw_now_ns() < deadline)
        step(l, 20);
}

/* Ends what a killed mpirun left: its children are ours now, and theirs when they are gone. */
static void end_orphans(void) {
    char path[64];
    snprintf(path, sizeof path, "/proc/self/task/%ld/children", (long)getpid());
    int64_t deadline = gw_now_ns() + GRACE_MS * INT64_C(1000000);
    int status;
    for (pid_t ended; (ended = waitpid(-1, &status, WNOHANG)) >= 0 && gw_now_ns() < deadline;) {
        FILE *list = fopen(path, "re");
        long child;
        while (list && fscanf(list, "%ld", &child) == 1)
            kill((pid_t)child, SIGKILL);
        if (list)
            fclose(list);
        if (ended == 0)
            poll(NULL, 0, 10);
    }
}

/* Rank 0 is lost on the way: the tiles are told, so that none leaves a frozen frame behind. */
static void tell_tiles(gw_launcher *l) {
    int64_t deadline = gw_now_ns() + GRACE_MS * INT64_C(1000000);
    for (uint32_t i = 1; i < l->tile_count; i++)
        if (l->ranks[i].line.socket >= 0)
            gw_line_send(&l->ranks[i].line, GW_LINK_ROOT_LOST, 0, 0, l->result->text, 0);
    for (uint32_t left = 1; left && gw_now_ns() < deadline;) {
        step(l, 20);
        left = 0;
        for (uint32_t i = 1; i < l->tile_count; i++)
            left += l->ranks[i].line.socket >= 0;
    }
}

static void end_all(gw_launcher *l) {
    if (l->mpirun <= 0)
        return;
    if (l->result->code == GW_ENDED_EARLY && gw_launcher_all_ready(l) && !l->mpirun_ended)
        tell_tiles(l);
    /* After a good end the ranks leave by themselves, and a lost one has its grace time. */
    if (l->result->code == GW_OK || l->result->code == GW_TILES_LOST)
        wait_until_gone(l, GRACE_MS);
    if (!all_gone(l)) {
        signal_all(l, SIGTERM);
        wait_until_gone(l, l->plan->hosts->remote ? TERMINATION_MS : GRACE_MS);
    }
    if (!all_gone(l)) {
        gw_log_write(&l->console->log, GW_LOG_DEBUG, "ending what does not end by itself");
        signal_all(l, SIGKILL);
        wait_until_gone(l, GRACE_MS);
    }
    end_orphans();
    /* A rank that comes only now finds nobody, and leaves before it has made anything. */
    gw_link_close(&l->listener);
    gw_mpirun_sweep(l->mpirun, l->job);
    gw_share_sweep();
}

gw_code gw_launch(const gw_launch_plan *plan, gw_error *result) {
    static gw_launcher l;
    memset(&l, 0, sizeof l);
    l.plan = plan;
    l.tile_count = plan->site->layout.tile_count;
    l.console = plan->console;
    l.listener.local = l.listener.network = l.signals = l.output = -1;
    l.restart_output[0] = l.restart_output[1] = -1;
    for (int i = 0; i < GW_MAXIMUM_TILES; i++)
        l.ranks[i].line.socket = -1;
    l.result = result;
    gw_error error = {0};
    gw_code code = start(&l, &error);
    if (code)
        gw_launcher_conclude(&l, code, "%s", error.text);
    else
        watch(&l);
    end_all(&l);
    gw_console_finish(l.console);
    fflush(stdout);
    return result->code;
}
