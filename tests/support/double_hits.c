/* See double_hits.h. */
#include "tests/support/double_hits.h"

#include <float.h>
#include <math.h>

/* Half an ulp of 1 in float. */
static const double unit = 0x1p-24;

typedef struct vertices {
    double from_origin[3][3]; /* of the vertices, exact to double */
    double ab[3], ac[3];
} vertices;

static vertices load(const gw_scene *scene, uint32_t triangle, const gw_ray *ray) {
    vertices v;
    for (uint32_t i = 0; i < 3; ++i)
        for (uint32_t k = 0; k < 3; ++k)
            v.from_origin[i][k] =
                (double)scene->positions[scene->triangles[triangle][i] * 3 + k] - (double)ray->origin[k];
    for (uint32_t k = 0; k < 3; ++k) {
        v.ab[k] = v.from_origin[1][k] - v.from_origin[0][k];
        v.ac[k] = v.from_origin[2][k] - v.from_origin[0][k];
    }
    return v;
}

/* t = ((a - o).n) / (d.n), n = ab x ac. In float each component of n is off by at most 4 units of
 * N = |ab_j ac_k| + |ab_k ac_j| (rounding of both edges, of the products and of their difference), each sum
 * of three products by another 4 units of its terms: 8 units of sum |f_i| N_i above, as many of sum |d_i| N_i
 * along, and one of the quotient. To first order; doubled for the rest. The test then keeps t within the
 * vertices' depths, which are off by 3 units of themselves. */
static void cross_plane(const vertices *v, const gw_ray *ray, gw_double_crossing *out) {
    double above = 0, along = 0, above_terms = 0, along_terms = 0, depth = 0;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double n = v->ab[j] * v->ac[k] - v->ab[k] * v->ac[j];
        double terms = fabs(v->ab[j] * v->ac[k]) + fabs(v->ab[k] * v->ac[j]);
        above += v->from_origin[0][i] * n;
        along += (double)ray->direction[i] * n;
        above_terms += fabs(v->from_origin[0][i]) * terms;
        along_terms += fabs((double)ray->direction[i]) * terms;
    }
    double farthest = 0, nearest = INFINITY, size = 0;
    for (int k = 0; k < 3; ++k)
        size = fmax(size, fabs((double)ray->direction[k]));
    for (int k = 0; k < 3; ++k)
        if (fabs((double)ray->direction[k]) == size)
            for (int i = 0; i < 3; ++i) {
                depth = v->from_origin[i][k] / (double)ray->direction[k];
                farthest = fmax(farthest, depth);
                nearest = fmin(nearest, depth);
            }
    out->t = along != 0 ? above / along : nearest;
    double rounding =
        along != 0 ? 2 * unit * (8 * above_terms + 8 * fabs(out->t) * along_terms) / fabs(along) : INFINITY;
    /* Whatever the quotient, t stays within the vertices' depths: a ray that passes a sliver within the
     * rounding of its edges may cross the plane far from it. */
    out->t = fmin(fmax(out->t, nearest), farthest);
    out->bound = fmin(rounding, farthest - nearest) + 8 * unit * fmax(fabs(farthest), fabs(nearest));
}

/* Signs of the edge products with bounds of their rounding: sheared coordinates are off by 4 units of
 * |x| + |slope z|, products by those and two units of themselves. */
static gw_double_class classify(const vertices *v, const gw_ray *ray) {
    int z = 0;
    for (int k = 1; k < 3; ++k)
        if (fabs((double)ray->direction[k]) > fabs((double)ray->direction[z]))
            z = k;
    int axes[2] = {(z + 1) % 3, (z + 2) % 3}, above = 0, below = 0, open = 0;
    double p[3][2], off[3][2];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 2; ++k) {
            double slope = (double)ray->direction[axes[k]] / (double)ray->direction[z];
            double x = v->from_origin[i][axes[k]], along = slope * v->from_origin[i][z];
            p[i][k] = x - along;
            off[i][k] = 4 * unit * (fabs(x) + fabs(along)) + 0x1p-63 * fabs(v->from_origin[i][z]);
        }
    for (int i = 0; i < 3; ++i) {
        const double *b = p[(i + 1) % 3], *c = p[(i + 2) % 3], *db = off[(i + 1) % 3], *dc = off[(i + 2) % 3];
        double edge = c[0] * b[1] - c[1] * b[0];
        double terms = fabs(c[0] * b[1]) + fabs(c[1] * b[0]);
        double bound = fabs(c[0]) * db[1] + fabs(b[1]) * dc[0] + fabs(c[1]) * db[0] + fabs(b[0]) * dc[1] +
                       dc[0] * db[1] + dc[1] * db[0] + 3 * unit * terms + FLT_MIN;
        above += edge > bound;
        below += edge < -bound;
        open += fabs(edge) <= bound;
    }
    if (above > 0 && below > 0)
        return GW_DOUBLE_MISS;
    for (int k = 0; k < 2; ++k) { /* the square about a sliver that is seen edge-on */
        double least = INFINITY, most = -INFINITY;
        for (int i = 0; i < 3; ++i) {
            least = fmin(least, p[i][k] - off[i][k]);
            most = fmax(most, p[i][k] + off[i][k]);
        }
        if (least > 0 || most < 0)
            return GW_DOUBLE_MISS;
    }
    return open > 0 ? GW_DOUBLE_EITHER : GW_DOUBLE_HIT;
}

gw_double_crossing gw_double_cross(const gw_scene *scene, uint32_t triangle, const gw_ray *ray) {
    gw_double_crossing out = {GW_DOUBLE_MISS, 0, 0};
    const vertices v = load(scene, triangle, ray);
    out.class = classify(&v, ray);
    if (out.class != GW_DOUBLE_MISS)
        cross_plane(&v, ray, &out);
    return out;
}

gw_double_result gw_double_judge(const gw_scene *scene, const gw_ray *ray, const gw_hit *hit) {
    gw_double_result out = {.verdict = GW_DOUBLE_SAME, .nearest = GW_NO_TRIANGLE, .t = INFINITY};
    double limit = INFINITY; /* no later than this the float test has found something */
    gw_double_crossing own = {GW_DOUBLE_MISS, INFINITY, 0};
    for (uint32_t i = 0; i < scene->triangle_count; ++i) {
        gw_double_crossing c = gw_double_cross(scene, i, ray);
        if (i == hit->triangle)
            own = c;
        if (c.class != GW_DOUBLE_HIT || c.t - c.bound <= (double)ray->minimum)
            continue;
        limit = fmin(limit, c.t + c.bound);
        if (c.t < out.t) {
            out.t = c.t;
            out.nearest = i;
        }
    }
    if (hit->triangle == GW_NO_TRIANGLE) {
        out.verdict = out.nearest == GW_NO_TRIANGLE ? GW_DOUBLE_SAME : GW_DOUBLE_WRONG;
        return out;
    }
    double apart = fabs(own.t - (double)hit->t);
    int allowed = own.class != GW_DOUBLE_MISS && apart <= own.bound && (double)hit->t <= limit;
    out.error = own.t != 0 ? apart / fabs(own.t) : 0;
    out.share = own.bound > 0 ? apart / own.bound : 0;
    out.verdict = !allowed                       ? GW_DOUBLE_WRONG
                  : hit->triangle == out.nearest ? GW_DOUBLE_SAME
                                                 : GW_DOUBLE_CLOSE;
    return out;
}
