#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char *const level_names[] = {"error", "warning", "info", "debug"};

void gw_log_write(const gw_log *log, gw_log_level level, const char *format, ...) {
    if (!log || !log->line || level > log->threshold) {
        return;
    }
    char text[2048];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length < 0) {
        return;
    }
    if ((size_t)length >= sizeof text) {
        memcpy(text + sizeof text - 4, "...", 4);
    }
    log->line(log->context, level, text);
}

void gw_log_progress(const gw_log *log, const char *what, double fraction) {
    if (log && log->progress) {
        log->progress(log->context, what, fraction < 0 ? -1 : fraction > 1 ? 1 : fraction);
    }
}

const char *gw_log_level_name(gw_log_level level) {
    return level_names[level];
}

int gw_log_level_parse(const char *word, gw_log_level *level) {
    for (int i = GW_LOG_ERROR; i <= GW_LOG_DEBUG; i++) {
        if (strcmp(word, level_names[i]) == 0) {
            *level = (gw_log_level)i;
            return 1;
        }
    }
    return 0;
}
