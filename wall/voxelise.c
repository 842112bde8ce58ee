#include "wall/voxelise.h"

#include "base/clock.h"
#include "base/memory.h"
#include "build/gpu_types.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LOCATION_FIRST, LOCATION_RESOLUTION, LOCATION_CAPACITY };

typedef struct voxeliser {
    gw_gl *device;
    GLuint program, framebuffer, vertex_array;
    gw_gl_buffer triangles, colors, counter, fragments;
    uint32_t resolution, capacity;
    gw_voxelised *out;
    size_t room; /* of out->fragments */
} voxeliser;

static uint32_t byte_of(float value) {
    return (uint32_t)lrintf(255.0f * fminf(fmaxf(value, 0.0f), 1.0f));
}

static gw_code upload(voxeliser *self, const gw_scene *scene, gw_error *error) {
    gw_gpu_triangle *triangles = NULL;
    uint32_t *colors = NULL;
    size_t count = scene->triangle_count;
    gw_code code = gw_allocate((void **)&triangles, count, sizeof *triangles, "triangles", error);
    if (code == GW_OK)
        code = gw_allocate((void **)&colors, count, sizeof *colors, "colours", error);
    for (size_t i = 0; i < count && code == GW_OK; i++) {
        const float *base = scene->materials[scene->material_of[i]].base_color;
        for (int k = 0; k < 3; k++)
            memcpy(triangles[i].vertex[k], scene->positions + 3 * (size_t)scene->triangles[i][k], 12);
        colors[i] =
            byte_of(base[0]) | byte_of(base[1]) << 8 | byte_of(base[2]) << 16 | byte_of(base[3]) << 24;
    }
    if (code == GW_OK)
        code = gw_gl_buffer_create(self->device, "triangles", count * sizeof *triangles, triangles,
                                   GL_RGBA32F, &self->triangles, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(self->device, "colours", count * sizeof *colors, colors, GL_R32UI,
                                   &self->colors, error);
    free(triangles);
    free(colors);
    return code;
}

static gw_code prepare(voxeliser *self, const gw_scene *scene, int enlarge, uint32_t limit, gw_error *error) {
    const gw_gl_limits *limits = gw_gl_limits_of(self->device);
    uint64_t most = (uint64_t)limits->storage_block_bytes / sizeof(gw_fragment);
    most = limit > 0 && limit < most ? limit : most;
    /* A pixel for every triangle, and as many again for each side of the grid, is plenty to begin with. */
    uint64_t guess = 8 * ((uint64_t)scene->triangle_count + (uint64_t)self->resolution * self->resolution);
    self->capacity = (uint32_t)(guess < most ? guess : most);
    gw_code code =
        gw_gl_draw_program(self->device, "build/voxelise",
                           enlarge ? "#define ENLARGE 1\n" : "#define ENLARGE 0\n", &self->program, error);
    if (code == GW_OK)
        code = upload(self, scene, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(self->device, "fragment counter", 4, NULL, 0, &self->counter, error);
    if (code == GW_OK)
        code = gw_gl_buffer_create(self->device, "fragments", (size_t)self->capacity * sizeof(gw_fragment),
                                   NULL, 0, &self->fragments, error);
    if (code != GW_OK)
        return code;
    GLint bits = 0;
    glGetIntegerv(GL_SUBPIXEL_BITS, &bits);
    self->out->subpixel = ldexp(1.0, -bits);
    glCreateVertexArrays(1, &self->vertex_array);
    glCreateFramebuffers(1, &self->framebuffer); /* no attachments: fragments go to the buffer alone */
    glNamedFramebufferParameteri(self->framebuffer, GL_FRAMEBUFFER_DEFAULT_WIDTH, (GLint)self->resolution);
    glNamedFramebufferParameteri(self->framebuffer, GL_FRAMEBUFFER_DEFAULT_HEIGHT, (GLint)self->resolution);
    return gw_gl_check("preparing the voxeliser", error);
}

static void bind(const voxeliser *self) {
    glBindFramebuffer(GL_FRAMEBUFFER, self->framebuffer);
    glBindVertexArray(self->vertex_array);
    glViewport(0, 0, (GLsizei)self->resolution, (GLsizei)self->resolution);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
    glUseProgram(self->program);
    glProgramUniform1ui(self->program, LOCATION_RESOLUTION, self->resolution);
    glProgramUniform1ui(self->program, LOCATION_CAPACITY, self->capacity);
    gw_gl_texture_bind(&self->triangles, 0);
    gw_gl_texture_bind(&self->colors, 1);
    gw_gl_buffer_bind(&self->fragments, 0);
    glBindBufferBase(GL_ATOMIC_COUNTER_BUFFER, 0, self->counter.id);
}

/* Draws a slice; *count may exceed the capacity, and then the fragments are not all there. */
static gw_code draw(voxeliser *self, uint32_t first, uint32_t triangles, uint32_t *count, gw_error *error) {
    const uint32_t zero = 0;
    gw_code code = gw_gl_buffer_write(&self->counter, 0, 4, &zero, error);
    int64_t begin = gw_now_ns();
    if (code != GW_OK)
        return code;
    glProgramUniform1ui(self->program, LOCATION_FIRST, first);
    glDrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * triangles));
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    code = gw_gl_finish(self->device, error);
    self->out->milliseconds += (double)(gw_now_ns() - begin) * 1e-6;
    if (code == GW_OK)
        code = gw_gl_check("drawing fragments", error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&self->counter, 0, 4, count, error);
    self->out->draws++;
    return code;
}

static gw_code keep(voxeliser *self, uint32_t count, gw_error *error) {
    gw_voxelised *out = self->out;
    gw_code code = gw_grow((void **)&out->fragments, &self->room, (size_t)(out->count + count),
                           sizeof *out->fragments, "fragments", error);
    if (code == GW_OK)
        code = gw_gl_buffer_read(&self->fragments, 0, (size_t)count * sizeof *out->fragments,
                                 out->fragments + out->count, error);
    if (code == GW_OK)
        out->count += count;
    return code;
}

/* Draws everything in slices whose fragments fit. */
static gw_code draw_all(voxeliser *self, uint32_t triangle_count, gw_error *error) {
    uint32_t slice = triangle_count;
    gw_code code = GW_OK;
    bind(self);
    for (uint32_t first = 0; first < triangle_count && code == GW_OK;) {
        uint32_t count = 0, now = triangle_count - first < slice ? triangle_count - first : slice;
        code = draw(self, first, now, &count, error);
        if (code != GW_OK)
            break;
        if (count > self->capacity) {
            if (now == 1)
                return gw_fail(error, GW_MACHINE,
                               "triangle %" PRIu32 " alone has %" PRIu32 " fragments, %" PRIu32
                               " fit in one buffer of this driver",
                               first, count, self->capacity);
            slice = now / 2;
            continue;
        }
        code = keep(self, count, error);
        first += now;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glBindVertexArray(0);
    return code;
}

gw_code gw_voxelise(gw_gl *device, const gw_scene *scene, uint32_t resolution, int enlarge, uint32_t limit,
                    gw_voxelised *out, gw_error *error) {
    voxeliser self = {.device = device, .resolution = resolution, .out = out};
    *out = (gw_voxelised){0};
    if (resolution < 2 || resolution > 1024)
        return gw_fail(error, GW_BAD_INPUT, "a grid has 2 to 1024 voxels along a side, not %" PRIu32,
                       resolution);
    gw_code code = prepare(&self, scene, enlarge, limit, error);
    if (code == GW_OK)
        code = draw_all(&self, scene->triangle_count, error);
    if (code == GW_OK && out->draws == 1) {
        out->buffer = self.fragments;
        self.fragments = (gw_gl_buffer){0};
    }
    gw_gl_buffer_finish(&self.triangles);
    gw_gl_buffer_finish(&self.colors);
    gw_gl_buffer_finish(&self.counter);
    gw_gl_buffer_finish(&self.fragments);
    glDeleteVertexArrays(1, &self.vertex_array);
    glDeleteFramebuffers(1, &self.framebuffer);
    if (code != GW_OK)
        gw_voxelised_finish(out);
    return code;
}

void gw_voxelised_finish(gw_voxelised *voxelised) {
    free(voxelised->fragments);
    gw_gl_buffer_finish(&voxelised->buffer);
    *voxelised = (gw_voxelised){0};
}
