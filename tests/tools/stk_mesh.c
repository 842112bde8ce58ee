#include "tests/tools/stk_mesh.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { KIND_PARTITIONED, KIND_SKINNED, KIND_STATIC };
enum { FLAG_NORMALS = 1, FLAG_COLORS = 2, FLAG_TANGENTS = 4 };

typedef struct reader {
    const char *name;
    const uint8_t *data;
    size_t size, at;
    int kind, flags;
    uint8_t *second_texture; /* [material_count] 1 where a material names two */
    stk_mesh *mesh;
    gw_error *error;
} reader;

static gw_code refuse(const reader *self, const char *what) {
    return gw_fail(self->error, GW_BAD_INPUT, "%s: at byte %zu of %zu: %s", self->name, self->at, self->size,
                   what);
}

/* The next `count` bytes, or NULL when the file ends before. */
static const uint8_t *take(reader *self, size_t count) {
    if (count > self->size - self->at)
        return NULL;
    self->at += count;
    return self->data + self->at - count;
}

static uint32_t read_u16(const uint8_t *from) {
    return (uint32_t)from[0] | (uint32_t)from[1] << 8;
}

static uint32_t read_u32(const uint8_t *from) {
    return read_u16(from) | read_u16(from + 2) << 16;
}

static float read_float(const uint8_t *from) {
    uint32_t bits = read_u32(from);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static float read_half(const uint8_t *from) {
    uint32_t bits = read_u16(from);
    int exponent = (int)(bits >> 10 & 31u);
    double mantissa = bits & 1023u;
    double value = exponent == 0    ? ldexp(mantissa, -24)
                   : exponent == 31 ? 0.0 /* infinite or not a number: no place in a picture */
                                    : ldexp(1024.0 + mantissa, exponent - 25);
    return (float)(bits & 0x8000u ? -value : value);
}

/* Signed 10 bits, 511 is 1. */
static float read_tenth(uint32_t word, int shift) {
    int value = (int)(word >> shift & 1023u);
    return fmaxf((float)(value >= 512 ? value - 1024 : value) / 511.0f, -1.0f);
}

static gw_code read_header(reader *self) {
    const uint8_t *head = take(self, 4 + 24);
    if (!head || head[0] != 'S' || head[1] != 'P' || head[2] >> 3 != 1)
        return refuse(self, "not an SPM file of version 1");
    self->kind = head[2] & 7;
    self->flags = head[3];
    if (self->kind != KIND_SKINNED && self->kind != KIND_STATIC)
        return refuse(self, "only static and skinned meshes are known here");
    self->mesh->has_normals = (self->flags & FLAG_NORMALS) != 0;
    self->mesh->has_colors = (self->flags & FLAG_COLORS) != 0;
    return GW_OK;
}

static gw_code read_materials(reader *self) {
    stk_mesh *mesh = self->mesh;
    const uint8_t *from = take(self, 2);
    if (!from)
        return refuse(self, "the file ends before its materials");
    mesh->material_count = read_u16(from);
    gw_code code = gw_allocate((void **)&mesh->textures, mesh->material_count, sizeof *mesh->textures,
                               "texture names", self->error);
    if (code == GW_OK)
        code = gw_allocate((void **)&self->second_texture, mesh->material_count, 1, "materials", self->error);
    for (uint32_t i = 0; code == GW_OK && i < mesh->material_count; i++)
        for (int k = 0; k < 2; k++) {
            const uint8_t *length = take(self, 1);
            const uint8_t *text = length ? take(self, *length) : NULL;
            if (!text || memchr(text, '\0', *length))
                return refuse(self, "a texture's name is cut or contains a zero byte");
            if (k == 0)
                memcpy(mesh->textures[i], text, *length); /* 255 at most, and the rest is zero */
            else
                self->second_texture[i] = *length > 0;
        }
    return code;
}

/* Least bytes that a vertex of this buffer takes: a count that cannot fit is refused before it is allocated.
 */
static size_t least_vertex_bytes(const reader *self, uint32_t material) {
    size_t bytes = 12 + (self->flags & FLAG_NORMALS ? 4u : 0u) + (self->flags & FLAG_COLORS ? 1u : 0u);
    if (self->mesh->textures[material][0])
        bytes += 4u + (self->second_texture[material] ? 4u : 0u) + (self->flags & FLAG_TANGENTS ? 4u : 0u);
    return bytes + (self->kind == KIND_SKINNED ? 16u : 0u);
}

static gw_code grow_vertices(reader *self, size_t count) {
    stk_mesh *mesh = self->mesh;
    size_t needed = mesh->vertex_count + count;
    gw_code code = gw_grow((void **)&mesh->positions, &mesh->position_capacity, needed,
                           sizeof *mesh->positions, "positions", self->error);
    if (code == GW_OK)
        code = gw_grow((void **)&mesh->texcoords, &mesh->texcoord_capacity, needed, sizeof *mesh->texcoords,
                       "texture coordinates", self->error);
    if (code == GW_OK && mesh->has_normals)
        code = gw_grow((void **)&mesh->normals, &mesh->normal_capacity, needed, sizeof *mesh->normals,
                       "normals", self->error);
    if (code == GW_OK && mesh->has_colors)
        code = gw_grow((void **)&mesh->colors, &mesh->color_capacity, needed, sizeof *mesh->colors,
                       "vertex colours", self->error);
    return code;
}

static void put_normal(float to[3], uint32_t word) {
    float n[3] = {read_tenth(word, 0), read_tenth(word, 10), -read_tenth(word, 20)};
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        to[i] = length > 0.0f ? n[i] / length : (i == 1 ? 1.0f : 0.0f);
}

/* One vertex into place `at`; 0 when the file ends in it. */
static int read_vertex(reader *self, uint32_t material, size_t at) {
    stk_mesh *mesh = self->mesh;
    const uint8_t *from = take(self, 12);
    if (!from)
        return 0;
    for (int i = 0; i < 3; i++)
        mesh->positions[at][i] = read_float(from + (size_t)i * 4);
    mesh->positions[at][2] = -mesh->positions[at][2];
    if (mesh->has_normals) {
        if (!(from = take(self, 4)))
            return 0;
        put_normal(mesh->normals[at], read_u32(from));
    }
    if (mesh->has_colors) {
        memset(mesh->colors[at], 255, 4);
        if (!(from = take(self, 1)))
            return 0;
        if (*from != 128) { /* 128: white, and no colour follows */
            if (!(from = take(self, 3)))
                return 0;
            memcpy(mesh->colors[at], from, 3);
        }
    }
    memset(mesh->texcoords[at], 0, sizeof mesh->texcoords[at]);
    if (mesh->textures[material][0]) {
        if (!(from = take(self, 4u + (self->second_texture[material] ? 4u : 0u) +
                                    (self->flags & FLAG_TANGENTS ? 4u : 0u))))
            return 0;
        mesh->texcoords[at][0] = read_half(from);
        mesh->texcoords[at][1] = read_half(from + 2);
    }
    return self->kind != KIND_SKINNED || take(self, 16) != NULL; /* joints and weights */
}

static gw_code read_indices(reader *self, const stk_buffer *buffer) {
    stk_mesh *mesh = self->mesh;
    size_t width = buffer->vertex_count <= 255 ? 1 : buffer->vertex_count <= 65535 ? 2 : 4;
    const uint8_t *from = take(self, (size_t)buffer->index_count * width);
    if (!from)
        return refuse(self, "the file ends in its indices");
    gw_code code =
        gw_grow((void **)&mesh->indices, &mesh->index_capacity, mesh->index_count + buffer->index_count,
                sizeof *mesh->indices, "indices", self->error);
    for (uint32_t i = 0; code == GW_OK && i < buffer->index_count; i++) {
        const uint8_t *index = from + i * width;
        uint32_t vertex = width == 1 ? *index : width == 2 ? read_u16(index) : read_u32(index);
        if (vertex >= buffer->vertex_count)
            return refuse(self, "an index points behind its buffer's vertices");
        /* 0 1 2 becomes 0 2 1: the mirrored z turns the winding. */
        mesh->indices[mesh->index_count + i - i % 3 + (3 - i % 3) % 3] = vertex;
    }
    mesh->index_count += code == GW_OK ? buffer->index_count : 0;
    return code;
}

static gw_code read_buffer(reader *self) {
    stk_mesh *mesh = self->mesh;
    const uint8_t *from = take(self, 10);
    if (!from)
        return refuse(self, "the file ends before a buffer");
    stk_buffer buffer = {.vertex_first = (uint32_t)mesh->vertex_count,
                         .vertex_count = read_u32(from),
                         .index_first = (uint32_t)mesh->index_count,
                         .index_count = read_u32(from + 4),
                         .material = read_u16(from + 8)};
    if (buffer.material >= mesh->material_count)
        return refuse(self, "a buffer names a material that is not there");
    if (buffer.index_count % 3 != 0)
        return refuse(self, "a buffer's indices are not triples");
    size_t left = self->size - self->at;
    if (buffer.vertex_count > left / least_vertex_bytes(self, buffer.material) || buffer.index_count > left)
        return refuse(self, "a buffer is longer than the file");
    gw_code code = grow_vertices(self, buffer.vertex_count);
    for (size_t i = mesh->vertex_count; code == GW_OK && i < mesh->vertex_count + buffer.vertex_count; i++) {
        if (!read_vertex(self, buffer.material, i))
            return refuse(self, "the file ends in its vertices");
        const float *p = mesh->positions[i];
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
            return refuse(self, "a position is not a finite number");
    }
    if (code == GW_OK)
        mesh->vertex_count += buffer.vertex_count;
    if (code == GW_OK)
        code = read_indices(self, &buffer);
    if (code == GW_OK)
        code = gw_grow((void **)&mesh->buffers, &mesh->buffer_capacity, mesh->buffer_count + 1,
                       sizeof *mesh->buffers, "mesh buffers", self->error);
    if (code == GW_OK)
        mesh->buffers[mesh->buffer_count++] = buffer;
    return code;
}

static gw_code read_all(reader *self) {
    gw_code code = read_header(self);
    if (code == GW_OK)
        code = read_materials(self);
    const uint8_t *sectors = code == GW_OK ? take(self, 2) : NULL;
    if (code == GW_OK && !sectors)
        return refuse(self, "the file ends before its sectors");
    for (uint32_t s = 0, count = sectors ? read_u16(sectors) : 0; code == GW_OK && s < count; s++) {
        const uint8_t *buffers = take(self, 2);
        if (!buffers)
            return refuse(self, "the file ends before a sector");
        for (uint32_t b = 0, many = read_u16(buffers); code == GW_OK && b < many; b++)
            code = read_buffer(self);
    }
    /* A skeleton and its animation follow a skinned mesh; the rest pose needs neither. */
    if (code == GW_OK && self->kind == KIND_STATIC && self->at != self->size)
        return refuse(self, "bytes are left over after the last buffer");
    return code;
}

gw_code stk_mesh_read(const char *name, const uint8_t *data, size_t size, stk_mesh *out, gw_error *error) {
    *out = (stk_mesh){0};
    reader self = {.name = name, .data = data, .size = size, .mesh = out, .error = error};
    gw_code code = read_all(&self);
    free(self.second_texture);
    if (code != GW_OK)
        stk_mesh_finish(out);
    return code;
}

void stk_mesh_finish(stk_mesh *mesh) {
    free(mesh->textures);
    free(mesh->buffers);
    free(mesh->positions);
    free(mesh->normals);
    free(mesh->texcoords);
    free(mesh->colors);
    free(mesh->indices);
    *mesh = (stk_mesh){0};
}
