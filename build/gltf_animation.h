/* The animation of a glTF file: nodes, channels and skins from its JSON and buffers, tied to the vertices
 * that the import child delivered. Reads untrusted bytes. Any thread. */
#ifndef GW_BUILD_GLTF_ANIMATION_H
#define GW_BUILD_GLTF_ANIMATION_H

#include "base/status.h"
#include "build/gltf.h"
#include "build/source_model.h"

/* choice: the name or number of the animation that plays, "all", "none", or NULL for the first. Gives
 * model->scene an animation when something moves; skins that stay are put into their pose. Says in notes what
 * plays and what does not. folder: of the model's files, NULL: not looked for. */
gw_code gw_gltf_animate(const gw_gltf *gltf, const char *folder, const char *choice, gw_source_model *model,
                        gw_error *error);

#endif
