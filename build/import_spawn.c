/* Starts the import child, collects what it sends under limits, and turns every way to fail into one
 * sentence. */
#include "build/import_internal.h"

#include "base/clock.h"
#include "base/memory.h"
#include "build/import_stream.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Set in the child: a program that is no importer but calls gw_import would start itself without end. */
#define IMPORTING "GAZEWALL_IMPORTING"

enum { TAIL_SIZE = 2048, PIPE_CHUNK = 1 << 20, POLL_MS = 200 };

typedef struct child {
    pid_t pid;
    int output, messages; /* read ends; -1 when closed */
    gw_bytes bytes;
    size_t capacity;
    char tail[TAIL_SIZE]; /* last part of what it said on standard error */
    size_t tail_size;
    uint64_t promised; /* bytes, told by the stream's header; 0: not yet */
} child;

static void close_end(int *end) {
    if (*end >= 0)
        close(*end);
    *end = -1;
}

/* This process's environment and the mark; free() it, not its texts. */
static char **environment_of_child(void) {
    static char mark[] = IMPORTING "=1";
    size_t count = 0;
    while (environ && environ[count])
        count++;
    char **copy = calloc(count + 2, sizeof *copy);
    if (!copy)
        return NULL;
    if (count > 0)
        memcpy(copy, environ, count * sizeof *copy);
    copy[count] = mark;
    return copy;
}

/* posix_spawn, never fork: the caller may be an MPI rank. Everything above standard error is closed in the
 * child. */
static int spawn(const char *program, char *const arguments[], int output, int messages, pid_t *pid) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawnattr_init(&attributes);
    if (failed) {
        posix_spawn_file_actions_destroy(&actions);
        return failed;
    }
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    char **environment = environment_of_child();
    failed = environment ? posix_spawn(pid, program, &actions, &attributes, arguments, environment) : ENOMEM;
    free(environment);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return failed;
}

static gw_code start(child *self, const char *path, const gw_import_options *options, gw_error *error) {
    const char *program = options->program ? options->program : "/proc/self/exe";
    char seconds[32], bytes[32];
    snprintf(seconds, sizeof seconds, "%.0f", gw_import_time_limit(options) + 1.0);
    snprintf(bytes, sizeof bytes, "%llu", (unsigned long long)gw_import_memory_limit(options));
    char *path_copy = gw_copy_text(path), *verb = gw_copy_text("import-child"),
         *name = gw_copy_text("gazewall");
    char *arguments[] = {name, verb, path_copy, seconds, bytes, NULL};
    int output[2] = {-1, -1}, messages[2] = {-1, -1}, failed = 0;
    gw_code code = GW_OK;
    if (getenv(IMPORTING))
        code = gw_fail(error, GW_MACHINE, "the importer '%s' is not gazewall: it started itself", program);
    else if (!path_copy || !verb || !name)
        code = gw_fail(error, GW_MACHINE, "out of memory for the importer");
    else if (pipe2(output, O_CLOEXEC) != 0 || pipe2(messages, O_CLOEXEC) != 0)
        code = gw_fail(error, GW_MACHINE, "a pipe for the importer could not be made: %s", strerror(errno));
    else if ((failed = spawn(program, arguments, output[1], messages[1], &self->pid)) != 0)
        code = gw_fail(error, GW_MACHINE, "the importer '%s' could not be started: %s", program,
                       strerror(failed));
    close_end(&output[1]);
    close_end(&messages[1]);
    self->output = output[0];
    self->messages = messages[0];
    if (self->output >= 0) {
        fcntl(self->output, F_SETFL, O_NONBLOCK);
        fcntl(self->output, F_SETPIPE_SZ, PIPE_CHUNK); /* fewer wake-ups; a smaller pipe works too */
    }
    free(path_copy);
    free(verb);
    free(name);
    return code;
}

/* Keeps the last TAIL_SIZE - 1 bytes. */
static void read_messages(child *self) {
    char part[TAIL_SIZE / 2];
    const ssize_t got = read(self->messages, part, sizeof part);
    if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN))
        close_end(&self->messages);
    if (got <= 0)
        return;
    const size_t size = (size_t)got;
    if (self->tail_size + size > TAIL_SIZE - 1) {
        const size_t excess = self->tail_size + size - (TAIL_SIZE - 1);
        memmove(self->tail, self->tail + excess, self->tail_size - excess);
        self->tail_size -= excess;
    }
    memcpy(self->tail + self->tail_size, part, size);
    self->tail_size += size;
    self->tail[self->tail_size] = '\0';
}

static gw_code read_output(child *self, uint64_t limit, gw_error *error) {
    const size_t wanted = self->bytes.size + PIPE_CHUNK;
    gw_code code = gw_grow((void **)&self->bytes.data, &self->capacity, wanted, 1, "imported model", error);
    if (code != GW_OK)
        return code;
    const ssize_t got = read(self->output, self->bytes.data + self->bytes.size, PIPE_CHUNK);
    if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN))
        close_end(&self->output);
    if (got <= 0)
        return GW_OK;
    self->bytes.size += (size_t)got;
    if (self->bytes.size > limit)
        return gw_fail(error, GW_BAD_INPUT, "the imported model is larger than the limit of %llu MiB",
                       (unsigned long long)(limit >> 20));
    if (self->promised == 0 && self->bytes.size >= GW_MODEL_STREAM_HEADER)
        self->promised = gw_model_stream_size(self->bytes.data);
    return GW_OK;
}

/* Until both pipes are closed, or the time is over. */
static gw_code collect(child *self, const char *path, const gw_import_options *options, gw_error *error) {
    const double seconds = gw_import_time_limit(options);
    const int64_t deadline = gw_now_ns() + (int64_t)(seconds * 1e9);
    char what[160];
    snprintf(what, sizeof what, "reading %.120s", gw_path_name(path));
    while (self->output >= 0 || self->messages >= 0) {
        if (gw_now_ns() > deadline)
            return gw_fail(
                error, GW_BAD_INPUT,
                "the importer did not finish within %g s and was ended: the file is broken or too large",
                seconds);
        struct pollfd ends[2] = {{self->output, POLLIN, 0}, {self->messages, POLLIN, 0}};
        if (poll(ends, 2, POLL_MS) < 0 && errno != EINTR)
            return gw_fail(error, GW_MACHINE, "waiting for the importer failed: %s", strerror(errno));
        if (ends[1].revents)
            read_messages(self);
        gw_code code = ends[0].revents ? read_output(self, gw_import_memory_limit(options), error) : GW_OK;
        if (code != GW_OK)
            return code;
        gw_log_progress(options->log, what,
                        self->promised ? (double)self->bytes.size / (double)self->promised : 0.0);
    }
    return GW_OK;
}

/* The last "error: ..." line that the child wrote, or NULL. */
static const char *last_error_line(char *tail) {
    const char *found = NULL;
    for (char *line = tail; line && *line;) {
        char *stop = strchr(line, '\n');
        if (stop)
            *stop++ = '\0';
        if (strncmp(line, "error: ", 7) == 0)
            found = line + 7;
        line = stop;
    }
    return found;
}

static gw_code judge_end(child *self, int status, const gw_import_options *options, gw_error *error) {
    if (WIFSIGNALED(status)) {
        const int number = WTERMSIG(status);
        if (number == SIGXCPU)
            return gw_fail(
                error, GW_BAD_INPUT,
                "the importer used more than %g s of processor time and was ended: the file is broken or "
                "too large",
                gw_import_time_limit(options));
        if (strstr(self->tail, "bad_alloc"))
            return gw_fail(error, GW_BAD_INPUT,
                           "it needs more than the %llu MiB of memory that the importer may use",
                           (unsigned long long)(gw_import_memory_limit(options) >> 20));
        return gw_fail(error, GW_BAD_INPUT, "the importer crashed on it (signal %d, %s): the file is broken",
                       number, strsignal(number));
    }
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : GW_BAD_INPUT;
    if (code == 0)
        return GW_OK;
    const char *line = last_error_line(self->tail);
    return gw_fail(error, code == GW_MACHINE ? GW_MACHINE : GW_BAD_INPUT, "%s",
                   line ? line : "the importer ended without a reason");
}

gw_code gw_import_spawn(const char *path, const gw_import_options *options, gw_bytes *out, gw_error *error) {
    child self = {.output = -1, .messages = -1};
    int status = 0;
    *out = (gw_bytes){0};
    gw_code code = start(&self, path, options, error);
    if (code == GW_OK)
        code = collect(&self, path, options, error);
    if (self.pid > 0) {
        if (code != GW_OK)
            kill(self.pid, SIGKILL);
        pid_t ended;
        do {
            ended = waitpid(self.pid, &status, 0);
        } while (ended < 0 && errno == EINTR);
        if (code == GW_OK && ended == self.pid) /* else somebody else reaped it; the stream's own end tells */
            code = judge_end(&self, status, options, error);
    }
    close_end(&self.output);
    close_end(&self.messages);
    if (code != GW_OK)
        free(self.bytes.data);
    else
        *out = self.bytes;
    return code;
}
