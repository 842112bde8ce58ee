/* What a fuzzer and the unit test do with bytes that come to rank 0's door: read them as a hello and as the
 * place of a tile, and pass them through a wire as whoever connects may send them. Aborts when an invariant
 * does not hold. */
#ifndef GW_TESTS_FUZZ_REJOIN_ENTRY_H
#define GW_TESTS_FUZZ_REJOIN_ENTRY_H

#include "wall/gate_message.h"
#include "wall/layout.h"
#include "wall/rejoin_message.h"
#include "wall/wire_tcp.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static inline void fuzz_rejoin_require(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_rejoin_message(const uint8_t *bytes, size_t size) {
    static gw_answer answer;
    static gw_release release;
    gw_rejoin_welcome welcome;
    gw_rejoin_hello hello;
    if (!gw_rejoin_hello_read(bytes, size, &hello)) {
        uint8_t again[GW_REJOIN_HELLO];
        fuzz_rejoin_require(hello.tile > 0 && hello.tile < GW_MAXIMUM_TILES && hello.start > 0);
        fuzz_rejoin_require(strlen(hello.secret) <= GW_SECRET_DIGITS && strlen(hello.program) <= 32);
        /* What stands behind a zero byte of the digits is not kept; all else is. */
        if (strlen(hello.secret) == GW_SECRET_DIGITS && strlen(hello.program) == 32) {
            gw_rejoin_hello_write(&hello, again);
            fuzz_rejoin_require(size == sizeof again && !memcmp(again, bytes, size));
        }
    }
    memcpy(&welcome, bytes, size < sizeof welcome ? size : sizeof welcome);
    if (gw_rejoin_welcome_check(&welcome, size))
        fuzz_rejoin_require(strlen(welcome.text) < sizeof welcome.text);
    memcpy(&answer, bytes, size < sizeof answer ? size : sizeof answer);
    if (gw_answer_check(&answer, size) && answer.kind == GW_ANSWER_DONE)
        fuzz_rejoin_require(strlen(answer.done.text) < sizeof answer.done.text);
    memcpy(&release, bytes, size < sizeof release ? size : sizeof release);
    fuzz_rejoin_require(!gw_release_check(&release, size) || size == sizeof release);
}

static inline void fuzz_rejoin(const uint8_t *data, size_t size) {
    int ends[2];
    gw_error error = {0};
    gw_wire *wire = NULL;
    gw_rejoin_place place;
    char text[128];
    const size_t length = size < sizeof text - 1 ? size : sizeof text - 1;
    memcpy(text, data, length);
    text[length] = '\0';
    if (gw_rejoin_place_read(text, &place))
        fuzz_rejoin_require(place.tile > 0 && place.tile < GW_MAXIMUM_TILES && place.start > 0 &&
                            place.port > 0 && place.address[0] &&
                            strlen(place.address) < sizeof place.address);
    fuzz_rejoin_message(data, size);
    fuzz_rejoin_require(!socketpair(AF_UNIX, SOCK_STREAM, 0, ends));
    fuzz_rejoin_require(gw_wire_tcp(ends[0], &wire, &error) == GW_OK);
    /* In two pieces; the first byte of the input says where it is cut. */
    const size_t cut = size ? data[0] % size : 0;
    for (int piece = 0; piece < 3; piece++) {
        const uint8_t *from = piece ? data + cut : data;
        const size_t bytes = piece ? size - cut : cut;
        if (piece < 2 && bytes)
            fuzz_rejoin_require(send(ends[1], from, bytes, MSG_NOSIGNAL | MSG_DONTWAIT) >= 0);
        if (piece == 2)
            close(ends[1]);
        for (;;) {
            uint8_t message[GW_WIRE_MESSAGE];
            size_t got = 0;
            const gw_wire_result result = wire->receive(wire, message, &got);
            if (result != GW_WIRE_DONE) {
                fuzz_rejoin_require(piece < 2 || result == GW_WIRE_BROKEN);
                break;
            }
            fuzz_rejoin_require(got <= GW_WIRE_MESSAGE);
            fuzz_rejoin_message(message, got);
        }
    }
    wire->close(wire);
}

#endif
