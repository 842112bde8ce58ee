/* The doctor's end of the talk with `gazewall examine`. */
#include "wall/examine.h"

#include "base/clock.h"

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

enum { START_MS = 20000, FAREWELL_MS = 2000, COMMAND = 4400, NO_AGENT = 125 };

/* PROGRAM examine, for the shell of the host. */
static int quote_program(const char *program, char out[COMMAND]) {
    if (strchr(program, '\''))
        return 0;
    return snprintf(out, COMMAND, "'%s' examine", program) < COMMAND;
}

static gw_code spawn(char **words, gw_examiner *out, gw_error *error) {
    int in[2], from[2], errors[2];
    if (pipe2(in, O_CLOEXEC) || pipe2(from, O_CLOEXEC) || pipe2(errors, O_CLOEXEC))
        return gw_fail(error, GW_MACHINE, "no pipe: %s", strerror(errno));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, from[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, errors[1], STDERR_FILENO);
    int failed = posix_spawn(&out->pid, words[0], &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(in[0]);
    close(from[1]);
    close(errors[1]);
    out->in = in[1];
    out->out = from[0];
    out->errors = errors[0];
    fcntl(out->errors, F_SETFL, O_NONBLOCK);
    return failed ? gw_fail(error, GW_MACHINE, "%s cannot be started: %s", words[0], strerror(failed))
                  : GW_OK;
}

/* A whole JSON line into *answer: 1, 0 when the time is over, -1 when the other end is gone. */
static int read_answer(gw_examiner *e, int milliseconds, json_t **answer) {
    const int64_t deadline = gw_now_ns() + milliseconds * INT64_C(1000000);
    for (;;) {
        char *end;
        while ((end = memchr(e->pending, '\n', e->size))) {
            *end = '\0';
            *answer = json_loads(e->pending, 0, NULL);
            size_t used = (size_t)(end + 1 - e->pending);
            memmove(e->pending, end + 1, e->size - used);
            e->size -= used;
            if (json_is_object(*answer))
                return 1;
            json_decref(*answer);
        }
        if (e->size == sizeof e->pending)
            e->size = 0;
        int64_t left = (deadline - gw_now_ns()) / 1000000;
        struct pollfd wait = {.fd = e->out, .events = POLLIN};
        if (left <= 0 || poll(&wait, 1, (int)left) == 0)
            return 0;
        ssize_t size = read(e->out, e->pending + e->size, sizeof e->pending - e->size);
        if (size == 0 || (size < 0 && errno != EINTR))
            return -1;
        e->size += size > 0 ? (size_t)size : 0;
    }
}

/* The last line that it printed to standard error, in text. */
static void last_words(gw_examiner *e, char text[256]) {
    char all[2048];
    size_t size = 0;
    ssize_t more;
    while ((more = read(e->errors, all + size, sizeof all - 1 - size)) > 0 &&
           (size += (size_t)more) < sizeof all - 1)
        ;
    while (size && (all[size - 1] == '\n' || all[size - 1] == '\r'))
        size--;
    all[size] = '\0';
    const char *line = strrchr(all, '\n');
    snprintf(text, 256, "%.250s", line ? line + 1 : all);
}

static gw_code blame(const gw_host *host, const char *agent, const char *program, int gone, gw_examiner *e,
                     gw_error *error) {
    char words[256];
    int status = 0;
    if (gone && waitpid(e->pid, &status, 0) == e->pid)
        e->pid = 0;
    last_words(e, words);
    if (!gone)
        return gw_fail(error, GW_MACHINE,
                       "'%s' started nothing in %d s; does it ask for a password? 'ssh-copy-id %s' ends that",
                       agent, START_MS / 1000, host->name);
    if (WIFEXITED(status) && WEXITSTATUS(status) == NO_AGENT)
        return gw_fail(error, GW_MACHINE, "the agent '%s' is no command here", agent);
    if (WIFEXITED(status) && (WEXITSTATUS(status) == 127 || WEXITSTATUS(status) == 126))
        return gw_fail(error, GW_MACHINE, "there is no program %s (%s); install the same gazewall there",
                       program, words[0] ? words : "the host said nothing");
    return gw_fail(error, GW_MACHINE, "'%s' could not start a program there: %s", agent,
                   words[0] ? words : "it said nothing");
}

gw_code gw_examiner_start(const gw_host *host, const char *agent, const char *program, gw_examiner *out,
                          gw_error *error) {
    static char shell[] = "/bin/sh", option[] = "-c";
    char script[COMMAND], command[COMMAND], name[64];
    memset(out, 0, sizeof *out);
    out->in = out->out = out->errors = -1;
    if (!quote_program(program, command))
        return gw_fail(error, GW_MACHINE, "the program's path is too odd for a shell: %s", program);
    snprintf(name, sizeof name, "%s", host->name);
    /* The agent may be several words, as mpirun takes it. */
    if (host->here)
        snprintf(script, sizeof script, "exec %.*s", COMMAND - 8, command);
    else
        snprintf(script, sizeof script, "command -v %.*s >/dev/null || exit %d; exec %.2000s \"$0\" \"$@\"",
                 (int)strcspn(agent, " ") % 2000, agent, NO_AGENT, agent);
    char *words[] = {shell, option, script, name, command, NULL};
    gw_code code = spawn(words, out, error);
    json_t *greeting = NULL;
    int got = code ? 0 : read_answer(out, START_MS, &greeting);
    json_decref(greeting);
    if (!code && got <= 0)
        code = blame(host, host->here ? "sh" : agent, program, got < 0, out, error);
    if (code)
        gw_examiner_stop(out);
    return code;
}

gw_code gw_examiner_ask(gw_examiner *e, const char *request, int milliseconds, json_t **answer,
                        gw_error *error) {
    *answer = NULL;
    char words[256];
    int got = -1;
    if (dprintf(e->in, "%s\n", request) > 0)
        got = read_answer(e, milliseconds, answer);
    if (got <= 0) {
        last_words(e, words);
        return gw_fail(error, GW_MACHINE, "%s%s%s",
                       got ? "the program there ended when it was asked" : "there was no answer in time",
                       words[0] ? ": " : "", words);
    }
    const char *failed = json_string_value(json_object_get(*answer, "error"));
    if (!failed)
        return GW_OK;
    gw_fail(error, GW_MACHINE, "%s", failed);
    json_decref(*answer);
    *answer = NULL;
    return GW_MACHINE;
}

void gw_examiner_stop(gw_examiner *e) {
    if (e->in >= 0)
        close(e->in);
    const int64_t deadline = gw_now_ns() + FAREWELL_MS * INT64_C(1000000);
    while (e->pid > 0 && waitpid(e->pid, NULL, WNOHANG) == 0) {
        if (gw_now_ns() > deadline)
            kill(e->pid, SIGKILL);
        poll(NULL, 0, 10);
    }
    e->pid = 0;
    if (e->out >= 0)
        close(e->out);
    if (e->errors >= 0)
        close(e->errors);
    e->in = e->out = e->errors = -1;
}
