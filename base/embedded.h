/* Files that travel inside the program: the shader library and the parts of configs/ that the demo needs. The
 * table is made at build time by shaders/embed_files.c. Read-only; any thread. */
#ifndef GW_BASE_EMBEDDED_H
#define GW_BASE_EMBEDDED_H

#include <stddef.h>

typedef struct gw_embedded_file {
    const char *name;          /* path from the repository root: "shaders/common/shared.h" */
    const unsigned char *data; /* followed by one zero byte that size does not count */
    size_t size;               /* bytes */
} gw_embedded_file;

extern const gw_embedded_file gw_embedded_files[]; /* sorted by name */
extern const size_t gw_embedded_count;

/* NULL when there is no such file. */
const gw_embedded_file *gw_embedded_find(const char *name);

#endif
