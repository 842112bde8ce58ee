#include "build/octree_internal.h"

#include "base/clock.h"
#include "base/memory.h"
#include "build/components.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A connected component of the mesh: triangles that hang together by welded vertices. */
typedef struct component {
    uint32_t triangles;
    float low[3], high[3];
} component;

enum { COUNTED_EXACTLY = 1 << 24 }; /* integers that a float holds exactly */

static void measure_components(const gw_scene *scene, const uint32_t *component_of, component *components) {
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        component *c = &components[component_of[scene->welded[scene->triangles[t][0]]]];
        for (int k = 0; k < 3; ++k) {
            const float *p = scene->positions + (size_t)scene->triangles[t][k] * 3;
            for (int axis = 0; axis < 3; ++axis) {
                int first = c->triangles == 0 && k == 0;
                c->low[axis] = first || p[axis] < c->low[axis] ? p[axis] : c->low[axis];
                c->high[axis] = first || p[axis] > c->high[axis] ? p[axis] : c->high[axis];
            }
        }
        c->triangles++;
    }
}

static float longest_side(const component *c) {
    float side = 0;
    for (int axis = 0; axis < 3; ++axis)
        side = fmaxf(side, c->high[axis] - c->low[axis]);
    return side;
}

static void fill_texels(const gw_scene *scene, const uint32_t *component_of, const component *components,
                        float (*triangles)[3][4], uint32_t (*topology)[4]) {
    for (uint32_t t = 0; t < scene->triangle_count; ++t) {
        uint32_t root = component_of[scene->welded[scene->triangles[t][0]]];
        uint32_t size = components[root].triangles;
        for (int k = 0; k < 3; ++k) {
            uint32_t vertex = scene->triangles[t][k];
            memcpy(triangles[t][k], scene->positions + (size_t)vertex * 3, 3 * sizeof(float));
            topology[t][k] = scene->welded[vertex];
        }
        topology[t][3] = root;
        triangles[t][0][3] = longest_side(&components[root]);
        triangles[t][1][3] = (float)(size < COUNTED_EXACTLY ? size : COUNTED_EXACTLY);
    }
}

gw_code gw_octree_upload(gw_octree_builder *builder, gw_error *error) {
    const gw_scene *scene = builder->scene;
    uint32_t *component_of = NULL;
    component *components = NULL;
    float(*triangles)[3][4] = NULL;
    uint32_t(*topology)[4] = NULL;
    gw_code code = gw_components(scene, &component_of, error);
    if (code == GW_OK)
        code =
            gw_allocate((void **)&components, scene->welded_count, sizeof *components, "components", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&triangles, scene->triangle_count, sizeof *triangles, "triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&topology, scene->triangle_count, sizeof *topology, "topology", error);
    if (code == GW_OK) {
        measure_components(scene, component_of, components);
        fill_texels(scene, component_of, components, triangles, topology);
        code = gw_gl_buffer_create(builder->device, "build triangles",
                                   (size_t)scene->triangle_count * sizeof *triangles, triangles, GL_RGBA32F,
                                   &builder->triangles, error);
    }
    if (code == GW_OK)
        code = gw_gl_buffer_create(builder->device, "build topology",
                                   (size_t)scene->triangle_count * sizeof *topology, topology, GL_RGBA32UI,
                                   &builder->topology, error);
    free(component_of);
    free(components);
    free(triangles);
    free(topology);
    return code;
}

static gw_code count_arrays(const gw_octree_builder *builder, gw_octree *octree, gw_error *error) {
    const gw_gl_limits *limits = gw_gl_limits_of(builder->device);
    uint64_t nodes = 0, references = 1; /* entry 0 is reserved */
    for (uint32_t l = 0; l <= builder->depth; ++l) {
        octree->level_begin[l] = (uint32_t)nodes;
        nodes += builder->levels[l].node_count;
        references += builder->levels[l].reference_count;
        if (builder->levels[l].node_count > 0)
            octree->statistics.deepest = l;
    }
    for (uint32_t l = builder->depth + 1; l < GW_OCTREE_MAXIMUM_DEPTH + 2; ++l)
        octree->level_begin[l] = (uint32_t)nodes;
    if (nodes > (uint64_t)limits->texture_buffer_texels ||
        references > (uint64_t)limits->texture_buffer_texels)
        return gw_fail(error, GW_MACHINE,
                       "the octree needs %" PRIu64 " nodes and %" PRIu64
                       " references, this driver reads at most %" PRId64
                       " of each; lower octree_depth (now %" PRIu32 ") or raise leaf_triangles (now %" PRId32
                       ")",
                       nodes, references, limits->texture_buffer_texels, builder->depth,
                       builder->settings->leaf_triangles);
    octree->node_count = (uint32_t)nodes;
    octree->reference_count = (uint32_t)references;
    return GW_OK;
}

/* Zeroed rows in *array, which has `room` of them (0 for none). */
static gw_code renew(void *array_address, uint32_t room, uint32_t wanted, uint32_t count, size_t row,
                     const char *what, gw_error *error) {
    void **array = array_address;
    if (*array && count <= room) {
        memset(*array, 0, count * row);
        return GW_OK;
    }
    free(*array);
    return gw_allocate(array, wanted, row, what, error);
}

/* An octree that is built again gets an eighth more than it needs when it has to grow. */
static uint32_t room_for(uint32_t room, uint32_t count) {
    return room == 0 ? count : count <= room ? room : count + count / 8;
}

gw_code gw_octree_allocate(gw_octree *octree, gw_error *error) {
    const uint32_t nodes = room_for(octree->node_room, octree->node_count),
                   references = room_for(octree->reference_room, octree->reference_count);
    gw_code code = renew(&octree->nodes, octree->node_room, nodes, octree->node_count, sizeof *octree->nodes,
                         "octree nodes", error);
    if (code == GW_OK)
        code = renew(&octree->payloads, octree->node_room, nodes, octree->node_count,
                     sizeof *octree->payloads, "octree payloads", error);
    if (code == GW_OK)
        code = renew(&octree->references, octree->reference_room, references, octree->reference_count,
                     sizeof *octree->references, "octree references", error);
    if (octree->emissions && nodes != octree->node_room) { /* made by the payload, where light is emitted */
        free(octree->emissions);
        octree->emissions = NULL;
    }
    octree->node_room = nodes;
    octree->reference_room = references;
    return code;
}

gw_code gw_octree_assemble(const gw_octree_builder *builder, gw_octree *octree, gw_error *error) {
    uint32_t reference_base = 1, run = 0;
    gw_code code = count_arrays(builder, octree, error);
    if (code == GW_OK)
        code = gw_octree_allocate(octree, error);
    if (code != GW_OK)
        return code;
    octree->references[0] = GW_REFERENCE_LAST;
    for (uint32_t l = 0; l <= builder->depth; ++l) {
        const gw_octree_level *level = &builder->levels[l];
        for (size_t i = 0; i < level->node_count; ++i) {
            gw_node node = level->nodes[i];
            if (GW_NODE_KIND(node.bits) == GW_KIND_INNER)
                node.link += octree->level_begin[l + 1];
            else if (GW_NODE_KIND(node.bits) == GW_LEAF_LIST)
                node.link += reference_base;
            octree->nodes[octree->level_begin[l] + i] = node;
        }
        if (level->reference_count > 0)
            memcpy(octree->references + reference_base, level->references,
                   level->reference_count * sizeof *level->references);
        reference_base += (uint32_t)level->reference_count;
    }
    for (uint32_t i = 1; i < octree->reference_count; ++i) {
        run++;
        if (run > octree->statistics.longest_list)
            octree->statistics.longest_list = run;
        if (octree->references[i] & GW_REFERENCE_LAST)
            run = 0;
    }
    if (octree->statistics.longest_list == 0)
        octree->statistics.longest_list = 1;
    return GW_OK;
}

void gw_octree_builder_finish(gw_octree_builder *builder) {
    for (uint32_t l = 0; l <= GW_OCTREE_MAXIMUM_DEPTH; ++l) {
        free(builder->levels[l].nodes);
        free(builder->levels[l].cells);
        free(builder->levels[l].references);
    }
    gw_gl_buffer_finish(&builder->triangles);
    gw_gl_buffer_finish(&builder->topology);
    gw_payload_inputs_finish(&builder->inputs);
}

void gw_octree_builder_clear(gw_octree_builder *builder) {
    for (uint32_t l = 0; l <= GW_OCTREE_MAXIMUM_DEPTH; ++l)
        builder->levels[l].node_count = builder->levels[l].reference_count = 0;
    builder->statistics = (gw_octree_statistics){0};
    builder->budget = (gw_octree_budget){0};
    builder->least_gain = 0;
    builder->may_count = 1;
    builder->counting = 0;
}

/* Of one node in all arrays that have nodes. */
static uint64_t node_bytes(const gw_scene *scene) {
    return sizeof(gw_node) + sizeof(gw_payload) + (gw_octree_emits(scene) ? sizeof(uint32_t) : 0);
}

void gw_octree_builder_reset(gw_octree_builder *builder, const gw_scene *scene) {
    gw_octree_builder_clear(builder);
    gw_gl_buffer_finish(&builder->triangles);
    gw_gl_buffer_finish(&builder->topology);
    builder->scene = scene;
    builder->allowance.node_bytes = node_bytes(scene);
}

void gw_octree_hash(gw_octree *octree) {
    gw_hash hash = {0, 0};
    hash = gw_hash_bytes(hash, &octree->depth, sizeof octree->depth);
    hash = gw_hash_bytes(hash, octree->nodes, (size_t)gw_octree_node_bytes(octree));
    hash = gw_hash_bytes(hash, octree->payloads, (size_t)gw_octree_payload_bytes(octree));
    hash = gw_hash_bytes(hash, octree->references, (size_t)gw_octree_reference_bytes(octree));
    if (octree->emissions)
        hash = gw_hash_bytes(hash, octree->emissions, (size_t)gw_octree_emission_bytes(octree));
    if (octree->boxes)
        hash = gw_hash_bytes(hash, octree->boxes, (size_t)gw_octree_box_bytes(octree));
    octree->hash = hash;
}

static double milliseconds_since(int64_t start) {
    return (double)(gw_now_ns() - start) * 1e-6;
}

gw_code gw_octree_run(gw_octree_builder *builder, gw_octree *octree, gw_error *error) {
    int64_t start = gw_now_ns();
    double refine_ms, assemble_ms;
    gw_code code = gw_octree_upload(builder, error);
    if (code == GW_OK)
        code = gw_octree_refine_within(builder, error);
    if (code != GW_OK)
        return code;
    refine_ms = milliseconds_since(start);
    start = gw_now_ns();
    octree->statistics = builder->statistics;
    code = gw_octree_assemble(builder, octree, error);
    assemble_ms = milliseconds_since(start);
    const gw_payload_range all = {.deepest = octree->statistics.deepest};
    if (code == GW_OK)
        code = gw_octree_payload(builder, &all, octree, error); /* fills milliseconds[1] and [2] */
    octree->statistics.milliseconds[0] = refine_ms;
    octree->statistics.milliseconds[3] = assemble_ms;
    return code == GW_OK ? gw_octree_complete(builder, octree, error) : code;
}

gw_code gw_octree_complete(const gw_octree_builder *builder, gw_octree *octree, gw_error *error) {
    gw_code code =
        gw_octree_add_boxes(builder->scene, (uint32_t)builder->settings->dense_leaf, octree, error);
    if (code == GW_OK)
        gw_octree_hash(octree);
    return code;
}

void gw_octree_builder_init(gw_octree_builder *builder, gw_gl *device, const gw_scene *scene,
                            const gw_octree_options *options) {
    uint64_t driver_limit = (uint64_t)gw_gl_limits_of(device)->storage_block_bytes / 8;
    *builder = (gw_octree_builder){.device = device,
                                   .scene = scene,
                                   .settings = options->settings,
                                   .log = options->log,
                                   .depth = (uint32_t)options->settings->octree_depth,
                                   .may_count = 1,
                                   .key_last = 1};
    const double mebibytes = options->settings->octree_memory;
    const uint64_t driver_texels = (uint64_t)gw_gl_limits_of(device)->texture_buffer_texels;
    builder->allowance.bytes = mebibytes > 0 ? (uint64_t)(mebibytes * 1048576.0) : UINT64_MAX;
    builder->allowance.texels =
        options->texel_limit && options->texel_limit < driver_texels ? options->texel_limit : driver_texels;
    builder->allowance.node_bytes = scene ? node_bytes(scene) : 0;
    builder->pair_limit = driver_limit < UINT32_MAX / 8 ? driver_limit : UINT32_MAX / 8;
    if (options->part_limit > 0 && options->part_limit < builder->pair_limit)
        builder->pair_limit = options->part_limit;
}

gw_code gw_octree_build(gw_gl *device, const gw_scene *scene, const gw_octree_options *options,
                        gw_octree **out, gw_error *error) {
    gw_octree_builder builder;
    gw_octree *octree = NULL;
    *out = NULL;
    gw_octree_builder_init(&builder, device, scene, options);
    gw_code code = gw_allocate((void **)&octree, 1, sizeof *octree, "octree", error);
    if (code != GW_OK)
        return code;
    octree->depth = builder.depth;
    code = gw_octree_run(&builder, octree, error);
    gw_octree_builder_finish(&builder);
    if (code != GW_OK) {
        gw_octree_destroy(&octree);
        return gw_context(error, "cannot build the octree of '%s'", scene->path ? scene->path : "scene");
    }
    *out = octree;
    return GW_OK;
}

void gw_octree_destroy(gw_octree **octree) {
    if (!octree || !*octree)
        return;
    if (!(*octree)->borrowed) {
        free((*octree)->nodes);
        free((*octree)->payloads);
        free((*octree)->references);
        free((*octree)->emissions);
        free((*octree)->boxes);
    }
    free((*octree)->block);
    free(*octree);
    *octree = NULL;
}

uint64_t gw_octree_node_bytes(const gw_octree *octree) {
    return (uint64_t)octree->node_count * sizeof *octree->nodes;
}

uint64_t gw_octree_payload_bytes(const gw_octree *octree) {
    return (uint64_t)octree->node_count * sizeof *octree->payloads;
}

uint64_t gw_octree_reference_bytes(const gw_octree *octree) {
    return (uint64_t)octree->reference_count * sizeof *octree->references;
}

uint64_t gw_octree_emission_bytes(const gw_octree *octree) {
    return octree->emissions ? (uint64_t)octree->node_count * sizeof *octree->emissions : 0;
}

uint64_t gw_octree_box_bytes(const gw_octree *octree) {
    return (uint64_t)octree->box_count * sizeof *octree->boxes;
}

uint64_t gw_octree_bytes(const gw_octree *octree) {
    return gw_octree_node_bytes(octree) + gw_octree_payload_bytes(octree) +
           gw_octree_reference_bytes(octree) + gw_octree_emission_bytes(octree) + gw_octree_box_bytes(octree);
}
