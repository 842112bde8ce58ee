#include "wall/gate_door.h"

#include "base/clock.h"
#include "base/memory.h"
#include "wall/layout.h"
#include "wall/wire_tcp.h"

#include <errno.h>
#include <inttypes.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    STRANGERS = 8,
    WAITING = 64,
    ATTEND_MS = 5,
    HELLO_MS = 2000, /* for a stranger to say who it is */
    ROOM_MS = 100,   /* a silent stranger that was there for so long makes room for the next */
    TELL_MS = 1000   /* between two lines about dropped connections */
};
static const int64_t millisecond = 1000000;

typedef enum stage { NOBODY, STRANGER, SENT_SITE, LOADS, READY } stage;

typedef struct visitor {
    stage stage;
    gw_wire *wire;
    int64_t since; /* ns */
    char from[64];
    gw_rejoin_hello hello;
    gw_site *site; /* what is sent to it: a copy, because a newer one may come meanwhile */
    uint32_t site_epoch;
} visitor;

struct gw_door {
    gw_door_options options;
    int socket;
    char name[96];
    visitor strangers[STRANGERS];
    visitor tiles[GW_MAXIMUM_TILES]; /* who has told the secret, by the tile that it is */
    int64_t attended, told;          /* ns */
    uint32_t refused, untold;        /* connections dropped; of these, not told about yet */
};

/* --- opening and closing
 * --------------------------------------------------------------------------------------------- */

static void name_door(gw_door *door) {
    struct sockaddr_storage bound;
    socklen_t size = sizeof bound;
    char port[16] = "";
    if (!getsockname(door->socket, (struct sockaddr *)&bound, &size))
        getnameinfo((struct sockaddr *)&bound, size, NULL, 0, port, sizeof port, NI_NUMERICSERV);
    snprintf(door->name, sizeof door->name, "%.64s:%s", door->options.address, port);
}

static gw_code listen_at(gw_door *door, gw_error *error) {
    const struct addrinfo hints = {.ai_family = AF_UNSPEC,
                                   .ai_socktype = SOCK_STREAM,
                                   .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE};
    const int on = 1;
    struct addrinfo *found = NULL;
    char port[8];
    snprintf(port, sizeof port, "%u", (unsigned)door->options.port);
    int failed = getaddrinfo(door->options.address, port, &hints, &found);
    if (failed)
        return gw_fail(error, GW_BAD_INPUT, "'%s' is no numeric address: %s", door->options.address,
                       gai_strerror(failed));
    door->socket = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, found->ai_protocol);
    int bad = door->socket < 0 || setsockopt(door->socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) ||
              bind(door->socket, found->ai_addr, found->ai_addrlen) || listen(door->socket, WAITING);
    gw_code code = bad ? gw_fail(error, GW_MACHINE, "nothing can listen at %s, port %s, on this machine: %s",
                                 door->options.address, port, strerror(errno))
                       : GW_OK;
    freeaddrinfo(found);
    if (!code)
        name_door(door);
    return code;
}

gw_code gw_door_open(const gw_door_options *options, gw_door **out, gw_error *error) {
    gw_door *door = NULL;
    gw_code code = gw_allocate((void **)&door, 1, sizeof *door, "door of the gate", error);
    *out = NULL;
    if (code)
        return code;
    door->options = *options;
    door->socket = -1;
    code = listen_at(door, error);
    if (code)
        gw_door_close(&door);
    *out = door;
    return code;
}

static void leave(visitor *v) {
    if (v->wire)
        v->wire->close(v->wire);
    free(v->site);
    *v = (visitor){0};
}

void gw_door_close(gw_door **door) {
    gw_door *d = *door;
    if (!d)
        return;
    if (d->socket >= 0)
        close(d->socket);
    for (int i = 0; i < STRANGERS; i++)
        leave(&d->strangers[i]);
    for (int i = 0; i < GW_MAXIMUM_TILES; i++)
        leave(&d->tiles[i]);
    free(d);
    *door = NULL;
}

const char *gw_door_name(const gw_door *door) {
    return door->name;
}

uint32_t gw_door_refused(const gw_door *door) {
    return door->refused;
}

/* --- who comes
 * ---------------------------------------------------------------------------------------------------- */

/* A flood of them must not become a flood of lines. */
static void refuse(gw_door *door, visitor *v, const char *why, int64_t now) {
    door->refused++;
    if (door->told && now - door->told < TELL_MS * millisecond)
        door->untold++;
    else {
        char others[48] = "";
        if (door->untold)
            snprintf(others, sizeof others, "; %" PRIu32 " more since the last such line", door->untold);
        gw_log_write(door->options.log, GW_LOG_WARNING, "a connection from %s was dropped at the gate: %s%s",
                     v->from, why, others);
        door->told = now;
        door->untold = 0;
    }
    leave(v);
}

/* A free place, if need be that of the oldest who has had time to speak; NULL: there is none yet. */
static visitor *place_for_stranger(gw_door *door, int64_t now) {
    visitor *oldest = &door->strangers[0];
    for (int i = 0; i < STRANGERS; i++) {
        if (door->strangers[i].stage == NOBODY)
            return &door->strangers[i];
        if (door->strangers[i].since < oldest->since)
            oldest = &door->strangers[i];
    }
    if (now - oldest->since < ROOM_MS * millisecond)
        return NULL;
    refuse(door, oldest, "it said nothing, and others wait", now);
    return oldest;
}

static void let_in(gw_door *door, int64_t now) {
    for (int turn = 0; turn < STRANGERS; turn++) {
        struct sockaddr_storage peer;
        socklen_t size = sizeof peer;
        gw_error ignored = {0};
        visitor *v = place_for_stranger(door, now);
        int taken =
            v ? accept4(door->socket, (struct sockaddr *)&peer, &size, SOCK_CLOEXEC | SOCK_NONBLOCK) : -1;
        if (taken < 0 || gw_wire_tcp(taken, &v->wire, &ignored))
            return;
        v->stage = STRANGER;
        v->since = now;
        if (getnameinfo((struct sockaddr *)&peer, size, v->from, sizeof v->from, NULL, 0, NI_NUMERICHOST))
            snprintf(v->from, sizeof v->from, "an unknown address");
    }
}

/* --- what they say
 * ------------------------------------------------------------------------------------------------ */

/* A tile of this run: the site goes to it, or the reason why it may not come in. */
static void welcome(gw_door *door, visitor *v, const gw_door_keeper *keeper, int64_t now) {
    const uint32_t tile = v->hello.tile;
    const char *why = strcmp(v->hello.program, door->options.program)
                          ? "it is another program than rank 0's; install the same gazewall on both"
                          : keeper->refuse(keeper->context, tile, v->hello.start);
    visitor *place = &door->tiles[tile];
    gw_error error = {0};
    if (!why && place->stage != NOBODY && v->hello.start <= place->hello.start)
        why = "another process is about to take its place";
    if (!why && gw_allocate((void **)&v->site, 1, sizeof *v->site, "site", &error))
        why = error.text;
    if (why) {
        gw_rejoin_welcome word = {0};
        snprintf(word.text, sizeof word.text, "%.255s", why);
        v->wire->send(v->wire, &word, sizeof word);
        refuse(door, v, why, now);
        return;
    }
    leave(place); /* an older start of it */
    const gw_rejoin_welcome word = {.taken = 1,
                                    .number = keeper->number,
                                    .site = keeper->site_epoch,
                                    .here = (uint32_t)keeper->is_here(keeper->context, tile),
                                    .keys = door->options.keys};
    *v->site = *keeper->site;
    v->site_epoch = keeper->site_epoch;
    if (v->wire->send(v->wire, &word, sizeof word) != GW_WIRE_DONE) {
        refuse(door, v, "the line to it broke", now);
        return;
    }
    v->stage = SENT_SITE;
    v->since = now;
    *place = *v;
    *v = (visitor){0};
    gw_log_write(door->options.log, GW_LOG_INFO, "tile %s was started again and loads",
                 keeper->name(keeper->context, tile));
}

static void hear_stranger(gw_door *door, visitor *v, const gw_door_keeper *keeper, int64_t now) {
    uint8_t message[GW_WIRE_MESSAGE];
    size_t size = 0;
    const gw_wire_result result = v->wire->receive(v->wire, message, &size);
    if (result == GW_WIRE_NOT_YET) {
        if (now - v->since > HELLO_MS * millisecond)
            refuse(door, v, "it did not say who it is", now);
        return;
    }
    const char *why = result == GW_WIRE_DONE ? gw_rejoin_hello_read(message, size, &v->hello)
                                             : "what it sent is no hello of a tile";
    if (!why && !gw_same_secret(v->hello.secret, door->options.secret))
        why = "it did not tell the secret of this run";
    if (why)
        refuse(door, v, why, now);
    else
        welcome(door, v, keeper, now);
}

/* What it has loaded is what the wall shows. */
static void hear_ready(gw_door *door, visitor *v, int64_t now) {
    uint8_t message[GW_WIRE_MESSAGE];
    size_t size = 0;
    gw_rejoin_ready ready;
    const gw_wire_result result = v->wire->receive(v->wire, message, &size);
    if (result == GW_WIRE_NOT_YET)
        return;
    if (result == GW_WIRE_DONE && size == sizeof ready)
        memcpy(&ready, message, sizeof ready);
    if (result == GW_WIRE_BROKEN || size != sizeof ready)
        refuse(door, v, "a tile that was started again left while it loaded", now);
    else if (!gw_hash_equal(ready.scene, door->options.keys.scene) ||
             !gw_hash_equal(ready.octree, door->options.keys.octree))
        refuse(door, v, "a tile that was started again has loaded another scene", now);
    else
        v->stage = READY;
}

static void go_on(gw_door *door, visitor *v, int64_t now) {
    if (v->stage == SENT_SITE) {
        const gw_wire_result result = v->wire->send_block(v->wire, v->site, sizeof *v->site);
        if (result == GW_WIRE_BROKEN) {
            refuse(door, v, "a tile that was started again left while it was sent the site", now);
            return;
        }
        v->stage = result == GW_WIRE_DONE ? LOADS : SENT_SITE;
    }
    if (v->stage == LOADS)
        hear_ready(door, v, now);
    if (v->stage != NOBODY && v->stage != READY && now - v->since > door->options.patience)
        refuse(door, v, "a tile that was started again took too long to load", now);
}

void gw_door_attend(gw_door *door, const gw_door_keeper *keeper) {
    const int64_t now = gw_now_ns();
    if (now - door->attended < ATTEND_MS * millisecond)
        return;
    door->attended = now;
    let_in(door, now);
    for (int i = 0; i < STRANGERS; i++)
        if (door->strangers[i].stage == STRANGER)
            hear_stranger(door, &door->strangers[i], keeper, now);
    for (int i = 0; i < GW_MAXIMUM_TILES; i++)
        if (door->tiles[i].stage != NOBODY)
            go_on(door, &door->tiles[i], now);
}

int gw_door_take(gw_door *door, gw_newcomer *out) {
    for (uint32_t i = 0; i < GW_MAXIMUM_TILES; i++) {
        visitor *v = &door->tiles[i];
        if (v->stage != READY)
            continue;
        *out = (gw_newcomer){.tile = i,
                             .start = v->hello.start,
                             .site = v->site_epoch,
                             .process = v->hello.process,
                             .wire = v->wire};
        v->wire = NULL;
        leave(v);
        return 1;
    }
    return 0;
}
