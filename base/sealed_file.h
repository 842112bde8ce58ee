/* Sealed files: a block of bytes on disk, compressed, under a key, with a checksum. What is cut, altered, of
 * another kind, version or codec, or under another key is refused with a reason. Files are written under a
 * temporary name and renamed, so two programs that write the same file at once do no harm. One thread per
 * call. */
/* clang-format off */
/* The file, all numbers little-endian; columns are offset, bytes, contents:
 *   0    8    "GWSEALED"
 *   8    4    format version, 1
 *   12   4    codec: 1 is zlib's deflate (RFC 1950); others are refused
 *   16   16   key, high and low half
 *   32   8    size of the contents in bytes
 *   40   8    size of the compressed stream in bytes
 *   48        the stream
 *   end  16   XXH3-128 of everything before, high and low half
 */
/* clang-format on */
#ifndef GW_BASE_SEALED_FILE_H
#define GW_BASE_SEALED_FILE_H

#include "base/hash.h"
#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* Contents of a file; data is aligned to 64 and released with free(). */
typedef struct gw_sealed {
    void *data;
    size_t size;
} gw_sealed;

/* GW_BAD_INPUT names the file and tells why it was refused; out is then empty. Marks the file as used now. */
gw_code gw_sealed_read(const char *path, gw_hash key, gw_sealed *out, gw_error *error);

/* Writes the file, making its folder. GW_NO_OUTPUT when it cannot be written. */
gw_code gw_sealed_write(const char *path, gw_hash key, const void *data, size_t size, gw_error *error);

/* Removes the least recently used files of the folder whose names end in one of the suffixes (NULL ends the
 * list) until they are within limit bytes; `kept` (a path in the folder) is never removed. Best effort: what
 * cannot be removed stays, another program may be removing the same files. */
void gw_sealed_trim(const char *kept, const char *const *suffixes, uint64_t limit);

#endif
