#include "wall/rejoin_message.h"

#include "wall/layout.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { AT_VERSION = 8, AT_TILE = 12, AT_START = 16, AT_SITE = 20, AT_PROCESS = 24, AT_SECRET = 32 };
enum { AT_PROGRAM = 64, AT_CHECKSUM = 96, DIGITS = 32 };
static const char mark[] = "GWREJOIN";

static void put(uint8_t *at, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

static uint64_t get(const uint8_t *at, int bytes) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint64_t)at[i] << (8 * i);
    return value;
}

static uint64_t checksum_of(const uint8_t *bytes) {
    return gw_hash_bytes((gw_hash){0, 0}, bytes, AT_CHECKSUM).low;
}

void gw_rejoin_hello_write(const gw_rejoin_hello *hello, uint8_t out[GW_REJOIN_HELLO]) {
    memset(out, 0, GW_REJOIN_HELLO);
    memcpy(out, mark, sizeof mark - 1);
    put(out + AT_VERSION, GW_REJOIN_VERSION, 4);
    put(out + AT_TILE, hello->tile, 4);
    put(out + AT_START, hello->start, 4);
    put(out + AT_SITE, hello->site, 4);
    put(out + AT_PROCESS, (uint64_t)hello->process, 8);
    memcpy(out + AT_SECRET, hello->secret, strnlen(hello->secret, DIGITS));
    memcpy(out + AT_PROGRAM, hello->program, strnlen(hello->program, DIGITS));
    put(out + AT_CHECKSUM, checksum_of(out), 8);
}

const char *gw_rejoin_hello_read(const uint8_t *bytes, size_t size, gw_rejoin_hello *out) {
    memset(out, 0, sizeof *out);
    if (size < AT_TILE || memcmp(bytes, mark, sizeof mark - 1) != 0)
        return "what it sent is no hello of a tile";
    if (get(bytes + AT_VERSION, 4) != GW_REJOIN_VERSION)
        return "it speaks another version of the gate's language";
    if (size != GW_REJOIN_HELLO || get(bytes + AT_CHECKSUM, 8) != checksum_of(bytes))
        return "its hello was cut or altered";
    out->tile = (uint32_t)get(bytes + AT_TILE, 4);
    out->start = (uint32_t)get(bytes + AT_START, 4);
    out->site = (uint32_t)get(bytes + AT_SITE, 4);
    out->process = (int64_t)get(bytes + AT_PROCESS, 8);
    memcpy(out->secret, bytes + AT_SECRET, DIGITS);
    memcpy(out->program, bytes + AT_PROGRAM, DIGITS);
    if (out->tile == 0 || out->tile >= GW_MAXIMUM_TILES || out->start == 0 || out->site != 0 ||
        out->process <= 0)
        return "its hello names no tile that can come back";
    return NULL;
}

int gw_rejoin_welcome_check(gw_rejoin_welcome *welcome, size_t size) {
    if (size != sizeof *welcome || welcome->taken > 1 || welcome->here > 1)
        return 0;
    welcome->text[sizeof welcome->text - 1] = '\0';
    return 1;
}

/* A number of digits alone, which ends before `end`. */
static int read_number(const char **at, char end, uint32_t most, uint32_t *out) {
    char *stop = NULL;
    if (**at < '0' || **at > '9')
        return 0;
    const unsigned long value = strtoul(*at, &stop, 10);
    if (*stop != end || value > most)
        return 0;
    *at = stop + 1;
    *out = (uint32_t)value;
    return 1;
}

int gw_rejoin_place_read(const char *text, gw_rejoin_place *out) {
    uint32_t port = 0;
    memset(out, 0, sizeof *out);
    if (!read_number(&text, ':', GW_MAXIMUM_TILES - 1, &out->tile) ||
        !read_number(&text, ':', UINT32_MAX, &out->start))
        return 0;
    /* The address may have colons of its own. */
    const char *colon = strrchr(text, ':');
    const size_t length = colon ? (size_t)(colon - text) : 0;
    if (!colon || length == 0 || length >= sizeof out->address)
        return 0;
    memcpy(out->address, text, length);
    colon++;
    if (!read_number(&colon, '\0', UINT16_MAX, &port) || port == 0 || out->tile == 0 || out->start == 0)
        return 0;
    out->port = (uint16_t)port;
    return 1;
}
