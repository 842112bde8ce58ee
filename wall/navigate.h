/* Navigation: where in the scene the wall's neutral viewer stands and which way the wall faces, and how keys
 * and mouse move that, as a pure function of state, input and time.
 *
 * The viewer never rolls: up stays the scene's y, and looking up or down ends GW_STEEPEST short of the poles,
 * where there would be no direction left. A collision guard keeps the eye a hand's breadth off surfaces and
 * lets it slide along them; no step, however long, passes one. What a tracked head adds to where the viewer
 * stands is not guarded: nobody can hold a person back. Plain values; any thread. */
#ifndef GW_WALL_NAVIGATE_H
#define GW_WALL_NAVIGATE_H

#include "render/frame_state.h"
#include "render/view.h"

typedef struct gw_navigation {
    double position[3]; /* scene metres */
    double yaw, pitch;  /* rad: yaw 0 looks along -z, pi/2 along +x; pitch is up */
    double scale;       /* wall mm per scene metre */
    double speed;       /* m/s as the viewer feels them: of the room before the wall */
} gw_navigation;

typedef struct gw_navigation_input {
    double move[3];    /* -1 to 1: to the right, up, ahead */
    double turning[2]; /* rad/s: to the right, up */
    double turn[2];    /* rad at once */
    double haste;      /* times the speed; 0 counts as 1 */
    double notches;    /* of the wheel: speed changes by a quarter a notch */
} gw_navigation_input;

/* The nearest surface along a unit direction, within `reach` scene metres: 1, with distance and its unit
 * normal on either side, or 0. */
typedef struct gw_surfaces {
    int (*meet)(void *context, const double from[3], const double direction[3], double reach,
                double *distance, double normal[3]);
    void *context;
} gw_surfaces;

/* Below the poles, rad; of the speed, m/s; how far off surfaces the eye stays, mm of the room. */
#define GW_STEEPEST 1.5533430342749532 /* 89 degrees */
#define GW_SLOWEST 0.02
#define GW_FASTEST 200.0
#define GW_CLEARANCE 150.0

/* What stands for a placement of the scene: the same picture, but for a roll, which is taken out. */
gw_navigation gw_navigation_of(const gw_similarity *placement, const double neutral_eye[3], double speed);
/* dt in s, negative counts as 0. surfaces NULL: nothing is in the way. */
gw_navigation gw_navigate(const gw_navigation *before, const gw_navigation_input *input, double dt,
                          const gw_surfaces *surfaces);
/* Whether the input asks for anything that moves or turns. */
int gw_navigation_is_asked(const gw_navigation_input *input);
/* Writes it into a frame state: stand, look_at, scene_scale. */
void gw_navigation_apply(const gw_navigation *navigation, gw_frame_state *state);

#endif
