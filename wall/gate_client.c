#include "wall/gate_client.h"

#include "base/clock.h"
#include "wall/wire_mpi.h"

#include <inttypes.h>
#include <string.h>

enum {
    BEAT_MS = 200,
    DEAF_MS = 1000, /* a tile that did not look for so long, because it was stopped, blames nobody */
    SHORT_NAP_US = 20,
    LONG_NAP_US = 500, /* where no bell rings */
    BELL_NAP_MS = 10,
    LEAVE_MS = 2000,
    JOIN_MS = 10000 /* until rank 0 is heard for the first time */
};
static const int64_t millisecond = 1000000;

gw_code gw_gate_client_open(gw_gate_client *client, const gw_share *share, int rank, int64_t deadline,
                            gw_error *error) {
    uint64_t nonce = 0;
    client->bell.socket = -1;
    gw_code code = gw_ranks_meet(share, NULL, &nonce, deadline, error);
    client->here = share->leader == 0;
    if (!code && client->here)
        code = gw_bell_open(nonce, rank, &client->bell, error);
    if (!code)
        code = gw_wire_mpi(0, &client->wire, error);
    client->heard = client->looked = gw_now_ns();
    client->allowed = deadline - client->heard;
    client->offset_error = client->here ? 0 : -1;
    return code;
}

void gw_gate_client_join(gw_gate_client *client, gw_wire *wire, int here, uint32_t site) {
    client->bell.socket = -1;
    client->wire = wire;
    client->here = here;
    client->site_epoch = site;
    client->heard = client->looked = gw_now_ns();
    client->allowed = JOIN_MS * millisecond;
    client->offset_error = here ? 0 : -1;
}

void gw_gate_client_close(gw_gate_client *client) {
    if (client->wire)
        client->wire->close(client->wire);
    client->wire = NULL;
    gw_bell_close(&client->bell);
}

static void rest(gw_gate_client *client, int busy) {
    const int bell = (client->bell.socket >= 0 || client->wire->descriptor >= 0) && !busy;
    const int64_t most = bell ? BELL_NAP_MS * 1000 : LONG_NAP_US, least = bell ? most : SHORT_NAP_US;
    client->nap = client->nap < least ? least : 2 * client->nap;
    client->nap = client->nap > most ? most : client->nap;
    const struct pollfd line = {.fd = client->wire->descriptor, .events = POLLIN};
    gw_bell_wait(&client->bell, 1000 * client->nap, &line, 1);
}

/* Of several replies the fastest knows best; older ones count for less and less, since clocks drift. */
static void learn_clock(gw_gate_client *client, int64_t now, int64_t clock) {
    const int64_t trip = now - client->beat_at, error = trip / 2;
    if (client->here)
        return;
    client->offset_error += client->offset_error / 64;
    if (client->offset_error < 0 || error < client->offset_error) {
        client->offset = clock - (client->beat_at + error);
        client->offset_error = error;
    }
}

/* Everything that has come from rank 0. */
static gw_code listen(gw_gate_client *client, gw_error *error) {
    int64_t now = gw_now_ns(), deaf = now - client->looked;
    client->looked = now;
    if (deaf > DEAF_MS * millisecond)
        client->heard += deaf;
    for (;;) {
        uint8_t message[GW_WIRE_MESSAGE];
        gw_release release;
        size_t size = 0;
        if (client->site_due) {
            gw_wire_result block =
                client->wire->receive_block(client->wire, &client->site, sizeof client->site);
            if (block == GW_WIRE_NOT_YET)
                return GW_OK;
            if (block == GW_WIRE_BROKEN)
                return gw_fail(error, GW_ENDED_EARLY, "rank 0 was lost: the line to it broke");
            client->site_due = 0;
            client->site_epoch = client->site_coming;
            client->heard = gw_now_ns();
        }
        gw_wire_result result = client->wire->receive(client->wire, message, &size);
        if (result == GW_WIRE_NOT_YET)
            return GW_OK;
        if (result == GW_WIRE_DONE && size == sizeof release)
            memcpy(&release, message, sizeof release);
        if (result == GW_WIRE_BROKEN || !gw_release_check(&release, size))
            return gw_fail(error, GW_ENDED_EARLY, "rank 0 was lost: the line to it broke");
        client->heard = gw_now_ns();
        /* It may quit as soon as it has an answer whose sending has not been seen to end here. */
        client->allowed =
            (release.kind == GW_RELEASE_QUIT ? LEAVE_MS : (int64_t)release.silence_ms) * millisecond;
        if (release.kind == GW_RELEASE_PONG) {
            if (release.echo && release.echo == client->beat && client->beat_out) {
                client->beat_out = 0;
                learn_clock(client, client->heard, release.clock);
            }
        } else if (release.kind == GW_RELEASE_SITE) {
            client->site_due = 1;
            client->site_coming = release.site;
        } else {
            client->release = release;
            client->has_release = 1;
        }
    }
}

static gw_wire_result send_answer(gw_gate_client *client, gw_answer *answer) {
    answer->processor = gw_processor_ns();
    if (answer->kind != GW_ANSWER_BEAT && client->presented) {
        answer->presented = client->presented;
        answer->presented_at = client->presented_at + client->offset;
        answer->clock_error = client->offset_error;
        answer->rejoin_ms = client->rejoin_ms;
    }
    gw_wire_result result = client->wire->send(client->wire, answer, gw_answer_size(answer));
    if (result == GW_WIRE_DONE && client->bell.socket >= 0)
        gw_bell_ring(&client->bell, 0);
    if (result == GW_WIRE_DONE && answer->kind != GW_ANSWER_BEAT)
        client->presented = client->rejoin_ms = 0;
    return result;
}

void gw_gate_client_pulse(gw_gate_client *client, double silence) {
    gw_error ignored = {0};
    int64_t now = gw_now_ns();
    if (!client->wire || (silence <= 0 && now - client->beat_at < BEAT_MS * millisecond))
        return;
    if (listen(client, &ignored) || (client->beat_out && silence <= 0))
        return;
    static gw_answer beat;
    beat = (gw_answer){.kind = GW_ANSWER_BEAT,
                       .number = client->number,
                       .beat = client->beat + 1,
                       .silence_ms = (uint32_t)(silence * 1000)};
    if (send_answer(client, &beat) != GW_WIRE_DONE)
        return;
    client->beat++;
    client->beat_out = 1;
    client->beat_at = now;
}

/* GW_ENDED_EARLY when rank 0 is lost. */
static gw_code check_root(const gw_gate_client *client, gw_error *error) {
    const char *seen = client->lost ? client->lost(client->lost_context) : NULL;
    const int64_t silent = gw_now_ns() - client->heard;
    if (seen)
        return gw_fail(error, GW_ENDED_EARLY, "rank 0 was lost: %s", seen);
    return silent > client->allowed
               ? gw_fail(error, GW_ENDED_EARLY, "rank 0 was lost: nothing came from it for %.1f s",
                         (double)silent * 1e-9)
               : GW_OK;
}

gw_code gw_gate_client_wait(gw_gate_client *client, gw_release *out, gw_error *error) {
    client->nap = 0;
    for (;;) {
        gw_code code = listen(client, error);
        if (code)
            return code;
        if (client->has_release) {
            *out = client->release;
            client->has_release = 0;
            client->number = out->number;
            return GW_OK;
        }
        code = check_root(client, error);
        if (code)
            return code;
        gw_gate_client_pulse(client, 0);
        if (client->idle)
            client->idle(client->idle_context);
        rest(client, 0);
    }
}

void gw_gate_client_presented(gw_gate_client *client, uint32_t number, int64_t when) {
    client->presented = number + 1;
    client->presented_at = when;
}

/* Until rank 0 has taken it: a message, or a block when `message` is NULL. */
static gw_code send_patiently(gw_gate_client *client, gw_answer *message, const uint8_t *block, size_t size,
                              gw_error *error) {
    client->nap = 0;
    for (;;) {
        gw_wire_result result =
            message ? send_answer(client, message) : client->wire->send_block(client->wire, block, size);
        if (result == GW_WIRE_DONE)
            return GW_OK;
        if (result == GW_WIRE_BROKEN)
            return gw_fail(error, GW_ENDED_EARLY, "rank 0 was lost: the line to it broke");
        if (listen(client, error) || check_root(client, error))
            return error->code;
        rest(client, 1);
    }
}

gw_code gw_gate_client_answer(gw_gate_client *client, const gw_done *done, const uint8_t *pixels, size_t size,
                              gw_error *error) {
    static gw_answer answer;
    answer = (gw_answer){
        .kind = GW_ANSWER_DONE, .number = client->number, .pixels = pixels != NULL, .done = *done};
    gw_code code = send_patiently(client, &answer, NULL, 0, error);
    return code || !pixels ? code : send_patiently(client, NULL, pixels, size, error);
}

void gw_gate_client_leave(gw_gate_client *client) {
    static gw_answer left = {.kind = GW_ANSWER_LEFT};
    gw_error ignored = {0};
    client->heard = gw_now_ns();
    client->allowed = LEAVE_MS * millisecond;
    left.number = client->number;
    if (send_patiently(client, &left, NULL, 0, &ignored))
        return;
    while (!client->wire->is_sent(client->wire) && gw_now_ns() - client->heard < client->allowed)
        rest(client, 1);
}
