/* What `inspect` tells beyond the common report: the mesh, the octree level by level, memory. Each part is
 * computed once and then printed or put into the JSON report. One thread. */
#ifndef GW_WALL_INSPECT_REPORT_H
#define GW_WALL_INSPECT_REPORT_H

#include "base/status.h"
#include "build/mesh_report.h"
#include "build/octree_report.h"
#include "render/renderer.h"
#include "wall/model.h"

#include <jansson.h>
#include <stdint.h>

/* Bytes by use. Known after the import: triangles, host_scene; after the build: the rest. */
typedef struct gw_memory_report {
    uint64_t nodes, references, boxes, payload; /* on the GPU, per tile */
    uint64_t triangles;                         /* with faces and vertices */
    uint64_t others;                            /* textures, materials, lights */
    uint64_t ray;                               /* one ray while it is traced */
    uint64_t rays_at_once;                      /* at most; larger tiles are drawn in chunks */
    uint64_t sample_lists;                      /* of a frame with a gaze, at most */
    uint64_t build_peak; /* most at once while the octree was built; 0: it was not built */
    uint64_t host_scene, host_textures, host_octree;
} gw_memory_report;

typedef struct gw_inspect_report {
    gw_mesh_report mesh;
    gw_octree_report octree;
    gw_memory_report memory;
} gw_inspect_report;

/* After the import: mesh. */
gw_code gw_inspect_mesh(const gw_model *model, gw_inspect_report *out, gw_error *error);
/* After the build: octree and memory, of frames with these settings. */
void gw_inspect_octree(const gw_model *model, const gw_renderer *renderer, const gw_settings *settings,
                       gw_inspect_report *out);

/* "scene.mesh", "octree.levels", "octree.lists", "octree.bytes_per_triangle" and "memory". The report has
 * "scene" and "octree" already. */
void gw_inspect_report_json(const gw_inspect_report *inspected, const gw_model *model, json_t *report);

void gw_inspect_print_mesh(const gw_inspect_report *inspected, const gw_scene *scene);
void gw_inspect_print_levels(const gw_inspect_report *inspected);
void gw_inspect_print_memory(const gw_inspect_report *inspected, const gw_scene *scene);

#endif
