/* Which tangents of a glTF file's vertices are used: those that a normal map reads, one vec4 of floats for
 * each vertex, beside a normal, in a file where nothing moves. Never touches geometry. Any thread. */
#ifndef GW_BUILD_GLTF_TANGENTS_H
#define GW_BUILD_GLTF_TANGENTS_H

#include "base/status.h"
#include "build/gltf.h"
#include "build/scene.h"

/* Takes all others out of the JSON. */
void gw_gltf_strip_tangents(gw_gltf *gltf);
/* Says how many a normal map would have read. */
gw_code gw_gltf_note_tangents(const gw_gltf *gltf, gw_scene *scene, gw_error *error);

#endif
