/* The statue: a trefoil knot covered with scales, cast in gold, on a pedestal of dark marble. One closed
 * surface of half of all triangles: the dense, finely displaced thing of the demo scene. */
#include "base/portable_math.h"
#include "build/demo_parts.h"

#include <math.h>

const demo_point demo_statue_foot = {-1.12, 0.0, -5.3};

enum { KNOT_COLUMNS = 1152, KNOT_ROWS = 60, SCALES_ALONG = 128, SCALES_AROUND = 8 };
#define KNOT_RADIUS 0.085

/* The knot's curve lies on a torus, whose normal gives a frame that closes on itself. */
static demo_point knot_curve(double turn) {
    double ring = 0.36 + 0.17 * gw_cos(3.0 * turn);
    return (demo_point){ring * gw_cos(2.0 * turn), ring * gw_sin(2.0 * turn), 0.24 * gw_sin(3.0 * turn)};
}

/* Relief of overlapping scales, 0..1: rows alternate by half a scale; each scale is a shield that rises
 * towards its tip and lies over the next row. along and around count scales. */
static double scale_relief(double along, double around) {
    double best = 0.0;
    for (int back = 0; back < 2; back++) {
        double row = floor(along) - back, s = along - row; /* 0..2 from this scale's root */
        double odd = row - 2.0 * floor(row / 2.0);
        double t = around + 0.5 * odd;
        t = t - floor(t) - 0.5;
        double tip = (s - 0.55) / 1.1, d = tip * tip * (s > 0.55 ? 1.0 : 0.4) + t * t * 3.2;
        if (d < 1.0) {
            double keel = 1.0 - 1.6 * (t < 0.0 ? -t : t);
            double height = (0.25 + 0.45 * s) * sqrt(1.0 - d) * (0.8 + 0.2 * keel);
            best = height > best ? height : best;
        }
    }
    return best;
}

static void knot_surface(const void *context, double u, double v, demo_vertex *out) {
    (void)context;
    double turn = 2.0 * GW_PI * u, step = 1e-4;
    demo_point centre = knot_curve(turn);
    demo_point along = demo_unit(demo_subtract(knot_curve(turn + step), knot_curve(turn - step)));
    demo_point rise = {gw_cos(3.0 * turn) * gw_cos(2.0 * turn), gw_cos(3.0 * turn) * gw_sin(2.0 * turn),
                       gw_sin(3.0 * turn)};
    demo_point side = demo_unit(demo_cross(rise, along));
    rise = demo_cross(along, side);
    double around = 2.0 * GW_PI * v, c = gw_cos(around), s = gw_sin(around);
    double relief = scale_relief(SCALES_ALONG * u, SCALES_AROUND * v);
    /* A saw-toothed crest along the outer side. */
    double crest = v < 0.5 ? v : 1.0 - v;
    crest = crest < 0.05 ? 1.0 - crest / 0.05 : 0.0;
    double tooth = 64.0 * u;
    tooth -= floor(tooth);
    double radius = KNOT_RADIUS * (0.9 + 0.2 * relief + 0.55 * crest * (0.25 + 0.75 * tooth));
    out->position = demo_add(centre, demo_add(demo_scaled(rise, radius * c), demo_scaled(side, radius * s)));
    /* Stand it up, turned a little out of the picture's plane, above the pedestal. */
    const double turn_cos = 0.9063077870366499, turn_sin = 0.42261826174069944; /* 25 degrees */
    demo_point p = out->position;
    out->position =
        (demo_point){demo_statue_foot.x + p.x * turn_cos + p.z * turn_sin, demo_statue_foot.y + 1.78 + p.y,
                     demo_statue_foot.z + p.z * turn_cos - p.x * turn_sin};
    out->u = SCALES_ALONG * u;
    out->v = SCALES_AROUND * v;
    /* Gaps between scales see less; so do the inside of the knot and what faces the floor. */
    double up = rise.y * c + side.y * s;
    out->shade = (0.22 + 0.78 * demo_smooth(0.0, 0.5, relief + crest)) * (0.86 + 0.14 * c) * (0.8 + 0.2 * up);
}

static const demo_profile ball_foot[] = {{0.26, 1.02}, {0.27, 1.035}, {0.26, 1.05}, {0.2, 1.06},
                                         {0.12, 1.09}, {0.08, 1.14},  {0.075, 1.2}, {0.1, 1.235},
                                         {0.1, 1.245}, {0.0, 1.25}};

static double pedestal_shade(demo_point p) {
    return 0.65 + 0.35 * demo_smooth(0.0, 0.5, p.y);
}

static void pedestal_block(demo_mesh *mesh, double half, double low, double high, demo_material material) {
    demo_point f = demo_statue_foot;
    demo_box(mesh, (demo_point){f.x - half, f.y + low, f.z - half},
             (demo_point){f.x + half, f.y + high, f.z + half}, 1.0, pedestal_shade, material);
}

void demo_statue(demo_mesh *mesh) {
    pedestal_block(mesh, 0.36, 0.0, 0.12, DEMO_PEDESTAL);
    pedestal_block(mesh, 0.33, 0.12, 0.16, DEMO_TRIM);
    pedestal_block(mesh, 0.29, 0.16, 0.88, DEMO_PEDESTAL);
    pedestal_block(mesh, 0.315, 0.88, 0.92, DEMO_TRIM);
    pedestal_block(mesh, 0.34, 0.92, 1.02, DEMO_PEDESTAL);
    demo_lathe_options options = {
        .sides = 48, .turns = 1.0, .period = 1.0, .shade_low = 0.7, .shade_high = 1.0};
    demo_lathe(mesh, demo_statue_foot, ball_foot, (int)(sizeof ball_foot / sizeof ball_foot[0]), &options,
               DEMO_TRIM);
    demo_grid(mesh, KNOT_COLUMNS, KNOT_ROWS, 1, 1, knot_surface, NULL, DEMO_STATUE);
}
