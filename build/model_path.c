#include "build/model_path.h"

#include "base/file.h"
#include "base/memory.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* How far up the name leads at most: 0 stays in the folder. */
static int levels_up(const char *name) {
    int depth = 0, lowest = 0;
    while (*name) {
        size_t length = strcspn(name, "/");
        if (length == 2 && name[0] == '.' && name[1] == '.')
            depth--;
        else if (length > 0 && !(length == 1 && name[0] == '.'))
            depth++;
        lowest = depth < lowest ? depth : lowest;
        name += length;
        name += *name == '/';
    }
    return -lowest;
}

gw_code gw_model_path(const char *folder, const char *name, char **out, gw_error *error) {
    *out = NULL;
    char *plain = gw_copy_text(name);
    if (!plain)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    for (char *c = plain; *c; c++)
        if (*c == '\\')
            *c = '/';
    gw_code code = GW_OK;
    if (plain[0] == '\0')
        code = gw_fail(error, GW_BAD_INPUT, "an empty file name");
    else if (plain[0] == '/' || (isalpha((unsigned char)plain[0]) && plain[1] == ':'))
        code = gw_fail(
            error, GW_BAD_INPUT,
            "the model names the absolute path '%s': put the file beside the model and name it without a "
            "leading folder",
            name);
    else if (levels_up(plain) > 1)
        code =
            gw_fail(error, GW_BAD_INPUT,
                    "the model names '%s', more than one folder up: files must be in the model's folder, its "
                    "parent, or below",
                    name);
    else if (!(*out = gw_path_join(folder, plain)))
        code = gw_fail(error, GW_MACHINE, "out of memory for a file name");
    free(plain);
    return code;
}

static int hex_digit(char c) {
    if (c >= '0' && c <= '9')
        return c - '0';
    c = (char)tolower((unsigned char)c);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

void gw_uri_decode(char *text) {
    char *to = text;
    for (const char *from = text; *from; from++) {
        int high = from[0] == '%' ? hex_digit(from[1]) : -1;
        int low = high >= 0 ? hex_digit(from[2]) : -1;
        if (low >= 0 && high * 16 + low != 0) {
            *to++ = (char)(high * 16 + low);
            from += 2;
        } else {
            *to++ = *from;
        }
    }
    *to = '\0';
}
