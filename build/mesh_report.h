/* What kind of mesh a finished scene is: its edges, components, coincident triangles and slivers. Vertices
 * are the welded positions, whatever their normals and texture coordinates. Any thread. */
#ifndef GW_BUILD_MESH_REPORT_H
#define GW_BUILD_MESH_REPORT_H

#include "base/status.h"
#include "build/scene.h"

#include <stdint.h>

/* A sliver is a triangle whose longest edge is this many times its height above that edge, or more. */
enum { GW_SLIVER_ASPECT = 1000 };

typedef struct gw_mesh_report {
    uint64_t edges;              /* pairs of vertices that some triangle joins */
    uint64_t boundary_edges;     /* of one triangle */
    uint64_t inconsistent_edges; /* of two triangles that run the same way along them: one is turned over */
    uint64_t non_manifold_edges; /* of more than two triangles */
    uint64_t t_junctions;        /* boundary edges with another boundary vertex on them: cracks */

    uint64_t coincident;           /* triangles in the same place as an earlier one */
    uint64_t coincident_turned;    /* of these: turned over against it */
    uint64_t coincident_materials; /* of these: of another material */
    uint64_t slivers;

    /* Connected by shared vertices. Closed: along every edge as many triangles run one way as the other, so
     * the number of times that the surface winds round a point is well defined, and a ray that comes from far
     * away meets front faces and back faces in turn as often. */
    uint64_t components, closed_components, largest_component; /* the last in triangles */
    uint64_t closed_triangles;                                 /* in closed components */
    uint64_t inside_out; /* closed components whose volume is negative */
} gw_mesh_report;

gw_code gw_mesh_report_make(const gw_scene *scene, gw_mesh_report *out, gw_error *error);

#endif
