/* Programs: compiled once per (name, defines), found again, dispatched in slices. */
#include "base/gl_private.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/shader_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Slices: what every driver allows, and what a processor does in some 100 ms. */
enum { PORTABLE_GROUPS = 65535, SOFTWARE_GROUPS = 1024 };
static const double compile_patience = 120; /* s */

static void pulse(const gw_gl *device, double silence) {
    if (device->pulse)
        device->pulse(device->pulse_context, silence);
}

void gw_gl_expect_programs(gw_gl *device, uint32_t most) {
    device->expected = most;
    device->met_so_far = 0;
    device->expected_since = gw_now_ns();
}

/* How far compiling has come: what software GL does at the first dispatch is in it. */
static void tell(const gw_gl *device) {
    char text[96];
    if (device->expected == 0)
        return;
    snprintf(text, sizeof text, "compiling kernels: %u of at most %u, %.1f s", device->met_so_far,
             device->expected, (double)(gw_now_ns() - device->expected_since) * 1e-9);
    gw_log_progress(device->log, text, -1);
}

void gw_gl_program_free(const gw_gl_cached_program *program) {
    glDeleteProgram(program->id);
    free(program->name);
    free(program->defines);
}

void gw_gl_programs_finish(gw_gl *device) {
    for (size_t i = 0; i < device->program_count; i++) {
        gw_gl_program_free(&device->programs[i]);
    }
    free(device->programs);
    device->programs = NULL;
    device->program_count = device->program_capacity = 0;
}

/* The whole log is read before it is sorted: warnings of many screens may stand before the first error. */
static gw_code fail_compile(const gw_shader_text *text, GLuint shader, gw_error *error) {
    GLint size = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &size);
    char *log = calloc((size_t)(size > 0 ? size : 0) + 1, 1);
    if (log && size > 0) {
        glGetShaderInfoLog(shader, size, NULL, log);
    }
    char *message = log ? gw_shader_text_message(text, log) : NULL;
    gw_code code = gw_fail(error, GW_MACHINE, "%s does not compile:\n%s", text->files[0],
                           message ? message : "not enough memory for the driver's log");
    free(message);
    free(log);
    return code;
}

static gw_code fail_link(const char *name, GLuint program, gw_error *error) {
    char log[1024] = "";
    glGetProgramInfoLog(program, sizeof log, NULL, log);
    return gw_fail(error, GW_MACHINE, "shaders/%s does not link:\n%s", name, log);
}

static gw_code compile_shader(const gw_shader_text *text, GLenum stage, GLuint *out, gw_error *error) {
    GLuint shader = glCreateShader(stage);
    const GLchar *source = text->text;
    glShaderSource(shader, 1, &source, NULL);
    glCompileShader(shader);
    GLint done = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) {
        gw_code code = fail_compile(text, shader, error);
        glDeleteShader(shader);
        return code;
    }
    *out = shader;
    return GW_OK;
}

/* One file of a program and its stage. */
typedef struct program_stage {
    const char *name;
    GLenum stage;
} program_stage;

enum { MOST_STAGES = 3 };

static gw_code assemble(gw_gl *device, const program_stage *stages, size_t count, const char *defines,
                        gw_shader_text *texts, gw_error *error) {
    gw_code code = GW_OK;
    for (size_t i = 0; i < count && !code; i++)
        code = gw_shader_text_create(device->shader_folder, stages[i].name, defines, &texts[i], error);
    return code;
}

static gw_code compile_and_link(GLuint program, const program_stage *stages, const gw_shader_text *texts,
                                size_t count, gw_error *error) {
    GLuint attached[MOST_STAGES];
    GLsizei held = 0;
    GLint done = GL_FALSE;
    for (size_t i = 0; i < count; i++) {
        GLuint shader = 0;
        gw_code code = compile_shader(&texts[i], stages[i].stage, &shader, error);
        if (code)
            return code;
        glAttachShader(program, shader);
        glDeleteShader(shader); /* lives on until it is detached */
    }
    glLinkProgram(program);
    glGetAttachedShaders(program, MOST_STAGES, &held, attached);
    for (GLsizei i = 0; i < held; i++)
        glDetachShader(program, attached[i]);
    glGetProgramiv(program, GL_LINK_STATUS, &done);
    return done ? GW_OK : fail_link(stages[0].name, program, error);
}

/* The program by a binary of its texts, or of the texts themselves. */
static gw_code make_program(gw_gl *device, const program_stage *stages, size_t count, const char *defines,
                            gw_gl_cached_program *made, gw_error *error) {
    gw_shader_text texts[MOST_STAGES] = {{0}};
    const char *lines[MOST_STAGES] = {NULL};
    gw_code code = assemble(device, stages, count, defines, texts, error);
    if (!code) {
        for (size_t i = 0; i < count; i++)
            lines[i] = texts[i].text;
        made->id = glCreateProgram();
        made->source = gw_gl_binary_key(device, lines, count);
        if (!gw_gl_binary_read(device, made->source, made->id, &made->replaces)) {
            if (device->binaries)
                glProgramParameteri(made->id, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
            code = compile_and_link(made->id, stages, texts, count, error);
            made->unkept = 1;
            device->programs_compiled++;
        }
        if (code)
            glDeleteProgram(made->id);
    }
    for (size_t i = 0; i < count; i++)
        gw_shader_text_finish(&texts[i]);
    return code;
}

/* Remembers a program; the cache owns it from here on. */
static gw_code remember(gw_gl *device, const char *name, const char *defines,
                        const gw_gl_cached_program *made, gw_error *error) {
    void *programs = device->programs;
    gw_code code = gw_grow(&programs, &device->program_capacity, device->program_count + 1,
                           sizeof(gw_gl_cached_program), "programs", error);
    device->programs = programs;
    if (code) {
        return code;
    }
    gw_gl_cached_program entry = *made;
    entry.name = gw_copy_text(name);
    entry.defines = gw_copy_text(defines);
    if (!entry.name || !entry.defines) {
        free(entry.name);
        free(entry.defines);
        return gw_fail(error, GW_MACHINE, "not enough memory to keep program %s", name);
    }
    gw_gl_variant_mark(device, &entry, 1);
    device->programs[device->program_count++] = entry;
    return GW_OK;
}

/* The program of these stages, found by the first one's name or made. */
static gw_code find_program(gw_gl *device, const program_stage *stages, size_t count, const char *defines,
                            GLuint *out, gw_error *error) {
    *out = 0;
    const char *name = stages[0].name, *key = defines ? defines : "";
    for (size_t i = 0; i < device->program_count; i++) {
        if (strcmp(device->programs[i].name, name) == 0 && strcmp(device->programs[i].defines, key) == 0) {
            *out = device->programs[i].id;
            gw_gl_variant_mark(device, &device->programs[i], 0);
            return GW_OK;
        }
    }
    if (atomic_load(&device->stopped))
        return gw_fail(error, GW_INTERRUPTED, "%s is not compiled any more", name);
    int64_t start = gw_now_ns();
    gw_gl_cached_program made = {0};
    device->met_so_far++;
    if (device->expected > 0 && device->expected < device->met_so_far)
        device->expected = device->met_so_far;
    tell(device);
    pulse(device, compile_patience);
    gw_code code = make_program(device, stages, count, defines, &made, error);
    if (!code) {
        code = remember(device, name, key, &made, error);
        if (code) {
            glDeleteProgram(made.id);
        }
    }
    if (!code) {
        glObjectLabel(GL_PROGRAM, made.id, -1, name);
        gw_log_write(device->log, GW_LOG_DEBUG, "compiled %s in %.1f ms", name,
                     (double)(gw_now_ns() - start) * 1e-6);
        *out = made.id;
    }
    return code;
}

gw_code gw_gl_program(gw_gl *device, const char *name, const char *defines, GLuint *out, gw_error *error) {
    const program_stage stage = {name, GL_COMPUTE_SHADER};
    return find_program(device, &stage, 1, defines, out, error);
}

gw_code gw_gl_draw_program(gw_gl *device, const char *name, const char *defines, GLuint *out,
                           gw_error *error) {
    static const struct {
        const char *extension;
        GLenum stage;
    } kinds[] = {{"vert", GL_VERTEX_SHADER}, {"geom", GL_GEOMETRY_SHADER}, {"frag", GL_FRAGMENT_SHADER}};
    char names[MOST_STAGES][256];
    program_stage stages[MOST_STAGES];
    for (int i = 0; i < MOST_STAGES; i++) {
        snprintf(names[i], sizeof names[i], "%s.%s", name, kinds[i].extension);
        stages[i] = (program_stage){names[i], kinds[i].stage};
    }
    return find_program(device, stages, MOST_STAGES, defines, out, error);
}

int gw_gl_program_at(const gw_gl *device, size_t index, const char **name, const char **defines) {
    if (index >= device->program_count)
        return 0;
    *name = device->programs[index].name;
    *defines = device->programs[index].defines;
    return 1;
}

gw_code gw_gl_shader_text(gw_gl *device, const char *name, const char *defines, char **out, gw_error *error) {
    *out = NULL;
    gw_shader_text text;
    gw_code code = gw_shader_text_create(device->shader_folder, name, defines, &text, error);
    if (!code) {
        *out = text.text;
        text.text = NULL;
        gw_shader_text_finish(&text);
    }
    return code;
}

/* The label that gw_gl_program gave. */
static void program_label(GLuint program, char label[128]) {
    label[0] = '\0';
    glGetObjectLabel(GL_PROGRAM, program, 128, NULL, label);
}

gw_code gw_gl_uniform(GLuint program, const char *name, GLint *out, gw_error *error) {
    *out = glGetUniformLocation(program, name);
    if (*out < 0) {
        char label[128];
        program_label(program, label);
        return gw_fail(error, GW_MACHINE, "program '%s' has no uniform '%s' that it uses", label, name);
    }
    return GW_OK;
}

static const GLbitfield after_dispatch = GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                                         GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                                         GL_COMMAND_BARRIER_BIT;

/* Before work of a program: software GL compiles what has never run. */
static void announce(gw_gl *device, GLuint program) {
    double silence = 0;
    for (size_t i = 0; device->limits.software && i < device->program_count; i++) {
        gw_gl_cached_program *cached = &device->programs[i];
        if (cached->id == program && !cached->ran) {
            cached->ran = 1;
            silence = compile_patience;
            tell(device);
        }
    }
    pulse(device, silence);
}

gw_code gw_gl_dispatch(gw_gl *device, GLuint program, uint64_t groups, gw_error *error) {
    if (groups == 0) {
        return GW_OK;
    }
    announce(device, program);
    /* Slices of the size that every driver allows, so that the same sequence runs everywhere. */
    uint64_t slice = (uint64_t)device->limits.work_groups[0] < PORTABLE_GROUPS
                         ? (uint64_t)device->limits.work_groups[0]
                         : PORTABLE_GROUPS;
    GLint base = glGetUniformLocation(program, "group_base");
    if (groups > UINT32_MAX || (base < 0 && groups > slice)) {
        char label[128];
        program_label(program, label);
        return gw_fail(error, GW_MACHINE, "program '%s': %llu work groups are more than %llu%s", label,
                       (unsigned long long)groups, (unsigned long long)(base < 0 ? slice : UINT32_MAX),
                       base < 0 ? ", and it has no uniform 'group_base' that would allow slices" : "");
    }
    if (device->limits.software && base >= 0 && slice > SOFTWARE_GROUPS) {
        slice = SOFTWARE_GROUPS;
    }
    glUseProgram(program);
    for (uint64_t begin = 0; begin < groups; begin += slice) {
        uint64_t count = groups - begin < slice ? groups - begin : slice;
        if (base >= 0) {
            glProgramUniform1ui(program, base, (GLuint)begin);
        }
        glDispatchCompute((GLuint)count, 1, 1);
        pulse(device, 0);
    }
    glMemoryBarrier(after_dispatch);
    return gw_gl_check("dispatching work groups", error);
}

gw_code gw_gl_dispatch_indirect(gw_gl *device, GLuint program, const gw_gl_buffer *arguments, size_t offset,
                                gw_error *error) {
    announce(device, program);
    GLint base = glGetUniformLocation(program, "group_base");
    if (base >= 0) {
        glProgramUniform1ui(program, base, 0);
    }
    glUseProgram(program);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, arguments->id);
    glDispatchComputeIndirect((GLintptr)offset);
    glMemoryBarrier(after_dispatch);
    return gw_gl_check("dispatching work groups that a kernel counted", error);
}
