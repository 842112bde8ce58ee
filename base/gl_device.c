/* The device: a context by EGL (base/gl_egl.c) or that of a window (base/window.h), its limits, waiting and
 * errors. */
#include "base/gl_private.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void GLAPIENTRY on_driver_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                         GLsizei length, const GLchar *message, const void *user) {
    (void)source;
    (void)id;
    (void)length;
    const gw_gl *device = user;
    gw_log_level level = type == GL_DEBUG_TYPE_ERROR            ? GW_LOG_ERROR
                         : severity == GL_DEBUG_SEVERITY_HIGH   ? GW_LOG_WARNING
                         : severity == GL_DEBUG_SEVERITY_MEDIUM ? GW_LOG_INFO
                                                                : GW_LOG_DEBUG;
    gw_log_write(device->log, level, "GL: %s", message);
}

static void copy_string(char *target, size_t size, GLenum name) {
    snprintf(target, size, "%s", (const char *)glGetString(name));
}

static int64_t ask(GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return value;
}

static int is_software(const char *renderer) {
    static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "Software Rasterizer"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (strstr(renderer, names[i])) {
            return 1;
        }
    }
    return 0;
}

static void ask_limits(gw_gl_limits *limits) {
    copy_string(limits->vendor, sizeof limits->vendor, GL_VENDOR);
    copy_string(limits->renderer, sizeof limits->renderer, GL_RENDERER);
    copy_string(limits->version, sizeof limits->version, GL_VERSION);
    limits->storage_block_bytes = ask(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    limits->texture_buffer_texels = ask(GL_MAX_TEXTURE_BUFFER_SIZE);
    for (GLuint axis = 0; axis < 3; axis++) {
        GLint groups = 0;
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, axis, &groups);
        limits->work_groups[axis] = groups;
    }
    limits->work_group_invocations = (int32_t)ask(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
    limits->shared_bytes = (int32_t)ask(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
    limits->storage_blocks = (int32_t)ask(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS);
    limits->storage_bindings = (int32_t)ask(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS);
    limits->texture_units = (int32_t)ask(GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS);
    limits->texture_side = (int32_t)ask(GL_MAX_TEXTURE_SIZE);
    limits->texture_layers = (int32_t)ask(GL_MAX_ARRAY_TEXTURE_LAYERS);
    limits->program_binary_formats = (int32_t)ask(GL_NUM_PROGRAM_BINARY_FORMATS);
    limits->resets_told = ask(GL_RESET_NOTIFICATION_STRATEGY) == GL_LOSE_CONTEXT_ON_RESET;
    limits->software = is_software(limits->renderer);
}

static gw_code open_context(gw_gl *device, const gw_gl_options *options, gw_error *error) {
    gw_code code = options && options->window
                       ? gw_window_create(options->window, &device->window, error)
                       : gw_gl_egl_open(device, options && options->debug,
                                        options && options->choose_gpu ? &options->gpu : NULL, error);
    if (!code && epoxy_gl_version() < 45)
        code = gw_fail(error, GW_MACHINE, "the GL driver gives %s, OpenGL 4.5 core is needed",
                       (const char *)glGetString(GL_VERSION));
    return code;
}

gw_code gw_gl_create(const gw_gl_options *options, gw_gl **out, gw_error *error) {
    *out = NULL;
    gw_gl *device = calloc(1, sizeof *device);
    if (!device) {
        return gw_fail(error, GW_MACHINE, "not enough memory for the GL device");
    }
    device->display = EGL_NO_DISPLAY;
    device->variant = -1;
    device->context = EGL_NO_CONTEXT;
    device->log = options ? options->log : NULL;
    device->debug = options && options->debug;
    gw_code code = GW_OK;
    if (options && options->shader_folder) {
        device->shader_folder = gw_copy_text(options->shader_folder);
        if (!device->shader_folder) {
            code = gw_fail(error, GW_MACHINE, "not enough memory for the GL device");
        }
    }
    if (!code) {
        code = open_context(device, options, error);
    }
    if (code) {
        gw_gl_destroy(&device);
        return code;
    }
    ask_limits(&device->limits);
    if (device->limits.storage_bindings < GW_GL_STORAGE_BINDINGS) {
        code = gw_fail(error, GW_MACHINE,
                       "the GL driver %s (%s) has %d binding points for storage buffers, %d are needed; use "
                       "a newer driver, or Mesa's software OpenGL (LIBGL_ALWAYS_SOFTWARE=1)",
                       device->limits.renderer, device->limits.version, device->limits.storage_bindings,
                       GW_GL_STORAGE_BINDINGS);
        gw_gl_destroy(&device);
        return code;
    }
    if (options && options->debug) {
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageCallback(on_driver_message, device);
    }
    const int spares = device->limits.program_binary_formats > 0 &&
                       (!device->limits.software || (options && options->binaries_always));
    if (options && options->binaries && spares && !(device->binaries = gw_copy_text(options->binaries))) {
        gw_gl_destroy(&device);
        return gw_fail(error, GW_MACHINE, "not enough memory for the GL device");
    }
    gw_log_write(device->log, GW_LOG_INFO, "GL device: %s, %s, OpenGL %s", device->limits.vendor,
                 device->limits.renderer, device->limits.version);
    *out = device;
    return GW_OK;
}

void gw_gl_destroy(gw_gl **device) {
    if (!device || !*device) {
        return;
    }
    gw_gl *gone = *device;
    if (gone->context != EGL_NO_CONTEXT || gone->window) {
        gw_gl_pool_stop(gone);
        gw_gl_programs_finish(gone);
    }
    gw_gl_egl_close(gone);
    gw_window_destroy(&gone->window);
    free(gone->shader_folder);
    free(gone->binaries);
    free(gone->named);
    free(gone);
    *device = NULL;
}

gw_code gw_gl_create_shared(gw_gl *with, gw_gl **out, gw_error *error) {
    *out = NULL;
    gw_gl *device = calloc(1, sizeof *device);
    if (!device)
        return gw_fail(error, GW_MACHINE, "not enough memory for a second GL device");
    device->display = EGL_NO_DISPLAY;
    device->context = EGL_NO_CONTEXT;
    device->shared = 1;
    device->variant = -1;
    device->limits = with->limits;
    gw_code code = GW_OK;
    if ((with->shader_folder && !(device->shader_folder = gw_copy_text(with->shader_folder))) ||
        (with->binaries && !(device->binaries = gw_copy_text(with->binaries))))
        code = gw_fail(error, GW_MACHINE, "not enough memory for a second GL device");
    if (!code)
        code = with->window ? gw_window_share(with->window, &device->window, error)
                            : gw_gl_egl_share(with, device, error);
    if (code) {
        gw_gl_destroy(&device);
        return code;
    }
    *out = device;
    return GW_OK;
}

gw_code gw_gl_take(gw_gl *device, gw_error *error) {
    return device->window ? gw_window_take(device->window, error) : gw_gl_egl_take(device, error);
}

void gw_gl_leave(gw_gl *device) {
    if (device->window)
        gw_window_leave();
    else
        gw_gl_egl_leave(device);
}

void gw_gl_stop_compiling(gw_gl *device) {
    atomic_store(&device->stopped, 1);
}

const gw_gl_limits *gw_gl_limits_of(const gw_gl *device) {
    return &device->limits;
}

gw_window *gw_gl_window(const gw_gl *device) {
    return device->window;
}

const gw_log *gw_gl_log(const gw_gl *device) {
    return device->log;
}

void gw_gl_set_pulse(gw_gl *device, gw_gl_pulse *pulse, void *context) {
    device->pulse = pulse;
    device->pulse_context = context;
}

gw_code gw_gl_finish(gw_gl *device, gw_error *error) {
    (void)device;
    GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence) {
        return gw_gl_check("setting a fence", error);
    }
    GLenum state;
    do {
        state = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, 1000000000);
    } while (state == GL_TIMEOUT_EXPIRED);
    glDeleteSync(fence);
    if (state == GL_WAIT_FAILED) {
        return gw_fail(error, GW_MACHINE, "waiting for the GPU failed: the driver lost its device");
    }
    return gw_gl_check("waiting for the GPU", error);
}

gw_code gw_gl_check_reset(gw_error *error) {
    switch (glGetGraphicsResetStatus()) {
    case GL_NO_ERROR:
        return GW_OK;
    case GL_GUILTY_CONTEXT_RESET:
        return gw_fail(error, GW_MACHINE, "the GL context was lost: the GPU was reset while it drew this");
    case GL_INNOCENT_CONTEXT_RESET:
        return gw_fail(error, GW_MACHINE, "the GL context was lost: another program made the GPU reset");
    default:
        return gw_fail(error, GW_MACHINE, "the GL context was lost: the GPU was reset");
    }
}

static const char *gl_error_text(GLenum number) {
    switch (number) {
    case GL_INVALID_ENUM:
        return "invalid enum";
    case GL_INVALID_VALUE:
        return "invalid value";
    case GL_INVALID_OPERATION:
        return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "invalid framebuffer operation";
    case GL_OUT_OF_MEMORY:
        return "out of memory";
    case GL_CONTEXT_LOST:
        return "context lost";
    default:
        return "unknown error";
    }
}

gw_code gw_gl_check(const char *where, gw_error *error) {
    GLenum first = glGetError();
    if (first == GL_NO_ERROR) {
        return GW_OK;
    }
    /* Several flags may be set; a lost context never runs dry, so stop after a few. */
    for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; i++) {
    }
    return gw_fail(error, GW_MACHINE, "GL error at %s: %s (0x%04x)", where, gl_error_text(first), first);
}
