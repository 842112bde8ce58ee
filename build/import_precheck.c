/* Damage that assimp 5.2.5 does not survive (a PLY header without an end never returns) or does not notice (a
 * text file that stops in the middle gives half a model). Runs in the import child. */
#include "build/import_internal.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLY_ELEMENTS = 16, PLY_PROPERTIES = 64, STL_HEADER = 84, STL_TRIANGLE = 50 };

/* A text without copies: lines from `at`. */
typedef struct lines {
    const char *at, *end;
} lines;

/* The next line, cut of blanks at both ends; 0 at the end. An unfinished last line counts. */
static int next_line(lines *text, const char **line, size_t *length) {
    if (text->at >= text->end)
        return 0;
    const char *stop = memchr(text->at, '\n', (size_t)(text->end - text->at));
    const char *begin = text->at, *end = stop ? stop : text->end;
    text->at = stop ? stop + 1 : text->end;
    while (begin < end && isspace((unsigned char)*begin))
        begin++;
    while (end > begin && isspace((unsigned char)end[-1]))
        end--;
    *line = begin;
    *length = (size_t)(end - begin);
    return 1;
}

static uint64_t count_filled_lines(lines *text, char comment) {
    const char *line;
    size_t length;
    uint64_t count = 0;
    while (next_line(text, &line, &length))
        count += length > 0 && *line != comment;
    return count;
}

/* --- PLY --- */

typedef struct ply_property {
    int count_bytes; /* of a list's length; 0: no list */
    int bytes;
} ply_property;

typedef struct ply_element {
    char name[32];
    uint64_t count;
    ply_property properties[PLY_PROPERTIES];
    int property_count;
} ply_element;

typedef struct ply_header {
    ply_element elements[PLY_ELEMENTS];
    int element_count;
    int binary, big_endian;
} ply_header;

static int ply_type_bytes(const char *name) {
    static const struct {
        const char *name;
        int bytes;
    } types[] = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
                 {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
                 {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, name) == 0)
            return types[i].bytes;
    return 0;
}

static gw_code ply_property_line(ply_header *header, const char *line, gw_error *error) {
    char first[16], second[16], third[16];
    ply_element *element = header->element_count > 0 ? &header->elements[header->element_count - 1] : NULL;
    if (!element || element->property_count == PLY_PROPERTIES)
        return gw_fail(error, GW_BAD_INPUT,
                       "the PLY header has a property in a wrong place or more than %d of them",
                       PLY_PROPERTIES);
    ply_property *property = &element->properties[element->property_count++];
    if (sscanf(line, "property list %15s %15s %15s", first, second, third) == 3)
        *property = (ply_property){ply_type_bytes(first), ply_type_bytes(second)};
    else if (sscanf(line, "property %15s %15s", first, second) == 2)
        *property = (ply_property){0, ply_type_bytes(first)};
    if (property->bytes == 0 || (strncmp(line, "property list", 13) == 0 && property->count_bytes == 0))
        return gw_fail(error, GW_BAD_INPUT, "the PLY header has an unknown property type: '%.60s'", line);
    return GW_OK;
}

static gw_code ply_header_line(ply_header *header, const char *line, gw_error *error) {
    char word[32];
    if (strncmp(line, "property", 8) == 0)
        return ply_property_line(header, line, error);
    if (strncmp(line, "element", 7) == 0) {
        unsigned long long count;
        if (header->element_count == PLY_ELEMENTS || sscanf(line, "element %31s %llu", word, &count) != 2 ||
            count > UINT32_MAX)
            return gw_fail(error, GW_BAD_INPUT,
                           "the PLY header has a broken or one too many element line: '%.60s'", line);
        ply_element *element = &header->elements[header->element_count++];
        snprintf(element->name, sizeof element->name, "%s", word);
        element->count = count;
    } else if (sscanf(line, "format %31s", word) == 1) {
        header->big_endian = strcmp(word, "binary_big_endian") == 0;
        header->binary = header->big_endian || strcmp(word, "binary_little_endian") == 0;
        if (!header->binary && strcmp(word, "ascii") != 0)
            return gw_fail(error, GW_BAD_INPUT, "the PLY header names the unknown format '%s'", word);
    }
    return GW_OK;
}

static gw_code ply_read_header(lines *text, ply_header *header, gw_error *error) {
    const char *line;
    char copy[256];
    size_t length;
    const int ends = memmem(text->at, (size_t)(text->end - text->at), "\rend_header\r", 12) != NULL;
    for (int number = 0; next_line(text, &line, &length) && number < 4096; number++) {
        if (length == 10 && memcmp(line, "end_header", 10) == 0)
            return GW_OK;
        snprintf(copy, sizeof copy, "%.*s", (int)(length < sizeof copy ? length : sizeof copy - 1), line);
        gw_code code = ply_header_line(header, copy, error);
        if (code != GW_OK)
            return code;
    }
    return gw_fail(
        error, GW_BAD_INPUT, "%s",
        ends ? "the lines of the PLY header must end in a line feed, these end in a carriage return alone"
             : "the PLY file is cut inside its header: 'end_header' is missing");
}

static uint64_t ply_list_length(const uint8_t *data, int bytes, int big_endian) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint64_t)data[i] << (8 * (big_endian ? bytes - 1 - i : i));
    return value;
}

/* Bytes of one row, 0 when it does not end inside what is left. */
static size_t ply_row_bytes(const ply_header *header, const ply_element *element, const uint8_t *data,
                            size_t left) {
    size_t at = 0;
    for (int i = 0; i < element->property_count; i++) {
        const ply_property *property = &element->properties[i];
        uint64_t count = 1;
        if (property->count_bytes > 0) {
            if (left - at < (size_t)property->count_bytes)
                return 0;
            count = ply_list_length(data + at, property->count_bytes, header->big_endian);
            at += (size_t)property->count_bytes;
        }
        if (count > (left - at) / (size_t)property->bytes)
            return 0;
        at += (size_t)count * (size_t)property->bytes;
    }
    return at;
}

static gw_code ply_check_binary(const ply_header *header, const lines *body, gw_error *error) {
    const uint8_t *data = (const uint8_t *)body->at;
    size_t left = (size_t)(body->end - body->at);
    for (int i = 0; i < header->element_count; i++) {
        const ply_element *element = &header->elements[i];
        for (uint64_t row = 0; element->property_count > 0 && row < element->count; row++) {
            const size_t bytes = ply_row_bytes(header, element, data, left);
            if (bytes == 0)
                return gw_fail(
                    error, GW_BAD_INPUT,
                    "the PLY file is cut or damaged: %llu '%s' rows are promised, it ends in row %llu",
                    (unsigned long long)element->count, element->name, (unsigned long long)row + 1);
            data += bytes;
            left -= bytes;
        }
    }
    return GW_OK;
}

static gw_code check_ply(const uint8_t *data, size_t size, gw_error *error) {
    ply_header header = {0};
    lines text = {(const char *)data, (const char *)data + size};
    if (size < 4 || memcmp(data, "ply", 3) != 0)
        return gw_fail(error, GW_BAD_INPUT, "it is not a PLY file: it does not begin with 'ply'");
    gw_code code = ply_read_header(&text, &header, error);
    if (code != GW_OK)
        return code;
    if (header.binary)
        return ply_check_binary(&header, &text, error);
    uint64_t promised = 0;
    for (int i = 0; i < header.element_count; i++)
        promised += header.elements[i].property_count > 0 ? header.elements[i].count : 0;
    const uint64_t rows = count_filled_lines(&text, '\0');
    if (rows < promised)
        return gw_fail(error, GW_BAD_INPUT, "the PLY file is cut: %llu rows are promised, %llu are there",
                       (unsigned long long)promised, (unsigned long long)rows);
    return GW_OK;
}

/* --- STL, OFF, glTF, OBJ --- */

static int contains(const uint8_t *data, size_t size, const char *word) {
    return memmem(data, size, word, strlen(word)) != NULL;
}

static gw_code check_stl(const uint8_t *data, size_t size, gw_error *error) {
    uint64_t promised = 0;
    if (size >= STL_HEADER)
        promised = (uint64_t)data[80] | (uint64_t)data[81] << 8 | (uint64_t)data[82] << 16 |
                   (uint64_t)data[83] << 24;
    if (size >= STL_HEADER && size == STL_HEADER + promised * STL_TRIANGLE)
        return GW_OK;
    const size_t begin = size < 1024 ? size : 1024;
    if (size > 5 && memcmp(data, "solid", 5) == 0 && contains(data, begin, "facet")) {
        if (!contains(data, size, "endsolid"))
            return gw_fail(error, GW_BAD_INPUT, "the STL file is cut: 'endsolid' is missing");
        return GW_OK;
    }
    if (size < STL_HEADER)
        return gw_fail(error, GW_BAD_INPUT, "it is not an STL file: %zu bytes are less than a header", size);
    return gw_fail(
        error, GW_BAD_INPUT,
        "the STL file is cut or damaged: its header promises %llu triangles (%llu bytes), it has %zu bytes",
        (unsigned long long)promised, (unsigned long long)(STL_HEADER + promised * STL_TRIANGLE), size);
}

/* "OFF", with letters before it for the extra columns; then the counts, then one row each. */
static gw_code check_off(const uint8_t *data, size_t size, gw_error *error) {
    lines text = {(const char *)data, (const char *)data + size};
    const char *line = "", *word;
    size_t length = 0;
    char copy[128];
    unsigned long long vertices = 0, faces = 0;
    while (next_line(&text, &line, &length) && (length == 0 || *line == '#'))
        continue;
    word = memmem(line, length < 8 ? length : 8, "OFF", 3);
    if (!word)
        return gw_fail(error, GW_BAD_INPUT, "it is not an OFF file: it does not begin with 'OFF'");
    length -= (size_t)(word + 3 - line);
    line = word + 3;
    while (length == 0 || *line == '#')
        if (!next_line(&text, &line, &length))
            break;
    snprintf(copy, sizeof copy, "%.*s", (int)(length < sizeof copy ? length : sizeof copy - 1), line);
    if (sscanf(copy, "%llu %llu", &vertices, &faces) != 2 || vertices > UINT32_MAX || faces > UINT32_MAX)
        return gw_fail(error, GW_BAD_INPUT, "the OFF file is cut or damaged: its counts are missing");
    const uint64_t rows = count_filled_lines(&text, '#');
    if (rows < vertices + faces)
        return gw_fail(error, GW_BAD_INPUT, "the OFF file is cut: %llu rows are promised, %llu are there",
                       vertices + faces, (unsigned long long)rows);
    return GW_OK;
}

static gw_code check_gltf(const uint8_t *data, size_t size, gw_error *error) {
    size_t at = 0;
    if (size >= 4 && memcmp(data, "glTF", 4) == 0) {
        if (size < 12)
            return gw_fail(error, GW_BAD_INPUT, "the .glb file is cut: %zu bytes are less than a header",
                           size);
        return GW_OK;
    }
    while (at < size && isspace(data[at]))
        at++;
    if (at == size || data[at] != '{')
        return gw_fail(error, GW_BAD_INPUT,
                       "it is not a glTF file: it begins neither with '{' nor with 'glTF'");
    return GW_OK;
}

static gw_code check_obj(const uint8_t *data, size_t size, gw_error *error) {
    if (memchr(data, '\0', size))
        return gw_fail(error, GW_BAD_INPUT,
                       "it is not an OBJ text: it holds zero bytes (if it is UTF-16, save it as UTF-8)");
    return GW_OK;
}

gw_code gw_import_precheck(gw_model_format format, const uint8_t *data, size_t size, gw_error *error) {
    switch (format) {
    case GW_FORMAT_GLTF:
        return check_gltf(data, size, error);
    case GW_FORMAT_OBJ:
        return check_obj(data, size, error);
    case GW_FORMAT_PLY:
        return check_ply(data, size, error);
    case GW_FORMAT_STL:
        return check_stl(data, size, error);
    case GW_FORMAT_OFF:
        return check_off(data, size, error);
    }
    return GW_OK;
}
