/* Buffers of fixed size, checked against the driver's limits before they are made. */
#include "base/gl_private.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

enum { GRANULE = 16 };

static size_t texel_bytes(GLenum format) {
    switch (format) {
    case GL_R32UI:
    case GL_R32I:
    case GL_R32F:
    case GL_RGBA8:
    case GL_RGBA8UI:
        return 4;
    case GL_RG32UI:
    case GL_RG32I:
    case GL_RG32F:
        return 8;
    case GL_RGB32UI:
    case GL_RGB32I:
    case GL_RGB32F:
        return 12;
    case GL_RGBA32UI:
    case GL_RGBA32I:
    case GL_RGBA32F:
        return 16;
    default:
        return 0;
    }
}

static double mebibytes(double bytes) {
    return bytes / (1024.0 * 1024.0);
}

static gw_code check_size(const gw_gl *device, const char *name, size_t size, GLenum format,
                          gw_error *error) {
    if (!format) {
        if ((int64_t)size > device->limits.storage_block_bytes) {
            return gw_fail(error, GW_MACHINE,
                           "buffer '%s' needs %.1f MiB, the driver's limit for a storage block is %.1f MiB",
                           name, mebibytes((double)size),
                           mebibytes((double)device->limits.storage_block_bytes));
        }
        return GW_OK;
    }
    size_t texel = texel_bytes(format);
    if (texel == 0) {
        return gw_fail(error, GW_MACHINE, "buffer '%s': format 0x%04x is not known as a buffer texture", name,
                       format);
    }
    if ((int64_t)(size / texel) > device->limits.texture_buffer_texels) {
        double limit = (double)device->limits.texture_buffer_texels * (double)texel;
        return gw_fail(
            error, GW_MACHINE,
            "buffer '%s' needs %.1f MiB, the driver's limit for a buffer texture of this format is %.1f MiB",
            name, mebibytes((double)size), mebibytes(limit));
    }
    return GW_OK;
}

static size_t rounded(size_t size) {
    return (size + GRANULE - 1) / GRANULE * GRANULE;
}

/* Fresh storage is not cleared by GL; contents must not depend on what was there. */
static void fill(GLuint id, size_t size, size_t allocated, const void *data) {
    static const uint8_t zeros[GRANULE];
    if (!data) {
        const GLuint zero = 0;
        glClearNamedBufferSubData(id, GL_R32UI, 0, (GLsizeiptr)allocated, GL_RED_INTEGER, GL_UNSIGNED_INT,
                                  &zero);
        return;
    }
    glNamedBufferSubData(id, 0, (GLsizeiptr)size, data);
    if (allocated > size) {
        glNamedBufferSubData(id, (GLintptr)size, (GLsizeiptr)(allocated - size), zeros);
    }
}

/* The row of a name, or NULL. */
static gw_gl_named_bytes *find_named(const gw_gl *device, const char *name) {
    for (size_t i = 0; i < device->named_count; i++) {
        if (!strcmp(device->named[i].name, name)) {
            return &device->named[i];
        }
    }
    return NULL;
}

static gw_code count_bytes(gw_gl *device, const gw_gl_buffer *buffer, gw_error *error) {
    gw_gl_named_bytes *row = find_named(device, buffer->name);
    if (!row) {
        gw_code code = gw_grow((void **)&device->named, &device->named_capacity, device->named_count + 1,
                               sizeof *row, "names of buffers", error);
        if (code) {
            return code;
        }
        row = &device->named[device->named_count++];
        memcpy(row->name, buffer->name, sizeof row->name);
        row->bytes = 0;
    }
    row->bytes += buffer->size;
    device->usage.bytes += buffer->size;
    if (device->usage.peak < device->usage.bytes) {
        device->usage.peak = device->usage.bytes;
    }
    return GW_OK;
}

uint64_t gw_gl_buffer_bytes(const gw_gl *device, const char *name) {
    const gw_gl_named_bytes *row = find_named(device, name);
    return row ? row->bytes : 0;
}

const char *gw_gl_buffer_name(const gw_gl *device, size_t index) {
    return index < device->named_count ? device->named[index].name : NULL;
}

gw_code gw_gl_buffer_create(gw_gl *device, const char *name, size_t size, const void *data, GLenum as_texture,
                            gw_gl_buffer *out, gw_error *error) {
    *out = (gw_gl_buffer){0};
    gw_code code = check_size(device, name, size, as_texture, error);
    if (!code) {
        code = gw_gl_check("the calls before making a buffer", error);
    }
    if (code) {
        return code;
    }
    snprintf(out->name, sizeof out->name, "%s", name);
    if (size == 0) {
        data = NULL;
    }
    out->size = size == 0 ? GRANULE : size;
    const size_t allocated = rounded(out->size);
    code = count_bytes(device, out, error);
    if (code) {
        *out = (gw_gl_buffer){0};
        return code;
    }
    out->device = device;
    out->keeper = device->pool.on ? device : NULL;
    gw_gl_pool_take(device, allocated, &out->id, &out->capacity);
    if (!out->id) {
        code = gw_fail(error, GW_MACHINE, "buffer '%s': the GPU has no room for %.1f MiB", name,
                       mebibytes((double)allocated));
        gw_gl_buffer_finish(out);
        return code;
    }
    fill(out->id, out->size, allocated, data);
    glObjectLabel(GL_BUFFER, out->id, -1, out->name);
    if (as_texture) {
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &out->texture);
        glTextureBufferRange(out->texture, as_texture, out->id, 0, (GLsizeiptr)allocated);
        glObjectLabel(GL_TEXTURE, out->texture, -1, out->name);
    }
    code = gw_gl_check("making a buffer", error);
    if (code) {
        gw_gl_buffer_finish(out);
        return gw_context(error, "buffer '%s'", name);
    }
    return GW_OK;
}

gw_gl_usage gw_gl_usage_of(const gw_gl *device) {
    return device->usage;
}

void gw_gl_reset_peak(gw_gl *device) {
    device->usage.peak = device->usage.bytes;
}

void gw_gl_buffer_finish(gw_gl_buffer *buffer) {
    if (buffer->device) {
        buffer->device->usage.bytes -= buffer->size;
        find_named(buffer->device, buffer->name)->bytes -= buffer->size;
    }
    if (buffer->texture) {
        glDeleteTextures(1, &buffer->texture);
    }
    if (buffer->id) {
        gw_gl_pool_give(buffer->keeper, buffer->id, buffer->capacity);
    }
    *buffer = (gw_gl_buffer){0};
}

static gw_code check_range(const gw_gl_buffer *buffer, size_t offset, size_t size, const char *what,
                           gw_error *error) {
    if (offset > buffer->size || size > buffer->size - offset) {
        return gw_fail(error, GW_MACHINE, "buffer '%s' of %zu bytes: %s %zu bytes at %zu is outside",
                       buffer->name, buffer->size, what, size, offset);
    }
    return GW_OK;
}

gw_code gw_gl_buffer_write(gw_gl_buffer *buffer, size_t offset, size_t size, const void *data,
                           gw_error *error) {
    gw_code code = check_range(buffer, offset, size, "writing", error);
    if (code || size == 0) {
        return code;
    }
    glNamedBufferSubData(buffer->id, (GLintptr)offset, (GLsizeiptr)size, data);
    code = gw_gl_check("writing a buffer", error);
    return code ? gw_context(error, "buffer '%s'", buffer->name) : GW_OK;
}

gw_code gw_gl_buffer_read(const gw_gl_buffer *buffer, size_t offset, size_t size, void *data,
                          gw_error *error) {
    gw_code code = check_range(buffer, offset, size, "reading", error);
    if (code || size == 0) {
        return code;
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(buffer->id, (GLintptr)offset, (GLsizeiptr)size, data);
    code = gw_gl_check("reading a buffer", error);
    return code ? gw_context(error, "buffer '%s'", buffer->name) : GW_OK;
}

void gw_gl_buffer_bind(const gw_gl_buffer *buffer, GLuint binding) {
    if (buffer->id) {
        glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer->id, 0,
                          (GLsizeiptr)rounded(buffer->size));
    } else {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, 0);
    }
}

void gw_gl_buffer_bind_range(const gw_gl_buffer *buffer, GLuint binding, size_t offset, size_t size) {
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer->id, (GLintptr)offset, (GLsizeiptr)size);
}

void gw_gl_texture_bind(const gw_gl_buffer *buffer, GLuint texture_unit) {
    glBindTextureUnit(texture_unit, buffer->texture);
}
