/* What a tile that was started again and rank 0 say to each other before the tile is at the gate, each one
 * message of wall/wire.h: the tile's hello, rank 0's welcome with the site as a block behind it, and, when
 * the tile has loaded what it is drawn with, its ready.
 *
 * Of whoever connects nothing is known, so a hello has fixed places, a checksum and the secret of the run;
 * what follows comes from the same program and travels as it stands. */
/* clang-format off */
/* A hello, numbers little-endian; columns are offset, bytes, contents:
 *   0    8    "GWREJOIN"
 *   8    4    GW_REJOIN_VERSION
 *   12   4    number of the tile
 *   16   4    which start of it by the launcher this is, from 1
 *   20   4    number of the site that it has: 0, that of the start
 *   24   8    number of its process, as it sees it
 *   32   32   secret of the run, digits
 *   64   32   hash of its program, digits
 *   96   8    XXH3 (low half of 128 bits) of everything before
 */
/* clang-format on */
#ifndef GW_WALL_REJOIN_MESSAGE_H
#define GW_WALL_REJOIN_MESSAGE_H

#include "base/hash.h"
#include "wall/link.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_REJOIN_VERSION = 1, GW_REJOIN_HELLO = 104 };

typedef struct gw_rejoin_hello {
    uint32_t tile, start, site;
    int64_t process;
    char secret[GW_SECRET_DIGITS + 1], program[33];
} gw_rejoin_hello;

void gw_rejoin_hello_write(const gw_rejoin_hello *hello, uint8_t out[GW_REJOIN_HELLO]);
/* NULL, or in words why the bytes are no hello. */
const char *gw_rejoin_hello_read(const uint8_t *bytes, size_t size, gw_rejoin_hello *out);

/* What a tile is drawn with, by content; all zero where nothing is loaded. */
typedef struct gw_rejoin_keys {
    gw_hash scene_block, octree_block; /* names of the blocks in a machine's cache (wall/share_kept.h) */
    gw_hash scene, octree;             /* hashes of what is in them */
} gw_rejoin_keys;

typedef struct gw_rejoin_welcome {
    uint32_t taken;  /* 0: text says why not, and nothing follows; 1: the site follows as a block */
    uint32_t number; /* of the next frame */
    uint32_t site;   /* number of the site that follows */
    uint32_t here;   /* 1: rank 0's machine, and its clock */
    gw_rejoin_keys keys;
    char text[256];
} gw_rejoin_welcome;

/* 1 when it makes sense; the text is then ended. */
int gw_rejoin_welcome_check(gw_rejoin_welcome *welcome, size_t size);

/* The tile could draw: what it has loaded. */
typedef struct gw_rejoin_ready {
    gw_hash scene, octree;
} gw_rejoin_ready;

/* "TILE:START:ADDRESS:PORT", as the launcher tells a tile that it starts again. */
typedef struct gw_rejoin_place {
    uint32_t tile, start;
    uint16_t port;
    char address[64]; /* numeric */
} gw_rejoin_place;

/* 1 when the text is a place, all of it. */
int gw_rejoin_place_read(const char *text, gw_rejoin_place *out);

#endif
