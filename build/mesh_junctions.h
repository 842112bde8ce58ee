/* T-junctions: where a vertex of one triangle lies on the side of another that does not have it, rounding
 * leaves a crack that rays may pass. Any thread. */
#ifndef GW_BUILD_MESH_JUNCTIONS_H
#define GW_BUILD_MESH_JUNCTIONS_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* Of `edges` (two vertices each, the lesser in the high half) counts those that have a vertex of another of
 * them strictly between their ends and within 2^-21, some steps of float, of their line. positions:
 * [vertex][3], rebased. */
gw_code gw_mesh_junctions(const float (*positions)[3], const uint64_t *edges, size_t edge_count,
                          uint64_t *out, gw_error *error);

#endif
