#include "base/shader_text.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/memory.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 1 << 20, TEXT_LIMIT = 1 << 24, INCLUDE_DEPTH = 32 };

/* One file that takes part. */
typedef struct source {
    gw_bytes bytes;
    int always; /* already in the text outside of any condition */
    int open;   /* being taken in now: including it again would not end */
} source;

typedef struct assembler {
    const char *folder;
    gw_shader_text *out;
    source *sources; /* parallel to out->files */
    size_t source_capacity, name_capacity, size, capacity;
    int condition_depth; /* open #if, #ifdef, #ifndef around the place where we are */
    gw_error *error;
} assembler;

static gw_code append(assembler *work, const char *text, size_t size) {
    if (work->size + size > TEXT_LIMIT) {
        return gw_fail(work->error, GW_BAD_INPUT, "%s: the assembled shader is larger than %d bytes",
                       work->out->files[0], TEXT_LIMIT);
    }
    void *grown = work->out->text;
    gw_code code =
        gw_grow(&grown, &work->capacity, work->size + size + 1, 1, "bytes of shader text", work->error);
    work->out->text = grown;
    if (!code) {
        memcpy(work->out->text + work->size, text, size);
        work->size += size;
        work->out->text[work->size] = '\0';
    }
    return code;
}

__attribute__((format(printf, 2, 3))) static gw_code append_line(assembler *work, const char *format, ...) {
    char line[128];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    return append(work, line, (size_t)length);
}

static gw_code read_source(const assembler *work, const char *path, gw_bytes *out) {
    /* path starts with "shaders/", the folder stands for that part. */
    if (work->folder) {
        char *file = gw_path_join(work->folder, path + strlen("shaders/"));
        if (!file) {
            return gw_fail(work->error, GW_MACHINE, "%s: not enough memory for a file name", path);
        }
        gw_code code = gw_file_read(file, FILE_LIMIT, out, work->error);
        free(file);
        return code;
    }
    const gw_embedded_file *file = gw_embedded_find(path);
    if (!file) {
        return gw_fail(work->error, GW_BAD_INPUT, "%s: there is no such shader in the program", path);
    }
    void *data = NULL;
    gw_code code = gw_allocate(&data, file->size + 1, 1, "bytes of shader text", work->error);
    if (!code) {
        memcpy(data, file->data, file->size);
        *out = (gw_bytes){.data = data, .size = file->size};
    }
    return code;
}

/* Number of the file, read at its first use. */
static gw_code find_source(assembler *work, const char *name, size_t name_length, size_t *number) {
    char path[256];
    int length = snprintf(path, sizeof path, "shaders/%.*s", (int)name_length, name);
    if (length < 0 || (size_t)length >= sizeof path || strstr(path, "..")) {
        return gw_fail(work->error, GW_BAD_INPUT, "'%.*s' is no name of a shader", (int)name_length, name);
    }
    gw_shader_text *out = work->out;
    for (size_t i = 0; i < out->file_count; i++) {
        if (strcmp(out->files[i], path) == 0) {
            *number = i;
            return GW_OK;
        }
    }
    void *sources = work->sources, *files = out->files;
    gw_code code = gw_grow(&sources, &work->source_capacity, out->file_count + 1, sizeof(source),
                           "shader files", work->error);
    work->sources = sources;
    if (!code) {
        code = gw_grow(&files, &work->name_capacity, out->file_count + 1, sizeof(char *), "shader files",
                       work->error);
        out->files = files;
    }
    if (code) {
        return code;
    }
    source found = {0};
    code = read_source(work, path, &found.bytes);
    if (code) {
        return code;
    }
    char *copy = gw_copy_text(path);
    if (!copy) {
        gw_bytes_finish(&found.bytes);
        return gw_fail(work->error, GW_MACHINE, "%s: not enough memory to read it", path);
    }
    *number = out->file_count;
    work->sources[*number] = found;
    out->files[*number] = copy;
    out->file_count++;
    return GW_OK;
}

static gw_code take_file(assembler *work, size_t number, int depth);

/* The directive's word after '#', and where it ends; NULL when the line is no directive. */
static const char *directive(const char *line, const char *end, size_t *length) {
    while (line < end && (*line == ' ' || *line == '\t')) {
        line++;
    }
    if (line == end || *line != '#') {
        return NULL;
    }
    line++;
    while (line < end && (*line == ' ' || *line == '\t')) {
        line++;
    }
    *length = 0;
    while (line + *length < end && line[*length] >= 'a' && line[*length] <= 'z') {
        ++*length;
    }
    return line;
}

static int word_is(const char *word, size_t length, const char *expected) {
    return length == strlen(expected) && memcmp(word, expected, length) == 0;
}

static gw_code take_include(assembler *work, size_t from, int line, const char *rest, const char *end,
                            int depth) {
    const char *here = work->out->files[from];
    const char *open = memchr(rest, '"', (size_t)(end - rest));
    const char *close = open ? memchr(open + 1, '"', (size_t)(end - open - 1)) : NULL;
    if (!close) {
        return gw_fail(work->error, GW_BAD_INPUT, "%s:%d: #include needs a name in double quotes", here,
                       line);
    }
    size_t number = 0;
    if (find_source(work, open + 1, (size_t)(close - open - 1), &number)) {
        return gw_context(work->error, "%s:%d", work->out->files[from], line);
    }
    if (work->sources[number].always) {
        return append(work, "\n", 1);
    }
    if (work->sources[number].open || depth + 1 >= INCLUDE_DEPTH) {
        return gw_fail(work->error, GW_BAD_INPUT, "%s:%d: including %s here would never end",
                       work->out->files[from], line, work->out->files[number]);
    }
    int conditional = work->condition_depth > 0;
    gw_code code = append_line(work, "#ifndef GW_FILE_%zu\n#define GW_FILE_%zu\n#line %zu\n", number, number,
                               number * GW_SHADER_LINES + 1);
    if (!code) {
        code = take_file(work, number, depth + 1);
    }
    work->sources[number].always = !conditional;
    return code ? code : append_line(work, "#endif\n#line %zu\n", from * GW_SHADER_LINES + (size_t)line + 1);
}

static gw_code take_file(assembler *work, size_t number, int depth) {
    /* The arrays may move while we recurse: only the bytes stay where they are. */
    const char *text = (const char *)work->sources[number].bytes.data;
    const char *end = text + work->sources[number].bytes.size;
    work->sources[number].open = 1;
    int conditions_before = work->condition_depth;
    gw_code code = GW_OK;
    for (int line = 1; text < end && !code; line++) {
        const char *line_end = memchr(text, '\n', (size_t)(end - text));
        line_end = line_end ? line_end : end;
        size_t length = 0;
        const char *word = directive(text, line_end, &length);
        if (word && word_is(word, length, "include")) {
            code = take_include(work, number, line, word + length, line_end, depth);
        } else {
            if (word && (word_is(word, length, "if") || word_is(word, length, "ifdef") ||
                         word_is(word, length, "ifndef"))) {
                work->condition_depth++;
            } else if (word && word_is(word, length, "endif")) {
                work->condition_depth--;
            }
            code = append(work, text, (size_t)(line_end - text));
            code = code ? code : append(work, "\n", 1);
        }
        text = line_end + (line_end < end);
        if (!code && line == GW_SHADER_LINES - 1 && text < end) {
            code =
                gw_fail(work->error, GW_BAD_INPUT, "%s: more than %d lines", work->out->files[number], line);
        }
    }
    work->sources[number].open = 0;
    if (!code && work->condition_depth != conditions_before) {
        code =
            gw_fail(work->error, GW_BAD_INPUT, "%s: #if and #endif do not pair up", work->out->files[number]);
    }
    return code;
}

static int part_of_word(char c) {
    return c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* Whether the word stands in the text, what follows "//" in a line aside. */
static int has_word(const char *text, const char *word, size_t length) {
    for (const char *line = text; *line;) {
        const char *end = line + strcspn(line, "\n");
        for (const char *at = line; at < end && memcmp(at, "//", 2) != 0; at++) {
            if (strncmp(at, word, length) == 0 && !part_of_word(at[length]) &&
                (at == line || !part_of_word(at[-1]))) {
                return 1;
            }
        }
        line = end + (*end == '\n');
    }
    return 0;
}

/* The lines of defines whose name the body reads. */
static gw_code append_defines(assembler *work, const char *defines, const char *body) {
    static const char define[] = "#define ";
    gw_code code = GW_OK;
    while (*defines && !code) {
        const char *end = defines + strcspn(defines, "\n"), *name = defines + strlen(define);
        size_t length = 0;
        end += *end == '\n';
        while (strncmp(defines, define, strlen(define)) == 0 && part_of_word(name[length])) {
            length++;
        }
        if (length == 0 || has_word(body, name, length)) {
            code = append(work, defines, (size_t)(end - defines));
        }
        defines = end;
    }
    return code;
}

/* The version line and the defines go before the body, which was assembled first. */
static gw_code put_head(assembler *work, const char *defines) {
    char *body = work->out->text;
    const size_t size = work->size;
    work->out->text = NULL;
    work->size = work->capacity = 0;
    gw_code code = append_line(work, "#version 450 core\n");
    if (!code && defines) {
        code = append_defines(work, defines, body);
    }
    if (!code) {
        code = append_line(work, "\n#line 1\n");
    }
    if (!code) {
        code = append(work, body, size);
    }
    free(body);
    return code;
}

gw_code gw_shader_text_create(const char *folder, const char *name, const char *defines, gw_shader_text *out,
                              gw_error *error) {
    *out = (gw_shader_text){0};
    assembler work = {.folder = folder, .out = out, .error = error};
    size_t number = 0;
    gw_code code = find_source(&work, name, strlen(name), &number);
    if (!code) {
        code = take_file(&work, number, 0);
    }
    if (!code) {
        code = append(&work, "", 0); /* an empty file is a body, too */
    }
    if (!code) {
        code = put_head(&work, defines);
    }
    for (size_t i = 0; i < out->file_count; i++) {
        gw_bytes_finish(&work.sources[i].bytes);
    }
    free(work.sources);
    if (code) {
        gw_shader_text_finish(out);
    }
    return code;
}

void gw_shader_text_finish(gw_shader_text *text) {
    for (size_t i = 0; i < text->file_count; i++) {
        free(text->files[i]);
    }
    free(text->files);
    free(text->text);
    *text = (gw_shader_text){0};
}

/* Line number at the start of a line of the log, counted over all files, or 0; *rest is what follows it. */
static unsigned long message_line(const char *line, const char **rest) {
    static const char *const leads[] = {"ERROR: ", "WARNING: "};
    for (size_t i = 0; i < sizeof leads / sizeof leads[0]; i++) {
        if (strncmp(line, leads[i], strlen(leads[i])) == 0) {
            line += strlen(leads[i]);
        }
    }
    size_t digits = strspn(line, "0123456789");
    if (digits == 0 || (line[digits] != ':' && line[digits] != '(')) {
        return 0;
    }
    line += digits + 1;
    digits = strspn(line, "0123456789");
    if (digits == 0 || digits > 9) {
        return 0;
    }
    *rest = line + digits;
    return strtoul(line, NULL, 10);
}

/* Whether a line of the log says why compiling failed, and not what the driver would rather see. */
static bool is_error_line(const char *line, size_t length) {
    char *copy = strndup(line, length);
    bool is_error = copy && strcasestr(copy, "error") && !strcasestr(copy, "warning");
    free(copy);
    return is_error;
}

static void write_line(FILE *stream, const gw_shader_text *text, const char *line, size_t length) {
    const char *rest = NULL;
    unsigned long number = message_line(line, &rest);
    if (number > 0 && number / GW_SHADER_LINES < text->file_count) {
        fprintf(stream, "%s:%lu%.*s\n", text->files[number / GW_SHADER_LINES], number % GW_SHADER_LINES,
                (int)(length - (size_t)(rest - line)), rest);
    } else {
        fprintf(stream, "%.*s\n", (int)length, line);
    }
}

char *gw_shader_text_message(const gw_shader_text *text, const char *log) {
    char *message = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&message, &size);
    if (!stream) {
        return NULL;
    }
    /* Drivers list in the order of lines; errors go first, because an error text has an end. */
    for (int errors = 1; errors >= 0; errors--) {
        for (const char *line = log; *line;) {
            size_t length = strcspn(line, "\n");
            if (is_error_line(line, length) == (errors == 1)) {
                write_line(stream, text, line, length);
            }
            line += length + (line[length] == '\n');
        }
    }
    if (fclose(stream) != 0) {
        free(message);
        return NULL;
    }
    if (size > 0 && message[size - 1] == '\n') {
        message[size - 1] = '\0';
    }
    return message;
}
