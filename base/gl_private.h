/* What the files of the GL device share among themselves; nobody else includes this. */
#ifndef GW_BASE_GL_PRIVATE_H
#define GW_BASE_GL_PRIVATE_H

#include "base/gl.h"

#include <epoxy/egl.h>

/* A compiled program, found again by name and defines. */
typedef struct gw_gl_cached_program {
    char *name, *defines;
    GLuint id;
} gw_gl_cached_program;

struct gw_gl {
    EGLDisplay display;
    EGLContext context;
    gw_gl_limits limits;
    const gw_log *log;
    char *shader_folder; /* NULL: embedded */
    gw_gl_cached_program *programs;
    size_t program_count, program_capacity;
};

/* Deletes all programs and frees the cache. */
void gw_gl_programs_finish(gw_gl *device);

#endif
