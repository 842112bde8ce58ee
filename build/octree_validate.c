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
    LOCATION_TRIANGLE_COUNT
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
    gw_gl_buffer triangles, nodes, references, payloads, failure, cells, parents;
} validation;

static void finish_validation(validation *v) {
    gw_gl_buffer *all[] = {&v->triangles, &v->nodes, &v->references, &v->payloads,
                           &v->failure,   &v->cells, &v->parents};
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
    gw_gl_buffer_bind(&v->failure, 0);
    gw_gl_buffer_bind(&v->cells, 1);
    gw_gl_buffer_bind(&v->parents, 2);
    glProgramUniform1ui(program, LOCATION_NODE_COUNT, octree->node_count);
    glProgramUniform1ui(program, LOCATION_REFERENCE_COUNT, octree->reference_count);
    glProgramUniform1ui(program, LOCATION_TRIANGLE_COUNT, scene->triangle_count);
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
    finish_validation(&v);
    return code;
}
