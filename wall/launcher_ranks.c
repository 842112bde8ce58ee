/* The launcher's side of the lines to the ranks: who comes, what they say, who is gone. */
#include "wall/launcher_internal.h"

#include "base/clock.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>

#define SECONDS INT64_C(1000000000)

enum { HELLO_S = 10, SILENCE_S = 10 };

void gw_launcher_conclude(gw_launcher *l, gw_code code, const char *format, ...) {
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

/* --- who it is
 * -------------------------------------------------------------------------------------------- */

static int number_of(const gw_launcher *l, const gw_rank_line *r) {
    return (int)(r - l->ranks);
}

static const char *tile_name(const gw_launcher *l, const gw_rank_line *r) {
    return l->plan->site->layout.tiles[number_of(l, r)].name;
}

/* "rank 3 (tile c1r0 on wall2, process 4711)"; the host only where it is another. */
static const char *name_rank(const gw_launcher *l, const gw_rank_line *r, char text[160]) {
    snprintf(text, 160, "rank %d (tile %s%s%s, process %ld)", number_of(l, r), tile_name(l, r),
             r->here ? "" : " on ", r->here ? "" : r->host, (long)r->pid);
    return text;
}

void gw_launcher_silent(const gw_launcher *l, char text[512]) {
    uint32_t told = 0;
    text[0] = '\0';
    for (uint32_t i = 0; i < l->tile_count && told < 3; i++) {
        char name[160];
        if (!l->ranks[i].silent)
            continue;
        size_t length = strlen(text);
        snprintf(text + length, 512 - length, "%s%s", told ? ", " : "", name_rank(l, &l->ranks[i], name));
        told++;
    }
}

int gw_launcher_mpirun_killed(gw_launcher *l) {
    if (!l->mpirun_ended || !WIFSIGNALED(l->mpirun_status))
        return 0;
    gw_launcher_conclude(l, GW_ENDED_EARLY, "mpirun was killed by signal %d", WTERMSIG(l->mpirun_status));
    return 1;
}

/* --- messages
 * --------------------------------------------------------------------------------------------- */

static void fail(gw_launcher *l, gw_rank_line *r, const gw_link_message *m) {
    char silent[512];
    gw_launcher_silent(l, silent);
    r->left = 1;
    snprintf(r->failed, sizeof r->failed, "%.255s", m->text);
    /* One that waited in vain for another that does not answer is not the one to name. */
    if (!gw_launcher_all_ready(l) && m->value == GW_ENDED_EARLY && silent[0])
        gw_launcher_conclude(l, GW_ENDED_EARLY, "%s: no sign of life before the first frame", silent);
    else if (number_of(l, r) == 0)
        gw_launcher_conclude(l, (gw_code)m->value, "%s", m->text);
    else if (!gw_launcher_all_ready(l))
        gw_launcher_conclude(l, (gw_code)m->value, "tile %s: %s", tile_name(l, r), m->text);
    else /* Once all are ready, a tile that fails is rank 0's to judge; after the end it is no matter. */
        gw_log_write(&l->console->log, l->has_result ? GW_LOG_DEBUG : GW_LOG_WARNING, "tile %s: %s",
                     tile_name(l, r), m->text);
}

static void show_progress(gw_launcher *l, const gw_rank_line *r, const gw_link_message *m) {
    char text[160];
    snprintf(text, sizeof text, "%s%s%.80s", r->here ? "" : r->host, r->here ? "" : ": ", m->text);
    gw_log_progress(&l->console->log, text, m->fraction);
}

static void take_message(gw_launcher *l, gw_rank_line *r, const gw_link_message *m) {
    switch ((gw_link_kind)m->kind) {
    case GW_LINK_LOG:
        gw_log_write(&l->console->log, (gw_log_level)m->value, "%s", m->text);
        break;
    case GW_LINK_PROGRESS:
        show_progress(l, r, m);
        break;
    case GW_LINK_READY:
        l->ready_count += !r->ready;
        r->ready = 1;
        break;
    case GW_LINK_PROMISE:
        if (number_of(l, r) == 0)
            l->promised = gw_now_ns() + (int64_t)(m->fraction * 1e9);
        break;
    case GW_LINK_DOOR:
        if (number_of(l, r) == 0) {
            snprintf(l->door, sizeof l->door, "%.95s", m->text);
            l->restart_most = m->value < 0 || m->value > GW_MAXIMUM_RESTARTS ? 0 : (uint32_t)m->value;
        }
        break;
    case GW_LINK_PRINT:
        gw_console_finish(l->console);
        puts(m->text);
        break;
    case GW_LINK_FAILED:
        fail(l, r, m);
        break;
    case GW_LINK_LEFT:
        r->left = 1;
        break;
    case GW_LINK_RESULT:
        r->left = 1;
        gw_launcher_conclude(l, (gw_code)m->value,
                             m->value == GW_TILES_LOST ? "finished, but not all tiles lasted to the end"
                                                       : "");
        break;
    default: /* a pong: that something came is what counts */
        break;
    }
}

/* The ranks die with mpirun, and are not to blame; its own end may be told a moment after theirs. */
static void blame_rank(gw_launcher *l, const char *text) {
    for (int turn = 0; turn < 20 && !l->mpirun_ended; turn++) {
        poll(NULL, 0, 10);
        gw_launcher_reap(l);
    }
    if (!gw_launcher_mpirun_killed(l))
        gw_launcher_conclude(l, GW_ENDED_EARLY, "%s", text);
}

static void lost_rank(gw_launcher *l, gw_rank_line *r, int how) {
    gw_line_close(&r->line);
    r->silent = 0;
    const int vital = number_of(l, r) == 0 || !gw_launcher_all_ready(l);
    if (l->has_result || (r->left && (vital || !r->failed[0])))
        return;
    if (!r->left) {
        char text[512], name[160];
        const char *when = gw_launcher_all_ready(l) ? "on the way" : "before the first frame";
        if (how)
            snprintf(text, sizeof text, "%s was cut off %s: %s", name_rank(l, r, name), when, strerror(how));
        else
            snprintf(text, sizeof text, "%s died %s", name_rank(l, r, name), when);
        if (vital) {
            blame_rank(l, text);
            return;
        }
        gw_log_write(&l->console->log, GW_LOG_WARNING, "%s", text);
    }
    /* Rank 0 learns it before anything that is started again can knock at its door. */
    gw_line_send(&l->ranks[0].line, GW_LINK_LOST, number_of(l, r), r->start, r->failed, 0);
    gw_launcher_want_restart(l, (uint32_t)number_of(l, r));
}

static void read_rank(gw_launcher *l, gw_rank_line *r) {
    gw_link_message message;
    int got;
    while ((got = gw_line_receive(&r->line, &message)) > 0) {
        r->asked = 0;
        r->silent = 0;
        take_message(l, r, &message);
    }
    if (got < 0)
        lost_rank(l, r, got == -1 && errno != ECONNRESET ? errno : 0);
}

/* --- strangers
 * -------------------------------------------------------------------------------------------- */

static void drop(gw_launcher *l, gw_stranger *s, const char *why) {
    if (why)
        gw_log_write(&l->console->log, GW_LOG_WARNING, "a connection from %s was dropped: %s", s->from, why);
    gw_line_close(&s->line);
    *s = l->strangers[--l->stranger_count];
}

static void refuse_program(gw_launcher *l, gw_rank_line *r, int again, const char *program) {
    char name[160], text[512];
    snprintf(
        text, sizeof text,
        "%s runs another program than this machine: the executable there has hash %s, here %s; install the "
        "same gazewall on both",
        name_rank(l, r, name), program, l->program);
    if (!again) {
        gw_launcher_conclude(l, GW_MACHINE, "%s", text);
        return;
    }
    gw_log_write(&l->console->log, GW_LOG_ERROR, "%s", text);
    r->left = 1;
    snprintf(r->failed, sizeof r->failed, "it is another program than rank 0's");
    lost_rank(l, r, 0);
}

/* Where tiles that are started again find rank 0. */
static const char *door_address(const gw_launcher *l) {
    const gw_hosts *hosts = l->plan->hosts;
    const gw_host *first = &hosts->host[hosts->of_tile[0]];
    return !first->here ? first->address : hosts->remote ? hosts->listen : "127.0.0.1";
}

static void greet(gw_launcher *l, gw_stranger *s, const gw_link_message *m) {
    gw_hello hello;
    if (m->kind != GW_LINK_HELLO || !gw_hello_read(m->text, &hello) ||
        !gw_same_secret(hello.secret, l->listener.secret)) {
        drop(l, s, "it did not tell the secret of this run");
        return;
    }
    gw_rank_line *r = m->value >= 0 && m->value < (int)l->tile_count ? &l->ranks[m->value] : NULL;
    const int again = r && r->greeted;
    if (!r || r->line.socket >= 0 || (again && !l->restarts[m->value].pending)) {
        drop(l, s, r ? "its rank is here already" : "the wall has no tile for its rank");
        return;
    }
    l->greeted_count += !again;
    *r = (gw_rank_line){.line = s->line,
                        .pid = s->pid ? s->pid : hello.pid,
                        .here = s->pid != 0,
                        .start = l->restarts[m->value].start,
                        .greeted = 1,
                        .ready = r->ready};
    l->restarts[m->value].pending = 0;
    snprintf(r->host, sizeof r->host, "%s", hello.host);
    if (hello.job)
        l->job = hello.job;
    s->line.socket = -1;
    drop(l, s, NULL);
    gw_log_write(&l->console->log, GW_LOG_DEBUG, "rank %d (tile %s) is process %ld%s%s", number_of(l, r),
                 tile_name(l, r), (long)r->pid, r->here ? "" : " on ", r->here ? "" : r->host);
    if (strcmp(hello.program, l->program))
        refuse_program(l, r, again, hello.program);
    else /* Only rank 0 has a door; its site may name another address. */
        gw_line_send(&r->line, GW_LINK_WELCOME, 0, 0, number_of(l, r) ? "" : door_address(l), 0);
}

static void take_connections(gw_launcher *l) {
    while (l->stranger_count < GW_LAUNCHER_STRANGERS) {
        gw_stranger *s = &l->strangers[l->stranger_count];
        *s = (gw_stranger){.since = gw_now_ns()};
        s->line.socket = gw_link_accept(&l->listener, &s->pid, s->from);
        if (s->line.socket < 0)
            return;
        l->stranger_count++;
    }
}

static void read_strangers(gw_launcher *l) {
    /* From the last, because one that goes is replaced by the last. */
    for (uint32_t i = l->stranger_count; i-- > 0;) {
        gw_stranger *s = &l->strangers[i];
        gw_link_message message;
        int got = gw_line_receive(&s->line, &message);
        if (got > 0)
            greet(l, s, &message);
        else if (got == -2)
            drop(l, s, "what it sent is no message of a rank");
        else if (got < 0)
            drop(l, s, NULL);
        else if (gw_now_ns() - s->since > HELLO_S * SECONDS)
            drop(l, s, "it said nothing");
    }
}

void gw_launcher_listen(gw_launcher *l) {
    take_connections(l);
    read_strangers(l);
    for (uint32_t i = 0; i < l->tile_count; i++)
        if (l->ranks[i].line.socket >= 0)
            read_rank(l, &l->ranks[i]);
}

void gw_launcher_ping(gw_launcher *l) {
    int64_t now = gw_now_ns();
    if (now - l->pinged < SECONDS)
        return;
    l->pinged = now;
    for (uint32_t i = 0; i < l->tile_count; i++) {
        gw_rank_line *r = &l->ranks[i];
        if (r->line.socket < 0)
            continue;
        if (!r->asked) {
            r->asked = now;
            gw_line_send(&r->line, GW_LINK_PING, 0, 0, "", 0);
        } else if (!r->silent && now - r->asked > SILENCE_S * SECONDS) {
            char name[160];
            r->silent = 1;
            if (!gw_launcher_all_ready(l))
                gw_log_write(&l->console->log, GW_LOG_WARNING,
                             "%s gives no sign of life since %d s: is it stopped, or its host cut off?",
                             name_rank(l, r, name), SILENCE_S);
        }
    }
}
