/* The node of Weier et al. 2014, see node_forms.h. */
#include "wall/node_forms.h"

#include "base/memory.h"
#include "shaders/bench/node_forms.h"

#include <epoxy/gl.h>
#include <stdlib.h>

typedef struct seed_node {
    uint32_t word, voxel;
} seed_node;

typedef struct seed_builder {
    const gw_octree *octree;
    uint32_t triangles;
    int single_inline;
    seed_node *nodes;
    uint32_t *places; /* of the octree's nodes */
    uint32_t *references;
    uint32_t pair_end, list_end; /* next free places: lists of two stand before the others */
} seed_builder;

static uint32_t list_length(const gw_octree *octree, const gw_node *leaf) {
    uint32_t length = 1;
    if (GW_NODE_KIND(leaf->bits) == GW_LEAF_LIST)
        while (!(octree->references[leaf->link + length - 1] & GW_REFERENCE_LAST))
            length++;
    return length;
}

/* References that the form needs, and how many of them are of lists of two. */
static uint64_t count_references(const seed_builder *b, uint64_t *pairs) {
    uint64_t total = 0;
    *pairs = 0;
    for (uint32_t i = 0; i < b->octree->node_count; i++) {
        const gw_node *node = &b->octree->nodes[i];
        if (GW_NODE_KIND(node->bits) == GW_KIND_INNER)
            continue;
        uint32_t length = list_length(b->octree, node);
        if (length == 1 && b->single_inline)
            continue;
        total += length;
        *pairs += length == 2 ? 2 : 0;
    }
    return total;
}

static uint32_t leaf_word(seed_builder *b, const gw_node *leaf) {
    uint32_t length = list_length(b->octree, leaf);
    int single = GW_NODE_KIND(leaf->bits) == GW_LEAF_SINGLE;
    if (length == 1 && b->single_inline)
        return GW_SEED_LEAF | (single ? leaf->link : b->octree->references[leaf->link] & GW_REFERENCE_ID);
    uint32_t *end = length == 2 ? &b->pair_end : &b->list_end;
    uint32_t place = *end;
    for (uint32_t k = 0; k < length; k++)
        b->references[place + k] = single ? leaf->link : b->octree->references[leaf->link + k];
    b->references[place + length - 1] |= GW_REFERENCE_LAST;
    *end += length;
    return GW_SEED_LEAF | (b->triangles + place);
}

static void fill_nodes(seed_builder *b) {
    const gw_octree *octree = b->octree;
    uint32_t next = 1;
    b->places[0] = 0;
    for (uint32_t i = 0; i < octree->node_count; i++) {
        const gw_node *node = &octree->nodes[i];
        seed_node *seed = &b->nodes[b->places[i]];
        seed->voxel = i;
        if (GW_NODE_KIND(node->bits) != GW_KIND_INNER) {
            seed->word = leaf_word(b, node);
            continue;
        }
        seed->word = next;
        uint32_t child = node->link;
        for (uint32_t octant = 0; octant < 8; octant++) {
            b->nodes[next + octant] = (seed_node){GW_SEED_EMPTY, UINT32_MAX};
            if (GW_NODE_VALID(node->bits) >> octant & 1u)
                b->places[child++] = next + octant;
        }
        next += 8;
    }
}

gw_code gw_form_seed64(const gw_octree *octree, uint32_t triangles, int single_inline, gw_node_form *out,
                       gw_error *error) {
    seed_builder b = {.octree = octree, .triangles = triangles, .single_inline = single_inline};
    uint64_t inner = 0, pairs = 0;
    for (uint32_t i = 0; i < octree->node_count; i++) {
        inner += GW_NODE_KIND(octree->nodes[i].bits) == GW_KIND_INNER;
        if (GW_NODE_KIND(octree->nodes[i].bits) > GW_LEAF_SINGLE)
            return gw_fail(error, GW_MACHINE, "seed64 knows no leaf of kind %u",
                           (unsigned)GW_NODE_KIND(octree->nodes[i].bits));
    }
    uint64_t references = count_references(&b, &pairs), nodes = 1 + 8 * inner;
    if (triangles + references >= GW_SEED_INDEX || nodes >= GW_SEED_INDEX)
        return gw_fail(error, GW_MACHINE,
                       "seed64 addresses 2^30 nodes or triangles and references, here are %llu and %llu",
                       (unsigned long long)nodes, (unsigned long long)(triangles + references));
    b.list_end = (uint32_t)pairs;
    gw_code code = gw_allocate((void **)&b.nodes, (size_t)nodes, sizeof *b.nodes, "seed64 nodes", error);
    if (!code)
        code =
            gw_allocate((void **)&b.places, octree->node_count, sizeof *b.places, "places of nodes", error);
    if (!code)
        code = gw_allocate((void **)&b.references, (size_t)references + 1, sizeof *b.references,
                           "seed64 references", error);
    if (!code)
        fill_nodes(&b);
    free(b.places);
    *out = (gw_node_form){.arrays = {{b.nodes, (size_t)nodes * sizeof *b.nodes, GL_RG32UI, 0, GW_PART_NODES},
                                     {b.references, (size_t)references * sizeof *b.references, GL_R32UI, 1,
                                      GW_PART_REFERENCES}},
                          .array_count = 2,
                          .voxels = octree->node_count};
    if (code)
        gw_node_form_finish(out);
    return code;
}
