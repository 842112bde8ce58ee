// Testing the triangles of a leaf.
uint list_cursor; // where to go on, also after a suspension: next reference, or a place in boxes; 0: at the beginning
bool list_ended;

// Tests the leaf's triangles from list_cursor on until the list or the budget ends.
void test_leaf(uvec2 leaf) {
    bool single = GW_NODE_KIND(leaf.y) == GW_LEAF_SINGLE;
    list_cursor = list_cursor == 0u ? leaf.x : list_cursor;
    list_ended = false;
    while (!list_ended && iterations < LOOP_BUDGET) {
        ++iterations;
        COUNT_TEST();
        uint reference = REFERENCE(single ? 0u : list_cursor);
        reference = single ? leaf.x : reference;
        test_triangle(reference & GW_REFERENCE_ID);
        list_ended = single || (reference & GW_REFERENCE_LAST) != 0u || hit_suffices();
        ++list_cursor;
    }
}

#ifdef DENSE_LEAVES
#include "trace/boxes.glsl"
#endif
