/* Lint's tool: prints the assembled text of a shader, with includes resolved as the program does it.
 *   assemble FOLDER NAME [NAME=VALUE ...]               e.g. assemble shaders trace/primary.comp COUNT=1
 *   assemble --messages FOLDER NAME [NAME=VALUE ...]    maps messages on standard input to files and lines
 */
#include "base/shader_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Messages of a whole compilation fit easily; a longer text is cut. */
static void map_messages(const gw_shader_text *text) {
    char log[65536];
    log[fread(log, 1, sizeof log - 1, stdin)] = '\0';
    char *message = gw_shader_text_message(text, log);
    printf("%s\n", message ? message : log);
    free(message);
}

int main(int argc, char **argv) {
    int messages = argc > 1 && strcmp(argv[1], "--messages") == 0;
    argc -= messages;
    argv += messages;
    if (argc < 3) {
        fprintf(stderr, "usage: assemble [--messages] FOLDER NAME [NAME=VALUE ...]\n");
        return 2;
    }
    char defines[4096] = "";
    size_t length = 0;
    for (int i = 3; i < argc; i++) {
        char *equals = strchr(argv[i], '=');
        size_t name = equals ? (size_t)(equals - argv[i]) : strlen(argv[i]);
        int written = snprintf(defines + length, sizeof defines - length, "#define %.*s %s\n", (int)name,
                               argv[i], equals ? equals + 1 : "1");
        if (written < 0 || (size_t)written >= sizeof defines - length) {
            fprintf(stderr, "assemble: too many defines\n");
            return 2;
        }
        length += (size_t)written;
    }
    gw_shader_text text;
    gw_error error = {0};
    if (gw_shader_text_create(argv[1], argv[2], defines, &text, &error)) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    if (messages) {
        map_messages(&text);
    } else {
        fputs(text.text, stdout);
    }
    gw_shader_text_finish(&text);
    return 0;
}
