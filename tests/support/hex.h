/* Bytes written as hexadecimal digits with blanks between them, for golden vectors. Header only. */
#ifndef GW_TESTS_SUPPORT_HEX_H
#define GW_TESTS_SUPPORT_HEX_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Returns how many bytes; what is no hexadecimal digit ends it. */
static inline size_t hex_bytes(const char *hex, uint8_t *out, size_t room) {
    size_t size = 0;
    while (*hex != '\0' && size < room) {
        unsigned value;
        if (*hex == ' ' || *hex == '\n') {
            hex++;
            continue;
        }
        if (sscanf(hex, "%2x", &value) != 1)
            break;
        out[size++] = (uint8_t)value;
        hex += 2;
    }
    return size;
}

#endif
