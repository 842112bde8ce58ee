// Walking the boxes over the list of a dense leaf (build/octree_dense.c): depth first, by links, without a stack. The cursor
// is box * 8 + k: k = 0, the box is to be tested; else its k-th triangle is.

uint box_link, box_triangles; // of the box whose triangles are tested

// Whether the ray may hit something in the box: never no where the triangle test could say yes. Boxes are wider than their
// triangles by the test's rounding relative to the triangle; what grows with the distance along the ray is added here. Depths
// are compared on the axis on which the test bounds its t.
bool meets_box(vec3 low, vec3 high) {
    bvec3 negative = notEqual(uvec3(mirror) & uvec3(1u, 2u, 4u), uvec3(0u));
    vec3 inverse = mix(grid_inverse, -grid_inverse, negative) * GRID_HALF;
    vec3 entries = (mix(low, high, negative) - ray_origin) * inverse;
    vec3 exits = (mix(high, low, negative) - ray_origin) * inverse;
    const float widen = 1.0 / 1048576.0;
    entries = multiply_add(-abs(entries), vec3(widen), entries);
    exits = multiply_add(abs(exits), vec3(widen), exits);
    return max(entries.x, max(entries.y, entries.z)) <= min(exits.x, min(exits.y, exits.z)) &&
           along_shear(entries).z <= hit_t && along_shear(exits).z >= floor_t;
}

// Goes on to the next triangle of a box that the ray meets; list_ended if there is none.
void find_triangle() {
    while (!list_ended && (list_cursor & 7u) == 0u && iterations < LOOP_BUDGET) {
        ++iterations;
        COUNT_STEP();
        COUNT_NODE(true);
        uint box = list_cursor >> 3;
        uvec4 first = BOX(box, 0);
        uvec4 second = BOX(box, 1);
        bool met = meets_box(uintBitsToFloat(first.xyz), uintBitsToFloat(second.xyz));
        bool lowest = GW_BOX_TRIANGLES(second.w) != 0u;
        box_link = first.w;
        box_triangles = second.w;
        uint next = met || lowest ? box + 1u : first.w;
        list_cursor = met && lowest ? list_cursor + 1u : next << 3;
        list_ended = !met && (lowest ? (second.w & GW_BOX_LAST) != 0u : first.w == 0u);
    }
}

// As test_leaf, for a dense one.
void test_boxes(uvec2 leaf) {
    list_cursor = list_cursor == 0u ? leaf.x << 3 : list_cursor;
    list_ended = false;
    box_link = BOX(list_cursor >> 3, 0).w;
    box_triangles = BOX(list_cursor >> 3, 1).w;
    while (!list_ended && iterations < LOOP_BUDGET) {
        ++iterations;
        find_triangle();
        uint k = list_cursor & 7u;
        if (!list_ended && k != 0u) {
            COUNT_TEST();
            uint reference = REFERENCE(box_link + k - 1u);
            test_triangle(reference & GW_REFERENCE_ID);
            list_ended = (reference & GW_REFERENCE_LAST) != 0u || hit_suffices();
            list_cursor = k < GW_BOX_TRIANGLES(box_triangles) ? list_cursor + 1u : (list_cursor | 7u) + 1u;
        }
    }
}
