#include "base/window.h"

#include "base/clock.h"
#include "base/suggest.h"
#include "base/window_monitor.h"
#include "base/window_wake.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAXIMUM_EVENTS = 256, LEAST_WIDTH = 640, LEAST_HEIGHT = 400 /* px */ };

/* A window manager may still move and shape a new window; it is given this long. */
static const int64_t settling_ns = 2000000000;

struct gw_window {
    GLFWwindow *handle;
    int wish; /* how its context was asked for */
    const gw_log *log;
    gw_window_wake wake;
    gw_event events[MAXIMUM_EVENTS]; /* since the last poll */
    size_t count;
    int taken; /* a poll has given them away */
};

/* --- events
 * ----------------------------------------------------------------------------------------------------- */

static void note(GLFWwindow *handle, gw_event_kind kind, int32_t key, double x, double y) {
    gw_window *window = glfwGetWindowUserPointer(handle);
    gw_event *last = window->count ? &window->events[window->count - 1] : NULL;
    gw_event event = {.kind = kind, .key = key, .position = {x, y}};
    /* Of a pointer that moves, where it came to is enough. */
    if (last && last->kind == GW_EVENT_POINTER && kind == GW_EVENT_POINTER)
        *last = event;
    else if (window->count < MAXIMUM_EVENTS)
        window->events[window->count++] = event;
    else if (kind == GW_EVENT_CLOSE)
        *last = event;
}

static int32_t key_of(int key) {
    static const struct {
        int glfw;
        int32_t ours;
    } named[] = {{GLFW_KEY_ESCAPE, GW_KEY_ESCAPE},
                 {GLFW_KEY_ENTER, GW_KEY_ENTER},
                 {GLFW_KEY_TAB, GW_KEY_TAB},
                 {GLFW_KEY_LEFT, GW_KEY_LEFT},
                 {GLFW_KEY_RIGHT, GW_KEY_RIGHT},
                 {GLFW_KEY_UP, GW_KEY_UP},
                 {GLFW_KEY_DOWN, GW_KEY_DOWN},
                 {GLFW_KEY_PAGE_UP, GW_KEY_PAGE_UP},
                 {GLFW_KEY_PAGE_DOWN, GW_KEY_PAGE_DOWN},
                 {GLFW_KEY_HOME, GW_KEY_HOME},
                 {GLFW_KEY_LEFT_SHIFT, GW_KEY_SHIFT},
                 {GLFW_KEY_RIGHT_SHIFT, GW_KEY_SHIFT},
                 {GLFW_KEY_LEFT_CONTROL, GW_KEY_CONTROL},
                 {GLFW_KEY_RIGHT_CONTROL, GW_KEY_CONTROL},
                 {GLFW_KEY_F1, GW_KEY_F1}};
    for (size_t i = 0; i < sizeof named / sizeof named[0]; i++)
        if (named[i].glfw == key)
            return named[i].ours;
    return key >= ' ' && key < 127 ? key : 0;
}

static void on_key(GLFWwindow *handle, int key, int scancode, int action, int modifiers) {
    (void)scancode;
    (void)modifiers;
    int32_t ours = key_of(key);
    if (ours && action != GLFW_REPEAT)
        note(handle, action == GLFW_PRESS ? GW_EVENT_KEY_DOWN : GW_EVENT_KEY_UP, ours, 0, 0);
}

static void on_pointer(GLFWwindow *handle, double x, double y) {
    int inside[2], picture[2];
    glfwGetWindowSize(handle, &inside[0], &inside[1]);
    glfwGetFramebufferSize(handle, &picture[0], &picture[1]);
    if (inside[0] > 0 && inside[1] > 0)
        note(handle, GW_EVENT_POINTER, 0, x * picture[0] / inside[0], y * picture[1] / inside[1]);
}

static void on_button(GLFWwindow *handle, int button, int action, int modifiers) {
    (void)modifiers;
    note(handle, action == GLFW_PRESS ? GW_EVENT_BUTTON_DOWN : GW_EVENT_BUTTON_UP, button, 0, 0);
}

static void on_scroll(GLFWwindow *handle, double x, double y) {
    note(handle, GW_EVENT_SCROLL, 0, x, y);
}

static void on_focus(GLFWwindow *handle, int focused) {
    if (!focused)
        note(handle, GW_EVENT_BLUR, 0, 0, 0);
}

static void on_close(GLFWwindow *handle) {
    note(handle, GW_EVENT_CLOSE, 0, 0, 0);
}

static void listen(gw_window *window) {
    glfwSetWindowUserPointer(window->handle, window);
    glfwSetKeyCallback(window->handle, on_key);
    glfwSetCursorPosCallback(window->handle, on_pointer);
    glfwSetMouseButtonCallback(window->handle, on_button);
    glfwSetScrollCallback(window->handle, on_scroll);
    glfwSetWindowFocusCallback(window->handle, on_focus);
    glfwSetWindowCloseCallback(window->handle, on_close);
}

void gw_window_attend(gw_window *window) {
    if (window->taken)
        window->count = 0;
    window->taken = 0;
    glfwPollEvents();
}

const gw_event *gw_window_poll(gw_window *window, size_t *count) {
    gw_window_attend(window);
    window->taken = 1;
    *count = window->count;
    return window->events;
}

/* --- opening
 * ---------------------------------------------------------------------------------------------------- */

/* What GLFW says about the call that failed last. */
static const char *reason(void) {
    const char *text = NULL;
    return glfwGetError(&text) == GLFW_NO_ERROR || !text ? "no reason given" : text;
}

gw_code gw_window_possible(gw_error *error) {
    const char *display = getenv("DISPLAY");
    if (!display || !*display)
        return gw_fail(
            error, GW_MACHINE,
            "no window can be opened: DISPLAY is not set; set it to an X server, as in DISPLAY=:0, "
            "or draw without windows (--headless)");
    if (!glfwInit())
        return gw_fail(
            error, GW_MACHINE,
            "no window can be opened on display '%s': %s; set DISPLAY to an X server that runs and "
            "lets you in, or draw without windows (--headless)",
            display, reason());
    return GW_OK;
}

/* How a context is asked for: EGL first, as without a window: one driver for both. GLX serves where the
 * display's EGL does not. That a reset of the GPU be told is asked where the driver can. */
typedef struct context_wish {
    int api, robustness;
} context_wish;
static const context_wish wishes[] = {{GLFW_EGL_CONTEXT_API, GLFW_LOSE_CONTEXT_ON_RESET},
                                      {GLFW_EGL_CONTEXT_API, GLFW_NO_ROBUSTNESS},
                                      {GLFW_NATIVE_CONTEXT_API, GLFW_LOSE_CONTEXT_ON_RESET},
                                      {GLFW_NATIVE_CONTEXT_API, GLFW_NO_ROBUSTNESS}};
enum { WISH_COUNT = sizeof wishes / sizeof wishes[0] };

static void hint(const gw_window_options *options, const context_wish *wish) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, wish->api);
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, wish->robustness);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    /* Pictures are blitted: nothing but colour is needed. */
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHint(GLFW_ALPHA_BITS, 0);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwWindowHint(GLFW_RESIZABLE, options->resizable ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_DECORATED, options->placed ? GLFW_FALSE : GLFW_TRUE);
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, options->placed ? GLFW_FALSE : GLFW_TRUE);
    /* Shown when it stands where it belongs. */
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
}

/* A full-screen window keeps the mode that the monitor is in: a mode that is switched behind the user's back
 * would move every other window of the desktop. */
static gw_code check_mode(const gw_window_options *options, const gw_monitor *monitor, gw_error *error) {
    if (monitor->size[0] == options->size[0] && monitor->size[1] == options->size[1])
        return GW_OK;
    return gw_fail(error, GW_MACHINE,
                   "%s: asked for %" PRIu32 "x%" PRIu32 " px on monitor %s, which shows %" PRIu32 "x%" PRIu32
                   " px; set its mode (xrandr --output %s --mode %" PRIu32 "x%" PRIu32
                   ") or the tile's pixels",
                   options->title, options->size[0], options->size[1], monitor->name, monitor->size[0],
                   monitor->size[1], monitor->name, options->size[0], options->size[1]);
}

/* The size to open with: a resizable window must not be larger than the desktop, nor too small to be read. */
static void fit(const gw_window_options *options, int size[2]) {
    const double share = 0.9;
    double scale = 1;
    int at[2], room[2] = {0, 0};
    GLFWmonitor *primary = options->resizable ? glfwGetPrimaryMonitor() : NULL;
    if (primary)
        glfwGetMonitorWorkarea(primary, &at[0], &at[1], &room[0], &room[1]);
    for (int i = 0; i < 2; i++)
        if (room[i] > 0 && scale * options->size[i] > share * room[i])
            scale = share * room[i] / options->size[i];
    for (int i = 0; i < 2; i++) {
        const int least = !options->resizable ? 1 : i ? LEAST_HEIGHT : LEAST_WIDTH;
        size[i] = (int)(scale * options->size[i]);
        size[i] = size[i] < least ? least : size[i];
    }
}

static gw_code make(gw_window *window, const gw_window_options *options, const gw_monitor *monitor,
                    gw_error *error) {
    int size[2];
    fit(options, size);
    char tried[WISH_COUNT][256];
    for (int i = 0; i < WISH_COUNT && !window->handle; i++) {
        hint(options, &wishes[i]);
        if (monitor)
            glfwWindowHint(GLFW_REFRESH_RATE, monitor->refresh);
        window->handle =
            glfwCreateWindow(size[0], size[1], options->title, monitor ? monitor->handle : NULL, NULL);
        window->wish = i;
        if (!window->handle)
            snprintf(tried[i], sizeof tried[i], "%s", reason());
    }
    if (!window->handle)
        return gw_fail(error, GW_MACHINE,
                       "%s: no window with OpenGL 4.5 core on display '%s'; install a driver such as "
                       "libgl1-mesa-dri (by EGL: %s; by GLX: %s)",
                       options->title, getenv("DISPLAY"), tried[1], tried[3]);
    return GW_OK;
}

static int stands_right(const gw_window *window, const gw_window_options *options, const int32_t at[2],
                        int got[4]) {
    glfwGetWindowPos(window->handle, &got[0], &got[1]);
    glfwGetFramebufferSize(window->handle, &got[2], &got[3]);
    return got[0] == at[0] && got[1] == at[1] && got[2] == (int)options->size[0] &&
           got[3] == (int)options->size[1];
}

/* A tile a few pixels off, or scaled, is a wall whose lines break at its edge. */
static gw_code check_place(const gw_window *window, const gw_window_options *options, const int32_t at[2],
                           gw_error *error) {
    int got[4];
    for (int64_t end = gw_now_ns() + settling_ns; gw_now_ns() < end; glfwWaitEventsTimeout(0.02))
        if (stands_right(window, options, at, got))
            return GW_OK;
    return gw_fail(error, GW_MACHINE,
                   "%s: asked for a window of %" PRIu32 "x%" PRIu32 " px at %" PRId32 ",%" PRId32
                   ", obtained %dx%d px at %d,%d; a window manager or the desktop's size is in the way: make "
                   "the desktop large enough, or let no window manager run there",
                   options->title, options->size[0], options->size[1], at[0], at[1], got[2], got[3], got[0],
                   got[1]);
}

static gw_code open_window(gw_window *window, const gw_window_options *options, gw_error *error) {
    gw_monitor monitor;
    const int full = options->monitor && *options->monitor;
    gw_code code = gw_window_possible(error);
    if (!code && full)
        code = gw_monitor_find(options->monitor, &monitor, error);
    if (!code && full)
        code = check_mode(options, &monitor, error);
    if (!code)
        code = make(window, options, full ? &monitor : NULL, error);
    if (code)
        return code;
    listen(window);
    if (full)
        glfwSetInputMode(window->handle, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    if (options->placed && !full)
        glfwSetWindowPos(window->handle, options->position[0], options->position[1]);
    glfwShowWindow(window->handle);
    if (full || options->placed)
        code = check_place(window, options, full ? monitor.position : options->position, error);
    if (code)
        return code;
    gw_window_wake_start(&window->wake, options->log);
    glfwMakeContextCurrent(window->handle);
    glfwSwapInterval(options->wait ? 1 : 0);
    return GW_OK;
}

gw_code gw_window_create(const gw_window_options *options, gw_window **out, gw_error *error) {
    *out = NULL;
    gw_window *window = calloc(1, sizeof *window);
    if (!window)
        return gw_fail(error, GW_MACHINE, "not enough memory for a window");
    window->log = options->log;
    gw_code code = open_window(window, options, error);
    if (code) {
        gw_window_destroy(&window);
        return code;
    }
    gw_log_write(window->log, GW_LOG_DEBUG, "%s: %" PRIu32 "x%" PRIu32 " px%s%s, swap interval %d",
                 options->title, options->size[0], options->size[1],
                 options->monitor && *options->monitor ? ", full-screen on " : "",
                 options->monitor ? options->monitor : "", options->wait ? 1 : 0);
    *out = window;
    return GW_OK;
}

gw_code gw_window_share(const gw_window *window, gw_window **out, gw_error *error) {
    const gw_window_options unseen = {.placed = 1};
    *out = NULL;
    gw_window *made = calloc(1, sizeof *made);
    if (!made)
        return gw_fail(error, GW_MACHINE, "not enough memory for a second GL context");
    hint(&unseen, &wishes[window->wish]);
    made->handle = glfwCreateWindow(1, 1, "Gazewall kernels", NULL, window->handle);
    if (!made->handle) {
        free(made);
        return gw_fail(error, GW_MACHINE, "no second GL context beside the window's: %s", reason());
    }
    *out = made;
    return GW_OK;
}

gw_code gw_window_take(gw_window *window, gw_error *error) {
    glfwMakeContextCurrent(window->handle);
    return glfwGetCurrentContext() == window->handle
               ? GW_OK
               : gw_fail(error, GW_MACHINE, "the GL context cannot be used on this thread: %s", reason());
}

void gw_window_leave(void) {
    glfwMakeContextCurrent(NULL);
}

void gw_window_destroy(gw_window **window) {
    if (!window || !*window)
        return;
    gw_window_wake_stop(&(*window)->wake);
    if ((*window)->handle)
        glfwDestroyWindow((*window)->handle);
    free(*window);
    *window = NULL;
}

/* --- use
 * -------------------------------------------------------------------------------------------------------- */

void gw_window_size(const gw_window *window, uint32_t size[2]) {
    int got[2];
    glfwGetFramebufferSize(window->handle, &got[0], &got[1]);
    size[0] = got[0] > 0 ? (uint32_t)got[0] : 0;
    size[1] = got[1] > 0 ? (uint32_t)got[1] : 0;
}

void gw_window_resize(gw_window *window, const uint32_t size[2]) {
    glfwSetWindowSize(window->handle, (int)size[0], (int)size[1]);
}

void gw_window_swap(gw_window *window) {
    glfwSwapBuffers(window->handle);
}
