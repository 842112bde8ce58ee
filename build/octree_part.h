/* One octree built by several devices: the cells are divided, each builder makes a part, the parts are
 * joined. The joined bytes are those of gw_octree_build, whatever the number of parts.
 *
 * The cells of one level, the split level, are cut in Morton order into ranges, one a part. A builder refines
 * from the root and follows only cells that hold some of its range, so the work above the split level that
 * several do twice is small. Of the cells above the split level, the part that has a cell's first descendant
 * owns it. Payload sums of the cells at the split level travel with the part; joining computes the levels
 * above. Every function gives the same on every machine for the same scene, settings and number of parts.
 * Those with a device need it current on the calling thread. */
#ifndef GW_BUILD_OCTREE_PART_H
#define GW_BUILD_OCTREE_PART_H

#include "base/gl.h"
#include "base/status.h"
#include "build/octree.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_OCTREE_MAXIMUM_PARTS = 64 };

typedef struct gw_octree_division {
    uint32_t level, part_count;
    uint64_t begin[GW_OCTREE_MAXIMUM_PARTS + 1]; /* part p has the cells with Morton numbers [begin[p],
                                                    begin[p + 1]) of the level */
    uint64_t pairs[GW_OCTREE_MAXIMUM_PARTS]; /* (triangle, cell) pairs expected there and below, by bounding
                                                boxes */
} gw_octree_division;

/* Cuts the scene's cells into part_count (1..GW_OCTREE_MAXIMUM_PARTS) ranges of about equally many pairs. */
gw_code gw_octree_divide(const gw_scene *scene, const gw_settings *settings, uint32_t part_count,
                         gw_octree_division *out, gw_error *error);

/* A part as one flat block of bytes that may be sent; data is released with free(). */
typedef struct gw_octree_part {
    void *data;
    size_t size;
} gw_octree_part;

/* What the build of a part counted; the overlap tests are the measure of its work. Zeros when it is no part.
 */
gw_octree_statistics gw_octree_part_statistics(const gw_octree_part *part);

gw_code gw_octree_build_part(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                             const gw_octree_division *division, uint32_t part, gw_octree_part *out,
                             gw_error *error);

/* Whether the joined octree keeps the memory budget. One that does not has parts that cannot be joined, and
 * is built by gw_octree_build, which finds the cells that are not refined. */
int gw_octree_parts_fit(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                        const gw_octree_part *parts, uint32_t count);

/* parts[division->part_count], in order. Checks the blocks: GW_BAD_INPUT when one is not what
 * gw_octree_build_part made for this division. */
gw_code gw_octree_join(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                       const gw_octree_division *division, const gw_octree_part *parts, gw_octree **out,
                       gw_error *error);

#endif
