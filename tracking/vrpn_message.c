#include "tracking/vrpn_message.h"

#include "tracking/big_endian.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>

/* --- the greeting */

static const char greeting[] = "vrpn: ver. 07.38  0"; /* what follows, up to 24 bytes, is zero */
enum { PROTOCOL_PART = 11, MAJOR_PART = 14 };

void gw_vrpn_cookie_write(uint8_t cookie[GW_VRPN_COOKIE]) {
    memset(cookie, 0, GW_VRPN_COOKIE);
    memcpy(cookie, greeting, sizeof greeting - 1);
}

gw_vrpn_greeting gw_vrpn_cookie_read(const uint8_t cookie[GW_VRPN_COOKIE]) {
    if (memcmp(cookie, greeting, PROTOCOL_PART) != 0)
        return GW_VRPN_OTHER_PROTOCOL;
    return memcmp(cookie, greeting, MAJOR_PART) != 0 ? GW_VRPN_OTHER_VERSION : GW_VRPN_SPEAKS;
}

/* --- messages */

static size_t padded(size_t size) {
    return (size + 7) & ~(size_t)7;
}

int gw_vrpn_message_read(const uint8_t *data, size_t size, size_t *offset, gw_vrpn_message *out) {
    const uint8_t *header = data + *offset;
    const size_t left = size - *offset;
    if (left < 4)
        return 0;
    const int32_t length = gw_get_int32(header);
    if (length < GW_VRPN_HEADER || length > GW_VRPN_HEADER + GW_VRPN_PAYLOAD)
        return -1;
    if (left < padded((size_t)length))
        return 0;
    /* Seconds and microseconds are 32 bits each, so the sum cannot overflow, whatever they say. */
    out->time = (int64_t)gw_get_int32(header + 4) * 1000000000 + (int64_t)gw_get_int32(header + 8) * 1000;
    out->sender = gw_get_int32(header + 12);
    out->type = gw_get_int32(header + 16);
    out->sequence = gw_get_int32(header + 20);
    out->payload = header + GW_VRPN_HEADER;
    out->payload_size = (size_t)length - GW_VRPN_HEADER;
    *offset += padded((size_t)length);
    return 1;
}

size_t gw_vrpn_message_write(const gw_vrpn_message *message, uint8_t *bytes, size_t room) {
    if (message->payload_size > GW_VRPN_PAYLOAD)
        return 0;
    const size_t length = GW_VRPN_HEADER + message->payload_size, whole = padded(length);
    if (whole > room)
        return 0;
    int64_t seconds = message->time / 1000000000, rest = message->time % 1000000000;
    if (rest < 0) {
        rest += 1000000000;
        seconds--;
    }
    const int32_t fields[] = {(int32_t)length, (int32_t)seconds, (int32_t)(rest / 1000),
                              message->sender, message->type,    message->sequence};
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
        bytes = gw_put_int32(bytes, fields[i]);
    if (message->payload_size > 0)
        memcpy(bytes, message->payload, message->payload_size);
    memset(bytes + message->payload_size, 0, whole - length);
    return whole;
}

size_t gw_vrpn_description_write(int32_t kind, int32_t id, int64_t time, const char *name, uint8_t *bytes,
                                 size_t room) {
    uint8_t payload[4 + GW_VRPN_NAME];
    const size_t length = strlen(name) + 1;
    if (length < 2 || length > GW_VRPN_NAME)
        return 0;
    memcpy(gw_put_int32(payload, (int32_t)length), name, length);
    const gw_vrpn_message message = {
        .type = kind, .sender = id, .time = time, .payload = payload, .payload_size = 4 + length};
    return gw_vrpn_message_write(&message, bytes, room);
}

/* --- payloads */

const char *gw_vrpn_name_read(const uint8_t *payload, size_t size) {
    if (size < 6)
        return NULL;
    const int32_t length = gw_get_int32(payload);
    if (length < 2 || length > GW_VRPN_NAME || (size_t)length > size - 4)
        return NULL;
    const char *name = (const char *)payload + 4;
    return strnlen(name, (size_t)length) == (size_t)length - 1 ? name : NULL;
}

int gw_vrpn_pose_read(const uint8_t *payload, size_t size, gw_vrpn_pose *out) {
    if (size != GW_VRPN_POSE)
        return 0;
    out->sensor = gw_get_int32(payload); /* the four bytes after it mean nothing */
    for (int i = 0; i < 3; i++)
        out->position[i] = gw_get_double(payload + 8 + 8 * i);
    for (int i = 0; i < 4; i++)
        out->orientation[i] = gw_get_double(payload + 32 + 8 * i);
    return 1;
}

void gw_vrpn_pose_write(const gw_vrpn_pose *pose, uint8_t payload[GW_VRPN_POSE]) {
    payload = gw_put_int32(gw_put_int32(payload, pose->sensor), 0);
    for (int i = 0; i < 3; i++)
        payload = gw_put_double(payload, pose->position[i]);
    for (int i = 0; i < 4; i++)
        payload = gw_put_double(payload, pose->orientation[i]);
}

int gw_vrpn_button_read(const uint8_t *payload, size_t size, int32_t *button, int32_t *state) {
    if (size != GW_VRPN_BUTTON)
        return 0;
    *button = gw_get_int32(payload);
    *state = gw_get_int32(payload + 4);
    return 1;
}

void gw_vrpn_button_write(int32_t button, int32_t state, uint8_t payload[GW_VRPN_BUTTON]) {
    gw_put_int32(gw_put_int32(payload, button), state);
}

int gw_vrpn_buttons_read(const uint8_t *payload, size_t size, int32_t states[GW_VRPN_CHANNELS]) {
    const int32_t count = size >= 4 ? gw_get_int32(payload) : -1;
    if (count < 0 || count > GW_VRPN_CHANNELS || size < 4 + 4 * (size_t)count)
        return -1;
    for (int32_t i = 0; i < count; i++)
        states[i] = gw_get_int32(payload + 4 + 4 * i);
    return count;
}

size_t gw_vrpn_buttons_write(const int32_t *states, int count, uint8_t payload[4 + 4 * GW_VRPN_CHANNELS]) {
    payload = gw_put_int32(payload, count);
    for (int i = 0; i < count; i++)
        payload = gw_put_int32(payload, states[i]);
    return 4 + 4 * (size_t)count;
}

int gw_vrpn_analog_read(const uint8_t *payload, size_t size, double values[GW_VRPN_CHANNELS]) {
    const double told = size >= 8 ? gw_get_double(payload) : -1;
    if (!(told >= 0 && told <= GW_VRPN_CHANNELS))
        return -1;
    const int count = (int)told;
    if (count != told || size < 8 + 8 * (size_t)count)
        return -1;
    for (int i = 0; i < count; i++)
        values[i] = gw_get_double(payload + 8 + 8 * i);
    return count;
}

size_t gw_vrpn_analog_write(const double *values, int count, uint8_t payload[8 + 8 * GW_VRPN_CHANNELS]) {
    payload = gw_put_double(payload, count);
    for (int i = 0; i < count; i++)
        payload = gw_put_double(payload, values[i]);
    return 8 + 8 * (size_t)count;
}

int gw_vrpn_text_read(const uint8_t *payload, size_t size, uint32_t *severity, char text[256]) {
    if (size != GW_VRPN_TEXT)
        return 0;
    *severity = (uint32_t)gw_get_int32(payload);
    size_t used = 0;
    for (const uint8_t *from = payload + 8; used < 255 && *from != '\0'; from++)
        text[used++] = *from >= ' ' && *from < 127 ? (char)*from : '?';
    text[used] = '\0';
    return 1;
}

/* --- addresses */

/* 1 when the text, which ends by a zero or with its bytes, is a dotted IPv4 address. */
static int take_address(const uint8_t *text, size_t size, char address[16]) {
    const size_t length = strnlen((const char *)text, size);
    struct in_addr unused;
    if (length == 0 || length > 15)
        return 0;
    memcpy(address, text, length);
    address[length] = '\0';
    return inet_pton(AF_INET, address, &unused) == 1;
}

int gw_vrpn_address_read(const uint8_t *payload, size_t size, char address[16]) {
    return size > 0 && take_address(payload, size, address);
}

size_t gw_vrpn_address_write(const char *address, uint8_t payload[16]) {
    const size_t length = strnlen(address, 15);
    memcpy(payload, address, length);
    payload[length] = '\0';
    return length + 1;
}

int gw_vrpn_callback_read(const uint8_t *data, size_t size, char address[16], uint16_t *port) {
    const uint8_t *blank = size > 0 ? memchr(data, ' ', size < 16 ? size : 16) : NULL;
    if (!blank || !take_address(data, (size_t)(blank - data), address))
        return 0;
    uint32_t number = 0;
    const uint8_t *end = data + size, *digit = blank + 1;
    for (; digit < end && *digit >= '0' && *digit <= '9' && number <= UINT16_MAX; digit++)
        number = 10 * number + (uint32_t)(*digit - '0');
    if (number < 1024 || number > UINT16_MAX || (digit < end && *digit != '\0'))
        return 0;
    *port = (uint16_t)number;
    return 1;
}

size_t gw_vrpn_callback_write(const char *address, uint16_t port, uint8_t data[32]) {
    return (size_t)snprintf((char *)data, 32, "%.15s %u", address, (unsigned)port) + 1;
}
