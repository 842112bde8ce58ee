/* Windows on X11 through GLFW: full-screen on a monitor chosen by the name of its connector, or at a place of
 * the desktop; each with an OpenGL 4.5 core context of its own, and with its keys, pointer and size as a list
 * of events.
 *
 * GLFW keeps its state per process and belongs to the main thread: so do all these calls, but for take and
 * leave. The X display is
 * that of the environment variable DISPLAY at the first call. */
#ifndef GW_BASE_WINDOW_H
#define GW_BASE_WINDOW_H

#include "base/log.h"
#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_window gw_window;

typedef struct gw_window_options {
    const char *title;
    const char *monitor; /* connector, as "DP-1": full-screen there; NULL or "": a window */
    int32_t position[2]; /* px, top left corner on the desktop, if placed */
    uint32_t size[2];    /* px; full-screen: what the monitor must show already */
    int placed;          /* 1: it must stand at `position` with `size`, or creation fails; without borders */
    int resizable;       /* 1: the user may change its size; with borders; made smaller to fit the desktop */
    int wait;            /* 1: a swap waits for the screen. For one window of a thread only */
    const gw_log *log;   /* must outlive the window */
} gw_window_options;

/* GW_MACHINE when there is no X server, no such monitor (the error names those there are, the nearest name
 * first), no OpenGL 4.5 core, or when what was obtained is not what was asked for: the error names both. Its
 * context is current afterwards. Nothing iconifies it; full-screen hides the pointer; while one is open, the
 * screen saver of the X server is off. */
gw_code gw_window_create(const gw_window_options *options, gw_window **out, gw_error *error);
void gw_window_destroy(gw_window **window); /* accepts NULL and a NULL window */

/* A context that shares objects with the window's, in a window that is never shown, for another thread: made
 * and destroyed on the main thread, current on the other one from take to leave. */
gw_code gw_window_share(const gw_window *window, gw_window **out, gw_error *error);
gw_code gw_window_take(gw_window *window, gw_error *error);
void gw_window_leave(void);

/* GW_MACHINE, with the reason, when no window can be opened on the display. */
gw_code gw_window_possible(gw_error *error);

/* Keys: printable ones are their upper-case ASCII. */
typedef enum gw_key {
    GW_KEY_ESCAPE = 256,
    GW_KEY_ENTER,
    GW_KEY_TAB,
    GW_KEY_LEFT,
    GW_KEY_RIGHT,
    GW_KEY_UP,
    GW_KEY_DOWN,
    GW_KEY_PAGE_UP,
    GW_KEY_PAGE_DOWN,
    GW_KEY_HOME,
    GW_KEY_SHIFT,
    GW_KEY_CONTROL,
    GW_KEY_F1,
    GW_KEY_END /* none: one more than the last */
} gw_key;

typedef enum gw_event_kind {
    GW_EVENT_KEY_DOWN, /* key; not repeated while it is held */
    GW_EVENT_KEY_UP,
    GW_EVENT_POINTER,     /* position in px of the window's picture */
    GW_EVENT_BUTTON_DOWN, /* key: 0 left, 1 right, 2 middle */
    GW_EVENT_BUTTON_UP,
    GW_EVENT_SCROLL, /* position[1]: notches, away from the user is positive */
    GW_EVENT_BLUR,   /* keys and buttons will not be heard any more: they count as up */
    GW_EVENT_CLOSE
} gw_event_kind;

typedef struct gw_event {
    gw_event_kind kind;
    int32_t key;
    double position[2];
} gw_event;

/* What has happened since the last call, oldest first; of more than it can hold the newest are dropped, but a
 * close never is. Valid until the next call. */
const gw_event *gw_window_poll(gw_window *window, size_t *count);
/* Answers the window system, so that it does not take the window for hung during long work; what happens is
 * kept for the next poll. Ends what an earlier poll gave. */
void gw_window_attend(gw_window *window);
/* Of its picture, px; 0 x 0 while it is iconified by hand. */
void gw_window_size(const gw_window *window, uint32_t size[2]);
/* Asks for another size; the desktop decides. */
void gw_window_resize(gw_window *window, const uint32_t size[2]);
/* Shows what was drawn into its back buffer. */
void gw_window_swap(gw_window *window);

#endif
