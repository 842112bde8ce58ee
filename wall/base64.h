/* Bytes as text for data: addresses (RFC 4648, section 4). Any thread. */
#ifndef GW_WALL_BASE64_H
#define GW_WALL_BASE64_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

void gw_base64_write(FILE *file, const uint8_t *data, size_t size);

#endif
