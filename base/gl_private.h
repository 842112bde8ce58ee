/* What the files of the GL device share among themselves; nobody else includes this. */
#ifndef GW_BASE_GL_PRIVATE_H
#define GW_BASE_GL_PRIVATE_H

#include "base/gl.h"

#include <epoxy/egl.h>
#include <stdatomic.h>

/* A compiled program, found again by name and defines. */
typedef struct gw_gl_cached_program {
    char *name, *defines;
    GLuint id;
    int ran;        /* software GL compiles at the first dispatch */
    gw_hash source; /* gw_gl_binary_key() */
    int unkept;     /* compiled, and its binary not written yet */
    int replaces;   /* ... in the place of one that was refused */
    uint32_t
        variants; /* a bit for each place in gw_gl.variants; 0: never used within one, so never deleted */
} gw_gl_cached_program;

/* Storage that waits for its next buffer. */
typedef struct gw_gl_idle {
    GLuint id;
    size_t capacity;
} gw_gl_idle;

/* Specialised kernels that belong together. */
typedef struct gw_gl_variant {
    gw_hash key;
    uint64_t begun; /* when it was begun last: counts all beginnings; 0: a free place */
} gw_gl_variant;

/* Bytes of the buffers of one name. */
typedef struct gw_gl_named_bytes {
    char name[32];
    uint64_t bytes;
} gw_gl_named_bytes;

typedef struct gw_gl_pool {
    int on;
    gw_gl_idle *idle;
    size_t idle_count, idle_capacity;
    uint64_t made, reused;
} gw_gl_pool;

struct gw_gl {
    EGLDisplay display;
    EGLContext context; /* without a window, else EGL_NO_CONTEXT */
    gw_window *window;  /* whose context it is, or NULL */
    int debug, shared;  /* shared: objects are those of another device, on another thread */
    atomic_int stopped; /* of gw_gl_stop_compiling() */
    gw_gl_limits limits;
    const gw_log *log;
    char *shader_folder; /* NULL: embedded */
    gw_gl_cached_program *programs;
    size_t program_count, program_capacity;
    gw_gl_variant variants[GW_GL_VARIANTS];
    int variant; /* place of the one that was begun, -1: none */
    uint64_t variants_begun, programs_deleted, programs_compiled;
    char *binaries; /* folder of program binaries, NULL: none are read or kept */
    uint64_t binaries_read, binaries_refused;
    uint32_t expected,
        met_so_far;         /* programs of the work under way: most, and compiled; 0 expected: not told */
    int64_t expected_since; /* ns */
    gw_gl_pool pool;
    gw_gl_usage usage;
    gw_gl_named_bytes *named; /* a row for each name that a buffer ever had */
    size_t named_count, named_capacity;
    gw_gl_pulse *pulse;
    void *pulse_context;
};

/* Makes a context without a window and makes it current; gpu: the index of the EGL device, NULL: the first
 * display that serves. */
gw_code gw_gl_egl_open(gw_gl *device, int debug, const int32_t *gpu, gw_error *error);
void gw_gl_egl_close(gw_gl *device);

/* The same, sharing objects with `with`; it is made current nowhere. */
gw_code gw_gl_egl_share(const gw_gl *with, gw_gl *device, gw_error *error);
gw_code gw_gl_egl_take(gw_gl *device, gw_error *error);
void gw_gl_egl_leave(gw_gl *device);

/* Deletes all programs and frees the cache. */
void gw_gl_programs_finish(gw_gl *device);
void gw_gl_program_free(const gw_gl_cached_program *program);
/* gl_variant.c: whoever uses a program within a variant keeps it alive as long as the variant; outside, for
 * good. made: 1 if it was compiled just now. */
void gw_gl_variant_mark(const gw_gl *device, gw_gl_cached_program *program, int made);

/* gl_binary.c: names a program by the texts of its stages and the driver. */
gw_hash gw_gl_binary_key(const gw_gl *device, const char *const *texts, size_t count);
/* 1: the program is linked by a binary from disk. *refused: 1 if there is one that is cut, altered, or of no
 * use to the driver. */
int gw_gl_binary_read(gw_gl *device, gw_hash key, GLuint program, int *refused);

/* Storage for at least `size` bytes: idle storage of its class if there is some, or new. *id is 0
 * when the GPU has no room. */
void gw_gl_pool_take(gw_gl *device, size_t size, GLuint *id, size_t *capacity);
/* Takes storage back, or deletes it. */
void gw_gl_pool_give(gw_gl *device, GLuint id, size_t capacity);

#endif
