/* Assembles the text of a shader: version line, defines, the file, and the files that it includes, each once.
 *
 * `#include "common/x.glsl"` is resolved against shaders/, whatever file it stands in. A file that was
 * already taken in outside of any #if is not taken in again; inside one it is wrapped in a guard, so that the
 * compiler's preprocessor decides. #line directives carry (line, file number), so that messages can be mapped
 * back with gw_shader_text_message. Any thread. */
#ifndef GW_BASE_SHADER_TEXT_H
#define GW_BASE_SHADER_TEXT_H

#include "base/status.h"

#include <stddef.h>

typedef struct gw_shader_text {
    char *text;   /* for the compiler */
    char **files; /* [file_count] names by the file number of the #line directives:
                     "shaders/trace/primary.comp" */
    size_t file_count;
} gw_shader_text;

/* folder: read shaders from there ("/somewhere/shaders") instead of the embedded ones; NULL: embedded. name:
 * "trace/primary.comp". defines: "#define A 1\n" lines or NULL. GW_BAD_INPUT names the file and line of an
 * #include that leads nowhere or back to itself. */
gw_code gw_shader_text_create(const char *folder, const char *name, const char *defines, gw_shader_text *out,
                              gw_error *error);
void gw_shader_text_finish(gw_shader_text *text);

/* A compiler's log with file numbers replaced by file names; knows the forms "N:LINE", "N(LINE)" and "ERROR:
 * N:LINE". free() the result; NULL when memory is out. */
char *gw_shader_text_message(const gw_shader_text *text, const char *log);

#endif
