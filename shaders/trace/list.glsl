// Testing the triangles of a leaf.
uint list_cursor; // next reference; where a suspended ray goes on
bool list_ended;

// Tests from list_cursor on until the list or the budget ends.
void test_leaf(uvec2 leaf) {
    bool single = GW_NODE_KIND(leaf.y) == GW_LEAF_SINGLE;
    list_ended = false;
    while (!list_ended && iterations < LOOP_BUDGET) {
        ++iterations;
        COUNT_TEST();
        uint reference = REFERENCE(single ? 0u : list_cursor);
        reference = single ? leaf.x : reference;
        test_triangle(reference & GW_REFERENCE_ID);
        list_ended = single || (reference & GW_REFERENCE_LAST) != 0u;
        ++list_cursor;
    }
}
