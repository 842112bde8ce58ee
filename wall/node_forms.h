/* Other forms of a finished octree's nodes, made on the host and traced by shaders/bench only: to be measured
 * against the shipped form (`gazewall bench layouts`). They list the same triangles in the same cells, so
 * every ray must meet the same hit. Encodings: shaders/bench/node_forms.h. Plain host code; a form owns its
 * arrays.
 */
#ifndef GW_WALL_NODE_FORMS_H
#define GW_WALL_NODE_FORMS_H

#include "base/status.h"
#include "build/octree.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_FORM_ARRAYS = 3 };

typedef enum gw_form_part { GW_PART_NODES, GW_PART_REFERENCES, GW_PART_GRID } gw_form_part;

/* An array that the form's kernel reads through a buffer texture. */
typedef struct gw_form_array {
    void *data;
    size_t bytes;
    uint32_t format; /* of the buffer texture: GL_RG32UI, ... */
    uint32_t unit;   /* texture unit */
    gw_form_part part;
} gw_form_array;

typedef struct gw_node_form {
    gw_form_array arrays[GW_FORM_ARRAYS];
    uint32_t array_count;
    uint64_t voxels; /* nodes of the octree whose voxel this form can address */
} gw_node_form;

/* The node of Weier et al. 2014. single_inline 0: a lone triangle is a list of one, instead of standing in
 * the leaf. GW_MACHINE when the octree does not fit its 30 bits. */
gw_code gw_form_seed64(const gw_octree *octree, uint32_t triangles, int single_inline, gw_node_form *out,
                       gw_error *error);
/* Inner nodes of 12 bytes; leaves are words in an array of their own. */
gw_code gw_form_short(const gw_octree *octree, gw_node_form *out, gw_error *error);
/* Nodes of 4 x 4 x 4 children; leaves are words in an array of their own. With a limit of odd depth the top
 * node uses eight of its children only. */
gw_code gw_form_wide(const gw_octree *octree, gw_node_form *out, gw_error *error);
/* A grid over the cells of one level, 1 to depth - 1, to stand above the shipped nodes, which it does not
 * hold. GW_MACHINE for more than 2^24 nodes. */
gw_code gw_form_root_grid(const gw_octree *octree, uint32_t level, gw_node_form *out, gw_error *error);
void gw_node_form_finish(gw_node_form *form);

/* A leaf in one word, and whether all leaves of an octree fit one. */
uint32_t gw_form_leaf_word(const gw_node *leaf);
gw_code gw_form_check_leaf_words(const gw_octree *octree, gw_error *error);

#endif
