/* The hall of the demo scene: large flat triangles. A nave with arcades of five bays under a coffered barrel
 * vault, aisles with windows, and an end wall with a great window. */
#include "base/portable_math.h"
#include "build/demo_parts.h"

#include <math.h>
#include <string.h>

enum { ARCH_STEPS = 24 };
#define FLOOR_PERIOD 1.25 /* m */

/* A wall standing on a line: point (s, y) of its front is origin + s * along + y up; depth is its thickness.
 */
typedef struct wall {
    demo_point origin, along, normal; /* along x up = normal */
    double depth, period;
    demo_material front, inside;
    demo_shader shade;
} wall;

/* An opening of one bay from s0 to s1 and y0 to y1: jambs at centre -/+ half_width from sill to spring, then
 * a half circle. */
typedef struct bay {
    double s0, s1, y0, y1, centre, half_width, sill, spring;
} bay;

static demo_point wall_point(const wall *w, double s, double y, double deep) {
    demo_point p = demo_add(w->origin, demo_scaled(w->along, s));
    p = demo_subtract(p, demo_scaled(w->normal, deep));
    p.y += y;
    return p;
}

/* One flat piece of the front and, where the wall has one, of its back; corners counter-clockwise. */
static void wall_piece(demo_mesh *mesh, const wall *w, const double corners[4][2]) {
    for (int side = 0; side < 2; side++) {
        uint32_t index[4];
        for (int i = 0; i < 4; i++) {
            const double *at = corners[side == 0 ? i : 3 - i];
            demo_vertex vertex = {.normal = demo_scaled(w->normal, side == 0 ? 1.0 : -1.0)};
            vertex.position = wall_point(w, at[0], at[1], side == 0 ? 0.0 : w->depth);
            vertex.u = at[0] / w->period;
            vertex.v = -at[1] / w->period;
            vertex.shade = w->shade(vertex.position);
            index[i] = demo_add_vertex(mesh, &vertex);
        }
        demo_add_triangle(mesh, index[0], index[1], index[2], w->front);
        demo_add_triangle(mesh, index[0], index[2], index[3], w->front);
    }
}

static void wall_rectangle(demo_mesh *mesh, const wall *w, double s0, double s1, double y0, double y1) {
    if (s1 > s0 && y1 > y0)
        wall_piece(mesh, w, (const double[4][2]){{s0, y0}, {s1, y0}, {s1, y1}, {s0, y1}});
}

/* Point i of the opening's outline, from the right jamb's foot over the arch to the left jamb's foot; its
 * inward normal. */
static void outline_point(const bay *b, int i, double at[2], double inward[2]) {
    double turn = GW_PI * demo_clamp(i - 1, 0, ARCH_STEPS) / ARCH_STEPS;
    inward[0] = -gw_cos(turn);
    inward[1] = -gw_sin(turn);
    at[0] = b->centre - b->half_width * inward[0];
    at[1] = i == 0 || i == ARCH_STEPS + 2 ? b->sill : b->spring - b->half_width * inward[1];
}

/* Front and back vertex of the opening's inner surface at a point of its outline; the normal is up + side *
 * along. */
static void add_reveal_edge(demo_mesh *mesh, const wall *w, const double at[2], demo_point up, double side,
                            uint32_t edge[2]) {
    for (int back = 0; back < 2; back++) {
        demo_vertex vertex = {.shade = back ? 0.55 : 0.75,
                              .normal = demo_add(up, demo_scaled(w->along, side))};
        vertex.position = wall_point(w, at[0], at[1], back ? w->depth : 0.0);
        vertex.u = (back ? w->depth : 0.0) / w->period;
        vertex.v = (at[0] + at[1]) / w->period;
        edge[back] = demo_add_vertex(mesh, &vertex);
    }
}

static void add_reveal(demo_mesh *mesh, const wall *w, const uint32_t before[2], const uint32_t now[2]) {
    demo_add_triangle(mesh, before[0], now[0], now[1], w->inside);
    demo_add_triangle(mesh, before[0], now[1], before[1], w->inside);
}

static void wall_bay(demo_mesh *mesh, const wall *w, const bay *b) {
    double left = b->centre - b->half_width, right = b->centre + b->half_width;
    const double s[4] = {b->s0, left, right, b->s1}, y[4] = {b->y0, b->sill, b->spring, b->y1};
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++)
            if (column != 1 || row == 0)
                wall_rectangle(mesh, w, s[column], s[column + 1], y[row], y[row + 1]);

    int jambs = b->spring > b->sill; /* else the arch stands on nothing and there is no sill */
    uint32_t before[2] = {0, 0}, start[2] = {0, 0};
    double last[2] = {0.0, 0.0}, at[2], inward[2];
    for (int i = jambs ? 0 : 1; i <= ARCH_STEPS + (jambs ? 2 : 1); i++) {
        outline_point(b, i, at, inward);
        uint32_t now[2];
        add_reveal_edge(mesh, w, at, (demo_point){0.0, inward[1], 0.0}, inward[0], now);
        if (start[0] != start[1])
            add_reveal(mesh, w, before, now);
        else
            memcpy(start, now, sizeof start);
        if (i > 1 && i < ARCH_STEPS + 2) /* what is left of the wall above this step of the arch */
            wall_piece(
                mesh, w,
                (const double[4][2]){{at[0], at[1]}, {last[0], last[1]}, {last[0], b->y1}, {at[0], b->y1}});
        memcpy(before, now, sizeof before);
        memcpy(last, at, sizeof last);
    }
    if (jambs) {
        uint32_t sill[2][2];
        for (int end = 0; end < 2; end++)
            add_reveal_edge(mesh, w, (const double[2]){end == 0 ? left : right, b->sill},
                            (demo_point){0.0, 1.0, 0.0}, 0.0, sill[end]);
        add_reveal(mesh, w, sill[0], sill[1]);
    }
}

/* The moulding around an arch: a ring of two swellings before the wall. */
typedef struct moulding {
    const wall *wall;
    double centre, spring, radius, width, swell;
} moulding;

static void moulding_surface(const void *context, double u, double v, demo_vertex *out) {
    const moulding *m = context;
    double turn = GW_PI * (1.0 - u),
           radius = m->radius + m->width * v; /* from the left, so that the front is out */
    double wave = gw_sin(2.0 * GW_PI * v);
    double out_of_wall = m->swell * ((wave < 0.0 ? -0.7 * wave : wave) + (v > 0.0 && v < 1.0 ? 0.25 : 0.0));
    out->position = wall_point(m->wall, m->centre + radius * gw_cos(turn), m->spring + radius * gw_sin(turn),
                               -out_of_wall);
    out->u = 3.0 * u;
    out->v = 0.25 * v;
    out->shade = 0.95;
}

static void archivolt(demo_mesh *mesh, const wall *w, const bay *b, double width, double swell) {
    const moulding m = {w, b->centre, b->spring, b->half_width, width, swell};
    demo_grid(mesh, 32, 12, 0, 0, moulding_surface, &m, DEMO_MARBLE);
}

/* The blocks from which a moulding springs. */
static void imposts(demo_mesh *mesh, const wall *w, const bay *b, double width) {
    for (double side = -1.0; side <= 1.0; side += 2.0) {
        demo_point p =
            wall_point(w, b->centre + side * (b->half_width - 0.015), b->spring - 0.09, -0.5 * width);
        demo_point q = wall_point(w, b->centre + side * (b->half_width + width + 0.02), b->spring, 0.02);
        demo_box(mesh, (demo_point){fmin(p.x, q.x), p.y, fmin(p.z, q.z)},
                 (demo_point){fmax(p.x, q.x), q.y, fmax(p.z, q.z)}, 1.0, NULL, DEMO_MARBLE);
    }
}

/* Bars of a window: uprights and cross-bars as thin boxes, the fine structure that voxels must not lose. */
static void window_bars(demo_mesh *mesh, const wall *w, const bay *b, int uprights, int crossbars) {
    const double thick = 0.018;
    double deep = 0.5 * w->depth;
    for (int i = 1; i <= uprights; i++) {
        double s = b->centre + b->half_width * (2.0 * i / (uprights + 1) - 1.0);
        double x = (s - b->centre) / b->half_width, top = b->spring + b->half_width * sqrt(1.0 - x * x);
        demo_point p = wall_point(w, s, b->sill, deep), q = wall_point(w, s, top, deep);
        demo_box(mesh, (demo_point){p.x - thick, p.y, p.z - thick},
                 (demo_point){q.x + thick, q.y, q.z + thick}, 0.5, NULL, DEMO_WOOD);
    }
    for (int i = 1; i <= crossbars; i++) {
        double y = b->sill + (b->spring - b->sill) * i / crossbars;
        demo_point p = wall_point(w, b->centre - b->half_width, y, deep);
        demo_point q = wall_point(w, b->centre + b->half_width, y, deep);
        demo_point low = {fmin(p.x, q.x) - thick, y - thick, fmin(p.z, q.z) - thick};
        demo_point high = {fmax(p.x, q.x) + thick, y + thick, fmax(p.z, q.z) + thick};
        demo_box(mesh, low, high, 0.5, NULL, DEMO_WOOD);
    }
}

/* How dark a floor point is at `distance` outside the edge of something that stands on it. */
static double contact(double distance, double reach, double strength) {
    double d = distance > 0.0 ? distance / reach : 0.0;
    return 1.0 - strength / (1.0 + d * d);
}

static double floor_shade(demo_point p) {
    double shade = contact(4.3 - fabs(p.x), 0.5, 0.45) * contact(p.z - DEMO_FAR, 0.4, 0.4);
    for (int i = 0; i <= DEMO_BAYS; i++) {
        double x = fabs(p.x) - DEMO_ARCADE, z = p.z - (DEMO_FIRST_COLUMN - DEMO_BAY * i);
        shade *= contact(sqrt(x * x + z * z) - 0.26, 0.2, 0.6);
    }
    for (int i = 0; i < DEMO_TREES; i++) {
        demo_point d = demo_subtract(p, demo_tree_list[i].foot);
        double distance = sqrt(d.x * d.x + d.z * d.z), scale = demo_tree_list[i].scale;
        shade *= contact(distance - 0.24 * scale, 0.14, 0.65) * contact(distance - 0.5 * scale, 0.5, 0.3);
    }
    demo_point d = demo_subtract(p, demo_statue_foot);
    shade *= contact(fmax(fabs(d.x), fabs(d.z)) - 0.36, 0.18, 0.65);
    return shade * (fabs(p.x) > DEMO_ARCADE ? 0.85 : 1.0);
}

/* Walls darken towards the floor and into their upper corners. */
static double nave_wall_shade(demo_point p) {
    return 1.0 - 0.35 * demo_smooth(DEMO_CORNICE - 0.35, DEMO_CORNICE, p.y) -
           0.12 * demo_smooth(2.9, 2.4, p.y);
}

static double aisle_wall_shade(demo_point p) {
    return (0.55 + 0.4 * demo_smooth(0.0, 1.0, p.y)) * (1.0 - 0.45 * demo_smooth(2.8, 3.9, p.y));
}

static double end_wall_shade(demo_point p) {
    return 1.0 - 0.3 * demo_smooth(1.6, 2.3, fabs(p.x)) - 0.2 * demo_smooth(4.6, 6.4, p.y);
}

static double ceiling_shade(demo_point p) {
    (void)p;
    return 0.55;
}

/* Steps: the foot of each riser is darker than its edge. */
static double step_shade(demo_point p) {
    double edge = 0.15 * (1.0 + (-14.2 - p.z) / 0.4); /* height of the tread that ends here */
    return p.y > edge - 0.01 ? 0.95 : 0.45;
}

/* One side of the nave; side is -1 for the left, 1 for the right. */
static void arcade(demo_mesh *mesh, double side) {
    demo_point along = {0.0, 0.0, side}; /* along x up = normal: towards the nave */
    wall w = {.origin = {side * (DEMO_ARCADE - DEMO_THICKNESS), 0.0, 0.0},
              .along = along,
              .normal = {-side, 0.0, 0.0}};
    w.depth = 2.0 * DEMO_THICKNESS;
    w.period = 1.25;
    w.front = DEMO_ASHLAR;
    w.inside = DEMO_PLASTER;
    w.shade = nave_wall_shade;
    double first = DEMO_FIRST_COLUMN;
    for (int i = 0; i < DEMO_BAYS; i++) {
        double za = first - DEMO_BAY * i, zb = za - DEMO_BAY;
        bay b = {.s0 = side > 0 ? zb : -za,
                 .y0 = DEMO_SPRING,
                 .y1 = DEMO_CORNICE,
                 .half_width = 0.5 * DEMO_BAY - 0.22};
        b.s1 = b.s0 + DEMO_BAY;
        b.centre = 0.5 * (b.s0 + b.s1);
        b.sill = b.spring = DEMO_SPRING;
        wall_bay(mesh, &w, &b);
        archivolt(mesh, &w, &b, 0.17, 0.05);
    }
    double last = first - DEMO_BAY * DEMO_BAYS;
    const double ends[2][2] = {{first, DEMO_NEAR}, {DEMO_FAR, last}};
    for (int i = 0; i < 2; i++)
        wall_rectangle(mesh, &w, side > 0 ? ends[i][0] : -ends[i][1], side > 0 ? ends[i][1] : -ends[i][0],
                       DEMO_SPRING, DEMO_CORNICE);
}

static void aisle(demo_mesh *mesh, double side) {
    wall w = {.origin = {side * 4.3, 0.0, 0.0}, .along = {0.0, 0.0, side}, .normal = {-side, 0.0, 0.0}};
    w.depth = 0.25;
    w.period = 1.6;
    w.front = DEMO_PLASTER;
    w.inside = DEMO_PLASTER;
    w.shade = aisle_wall_shade;
    for (int i = 0; i < DEMO_BAYS; i++) {
        double za = DEMO_FIRST_COLUMN - DEMO_BAY * i, zb = za - DEMO_BAY;
        bay b = {
            .s0 = side > 0 ? zb : -za, .y0 = 0.0, .y1 = 3.9, .half_width = 0.55, .sill = 0.9, .spring = 2.6};
        b.s1 = b.s0 + DEMO_BAY;
        b.centre = 0.5 * (b.s0 + b.s1);
        wall_bay(mesh, &w, &b);
        archivolt(mesh, &w, &b, 0.1, 0.03);
        imposts(mesh, &w, &b, 0.1);
        window_bars(mesh, &w, &b, 2, 4);
    }
    double last = DEMO_FIRST_COLUMN - DEMO_BAY * DEMO_BAYS;
    const double ends[2][2] = {{DEMO_FIRST_COLUMN, DEMO_NEAR}, {DEMO_FAR, last}};
    for (int i = 0; i < 2; i++)
        wall_rectangle(mesh, &w, side > 0 ? ends[i][0] : -ends[i][1], side > 0 ? ends[i][1] : -ends[i][0],
                       0.0, 3.9);
    double inner = side * (DEMO_ARCADE + DEMO_THICKNESS), outer = side * 4.3;
    double low = fmin(inner, outer), high = fmax(inner, outer);
    demo_quad(mesh, (demo_point){low, 3.9, DEMO_FAR}, (demo_point){high, 3.9, DEMO_FAR},
              (demo_point){high, 3.9, DEMO_NEAR}, (demo_point){low, 3.9, DEMO_NEAR}, 1, 6, 1.0, ceiling_shade,
              DEMO_WOOD);
    for (int i = 0; i <= 2 * DEMO_BAYS; i++) { /* beams under it */
        double z = DEMO_FIRST_COLUMN - 0.5 * DEMO_BAY * i;
        demo_quad(mesh, (demo_point){low, 3.72, z}, (demo_point){high, 3.72, z}, (demo_point){high, 3.9, z},
                  (demo_point){low, 3.9, z}, 1, 1, 1.0, ceiling_shade, DEMO_WOOD);
        demo_quad(mesh, (demo_point){low, 3.72, z - 0.14}, (demo_point){high, 3.72, z - 0.14},
                  (demo_point){high, 3.72, z}, (demo_point){low, 3.72, z}, 1, 1, 1.0, ceiling_shade,
                  DEMO_WOOD);
    }
}

/* The cornice's profile, from the wall to its upper edge: distance from the wall and height above
 * DEMO_CORNICE. */
static const double cornice_profile[][2] = {{0.0, 0.0},   {0.03, 0.0},  {0.03, 0.05},
                                            {0.06, 0.08}, {0.06, 0.13}, {0.15, 0.17},
                                            {0.15, 0.22}, {0.18, 0.25}, {0.0, 0.25}};

static void cornice(demo_mesh *mesh, double side) {
    double wall_x = side * (DEMO_ARCADE - DEMO_THICKNESS);
    enum { POINTS = sizeof cornice_profile / sizeof cornice_profile[0] };
    double start = side > 0 ? DEMO_FAR : DEMO_NEAR, end = side > 0 ? DEMO_NEAR : DEMO_FAR;
    for (int i = 0; i + 1 < POINTS; i++) {
        const double *low = cornice_profile[i], *high = cornice_profile[i + 1];
        double xl = wall_x - side * low[0], xh = wall_x - side * high[0];
        double yl = DEMO_CORNICE + low[1], yh = DEMO_CORNICE + high[1];
        demo_quad(mesh, (demo_point){xl, yl, start}, (demo_point){xl, yl, end}, (demo_point){xh, yh, end},
                  (demo_point){xh, yh, start}, 1, 1, 1.0, NULL, i == 6 ? DEMO_TRIM : DEMO_MARBLE);
    }
    for (double z = DEMO_NEAR - 0.1; z > DEMO_FAR + 0.1; z -= 0.125) { /* dentils */
        double inner = wall_x - side * 0.13, outer = wall_x - side * 0.055;
        demo_box(mesh, (demo_point){fmin(inner, outer), DEMO_CORNICE + 0.08, z - 0.06},
                 (demo_point){fmax(inner, outer), DEMO_CORNICE + 0.145, z}, 1.0, NULL, DEMO_MARBLE);
    }
}

/* One coffer of the vault: rib, slope and recessed panel on a grid of breaks. */
enum { COFFERS_AROUND = 9, COFFERS_ALONG = 20, BREAKS_AROUND = 9, BREAKS_ALONG = 6 };
static const double around_breaks[BREAKS_AROUND] = {0.0, 0.1, 0.15, 0.325, 0.5, 0.675, 0.85, 0.9, 1.0};
static const double along_breaks[BREAKS_ALONG] = {0.0, 0.1, 0.15, 0.85, 0.9, 1.0};

static demo_vertex vault_vertex(double turn, double z, double depth) {
    double radius = DEMO_ARCADE - DEMO_THICKNESS + depth;
    demo_vertex vertex = {.shade = 0.75 + 0.25 * gw_sin(turn) - 2.0 * depth};
    vertex.normal = (demo_point){-gw_cos(turn), -gw_sin(turn), 0.0};
    vertex.position = (demo_point){radius * gw_cos(turn), DEMO_VAULT_SPRING + radius * gw_sin(turn), z};
    return vertex;
}

static void coffer_cell(demo_mesh *mesh, int coffer_around, int coffer_along, int i, int k) {
    static const double recess = 0.05;
    uint32_t index[4];
    demo_vertex vertices[4];
    double depths[4];
    for (int corner = 0; corner < 4; corner++) {
        int a = i + (corner == 1 || corner == 2), b = k + (corner >= 2);
        int deep = a >= 2 && a <= BREAKS_AROUND - 3 && b >= 2 && b <= BREAKS_ALONG - 3;
        double turn = GW_PI * (coffer_around + around_breaks[a]) / COFFERS_AROUND;
        double z = DEMO_NEAR + (DEMO_FAR - DEMO_NEAR) * (coffer_along + along_breaks[b]) / COFFERS_ALONG;
        depths[corner] = deep ? recess : 0.0;
        vertices[corner] = vault_vertex(turn, z, depths[corner]);
        vertices[corner].u = (around_breaks[a] - 0.15) / 0.7;
        vertices[corner].v = (along_breaks[b] - 0.15) / 0.7;
    }
    int deep_corners = 0;
    for (int corner = 0; corner < 4; corner++)
        deep_corners += depths[corner] > 0.0;
    demo_material material = deep_corners == 4 ? DEMO_VAULT : deep_corners == 0 ? DEMO_PLASTER : DEMO_TRIM;
    demo_point flat = demo_cross(demo_subtract(vertices[2].position, vertices[0].position),
                                 demo_subtract(vertices[3].position, vertices[1].position));
    for (int corner = 0; corner < 4; corner++) {
        if (material == DEMO_TRIM)
            vertices[corner].normal = flat;
        index[corner] = demo_add_vertex(mesh, &vertices[corner]);
    }
    demo_add_triangle(mesh, index[0], index[1], index[2], material);
    demo_add_triangle(mesh, index[0], index[2], index[3], material);
}

static void vault(demo_mesh *mesh) {
    for (int along = 0; along < COFFERS_ALONG; along++)
        for (int around = 0; around < COFFERS_AROUND; around++)
            for (int i = 0; i + 1 < BREAKS_AROUND; i++)
                for (int k = 0; k + 1 < BREAKS_ALONG; k++)
                    coffer_cell(mesh, around, along, i, k);
}

static void end_wall(demo_mesh *mesh) {
    wall w = {.origin = {0.0, 0.0, DEMO_FAR}, .along = {1.0, 0.0, 0.0}, .normal = {0.0, 0.0, 1.0}};
    w.depth = 0.3;
    w.period = 1.25;
    w.front = DEMO_ASHLAR;
    w.inside = DEMO_PLASTER;
    w.shade = end_wall_shade;
    bay b = {.s0 = -2.4, .s1 = 2.4, .y0 = 0.0, .y1 = 6.6, .half_width = 1.25, .sill = 0.95, .spring = 2.9};
    wall_bay(mesh, &w, &b);
    wall_rectangle(mesh, &w, -4.3, -2.4, 0.0, 3.9);
    wall_rectangle(mesh, &w, 2.4, 4.3, 0.0, 3.9);
    archivolt(mesh, &w, &b, 0.24, 0.07);
    imposts(mesh, &w, &b, 0.24);
    window_bars(mesh, &w, &b, 3, 4);
    demo_point low = {-3.2, -0.3, DEMO_FAR - 0.7}, high = {3.2, 5.2, DEMO_FAR - 0.7};
    demo_vertex vertex = {.normal = {0.0, 0.0, 1.0}, .shade = 1.0};
    uint32_t index[4];
    for (int i = 0; i < 4; i++) {
        int right = i == 1 || i == 2, up = i >= 2;
        vertex.position = (demo_point){right ? high.x : low.x, up ? high.y : low.y, low.z};
        vertex.u = right ? 1.0 : 0.0;
        vertex.v = up ? 0.0 : 1.0;
        index[i] = demo_add_vertex(mesh, &vertex);
    }
    demo_add_triangle(mesh, index[0], index[1], index[2], DEMO_LANDSCAPE);
    demo_add_triangle(mesh, index[0], index[2], index[3], DEMO_LANDSCAPE);
}

/* Where sunlight through a point of the left aisle's windows meets the floor, just above the slabs. */
static demo_point sun_on_floor(double z, double y) {
    demo_point p = {-4.3, y, z};
    p = demo_add(p, demo_scaled(demo_sun, y / -demo_sun.y));
    p.y = 0.003;
    return p;
}

static void sun_patch(demo_mesh *mesh, const double corners[4][2]) {
    uint32_t index[4];
    for (int i = 0; i < 4; i++) {
        demo_vertex vertex = {.normal = {0.0, 1.0, 0.0}};
        vertex.position = sun_on_floor(corners[i][0], corners[i][1]);
        vertex.u = vertex.position.x / FLOOR_PERIOD;
        vertex.v = vertex.position.z / FLOOR_PERIOD;
        vertex.shade = floor_shade(vertex.position);
        index[i] = demo_add_vertex(mesh, &vertex);
    }
    demo_add_triangle(mesh, index[0], index[2], index[1], DEMO_SUNLIT);
    demo_add_triangle(mesh, index[0], index[3], index[2], DEMO_SUNLIT);
}

/* The sun through one window: a patch for each pane between the bars. */
static void sun_through_window(demo_mesh *mesh, double centre) {
    static const double half_width = 0.55, sill = 0.9, spring = 2.6, bar = 0.03;
    enum { STEPS = 5 };
    for (int column = 0; column < 3; column++) {
        double left = half_width * (2.0 * column / 3.0 - 1.0) + bar,
               right = left + 2.0 * half_width / 3.0 - 2.0 * bar;
        for (int row = 0; row < 4; row++) {
            double low = sill + (spring - sill) * row / 4.0 + bar,
                   high = low + (spring - sill) / 4.0 - 2.0 * bar;
            sun_patch(mesh, (const double[4][2]){{centre - left, low},
                                                 {centre - right, low},
                                                 {centre - right, high},
                                                 {centre - left, high}});
        }
        for (int step = 0; step < STEPS; step++) {
            double a = left + (right - left) * step / STEPS, b = left + (right - left) * (step + 1) / STEPS;
            double low = spring + bar, top_a = spring + sqrt(half_width * half_width - a * a);
            double top_b = spring + sqrt(half_width * half_width - b * b);
            sun_patch(mesh, (const double[4][2]){{centre - a, low},
                                                 {centre - b, low},
                                                 {centre - b, fmax(top_b, low + 0.01)},
                                                 {centre - a, fmax(top_a, low + 0.01)}});
        }
    }
}

void demo_hall(demo_mesh *mesh) {
    demo_quad(mesh, (demo_point){-4.3, 0.0, DEMO_NEAR}, (demo_point){4.3, 0.0, DEMO_NEAR},
              (demo_point){4.3, 0.0, DEMO_FAR}, (demo_point){-4.3, 0.0, DEMO_FAR}, 43, 75, FLOOR_PERIOD,
              floor_shade, DEMO_FLOOR);
    for (int i = 0; i + 1 < DEMO_BAYS; i++) /* the last window's would lie outside */
        sun_through_window(mesh, DEMO_FIRST_COLUMN - DEMO_BAY * (i + 0.5));
    demo_box(mesh, (demo_point){-0.7, 0.0, -14.2}, (demo_point){0.7, 0.012, -3.0}, 1.4, NULL, DEMO_CARPET);
    for (int i = 0; i < 3; i++)
        demo_box(mesh, (demo_point){-2.2, 0.15 * i, DEMO_FAR},
                 (demo_point){2.2, 0.15 * (i + 1), -14.2 - 0.4 * i}, 1.25, step_shade, DEMO_MARBLE);
    for (double side = -1.0; side <= 1.0; side += 2.0) {
        arcade(mesh, side);
        aisle(mesh, side);
        cornice(mesh, side);
    }
    vault(mesh);
    end_wall(mesh);
}

static const demo_profile column_base[] = {{0.24, 0.10},  {0.255, 0.12},  {0.26, 0.14},  {0.25, 0.165},
                                           {0.22, 0.175}, {0.22, 0.175},  {0.215, 0.19}, {0.225, 0.205},
                                           {0.22, 0.225}, {0.195, 0.235}, {0.16, 0.24}};
static const demo_profile column_shaft[] = {{0.19, 0.235}, {0.191, 0.6}, {0.19, 1.0},
                                            {0.185, 1.4},  {0.176, 1.8}, {0.168, 2.12}};
static const demo_profile column_head[] = {{0.14, 2.12},  {0.17, 2.12},  {0.17, 2.12},  {0.185, 2.125},
                                           {0.185, 2.15}, {0.17, 2.155}, {0.17, 2.155}, {0.172, 2.2},
                                           {0.185, 2.26}, {0.22, 2.32},  {0.255, 2.35}, {0.26, 2.36}};
#define COUNT(profile) ((int)(sizeof(profile) / sizeof(profile)[0]))

static double capital_shade(demo_point p) {
    (void)p;
    return 0.8;
}

void demo_columns(demo_mesh *mesh) {
    for (int i = 0; i <= DEMO_BAYS; i++)
        for (double side = -1.0; side <= 1.0; side += 2.0) {
            demo_point foot = {side * DEMO_ARCADE, 0.0, DEMO_FIRST_COLUMN - DEMO_BAY * i};
            demo_lathe_options plain = {
                .sides = 36, .turns = 1.0, .period = 1.2, .shade_low = 0.75, .shade_high = 1.0};
            demo_lathe_options fluted = plain;
            fluted.sides = 100;
            fluted.flutes = 20;
            fluted.flute_depth = 0.09;
            fluted.shade_low = 0.85;
            demo_point plinth = {0.27, 0.1, 0.27}, slab = {0.28, 0.0, 0.28};
            demo_box(mesh, (demo_point){foot.x - plinth.x, 0.0, foot.z - plinth.z},
                     (demo_point){foot.x + plinth.x, plinth.y, foot.z + plinth.z}, 1.2, NULL, DEMO_MARBLE);
            demo_lathe(mesh, foot, column_base, COUNT(column_base), &plain, DEMO_MARBLE);
            demo_lathe(mesh, foot, column_shaft, COUNT(column_shaft), &fluted, DEMO_MARBLE);
            plain.shade_low = plain.shade_high = 0.8;
            demo_lathe(mesh, foot, column_head, COUNT(column_head), &plain, DEMO_TRIM);
            demo_box(mesh, (demo_point){foot.x - slab.x, 2.36, foot.z - slab.z},
                     (demo_point){foot.x + slab.x, DEMO_SPRING, foot.z + slab.z}, 1.2, capital_shade,
                     DEMO_MARBLE);
        }
}
