#include "wall/gate_internal.h"

#include "base/clock.h"
#include "base/memory.h"
#include "wall/wire_mpi.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    QUIT_PATIENCE_MS = 2000,
    DEAF_MS = 250,     /* rank 0 that did not look for so long blames no tile for the silence */
    LOOK_MS = 100,     /* how often the process of a tile that is waited for is looked at */
    SHORT_NAP_US = 20, /* where no bell rings */
    LONG_NAP_US = 500,
    BELL_NAP_MS = 10,   /* where one does */
    MESSAGES = 64,      /* of one tile, before the others have their turn */
    FIRST_PROBATION = 3 /* frames in a row in which a tile that was late must keep up */
};
static const int64_t millisecond = 1000000;

/* --- making
 * ----------------------------------------------------------------------------------------------------- */

static gw_code add_member(gw_gate *gate, uint32_t tile, const gw_acquaintance *known, gw_error *error) {
    gw_gate_member *m = &gate->members[tile];
    const gw_rectangle *rectangle = &gate->layout->tiles[tile].rectangle;
    m->rank = (int)tile;
    m->here = m->bell = known[tile].machine == known[0].machine;
    m->probation = FIRST_PROBATION;
    if (m->here)
        m->process = gw_process_find(known[tile].process);
    m->pixel_bytes = (size_t)rectangle->width * rectangle->height * 4;
    gw_code code = gw_allocate((void **)&m->tile.pixels, m->pixel_bytes, 1, "pixels of a tile", error);
    return code ? code : gw_wire_mpi(m->rank, &m->wire, error);
}

gw_code gw_gate_create(const gw_gate_options *options, gw_gate **out, gw_error *error) {
    gw_gate *gate = NULL;
    gw_acquaintance known[GW_MAXIMUM_TILES] = {0};
    uint64_t nonce = 0;
    *out = NULL;
    gw_code code = gw_allocate((void **)&gate, 1, sizeof *gate, "frame gate", error);
    if (code)
        return code;
    gate->bell.socket = -1;
    gate->count = options->layout->tile_count;
    gate->layout = options->layout;
    gate->log = options->log;
    gate->died = options->died;
    gate->died_context = options->died_context;
    gate->live = options->live;
    gate->silence = options->silence;
    gate->looked = gw_now_ns();
    code = gw_ranks_meet(options->share, known, &nonce, options->deadline, error);
    if (!code)
        code = gw_bell_open(nonce, 0, &gate->bell, error);
    if (!code)
        code = gw_swap_skew_create(options->frames, &gate->swaps, error);
    if (!code)
        code = gw_allocate((void **)&gate->members, gate->count, sizeof *gate->members, "frame gate", error);
    for (uint32_t i = 1; i < gate->count && !code; i++)
        code = add_member(gate, i, known, error);
    if (code)
        gw_gate_destroy(&gate);
    *out = gate;
    return code;
}

void gw_gate_destroy(gw_gate **gate) {
    if (!*gate)
        return;
    for (uint32_t i = 1; (*gate)->members && i < (*gate)->count; i++) {
        gw_gate_member *m = &(*gate)->members[i];
        if (m->wire)
            m->wire->close(m->wire);
        free(m->tile.pixels);
        free(m->site_sent);
    }
    gw_door_close(&(*gate)->door);
    free((*gate)->site);
    free((*gate)->members);
    gw_swap_skew_finish(&(*gate)->swaps);
    gw_bell_close(&(*gate)->bell);
    free(*gate);
    *gate = NULL;
}

const gw_gate_tile *gw_gate_tile_of(const gw_gate *gate, uint32_t tile) {
    return &gate->members[tile].tile;
}

gw_swap_skew *gw_gate_swaps(gw_gate *gate) {
    return &gate->swaps;
}

/* --- faults
 * ----------------------------------------------------------------------------------------------------- */

void gw_gate_tell(const gw_gate *gate, const gw_gate_member *m, const char *what) {
    gw_log_write(gate->log, GW_LOG_WARNING, "tile %s (rank %d) %s frame %" PRIu32 ": %s",
                 gate->layout->tiles[m->rank].name, m->rank, what,
                 gate->current.state.frame + (m->tile.state == GW_TILE_LOST && m->tile.complete),
                 m->tile.fault);
}

void gw_gate_name_fault(gw_gate_member *m, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(m->tile.fault, sizeof m->tile.fault, format, arguments);
    va_end(arguments);
}

static void lose(gw_gate *gate, gw_gate_member *m) {
    m->tile.state = GW_TILE_LOST;
    m->tile.lost_frame = gate->current.number + (m->tile.complete != 0);
    m->tile.lost++;
    m->kept_up = 0;
    gw_gate_tell(gate, m, "is lost since");
}

static void break_wire(gw_gate *gate, gw_gate_member *m, const char *why) {
    m->wire->close(m->wire);
    m->wire = NULL;
    m->outstanding = m->pixels_due = 0;
    /* Whoever comes back in its place has the site of the start. */
    m->site = 0;
    m->site_under_way = 0;
    if (m->tile.state != GW_TILE_LOST) {
        gw_gate_name_fault(m, "%s", why);
        lose(gate, m);
    }
}

void gw_gate_tile_died(gw_gate *gate, uint32_t tile, const char *how) {
    gw_gate_member *m = tile > 0 && tile < gate->count ? &gate->members[tile] : NULL;
    if (m && m->wire && !m->left)
        break_wire(gate, m, how);
}

/* Silent beyond its time: says what can be seen of it. */
static void lose_silent(gw_gate *gate, gw_gate_member *m, int64_t now) {
    const double seconds = (double)(now - m->heard) * 1e-9;
    switch (m->here ? gw_process_look(&m->process) : GW_PROCESS_UNKNOWN) {
    case GW_PROCESS_GONE:
        break_wire(gate, m, "its process died");
        return;
    case GW_PROCESS_STOPPED:
        gw_gate_name_fault(m, "its process is stopped; nothing came from it for %.1f s", seconds);
        break;
    case GW_PROCESS_RUNS:
        gw_gate_name_fault(m, "it hangs: its process runs, but its drawing did not go on for %.1f s",
                           seconds);
        break;
    case GW_PROCESS_UNKNOWN:
        gw_gate_name_fault(m, "nothing came from it for %.1f s: it hangs, is stopped, or its host is cut off",
                           seconds);
    }
    lose(gate, m);
}

static void note_late(gw_gate *gate, gw_gate_member *m, int64_t now) {
    m->tile.state = GW_TILE_LATE;
    m->kept_up = 0;
    if (m->here && gw_process_look(&m->process) == GW_PROCESS_STOPPED)
        gw_gate_name_fault(m, "its process is stopped; the others go on without it");
    else if (now - m->heard > DEAF_MS * millisecond)
        gw_gate_name_fault(m, "nothing was heard of it for %.0f ms; the others go on without it",
                           (double)(now - m->heard) * 1e-6);
    else
        gw_gate_name_fault(m, "it is slow, at work for %.0f ms; the others go on without it",
                           (double)(now - m->released_at) * 1e-6);
    gw_gate_tell(gate, m, "is late since");
}

/* --- listening
 * -------------------------------------------------------------------------------------------------- */

static void ring(const gw_gate *gate, const gw_gate_member *m) {
    if (m->bell)
        gw_bell_ring(&gate->bell, m->rank);
}

static gw_wire_result send(gw_gate *gate, gw_gate_member *m, gw_release *release) {
    release->clock = gw_now_ns();
    gw_wire_result result = m->wire->send(m->wire, release, sizeof *release);
    if (result == GW_WIRE_DONE)
        ring(gate, m);
    else if (result == GW_WIRE_BROKEN)
        break_wire(gate, m, "the line to it broke");
    return result;
}

static void send_pong(gw_gate *gate, gw_gate_member *m, int64_t silence) {
    gw_release pong = {.kind = GW_RELEASE_PONG,
                       .number = gate->current.number,
                       .silence_ms = (uint32_t)(silence / millisecond),
                       .echo = m->echo};
    /* Nothing comes between a site's announcement and the site. */
    if (!m->site_under_way && send(gate, m, &pong) == GW_WIRE_DONE) {
        m->pong_due = 0;
        m->echo = 0;
    }
}

/* A tile that was given up has spoken. */
static void take_back(gw_gate *gate, gw_gate_member *m) {
    m->tile.state = GW_TILE_LATE;
    m->tile.returned++;
    gw_gate_name_fault(m, "was lost, and came back");
    gw_gate_tell(gate, m, "takes part again from");
}

/* The frame in work is whole on this tile. */
static void complete(gw_gate *gate, gw_gate_member *m) {
    m->outstanding = m->pixels_due = 0;
    m->tile.complete = m->released == gate->current.number;
    if (m->tile.state != GW_TILE_LATE)
        return;
    /* Nobody waits for it, so the frame may be over although it is as fast as the others: what counts is
     * whether it would have been waited for. */
    const int in_time = m->tile.complete || gw_now_ns() - m->released_at <= m->allowed;
    m->kept_up = in_time ? m->kept_up + 1 : 0;
    if (m->kept_up >= m->probation) {
        m->tile.state = GW_TILE_LIVE;
        /* The more often it was late, the longer it must prove itself, so that it costs ever less. */
        m->probation = m->probation < 96 ? 2 * m->probation : m->probation;
        gw_log_write(gate->log, GW_LOG_INFO, "tile %s keeps up again", gate->layout->tiles[m->rank].name);
    }
}

static void take_presented(gw_gate *gate, gw_gate_member *m) {
    const gw_answer *answer = &m->incoming;
    /* A picture that a late tile shows after its time is no part of the wall's swap. */
    const uint32_t next = answer->kind == GW_ANSWER_LEFT ? gate->next : answer->number;
    m->tile.presented += answer->presented > 0;
    if (answer->presented && answer->rejoin_ms)
        m->tile.rejoin_ms = answer->rejoin_ms;
    if (answer->presented && answer->presented == next)
        gw_swap_skew_note(&gate->swaps, answer->presented - 1, answer->presented_at, answer->clock_error);
}

static void take_answer(gw_gate *gate, gw_gate_member *m) {
    gw_answer *answer = &m->incoming;
    m->silence = answer->silence_ms * millisecond;
    m->tile.compiling = answer->kind == GW_ANSWER_BEAT && (answer->silence_ms > 0 || m->tile.compiling);
    m->tile.processor = answer->processor;
    if (answer->kind == GW_ANSWER_BEAT) {
        m->pong_due = 1;
        m->echo = answer->beat;
        return;
    }
    take_presented(gate, m);
    if (answer->kind == GW_ANSWER_LEFT) {
        m->left = 1;
        m->outstanding = 0;
        return;
    }
    if (!m->outstanding || answer->number != m->released) {
        break_wire(gate, m, "it answered what it was not asked");
        return;
    }
    m->tile.done = answer->done;
    m->pixels_due = answer->pixels != 0;
    if (!m->pixels_due)
        complete(gate, m);
}

static int announce_site(gw_gate *gate, gw_gate_member *m) {
    gw_error error = {0};
    gw_release word = {.kind = GW_RELEASE_SITE,
                       .number = gate->current.number,
                       .silence_ms = (uint32_t)(gate->silence / millisecond),
                       .site = gate->site_epoch};
    if (!m->site_sent && gw_allocate((void **)&m->site_sent, 1, sizeof *m->site_sent, "site", &error)) {
        break_wire(gate, m, error.text);
        return 0;
    }
    if (send(gate, m, &word) != GW_WIRE_DONE)
        return 0;
    *m->site_sent = *gate->site;
    m->site_coming = gate->site_epoch;
    m->site_under_way = 1;
    return 1;
}

/* 1 when it has the site of the frame in work, or needs none; else sends what it can of it. */
static int has_site(gw_gate *gate, gw_gate_member *m) {
    if (m->site == gate->current.site)
        return 1;
    if (!m->site_under_way && !announce_site(gate, m))
        return 0;
    gw_wire_result result = m->wire->send_block(m->wire, m->site_sent, sizeof *m->site_sent);
    if (result == GW_WIRE_BROKEN)
        break_wire(gate, m, "the line to it broke");
    if (result != GW_WIRE_DONE)
        return 0;
    m->site_under_way = 0;
    m->site = m->site_coming;
    return m->site == gate->current.site;
}

/* Sends it the frame in work, unless something else is still on its way to it. */
static void send_due(gw_gate *gate, gw_gate_member *m) {
    if (!m->due || !has_site(gate, m) || send(gate, m, &gate->current) != GW_WIRE_DONE)
        return;
    m->due = 0;
    m->outstanding = 1;
    m->released = gate->current.number;
    m->released_at = gate->current.clock;
    m->allowed = gate->frame;
    m->silence = 0;
}

/* Everything that has come from one tile; 1 when something had. */
static int listen_to(gw_gate *gate, gw_gate_member *m) {
    int moved = 0;
    for (int turn = 0; turn < MESSAGES && m->wire && !m->left; turn++) {
        size_t size = 0;
        int block = m->pixels_due;
        gw_wire_result result = block ? m->wire->receive_block(m->wire, m->tile.pixels, m->pixel_bytes)
                                      : m->wire->receive(m->wire, &m->incoming, &size);
        if (result == GW_WIRE_NOT_YET)
            break;
        if (result == GW_WIRE_BROKEN || (!block && !gw_answer_check(&m->incoming, size))) {
            break_wire(gate, m, "the line to it broke");
            return 1;
        }
        moved = 1;
        m->heard = gw_now_ns();
        if (m->tile.state == GW_TILE_LOST && gate->live)
            take_back(gate, m);
        if (block)
            complete(gate, m);
        else
            take_answer(gate, m);
    }
    if (m->wire)
        send_due(gate, m);
    if (m->wire && m->pong_due)
        send_pong(gate, m, gate->silence);
    return moved;
}

static int is_listened_to(const gw_gate *gate, const gw_gate_member *m) {
    return m->wire && !m->left && (m->tile.state != GW_TILE_LOST || gate->live);
}

/* One look at all tiles; 1 when something had come. */
static int look(gw_gate *gate) {
    int moved = 0;
    int64_t now = gw_now_ns(), deaf = now - gate->looked;
    gw_death death;
    while (gate->died && gate->died(gate->died_context, &death))
        /* What is told of an earlier start of the tile comes too late. */
        if (death.tile > 0 && death.tile < gate->count && gate->members[death.tile].start == death.start)
            gw_gate_tile_died(gate, death.tile, death.how[0] ? death.how : "its process died");
    for (uint32_t i = 1; i < gate->count; i++) {
        gw_gate_member *m = &gate->members[i];
        if (deaf > DEAF_MS * millisecond)
            m->heard += deaf; /* nobody listened meanwhile */
        if (is_listened_to(gate, m))
            moved |= listen_to(gate, m);
    }
    if (gate->door)
        gw_gate_attend_door(gate);
    gate->looked = now;
    return moved;
}

/* --- a frame
 * ---------------------------------------------------------------------------------------------------- */

gw_code gw_gate_take_site(gw_gate *gate, const gw_site *site, uint32_t epoch, gw_error *error) {
    gw_code code =
        gate->site ? GW_OK : gw_allocate((void **)&gate->site, 1, sizeof *gate->site, "site", error);
    if (code)
        return code;
    *gate->site = *site;
    gate->site_epoch = epoch;
    gate->keeper.site = gate->site;
    gate->keeper.site_epoch = epoch;
    return GW_OK;
}

void gw_gate_release(gw_gate *gate, gw_release *release) {
    release->kind = GW_RELEASE_FRAME;
    release->number = gate->next++;
    release->silence_ms = (uint32_t)(gate->silence / millisecond);
    release->echo = 0;
    release->site = gate->site_epoch;
    gate->current = *release;
    for (uint32_t i = 1; i < gate->count; i++)
        gate->members[i].tile.complete = gate->members[i].due = 0;
    look(gate);
    for (uint32_t i = 1; i < gate->count; i++) {
        gw_gate_member *m = &gate->members[i];
        if (!m->wire || m->left || m->tile.state == GW_TILE_LOST)
            continue;
        if (!m->outstanding) {
            m->due = 1;
            m->heard = m->looked = gw_now_ns();
            send_due(gate, m);
        }
    }
}

void gw_gate_attend(gw_gate *gate, int64_t silence) {
    look(gate);
    for (uint32_t i = 1; i < gate->count && silence; i++) {
        gw_gate_member *m = &gate->members[i];
        if (is_listened_to(gate, m))
            send_pong(gate, m, silence + gate->silence);
    }
}

/* Something is to come from it. */
static int is_busy(const gw_gate_member *m) {
    return m->wire && (m->outstanding || m->due) && m->tile.state != GW_TILE_LOST;
}

static int is_waited_for(const gw_gate *gate, const gw_gate_member *m, const gw_patience *patience) {
    if (!is_busy(m))
        return 0;
    return !patience->live ||
           (m->tile.state == GW_TILE_LIVE && (m->due || m->released == gate->current.number));
}

/* Whose time is over? Returns how many are still waited for. */
static uint32_t judge(gw_gate *gate, const gw_patience *patience, int64_t begin) {
    uint32_t waiting = 0;
    int64_t now = gw_now_ns();
    for (uint32_t i = 1; i < gate->count; i++) {
        gw_gate_member *m = &gate->members[i];
        if (!is_busy(m))
            continue;
        if (now - m->heard > (m->silence > patience->death ? m->silence : patience->death)) {
            lose_silent(gate, m, now);
            continue;
        }
        if (m->here && now - m->looked > LOOK_MS * millisecond) {
            m->looked = now;
            if (gw_process_look(&m->process) == GW_PROCESS_GONE) {
                break_wire(gate, m, "its process died");
                continue;
            }
        }
        if (is_waited_for(gate, m, patience) && patience->live && now - begin > patience->frame)
            note_late(gate, m, now);
        waiting += (uint32_t)is_waited_for(gate, m, patience);
    }
    return waiting;
}

/* Until something comes. */
static void rest(gw_gate *gate, int moved, int64_t until) {
    struct pollfd lines[GW_MAXIMUM_TILES];
    nfds_t line_count = 0;
    int bells = 1;
    for (uint32_t i = 1; i < gate->count; i++) {
        const gw_gate_member *m = &gate->members[i];
        if (!is_busy(m))
            continue;
        const int line = m->wire->descriptor >= 0;
        if (line)
            lines[line_count++] = (struct pollfd){.fd = m->wire->descriptor, .events = POLLIN};
        if (m->due || (!line && (!m->bell || m->pixels_due)))
            bells = 0;
    }
    const int64_t most = bells ? BELL_NAP_MS * 1000 : LONG_NAP_US, least = bells ? most : SHORT_NAP_US;
    gate->nap = moved || gate->nap < least ? least : 2 * gate->nap;
    gate->nap = gate->nap > most ? most : gate->nap;
    int64_t left = until - gw_now_ns(), nap = 1000 * gate->nap;
    gw_bell_wait(&gate->bell, left < 0 ? 0 : left < nap ? left : nap, lines, line_count);
}

uint64_t gw_gate_compiling(const gw_gate *gate) {
    uint64_t tiles = 0;
    for (uint32_t i = 1; i < gate->count; i++) {
        const gw_gate_tile *tile = &gate->members[i].tile;
        const int at_it = tile->compiling || (tile->complete && tile->done.making);
        tiles |= (uint64_t)(tile->state != GW_TILE_LOST && at_it) << i;
    }
    return tiles;
}

/* Frames wait long only for kernels. */
static void tell_compiling(const gw_gate *gate) {
    char names[96], text[160];
    uint64_t tiles = 0;
    for (uint32_t i = 1; i < gate->count; i++)
        tiles |= (uint64_t)(is_busy(&gate->members[i]) && gate->members[i].tile.compiling) << i;
    if (!tiles)
        return;
    gw_layout_names(gate->layout, tiles, names, sizeof names);
    snprintf(text, sizeof text, "frame %" PRIu32 " waits for kernels: %s", gate->current.state.frame, names);
    gw_log_progress(gate->log, text, -1);
}

void gw_gate_collect(gw_gate *gate, const gw_patience *patience) {
    int64_t begin = gw_now_ns();
    gate->nap = 0;
    gate->frame = patience->live ? patience->frame : 0;
    for (uint32_t i = 1; i < gate->count; i++)
        if (gate->members[i].released == gate->current.number)
            gate->members[i].allowed = begin - gate->members[i].released_at + gate->frame;
    for (;;) {
        int moved = look(gate);
        if (!judge(gate, patience, begin))
            break;
        tell_compiling(gate);
        if (!moved)
            rest(gate, moved, patience->live ? begin + patience->frame : INT64_MAX);
    }
    for (uint32_t i = 1; i < gate->count; i++) {
        gw_gate_member *m = &gate->members[i];
        int released = m->outstanding && m->released == gate->current.number;
        m->tile.missed = m->tile.complete                ? GW_MISSED_NOT
                         : m->tile.state == GW_TILE_LOST ? GW_MISSED_LOST
                         : released                      ? GW_MISSED_LATE
                                                         : GW_MISSED_SKIPPED;
        m->tile.late += m->tile.missed == GW_MISSED_LATE;
        m->tile.skipped += m->tile.missed == GW_MISSED_SKIPPED;
    }
}

/* Sends the word to those that could not take it before; returns how many have not left. */
static uint32_t say_quit(gw_gate *gate) {
    gw_release quit = {.kind = GW_RELEASE_QUIT, .number = gate->next};
    uint32_t waiting = 0;
    for (uint32_t i = 1; i < gate->count; i++) {
        gw_gate_member *m = &gate->members[i];
        if (!m->wire || m->left)
            continue;
        /* A lost one may only be slow: the word waits for it in its queue. */
        if (!m->told && !m->site_under_way && send(gate, m, &quit) == GW_WIRE_DONE)
            m->told = 1;
        waiting += m->wire && m->tile.state != GW_TILE_LOST;
    }
    return waiting;
}

void gw_gate_quit(gw_gate *gate) {
    look(gate);
    say_quit(gate);
}

void gw_gate_wait_until_left(gw_gate *gate) {
    int64_t deadline = gw_now_ns() + QUIT_PATIENCE_MS * millisecond;
    gate->nap = 0;
    for (;;) {
        int moved = look(gate);
        if (!say_quit(gate) || gw_now_ns() > deadline)
            return;
        if (!moved)
            rest(gate, moved, deadline);
    }
}
