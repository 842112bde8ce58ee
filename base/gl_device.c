/* The context: which EGL display gives one, its limits, waiting and errors.
 *
 * Displays are tried in order: each EGL device (a GPU's device comes before the software one), the
 * surfaceless platform, the default display. A display is never terminated: EGL hands the same one to
 * everybody in the process who asks, so terminating it would kill the contexts of others; it costs nothing to
 * keep until the process ends. */
#include "base/gl_private.h"

#include "base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAXIMUM_EGL_DEVICES = 16 };

/* What was tried and why it failed, for the error when nothing is left. */
typedef struct attempts {
    char text[1024];
    size_t length;
} attempts;

__attribute__((format(printf, 2, 3))) static void note_attempt(attempts *tried, const char *format, ...) {
    size_t room = sizeof tried->text - tried->length;
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(tried->text + tried->length, room, format, arguments);
    va_end(arguments);
    if (length > 0) {
        tried->length += (size_t)length < room ? (size_t)length : room - 1;
    }
}

static const char *egl_error_text(void) {
    switch (eglGetError()) {
    case EGL_NOT_INITIALIZED:
        return "not initialised";
    case EGL_BAD_ACCESS:
        return "no access";
    case EGL_BAD_ALLOC:
        return "out of memory";
    case EGL_BAD_MATCH:
        return "no OpenGL 4.5 core";
    case EGL_BAD_ATTRIBUTE:
        return "context attributes not supported";
    case EGL_BAD_CONFIG:
        return "contexts without a config not supported";
    default:
        return "unknown EGL error";
    }
}

/* Makes a context on a display and makes it current; 1 on success. */
static int try_display(gw_gl *device, EGLDisplay display, const char *what, int debug, attempts *tried) {
    if (display == EGL_NO_DISPLAY) {
        note_attempt(tried, "; %s: no display", what);
        return 0;
    }
    if (!eglInitialize(display, NULL, NULL)) {
        note_attempt(tried, "; %s: %s", what, egl_error_text());
        return 0;
    }
    const char *needed[] = {"EGL_KHR_create_context", "EGL_KHR_no_config_context",
                            "EGL_KHR_surfaceless_context"};
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        if (!epoxy_has_egl_extension(display, needed[i])) {
            note_attempt(tried, "; %s: lacks %s", what, needed[i]);
            return 0;
        }
    }
    if (!eglBindAPI(EGL_OPENGL_API)) {
        note_attempt(tried, "; %s: no desktop OpenGL", what);
        return 0;
    }
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_FLAGS_KHR,
                                 debug ? EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR : 0,
                                 EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) {
        note_attempt(tried, "; %s: %s", what, egl_error_text());
        return 0;
    }
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        note_attempt(tried, "; %s: %s", what, egl_error_text());
        eglDestroyContext(display, context);
        return 0;
    }
    device->display = display;
    device->context = context;
    return 1;
}

static int try_egl_devices(gw_gl *device, int debug, attempts *tried) {
    EGLDeviceEXT found[MAXIMUM_EGL_DEVICES];
    EGLint count = 0;
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
        !eglQueryDevicesEXT(MAXIMUM_EGL_DEVICES, found, &count)) {
        note_attempt(tried, "; EGL devices: cannot be listed");
        return 0;
    }
    for (EGLint i = 0; i < count; i++) {
        char what[32];
        snprintf(what, sizeof what, "EGL device %d", (int)i);
        if (try_display(device, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, found[i], NULL), what,
                        debug, tried)) {
            return 1;
        }
    }
    return 0;
}

static int try_surfaceless(gw_gl *device, int debug, attempts *tried) {
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        note_attempt(tried, "; surfaceless platform: not offered");
        return 0;
    }
    return try_display(device,
                       eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL),
                       "surfaceless platform", debug, tried);
}

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
    limits->texture_units = (int32_t)ask(GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS);
    limits->texture_side = (int32_t)ask(GL_MAX_TEXTURE_SIZE);
    limits->texture_layers = (int32_t)ask(GL_MAX_ARRAY_TEXTURE_LAYERS);
    limits->program_binary_formats = (int32_t)ask(GL_NUM_PROGRAM_BINARY_FORMATS);
    limits->software = is_software(limits->renderer);
}

static gw_code open_context(gw_gl *device, int debug, gw_error *error) {
    attempts tried = {0};
    if (!epoxy_has_egl()) {
        return gw_fail(error, GW_MACHINE,
                       "there is no EGL library; install libegl1 and a driver such as libgl1-mesa-dri");
    }
    if (!try_egl_devices(device, debug, &tried) && !try_surfaceless(device, debug, &tried) &&
        !try_display(device, eglGetDisplay(EGL_DEFAULT_DISPLAY), "default display", debug, &tried)) {
        return gw_fail(
            error, GW_MACHINE,
            "no EGL display gives an OpenGL 4.5 core context; install a driver such as libgl1-mesa-dri "
            "(tried: %s)",
            tried.length > 2 ? tried.text + 2 : "nothing");
    }
    if (epoxy_gl_version() < 45) {
        return gw_fail(error, GW_MACHINE, "the GL driver gives %s, OpenGL 4.5 core is needed",
                       (const char *)glGetString(GL_VERSION));
    }
    return GW_OK;
}

gw_code gw_gl_create(const gw_gl_options *options, gw_gl **out, gw_error *error) {
    *out = NULL;
    gw_gl *device = calloc(1, sizeof *device);
    if (!device) {
        return gw_fail(error, GW_MACHINE, "not enough memory for the GL device");
    }
    device->display = EGL_NO_DISPLAY;
    device->context = EGL_NO_CONTEXT;
    device->log = options ? options->log : NULL;
    gw_code code = GW_OK;
    if (options && options->shader_folder) {
        device->shader_folder = gw_copy_text(options->shader_folder);
        if (!device->shader_folder) {
            code = gw_fail(error, GW_MACHINE, "not enough memory for the GL device");
        }
    }
    if (!code) {
        code = open_context(device, options && options->debug, error);
    }
    if (code) {
        gw_gl_destroy(&device);
        return code;
    }
    ask_limits(&device->limits);
    if (options && options->debug) {
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageCallback(on_driver_message, device);
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
    if (gone->context != EGL_NO_CONTEXT) {
        gw_gl_pool_stop(gone);
        gw_gl_programs_finish(gone);
        eglMakeCurrent(gone->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(gone->display, gone->context);
    }
    free(gone->shader_folder);
    free(gone);
    *device = NULL;
}

const gw_gl_limits *gw_gl_limits_of(const gw_gl *device) {
    return &device->limits;
}

const gw_log *gw_gl_log(const gw_gl *device) {
    return device->log;
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
