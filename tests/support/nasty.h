/* Random scenes biased to nastiness: corners on a lattice of cells, rectangles in cell planes, needles, sizes
 * from a millionth of the scene to all of it, fans, specks, copies. The same for the same seed everywhere. */
#ifndef GW_TESTS_SUPPORT_NASTY_H
#define GW_TESTS_SUPPORT_NASTY_H

#include "tests/support/meshes.h"

#include <stdint.h>

/* Adds some of these, within [-1,1]^3, which they span. */
void gw_mesh_add_nasty(gw_mesh *mesh, uint64_t *random);

#endif
