/* Assembles the text of a shader: version line, defines, the file, and the files that it includes, each once.
 *
 * `#include "common/x.glsl"` is resolved against shaders/, whatever file it stands in. A file that was
 * already taken in outside of any #if is not taken in again; inside one it is wrapped in a guard, so that the
 * compiler's preprocessor decides. #line directives give every file its own range of line numbers - line L of
 * file k is k * GW_SHADER_LINES + L - because drivers lose the second number of #line;
 * gw_shader_text_message turns them back into names and lines. Any thread. */
#ifndef GW_BASE_SHADER_TEXT_H
#define GW_BASE_SHADER_TEXT_H

#include "base/status.h"

#include <stddef.h>

enum { GW_SHADER_LINES = 100000 }; /* no file may have as many lines */

typedef struct gw_shader_text {
    char *text;   /* for the compiler */
    char **files; /* [file_count] names by file number k: "shaders/trace/primary.comp" */
    size_t file_count;
} gw_shader_text;

/* folder: read shaders from there ("/somewhere/shaders") instead of the embedded ones; NULL: embedded. name:
 * "trace/primary.comp". defines: "#define A 1\n" lines or NULL; those whose name no line of the files reads
 * (comments aside) are left out, so that kernels which differ in nothing have one text and drivers translate
 * it once; what a define stands for names no other. GW_BAD_INPUT names the file and line of an #include that
 * leads nowhere or back to itself. */
gw_code gw_shader_text_create(const char *folder, const char *name, const char *defines, gw_shader_text *out,
                              gw_error *error);
void gw_shader_text_finish(gw_shader_text *text);

/* A compiler's log with its errors first and its line numbers replaced by file name and line; knows the forms
 * "0:LINE", "0(LINE)" and "ERROR: 0:LINE". free() the result; NULL when memory is out. */
char *gw_shader_text_message(const gw_shader_text *text, const char *log);

#endif
