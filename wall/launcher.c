#include "wall/launcher.h"

#include "base/clock.h"
#include "wall/interrupt.h"
#include "wall/link.h"
#include "wall/mpirun_sweep.h"
#include "wall/share.h"
#include "wall/verbs.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

enum { GRACE_MS = 2000, POLL_MS = 200, NOISE_BYTES = 8192 };

typedef struct rank_line {
    int socket; /* -1: not connected (yet, or any more) */
    pid_t pid;
    int number; /* -1 until it said hello */
    int ready, left;
} rank_line;

typedef struct launcher {
    const gw_launch_plan *plan;
    const gw_layout *layout; /* the plan's */
    gw_console *console;     /* the plan's */
    char link_name[64];
    int listener, signals, output; /* sockets and the pipe from mpirun */
    pid_t mpirun;
    int mpirun_ended;
    rank_line ranks[GW_MAXIMUM_TILES];
    uint32_t rank_count;
    uint32_t ready_count;
    int64_t promised;        /* ns, when rank 0 must have been heard again; 0: it has not begun */
    uint32_t job;            /* MPI's number of this run, or 0 */
    int has_result;          /* rank 0 has told how the run ended */
    int interrupted;         /* signal number, or 0 */
    gw_error *result;        /* code GW_OK until something else is known */
    char noise[NOISE_BYTES]; /* what mpirun printed last, for when it fails to start */
    size_t noise_size;
} launcher;

/* --- starting
 * ---------------------------------------------------------------------------------------------------- */

enum { MAXIMUM_WORDS = 512 };

typedef struct words {
    char *word[MAXIMUM_WORDS];
    size_t count;
} words;

static void add_word(words *list, const char *word) {
    /* The program's own words and argv's; argc is checked against the room before. */
    list->word[list->count++] = (char *)(uintptr_t)word;
    list->word[list->count] = NULL;
}

static gw_code own_path(char path[4096], gw_error *error) {
    ssize_t length = readlink("/proc/self/exe", path, 4095);
    if (length < 0)
        return gw_fail(error, GW_MACHINE, "the program's own path cannot be read from /proc/self/exe: %s",
                       strerror(errno));
    path[length] = '\0';
    return GW_OK;
}

/* gazewall launch PID mpirun ... gazewall rank --link=NAME, the user's words. */
static gw_code make_command(const launcher *l, char *path, char *pid, char *count, char *link, words *out,
                            gw_error *error) {
    if (l->plan->argc > MAXIMUM_WORDS - 32)
        return gw_fail(error, GW_BAD_INPUT, "the command line has %d words; at most %d are possible",
                       l->plan->argc, MAXIMUM_WORDS - 32);
    sprintf(pid, "%ld", (long)getpid());
    sprintf(count, "%" PRIu32, l->layout->tile_count);
    snprintf(link, 80, "--link=%s", l->link_name);
    const char *const head[] = {path,        "launch", pid,      "mpirun", "--enable-recovery",
                                "--bind-to", "none",   "--quiet"};
    for (size_t i = 0; i < sizeof head / sizeof head[0]; i++)
        add_word(out, head[i]);
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if ((long)l->layout->tile_count > processors) {
        add_word(out, "--oversubscribe");
        gw_log_write(&l->console->log, GW_LOG_INFO,
                     "%" PRIu32 " ranks share %ld processors (mpirun --oversubscribe)", l->layout->tile_count,
                     processors);
    }
    if (geteuid() == 0) {
        add_word(out, "--allow-run-as-root");
        gw_log_write(&l->console->log, GW_LOG_INFO, "started as root (mpirun --allow-run-as-root)");
    }
    /* The ranks of one machine need no network, and copying through the other process's memory is often
     * forbidden in containers. */
    const char *const tail[] = {"--mca", "btl", "self,vader", "--mca", "btl_vader_single_copy_mechanism",
                                "none",  "-np", count,        path,    "rank",
                                link};
    for (size_t i = 0; i < sizeof tail / sizeof tail[0]; i++)
        add_word(out, tail[i]);
    for (int i = 1; i < l->plan->argc; i++)
        add_word(out, l->plan->argv[i]);
    return GW_OK;
}

static gw_code spawn(launcher *l, char **command, gw_error *error) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC))
        return gw_fail(error, GW_MACHINE, "no pipe to mpirun: %s", strerror(errno));
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    /* A group of its own: Ctrl-C comes to the launcher alone, which then ends the others in order. */
    posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    int failed = posix_spawn(&l->mpirun, command[0], &actions, &attributes, command, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
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

static gw_code start(launcher *l, gw_error *error) {
    /* From here on signals are read from a descriptor, in order with everything else that happens. */
    sigset_t taken;
    sigemptyset(&taken);
    sigaddset(&taken, SIGINT);
    sigaddset(&taken, SIGTERM);
    sigaddset(&taken, SIGHUP);
    sigaddset(&taken, SIGCHLD);
    sigprocmask(SIG_BLOCK, &taken, NULL);
    l->signals = signalfd(-1, &taken, SFD_CLOEXEC | SFD_NONBLOCK);
    if (l->signals < 0)
        return gw_fail(error, GW_MACHINE, "no descriptor for signals: %s", strerror(errno));
    gw_code code = gw_link_listen(l->link_name, &l->listener, error);
    if (code)
        return code;
    char path[4096], pid[24], count[16], link[80];
    words command = {.count = 0};
    code = own_path(path, error);
    if (!code)
        code = make_command(l, path, pid, count, link, &command, error);
    return code ? code : spawn(l, command.word, error);
}

/* --- watching
 * ---------------------------------------------------------------------------------------------------- */

static const char *tile_name(const launcher *l, const rank_line *r) {
    return r->number >= 0 && r->number < (int)l->layout->tile_count ? l->layout->tiles[r->number].name
                                                                    : "unknown";
}

/* The first failure stays: what follows is its consequence. */
static void conclude(launcher *l, gw_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void conclude(launcher *l, gw_code code, const char *format, ...) {
    if (l->has_result)
        return;
    l->has_result = 1;
    char text[sizeof l->result->text];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    gw_fail(l->result, code, "%s", text);
}

static void take_message(launcher *l, rank_line *r, const gw_link_message *m) {
    switch ((gw_link_kind)m->kind) {
    case GW_LINK_HELLO:
        r->number = m->value;
        l->job = (uint32_t)strtoul(m->text, NULL, 10);
        gw_log_write(&l->console->log, GW_LOG_DEBUG, "rank %d (tile %s) is process %ld", r->number,
                     tile_name(l, r), (long)r->pid);
        break;
    case GW_LINK_LOG:
        gw_log_write(&l->console->log, (gw_log_level)m->value, "%s", m->text);
        break;
    case GW_LINK_PROGRESS:
        gw_log_progress(&l->console->log, m->text, m->fraction);
        break;
    case GW_LINK_READY:
        r->ready = 1;
        l->ready_count++;
        break;
    case GW_LINK_PROMISE:
        l->promised = gw_now_ns() + (int64_t)(m->fraction * 1e9);
        break;
    case GW_LINK_PRINT:
        gw_console_finish(l->console);
        puts(m->text);
        break;
    case GW_LINK_FAILED:
        r->left = 1;
        /* Once all are ready, a tile that fails is rank 0's to judge. */
        if (r->number == 0)
            conclude(l, (gw_code)m->value, "%s", m->text);
        else if (l->ready_count < l->layout->tile_count)
            conclude(l, (gw_code)m->value, "tile %s: %s", tile_name(l, r), m->text);
        else
            gw_log_write(&l->console->log, GW_LOG_WARNING, "tile %s: %s", tile_name(l, r), m->text);
        break;
    case GW_LINK_LEFT:
        r->left = 1;
        break;
    case GW_LINK_RESULT:
        r->left = 1;
        conclude(l, (gw_code)m->value,
                 m->value == GW_TILES_LOST ? "finished, but not all tiles lasted to the end" : "");
        break;
    }
}

static void lost_rank(launcher *l, rank_line *r) {
    close(r->socket);
    r->socket = -1;
    if (r->left || l->has_result)
        return;
    char text[256];
    snprintf(text, sizeof text, "rank %d (tile %s, process %ld) died %s", r->number, tile_name(l, r),
             (long)r->pid, l->ready_count < l->layout->tile_count ? "before the first frame" : "on the way");
    if (r->number == 0 || l->ready_count < l->layout->tile_count)
        conclude(l, GW_ENDED_EARLY, "%s", text);
    else
        gw_log_write(&l->console->log, GW_LOG_WARNING, "%s", text);
}

static void read_rank(launcher *l, rank_line *r) {
    gw_link_message message;
    int got;
    while ((got = gw_link_receive(r->socket, &message)) > 0)
        take_message(l, r, &message);
    if (got < 0)
        lost_rank(l, r);
}

static void take_ranks(launcher *l) {
    pid_t pid;
    for (int taken; (taken = gw_link_accept(l->listener, &pid)) >= 0;) {
        if (l->rank_count == l->layout->tile_count)
            close(taken);
        else
            l->ranks[l->rank_count++] = (rank_line){.socket = taken, .pid = pid, .number = -1};
    }
}

/* A line that mpirun printed. Its noise about ranks that left without MPI_Finalize, as ours do, is for those
 * who look for trouble; anything else comes from a library or a sanitizer inside a rank and is worth seeing.
 */
static void show_noise(launcher *l, const char *text, int length) {
    if (length > 0)
        gw_log_write(&l->console->log,
                     memmem(text, (size_t)length, "PMIX ERROR", 10) ? GW_LOG_DEBUG : GW_LOG_WARNING,
                     "mpirun: %.*s", length, text);
}

static void read_output(launcher *l) {
    char buffer[1024];
    ssize_t size;
    while ((size = read(l->output, buffer, sizeof buffer)) > 0) {
        /* Before any rank has spoken it is mpirun itself: kept for blame_mpirun(). */
        if (l->rank_count == 0) {
            size_t room = sizeof l->noise - 1 - l->noise_size,
                   take = (size_t)size < room ? (size_t)size : room;
            memcpy(l->noise + l->noise_size, buffer, take);
            l->noise_size += take;
            continue;
        }
        for (char *at = buffer, *end = buffer + size; at < end;) {
            char *stop = memchr(at, '\n', (size_t)(end - at));
            stop = stop ? stop : end;
            show_noise(l, at, (int)(stop - at));
            at = stop + 1;
        }
    }
    if (size == 0) {
        close(l->output);
        l->output = -1;
    }
}

static void read_signals(launcher *l) {
    struct signalfd_siginfo info;
    while (read(l->signals, &info, sizeof info) == (ssize_t)sizeof info)
        if (info.ssi_signo != SIGCHLD && !l->interrupted) {
            l->interrupted = (int)info.ssi_signo;
            conclude(l, (gw_code)(128 + info.ssi_signo), "interrupted");
        }
    int status;
    if (!l->mpirun_ended && waitpid(l->mpirun, &status, WNOHANG) == l->mpirun)
        l->mpirun_ended = 1;
}

static void step(launcher *l, int timeout) {
    struct pollfd wait[GW_MAXIMUM_TILES + 3];
    wait[0] = (struct pollfd){.fd = l->listener, .events = POLLIN};
    wait[1] = (struct pollfd){.fd = l->signals, .events = POLLIN};
    wait[2] = (struct pollfd){.fd = l->output, .events = POLLIN};
    nfds_t count = 3;
    for (uint32_t i = 0; i < l->rank_count; i++)
        wait[count++] = (struct pollfd){.fd = l->ranks[i].socket, .events = POLLIN};
    if (poll(wait, count, timeout) < 0)
        return;
    take_ranks(l);
    for (uint32_t i = 0; i < l->rank_count; i++)
        if (l->ranks[i].socket >= 0)
            read_rank(l, &l->ranks[i]);
    if (l->output >= 0)
        read_output(l);
    read_signals(l);
}

/* mpirun ended and nobody told why: it could not start the ranks, or MPI ended them. */
static void blame_mpirun(launcher *l) {
    enum { SHOWN = 1500 };
    while (l->noise_size > 0 && (l->noise[l->noise_size - 1] == '\n' || l->noise[l->noise_size - 1] == ' '))
        l->noise_size--;
    int shown = l->noise_size > SHOWN ? SHOWN : (int)l->noise_size;
    conclude(l, l->ready_count < l->layout->tile_count ? GW_MACHINE : GW_ENDED_EARLY,
             "mpirun ended before the run did%s%.*s", shown ? "; its last words:\n" : " and said nothing",
             shown, l->noise + l->noise_size - shown);
}

static void watch(launcher *l) {
    int64_t deadline = gw_now_ns() + (int64_t)(l->plan->load_deadline * 1e9);
    while (!l->has_result) {
        step(l, POLL_MS);
        if (l->mpirun_ended && !l->has_result) {
            step(l, 0); /* what the ranks said last may still be in their lines */
            blame_mpirun(l);
        }
        if (l->promised && gw_now_ns() > l->promised)
            conclude(l, GW_ENDED_EARLY, "rank 0 (tile %s) hangs: it was not heard when it should have been",
                     l->layout->tiles[0].name);
        if (l->ready_count < l->layout->tile_count && gw_now_ns() > deadline) {
            conclude(l, GW_ENDED_EARLY,
                     "only %" PRIu32 " of %" PRIu32 " ranks were ready after %.0f s; raise --load-deadline",
                     l->ready_count, l->layout->tile_count, l->plan->load_deadline);
        }
    }
}

/* --- ending
 * ------------------------------------------------------------------------------------------------------ */

static int all_gone(const launcher *l) {
    for (uint32_t i = 0; i < l->rank_count; i++)
        if (l->ranks[i].socket >= 0)
            return 0;
    return l->mpirun_ended;
}

static void signal_all(const launcher *l, int number) {
    /* mpirun puts every rank in a process group of its own, so each is told by itself. A closed line means
     * that the rank is gone and its number perhaps somebody else's. */
    for (uint32_t i = 0; i < l->rank_count; i++)
        if (l->ranks[i].socket >= 0)
            kill(l->ranks[i].pid, number);
    if (!l->mpirun_ended)
        kill(-l->mpirun, number);
}

static void wait_until_gone(launcher *l, int milliseconds) {
    int64_t deadline = gw_now_ns() + milliseconds * INT64_C(1000000);
    while (!all_gone(l) && gw_now_ns() < deadline)
        step(l, 20);
}

static void end_all(launcher *l) {
    if (l->mpirun <= 0)
        return;
    /* After a good end the ranks leave by themselves, and a lost one has its grace time. */
    if (l->result->code == GW_OK || l->result->code == GW_TILES_LOST)
        wait_until_gone(l, GRACE_MS);
    if (!all_gone(l)) {
        signal_all(l, SIGTERM);
        wait_until_gone(l, GRACE_MS);
    }
    if (!all_gone(l)) {
        gw_log_write(&l->console->log, GW_LOG_DEBUG, "ending what does not end by itself");
        signal_all(l, SIGKILL);
        wait_until_gone(l, GRACE_MS);
    }
    gw_mpirun_sweep(l->mpirun, l->job);
    gw_share_sweep();
}

gw_code gw_launch(const gw_launch_plan *plan, gw_error *result) {
    static launcher l;
    memset(&l, 0, sizeof l);
    l.plan = plan;
    l.layout = plan->layout;
    l.console = plan->console;
    l.listener = l.signals = l.output = -1;
    l.result = result;
    gw_error error = {0};
    gw_code code = start(&l, &error);
    if (code)
        conclude(&l, code, "%s", error.text);
    else
        watch(&l);
    end_all(&l);
    gw_console_finish(l.console);
    fflush(stdout);
    return result->code;
}
