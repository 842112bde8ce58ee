/* The tree is built from libyaml's events, not by its document loader, because the loader has no limit of
 * depth and takes very long on deep nesting. */
#include "base/yaml.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/suggest.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { SIZE_LIMIT = 1 << 20, DEPTH_LIMIT = 64 };

struct gw_yaml_node {
    const gw_yaml *document; /* for the name in messages */
    gw_yaml_kind kind;
    int line;
    int quoted;           /* scalar in quotes or a block: text, never a number or a switch */
    char *text;           /* scalar */
    gw_yaml_node **items; /* list's items or map's values */
    gw_yaml_node **keys;  /* map: scalar nodes, parallel to items */
    size_t count, item_capacity, key_capacity;
};

struct gw_yaml {
    char *name;
    gw_yaml_node *root;
};

/* A load in progress: the open collections from the root inwards. */
typedef struct loader {
    gw_yaml *document;
    yaml_parser_t parser;
    gw_yaml_node *open[DEPTH_LIMIT];
    size_t depth;
    gw_yaml_node *key; /* of the innermost map, waiting for its value */
    gw_error *error;
} loader;

static void node_destroy(gw_yaml_node *node) {
    if (!node) {
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        node_destroy(node->items[i]);
        if (node->keys) {
            node_destroy(node->keys[i]);
        }
    }
    free(node->text);
    free(node->items);
    free(node->keys);
    free(node);
}

void gw_yaml_destroy(gw_yaml **document) {
    if (document && *document) {
        node_destroy((*document)->root);
        free((*document)->name);
        free(*document);
        *document = NULL;
    }
}

static gw_code fail_at(const loader *load, size_t line, const char *text) {
    return gw_fail(load->error, GW_BAD_INPUT, "%s:%zu: %s", load->document->name, line, text);
}

static gw_code no_memory(const loader *load) {
    return gw_fail(load->error, GW_MACHINE, "%s: not enough memory to read it", load->document->name);
}

/* Appends child to the innermost open collection; on success the tree owns it. */
static gw_code attach(loader *load, gw_yaml_node *child) {
    if (load->depth == 0) {
        load->document->root = child;
        return GW_OK;
    }
    gw_yaml_node *parent = load->open[load->depth - 1];
    if (parent->kind == GW_YAML_MAP && !load->key) {
        if (child->kind != GW_YAML_SCALAR) {
            return fail_at(load, (size_t)child->line, "a key must be a plain word, not a list or a map");
        }
        load->key = child;
        return GW_OK;
    }
    void *items = parent->items, *keys = parent->keys;
    gw_code code =
        gw_grow(&items, &parent->item_capacity, parent->count + 1, sizeof child, "nodes", load->error);
    parent->items = items;
    if (!code && parent->kind == GW_YAML_MAP) {
        code = gw_grow(&keys, &parent->key_capacity, parent->count + 1, sizeof child, "nodes", load->error);
        parent->keys = keys;
    }
    if (code) {
        return code;
    }
    if (parent->kind == GW_YAML_MAP) {
        parent->keys[parent->count] = load->key;
        load->key = NULL;
    }
    parent->items[parent->count++] = child;
    return GW_OK;
}

static gw_code add_node(loader *load, gw_yaml_kind kind, const yaml_event_t *event, gw_yaml_node **out) {
    gw_yaml_node *node = calloc(1, sizeof *node);
    if (!node) {
        return no_memory(load);
    }
    node->document = load->document;
    node->kind = kind;
    node->line = (int)event->start_mark.line + 1;
    gw_code code = GW_OK;
    if (kind == GW_YAML_SCALAR) {
        const char *value = (const char *)event->data.scalar.value;
        size_t length = event->data.scalar.length;
        node->quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
        node->text = strlen(value) == length ? gw_copy_text(value) : NULL;
        if (strlen(value) != length) {
            code = fail_at(load, (size_t)node->line, "a text must not contain a zero byte");
        } else if (!node->text) {
            code = no_memory(load);
        }
    }
    if (!code) {
        code = attach(load, node);
    }
    if (code) {
        node_destroy(node);
        return code;
    }
    *out = node;
    return GW_OK;
}

static int by_text_then_line(const void *a, const void *b) {
    const gw_yaml_node *left = *(gw_yaml_node *const *)a, *right = *(gw_yaml_node *const *)b;
    int order = strcmp(left->text, right->text);
    return order ? order : (left->line > right->line) - (left->line < right->line);
}

/* Sorted, because a hostile map may have hundreds of thousands of keys. */
static gw_code check_repeated_keys(const loader *load, const gw_yaml_node *map) {
    if (map->count < 2) {
        return GW_OK;
    }
    gw_yaml_node **sorted = malloc(map->count * sizeof *sorted);
    if (!sorted) {
        return no_memory(load);
    }
    memcpy(sorted, map->keys, map->count * sizeof(gw_yaml_node *));
    qsort(sorted, map->count, sizeof(gw_yaml_node *), by_text_then_line);
    gw_code code = GW_OK;
    for (size_t i = 1; i < map->count && !code; i++) {
        if (strcmp(sorted[i - 1]->text, sorted[i]->text) == 0) {
            code =
                gw_fail(load->error, GW_BAD_INPUT, "%s:%d: key '%s' is given twice; the first is in line %d",
                        load->document->name, sorted[i]->line, sorted[i]->text, sorted[i - 1]->line);
        }
    }
    free(sorted);
    return code;
}

static gw_code open_collection(loader *load, gw_yaml_kind kind, const yaml_event_t *event) {
    if (load->depth == DEPTH_LIMIT) {
        return fail_at(load, event->start_mark.line + 1, "nested deeper than 64 levels");
    }
    gw_yaml_node *node = NULL;
    gw_code code = add_node(load, kind, event, &node);
    if (!code) {
        load->open[load->depth++] = node;
    }
    return code;
}

static gw_code close_collection(loader *load) {
    gw_yaml_node *node = load->open[--load->depth];
    return node->kind == GW_YAML_MAP ? check_repeated_keys(load, node) : GW_OK;
}

/* Anchors are refused where they are set: an alias could only follow one. Tags would change what a value
 * means. */
static gw_code refuse_extras(const loader *load, const yaml_event_t *event) {
    const yaml_char_t *anchor = NULL, *tag = NULL;
    switch (event->type) {
    case YAML_ALIAS_EVENT:
        anchor = event->data.alias.anchor;
        break;
    case YAML_SCALAR_EVENT:
        anchor = event->data.scalar.anchor;
        tag = event->data.scalar.tag;
        break;
    case YAML_SEQUENCE_START_EVENT:
        anchor = event->data.sequence_start.anchor;
        tag = event->data.sequence_start.tag;
        break;
    case YAML_MAPPING_START_EVENT:
        anchor = event->data.mapping_start.anchor;
        tag = event->data.mapping_start.tag;
        break;
    default:
        break;
    }
    if (anchor) {
        return fail_at(load, event->start_mark.line + 1, "anchors and aliases (& and *) are not supported");
    }
    if (tag) {
        return fail_at(load, event->start_mark.line + 1, "tags (!) are not supported");
    }
    return GW_OK;
}

static gw_code take_event(loader *load, const yaml_event_t *event) {
    gw_yaml_node *node = NULL;
    gw_code code = refuse_extras(load, event);
    if (code) {
        return code;
    }
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (load->document->root) {
            return fail_at(load, event->start_mark.line + 1, "a second document begins; one is allowed");
        }
        return GW_OK;
    case YAML_SCALAR_EVENT:
        return add_node(load, GW_YAML_SCALAR, event, &node);
    case YAML_SEQUENCE_START_EVENT:
        return open_collection(load, GW_YAML_LIST, event);
    case YAML_MAPPING_START_EVENT:
        return open_collection(load, GW_YAML_MAP, event);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        return close_collection(load);
    default:
        return GW_OK;
    }
}

static gw_code fail_syntax(const loader *load) {
    const yaml_parser_t *parser = &load->parser;
    if (parser->error == YAML_MEMORY_ERROR) {
        return no_memory(load);
    }
    if (parser->error == YAML_READER_ERROR) {
        return gw_fail(load->error, GW_BAD_INPUT, "%s: not valid UTF-8 text at byte %zu: %s",
                       load->document->name, parser->problem_offset, parser->problem);
    }
    return gw_fail(load->error, GW_BAD_INPUT, "%s:%zu: not valid YAML: %s%s%s", load->document->name,
                   parser->problem_mark.line + 1, parser->context ? parser->context : "",
                   parser->context ? ", " : "", parser->problem ? parser->problem : "unknown problem");
}

static gw_code take_all_events(loader *load) {
    for (;;) {
        yaml_event_t event;
        if (!yaml_parser_parse(&load->parser, &event)) {
            return fail_syntax(load);
        }
        int last = event.type == YAML_STREAM_END_EVENT;
        gw_code code = take_event(load, &event);
        yaml_event_delete(&event);
        if (code || last) {
            return code;
        }
    }
}

gw_code gw_yaml_parse(const char *text, size_t size, const char *name, gw_yaml **out, gw_error *error) {
    *out = NULL;
    if (size > SIZE_LIMIT) {
        return gw_fail(error, GW_BAD_INPUT, "%s: %zu bytes, larger than the limit of %d bytes", name, size,
                       SIZE_LIMIT);
    }
    loader load = {.error = error};
    load.document = calloc(1, sizeof *load.document);
    if (!load.document || !(load.document->name = gw_copy_text(name)) ||
        !yaml_parser_initialize(&load.parser)) {
        gw_yaml_destroy(&load.document);
        return gw_fail(error, GW_MACHINE, "%s: not enough memory to read it", name);
    }
    yaml_parser_set_encoding(&load.parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&load.parser, (const unsigned char *)text, size);
    gw_code code = take_all_events(&load);
    yaml_parser_delete(&load.parser);
    node_destroy(load.key);
    if (!code && !load.document->root) {
        code = gw_fail(error, GW_BAD_INPUT, "%s:1: there is nothing in it", name);
    }
    if (code) {
        gw_yaml_destroy(&load.document);
        return code;
    }
    *out = load.document;
    return GW_OK;
}

gw_code gw_yaml_load(const char *path, gw_yaml **out, gw_error *error) {
    *out = NULL;
    gw_bytes bytes;
    gw_code code = gw_file_read(path, SIZE_LIMIT, &bytes, error);
    if (!code) {
        code = gw_yaml_parse((const char *)bytes.data, bytes.size, path, out, error);
        gw_bytes_finish(&bytes);
    }
    return code;
}

const gw_yaml_node *gw_yaml_root(const gw_yaml *document) {
    return document->root;
}

gw_yaml_kind gw_yaml_node_kind(const gw_yaml_node *node) {
    return node->kind;
}

int gw_yaml_node_line(const gw_yaml_node *node) {
    return node->line;
}

size_t gw_yaml_count(const gw_yaml_node *node) {
    return node->count;
}

const gw_yaml_node *gw_yaml_item(const gw_yaml_node *list, size_t index) {
    return index < list->count ? list->items[index] : NULL;
}

const char *gw_yaml_key(const gw_yaml_node *map, size_t index) {
    return map->keys && index < map->count ? map->keys[index]->text : NULL;
}

const gw_yaml_node *gw_yaml_value(const gw_yaml_node *map, size_t index) {
    return map->keys ? gw_yaml_item(map, index) : NULL;
}

const gw_yaml_node *gw_yaml_find(const gw_yaml_node *map, const char *key) {
    for (size_t i = 0; map->keys && i < map->count; i++) {
        if (strcmp(map->keys[i]->text, key) == 0) {
            return map->items[i];
        }
    }
    return NULL;
}

const char *gw_yaml_text(const gw_yaml_node *node) {
    return node->text;
}

gw_code gw_yaml_fail(const gw_yaml_node *node, gw_error *error, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return gw_fail(error, GW_BAD_INPUT, "%s:%d: %s", node->document->name, node->line, text);
}

/* What stands there, for messages: the text of a scalar, cut to a readable length, else its kind. */
static const char *describe(const gw_yaml_node *node, char text[64]) {
    if (node->kind == GW_YAML_SCALAR) {
        snprintf(text, 64, "'%.40s%s'", node->text, strlen(node->text) > 40 ? "..." : "");
        return text;
    }
    return node->kind == GW_YAML_LIST ? "a list" : "a map";
}

gw_code gw_yaml_expect(const gw_yaml_node *node, gw_yaml_kind kind, const char *key, gw_error *error) {
    static const char *const names[] = {"a single value", "a list", "a map of keys and values"};
    char found[64];
    if (node->kind != kind) {
        return gw_yaml_fail(node, error, "key '%s': expected %s, found %s", key, names[kind],
                            describe(node, found));
    }
    return GW_OK;
}

/* "a, b, c": as many as fit. */
static const char *list_names(const char *const *names, size_t count, char text[400]) {
    size_t used = 0;
    text[0] = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t length = strlen(names[i]);
        if (used + length + 8 > 400) {
            memcpy(text + used, ", ...", 6);
            break;
        }
        used += (size_t)snprintf(text + used, 400 - used, "%s%s", i ? ", " : "", names[i]);
    }
    return text;
}

gw_code gw_yaml_check_keys(const gw_yaml_node *map, const char *const *names, size_t count, gw_error *error) {
    gw_code code = gw_yaml_expect(map, GW_YAML_MAP, "top level", error);
    for (size_t i = 0; i < map->count && !code; i++) {
        const char *key = map->keys[i]->text, *nearest;
        char text[400];
        size_t known = 0;
        while (known < count && strcmp(names[known], key) != 0)
            known++;
        if (known < count)
            continue;
        nearest = gw_suggest(key, names, count);
        code = nearest ? gw_yaml_fail(map->keys[i], error, "key '%.60s' is unknown; did you mean '%s'?", key,
                                      nearest)
                       : gw_yaml_fail(map->keys[i], error, "key '%.60s' is unknown here; known are: %s", key,
                                      list_names(names, count, text));
    }
    return code;
}

/* Plain decimals only: strtod alone would take hexadecimal, infinities and leading blanks. */
static int parse_plain_number(const gw_yaml_node *node, double *value) {
    if (node->kind != GW_YAML_SCALAR || node->quoted || node->text[0] == '\0' ||
        strspn(node->text, "0123456789+-.eE") != strlen(node->text)) {
        return 0;
    }
    char *end = NULL;
    *value = strtod(node->text, &end);
    return *end == '\0' && isfinite(*value);
}

gw_code gw_yaml_number(const gw_yaml_node *node, const char *key, double minimum, double maximum, double *out,
                       gw_error *error) {
    char found[64];
    double value = 0;
    if (!parse_plain_number(node, &value)) {
        return gw_yaml_fail(node, error, "key '%s': expected a number, found %s", key, describe(node, found));
    }
    if (value < minimum || value > maximum) {
        return gw_yaml_fail(node, error, "key '%s': %s is outside %g to %g", key, node->text, minimum,
                            maximum);
    }
    *out = value;
    return GW_OK;
}

gw_code gw_yaml_integer(const gw_yaml_node *node, const char *key, long minimum, long maximum, long *out,
                        gw_error *error) {
    char found[64];
    int plain = node->kind == GW_YAML_SCALAR && !node->quoted && node->text[0] != '\0' &&
                strspn(node->text, "0123456789+-") == strlen(node->text);
    char *end = NULL;
    errno = 0;
    long value = plain ? strtol(node->text, &end, 10) : 0;
    if (!plain || *end != '\0') {
        return gw_yaml_fail(node, error, "key '%s': expected a whole number, found %s", key,
                            describe(node, found));
    }
    if (errno == ERANGE || value < minimum || value > maximum) {
        return gw_yaml_fail(node, error, "key '%s': %.40s is outside %ld to %ld", key, node->text, minimum,
                            maximum);
    }
    *out = value;
    return GW_OK;
}

gw_code gw_yaml_boolean(const gw_yaml_node *node, const char *key, int *out, gw_error *error) {
    static const char *const words[2][3] = {{"false", "off", "no"}, {"true", "on", "yes"}};
    char found[64];
    for (int value = 0; value < 2 && node->kind == GW_YAML_SCALAR && !node->quoted; value++) {
        for (int i = 0; i < 3; i++) {
            if (strcmp(node->text, words[value][i]) == 0) {
                *out = value;
                return GW_OK;
            }
        }
    }
    return gw_yaml_fail(node, error, "key '%s': expected true or false, found %s", key,
                        describe(node, found));
}

gw_code gw_yaml_numbers(const gw_yaml_node *node, const char *key, size_t count, double *out,
                        gw_error *error) {
    char found[64];
    if (node->kind != GW_YAML_LIST) {
        return gw_yaml_fail(node, error, "key '%s': expected a list of %zu numbers, found %s", key, count,
                            describe(node, found));
    }
    if (node->count != count) {
        return gw_yaml_fail(node, error, "key '%s': expected %zu numbers, found %zu", key, count,
                            node->count);
    }
    for (size_t i = 0; i < count; i++) {
        if (!parse_plain_number(node->items[i], &out[i])) {
            return gw_yaml_fail(node->items[i], error, "key '%s': item %zu: expected a number, found %s", key,
                                i + 1, describe(node->items[i], found));
        }
    }
    return GW_OK;
}
