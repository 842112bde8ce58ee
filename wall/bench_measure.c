#include "wall/bench.h"

#include "base/clock.h"
#include "wall/report.h"

gw_code gw_bench_measure(const gw_bench *bench, const gw_scene *scene, const gw_settings *settings,
                         uint32_t repeats, gw_built *out, gw_error *error) {
    gw_octree_options options = {.settings = settings, .log = &bench->console.log};
    gw_code code = GW_OK;
    for (uint32_t i = 0; i < repeats && code == GW_OK; i++) {
        gw_octree *octree = NULL;
        int64_t begin = gw_now_ns();
        code = gw_octree_build(bench->model.device, scene, &options, &octree, error);
        double total_ms = (double)(gw_now_ns() - begin) * 1e-6;
        if (code != GW_OK)
            return code;
        if (i > 0 && !gw_hash_equal(octree->hash, out->hash))
            code = gw_fail(error, GW_MACHINE,
                           "two builds of the same octree differ; this device is not deterministic");
        if (i == 0 || total_ms < out->total_ms)
            *out = (gw_built){
                .depth = octree->depth,
                .triangles = scene->triangle_count,
                .statistics = octree->statistics,
                .node_bytes = gw_octree_node_bytes(octree),
                .reference_bytes = gw_octree_reference_bytes(octree) + gw_octree_box_bytes(octree),
                .payload_bytes = gw_octree_payload_bytes(octree) + gw_octree_emission_bytes(octree),
                .triangle_bytes = gw_triangle_bytes(scene),
                .total_ms = total_ms,
                .hash = octree->hash};
        gw_octree_destroy(&octree);
    }
    return code;
}
