// Walking a ray through octree cells. Grid units: g = (p + 1) * 2^(OCTREE_DEPTH - 1), finest cell = 1; the ray is mirrored
// so that no component of its direction is negative; a cell of scale s has side 2^s and is named by any finest cell in it.
// Cells are stepped in integers: the exit axis is set exactly and the others are clamped to the cell, so that every step
// reaches another cell and rounding can never stall or loop.
#include "trace/fetch.glsl"
#include "trace/stack.glsl"
#include "trace/triangle.glsl"

const int GRID_SIDE = 1 << OCTREE_DEPTH;
const float GRID_HALF = float(1 << (OCTREE_DEPTH - 1));

vec3 grid_origin, grid_direction, grid_inverse;
uint mirror;      // bit per axis
ivec3 cell;       // finest cell in which the ray stands
float cell_entry; // t at which it got there
float root_exit;
int scale;      // of the node whose children come next
uint node_word; // that node: link << 8 | valid mask, or its index with WIDE_NODES
bool in_root;

#define SCALE_ABOVE_ROOT (OCTREE_DEPTH + 1)

// link << 8 | valid mask fits 2^24 nodes; larger octrees keep the node's index and fetch it again.
#ifdef WIDE_NODES
uint node_word_of(uint index, uvec2 node) {
    return index;
}
uint child_at(uint word, uint octant, out bool valid) {
    bool above = word == GW_NO_TRIANGLE;
    uvec2 node = NODE(above ? 0u : word);
    uint mask = above ? 0xffu : GW_NODE_VALID(node.y);
    valid = ((mask >> octant) & 1u) != 0u;
    return above ? 0u : node.x + uint(bitCount(mask & ((1u << octant) - 1u)));
}
#define WORD_ABOVE_ROOT GW_NO_TRIANGLE
#else
uint node_word_of(uint index, uvec2 node) {
    return (node.x << 8) | GW_NODE_VALID(node.y);
}
uint child_at(uint word, uint octant, out bool valid) {
    valid = ((word >> octant) & 1u) != 0u;
    return (word >> 8) + uint(bitCount(word & ((1u << octant) - 1u)));
}
// A node above the root whose only child, in the octant that the mirrored ray sees first, is node 0.
#define WORD_ABOVE_ROOT (1u << mirror)
#endif

// Octant of the ray's cell among the children of scale s.
uint octant_at(int s) {
    ivec3 bits = (cell >> s) & 1;
    return uint(bits.x | (bits.y << 1) | (bits.z << 2)) ^ mirror;
}

// With ROOT_GRID_LEVEL the nodes end with a dense grid of the cells of that level, where the walk starts and where it returns to
// instead of to the levels above: render/root_grid.h. It visits the same cells, since empty ones are left as wide as they are. A
// ray to which cells of the grid or above it may stand for their contents needs those levels and walks from the root.
#ifdef ROOT_GRID_SCALE
#ifdef LOD
float most_accepted_error(); // trace/accepted_error.glsl
bool from_grid;
#else
const bool from_grid = true;
#endif
#define SCALE_ABOVE_GRID (17 + ROOT_GRID_SCALE) // its child has the grid's scale in its lower four bits
#define CHILD_SCALE ((scale - 1) & 15)

// Index of the grid's entry of the ray's cell.
uint grid_entry() {
    ivec3 sides = -ivec3(uvec3(mirror, mirror >> 1, mirror >> 2) & 1u) & (GRID_SIDE - 1);
    ivec3 at = (cell ^ sides) >> ROOT_GRID_SCALE;
    return NODES_END - (1u << (3 * ROOT_GRID_LEVEL)) +
           uint((((at.z << ROOT_GRID_LEVEL) | at.y) << ROOT_GRID_LEVEL) | at.x);
}

// Below what no cell of the grid stands for its contents, with some room for rounding.
#ifdef ALWAYS_FROM_GRID
#define LEAST_ABOVE_GRID 1e30 // the naive variant, for the test that shows why
#else
#define LEAST_ABOVE_GRID (0.499 * float(1 << ROOT_GRID_SCALE))
#endif

void restart() {
#ifdef LOD
    from_grid = most_accepted_error() < LEAST_ABOVE_GRID;
#endif
    scale = from_grid ? SCALE_ABOVE_GRID : SCALE_ABOVE_ROOT;
    node_word = from_grid ? 0u : WORD_ABOVE_ROOT;
}

// Scale of the ancestor to return to where cells differ in that bit.
int return_scale(int highest) {
    return from_grid && highest >= ROOT_GRID_SCALE ? SCALE_ABOVE_GRID : highest + 1;
}

// A node whose only child, where the ray stands, is this one of scale s: what is above a leaf that the grid names.
uint word_above(uint index, int s) {
    return (index << 8) | (1u << octant_at(s));
}

void return_to(int s) {
    scale = return_scale(s - 1);
    node_word = stack_pop(scale);
}
// A kernel that reads nodes of another form (bench/) brings its own of these two.
#elif defined(GW_NODE_FORM_DEFINED)
void restart();
void return_to(int s);
#else
#define CHILD_SCALE (scale - 1)
int return_scale(int highest) {
    return highest + 1;
}

void restart() {
    scale = SCALE_ABOVE_ROOT;
    node_word = WORD_ABOVE_ROOT;
}

// To the ancestor whose cell has scale s.
void return_to(int s) {
    scale = s;
    node_word = stack_pop(s);
}
#endif

// Brings the ray to the root cube; false if it never meets it. Components of the direction are clamped away from zero for
// stepping only, relative to the largest, so that divisions stay finite; not-a-number and infinite rays never enter.
bool enter_root(float minimum) {
    vec3 size = abs(ray_direction);
    float largest = max(size.x, max(size.y, size.z));
    bvec3 negative = lessThan(ray_direction, vec3(0.0));
    precise vec3 mirrored = mix(ray_origin, -ray_origin, negative);
    grid_origin = (mirrored + 1.0) * GRID_HALF;
    grid_direction = max(size, vec3(largest * 1e-12)) * GRID_HALF;
    precise vec3 inverse = 1.0 / grid_direction;
    grid_inverse = inverse;
    mirror = uint(negative.x) | (uint(negative.y) << 1) | (uint(negative.z) << 2);

    precise vec3 entries = -grid_origin * grid_inverse;
    precise vec3 exits = (float(GRID_SIDE) - grid_origin) * grid_inverse;
    // Widened by more than the rounding of the two operations above.
    const float widen = 1.0 / 1048576.0;
    float entry = max(entries.x, max(entries.y, entries.z));
    float leave = min(exits.x, min(exits.y, exits.z));
    entry = multiply_add(-abs(entry), widen, entry);
    root_exit = multiply_add(abs(leave), widen, leave);
    cell_entry = max(entry, max(minimum, 0.0));
    vec3 start = multiply_add(grid_direction, vec3(cell_entry), grid_origin);
    cell = ivec3(clamp(start, vec3(0.0), vec3(float(GRID_SIDE - 1))));
    restart();
    in_root = finite(ray_origin) && finite(ray_direction) && largest > 1e-30 && cell_entry <= root_exit;
    return in_root;
}

// t at which the ray leaves its cell of scale s.
float exit_of(int s) {
    ivec3 upper = ((cell >> s) + 1) << s;
    precise vec3 planes = (vec3(upper) - grid_origin) * grid_inverse;
    return min(planes.x, min(planes.y, planes.z));
}

#ifdef HITS_WITHIN_CELLS
bool in_present_cell(float t) {
    return t >= cell_entry && t <= exit_of(scale);
}
#endif

float least_of(vec3 v) {
    float yz = v.z < v.y ? v.z : v.y; // not min(): software GL spends two instructions more on not-a-number
    return yz < v.x ? yz : v.x;
}

// The way out of the cell of scale s: the cell that comes next and t there. The result is the highest bit in which the two
// differ.
int find_way_on(int s, out ivec3 next, out float leave) {
    ivec3 upper = ((cell >> s) + 1) << s;
    precise vec3 planes = (vec3(upper) - grid_origin) * grid_inverse;
    leave = least_of(planes);
    vec3 at = multiply_add(grid_direction, vec3(leave), grid_origin);
    next = mix(min(max(ivec3(at), cell), upper - 1), upper, lessThanEqual(planes, vec3(leave)));
    ivec3 changed = cell ^ next;
    return findMSB(uint(changed.x | changed.y | changed.z));
}

// Leaves the cell of scale s and returns to the smallest common ancestor of it and the next cell.
void advance(int s) {
    ivec3 next;
    float leave;
    int highest = find_way_on(s, next, leave);
    cell = next;
    cell_entry = leave;
    in_root = highest < OCTREE_DEPTH;
    return_to(highest + 1);
}
