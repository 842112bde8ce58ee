/* Exact, approximate, difference: a picture beside the one without any approximation, and where and how
 * strongly the two differ as the eye sees it. One thread. */
#ifndef GW_WALL_TRIPLE_H
#define GW_WALL_TRIPLE_H

#include "base/image.h"
#include "base/status.h"
#include "render/renderer.h"

#include <jansson.h>

typedef struct gw_triple_view {
    const gw_scene *scene;
    const gw_octree *octree;
    gw_renderer *renderer;
    const gw_similarity *placement;
    const gw_plane *plane; /* the picture shows it from pixel (0, 0) on */
    const gw_frame_state *state;
} gw_triple_view;

enum { GW_TRIPLE_RAYS = 16 };

/* The same view without any approximation: triangles and GW_TRIPLE_RAYS rays at every pixel. */
gw_frame_state gw_exact_state(const gw_frame_state *state);

/* Draws the view once more, exact. Writes into the folder
 * exact.png, approximate.png, difference.png (FLIP as colours, black 0 over red and yellow to white 1) and
 * triple.png, the three side by side; where somebody looks also seen.png, the difference behind the acuity of
 * that viewer, which stands as a fourth in triple.png. *numbers: {flip, seen_flip, pixels_per_degree, rays},
 * for a report. */
gw_code gw_triple_write(const gw_triple_view *view, const gw_image *approximate, const char *folder,
                        json_t **numbers, gw_error *error);

#endif
