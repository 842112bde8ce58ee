/* Contexts without a window: which EGL display gives one.
 *
 * Displays are tried in order: each EGL device (a GPU's device comes before the software one), the
 * surfaceless platform, the default display. A display is never terminated: EGL hands the same one to
 * everybody in the process who asks, so terminating it would kill the contexts of others; it costs nothing to
 * keep until the process ends. */
#include "base/gl_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Of EGL_EXT_device_query_name, which older headers do not have. */
enum { QUERY_RENDERER = 0x335F };

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

/* The last pair asks that a reset of the GPU be told; a driver that cannot is asked again without. */
static EGLContext create_context(EGLDisplay display, EGLContext share, int debug) {
    EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                           4,
                           EGL_CONTEXT_MINOR_VERSION,
                           5,
                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                           EGL_CONTEXT_FLAGS_KHR,
                           debug ? EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR : 0,
                           EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_KHR,
                           EGL_LOSE_CONTEXT_ON_RESET_KHR,
                           EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, share, attributes);
    if (context == EGL_NO_CONTEXT) {
        attributes[sizeof attributes / sizeof attributes[0] - 3] = EGL_NONE;
        context = eglCreateContext(display, EGL_NO_CONFIG_KHR, share, attributes);
    }
    return context;
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
    EGLContext context = create_context(display, EGL_NO_CONTEXT, debug);
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

/* The EGL devices, or -1 when they cannot be listed. */
static EGLint list_devices(EGLDeviceEXT found[GW_GL_MAXIMUM_GPUS]) {
    EGLint count = 0;
    if (!epoxy_has_egl() || !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
        !eglQueryDevicesEXT(GW_GL_MAXIMUM_GPUS, found, &count))
        return -1;
    return count;
}

static int try_device(gw_gl *device, EGLDeviceEXT found, EGLint index, int debug, attempts *tried) {
    char what[32];
    snprintf(what, sizeof what, "EGL device %d", (int)index);
    return try_display(device, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, found, NULL), what, debug,
                       tried);
}

static int try_egl_devices(gw_gl *device, int debug, attempts *tried) {
    EGLDeviceEXT found[GW_GL_MAXIMUM_GPUS];
    EGLint count = list_devices(found);
    if (count < 0)
        note_attempt(tried, "; EGL devices: cannot be listed");
    for (EGLint i = 0; i < count; i++)
        if (try_device(device, found[i], i, debug, tried))
            return 1;
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

/* Exactly that device: a wall that was told which GPU drives a tile must not draw it on another. */
static gw_code open_gpu(gw_gl *device, int debug, int32_t index, gw_error *error) {
    EGLDeviceEXT found[GW_GL_MAXIMUM_GPUS];
    attempts tried = {0};
    EGLint count = list_devices(found);
    if (count < 0)
        return gw_fail(error, GW_MACHINE,
                       "GPU %d was asked for, but this EGL library cannot list devices (it lacks "
                       "EGL_EXT_device_enumeration); leave the GPU out",
                       (int)index);
    if (index < 0 || index >= count)
        return gw_fail(error, GW_MACHINE,
                       "there is no GPU %d: EGL lists %d device%s, numbered from 0; gazewall inspect "
                       "--device shows them",
                       (int)index, (int)count, count == 1 ? "" : "s");
    if (!try_device(device, found[index], index, debug, &tried))
        return gw_fail(error, GW_MACHINE,
                       "GPU %d gives no OpenGL 4.5 core context (%s); gazewall inspect --device shows which "
                       "there are",
                       (int)index, tried.length > 2 ? tried.text + 2 : "no reason given");
    return GW_OK;
}

gw_code gw_gl_egl_open(gw_gl *device, int debug, const int32_t *gpu, gw_error *error) {
    attempts tried = {0};
    if (!epoxy_has_egl())
        return gw_fail(error, GW_MACHINE,
                       "there is no EGL library; install libegl1 and a driver such as libgl1-mesa-dri");
    if (gpu)
        return open_gpu(device, debug, *gpu, error);
    if (!try_egl_devices(device, debug, &tried) && !try_surfaceless(device, debug, &tried) &&
        !try_display(device, eglGetDisplay(EGL_DEFAULT_DISPLAY), "default display", debug, &tried))
        return gw_fail(
            error, GW_MACHINE,
            "no EGL display gives an OpenGL 4.5 core context; install a driver such as libgl1-mesa-dri "
            "(tried: %s)",
            tried.length > 2 ? tried.text + 2 : "nothing");
    return GW_OK;
}

gw_code gw_gl_egl_share(const gw_gl *with, gw_gl *device, gw_error *error) {
    device->display = with->display;
    device->context = create_context(with->display, with->context, with->debug);
    return device->context == EGL_NO_CONTEXT
               ? gw_fail(error, GW_MACHINE, "no second GL context beside the first: %s", egl_error_text())
               : GW_OK;
}

gw_code gw_gl_egl_take(gw_gl *device, gw_error *error) {
    if (!eglBindAPI(EGL_OPENGL_API) ||
        !eglMakeCurrent(device->display, EGL_NO_SURFACE, EGL_NO_SURFACE, device->context))
        return gw_fail(error, GW_MACHINE, "the GL context cannot be used on this thread: %s",
                       egl_error_text());
    return GW_OK;
}

void gw_gl_egl_leave(gw_gl *device) {
    eglMakeCurrent(device->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

void gw_gl_egl_close(gw_gl *device) {
    if (device->context == EGL_NO_CONTEXT)
        return;
    if (!device->shared) /* else the other thread has left it */
        gw_gl_egl_leave(device);
    eglDestroyContext(device->display, device->context);
}

/* Whether one of the names in a list between blanks is `name`. */
static int is_listed(const char *list, const char *name) {
    const size_t length = strlen(name);
    for (const char *at = list; at && (at = strstr(at, name)) != NULL; at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0'))
            return 1;
    return 0;
}

static void describe(EGLDeviceEXT device, gw_gl_gpu *out) {
    const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    const char *name = NULL, *file = NULL;
    if (is_listed(extensions, "EGL_EXT_device_query_name"))
        name = eglQueryDeviceStringEXT(device, QUERY_RENDERER);
    if (is_listed(extensions, "EGL_EXT_device_drm"))
        file = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT);
    if (!name)
        name = is_listed(extensions, "EGL_MESA_device_software") ? "software OpenGL" : "a GPU";
    snprintf(out->name, sizeof out->name, "%s%s%s", name, file ? ", " : "", file ? file : "");
}

size_t gw_gl_list_gpus(gw_gl_gpu out[GW_GL_MAXIMUM_GPUS]) {
    EGLDeviceEXT found[GW_GL_MAXIMUM_GPUS];
    EGLint count = list_devices(found);
    for (EGLint i = 0; i < count; i++)
        describe(found[i], &out[i]);
    return count > 0 ? (size_t)count : 0;
}
