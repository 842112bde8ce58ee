// Nearest triangle, no voxels: one merged descend-or-advance loop that stops at a leaf, then the leaf's triangles. The
// best hit is kept over all leaves and the walk stops only when it lies before the exit of a cell; a hit is never rejected
// for lying outside its cell, since that is how hits at cell borders get lost.
// Needs trace/walk.glsl before it.

bool walking; // false: the nearest hit is known
#ifdef ALPHA
ivec3 leaf_cell; // the cell before the last step: where the search goes on if the hit turns out to be transparent
float leaf_entry;
#endif

void step_on(int s) {
#ifdef ALPHA
    leaf_cell = cell;
    leaf_entry = cell_entry;
#endif
    advance(s);
    walking = in_root && hit_t > cell_entry;
}

// One step: down into the child in which the ray stands, or on, out of an empty one. True at a leaf, whose cell has the
// scale `scale` then. Kernels that read nodes of another form (bench/) bring their own.
#ifdef GW_NODE_FORM_DEFINED
bool take_step(out uvec2 leaf);
#else
bool take_step(out uvec2 leaf) {
    int child_scale = scale - 1;
    bool valid, found = false;
    uint index = child_at(node_word, octant_at(child_scale), valid);
    COUNT_NODE(valid);
    leaf = uvec2(0u);
    if (valid) {
        uvec2 node = NODE(index);
        scale = child_scale;
        found = GW_NODE_KIND(node.y) != GW_KIND_INNER;
        leaf = node;
        if (!found) {
            node_word = node_word_of(index, node);
            stack_push(child_scale, node_word);
        }
    } else {
        step_on(child_scale);
    }
    return found;
}
#endif

void traverse() {
    while (walking && iterations < LOOP_BUDGET) {
        ++iterations;
        uvec2 leaf = uvec2(0u);
        bool found = false;
        while (walking && !found && iterations < LOOP_BUDGET) {
            ++iterations;
            COUNT_STEP();
            found = take_step(leaf);
        }
        if (found) {
            list_cursor = list_cursor == 0u ? leaf.x : list_cursor;
            test_leaf(leaf);
            if (list_ended) {
                list_cursor = 0u;
                step_on(scale);
            }
        }
    }
}
