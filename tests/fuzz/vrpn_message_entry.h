/* What a fuzzer and the unit test do with bytes that claim to be VRPN messages: read all of them as every
 * payload there is, and write again what was understood. Aborts when an invariant does not hold. */
#ifndef GW_TESTS_FUZZ_VRPN_MESSAGE_ENTRY_H
#define GW_TESTS_FUZZ_VRPN_MESSAGE_ENTRY_H

#include "tracking/vrpn_message.h"

#include <stdlib.h>
#include <string.h>

static inline void fuzz_must(int holds) {
    if (!holds)
        abort();
}

static inline void fuzz_vrpn_payload(const uint8_t *payload, size_t size) {
    double values[GW_VRPN_CHANNELS];
    int32_t states[GW_VRPN_CHANNELS], button, state;
    char text[256], address[16];
    uint16_t port;
    uint32_t severity;
    gw_vrpn_pose pose;
    const char *name = gw_vrpn_name_read(payload, size);
    fuzz_must(!name || (strlen(name) > 0 && strlen(name) < GW_VRPN_NAME));
    if (gw_vrpn_pose_read(payload, size, &pose)) {
        uint8_t again[GW_VRPN_POSE];
        gw_vrpn_pose_write(&pose, again);
        fuzz_must(memcmp(again, payload, 4) == 0 && memcmp(again + 8, payload + 8, 56) == 0);
    }
    fuzz_must(gw_vrpn_button_read(payload, size, &button, &state) == (size == GW_VRPN_BUTTON));
    fuzz_must(gw_vrpn_buttons_read(payload, size, states) <= GW_VRPN_CHANNELS);
    fuzz_must(gw_vrpn_analog_read(payload, size, values) <= GW_VRPN_CHANNELS);
    if (gw_vrpn_text_read(payload, size, &severity, text))
        fuzz_must(strlen(text) < sizeof text);
    if (gw_vrpn_address_read(payload, size, address))
        fuzz_must(strlen(address) >= 7 && strlen(address) < sizeof address);
    if (gw_vrpn_callback_read(payload, size, address, &port))
        fuzz_must(port >= 1024);
}

static inline void fuzz_vrpn_message(const uint8_t *data, size_t size) {
    gw_vrpn_message m;
    size_t offset = 0, before = 0;
    if (size >= GW_VRPN_COOKIE)
        (void)gw_vrpn_cookie_read(data);
    fuzz_vrpn_payload(data, size);
    int got;
    while ((got = gw_vrpn_message_read(data, size, &offset, &m)) > 0) {
        fuzz_must(offset > before && offset <= size && offset % 8 == before % 8);
        fuzz_must(m.payload_size <= GW_VRPN_PAYLOAD && m.payload + m.payload_size <= data + size);
        fuzz_vrpn_payload(m.payload, m.payload_size);
        uint8_t *again = malloc(offset - before);
        fuzz_must(again != NULL && gw_vrpn_message_write(&m, again, offset - before) == offset - before);
        fuzz_must(memcmp(again, data + before, 4) == 0);
        fuzz_must(memcmp(again + 12, data + before + 12, 12 + m.payload_size) == 0);
        free(again);
        before = offset;
    }
    fuzz_must(offset == before);
}

#endif
