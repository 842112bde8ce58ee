#include "build/octree.h"

#include "base/memory.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum {
    LOCATION_NODE_FIRST = 1,
    LOCATION_NODE_LAST,
    LOCATION_LEVEL,
    LOCATION_NODE_COUNT,
    LOCATION_REFERENCE_COUNT,
    LOCATION_TRIANGLE_COUNT,
    LOCATION_BOX_COUNT
};
enum { GROUP = 64 };

/* What each check of shaders/build/validate.comp found, by its number. */
static const char *const check_texts[] = {
    "",
    "has an unknown kind, or is a root that is no inner node",
    "has child masks that contradict its kind",
    "points at children outside the array or not below its level",
    "says leaf of an inner child, or the other way round",
    "has a list that leaves the reference array, or a triangle that does not exist",
    "has a list that is not in rising order",
    "lists a triangle that does not touch its cell",
    "has an area that is not the mean of its children's",
};

typedef struct validation {
    gw_gl_buffer triangles, nodes, references, payloads, boxes, failure, cells, parents;
} validation;

static void finish_validation(validation *v) {
    gw_gl_buffer *all[] = {&v->triangles, &v->nodes,   &v->references, &v->payloads,
                           &v->boxes,     &v->failure, &v->cells,      &v->parents};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        gw_gl_buffer_finish(all[i]);
}

static gw_code upload(validation *v, gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                      gw_error *error) {
    const uint32_t none = UINT32_MAX;
    float(*triangles)[3][4] = NULL;
    gw_code code =
        gw_allocate((void **)&triangles, scene->triangle_count, sizeof *triangles, "triangles", error);
    for (uint32_t t = 0; code == GW_OK && t < scene->triangle_count; ++t)
        for (int k = 0; k < 3; ++k)
            memcpy(triangles[t][k], scene->positions + (size_t)scene->triangles[t][k] * 3, 3 * sizeof(float));
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "triangles", (size_t)scene->triangle_count * sizeof *triangles,
                                   triangles, GL_RGBA32F, &v->triangles, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "nodes", (size_t)gw_octree_node_bytes(octree), octree->nodes,
                                   GL_RG32UI, &v->nodes, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "references", (size_t)gw_octree_reference_bytes(octree),
                                   octree->references, GL_R32UI, &v->references, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "payloads", (size_t)gw_octree_payload_bytes(octree),
                                   octree->payloads, GL_RGB32UI, &v->payloads, error);
    if (code == GW_OK && octree->boxes)
        code = gw_gl_buffer_create(device, "boxes", (size_t)gw_octree_box_bytes(octree), octree->boxes,
                                   GL_RGBA32UI, &v->boxes, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "failure", sizeof none, &none, 0, &v->failure, error);
    if (code == GW_OK)
        code =
            gw_gl_buffer_create(device, "cells", (size_t)octree->node_count * 8, NULL, 0, &v->cells, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(device, "parent counts", (size_t)octree->node_count * 4, NULL, 0,
                                   &v->parents, error);
    free(triangles);
    return code;
}

static gw_code run_levels(const validation *v, gw_gl *device, const gw_scene *scene, const gw_octree *octree,
                          gw_error *error) {
    GLuint program;
    gw_code code = gw_gl_program(device, "build/validate.comp", NULL, &program, error);
    if (code != GW_OK)
        return code;
    gw_gl_texture_bind(&v->triangles, 0);
    gw_gl_texture_bind(&v->nodes, 1);
    gw_gl_texture_bind(&v->references, 2);
    gw_gl_texture_bind(&v->payloads, 3);
    if (octree->boxes)
        gw_gl_texture_bind(&v->boxes, 4);
    gw_gl_buffer_bind(&v->failure, 0);
    gw_gl_buffer_bind(&v->cells, 1);
    gw_gl_buffer_bind(&v->parents, 2);
    glProgramUniform1ui(program, LOCATION_NODE_COUNT, octree->node_count);
    glProgramUniform1ui(program, LOCATION_REFERENCE_COUNT, octree->reference_count);
    glProgramUniform1ui(program, LOCATION_TRIANGLE_COUNT, scene->triangle_count);
    glProgramUniform1ui(program, LOCATION_BOX_COUNT, octree->box_count);
    for (uint32_t level = 0; code == GW_OK && level <= octree->depth; ++level) {
        uint32_t first = octree->level_begin[level], last = octree->level_begin[level + 1];
        if (first == last)
            break;
        gw_log_progress(gw_gl_log(device), "checking the octree", (double)level / (octree->depth + 1));
        glProgramUniform1ui(program, LOCATION_NODE_FIRST, first);
        glProgramUniform1ui(program, LOCATION_NODE_LAST, last);
        glProgramUniform1ui(program, LOCATION_LEVEL, level);
        code = gw_gl_dispatch(device, program, (last - first + GROUP - 1) / GROUP, error);
    }
    return code;
}

/* Every node but the root is the child of exactly one node. */
static gw_code check_parents(const validation *v, const gw_octree *octree, gw_error *error) {
    uint32_t *counts = NULL;
    gw_code code = gw_allocate((void **)&counts, octree->node_count, sizeof *counts, "parent counts", error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&v->parents, 0, (size_t)octree->node_count * 4, counts, error);
    for (uint32_t i = 0; code == GW_OK && i < octree->node_count; ++i)
        if (counts[i] != (i > 0))
            code =
                gw_fail(error, GW_MACHINE, "octree node %" PRIu32 " has %" PRIu32 " parents", i, counts[i]);
    free(counts);
    return code;
}

/* One dense leaf while its boxes are checked. */
typedef struct box_walk {
    const gw_scene *scene;
    const gw_octree *octree;
    uint32_t box, reference; /* the next of each */
} box_walk;

/* Every part of `inner` lies in `outer`. */
static int holds(const gw_box *outer, const float low[3], const float high[3]) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(low[axis] >= outer->low[axis] && high[axis] <= outer->high[axis]))
            return 0;
    return 1;
}

static int holds_triangles(box_walk *walk, const gw_box *box) {
    const gw_octree *octree = walk->octree;
    uint32_t count = GW_BOX_TRIANGLES(box->triangles);
    if (box->link != walk->reference || count > octree->reference_count - box->link)
        return 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t triangle = octree->references[walk->reference++] & GW_REFERENCE_ID;
        for (int k = 0; k < 3; ++k) {
            const float *p = walk->scene->positions + (size_t)walk->scene->triangles[triangle][k] * 3;
            if (!holds(box, p, p))
                return 0;
        }
    }
    return 1;
}

/* The box at walk->box and all below it: in order, linked on, around what they hold; last: nothing of the
 * leaf follows. */
static int check_boxes_below(box_walk *walk, int last, int levels_left) {
    const gw_octree *octree = walk->octree;
    if (walk->box >= octree->box_count || levels_left == 0)
        return 0;
    const gw_box *box = &octree->boxes[walk->box++];
    if (GW_BOX_TRIANGLES(box->triangles) > 0)
        return !(box->triangles & GW_BOX_LAST) == !last && holds_triangles(walk, box);
    for (int half = 0; half < 2; ++half) {
        const gw_box *child = &octree->boxes[walk->box];
        if (!check_boxes_below(walk, last && half == 1, levels_left - 1) ||
            !holds(box, child->low, child->high))
            return 0;
    }
    return box->link == (last ? 0 : walk->box);
}

/* The boxes of dense leaves, on the host: they are few and their order is a walk. */
static gw_code check_dense(const gw_scene *scene, const gw_octree *octree, gw_error *error) {
    enum { MOST_LEVELS = 256 };
    box_walk walk = {.scene = scene, .octree = octree};
    for (uint32_t i = 0; i < octree->node_count; ++i) {
        if (GW_NODE_KIND(octree->nodes[i].bits) != GW_LEAF_DENSE)
            continue;
        int sound = octree->nodes[i].link == walk.box && walk.box < octree->box_count;
        if (sound)
            walk.reference = gw_octree_first_reference(octree, &octree->nodes[i]);
        if (!sound || !check_boxes_below(&walk, 1, MOST_LEVELS) ||
            !(octree->references[walk.reference - 1] & GW_REFERENCE_LAST))
            return gw_fail(error, GW_MACHINE,
                           "octree node %" PRIu32 " has boxes that do not cover its list in order", i);
    }
    return GW_OK;
}

gw_code gw_octree_validate(gw_gl *device, const gw_scene *scene, const gw_octree *octree, gw_error *error) {
    validation v = {0};
    uint32_t failure = UINT32_MAX;
    gw_code code = upload(&v, device, scene, octree, error);
    if (code == GW_OK)
        code = run_levels(&v, device, scene, octree, error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&v.failure, 0, sizeof failure, &failure, error);
    if (code == GW_OK && failure != UINT32_MAX) {
        uint32_t check = failure & 0xfu;
        code = gw_fail(error, GW_MACHINE, "octree node %" PRIu32 " %s", failure >> 4,
                       check < sizeof check_texts / sizeof *check_texts ? check_texts[check] : "is broken");
    }
    if (code == GW_OK)
        code = check_parents(&v, octree, error);
    if (code == GW_OK)
        code = check_dense(scene, octree, error);
    finish_validation(&v);
    return code;
}
