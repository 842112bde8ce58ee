/* Inner nodes apart from leaves, see node_forms.h. */
#include "wall/node_forms.h"

#include "base/memory.h"
#include "shaders/bench/node_forms.h"

#include <epoxy/gl.h>
#include <stdlib.h>

typedef struct short_node {
    uint32_t first, words, masks; /* first inner child, first leaf word, masks of the shipped node */
} short_node;

uint32_t gw_form_leaf_word(const gw_node *leaf) {
    return leaf->link | GW_NODE_KIND(leaf->bits) << GW_LEAF_WORD_KIND_SHIFT;
}

gw_code gw_form_check_leaf_words(const gw_octree *octree, gw_error *error) {
    for (uint32_t i = 0; i < octree->node_count; i++) {
        const gw_node *node = &octree->nodes[i];
        uint32_t kind = GW_NODE_KIND(node->bits);
        if (kind != GW_KIND_INNER && (node->link > GW_LEAF_WORD_LINK || kind > 3))
            return gw_fail(error, GW_MACHINE,
                           "a leaf word holds 30 bits of link and three kinds; node %u has %u, %u", i,
                           node->link, kind);
    }
    return GW_OK;
}

/* Both arrays keep the octree's order, so places are counts. */
static void fill_short(const gw_octree *octree, short_node *nodes, uint32_t *words) {
    uint32_t inner = 0, leaves = 0, next_inner = 1, next_leaf = 0;
    for (uint32_t i = 0; i < octree->node_count; i++) {
        const gw_node *node = &octree->nodes[i];
        if (GW_NODE_KIND(node->bits) != GW_KIND_INNER) {
            words[leaves++] = gw_form_leaf_word(node);
            continue;
        }
        uint32_t leaf_children = (uint32_t)__builtin_popcount(GW_NODE_LEAVES(node->bits));
        nodes[inner++] = (short_node){next_inner, next_leaf, node->bits & 0xffffu};
        next_inner += (uint32_t)__builtin_popcount(GW_NODE_VALID(node->bits)) - leaf_children;
        next_leaf += leaf_children;
    }
}

gw_code gw_form_short(const gw_octree *octree, gw_node_form *out, gw_error *error) {
    short_node *nodes = NULL;
    uint32_t *words = NULL, inner = 0;
    for (uint32_t i = 0; i < octree->node_count; i++)
        inner += GW_NODE_KIND(octree->nodes[i].bits) == GW_KIND_INNER;
    uint32_t leaves = octree->node_count - inner;
    gw_code code = gw_form_check_leaf_words(octree, error);
    if (!code)
        code = gw_allocate((void **)&nodes, inner, sizeof *nodes, "short nodes", error);
    if (!code)
        code = gw_allocate((void **)&words, leaves, sizeof *words, "leaf words", error);
    if (!code)
        fill_short(octree, nodes, words);
    *out = (gw_node_form){.arrays = {{nodes, inner * sizeof *nodes, GL_RGB32UI, 0, GW_PART_NODES},
                                     {words, leaves * sizeof *words, GL_R32UI, 4, GW_PART_NODES}},
                          .array_count = 2,
                          .voxels = octree->node_count};
    if (code)
        gw_node_form_finish(out);
    return code;
}
