// Nearest triangle, no voxels: one merged descend-or-advance loop that stops at a leaf, then the leaf's triangles. The
// best hit is kept over all leaves and the walk stops only when it lies before the exit of a cell; a hit is never rejected
// for lying outside its cell, since that is how hits at cell borders get lost.
// With ANY_HIT, defined before trace/walk.glsl, any hit between floor_t and the first hit_t will do, as for shadows: the
// walk ends with the first triangle met. One that masks or blends (ALPHA) is left to be asked, nearest first.
// With UNTIL_COARSE the walk also ends before the first cell that stands for its contents at the ray's footprint: the ray's
// state then is one of trace/traverse_lod.glsl, which goes on with it and meets what it would have met alone.
// Needs trace/walk.glsl before it.

bool walking; // false: the nearest hit is known
#ifdef ALPHA
ivec3 leaf_cell; // the cell before the last step: where the search goes on if the hit turns out to be transparent
float leaf_entry;
int leaf_parent_scale;
#endif
#ifdef UNTIL_COARSE
bool coarse_ahead;
// The rest of the state that the other kernel goes on from.
const int voxel_scale = 0;
const float child_share = 0.0;
const float outer_share = 0.0;
const float voxel_given = 0.0;
const float leaf_share = 1.0;
const bool leave_ahead = false;
bool leaf_again;
#endif

void step_on(int s) {
#ifdef ALPHA
    leaf_cell = cell;
    leaf_entry = cell_entry;
    leaf_parent_scale = s + 1;
#endif
    advance(s);
    walking = in_root && hit_t > cell_entry && !hit_suffices();
}

// One step: down into the child in which the ray stands, or on, out of an empty one. True at a leaf or a coarse cell, which
// has the scale `scale` then. Kernels that read nodes of another form (bench/) bring their own.
#ifdef GW_NODE_FORM_DEFINED
bool take_step(out uvec2 leaf);
#else
// Straight through, both ways worked out and one selected: software GL executes both sides of a branch anyway, masks what
// either writes, and would let the way on wait for the node that only the way down needs.
bool take_step(out uvec2 leaf) {
    int child_scale = CHILD_SCALE;
    bool valid;
    uint index = child_at(node_word, octant_at(child_scale), valid);
#ifdef ROOT_GRID_SCALE
    bool above = scale == SCALE_ABOVE_GRID;
    index = above ? grid_entry() : index;
    valid = valid || above;
#endif
    COUNT_NODE(valid);
    uvec2 node = NODE(valid ? index : 0u);
    uint below = node_word_of(index, node);
    bool found = valid && GW_NODE_KIND(node.y) != GW_KIND_INNER;
#ifdef UNTIL_COARSE
    coarse_ahead = valid && accepted_error() >= 0.5 * float(1 << child_scale);
    found = found || coarse_ahead;
#endif
    ivec3 next;
    float leave;
    int highest = find_way_on(child_scale, next, leave);
    bool stays = highest < OCTREE_DEPTH;
    int back = return_scale(highest);
    uint ancestor = stack_pop(back);
#ifdef ROOT_GRID_SCALE
    child_scale = above ? int(GW_GRID_ENTRY_SCALE(node.y)) : child_scale;
#endif
    stack_push(valid && !found ? child_scale : 0, below);
    node_word = valid ? (found ? node_word : below) : ancestor;
    scale = valid ? child_scale : back;
#ifdef ALPHA
    leaf_cell = valid ? leaf_cell : cell;
    leaf_entry = valid ? leaf_entry : cell_entry;
    leaf_parent_scale = valid ? leaf_parent_scale : child_scale + 1;
#endif
    in_root = valid || stays;
    walking = valid || (stays && hit_t > leave);
    cell = valid ? cell : next;
    cell_entry = valid ? cell_entry : leave;
    leaf = node;
    return found;
}
#endif

uvec2 leaf_ahead; // the one that the walk stands in
bool dense_ahead; // it has boxes

// After the leaf's test: the next cell, unless the budget has ended the list.
void leave_leaf() {
    if (list_ended) {
        list_cursor = 0u;
        step_on(scale);
    }
}

// Through cells and plain lists, to the end or to a dense leaf.
void walk() {
    dense_ahead = false;
    while (walking && !dense_ahead && iterations < LOOP_BUDGET) {
        ++iterations;
        leaf_ahead = uvec2(0u);
        bool found = false;
        while (walking && !found && iterations < LOOP_BUDGET) {
            ++iterations;
            COUNT_STEP();
            found = take_step(leaf_ahead);
        }
#ifdef DENSE_LEAVES
        dense_ahead = found && GW_NODE_KIND(leaf_ahead.y) == GW_LEAF_DENSE;
#endif
#ifdef UNTIL_COARSE
        walking = walking && !coarse_ahead;
        dense_ahead = dense_ahead && !coarse_ahead;
        found = found && !coarse_ahead;
#endif
        if (found && !dense_ahead) {
            test_leaf(leaf_ahead);
            leave_leaf();
        }
    }
}

#ifdef DENSE_LEAVES
// Dense leaves are few: their boxes are walked out here, where software GL, which executes what no lane needs, passes once
// for each of them and not once for each list.
void traverse() {
    while (walking && iterations < LOOP_BUDGET) {
        ++iterations;
        walk();
        if (dense_ahead) {
            test_boxes(leaf_ahead);
            leave_leaf();
        }
    }
}
#else
void traverse() {
    walk();
}
#endif
