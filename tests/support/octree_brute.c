#include "tests/support/octree_brute.h"

#include "base/memory.h"
#include "build/octree_budget.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The builder inflates boxes by 2^-20 and allows for its float products (shaders/build/triangle_box.glsl). A
 * triangle that this test, in double and with twice that margin, finds clear of a cell must not be listed
 * there. */
static const double margin = 2 * 0x1p-20, product_margin = 2 * 0x1p-21;

enum { ISOLATED_AT_MOST = 64 }; /* longer lists are no small isolated thing: docs/octree.md */

typedef struct brute {
    const gw_scene *scene;
    const gw_octree *octree;
    const gw_settings *settings;
    gw_error *error;
    uint32_t *component;       /* [triangle] least triangle that it hangs together with */
    uint32_t *component_count; /* [triangle] triangles of the component of that number */
    float *component_side;     /* [triangle] longest side of its box */
} brute;

/* A cell: its level and integer place. */
typedef struct cell {
    uint32_t level, place[3];
} cell;

/* Triangle ids below a node, rising. */
typedef struct id_list {
    uint32_t *ids;
    size_t count, capacity;
} id_list;

static cell child_of(cell parent, uint32_t octant) {
    cell child = {parent.level + 1, {0, 0, 0}};
    for (uint32_t axis = 0; axis < 3; axis++)
        child.place[axis] = parent.place[axis] * 2 + (octant >> axis & 1u);
    return child;
}

static gw_code wrong(const brute *self, cell where, uint32_t node, const char *what) {
    return gw_fail(self->error, GW_MACHINE,
                   "node %" PRIu32 " (level %" PRIu32 ", cell %" PRIu32 ",%" PRIu32 ",%" PRIu32 ") %s", node,
                   where.level, where.place[0], where.place[1], where.place[2], what);
}

/* --- the overlap of a triangle and a closed box, by separating axes
 * -------------------------------------------------------------------------------------------------------- */

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double sum_of_sizes(const double a[3]) {
    return fabs(a[0]) + fabs(a[1]) + fabs(a[2]);
}

static int apart_on(const double axis[3], double p[3][3], double half, double slack) {
    double a = dot(axis, p[0]), b = dot(axis, p[1]), c = dot(axis, p[2]);
    double reach = half * sum_of_sizes(axis) + slack;
    return fmin(a, fmin(b, c)) > reach || fmax(a, fmax(b, c)) < -reach;
}

/* Thirteen axes: three faces, the triangle's plane, nine products of edges. `inflation` widens the box,
 * `product_slack` the tests on products. On short binary fractions (a lattice) double is exact; elsewhere it
 * is off by some 2^-50, which the builder's own inflation covers, so a triangle that touches by this test
 * must be listed. */
static int touches(const brute *self, uint32_t triangle, cell where, double inflation, double product_slack) {
    double side = ldexp(2, -(int)where.level), half = 0.5 * side + inflation, p[3][3], e[3][3], normal[3],
           reach = 0;
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++) {
            double centre = (where.place[axis] + 0.5) * side - 1;
            p[k][axis] =
                self->scene->positions[(size_t)self->scene->triangles[triangle][k] * 3 + (size_t)axis] -
                centre;
            reach = fmax(reach, fabs(p[k][axis]) + side);
        }
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++)
            e[k][axis] = p[(k + 1) % 3][axis] - p[k][axis];
    for (int axis = 0; axis < 3; axis++) {
        double unit[3] = {axis == 0, axis == 1, axis == 2};
        if (apart_on(unit, p, half, 0))
            return 0;
        for (int k = 0; k < 3; k++) {
            double product[3];
            cross(unit, e[k], product);
            if (apart_on(product, p, half, product_slack * reach * sum_of_sizes(product)))
                return 0;
        }
    }
    cross(e[0], e[1], normal);
    return !apart_on(normal, p, half, product_slack * reach * sum_of_sizes(e[0]) * sum_of_sizes(e[1]));
}

static int must_be_listed(const brute *self, uint32_t triangle, cell where) {
    return touches(self, triangle, where, 0, 0);
}

static int may_be_listed(const brute *self, uint32_t triangle, cell where) {
    return touches(self, triangle, where, margin, product_margin);
}

/* --- the stopping rules
 * -------------------------------------------------------------------------------------------------------- */

static int have_common_vertex(const gw_scene *scene, uint32_t a, uint32_t b) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (scene->welded[scene->triangles[a][i]] == scene->welded[scene->triangles[b][k]])
                return 1;
    return 0;
}

/* Components by spreading the least number until nothing changes. */
static void spread_components(const brute *self) {
    const uint32_t count = self->scene->triangle_count;
    for (uint32_t t = 0; t < count; t++)
        self->component[t] = t;
    for (int changed = 1; changed;) {
        changed = 0;
        for (uint32_t a = 0; a < count; a++)
            for (uint32_t b = 0; b < count; b++)
                if (self->component[b] < self->component[a] && have_common_vertex(self->scene, a, b)) {
                    self->component[a] = self->component[b];
                    changed = 1;
                }
    }
}

/* Triangles and longest side of component c. */
static void measure_component(const brute *self, uint32_t c) {
    float low[3] = {1, 1, 1}, high[3] = {-1, -1, -1}; /* the scene is in [-1,1] */
    for (uint32_t t = 0; t < self->scene->triangle_count; t++) {
        if (self->component[t] != c)
            continue;
        self->component_count[c]++;
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++) {
                float p = self->scene->positions[(size_t)self->scene->triangles[t][k] * 3 + (size_t)axis];
                low[axis] = fminf(low[axis], p);
                high[axis] = fmaxf(high[axis], p);
            }
    }
    for (int axis = 0; axis < 3; axis++)
        self->component_side[c] = fmaxf(self->component_side[c], high[axis] - low[axis]);
}

static gw_code find_components(brute *self) {
    const uint32_t count = self->scene->triangle_count;
    gw_code code = gw_allocate((void **)&self->component, count, sizeof(uint32_t), "components", self->error);
    if (code == GW_OK)
        code =
            gw_allocate((void **)&self->component_count, count, sizeof(uint32_t), "components", self->error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self->component_side, count, sizeof(float), "components", self->error);
    if (code != GW_OK)
        return code;
    spread_components(self);
    for (uint32_t c = 0; c < count; c++)
        if (self->component[c] == c)
            measure_component(self, c);
    return GW_OK;
}

static int share_one_vertex(const gw_scene *scene, const id_list *list) {
    for (int k = 0; k < 3; k++) {
        uint32_t vertex = scene->welded[scene->triangles[list->ids[0]][k]];
        size_t sharing = 0;
        for (size_t i = 0; i < list->count; i++) {
            const uint32_t *corners = scene->triangles[list->ids[i]];
            sharing += scene->welded[corners[0]] == vertex || scene->welded[corners[1]] == vertex ||
                       scene->welded[corners[2]] == vertex;
        }
        if (sharing == list->count)
            return 1;
    }
    return 0;
}

/* Nothing but whole components, each smaller than half the cell. */
static int is_small_isolated_thing(const brute *self, const id_list *list, cell where) {
    if (list->count > ISOLATED_AT_MOST)
        return 0;
    for (size_t i = 0; i < list->count; i++) {
        uint32_t c = self->component[list->ids[i]], found = 0;
        for (size_t j = 0; j < list->count; j++)
            found += self->component[list->ids[j]] == c;
        if (found != self->component_count[c] || !(self->component_side[c] < ldexpf(1, -(int)where.level)))
            return 0;
    }
    return 1;
}

/* What the rules make of a cell with these triangles. */
static int should_be_leaf(const brute *self, const id_list *list, cell where) {
    const gw_settings *s = self->settings;
    int small = list->count <= (size_t)s->leaf_triangles;
    int fan = s->fan_rule && list->count <= (size_t)s->fan_cap && share_one_vertex(self->scene, list);
    if (where.level == 0)
        return 0; /* the root is always an inner node */
    if (where.level == self->octree->depth)
        return 1;
    if (gw_octree_gain(where.level, (uint32_t)list->count) < self->octree->statistics.least_gain)
        return 1; /* the memory budget */
    return (small || fan) && !(s->isolation_rule && is_small_isolated_thing(self, list, where));
}

/* --- the arrays
 * -------------------------------------------------------------------------------------------------------- */

/* Siblings are packed and levels in Morton order exactly when each inner node's children begin where those of
 * the inner node before it end; lists likewise. */
static gw_code check_places(const brute *self) {
    const gw_octree *t = self->octree;
    uint32_t next_reference = 1;
    const cell nowhere = {0, {0, 0, 0}};
    if (t->level_begin[0] != 0 || t->level_begin[1] != 1 || t->level_begin[t->depth + 1] != t->node_count)
        return wrong(self, nowhere, 0, "begins levels that do not fit the nodes");
    for (uint32_t level = 0; level <= t->depth; level++) {
        uint32_t next_child = t->level_begin[level + 1];
        cell here = {level, {0, 0, 0}};
        for (uint32_t i = t->level_begin[level]; i < t->level_begin[level + 1]; i++) {
            gw_node node = t->nodes[i];
            if (GW_NODE_KIND(node.bits) == GW_KIND_INNER) {
                if (node.link != next_child)
                    return wrong(self, here, i, "has children that do not follow those before");
                next_child += (uint32_t)__builtin_popcount(GW_NODE_VALID(node.bits));
            } else if (GW_NODE_KIND(node.bits) != GW_LEAF_SINGLE) {
                if (gw_octree_first_reference(t, &node) != next_reference)
                    return wrong(self, here, i, "has a list that does not follow the one before");
                do
                    if (next_reference >= t->reference_count)
                        return wrong(self, here, i, "has a list that runs out of the array");
                while (!(t->references[next_reference++] & GW_REFERENCE_LAST));
            }
        }
        uint32_t end = level < t->depth ? t->level_begin[level + 2] : t->node_count;
        if (next_child != end)
            return wrong(self, here, t->level_begin[level], "begins a level whose children are too few");
    }
    return next_reference == t->reference_count
               ? GW_OK
               : wrong(self, nowhere, 0, "leaves references that no leaf uses");
}

/* --- contents
 * -------------------------------------------------------------------------------------------------------- */

static gw_code append_id(const brute *self, id_list *list, uint32_t id) {
    gw_code code = gw_grow((void **)&list->ids, &list->capacity, list->count + 1, sizeof *list->ids,
                           "triangle ids", self->error);
    if (code == GW_OK)
        list->ids[list->count++] = id;
    return code;
}

static int compare_ids(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* The union of the lists below: every triangle that the builder handed to the cell reaches some child. */
static void sort_unique(id_list *list) {
    size_t kept = 0;
    if (list->count == 0)
        return;
    qsort(list->ids, list->count, sizeof *list->ids, compare_ids);
    for (size_t i = 0; i < list->count; i++)
        if (kept == 0 || list->ids[kept - 1] != list->ids[i])
            list->ids[kept++] = list->ids[i];
    list->count = kept;
}

static gw_code read_leaf(const brute *self, uint32_t index, cell where, id_list *list) {
    const gw_octree *t = self->octree;
    const gw_node node = t->nodes[index];
    const int single = GW_NODE_KIND(node.bits) == GW_LEAF_SINGLE;
    for (uint32_t i = gw_octree_first_reference(t, &node), last = 0; !last; i++) {
        uint32_t entry = single ? node.link | GW_REFERENCE_LAST : t->references[i];
        uint32_t id = entry & GW_REFERENCE_ID;
        last = entry & GW_REFERENCE_LAST;
        if (id >= self->scene->triangle_count)
            return wrong(self, where, index, "lists a triangle that does not exist");
        if (list->count && id <= list->ids[list->count - 1])
            return wrong(self, where, index, "has a list that does not rise");
        if (append_id(self, list, id) != GW_OK)
            return GW_MACHINE;
    }
    return !single && list->count < 2 ? wrong(self, where, index, "keeps one triangle in a list") : GW_OK;
}

static gw_code check_leaf(const brute *self, uint32_t index, cell where, id_list *list) {
    gw_code code = read_leaf(self, index, where, list);
    size_t next = 0;
    for (uint32_t t = 0; code == GW_OK && t < self->scene->triangle_count; t++) {
        int listed = next < list->count && list->ids[next] == t;
        next += (size_t)listed;
        if (!listed && must_be_listed(self, t, where))
            code = wrong(self, where, index, "misses a triangle that overlaps its cell");
        else if (listed && !may_be_listed(self, t, where))
            code = wrong(self, where, index, "lists a triangle that stays clear of its cell");
    }
    return code;
}

static gw_code check_empty(const brute *self, uint32_t parent, cell where) {
    for (uint32_t t = 0; t < self->scene->triangle_count; t++)
        if (must_be_listed(self, t, where))
            return wrong(self, where, parent, "(its parent) lacks a child that a triangle overlaps");
    return GW_OK;
}

static gw_code check_node(const brute *self, uint32_t index, cell where, id_list *list);

static gw_code check_children(const brute *self, uint32_t index, cell where, id_list *list) {
    const gw_node node = self->octree->nodes[index];
    uint32_t child = node.link;
    gw_code code = GW_OK;
    if (GW_NODE_VALID(node.bits) == 0 || (GW_NODE_LEAVES(node.bits) & ~GW_NODE_VALID(node.bits)))
        return wrong(self, where, index, "has child masks that contradict each other");
    for (uint32_t octant = 0; code == GW_OK && octant < 8; octant++) {
        cell below = child_of(where, octant);
        id_list part = {0};
        if (!(GW_NODE_VALID(node.bits) >> octant & 1u)) {
            code = check_empty(self, index, below);
            continue;
        }
        int is_leaf = GW_NODE_KIND(self->octree->nodes[child].bits) != GW_KIND_INNER;
        if (is_leaf != (int)(GW_NODE_LEAVES(node.bits) >> octant & 1u))
            return wrong(self, where, index, "says leaf of an inner child, or the other way round");
        code = check_node(self, child, below, &part);
        for (size_t i = 0; code == GW_OK && i < part.count; i++)
            code = append_id(self, list, part.ids[i]);
        free(part.ids);
        child++;
    }
    sort_unique(list);
    return code;
}

static gw_code check_node(const brute *self, uint32_t index, cell where, id_list *list) {
    const uint32_t kind = GW_NODE_KIND(self->octree->nodes[index].bits);
    gw_code code;
    if (kind == GW_KIND_INNER && where.level < self->octree->depth)
        code = check_children(self, index, where, list);
    else if (kind == GW_LEAF_LIST || kind == GW_LEAF_SINGLE || kind == GW_LEAF_DENSE)
        code = check_leaf(self, index, where, list);
    else
        code = wrong(self, where, index, "has a kind that does not belong there");
    if (code != GW_OK)
        return code;
    if (kind == GW_KIND_INNER && should_be_leaf(self, list, where))
        return wrong(self, where, index, "is refined without need");
    if (kind != GW_KIND_INNER && !should_be_leaf(self, list, where))
        return wrong(self, where, index, "is a leaf against the rules");
    return GW_OK;
}

gw_code gw_brute_check_octree(const gw_scene *scene, const gw_octree *octree, const gw_settings *settings,
                              gw_error *error) {
    brute self = {.scene = scene, .octree = octree, .settings = settings, .error = error};
    const cell root = {0, {0, 0, 0}};
    id_list all = {0};
    gw_code code = find_components(&self);
    if (code == GW_OK)
        code = check_places(&self);
    if (code == GW_OK)
        code = check_node(&self, 0, root, &all);
    free(all.ids);
    free(self.component);
    free(self.component_count);
    free(self.component_side);
    return code;
}
