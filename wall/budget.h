/* Budget mode: holds what a frame costs by one number, the strain of the frame state (render/frame_state.h),
 * from what the tiles told of the frames before. Rank 0 alone decides; the decision travels, is recorded and
 * is repeated with the state.
 *
 * The cost is the rays of the whole wall (deterministic: equal runs decide alike), or the milliseconds of its
 * slowest tile. Strain moves in steps of an eighth of an octave. Above the budget it rises at once by as many
 * steps as the excess has eighths of an octave, at most two octaves; it falls one step a frame, once the cost
 * has stayed below GW_BUDGET_LOW of the budget for some frames, which are the more the more often falling
 * went wrong: so it does not swing. Milliseconds count when two frames agree. Plain values; rank 0's thread.
 */
#ifndef GW_WALL_BUDGET_H
#define GW_WALL_BUDGET_H

#include "render/frame_state.h"
#include "wall/gate.h"
#include "wall/layout.h"

#include <jansson.h>
#include <stdint.h>

/* Shares of the budget: what rising aims at, and below which strain falls. */
#define GW_BUDGET_AIM 0.9
#define GW_BUDGET_LOW 0.7

typedef struct gw_budget {
    double milliseconds;              /* a frame's slowest tile; 0: no such budget */
    double rays;                      /* of a frame of the whole wall; 0: no such budget */
    double least;                     /* strain that was asked for: it never falls below */
    uint32_t step;                    /* strain is least * 2^(step / 8), at most GW_MAXIMUM_STRAIN */
    uint32_t wait;                    /* frames below the band before strain falls */
    uint32_t patience;                /* what wait begins with */
    int fell;                         /* the last move was down */
    double before;                    /* cost of the frame before under the same strain; negative: none */
    double cost_of[GW_MAXIMUM_TILES]; /* of each tile's last frame: a late or lost tile's stands */
    uint32_t frames, over;            /* frames that counted, and those above the budget */
} gw_budget;

/* Either may be 0; both 0: no budget. least is the setting's strain. */
void gw_budget_init(gw_budget *budget, double milliseconds, double rays, double least);
int gw_budget_is_on(const gw_budget *budget);
/* What one tile did in the last frame. */
void gw_budget_note(gw_budget *budget, uint32_t tile, const gw_done *done);
/* After the frame's tiles: decides for the next one. Nothing changes after a frame without gaze, which strain
 * does not touch, while samples of a still view add up, and after the first frame, in which kernels were
 * compiled. */
void gw_budget_decide(gw_budget *budget, const gw_frame_state *state);
float gw_budget_strain(const gw_budget *budget);
/* {"ms" or "rays": the budget, "frames", "over"}; null without one. */
json_t *gw_budget_json(const gw_budget *budget);

#endif
