/* Every triangle against a ray in double precision, with bounds of what the float test may round: the oracle
 * of hits that shares no code with the shaders. Any thread. */
#ifndef GW_TESTS_SUPPORT_DOUBLE_HITS_H
#define GW_TESTS_SUPPORT_DOUBLE_HITS_H

#include "build/scene.h"
#include "render/renderer.h"

/* What the float test may make of one triangle. */
typedef enum gw_double_class { GW_DOUBLE_MISS, GW_DOUBLE_EITHER, GW_DOUBLE_HIT } gw_double_class;
typedef struct gw_double_crossing {
    gw_double_class class; /* either: the ray passes an edge within the rounding of the edge products */
    double t;              /* along the ray's direction, as it is given */
    double bound;          /* most by which the float t may be off */
} gw_double_crossing;

/* The ray's crossing of the triangle's plane; minimum and maximum are not looked at. */
gw_double_crossing gw_double_cross(const gw_scene *scene, uint32_t triangle, const gw_ray *ray);

/* How a hit that the float test found compares with all triangles in double. */
typedef enum gw_double_verdict {
    GW_DOUBLE_SAME,  /* the nearest in double, or nothing where double finds nothing */
    GW_DOUBLE_CLOSE, /* another: it or the nearest is undecided, or they lie within each other's bounds */
    GW_DOUBLE_WRONG
} gw_double_verdict;
typedef struct gw_double_result {
    gw_double_verdict verdict;
    uint32_t nearest; /* in double, of those that are hit for certain; GW_NO_TRIANGLE */
    double t;         /* its t */
    double error;     /* |t - hit's t| over t, of the hit's own triangle; 0 for none */
    double share;     /* of its bound that this error is */
} gw_double_result;
gw_double_result gw_double_judge(const gw_scene *scene, const gw_ray *ray, const gw_hit *hit);

#endif
