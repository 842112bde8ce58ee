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

static int is_absolute(const char *name) {
    return name[0] == '/' || (isalpha((unsigned char)name[0]) && name[1] == ':');
}

/* Backslashes and blanks at the end come from other systems and careless exporters. */
static char *plain_name(const char *name) {
    char *plain = gw_copy_text(name);
    if (!plain)
        return NULL;
    for (char *c = plain; *c; c++)
        if (*c == '\\')
            *c = '/';
    for (size_t length = strlen(plain); length > 0 && isspace((unsigned char)plain[length - 1]); length--)
        plain[length - 1] = '\0';
    return plain;
}

/* A path of the machine that made the model: the file may have come along in the model's folder. */
static gw_code path_of_absolute(const char *folder, const char *plain, char **out, gw_error *error) {
    *out = gw_path_join(folder, gw_path_name(plain));
    if (!*out)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    if (gw_file_exists(*out))
        return GW_OK;
    free(*out);
    *out = NULL;
    return gw_fail(error, GW_BAD_INPUT,
                   "the model names the absolute path '%s': put the file beside the model", plain);
}

gw_code gw_model_path(const char *folder, const char *name, char **out, gw_error *error) {
    *out = NULL;
    char *plain = plain_name(name);
    if (!plain)
        return gw_fail(error, GW_MACHINE, "out of memory for a file name");
    gw_code code = GW_OK;
    if (plain[0] == '\0')
        code = gw_fail(error, GW_BAD_INPUT, "an empty file name");
    else if (is_absolute(plain))
        code = path_of_absolute(folder, plain, out, error);
    else if (levels_up(plain) > 1)
        code =
            gw_fail(error, GW_BAD_INPUT,
                    "the model names '%s', more than one folder up: files must be in the model's folder, its "
                    "parent, or below",
                    plain);
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
