/* Hard cases of tracing: tiny scenes with an octree and a renderer of their own on one device, traced by the
 * shipped kernel and by variants of it. One thread; what fails ends the test. */
#ifndef GW_TESTS_SUPPORT_CASES_H
#define GW_TESTS_SUPPORT_CASES_H

#include "base/gl.h"
#include "build/octree.h"
#include "build/scene.h"
#include "render/renderer.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_case {
    gw_scene *scene; /* taken */
    gw_octree *octree;
    gw_renderer *renderer;
} gw_case;

/* depth: of the octree. Takes the scene. */
void gw_case_open(gw_case *c, gw_gl *device, gw_scene *scene, int depth);
void gw_case_close(gw_case *c);

/* Hits of the shipped traversal with these lines of defines, NULL: none; free() them. That no ray was cut off
 * is checked. */
gw_hit *gw_case_trace(const gw_case *c, const char *defines, const gw_ray *rays, size_t count);
gw_hit *gw_case_brute(const gw_case *c, const gw_ray *rays, size_t count);
size_t gw_case_misses(const gw_case *c, const char *defines, const gw_ray *rays, size_t count);
/* Rays that cross fronts without backs, or backs without fronts: through a closed convex surface none does.
 */
size_t gw_case_odd(const gw_case *c, const char *defines, const gw_ray *rays, size_t count);

/* A point of scene space (metres) in the scene's rebased space. */
void gw_case_rebase(const gw_scene *scene, const double point[3], double out[3]);

/* Rays at the corners of every triangle and at `on_edge` random places along each of its edges, from places
 * within `spread` of a point of rebased space. free() them. */
gw_ray *gw_aim_at_features(const gw_scene *scene, const double from[3], double spread, uint32_t on_edge,
                           uint64_t seed, size_t *count);

/* Names of what a define makes of the kernel, for messages. */
typedef struct gw_rung {
    const char *name, *defines;
} gw_rung;
/* Those that keep every invariant: shipped, contracted where the language allows it, double, ordered under
 * full contraction. */
enum { GW_SOUND_RUNGS = 4 };
extern const gw_rung gw_sound_rungs[GW_SOUND_RUNGS];

#endif
