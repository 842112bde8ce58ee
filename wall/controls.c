#include "wall/controls.h"

#include <math.h>
#include <string.h>

/* rad for dragging over the whole wall, across and down, and per s of a held arrow. */
static const double turn_across = 2.5, turn_down = 1.5, turn_per_second = 0.9;
enum { DRAG_BUTTONS = 1 << 1 | 1 << 2 };

const char gw_controls_help[] = "mouse          where the viewer looks\n"
                                "W S  A D       fly ahead, back, left, right\n"
                                "E Q            up, down\n"
                                "arrows         turn (also: drag with the right button)\n"
                                "Shift Ctrl     four times faster, slower\n"
                                "wheel          speed\n"
                                "Home           back to the start\n"
                                "G              gaze: mouse, track, nobody's\n"
                                "R              ring about the gaze\n"
                                "B              bird's-eye view\n"
                                "H F1           this help\n"
                                "Escape         end";

void gw_controls_note(gw_controls *controls, const gw_event *event) {
    const int is_key = event->key > 0 && event->key < GW_KEY_END;
    switch (event->kind) {
    case GW_EVENT_KEY_DOWN:
        if (!is_key)
            break;
        controls->held[event->key] = 1;
        controls->presses[event->key]++;
        controls->close |= event->key == GW_KEY_ESCAPE;
        break;
    case GW_EVENT_KEY_UP:
        if (is_key)
            controls->held[event->key] = 0;
        break;
    case GW_EVENT_POINTER:
        for (int k = 0; k < 2 && controls->pointer_known && (controls->buttons & DRAG_BUTTONS); k++)
            controls->dragged[k] += event->position[k] - controls->pointer[k];
        memcpy(controls->pointer, event->position, sizeof controls->pointer);
        controls->pointer_known = 1;
        break;
    case GW_EVENT_BUTTON_DOWN:
    case GW_EVENT_BUTTON_UP:
        if (event->key >= 0 && event->key < 8) {
            const unsigned bit = 1u << event->key;
            controls->buttons =
                (unsigned char)(event->kind == GW_EVENT_BUTTON_DOWN ? controls->buttons | bit
                                                                    : controls->buttons & ~bit);
        }
        break;
    case GW_EVENT_SCROLL:
        controls->notches += event->position[1];
        break;
    case GW_EVENT_BLUR:
        memset(controls->held, 0, sizeof controls->held);
        controls->buttons = 0;
        break;
    case GW_EVENT_CLOSE:
        controls->close = 1;
        break;
    }
}

static double axis(const gw_controls *controls, int32_t forth, int32_t back) {
    return controls->held[forth] - controls->held[back];
}

gw_navigation_input gw_controls_take(gw_controls *controls) {
    gw_navigation_input input = {
        .move = {axis(controls, 'D', 'A'), axis(controls, 'E', 'Q'), axis(controls, 'W', 'S')},
        .turning = {turn_per_second * axis(controls, GW_KEY_RIGHT, GW_KEY_LEFT),
                    turn_per_second * axis(controls, GW_KEY_UP, GW_KEY_DOWN)},
        .turn = {turn_across * controls->dragged[0], -turn_down * controls->dragged[1]},
        .haste = (controls->held[GW_KEY_SHIFT] ? 4 : 1) * (controls->held[GW_KEY_CONTROL] ? 0.25 : 1),
        .notches = controls->notches,
    };
    controls->dragged[0] = controls->dragged[1] = controls->notches = 0;
    return input;
}

void gw_controls_add_wand(gw_navigation_input *input, const gw_wand *wand) {
    input->move[2] = fmin(fmax(input->move[2] + wand->forward, -1), 1);
    input->turning[0] += turn_per_second * wand->turn;
}

unsigned gw_controls_pressed(gw_controls *controls, int32_t key) {
    const unsigned presses = controls->presses[key];
    controls->presses[key] = 0;
    return presses;
}
