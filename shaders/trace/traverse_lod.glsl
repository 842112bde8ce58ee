// Triangles and voxels along one ray, composited front to back. What is met becomes fragments; shading is another kernel,
// so this loop stays small.
//
// f' = lod_slope * t, in grid units, is decided once per cell, at its entry. An inner cell of side v with f' >= v / 2 stands
// for its contents: its voxel is composited, and below v also each child crossed, with complementary shares (voxel mode,
// which ends where the cell ends). A leaf blends its triangles with its voxel over the same range. A hit belongs to the
// cell in which it lies: one that lies in a cell shown as a voxel is part of that voxel and is dropped with it, also where the
// list of a leaf behind names the triangle again.
// With SHADOW_RAYS nothing is emitted, only composited; the ray ends at ray_maximum, its footprint need not begin at 0, alpha
// is asked at once of alpha_of_hit(). A triangle that is met stops the ray wherever it is met: if its place is shown by a
// voxel, dropping it would let light through where the voxel fills its part of the surface only to the border of its cell.
// Needs trace/walk.glsl, blend/opacity.glsl and common/payload.glsl before it.

bool walking;
int voxel_scale;          // scale of the cell in voxel mode, 0: none
float child_share;        // what its children count
float outer_share;        // that of its parent's children if the parent is in voxel mode, too; else 0
float voxel_given;        // what its own voxel added to the group's opacity
float leaf_share;         // opacity of the triangles of the last leaf
bool leaf_again;          // the leaf ahead has had its voxel composited: only its triangles count now
bool leave_ahead;         // the cell ahead is done with: the next step goes on past it
float ray_maximum;
uint fragment_count;
bool provisional; // the last fragment awaits its alpha

#ifdef SHADOW_RAYS
bool fragments_full() {
    return false;
}
void emit(uint id, float t, float weight) {
}
#else
// An iteration of the outer loop emits a voxel and a triangle at most.
bool fragments_full() {
    return fragment_count + 2u > FRAGMENTS;
}
void emit(uint id, float t, float weight) {
    uint at = (ray_slot * FRAGMENTS + fragment_count) * GW_FRAGMENT_WORDS;
    fragments[at] = id;
    fragments[at + 1u] = floatBitsToUint(t);
    fragments[at + 2u] = floatBitsToUint(weight);
    ++fragment_count;
}
#endif

// Where the ray is at t, from the centre of its cell of scale s, in sides of the cell, mirrored.
vec3 place_in_cell(float t, int s) {
    float side = float(1 << s);
    precise vec3 place = (grid_origin + grid_direction * t - vec3((cell >> s) << s)) * (1.0 / side) - 0.5;
    return place;
}

// Composites the voxel of the cell of scale s in which the ray stands. child: of one that shows it by share. The result is the
// opacity that the group gains.
float emit_voxel(uint index, float share, bool child, int s, float leave) {
    uvec3 payload = PAYLOAD(index);
    vec3 normal = payload_normal(payload);
    normal = mix(normal, -normal, bvec3((mirror & 1u) != 0u, (mirror & 2u) != 0u, (mirror & 4u) != 0u));
    Voxel_opacity voxel = payload_opacity(payload, normal, place_in_cell(cell_entry, s),
                                          place_in_cell(min(leave, ray_maximum), s));
    begin_group_if_apart(cell_entry);
    // What this cell's surface still owes: all that the cells before have not given. Its parent, of which it shows a share,
    // stands for the same place and does not count.
    float before = group_opacity;
    precise float given = before - (child ? voxel_given : 0.0);
#ifdef SLABS_ALONE
    given = 1.0; // the naive variant, for the test that shows why
#endif
    precise float opacity = share * max(voxel.opacity, voxel.owed - given);
    float weight = composite(opacity, voxel.lean, voxel.sheet);
    group_end = max(group_end, leave);
    COUNT_VOXEL();
    if (weight > LEAST_WEIGHT)
        emit(index | GW_FRAGMENT_VOXEL, cell_entry, weight);
    return group_opacity - before;
}

void forget_hit() {
    hit_t = ray_maximum;
    hit_triangle = GW_NO_TRIANGLE;
}

float lean_of_hit() {
    return (hit_triangle & GW_HIT_BACK) == 0u ? 1.0 : -1.0;
}

// The nearest hit is confirmed: it becomes a fragment, and what remains of the ray looks for the next one behind it.
void emit_hit() {
    begin_group_if_apart(hit_t);
    float weight = leaf_share;
#if defined(SHADOW_RAYS) && defined(ALPHA)
    weight = composite(leaf_share * alpha_of_hit(hit_triangle & ~GW_HIT_BACK, hit_t), 0.0, 1.0);
#elif defined(ALPHA)
    provisional = (hit_flags & GW_TRIANGLE_ALPHA) != 0u;
    if (!provisional)
        weight = composite(leaf_share, lean_of_hit(), 1.0);
#else
    weight = composite(leaf_share, lean_of_hit(), 1.0);
#endif
    emit(hit_triangle & ~GW_HIT_BACK, hit_t, weight);
    floor_t = hit_t;
    floor_triangle = hit_triangle;
    forget_hit();
}

uvec2 met_node; // of the cell in which the walk has stopped
uint met_index;

// At the cell ahead. One that holds what lets light through never stands for it: a voxel bends nothing.
float accepted_ahead() {
#if defined(TRANSMISSION) && !defined(VOXELS_ONLY) && !defined(VOXELS_OF_GLASS) // the naive variant, for the test that shows why
    return (met_node.y & GW_NODE_SHEER) != 0u ? 0.0 : accepted_error();
#else
    return accepted_error();
#endif
}

// One step, straight through as in trace/traverse_exact.glsl: down, on, or neither before a cell that is not walked into. True
// there.
bool take_step() {
    int child_scale = CHILD_SCALE;
    bool valid;
    met_index = child_at(node_word, octant_at(child_scale), valid);
#ifdef ROOT_GRID_SCALE
    bool above = scale == SCALE_ABOVE_GRID;
    met_index = above ? grid_entry() : met_index;
    valid = valid || above;
#endif
    valid = valid && !leave_ahead;
    COUNT_NODE(valid);
    met_node = NODE(valid ? met_index : 0u);
    bool coarse = accepted_ahead() >= 0.5 * float(1 << child_scale);
    bool met = valid && (coarse || scale == voxel_scale || GW_NODE_KIND(met_node.y) != GW_KIND_INNER);
    uint below = node_word_of(met_index, met_node);
    ivec3 next;
    float leave;
    int highest = find_way_on(child_scale, next, leave);
    bool stays = highest < OCTREE_DEPTH;
    int back = return_scale(highest);
    uint ancestor = stack_pop(back);
#ifdef ROOT_GRID_SCALE
    child_scale = above ? int(GW_GRID_ENTRY_SCALE(met_node.y)) : child_scale;
    node_word = above ? word_above(met_index, child_scale) : node_word;
    scale = above ? child_scale + 1 : scale;
#endif
    stack_push(valid && !met ? child_scale : 0, below);
    node_word = valid ? (met ? node_word : below) : ancestor;
    scale = valid ? (met ? scale : child_scale) : back;
    cell = valid ? cell : next;
    cell_entry = valid ? cell_entry : leave;
    in_root = valid || stays;
#if defined(SHADOW_RAYS) || defined(REFLECTED)
    in_root = in_root && cell_entry < ray_maximum;
#endif
    bool left = !valid && back > voxel_scale;
    bool still_in_outer = left && outer_share > 0.0 && back == voxel_scale + 1;
    voxel_scale = left ? (still_in_outer ? back : 0) : voxel_scale;
    child_share = still_in_outer ? outer_share : child_share;
    outer_share = left ? 0.0 : outer_share;
    leave_ahead = false; // a step with it went on
    return met;
}

// Leaves, descends and advances to the next occupied cell that is not walked into, or until the nearest hit is due.
bool find_cell() {
    bool met = false;
    while (in_root && !met && (hit_t > cell_entry || leaf_again) && iterations < LOOP_BUDGET) {
        ++iterations;
        COUNT_STEP();
        met = take_step();
    }
    return met;
}

// Composites the voxel of the met cell with its share, then walks into the cell (voxel mode), stays for the triangles of
// a blended leaf, or leaves.
void show_voxel() {
    int child_scale = scale - 1;
    float side = float(1 << child_scale);
    float footprint = accepted_error();
    bool leaf = GW_NODE_KIND(met_node.y) != GW_KIND_INNER;
    bool child_of_voxel = scale == voxel_scale;
    float triangles = leaf && !child_of_voxel ? triangles_share(footprint, side) : 0.0;
    bool separated = (PAYLOAD(met_index).x & GW_PAYLOAD_SEPARATED) != 0u;
    precise float accepted = separated ? SEPARATED_TAU * footprint : footprint;
    // A separated child whose parent is not: its own children come in by the share in which they will stand when the parent is
    // walked into, or they would pop up then.
    bool nested = child_of_voxel && !leaf && separated && outer_share == 0.0;
    float children = leaf || (child_of_voxel && !nested) ? 0.0 : children_share(accepted, side);
    float whole = child_of_voxel ? child_share : 1.0;
    precise float share = whole * (1.0 - max(triangles, children));
    float leave = exit_of(child_scale);
    float added = share > 0.0 ? emit_voxel(met_index, share, child_of_voxel, child_scale, leave) : 0.0;
    voxel_given = (child_of_voxel ? voxel_given : 0.0) + (child_of_voxel && !nested ? 0.0 : added);
    bool walk_in = children >= 1.0 && !child_of_voxel; // nothing of it is shown: its children are decided for themselves
    if (triangles == 0.0 && !walk_in) {
        if (hit_t <= leave)
            forget_hit(); // it is part of the voxel
#ifndef SHADOW_RAYS
        // Nor is it met later, in the list of a leaf behind.
        floor_triangle = leave > floor_t * BESIDE ? GW_NO_TRIANGLE : floor_triangle;
        floor_t = max(floor_t, leave * (1.0 / BESIDE));
#endif
    }
    leaf_again = triangles > 0.0;
    leave_ahead = !leaf_again && children == 0.0;
    if (children > 0.0) {
        outer_share = nested ? child_share : 0.0;
        voxel_scale = walk_in ? 0 : child_scale;
        precise float part = whole * children;
        child_share = part;
        scale = child_scale;
        node_word = node_word_of(met_index, met_node);
        stack_push(child_scale, node_word);
    }
}

// Tests the triangles of the met leaf and leaves it, unless a hit in it is confirmed or the list is unfinished. Returns
// whether a hit is confirmed.
bool test_met_leaf() {
#ifdef DENSE_LEAVES
    if (GW_NODE_KIND(met_node.y) == GW_LEAF_DENSE)
        test_boxes(met_node);
    else
#endif
        test_leaf(met_node);
    list_cursor = list_ended ? 0u : list_cursor;
    bool confirmed = list_ended && hit_triangle != GW_NO_TRIANGLE && (hit_suffices() || hit_t <= exit_of(scale - 1));
    leaf_again = confirmed || !list_ended;
    leave_ahead = !leaf_again;
    return confirmed;
}

void traverse() {
    bool suspend = false;
    provisional = false;
    while (walking && !suspend) {
        ++iterations;
        bool met = find_cell();
        // Due before the next cell; or beyond the last one's exit, by rounding.
        bool hit_due = !met && !leaf_again && hit_triangle != GW_NO_TRIANGLE && (hit_t <= cell_entry || !in_root);
        bool triangles = GW_NODE_KIND(met_node.y) != GW_KIND_INNER && scale != voxel_scale;
        float share = triangles ? triangles_share(accepted_ahead(), float(1 << (scale - 1))) : 0.0;
        bool voxel = met && !leaf_again && share < 1.0;
        // A wall in the face between a leaf and a voxel: the voxel holds nothing of it, and its hit must not be dropped with
        // the voxel for lying in its cell by rounding.
        bool before = voxel && hit_triangle != GW_NO_TRIANGLE && hit_t <= cell_entry * BESIDE;
        hit_due = hit_due || before;
        if (voxel && !before)
            show_voxel();
        if (met && !before && share > 0.0 && remaining() >= OPAQUE_REMAINDER) {
            leaf_share = share;
            hit_due = test_met_leaf();
        }
        if (hit_due)
            emit_hit();
        walking = (in_root || hit_triangle != GW_NO_TRIANGLE) && remaining() >= OPAQUE_REMAINDER;
        suspend = walking && (provisional || fragments_full() || iterations >= LOOP_BUDGET);
    }
}
