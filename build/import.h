/* Files to checked scenes.
 *
 * Model files (glTF 2.0, OBJ+MTL, PLY, PLY.gz, STL, OFF) are read by assimp in a child process - a hidden
 * verb of this program, started with posix_spawn under time and memory limits - because assimp hangs or
 * aborts on some broken files. The parent trusts nothing that comes back. YAML scenes (*.yaml, *.yml) name
 * models, placement, lights and viewpoints: docs/scenes.md. "demo" (or NULL) is the embedded demo scene. Call
 * from one thread of one rank; no MPI here. */
#ifndef GW_BUILD_IMPORT_H
#define GW_BUILD_IMPORT_H

#include "base/log.h"
#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

typedef struct gw_import_options {
    const char *program;    /* path of this executable, for the child ("/proc/self/exe" when NULL) */
    double time_limit;      /* s of wall clock for the child; 0: 120 */
    uint64_t memory_limit;  /* bytes of address space for the child; 0: 4 GiB */
    double outlier_extents; /* the setting of this name; 0 keeps all triangles, however far away */
    const char *animation;  /* which one plays: a name, a number from 0, "all" or "none"; NULL: the first */
    const gw_log *log;
} gw_import_options;

/* Loads path, or the demo scene for NULL and "demo". Every failure is one clear GW_BAD_INPUT (or GW_MACHINE)
 * and leaves nothing behind. */
gw_code gw_import(const char *path, const gw_import_options *options, gw_scene **out, gw_error *error);

/* The child's main(), `gazewall import-child FILE SECONDS BYTES`: argv[0] is the verb. Puts itself under
 * limits of processor time and address space, reads the model and writes it to standard output. Returns the
 * exit code. */
int gw_import_child(int argc, char **argv);

#endif
