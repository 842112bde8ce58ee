/* Keeps the screen of the X server awake while a window is open: its screen saver and the monitors' power
 * saving, by the extension MIT-SCREEN-SAVER of the library libXss, which is looked for at run time. The
 * server ends it by itself when the process ends, however that happens. Lockers of a desktop environment that
 * do not ask the X server are not reached. Main thread. */
#ifndef GW_BASE_WINDOW_WAKE_H
#define GW_BASE_WINDOW_WAKE_H

#include "base/log.h"

typedef struct gw_window_wake {
    void *library; /* NULL: nothing to end */
} gw_window_wake;

/* Without the library or the extension a line in the log says so, and how to do it by hand. */
void gw_window_wake_start(gw_window_wake *wake, const gw_log *log);
void gw_window_wake_stop(gw_window_wake *wake); /* accepts one that was not started */

#endif
