#include "base/window_wake.h"

#include <dlfcn.h>
#include <string.h>

/* GLFW's own declaration wants the headers of RandR, which nothing here needs. */
typedef struct _XDisplay Display;
Display *glfwGetX11Display(void);

typedef int (*query_function)(Display *, int *, int *);
typedef void (*suspend_function)(Display *, int);

/* POSIX lets a function's address travel as an object's; ISO C wants it copied. */
static void find(void *library, const char *name, void *function, size_t size) {
    void *address = dlsym(library, name);
    memcpy(function, &address, size);
}

/* The request leaves with the next events that are polled. */
static int suspend(void *library, int on) {
    query_function query;
    suspend_function suspend_saver;
    int event_base, error_base;
    Display *display = glfwGetX11Display();
    find(library, "XScreenSaverQueryExtension", &query, sizeof query);
    find(library, "XScreenSaverSuspend", &suspend_saver, sizeof suspend_saver);
    if (!display || !query || !suspend_saver || !query(display, &event_base, &error_base))
        return 0;
    suspend_saver(display, on);
    return 1;
}

void gw_window_wake_start(gw_window_wake *wake, const gw_log *log) {
    wake->library = dlopen("libXss.so.1", RTLD_NOW | RTLD_LOCAL);
    if (wake->library && suspend(wake->library, 1))
        return;
    gw_log_write(log, GW_LOG_INFO, "the screen saver stays on: %s; switch it off by hand (xset s off -dpms)",
                 wake->library ? "the X server has no extension MIT-SCREEN-SAVER"
                               : "libXss is not installed");
    if (wake->library)
        dlclose(wake->library);
    wake->library = NULL;
}

void gw_window_wake_stop(gw_window_wake *wake) {
    if (!wake->library)
        return;
    suspend(wake->library, 0);
    dlclose(wake->library);
    wake->library = NULL;
}
