#include "wall/rejoin.h"

#include "base/clock.h"
#include "wall/process_state.h"
#include "wall/rank_device.h"
#include "wall/reach.h"
#include "wall/rejoin_message.h"
#include "wall/share_kept.h"
#include "wall/wire_tcp.h"

#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CONNECT_MS = 5000, WELCOME_MS = 10000, NAP_MS = 100 };

int gw_rejoin_number(const char *place) {
    gw_rejoin_place read;
    char line[GW_SECRET_DIGITS + 2] = "";
    if (!gw_rejoin_place_read(place, &read))
        return -1;
    if (!getenv(GW_LINK_SECRET) && fgets(line, sizeof line, stdin)) {
        line[strcspn(line, "\n")] = '\0';
        setenv(GW_LINK_SECRET, line, 1);
    }
    return (int)read.tile;
}

/* --- at rank 0's door
 * ---------------------------------------------------------------------------------------- */

static gw_code broken(gw_error *error) {
    return gw_fail(error, GW_MACHINE, "rank 0 does not let this tile in: the line to it broke");
}

static gw_code knock(const gw_rejoin_place *place, gw_wire **out, gw_error *error) {
    const char *secret = getenv(GW_LINK_SECRET);
    gw_rejoin_hello hello = {.tile = place->tile, .start = place->start, .process = getpid()};
    uint8_t bytes[GW_REJOIN_HELLO];
    int made = -1;
    snprintf(hello.secret, sizeof hello.secret, "%s", secret ? secret : "");
    gw_code code = gw_program_hash(hello.program, error);
    if (code)
        return code;
    const gw_reach reach = gw_reach_tcp(place->address, place->port, CONNECT_MS, &made);
    if (reach != GW_REACHED)
        return gw_fail(error, GW_MACHINE, "rank 0 cannot be reached at %s, port %u: %s", place->address,
                       (unsigned)place->port, gw_reach_name(reach));
    code = gw_wire_tcp(made, out, error);
    if (code)
        return code;
    gw_rejoin_hello_write(&hello, bytes);
    return (*out)->send(*out, bytes, sizeof bytes) == GW_WIRE_DONE ? GW_OK : broken(error);
}

/* Until something comes, for a moment. */
static gw_code nap(const gw_wire *wire, int64_t deadline, gw_error *error) {
    struct pollfd line = {.fd = wire->descriptor, .events = POLLIN};
    poll(&line, 1, NAP_MS);
    return gw_now_ns() < deadline
               ? GW_OK
               : gw_fail(error, GW_MACHINE, "rank 0 did not answer at its door for %d s", WELCOME_MS / 1000);
}

static gw_code be_welcomed(gw_wire *wire, gw_site *site, gw_rejoin_welcome *out, gw_error *error) {
    const int64_t deadline = gw_now_ns() + WELCOME_MS * INT64_C(1000000);
    uint8_t message[GW_WIRE_MESSAGE];
    size_t size = 0;
    gw_wire_result result;
    while ((result = wire->receive(wire, message, &size)) == GW_WIRE_NOT_YET)
        if (nap(wire, deadline, error))
            return error->code;
    if (result == GW_WIRE_DONE && size == sizeof *out)
        memcpy(out, message, sizeof *out);
    if (result == GW_WIRE_BROKEN || !gw_rejoin_welcome_check(out, size))
        return broken(error);
    if (!out->taken)
        return gw_fail(error, GW_MACHINE, "rank 0 does not let this tile in: %s", out->text);
    while ((result = wire->receive_block(wire, site, sizeof *site)) == GW_WIRE_NOT_YET)
        if (nap(wire, deadline, error))
            return error->code;
    return result == GW_WIRE_BROKEN ? broken(error) : GW_OK;
}

/* --- what it draws with
 * -------------------------------------------------------------------------------------- */

static gw_code load(gw_rank *rank, const gw_rejoin_keys *keys, gw_error *error) {
    const gw_draw_options *draw = &rank->options.draw;
    char *cache = gw_cache_folder(draw);
    /* Processor time, because a machine with much to do stretches every other. */
    int64_t at[5] = {0, gw_processor_ns()};
    gw_code code = gw_rank_open_window(rank, error);
    if (!code)
        code = gw_share_restore(&rank->share, cache, keys, &draw->settings, error);
    free(cache);
    at[2] = gw_processor_ns();
    if (!code)
        code = gw_rank_open_device(rank, error);
    at[3] = gw_processor_ns();
    if (!code)
        code = gw_rank_create_renderer(rank, error);
    at[4] = gw_processor_ns();
    double ms[4];
    for (int i = 0; i < 4; i++)
        ms[i] = (double)(at[i + 1] - at[i]) * 1e-6;
    gw_log_write(&rank->line.log, GW_LOG_DEBUG,
                 "tile %s: ms of processor: %.0f until it was let in, %.0f reading the cache, %.0f for the "
                 "device, %.0f for the renderer",
                 rank->site.layout.tiles[rank->number].name, ms[0], ms[1], ms[2], ms[3]);
    return code;
}

static gw_code prepare(gw_rank *rank, const gw_rejoin_welcome *welcome, gw_error *error) {
    gw_code code = GW_OK;
    if (rank->options.gate_only)
        return GW_OK;
    if (gw_rank_needs_scene(rank))
        code = load(rank, &welcome->keys, error);
    else
        code = gw_rank_open_window(rank, error);
    return code ? code : gw_rank_make_room(rank, error);
}

gw_code gw_rank_rejoin(gw_rank *rank, gw_error *error) {
    gw_rejoin_place place;
    gw_rejoin_welcome welcome;
    gw_wire *wire = NULL;
    rank->rejoined = gw_now_ns() - gw_process_age();
    if (!gw_rejoin_place_read(rank->options.rejoin, &place))
        return gw_fail(error, GW_BAD_INPUT, "--rejoin '%s' is no place", rank->options.rejoin);
    gw_code code = knock(&place, &wire, error);
    if (!code)
        code = be_welcomed(wire, &rank->site, &welcome, error);
    if (!code && place.tile >= rank->site.layout.tile_count)
        code = broken(error);
    if (code)
        return code;
    rank->size = (int)rank->site.layout.tile_count;
    rank->site_epoch = welcome.site;
    rank->next = welcome.number;
    code = prepare(rank, &welcome, error);
    if (code)
        return code;
    const gw_rejoin_ready ready = {.scene = rank->share.scene.scene.hash, .octree = rank->share.octree.hash};
    if (wire->send(wire, &ready, sizeof ready) != GW_WIRE_DONE)
        return broken(error);
    gw_link_send(&rank->line, GW_LINK_READY, 0, "");
    gw_gate_client_join(&rank->gate, wire, (int)welcome.here, welcome.site);
    return gw_rank_follow(rank, error);
}
