/* Nodes of 4 x 4 x 4 children, see node_forms.h. */
#include "wall/node_forms.h"

#include "base/memory.h"

#include <epoxy/gl.h>
#include <stdlib.h>

typedef struct wide_node {
    uint64_t inner, leaves;           /* masks of children */
    uint32_t first, words, one, zero; /* first inner child, first leaf word, blocks that are one leaf */
} wide_node;
_Static_assert(sizeof(wide_node) == 32, "two texels of four words");

typedef struct wide_builder {
    const gw_octree *octree;
    wide_node *nodes;
    uint32_t *sources; /* the octree's node that each wide node stands for */
    uint32_t *words;   /* of leaves */
    uint32_t node_count, word_count;
} wide_builder;

/* What stands at a wide node's 64 children; UINT32_MAX: nothing. */
typedef struct wide_children {
    uint32_t node[64];
} wide_children;

static uint32_t child_of(const gw_octree *octree, uint32_t node, uint32_t octant) {
    const gw_node *n = &octree->nodes[node];
    uint32_t valid = GW_NODE_VALID(n->bits);
    return valid >> octant & 1u ? n->link + (uint32_t)__builtin_popcount(valid & ((1u << octant) - 1u))
                                : UINT32_MAX;
}

static int is_leaf(const gw_octree *octree, uint32_t node) {
    return GW_NODE_KIND(octree->nodes[node].bits) != GW_KIND_INNER;
}

/* Place of the lowest child of a block, in the order of the mask. */
static uint32_t lowest_of(uint32_t block) {
    return (block & 1u) << 1 | (block & 2u) << 2 | (block & 4u) << 3;
}

static uint32_t place_of(uint32_t block, uint32_t octant) {
    return lowest_of(block) + ((octant & 1u) | (octant & 2u) << 1 | (octant & 4u) << 2);
}

/* Returns the mask of blocks that are one leaf. */
static uint32_t gather(const gw_octree *octree, uint32_t source, int top_of_odd, wide_children *out) {
    uint32_t one = 0;
    for (int i = 0; i < 64; i++)
        out->node[i] = UINT32_MAX;
    for (uint32_t block = 0; block < 8; block++) {
        uint32_t child = child_of(octree, source, block);
        if (child == UINT32_MAX)
            continue;
        if (top_of_odd) {
            out->node[place_of(0, block)] = child;
        } else if (is_leaf(octree, child)) {
            out->node[lowest_of(block)] = child;
            one |= 1u << block;
        } else {
            for (uint32_t octant = 0; octant < 8; octant++)
                out->node[place_of(block, octant)] = child_of(octree, child, octant);
        }
    }
    return one;
}

static void fill_node(wide_builder *b, uint32_t index, int top_of_odd) {
    wide_children children;
    wide_node node = {.first = b->node_count, .words = b->word_count};
    node.one = gather(b->octree, b->sources[index], top_of_odd, &children);
    for (uint32_t place = 0; place < 64; place++) {
        uint32_t child = children.node[place];
        if (child == UINT32_MAX)
            continue;
        const gw_node *n = &b->octree->nodes[child];
        if (is_leaf(b->octree, child)) {
            node.leaves |= UINT64_C(1) << place;
            b->words[b->word_count++] = gw_form_leaf_word(n);
        } else {
            node.inner |= UINT64_C(1) << place;
            b->sources[b->node_count++] = child;
        }
    }
    b->nodes[index] = node;
}

gw_code gw_form_wide(const gw_octree *octree, gw_node_form *out, gw_error *error) {
    wide_builder b = {.octree = octree, .node_count = 1};
    uint32_t inner = 0;
    for (uint32_t i = 0; i < octree->node_count; i++)
        inner += !is_leaf(octree, i);
    gw_code code = gw_form_check_leaf_words(octree, error);
    if (!code)
        code = gw_allocate((void **)&b.nodes, inner, sizeof *b.nodes, "wide nodes", error);
    if (!code)
        code = gw_allocate((void **)&b.sources, inner, sizeof *b.sources, "places of nodes", error);
    if (!code)
        code =
            gw_allocate((void **)&b.words, octree->node_count - inner, sizeof *b.words, "leaf words", error);
    for (uint32_t i = 0; !code && i < b.node_count; i++)
        fill_node(&b, i, i == 0 && (octree->depth & 1u));
    free(b.sources);
    *out = (gw_node_form){.arrays = {{b.nodes, b.node_count * sizeof *b.nodes, GL_RGBA32UI, 0, GW_PART_NODES},
                                     {b.words, b.word_count * sizeof *b.words, GL_R32UI, 4, GW_PART_NODES}},
                          .array_count = 2,
                          .voxels = (uint64_t)b.node_count + b.word_count};
    if (code)
        gw_node_form_finish(out);
    return code;
}
