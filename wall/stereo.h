/* Two eyes on one tile: which rectangles of which planes are drawn from which eye, and where their pixels
 * stand on the panel.
 *
 * Every eye is a frame of its own, from where that eye is, of only those pixels that the panel shows to it:
 * half of them side by side, top to bottom and interlaced by rows. Gazes are the viewers' as in mono. A mono
 * tile is one view, of the state's own eye, and needs nothing of this. Host only; the thread of the renderer.
 */
#ifndef GW_WALL_STEREO_H
#define GW_WALL_STEREO_H

#include "base/status.h"
#include "render/predicted_error.h"
#include "render/renderer.h"
#include "wall/site.h"

#include <stddef.h>
#include <stdint.h>

enum { GW_MOST_EYES = 2 };

/* What one eye sees of a tile: the left one first. */
typedef struct gw_eye_view {
    gw_plane plane; /* the same for every tile of one split */
    gw_rectangle rectangle;
    double eye[3]; /* wall space, mm */
} gw_eye_view;

/* The views of a tile, 1 or 2; their number. */
uint32_t gw_stereo_views(gw_stereo stereo, const gw_tile *tile, const gw_frame_state *state,
                         gw_eye_view views[GW_MOST_EYES]);
/* Puts the pixels of a view where the panel shows them. An anaglyph takes red from the left eye, green and
 * blue from the right one. */
void gw_stereo_place(gw_stereo stereo, const gw_tile *tile, uint32_t view, const uint8_t *view_pixels,
                     uint8_t *tile_pixels);
/* Bytes that gw_stereo_draw() needs beside the tile's pixels; 0: one view, drawn in place. */
size_t gw_stereo_scratch(gw_stereo stereo, const gw_tile *tile);

/* The tile's frame. scratch: of gw_stereo_scratch() bytes, or NULL. */
gw_code gw_stereo_draw(gw_renderer *renderer, const gw_similarity *placement, gw_stereo stereo,
                       const gw_tile *tile, const gw_frame_state *state, uint8_t *scratch, uint8_t *pixels,
                       gw_counters *counters, gw_error *error);
/* Adds the predicted error of all that is drawn of the tile. */
gw_code gw_stereo_predict(const gw_scene *scene, const gw_octree *octree, const gw_similarity *placement,
                          gw_stereo stereo, const gw_tile *tile, const gw_frame_state *state,
                          gw_predicted_error *out, gw_error *error);

/* Whether some panel shows two eyes, so that states need the distance between them. */
int gw_site_is_stereo(const gw_site *site);
/* GW_BAD_INPUT names a tile whose pixels cannot be shared by two eyes as its panel would. */
gw_code gw_stereo_check(const gw_site *site, gw_error *error);
gw_code gw_stereo_check_tile(const gw_site *site, uint32_t index, gw_error *error);

#endif
