// Encodings of the nodes that only the bench traces, declared once for C (wall/node_forms.h) and GLSL.
#ifndef GW_NODE_FORMS_H
#define GW_NODE_FORMS_H

// Node of Weier et al. 2014: bit 31 leaf, bit 30 its mark of the build (0), bits 0-29 first child, or for leaves a triangle
// (below the number of triangles T) or T + a place in the references, where lists of two stand before longer ones.
#define GW_SEED_LEAF 0x80000000u
#define GW_SEED_INDEX 0x3fffffffu
#define GW_SEED_EMPTY 0xbfffffffu

// Leaf word of the short and the wide form: bits 30-31 kind as GW_NODE_KIND, bits 0-29 link.
#define GW_LEAF_WORD_LINK 0x3fffffffu
#define GW_LEAF_WORD_KIND_SHIFT 30

// Short inner node, three words: first inner child, first leaf word, masks as in the shipped node. Inner children and leaves of
// a node are packed apart.

// Wide node, two uvec4: mask of inner children (64 bits), mask of leaf children (64 bits); index of the first inner child,
// of the first leaf word, mask of the eight blocks of 2 x 2 x 2 children that are one leaf, 0. Child i is at x = bits 0-1,
// y = bits 2-3, z = bits 4-5; a block that is one leaf has one bit, that of its lowest child, in the leaf mask.

// Entry of the root grid, uvec2: x as the traversal's node word (link << 8 | valid mask) for an inner node, link for a leaf;
// y scale of the cell in bits 0-7, GW_GRID_PRESENT unless that cell is empty, kind in bits 16-19.
#define GW_GRID_PRESENT 0x100u

#endif
