/* The GL device: one OpenGL 4.5 core context, without a window (EGL) or of a window (base/window.h), its
 * limits, programs from the embedded shader library, buffers, and a clock that works on software GL too. What
 * is drawn depends on the driver, not on whether there is a window.
 *
 * A device belongs to the thread that created it. Everything made here must be destroyed before its device.
 * Limits are data: ask gw_gl_limits, never the vendor string. */
#ifndef GW_BASE_GL_H
#define GW_BASE_GL_H

#include "base/hash.h"
#include "base/log.h"
#include "base/status.h"
#include "base/window.h"

#include <epoxy/gl.h>
#include <stddef.h>
#include <stdint.h>

typedef struct gw_gl gw_gl;

/* Storage buffers have a binding point each, the same in all kernels; OpenGL 4.5 promises 8 only, drivers
 * give 32 to 96. */
enum { GW_GL_STORAGE_BINDINGS = 31 };

typedef struct gw_gl_limits {
    char vendor[128], renderer[256], version[256]; /* as the driver says; part of the build's identity */
    int64_t storage_block_bytes;                   /* GL_MAX_SHADER_STORAGE_BLOCK_SIZE */
    int64_t texture_buffer_texels;                 /* GL_MAX_TEXTURE_BUFFER_SIZE */
    int64_t work_groups[3];                        /* GL_MAX_COMPUTE_WORK_GROUP_COUNT */
    int32_t work_group_invocations, shared_bytes;
    int32_t storage_blocks, texture_units; /* in the compute stage */
    int32_t storage_bindings;              /* GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, of all stages */
    int32_t texture_side, texture_layers;  /* px of a 2D texture; layers of an array */
    int32_t program_binary_formats;        /* 0 is normal */
    int32_t resets_told;                   /* 1: the driver tells when the GPU was reset */
    int32_t software;                      /* 1: llvmpipe, softpipe or another CPU rasteriser */
} gw_gl_limits;

typedef struct gw_gl_options {
    const char *shader_folder;       /* read shaders here instead of the embedded ones; NULL: embedded */
    int debug;                       /* 1: debug context, driver messages go to the log */
    const gw_log *log;               /* must outlive the device */
    const gw_window_options *window; /* make this window, which the device then owns; NULL: none */
    /* Folder where the binaries of programs are read and kept (gw_gl_keep_programs); NULL: nowhere. Unheeded
     * where the driver offers no format, and on software GL, where a binary spares the link of some ms and
     * not the compilation of seconds - unless binaries_always. */
    const char *binaries;
    int binaries_always;
    int choose_gpu; /* 1, without a window: on the EGL device `gpu` and no other */
    int32_t gpu;    /* its index, from 0 (gw_gl_list_gpus) */
} gw_gl_options;

/* GW_MACHINE when there is no window, or no EGL device that gives 4.5 core. Leaves the context current on
 * this thread. */
gw_code gw_gl_create(const gw_gl_options *options, gw_gl **out, gw_error *error);
void gw_gl_destroy(gw_gl **device); /* accepts NULL and a NULL device */

/* A second device beside `with`, whose buffers, textures and programs it may use, for another thread: made
 * and destroyed on the thread of `with`, before which it is destroyed; between the two, current on that other
 * thread from take to leave. Has no log. What it made itself can be deleted by either. GW_MACHINE where the
 * driver shares nothing. */
gw_code gw_gl_create_shared(gw_gl *with, gw_gl **out, gw_error *error);
gw_code gw_gl_take(gw_gl *device, gw_error *error);
void gw_gl_leave(gw_gl *device);
/* From any thread: it compiles nothing more; whatever would need it fails with GW_INTERRUPTED. */
void gw_gl_stop_compiling(gw_gl *device);

const gw_gl_limits *gw_gl_limits_of(const gw_gl *device);
const gw_log *gw_gl_log(const gw_gl *device);
gw_window *gw_gl_window(const gw_gl *device); /* the one it owns, or NULL */

/* The GPUs (and software) that EGL lists, by index; 0 when it cannot list any. Needs no device. */
enum { GW_GL_MAXIMUM_GPUS = 16 };
typedef struct gw_gl_gpu {
    char name[256]; /* what EGL tells about it, and its device file */
} gw_gl_gpu;
size_t gw_gl_list_gpus(gw_gl_gpu out[GW_GL_MAXIMUM_GPUS]);

/* Called on the device's thread between pieces of long work: before and after slices of a dispatch, and
 * before a program is compiled. silence: s for which it may not be called again, because the driver compiles;
 * 0: as usual, which is about 200 ms also on software GL. Not called while the GPU is waited for, so a GPU
 * that hangs is silent. NULL: nobody (as at first). */
typedef void gw_gl_pulse(void *context, double silence);
void gw_gl_set_pulse(gw_gl *device, gw_gl_pulse *pulse, void *context);

/* Bytes of the buffers that exist on the device, and the most that existed at once since the peak was reset.
 * Textures and the driver's own memory are not in it. */
typedef struct gw_gl_usage {
    uint64_t bytes, peak;
} gw_gl_usage;
gw_gl_usage gw_gl_usage_of(const gw_gl *device);
void gw_gl_reset_peak(gw_gl *device);
/* Bytes of the buffers of this name that exist now; and all names that buffers had so far, by index: NULL
 * past the last. */
uint64_t gw_gl_buffer_bytes(const gw_gl *device, const char *name);
const char *gw_gl_buffer_name(const gw_gl *device, size_t index);

/* Compute program from shaders/<name> ("trace/primary.comp"). #include "common/x.glsl" is resolved against
 * shaders/, each file once; #line keeps error positions. defines is a text of "#define A 1\n" lines put after
 * the version line (NULL for none). "#version 450 core" is put first by this function. The same (name,
 * defines) is compiled once and shared: programs belong to the device. */
gw_code gw_gl_program(gw_gl *device, const char *name, const char *defines, GLuint *out, gw_error *error);
/* Program that draws, from shaders/<name>.vert, .geom and .frag. */
gw_code gw_gl_draw_program(gw_gl *device, const char *name, const char *defines, GLuint *out,
                           gw_error *error);
/* Specialised kernels: all programs asked for between begin and end belong to the variant of this key. At
 * most GW_GL_VARIANTS are alive: a further one takes the place of the one that was begun longest ago, and
 * programs that belong to no other are deleted. So nobody may keep such a program beyond the end. Programs
 * that were asked for outside stay. */
enum { GW_GL_VARIANTS = 8 };
void gw_gl_variant_begin(gw_gl *device, gw_hash key);
void gw_gl_variant_end(gw_gl *device);
typedef struct gw_gl_variant_counts {
    uint32_t alive;             /* variants */
    uint64_t programs, deleted; /* programs of the device that are alive; those deleted so far */
} gw_gl_variant_counts;
gw_gl_variant_counts gw_gl_variant_counts_of(const gw_gl *device);
int gw_gl_variant_lives(const gw_gl *device, gw_hash key);
/* Programs of a variant that a device which shares objects has made, and done with: those that this one lacks
 * become its own, in the variant of that key; it may take another's place. Nobody else may use `from`
 * meanwhile. */
gw_code gw_gl_variant_adopt(gw_gl *device, gw_gl *from, gw_hash key, gw_error *error);
/* The programs that were compiled so far, and are alive, by index: 0 past the last. */
int gw_gl_program_at(const gw_gl *device, size_t index, const char **name, const char **defines);
/* The next programs, up to the variant's end, are at most this many: compiling them is told as progress. */
void gw_gl_expect_programs(gw_gl *device, uint32_t most);
/* Of this device: programs that were compiled, linked by a binary, and whose binary was of no use. */
typedef struct gw_gl_program_counts {
    uint64_t compiled, read, refused;
} gw_gl_program_counts;
gw_gl_program_counts gw_gl_program_counts_of(const gw_gl *device);
/* Writes the binaries of programs that were compiled since it was last called, and removes those that were
 * not used for longest until all are within GW_GL_BINARIES_LIMIT. GW_NO_OUTPUT when one cannot be written. */
#define GW_GL_BINARY_SUFFIX ".gwp"
enum { GW_GL_BINARIES_LIMIT = 256 << 20 /* bytes: hundreds of kernels */ };
gw_code gw_gl_keep_programs(gw_gl *device, gw_error *error);
/* The assembled text that gw_gl_program would compile; free() it. */
gw_code gw_gl_shader_text(gw_gl *device, const char *name, const char *defines, char **out, gw_error *error);
/* Location of a uniform that must exist and be used; GW_MACHINE names both otherwise. -1 is never returned as
 * OK. */
gw_code gw_gl_uniform(GLuint program, const char *name, GLint *out, gw_error *error);

/* A buffer, by name for messages. size 0 is rounded up to 16 so that it can be bound. */
typedef struct gw_gl_buffer {
    gw_gl *device;
    GLuint id;
    size_t size;     /* bytes */
    GLuint texture;  /* buffer texture over the whole buffer, 0 if none */
    size_t capacity; /* bytes of storage, size or more; nothing beyond size can be seen */
    gw_gl *keeper;   /* the device whose pool the storage goes back to, NULL: it is deleted */
    char name[32];
} gw_gl_buffer;

/* Checks size against storage_block_bytes and fails with GW_MACHINE "needs N MiB ... limit M MiB" beyond it,
 * unless the buffer is only read through a texture (as_texture != 0: then texels are checked against
 * texture_buffer_texels). as_texture is the internal format (GL_RGBA32UI, GL_R32UI, GL_RG32UI, GL_RGB32UI) or
 * 0 for none. data may be NULL: contents are then zero. */
gw_code gw_gl_buffer_create(gw_gl *device, const char *name, size_t size, const void *data, GLenum as_texture,
                            gw_gl_buffer *out, gw_error *error);
void gw_gl_buffer_finish(gw_gl_buffer *buffer); /* accepts an empty one */
gw_code gw_gl_buffer_write(gw_gl_buffer *buffer, size_t offset, size_t size, const void *data,
                           gw_error *error);
/* Waits for the GPU, then copies. */
gw_code gw_gl_buffer_read(const gw_gl_buffer *buffer, size_t offset, size_t size, void *data,
                          gw_error *error);
void gw_gl_buffer_bind(const gw_gl_buffer *buffer, GLuint binding); /* as shader storage */
/* The part from `offset` on, `size` bytes long; offset is a multiple of 256. */
void gw_gl_buffer_bind_range(const gw_gl_buffer *buffer, GLuint binding, size_t offset, size_t size);
void gw_gl_texture_bind(const gw_gl_buffer *buffer, GLuint texture_unit); /* its buffer texture */

/* The pool: storage of finished buffers is kept for buffers to come of about the same size (up to a quarter
 * is wasted). For work that is done anew for every frame; off until asked for, and only buffers made while it
 * is on take part. */
typedef struct gw_gl_pool_counts {
    uint64_t made, reused; /* buffers since the device was made: with fresh storage, with that of another */
    uint64_t idle_bytes;   /* kept for buffers to come */
} gw_gl_pool_counts;
void gw_gl_pool_start(gw_gl *device);
/* Frees what is idle; from here on buffers are freed when they are finished. */
void gw_gl_pool_stop(gw_gl *device);
gw_gl_pool_counts gw_gl_pool_counts_of(const gw_gl *device);

/* Dispatches `groups` one-dimensional work groups of `program` in slices no larger than the driver's limit,
 * setting the uniform uint "group_base" (optional in the shader when one slice is enough) before each, with a
 * storage and texture fetch barrier after the last. */
gw_code gw_gl_dispatch(gw_gl *device, GLuint program, uint64_t groups, gw_error *error);
/* The same for as many groups as the three words at `offset` of the buffer say, which a kernel may have
 * written: at most 65,535 in x, 1 in y and z. */
gw_code gw_gl_dispatch_indirect(gw_gl *device, GLuint program, const gw_gl_buffer *arguments, size_t offset,
                                gw_error *error);
/* Waits until all that was issued is done, by a fence. */
gw_code gw_gl_finish(gw_gl *device, gw_error *error);
/* GW_MACHINE when the GPU was reset and this context with it: all that was on it is gone. A driver that does
 * not tell is believed. */
gw_code gw_gl_check_reset(gw_error *error);
/* GW_MACHINE naming `where` if GL has recorded an error. */
gw_code gw_gl_check(const char *where, gw_error *error);

#endif
