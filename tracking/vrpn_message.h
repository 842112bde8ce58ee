/* VRPN's messages byte by byte, as they travel (reference implementation 07.38): the greeting, messages of a
 * stream or a datagram, and the payloads that trackers use. Reading is hostile-safe: every length is bounded,
 * nothing is read beyond what was given. Pure functions; any thread. Integers are big-endian and signed;
 * doubles are IEEE 754 binary64, big-endian. */
#ifndef GW_TRACKING_VRPN_MESSAGE_H
#define GW_TRACKING_VRPN_MESSAGE_H

#include <stddef.h>
#include <stdint.h>

enum {
    GW_VRPN_PORT = 3883,
    GW_VRPN_COOKIE = 24,     /* bytes of the greeting */
    GW_VRPN_HEADER = 24,     /* bytes before a message's payload */
    GW_VRPN_PAYLOAD = 64000, /* bytes of the longest payload */
    GW_VRPN_DATAGRAM = 1472, /* bytes of the longest datagram */
    GW_VRPN_IDS = 2000,      /* senders of a connection, and types */
    GW_VRPN_NAME = 96,       /* bytes of the longest name with its zero */
    GW_VRPN_POSE = 64,       /* payloads of fixed size */
    GW_VRPN_BUTTON = 8,
    GW_VRPN_TEXT = 1032,
    GW_VRPN_CHANNELS = 128 /* axes of one report */
};

/* Messages of the connection itself. */
enum {
    GW_VRPN_SENDER_DESCRIPTION = -1, /* the field `sender` is the id that is described */
    GW_VRPN_TYPE_DESCRIPTION = -2,
    GW_VRPN_UDP_DESCRIPTION = -3, /* `sender` is a port: low-latency messages may go there by datagram */
    GW_VRPN_LOG_DESCRIPTION = -4,
    GW_VRPN_DISCONNECT = -5 /* only in files */
};

#define GW_VRPN_TYPE_POSE "vrpn_Tracker Pos_Quat"
#define GW_VRPN_TYPE_BUTTON "vrpn_Button Change"
#define GW_VRPN_TYPE_BUTTONS "vrpn_Button States"
#define GW_VRPN_TYPE_ANALOG "vrpn_Analog Channel"
#define GW_VRPN_TYPE_TEXT "vrpn_Base text_message"
#define GW_VRPN_TYPE_PING "vrpn_Base ping_message"
#define GW_VRPN_TYPE_PONG "vrpn_Base pong_message"

/* --- the greeting */

typedef enum gw_vrpn_greeting {
    GW_VRPN_SPEAKS,
    GW_VRPN_OTHER_VERSION, /* VRPN, but of another major version */
    GW_VRPN_OTHER_PROTOCOL
} gw_vrpn_greeting;

void gw_vrpn_cookie_write(uint8_t cookie[GW_VRPN_COOKIE]);
/* All up to the last dot must match: the major version. */
gw_vrpn_greeting gw_vrpn_cookie_read(const uint8_t cookie[GW_VRPN_COOKIE]);

/* --- messages */

typedef struct gw_vrpn_message {
    int32_t type, sender, sequence;
    int64_t time; /* ns since 1970 by the sender's clock, whole microseconds */
    const uint8_t *payload;
    size_t payload_size;
} gw_vrpn_message;

/* The message at *offset, and *offset moved behind its padding: 1; 0: not all of it is there yet; -1: its
 * length is impossible, so nothing after it can be read either. */
int gw_vrpn_message_read(const uint8_t *data, size_t size, size_t *offset, gw_vrpn_message *out);
/* Writes it with its padding; returns its bytes, 0 when it is longer than `room` or than VRPN allows. */
size_t gw_vrpn_message_write(const gw_vrpn_message *message, uint8_t *bytes, size_t room);
/* A description of a sender or a type, kind -1 or -2; 0 as above, or when the name is too long or empty. */
size_t gw_vrpn_description_write(int32_t kind, int32_t id, int64_t time, const char *name, uint8_t *bytes,
                                 size_t room);

/* --- payloads; the readers return 0 when it is not one */

/* The name in a description, ended by its zero: it points into the payload. */
const char *gw_vrpn_name_read(const uint8_t *payload, size_t size);

typedef struct gw_vrpn_pose {
    int32_t sensor;
    double position[3];    /* metres by convention */
    double orientation[4]; /* x, y, z, w, as sent: neither finite nor of length 1 for sure */
} gw_vrpn_pose;
int gw_vrpn_pose_read(const uint8_t *payload, size_t size, gw_vrpn_pose *out);
void gw_vrpn_pose_write(const gw_vrpn_pose *pose, uint8_t payload[GW_VRPN_POSE]);

int gw_vrpn_button_read(const uint8_t *payload, size_t size, int32_t *button, int32_t *state);
void gw_vrpn_button_write(int32_t button, int32_t state, uint8_t payload[GW_VRPN_BUTTON]);

/* The states of all buttons: how many, at most GW_VRPN_CHANNELS; -1: it is none. */
int gw_vrpn_buttons_read(const uint8_t *payload, size_t size, int32_t states[GW_VRPN_CHANNELS]);
size_t gw_vrpn_buttons_write(const int32_t *states, int count, uint8_t payload[4 + 4 * GW_VRPN_CHANNELS]);

/* The values of all axes, as above. */
int gw_vrpn_analog_read(const uint8_t *payload, size_t size, double values[GW_VRPN_CHANNELS]);
size_t gw_vrpn_analog_write(const double *values, int count, uint8_t payload[8 + 8 * GW_VRPN_CHANNELS]);

/* Severity 0 normal, 1 warning, 2 error; text is cut and cleaned of what is not printable. */
int gw_vrpn_text_read(const uint8_t *payload, size_t size, uint32_t *severity, char text[256]);

/* --- addresses: dotted IPv4 */

/* Of a UDP description's payload. */
int gw_vrpn_address_read(const uint8_t *payload, size_t size, char address[16]);
size_t gw_vrpn_address_write(const char *address, uint8_t payload[16]);
/* The datagram that asks a server to connect to `address` and `port` (at least 1024) by TCP. */
int gw_vrpn_callback_read(const uint8_t *data, size_t size, char address[16], uint16_t *port);
size_t gw_vrpn_callback_write(const char *address, uint16_t port, uint8_t data[32]);

#endif
