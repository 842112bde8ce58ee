/* Program binaries on disk, so that a program is translated once: one sealed file (base/sealed_file.h) for
 * each (texts of its stages, driver). */
#include "base/gl_private.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/sealed_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VERSION = 1, MOST_FORMATS = 64, LARGEST_BINARY = 64 << 20 /* bytes */ };
static const char *const suffixes[] = {GW_GL_BINARY_SUFFIX, NULL};

/* The driver's strings are in it: its binaries are its own. */
gw_hash gw_gl_binary_key(const gw_gl *device, const char *const *texts, size_t count) {
    const gw_gl_limits *limits = &device->limits;
    const char *driver[] = {limits->vendor, limits->renderer, limits->version};
    const uint32_t version = VERSION;
    gw_hash key = gw_hash_bytes((gw_hash){0, 0}, &version, sizeof version);
    for (size_t i = 0; i < sizeof driver / sizeof driver[0]; i++)
        key = gw_hash_bytes(key, driver[i], strlen(driver[i]) + 1);
    for (size_t i = 0; i < count; i++)
        key = gw_hash_bytes(key, texts[i], strlen(texts[i]) + 1);
    return key;
}

static char *path_of(const gw_gl *device, gw_hash key) {
    char text[33], name[64];
    gw_hash_text(key, text);
    snprintf(name, sizeof name, "program-%s" GW_GL_BINARY_SUFFIX, text);
    return gw_path_join(device->binaries, name);
}

static int is_offered(GLenum format) {
    GLint count = 0, formats[MOST_FORMATS];
    glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &count);
    if (count < 1 || count > MOST_FORMATS)
        return 0;
    glGetIntegerv(GL_PROGRAM_BINARY_FORMATS, formats);
    for (GLint i = 0; i < count; i++)
        if ((GLenum)formats[i] == format)
            return 1;
    return 0;
}

/* The driver judges a binary, and may refuse its own of yesterday. */
static int load(const gw_sealed *file, GLuint program) {
    uint32_t format;
    GLint done = GL_FALSE;
    if (file->size <= sizeof format || file->size > LARGEST_BINARY)
        return 0;
    memcpy(&format, file->data, sizeof format);
    if (!is_offered(format))
        return 0;
    glProgramBinary(program, format, (const char *)file->data + sizeof format,
                    (GLsizei)(file->size - sizeof format));
    glGetProgramiv(program, GL_LINK_STATUS, &done);
    while (glGetError() != GL_NO_ERROR && !done) {
    }
    return done == GL_TRUE;
}

int gw_gl_binary_read(gw_gl *device, gw_hash key, GLuint program, int *refused) {
    gw_error reason = {0};
    gw_sealed file = {0};
    char *path = device->binaries ? path_of(device, key) : NULL;
    int taken = 0;
    if (path && gw_file_exists(path)) {
        const gw_code code = gw_sealed_read(path, key, &file, &reason);
        taken = !code && load(&file, program);
        device->binaries_read += (uint64_t)taken;
        device->binaries_refused += (uint64_t)!taken;
        *refused = !taken;
        if (!taken)
            gw_log_write(device->log, GW_LOG_DEBUG, "%s is of no use, its program is compiled: %s", path,
                         code ? reason.text : "the driver refuses it");
        free(file.data);
    }
    free(path);
    return taken;
}

static gw_code keep(gw_gl *device, const gw_gl_cached_program *program, gw_error *error) {
    GLint size = 0;
    GLsizei written = 0;
    GLenum format = 0;
    void *bytes = NULL;
    char *path = path_of(device, program->source);
    if (!path)
        return gw_fail(error, GW_MACHINE, "not enough memory to keep a program's binary");
    glGetProgramiv(program->id, GL_PROGRAM_BINARY_LENGTH, &size);
    /* The driver gives none of this one; or another process was faster, and its file stands. */
    if (size <= 0 || size > LARGEST_BINARY - (GLint)sizeof(uint32_t) ||
        (!program->replaces && gw_file_exists(path))) {
        free(path);
        return GW_OK;
    }
    gw_code code = gw_allocate(&bytes, sizeof(uint32_t) + (size_t)size, 1, "a program's binary", error);
    if (!code) {
        glGetProgramBinary(program->id, size, &written, &format, (char *)bytes + sizeof(uint32_t));
        code = gw_gl_check("asking for a program's binary", error);
    }
    const uint32_t word = format;
    if (!code) {
        memcpy(bytes, &word, sizeof word);
        code = gw_sealed_write(path, program->source, bytes, sizeof word + (size_t)written, error);
    }
    if (!code)
        gw_sealed_trim(path, suffixes, GW_GL_BINARIES_LIMIT);
    free(path);
    free(bytes);
    return code;
}

gw_code gw_gl_keep_programs(gw_gl *device, gw_error *error) {
    gw_code code = GW_OK;
    for (size_t i = 0; device->binaries && !code && i < device->program_count; i++) {
        gw_gl_cached_program *program = &device->programs[i];
        if (!program->unkept)
            continue;
        program->unkept = 0;
        code = keep(device, program, error);
    }
    return code;
}

gw_gl_program_counts gw_gl_program_counts_of(const gw_gl *device) {
    return (gw_gl_program_counts){.compiled = device->programs_compiled,
                                  .read = device->binaries_read,
                                  .refused = device->binaries_refused};
}
