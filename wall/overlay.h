/* The overlay: what a tile is doing, drawn over the picture that is shown or written, never into the pixels
 * that are hashed: who it is, how long the parts of its last frames took as bars side by side, rays a second,
 * the age of the pose and the way from motion to photons, what was missed, and the frame code. Host only; one
 * thread. */
#ifndef GW_WALL_OVERLAY_H
#define GW_WALL_OVERLAY_H

#include "base/image.h"
#include "wall/latency.h"

#include <stdint.h>

/* The parts of a frame on a tile, in their order. */
typedef enum gw_lane {
    GW_LANE_WAIT,    /* from its answer to the next release */
    GW_LANE_TRACE,   /* everything up to samples: scene, rays, shading */
    GW_LANE_BLEND,   /* samples to pixels */
    GW_LANE_GATE,    /* telling rank 0, pixels included */
    GW_LANE_PRESENT, /* staging and swapping */
    GW_LANES
} gw_lane;

extern const char *const gw_lane_names[GW_LANES];

enum { GW_OVERLAY_FRAMES = 48 };

/* Times of a tile's last frames. Zero: none yet. */
typedef struct gw_lanes {
    float ms[GW_OVERLAY_FRAMES][GW_LANES]; /* a ring */
    uint32_t count;                        /* frames noted since the beginning */
} gw_lanes;

void gw_lanes_note(gw_lanes *lanes, const float ms[GW_LANES]);

/* Frames that went on without a tile. */
typedef struct gw_missed {
    uint32_t late, skipped, lost;
} gw_missed;

typedef struct gw_overlay_text {
    const char *tile, *host; /* host may be "" */
    uint32_t rank, frame;
    double rays_per_second; /* 0: nothing was traced */
    double pose_age;        /* s; negative: nobody is tracked */
    uint32_t late, skipped, lost;
    gw_latency latency; /* from motion to photons, of the frame before */
} gw_overlay_text;

/* Over a picture of one tile. */
void gw_overlay_draw(gw_image *tile, const gw_lanes *lanes, const gw_overlay_text *text);

#endif
