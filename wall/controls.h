/* Keys, buttons and pointer folded into what they ask for. Plain values; any thread. */
#ifndef GW_WALL_CONTROLS_H
#define GW_WALL_CONTROLS_H

#include "base/window.h"
#include "tracking/tracker.h"
#include "wall/navigate.h"

typedef struct gw_controls {
    unsigned char held[GW_KEY_END]; /* keys that are down */
    unsigned char buttons;          /* bit i: button i is down */
    int pointer_known;
    double pointer[2]; /* shares of the wall as it hangs */
    double
        dragged[2]; /* shares to the right and down, with the right or middle button, since the last take */
    double notches; /* of the wheel, since the last take */
    unsigned presses[GW_KEY_END]; /* how often each key went down since the last take */
    int close;                    /* the window, Escape: from then on */
} gw_controls;

/* A pointer's position is in shares of the wall. */
void gw_controls_note(gw_controls *controls, const gw_event *event);
/* How navigation is asked to go on. Empties what had gathered of drags and the wheel. */
gw_navigation_input gw_controls_take(gw_controls *controls);
/* Adds what a navigating device asks for: ahead as W, turning as the arrows. */
void gw_controls_add_wand(gw_navigation_input *input, const gw_wand *wand);
/* How often the key was pressed since it was last asked. */
unsigned gw_controls_pressed(gw_controls *controls, int32_t key);

/* What the keys do, for the window's help and the command line's. */
extern const char gw_controls_help[];

#endif
