/* Bytes of a file or of memory from front to back, expanded on the way when they are gzipped: for readers of
 * recordings. Never more than one window in memory, and never more than a limit in all, so a bomb costs
 * nothing. One thread at a time. */
#ifndef GW_TRACKING_BYTE_STREAM_H
#define GW_TRACKING_BYTE_STREAM_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_BYTE_WINDOW = 1 << 17 }; /* the most that can be asked for at a time */

typedef struct gw_byte_stream gw_byte_stream;

/* limit: the most bytes that may come out. GW_BAD_INPUT: there is no such file, or it is a folder. Memory
 * stays the caller's. */
gw_code gw_byte_stream_open(const char *path, uint64_t limit, gw_byte_stream **out, gw_error *error);
gw_code gw_byte_stream_of(const void *data, size_t size, uint64_t limit, gw_byte_stream **out,
                          gw_error *error);
void gw_byte_stream_close(gw_byte_stream **stream);

/* Makes `size` bytes (up to GW_BYTE_WINDOW) available at *bytes, fewer only at the end of what can be read;
 * returns how many there are. They stay until the next call. */
size_t gw_byte_stream_peek(gw_byte_stream *stream, size_t size, const uint8_t **bytes);
/* Goes on behind `size` of the bytes that peek made available. */
void gw_byte_stream_take(gw_byte_stream *stream, size_t size);

uint64_t gw_byte_stream_offset(const gw_byte_stream *stream); /* of what peek shows, after expansion */
int gw_byte_stream_is_gzip(const gw_byte_stream *stream);
/* Why there is no more, when that is not the end of the file: a cut or damaged gzip stream, an unreadable
 * disk, the limit. NULL otherwise. */
const char *gw_byte_stream_problem(const gw_byte_stream *stream);

#endif
