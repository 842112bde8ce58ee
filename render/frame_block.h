/* The frame block: everything about one frame that kernels read, computed in double on the host and rounded
 * to float once. Plain values; any thread. */
#ifndef GW_RENDER_FRAME_BLOCK_H
#define GW_RENDER_FRAME_BLOCK_H

#include "base/status.h"
#include "build/gpu_types.h"
#include "build/octree.h"
#include "build/scene.h"
#include "render/frame_state.h"
#include "render/view.h"
#include "shaders/common/frame.h"

/* Fills all but window, chunk and the light counts, for sample 0 of the view. Viewers whose gaze is not
 * finite, has no direction or no confidence are left out, as if they had none; *dropped (may be NULL) counts
 * them. GW_BAD_INPUT when the eye, the plane or a knob is not a number. */
gw_code gw_frame_block_fill(const gw_scene *scene, const gw_octree *octree, const gw_similarity *placement,
                            const gw_plane *plane, const gw_frame_state *state, gw_frame_block *block,
                            uint32_t *dropped, gw_error *error);

/* Sample `number` of the view instead, which gw_frame_block_fill() was given. */
void gw_frame_block_set_sample(const gw_frame_state *state, uint32_t number, gw_frame_block *block);

#endif
