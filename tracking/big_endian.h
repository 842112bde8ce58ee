/* Numbers as VRPN sends them: big-endian, two's complement and IEEE 754. Any thread. */
#ifndef GW_TRACKING_BIG_ENDIAN_H
#define GW_TRACKING_BIG_ENDIAN_H

#include <stdint.h>
#include <string.h>

static inline int32_t gw_get_int32(const uint8_t *bytes) {
    uint32_t value = (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
    int32_t out;
    memcpy(&out, &value, sizeof out);
    return out;
}

static inline double gw_get_double(const uint8_t *bytes) {
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++)
        bits = bits << 8 | bytes[i];
    double out;
    memcpy(&out, &bits, sizeof out);
    return out;
}

/* Both return the place after what they wrote. */
static inline uint8_t *gw_put_int32(uint8_t *bytes, int32_t value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(bits >> (24 - 8 * i));
    return bytes + 4;
}

static inline uint8_t *gw_put_double(uint8_t *bytes, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 8; i++)
        bytes[i] = (uint8_t)(bits >> (56 - 8 * i));
    return bytes + 8;
}

#endif
