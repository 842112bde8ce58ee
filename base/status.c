#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* What a file or packet said may be in the text: nothing of it may steer a terminal. */
static void disarm(char *text) {
    for (; *text; text++)
        if (((unsigned char)*text < ' ' && *text != '\n' && *text != '\t') || *text == 127)
            *text = '?';
}

/* Marks a text that did not fit. */
static void end_with_dots(gw_error *error) {
    memcpy(error->text + sizeof error->text - 4, "...", 4);
}

gw_code gw_fail(gw_error *error, gw_code code, const char *format, ...) {
    if (!error) {
        return code;
    }
    error->code = code;
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    if (length < 0) {
        error->text[0] = '\0';
    } else if ((size_t)length >= sizeof error->text) {
        end_with_dots(error);
    }
    disarm(error->text);
    return code;
}

gw_code gw_context(gw_error *error, const char *format, ...) {
    if (!error) {
        return GW_MACHINE;
    }
    char before[sizeof error->text];
    memcpy(before, error->text, sizeof before);
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    if (length < 0) {
        length = 0;
    }
    if ((size_t)length >= sizeof error->text) {
        end_with_dots(error);
        return error->code;
    }
    size_t room = sizeof error->text - (size_t)length;
    int rest = snprintf(error->text + length, room, ": %s", before);
    if (rest < 0 || (size_t)rest >= room) {
        end_with_dots(error);
    }
    disarm(error->text);
    return error->code;
}
