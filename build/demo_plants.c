/* Orange trees in pots and ivy on the arcade: tens of thousands of leaves, each of real triangles. */
#include "base/portable_math.h"
#include "build/demo_parts.h"

#include <math.h>

const demo_tree demo_tree_list[DEMO_TREES] = {
    {{1.38, 0.0, -5.6}, 1.0, 1000, 26}, {{-1.5, 0.0, -9.0}, 0.95, 420, 14},
    {{1.5, 0.0, -9.4}, 0.95, 420, 14},  {{-1.5, 0.0, -12.4}, 0.95, 300, 12},
    {{1.5, 0.0, -12.8}, 0.95, 300, 12},
};

enum { LEAVES_PER_TWIG = 15 };
#define GOLDEN_ANGLE 2.39996322972865332

/* A frame to put a leaf in: `along` from stalk to tip, `up` its upper side. */
typedef struct leaf {
    demo_point stalk, along, up;
    double length, width, shade;
} leaf;

static uint32_t leaf_vertex(demo_mesh *mesh, const leaf *f, double across, double along, double lift,
                            double tilt) {
    demo_point side = demo_cross(f->along, f->up);
    demo_vertex vertex = {.u = 0.5 + 0.5 * across, .v = 1.0 - along, .shade = f->shade};
    vertex.position = demo_add(f->stalk, demo_scaled(f->along, along * f->length));
    vertex.position = demo_add(vertex.position, demo_scaled(side, 0.5 * across * f->width));
    vertex.position = demo_add(vertex.position, demo_scaled(f->up, lift * f->length));
    vertex.normal = demo_add(f->up, demo_add(demo_scaled(side, -0.5 * across), demo_scaled(f->along, tilt)));
    return demo_add_vertex(mesh, &vertex);
}

/* A pointed oval, folded along its midrib, its tip hanging: four triangles. */
static void oval_leaf(demo_mesh *mesh, const leaf *f) {
    uint32_t stalk = leaf_vertex(mesh, f, 0.0, 0.0, 0.0, -0.2),
             tip = leaf_vertex(mesh, f, 0.0, 1.0, -0.14, 0.4);
    uint32_t left = leaf_vertex(mesh, f, -1.0, 0.48, 0.09, 0.0),
             right = leaf_vertex(mesh, f, 1.0, 0.48, 0.09, 0.0);
    uint32_t middle = leaf_vertex(mesh, f, 0.0, 0.5, 0.02, 0.1);
    demo_add_triangle(mesh, stalk, right, middle, DEMO_LEAF);
    demo_add_triangle(mesh, stalk, middle, left, DEMO_LEAF);
    demo_add_triangle(mesh, middle, right, tip, DEMO_LEAF);
    demo_add_triangle(mesh, middle, tip, left, DEMO_LEAF);
}

/* Five lobes about the stalk: across and along of the outline. */
static const double ivy_outline[][2] = {{0.0, 0.0}, {0.7, -0.05},  {0.62, 0.3},  {1.0, 0.55},  {0.42, 0.62},
                                        {0.0, 1.0}, {-0.42, 0.62}, {-1.0, 0.55}, {-0.62, 0.3}, {-0.7, -0.05}};

static void ivy_leaf(demo_mesh *mesh, const leaf *f) {
    enum { POINTS = sizeof ivy_outline / sizeof ivy_outline[0] };
    uint32_t centre = leaf_vertex(mesh, f, 0.0, 0.4, 0.05, 0.0), first = 0, before = 0;
    for (int i = 0; i < POINTS; i++) {
        double across = ivy_outline[i][0], along = ivy_outline[i][1];
        uint32_t now = leaf_vertex(mesh, f, across, along, i % 2 == 0 ? 0.02 : -0.05, 0.2 * along);
        if (i > 0)
            demo_add_triangle(mesh, centre, before, now, DEMO_IVY);
        else
            first = now;
        before = now;
    }
    demo_add_triangle(mesh, centre, before, first, DEMO_IVY);
}

/* A unit vector, even over the sphere. */
static demo_point random_direction(uint32_t *state) {
    double y = 2.0 * demo_random(state) - 1.0, turn = 2.0 * GW_PI * demo_random(state), r = sqrt(1.0 - y * y);
    return (demo_point){r * gw_cos(turn), y, r * gw_sin(turn)};
}

static demo_point any_normal(demo_point along) {
    demo_point axis = fabs(along.y) < 0.9 ? (demo_point){0.0, 1.0, 0.0} : (demo_point){1.0, 0.0, 0.0};
    return demo_unit(demo_cross(along, axis));
}

/* The crown: a ball of radius `radius` about centre, somewhat lumpy. */
typedef struct crown {
    demo_point centre;
    double radius, scale;
    uint32_t random;
} crown;

/* How much light comes to a place in the crown: little inside and below. */
static double crown_shade(const crown *c, demo_point p) {
    demo_point d = demo_scaled(demo_subtract(p, c->centre), 1.0 / c->radius);
    double out = sqrt(demo_dot(d, d));
    return (0.22 + 0.78 * demo_smooth(0.45, 1.0, out)) * (0.8 + 0.2 * demo_smooth(-0.8, 0.5, d.y));
}

static double crown_reach(const crown *c, demo_point direction) {
    double lump =
        gw_sin(3.1 * direction.x + 1.0) * gw_sin(2.7 * direction.y + 2.0) * gw_sin(3.7 * direction.z);
    return c->radius * (0.94 + 0.16 * lump);
}

static void twig(demo_mesh *mesh, crown *c) {
    demo_point direction = random_direction(&c->random);
    double reach = crown_reach(c, direction) * (0.72 + 0.28 * sqrt(demo_random(&c->random)));
    demo_point wander = demo_scaled(random_direction(&c->random), 0.55);
    demo_point tip = demo_add(c->centre, demo_scaled(direction, reach));
    demo_point along = demo_unit(demo_add(demo_add(direction, wander), (demo_point){0.0, 0.25, 0.0}));
    double length = 0.24 * c->scale * (0.8 + 0.4 * demo_random(&c->random));
    demo_point points[3] = {demo_subtract(tip, demo_scaled(along, length)),
                            demo_subtract(tip, demo_scaled(along, 0.45 * length)), tip};
    points[1].y -= 0.08 * length;
    const double radii[3] = {0.0035 * c->scale, 0.0026 * c->scale, 0.001 * c->scale};
    demo_tube(mesh, points, radii, 3, 3, 0.6 * crown_shade(c, points[1]), DEMO_BARK);
    demo_point normal = any_normal(along), second = demo_cross(along, normal);
    double start = 2.0 * GW_PI * demo_random(&c->random);
    for (int i = 0; i < LEAVES_PER_TWIG; i++) {
        double t = 0.15 + 0.85 * (i + 0.5) / LEAVES_PER_TWIG, turn = start + GOLDEN_ANGLE * i;
        demo_point at = t < 0.55 ? demo_toward(points[0], points[1], t / 0.55)
                                 : demo_toward(points[1], points[2], (t - 0.55) / 0.45);
        demo_point out = demo_add(demo_scaled(normal, gw_cos(turn)), demo_scaled(second, gw_sin(turn)));
        leaf f = {.stalk = at};
        f.along = demo_unit(demo_add(demo_add(demo_scaled(along, 0.5), out), demo_scaled(direction, 0.3)));
        demo_point up = demo_add((demo_point){0.0, 0.9, 0.0}, demo_scaled(direction, 0.6));
        up = demo_add(up, demo_scaled(random_direction(&c->random), 0.5));
        f.up = demo_unit(demo_subtract(up, demo_scaled(f.along, demo_dot(up, f.along))));
        f.length = (0.062 + 0.03 * demo_random(&c->random)) * c->scale;
        f.width = 0.46 * f.length;
        f.shade = crown_shade(c, at) * (0.8 + 0.2 * demo_random(&c->random));
        oval_leaf(mesh, &f);
    }
}

typedef struct ball {
    demo_point centre;
    double radius, shade;
} ball;

static void ball_surface(const void *context, double u, double v, demo_vertex *out) {
    const ball *b = context;
    double turn = 2.0 * GW_PI * u, rise = GW_PI * (v - 0.5);
    double ring = b->radius * gw_cos(rise);
    out->position =
        (demo_point){b->centre.x + ring * gw_cos(turn), b->centre.y + b->radius * 0.95 * gw_sin(rise),
                     b->centre.z - ring * gw_sin(turn)};
    out->u = u;
    out->v = v;
    out->shade = b->shade * (0.75 + 0.25 * v);
}

/* A ball without its poles' rows of needle triangles: the caps are closed by a fan of the last ring. */
static void orange(demo_mesh *mesh, const ball *b) {
    enum { SIDES = 15, RINGS = 7 };
    uint32_t before = 0;
    demo_vertex vertex;
    for (int ring = 0; ring <= RINGS + 1; ring++) {
        int pole = ring == 0 || ring == RINGS + 1;
        uint32_t now = (uint32_t)mesh->vertex_count;
        for (int side = 0; side <= (pole ? 0 : SIDES); side++) {
            vertex = (demo_vertex){0};
            ball_surface(b, (double)(side % SIDES) / SIDES, (double)ring / (RINGS + 1), &vertex);
            if (pole) {
                vertex.position.x = b->centre.x;
                vertex.position.z = b->centre.z;
            }
            vertex.normal = demo_subtract(vertex.position, b->centre);
            demo_add_vertex(mesh, &vertex);
        }
        for (uint32_t side = 0; ring > 0 && side < SIDES; side++) {
            uint32_t low = ring == 1 ? before : before + side,
                     low_next = ring == 1 ? before : before + side + 1;
            if (ring > 1)
                demo_add_triangle(mesh, low, low_next, pole ? now : now + side, DEMO_ORANGE);
            if (!pole)
                demo_add_triangle(mesh, low_next, now + side + 1, now + side, DEMO_ORANGE);
        }
        before = now;
    }
}

static const demo_profile pot_profile[] = {
    {0.17, 0.0},   {0.2, 0.015}, {0.2, 0.05},   {0.185, 0.065}, {0.185, 0.065}, {0.215, 0.2},  {0.235, 0.33},
    {0.235, 0.33}, {0.25, 0.34}, {0.25, 0.37},  {0.238, 0.38},  {0.238, 0.38},  {0.255, 0.46}, {0.255, 0.46},
    {0.285, 0.47}, {0.29, 0.5},  {0.28, 0.525}, {0.25, 0.525},  {0.245, 0.48}};

static void pot(demo_mesh *mesh, const demo_tree *tree) {
    enum { POINTS = sizeof pot_profile / sizeof pot_profile[0] };
    demo_profile profile[POINTS];
    for (int i = 0; i < POINTS; i++)
        profile[i] = (demo_profile){pot_profile[i].radius * tree->scale, pot_profile[i].height * tree->scale};
    demo_lathe_options options = {
        .sides = 64, .turns = 4.0, .period = 0.4, .shade_low = 0.6, .shade_high = 1.0};
    demo_lathe(mesh, tree->foot, profile, POINTS, &options, DEMO_TERRACOTTA);
    demo_profile soil[2] = {{0.25 * tree->scale, 0.485 * tree->scale}, {0.0, 0.5 * tree->scale}};
    options.shade_low = options.shade_high = 0.6;
    demo_lathe(mesh, tree->foot, soil, 2, &options, DEMO_SOIL);
}

static void trunk(demo_mesh *mesh, const demo_tree *tree, crown *c) {
    demo_point points[6];
    double radii[6];
    for (int i = 0; i < 6; i++) {
        double t = i / 5.0;
        points[i] =
            demo_toward(demo_add(tree->foot, (demo_point){0.0, 0.47 * tree->scale, 0.0}), c->centre, t);
        points[i].x += 0.02 * tree->scale * gw_sin(7.0 * t);
        points[i].z += 0.015 * tree->scale * gw_sin(5.0 * t + 1.0);
        radii[i] = tree->scale * (0.034 - 0.014 * t + 0.02 * (1.0 - t) * (1.0 - t) * (1.0 - t));
    }
    demo_tube(mesh, points, radii, 6, 14, 0.85, DEMO_BARK);
    for (int i = 0; i < 26; i++) { /* boughs */
        demo_point direction = random_direction(&c->random);
        direction.y = fabs(direction.y) - 0.25;
        demo_point end = demo_add(c->centre, demo_scaled(direction, 0.8 * c->radius));
        demo_point start = demo_toward(points[3], points[5], demo_random(&c->random));
        demo_point bend = demo_toward(start, end, 0.5);
        bend.y -= 0.04 * tree->scale;
        const demo_point bough[3] = {start, bend, end};
        const double thick[3] = {0.013 * tree->scale, 0.009 * tree->scale, 0.004 * tree->scale};
        demo_tube(mesh, bough, thick, 3, 6, 0.45, DEMO_BARK);
    }
}

void demo_trees(demo_mesh *mesh) {
    for (int i = 0; i < DEMO_TREES; i++) {
        const demo_tree *tree = &demo_tree_list[i];
        crown c = {
            .radius = 0.58 * tree->scale, .scale = tree->scale, .random = 1000000u * (uint32_t)(i + 1)};
        c.centre = demo_add(tree->foot, (demo_point){0.0, 1.72 * tree->scale, 0.0});
        pot(mesh, tree);
        trunk(mesh, tree, &c);
        for (int k = 0; k < tree->twigs; k++)
            twig(mesh, &c);
        for (int k = 0; k < tree->fruits; k++) {
            demo_point direction = random_direction(&c.random);
            double reach = crown_reach(&c, direction) * (0.97 + 0.05 * demo_random(&c.random));
            ball b = {demo_add(c.centre, demo_scaled(direction, reach)), 0.036 * tree->scale, 0.95};
            orange(mesh, &b);
        }
    }
}

/* Ivy winds up a column of the left arcade and spreads over the arch beside it. */
typedef struct climber {
    demo_point points[64];
    int count;
    uint32_t random;
} climber;

/* Leaves along a stem that clings to a surface: `outward` gives the surface's normal at a point of the stem.
 */
static void clothe(demo_mesh *mesh, climber *c, demo_point (*outward)(demo_point), int leaves_per_step) {
    double radii[64];
    for (int i = 0; i < c->count; i++)
        radii[i] = 0.008 - 0.006 * i / c->count;
    demo_tube(mesh, c->points, radii, c->count, 5, 0.5, DEMO_BARK);
    for (int i = 0; i + 1 < c->count; i++)
        for (int k = 0; k < leaves_per_step; k++) {
            demo_point at = demo_toward(c->points[i], c->points[i + 1], demo_random(&c->random));
            demo_point normal = outward(at), scatter = demo_scaled(random_direction(&c->random), 0.085);
            scatter = demo_subtract(scatter, demo_scaled(normal, demo_dot(scatter, normal)));
            double layer = demo_random(&c->random);
            leaf f = {.stalk = demo_add(demo_add(at, scatter), demo_scaled(normal, 0.01 + 0.06 * layer))};
            demo_point hang =
                demo_add((demo_point){0.0, -1.0, 0.0}, demo_scaled(random_direction(&c->random), 0.6));
            f.up = demo_unit(demo_add(normal, demo_scaled(random_direction(&c->random), 0.45)));
            f.along = demo_unit(demo_subtract(hang, demo_scaled(f.up, demo_dot(hang, f.up))));
            f.length = 0.045 + 0.035 * demo_random(&c->random);
            f.width = f.length * 0.9;
            f.shade = (0.45 + 0.55 * layer) * (0.8 + 0.2 * demo_random(&c->random));
            ivy_leaf(mesh, &f);
        }
}

static const demo_point ivy_column = {-DEMO_ARCADE, 0.0, DEMO_FIRST_COLUMN - DEMO_BAY};

static demo_point from_column(demo_point p) {
    demo_point d = {p.x - ivy_column.x, 0.0, p.z - ivy_column.z};
    return demo_unit(d);
}

static demo_point from_wall(demo_point p) {
    (void)p;
    return (demo_point){1.0, 0.0, 0.0};
}

static void climb_column(demo_mesh *mesh, double start, double turns, uint32_t seed) {
    climber c = {.count = 40, .random = seed};
    for (int i = 0; i < c.count; i++) {
        double t = i / (c.count - 1.0),
               turn = start + 2.0 * GW_PI * turns * t + 0.25 * gw_sin(9.0 * t + start);
        double radius = t < 0.06 ? 0.29 : 0.2 + 0.08 * demo_smooth(0.9, 1.0, t);
        c.points[i] = (demo_point){ivy_column.x + radius * gw_cos(turn), 2.42 * t,
                                   ivy_column.z - radius * gw_sin(turn)};
    }
    clothe(mesh, &c, from_column, 15);
}

/* Over the spandrel from the capital, towards +z or -z (direction), rising and then hanging in a swag. */
static void climb_wall(demo_mesh *mesh, double direction, double reach, double height, uint32_t seed) {
    climber c = {.count = 30, .random = seed};
    double x = -DEMO_ARCADE + DEMO_THICKNESS + 0.012;
    for (int i = 0; i < c.count; i++) {
        double t = i / (c.count - 1.0), wave = 0.06 * gw_sin(11.0 * t + direction);
        double out = x + 0.05 * demo_smooth(0.12, 0.0, t);
        c.points[i] = (demo_point){out, DEMO_SPRING + 0.02 + height * (1.0 - (1.0 - t) * (1.0 - t)) + wave,
                                   ivy_column.z + direction * (0.1 + reach * t * t)};
    }
    clothe(mesh, &c, from_wall, 15);
}

void demo_climbers(demo_mesh *mesh) {
    climb_column(mesh, 5.6, 1.2, 7000000u);
    climb_column(mesh, 0.4, -0.9, 7100000u);
    climb_column(mesh, 2.5, 0.6, 7200000u);
    climb_wall(mesh, 1.0, 0.75, 1.2, 7300000u);
    climb_wall(mesh, -1.0, 0.8, 1.25, 7400000u);
    climb_wall(mesh, -1.0, 0.25, 1.3, 7500000u);
}
