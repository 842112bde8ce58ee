#include "base/window_monitor.h"

#include "base/suggest.h"

#include <GLFW/glfw3.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_MONITORS = 16 };

/* 0 when it is off. */
static int describe(GLFWmonitor *handle, gw_monitor *out) {
    const GLFWvidmode *mode = glfwGetVideoMode(handle);
    const char *name = glfwGetMonitorName(handle);
    if (!mode || !name)
        return 0;
    *out = (gw_monitor){.size = {(uint32_t)mode->width, (uint32_t)mode->height},
                        .refresh = mode->refreshRate,
                        .handle = handle};
    snprintf(out->name, sizeof out->name, "%s", name);
    glfwGetMonitorPos(handle, &out->position[0], &out->position[1]);
    return 1;
}

static gw_code refuse(const char *name, const gw_monitor *there, size_t count, gw_error *error) {
    const char *names[SHOWN_MONITORS];
    char list[1024] = "";
    size_t length = 0;
    for (size_t i = 0; i < count; i++) {
        names[i] = there[i].name;
        int written = snprintf(list + length, sizeof list - length, "%s%s (%" PRIu32 "x%" PRIu32 ")",
                               i ? ", " : "", there[i].name, there[i].size[0], there[i].size[1]);
        if (written > 0 && length + (size_t)written < sizeof list)
            length += (size_t)written;
    }
    const char *near = gw_suggest(name, names, count), *display = getenv("DISPLAY");
    return gw_fail(error, GW_MACHINE, "display '%s' has no monitor '%s'%s%s%s; it has: %s",
                   display ? display : "", name, near ? "; did you mean '" : "", near ? near : "",
                   near ? "'?" : "", count ? list : "none");
}

gw_code gw_monitor_find(const char *name, gw_monitor *out, gw_error *error) {
    gw_monitor there[SHOWN_MONITORS];
    size_t seen = 0;
    int count = 0;
    GLFWmonitor **handles = glfwGetMonitors(&count);
    for (int i = 0; i < count; i++) {
        if (!describe(handles[i], out))
            continue;
        if (!strcmp(out->name, name))
            return GW_OK;
        if (seen < SHOWN_MONITORS)
            there[seen++] = *out;
    }
    return refuse(name, there, seen, error);
}
