/* Octrees of one scene in pose after pose. */
#include "build/octree_internal.h"

#include "base/memory.h"

#include <stdlib.h>

struct gw_octree_rebuilder {
    gw_settings settings; /* its own: the caller's may be gone */
    gw_octree_options options;
    gw_octree_builder builder;
    gw_octree *octree;
};

gw_code gw_octree_rebuilder_create(gw_gl *device, const gw_octree_options *options, gw_octree_rebuilder **out,
                                   gw_error *error) {
    gw_octree_rebuilder *made = NULL;
    *out = NULL;
    gw_code code = gw_allocate((void **)&made, 1, sizeof *made, "octree rebuilder", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&made->octree, 1, sizeof *made->octree, "octree", error);
    if (code != GW_OK) {
        free(made);
        return code;
    }
    made->settings = *options->settings;
    made->options = *options;
    made->options.settings = &made->settings;
    gw_octree_builder_init(&made->builder, device, NULL, &made->options);
    made->octree->depth = made->builder.depth;
    *out = made;
    return GW_OK;
}

gw_code gw_octree_rebuild(gw_octree_rebuilder *rebuilder, const gw_scene *scene, const gw_octree **out,
                          gw_error *error) {
    *out = NULL;
    gw_octree_builder_reset(&rebuilder->builder, scene);
    /* First of all, so that every round over the same poses asks for the same buffers in the same order. */
    gw_code code = gw_payload_inputs_make(&rebuilder->builder, error);
    if (code == GW_OK)
        code = gw_octree_run(&rebuilder->builder, rebuilder->octree, error);
    if (code != GW_OK)
        return gw_context(error, "cannot rebuild the octree of '%s'", scene->path ? scene->path : "scene");
    *out = rebuilder->octree;
    return GW_OK;
}

void gw_octree_rebuilder_destroy(gw_octree_rebuilder **address) {
    if (!address || !*address)
        return;
    gw_octree_builder_finish(&(*address)->builder);
    gw_octree_destroy(&(*address)->octree);
    free(*address);
    *address = NULL;
}
