/* One octree in several forms of nodes, fetches, stacks and traversals, each traced by its own kernel: what
 * `gazewall bench layouts` measures and a test compares. Belongs to the thread of its GL device; scene and
 * octree are borrowed. */
#ifndef GW_WALL_NODE_STUDY_H
#define GW_WALL_NODE_STUDY_H

#include "base/gl.h"
#include "base/status.h"
#include "render/renderer.h"
#include "wall/node_forms.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_STUDY_ENTRIES = 16, GW_STUDY_PARTS = 3 };

typedef struct gw_study_entry {
    const char *name; /* one word, a key in files */
    const char *what;
    int loses;        /* 1: by its own rule it may lose hits, which are counted */
    gw_error skipped; /* why it cannot be traced with this octree or device; no text: it can */
    char defines[128];
    gw_trace_variant variant; /* points into this structure */
    gw_gl_buffer buffers[GW_FORM_ARRAYS];
    uint64_t bytes[GW_STUDY_PARTS]; /* by gw_form_part */
    uint64_t voxels;                /* nodes of the octree whose voxel it can address */
} gw_study_entry;

/* Entry 0 is what ships. Must not be moved once open. */
typedef struct gw_node_study {
    gw_renderer *renderer;
    gw_study_entry entries[GW_STUDY_ENTRIES];
} gw_node_study;

gw_code gw_node_study_open(gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                           const gw_renderer_options *options, gw_node_study *out, gw_error *error);
void gw_node_study_close(gw_node_study *study);

/* count 0: the kernel that does not count work, for times; counters, which may be NULL, then get the rest. */
gw_code gw_node_study_trace(gw_node_study *study, uint32_t entry, const gw_ray *rays, size_t ray_count,
                            gw_hit *hits, int count, gw_counters *counters, gw_trace_time *time,
                            gw_error *error);

/* Counts hits that are not the same bits, triangle and t. GW_MACHINE names the first one of an entry that
 * must not differ. */
gw_code gw_study_compare(const gw_study_entry *entry, const gw_hit *shipped, const gw_hit *hits, size_t count,
                         uint64_t *different, gw_error *error);

#endif
