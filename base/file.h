/* Files: bounded reading, atomic writing, paths, gunzip with a cap. Any thread may call these. */
#ifndef GW_BASE_FILE_H
#define GW_BASE_FILE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* Owned bytes; data is followed by one zero byte that size does not count, so text can be parsed in place. */
typedef struct gw_bytes {
    uint8_t *data;
    size_t size;
} gw_bytes;

void gw_bytes_finish(gw_bytes *bytes);

/* Reads a whole regular file. Fails with GW_BAD_INPUT and names the path when it is missing, a directory, not
 * readable or larger than limit bytes. */
gw_code gw_file_read(const char *path, size_t limit, gw_bytes *out, gw_error *error);

/* Writes path by way of a temporary name in the same folder and rename; GW_NO_OUTPUT on failure, and the
 * temporary file is removed. Links are followed; devices and FIFOs are written to and stay what they are. */
gw_code gw_file_write(const char *path, const void *data, size_t size, gw_error *error);

/* GW_NO_OUTPUT where gw_file_write could not write, as far as can be told: a user hears that before long work
 * and not after it. A NULL path is fine. */
gw_code gw_file_writable(const char *path, gw_error *error);

/* mkdir -p; GW_NO_OUTPUT on failure. */
gw_code gw_make_directories(const char *path, gw_error *error);

/* 1 when a regular file (or a link to one) can be read there. */
int gw_file_exists(const char *path);

/* "folder/name", or a copy of name when it is absolute or folder is empty. Free the result. */
char *gw_path_join(const char *folder, const char *name);
/* Everything before the last '/', "." when there is none. Free the result. */
char *gw_path_folder(const char *path);
/* Points at the part after the last '/'. */
const char *gw_path_name(const char *path);
/* 1 when the name ends in the extension, without regard to case: gw_path_has_extension("a.PLY.gz",
 * ".ply.gz"). */
int gw_path_has_extension(const char *path, const char *extension);

/* Expands a gzip stream, at most limit bytes (a bomb is GW_BAD_INPUT, named by `name`). */
gw_code gw_gunzip(const void *data, size_t size, size_t limit, const char *name, gw_bytes *out,
                  gw_error *error);

#endif
