// The traversal that Weier et al. 2014 describe, over the shipped nodes: a span [t_min, t_max] of the ray and three phases,
// down into a child that is not empty, on to the next sibling, up until there is one. t_max is the exit of the cell of scale
// `scale`, computed anew instead of kept on the stack: the same value. The way down follows from t_min alone, so a suspended
// ray finds its leaf again.
// With LEAF_BOUNDS a hit counts only inside its leaf's cell, the paper's rule: what rounding puts into a cell that
// the ray does not visit, or that does not list the triangle, is lost.
//
// variants: OCTREE_DEPTH=11; OCTREE_DEPTH=11 RESUME=1 COUNT=1 LEAF_BOUNDS=1
#include "trace/rays.glsl"
#include "trace/walk.glsl"

bool walking; // false: the nearest hit is known
bool leaving; // the child in which the ray stands is done with

// Sets the cell to the child of scale s in which the ray is at t_min.
void first_child(int s) {
    ivec3 corner = (cell >> (s + 1)) << (s + 1);
    precise vec3 middles = (vec3(corner + (1 << s)) - grid_origin) * grid_inverse;
    cell = corner | (ivec3(lessThanEqual(middles, vec3(cell_entry))) << s);
}

// To the next sibling of the child of scale s; to the parent when there is none.
void leave_child(int s) {
    ivec3 corner = (cell >> s) << s, upper = corner + (1 << s);
    precise vec3 planes = (vec3(upper) - grid_origin) * grid_inverse;
    float leave = min(planes.x, min(planes.y, planes.z));
    in_root = s < OCTREE_DEPTH;
    leaving = !in_root || leave >= exit_of(s + 1);
    if (leaving) {
        scale = s + 2;
        node_word = stack_pop(scale);
    } else {
        cell = mix(corner, upper, lessThanEqual(planes, vec3(leave)));
        cell_entry = leave;
    }
    walking = walking && in_root && hit_t > cell_entry;
}

#ifdef LEAF_BOUNDS
// As test_leaf; the first leaf with a hit inside has the nearest one.
void test_bounded(uvec2 leaf) {
    bool single = GW_NODE_KIND(leaf.y) == GW_LEAF_SINGLE;
    vec3 corner = vec3((cell >> scale) << scale), upper = corner + float(1 << scale);
    list_cursor = list_cursor == 0u ? leaf.x : list_cursor;
    list_ended = false;
    while (!list_ended && iterations < LOOP_BUDGET) {
        ++iterations;
        COUNT_TEST();
        uint reference = REFERENCE(single ? 0u : list_cursor);
        reference = single ? leaf.x : reference;
        float before_t = hit_t;
        uint before = hit_triangle;
        test_triangle(reference & GW_REFERENCE_ID);
        precise vec3 at = grid_origin + grid_direction * hit_t;
        bool inside = all(greaterThanEqual(at, corner)) && all(lessThanEqual(at, upper));
        hit_t = inside ? hit_t : before_t;
        hit_triangle = inside ? hit_triangle : before;
        list_ended = single || (reference & GW_REFERENCE_LAST) != 0u;
        ++list_cursor;
    }
    walking = walking && !(list_ended && hit_triangle != GW_NO_TRIANGLE);
}
#define TEST_LEAF(leaf) test_bounded(leaf)
#else
#define TEST_LEAF(leaf) test_leaf(leaf)
#endif

void traverse() {
    leaving = false;
    while (walking && iterations < LOOP_BUDGET) {
        ++iterations;
        uvec2 leaf = uvec2(0u);
        bool found = false;
        while (walking && !found && iterations < LOOP_BUDGET) {
            ++iterations;
            COUNT_STEP();
            int child_scale = scale - 1;
            bool valid;
            uint index = child_at(node_word, octant_at(child_scale), valid);
            valid = valid && !leaving;
            COUNT_NODE(valid);
            if (valid) {
                leaf = NODE(index);
                scale = child_scale;
                found = GW_NODE_KIND(leaf.y) != GW_KIND_INNER;
                if (!found) {
                    node_word = node_word_of(index, leaf);
                    stack_push(child_scale, node_word);
                    first_child(child_scale - 1);
                }
            } else {
                leave_child(child_scale);
            }
        }
        if (found) {
            TEST_LEAF(leaf);
            if (list_ended) {
                list_cursor = 0u;
                ++scale; // back to the parent, whose word is still at hand
                leaving = true;
                // On at once, so that a ray suspended here does not find the same leaf again.
                while (leaving && in_root) {
                    ++iterations;
                    COUNT_STEP();
                    leave_child(scale - 1);
                }
            }
        }
    }
}
#include "trace/rays_main.glsl"
