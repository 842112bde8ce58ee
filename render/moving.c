#include "render/moving.h"

#include "base/clock.h"
#include "base/memory.h"
#include "build/scene_pose.h"

#include <inttypes.h>
#include <stdlib.h>

struct gw_moving {
    gw_gl *device;
    const gw_log *log;
    gw_posed *posed;
    gw_octree_rebuilder *rebuilder;
    gw_gl_pool_counts before; /* of the device, when this began */
    uint64_t rebuilds, held;
    double total_ms, worst_ms, pose_ms, phases_ms[4]; /* sums, but for the worst */
};

gw_code gw_moving_create(gw_gl *device, const gw_scene *scene, const gw_settings *settings, const gw_log *log,
                         gw_moving **out, gw_error *error) {
    const gw_octree_options options = {.settings = settings}; /* no log: no progress within a frame */
    gw_moving *moving = NULL;
    *out = NULL;
    gw_code code = gw_allocate((void **)&moving, 1, sizeof *moving, "moving scene", error);
    if (code)
        return code;
    moving->device = device;
    moving->log = log;
    gw_gl_pool_start(device);
    moving->before = gw_gl_pool_counts_of(device);
    code = gw_posed_create(scene, &moving->posed, error);
    if (!code)
        code = gw_octree_rebuilder_create(device, &options, &moving->rebuilder, error);
    if (code)
        gw_moving_destroy(&moving);
    *out = moving;
    return code;
}

void gw_moving_destroy(gw_moving **moving) {
    if (!moving || !*moving)
        return;
    gw_octree_rebuilder_destroy(&(*moving)->rebuilder);
    gw_posed_destroy(&(*moving)->posed);
    free(*moving);
    *moving = NULL;
}

static double milliseconds_since(int64_t begin) {
    return (double)(gw_now_ns() - begin) * 1e-6;
}

static void note_held(gw_moving *moving, int64_t time) {
    const uint64_t held = gw_posed_held(moving->posed);
    if (held > 0 && moving->held == 0)
        gw_log_write(moving->log, GW_LOG_WARNING,
                     "at %.3f s %" PRIu64
                     " vertices of the animation leave the bounds that the importer measured: "
                     "they are held at the border",
                     (double)time * 1e-9, held);
    moving->held += held;
}

gw_code gw_moving_to(gw_moving *moving, int64_t time, const gw_scene **scene, const gw_octree **octree,
                     gw_error *error) {
    const int64_t begin = gw_now_ns();
    gw_posed_move(moving->posed, time);
    moving->pose_ms += milliseconds_since(begin);
    note_held(moving, time);
    *scene = gw_posed_scene(moving->posed);
    gw_code code = gw_octree_rebuild(moving->rebuilder, *scene, octree, error);
    if (code)
        return code;
    const double milliseconds = milliseconds_since(begin);
    moving->rebuilds++;
    moving->total_ms += milliseconds;
    moving->worst_ms = milliseconds > moving->worst_ms ? milliseconds : moving->worst_ms;
    for (int i = 0; i < 4; i++)
        moving->phases_ms[i] += (*octree)->statistics.milliseconds[i];
    return GW_OK;
}

json_t *gw_moving_report(const gw_moving *moving) {
    const gw_gl_pool_counts now = gw_gl_pool_counts_of(moving->device);
    const double share = moving->rebuilds > 0 ? 1.0 / (double)moving->rebuilds : 0.0;
    const double *phases = moving->phases_ms;
    return json_pack("{s:I, s:{s:f, s:f}, s:{s:f, s:f, s:f, s:f, s:f}, s:{s:I, s:I, s:I}, s:I}", "rebuilds",
                     (json_int_t)moving->rebuilds, "ms", "mean", moving->total_ms * share, "max",
                     moving->worst_ms, "phases_ms", "pose", moving->pose_ms * share, "refinement",
                     phases[0] * share, "leaf_payload", phases[1] * share, "inner_payload", phases[2] * share,
                     "assembly", phases[3] * share, "buffers", "made",
                     (json_int_t)(now.made - moving->before.made), "reused",
                     (json_int_t)(now.reused - moving->before.reused), "idle_bytes",
                     (json_int_t)now.idle_bytes, "held_vertices", (json_int_t)moving->held);
}
