/* The monitors of the X display, by the names of their connectors. Main thread, as base/window.h. */
#ifndef GW_BASE_WINDOW_MONITOR_H
#define GW_BASE_WINDOW_MONITOR_H

#include "base/status.h"

#include <stdint.h>

struct GLFWmonitor;

typedef struct gw_monitor {
    char name[64]; /* connector, as RandR calls it */
    int32_t position[2];
    uint32_t size[2]; /* px, of the mode that it is in */
    int refresh;      /* Hz */
    struct GLFWmonitor *handle;
} gw_monitor;

/* GW_MACHINE when it is not there: the error names the nearest one and all that are. */
gw_code gw_monitor_find(const char *name, gw_monitor *out, gw_error *error);

#endif
