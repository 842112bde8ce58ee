/* Boxes over the lists of dense leaves: "a teapot in a stadium" puts thousands of triangles into one cell at
 * the depth limit, and a plain list costs each ray all of them.
 *
 * Lists are in canonical order, the Morton order of centroids, so a binary tree over runs of the list is a
 * bounding volume hierarchy (Lauterbach et al., Fast BVH Construction on GPUs, 2009) that needs no sort and
 * the same on every machine. Where a run is cut is decided by the surface area heuristic (Goldsmith and
 * Salmon 1987; MacDonald and Booth 1990) over the cuts that leave at least an eighth of it on either side, so
 * the tree stays shallow. */
#include "build/octree_internal.h"

#include "base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A kernel's place in a dense leaf is box * 8 + triangle, in a word (trace/list.glsl). */
enum { MOST_BOXES = 1 << 28 };

typedef struct bounds {
    float low[3], high[3];
} bounds;

/* One list on its way to boxes: its triangles in groups of GW_BOX_MOST_TRIANGLES, so that the number of boxes
 * follows from its length. */
typedef struct dense_list {
    uint32_t first, length; /* of its references */
    bounds *groups;
    float *areas; /* [groups] of the union of the groups up to this one */
    gw_box *boxes;
    size_t box_count;
} dense_list;

static bounds no_bounds(void) {
    return (bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void include(bounds *b, const bounds *other) {
    for (int axis = 0; axis < 3; ++axis) {
        b->low[axis] = fminf(b->low[axis], other->low[axis]);
        b->high[axis] = fmaxf(b->high[axis], other->high[axis]);
    }
}

/* Half the surface. */
static float area_of(const bounds *b) {
    float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x * y + y * z + z * x;
}

/* Wider than the triangle by 2^-20 of its longest side: what the triangle test rounds away (2^-21 of it).
 * What grows with the distance from the eye is added by the kernel. */
static bounds triangle_bounds(const gw_scene *scene, uint32_t triangle) {
    bounds b = no_bounds();
    float longest = 0;
    for (int k = 0; k < 3; ++k) {
        const float *p = scene->positions + (size_t)scene->triangles[triangle][k] * 3;
        bounds point = {{p[0], p[1], p[2]}, {p[0], p[1], p[2]}};
        include(&b, &point);
    }
    for (int axis = 0; axis < 3; ++axis)
        longest = fmaxf(longest, b.high[axis] - b.low[axis]);
    for (int axis = 0; axis < 3; ++axis) {
        b.low[axis] = nextafterf(b.low[axis] - longest * 0x1p-20f, -INFINITY);
        b.high[axis] = nextafterf(b.high[axis] + longest * 0x1p-20f, INFINITY);
    }
    return b;
}

static uint32_t groups_of(uint32_t length) {
    return (length + GW_BOX_MOST_TRIANGLES - 1) / GW_BOX_MOST_TRIANGLES;
}

uint64_t gw_octree_boxes_of(uint64_t length, uint32_t most_triangles) {
    return most_triangles == 0 || length <= most_triangles ? 0
                                                           : 2 * (uint64_t)groups_of((uint32_t)length) - 1;
}

/* Where to cut groups [begin, begin + count): the first of the second half. */
static uint32_t best_cut(dense_list *list, uint32_t begin, uint32_t count) {
    uint32_t least = count / 8 > 0 ? count / 8 : 1, best = count / 2;
    float best_cost = INFINITY;
    bounds left = no_bounds(), right = no_bounds();
    for (uint32_t i = 0; i < count; ++i) {
        include(&left, &list->groups[begin + i]);
        list->areas[begin + i] = area_of(&left);
    }
    for (uint32_t i = count; i-- > least;) {
        include(&right, &list->groups[begin + i]);
        float cost = list->areas[begin + i - 1] * (float)i + area_of(&right) * (float)(count - i);
        if (i <= count - least && cost < best_cost) {
            best_cost = cost;
            best = i;
        }
    }
    return begin + best;
}

/* Boxes of groups [begin, begin + count), depth first. */
static bounds add_boxes(dense_list *list, uint32_t begin, uint32_t count) {
    size_t at = list->box_count++;
    int last = begin + count == groups_of(list->length);
    bounds all = list->groups[begin];
    uint32_t link, triangles = 0;
    if (count == 1) {
        uint32_t before = begin * GW_BOX_MOST_TRIANGLES, left = list->length - before;
        link = list->first + before;
        triangles = left < GW_BOX_MOST_TRIANGLES ? left : GW_BOX_MOST_TRIANGLES;
        triangles |= last ? GW_BOX_LAST : 0u;
    } else {
        uint32_t cut = best_cut(list, begin, count);
        bounds half = add_boxes(list, begin, cut - begin);
        include(&all, &half);
        half = add_boxes(list, cut, begin + count - cut);
        include(&all, &half);
        link = last ? 0 : (uint32_t)list->box_count;
    }
    gw_box *box = &list->boxes[at];
    memcpy(box->low, all.low, sizeof box->low);
    memcpy(box->high, all.high, sizeof box->high);
    box->link = link;
    box->triangles = triangles;
    return all;
}

uint32_t gw_octree_first_reference(const gw_octree *octree, const gw_node *node) {
    uint32_t kind = GW_NODE_KIND(node->bits), box = node->link;
    if (kind != GW_LEAF_DENSE)
        return kind == GW_LEAF_LIST ? node->link : 0;
    while (GW_BOX_TRIANGLES(octree->boxes[box].triangles) == 0)
        box++;
    return octree->boxes[box].link;
}

/* Length of the list if it is to have boxes, else 0. */
static uint32_t dense_length(const gw_octree *octree, uint32_t level, const gw_node *node,
                             uint32_t most_triangles) {
    uint32_t at = node->link;
    if (GW_NODE_KIND(node->bits) != GW_LEAF_LIST)
        return 0;
    while (!(octree->references[at] & GW_REFERENCE_LAST))
        at++;
    const uint32_t length = at - node->link + 1;
    return length > most_triangles && gw_octree_gain(level, length) >= octree->statistics.least_gain ? length
                                                                                                     : 0;
}

static void make_dense(const gw_scene *scene, const gw_octree *octree, gw_node *node, dense_list *list) {
    list->first = node->link;
    for (uint32_t g = 0; g < groups_of(list->length); ++g)
        list->groups[g] = no_bounds();
    for (uint32_t i = 0; i < list->length; ++i) {
        bounds b = triangle_bounds(scene, octree->references[list->first + i] & GW_REFERENCE_ID);
        include(&list->groups[i / GW_BOX_MOST_TRIANGLES], &b);
    }
    node->link = (uint32_t)list->box_count;
    node->bits = (node->bits & ~(0xfu << 16)) | GW_LEAF_DENSE << 16;
    add_boxes(list, 0, groups_of(list->length));
}

gw_code gw_octree_add_boxes(const gw_scene *scene, uint32_t most_triangles, gw_octree *octree,
                            gw_error *error) {
    dense_list list = {0};
    uint64_t boxes = 0;
    free(octree->boxes); /* of an octree that is built again */
    octree->boxes = NULL;
    octree->box_count = 0;
    if (most_triangles == 0 || octree->statistics.longest_list <= most_triangles)
        return GW_OK;
    for (uint32_t level = 0; level <= octree->depth; ++level)
        for (uint32_t i = octree->level_begin[level]; i < octree->level_begin[level + 1]; ++i)
            boxes += gw_octree_boxes_of(dense_length(octree, level, &octree->nodes[i], most_triangles),
                                        most_triangles);
    if (boxes == 0)
        return GW_OK;
    if (boxes > MOST_BOXES)
        return gw_fail(error, GW_MACHINE,
                       "dense leaves need %" PRIu64 " boxes, more than %d; raise dense_leaf", boxes,
                       (int)MOST_BOXES);
    size_t groups = groups_of(octree->statistics.longest_list);
    gw_code code = gw_allocate((void **)&list.boxes, boxes, sizeof *list.boxes, "boxes of leaves", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&list.groups, groups, sizeof *list.groups, "bounds of triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&list.areas, groups, sizeof *list.areas, "areas of bounds", error);
    for (uint32_t level = 0; code == GW_OK && level <= octree->depth; ++level)
        for (uint32_t i = octree->level_begin[level]; i < octree->level_begin[level + 1]; ++i) {
            list.length = dense_length(octree, level, &octree->nodes[i], most_triangles);
            if (list.length == 0)
                continue;
            make_dense(scene, octree, &octree->nodes[i], &list);
            octree->statistics.dense_leaves++;
        }
    free(list.groups);
    free(list.areas);
    if (code != GW_OK) {
        free(list.boxes);
        return code;
    }
    octree->boxes = list.boxes;
    octree->box_count = (uint32_t)list.box_count;
    return GW_OK;
}
