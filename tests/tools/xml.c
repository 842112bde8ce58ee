#include "tests/tools/xml.h"

#include "base/memory.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* What is being read; `at` walks over the document's own text, which is cut into strings on the way. */
typedef struct reader {
    const char *name;
    xml_document *document;
    char *at;
    int32_t open; /* the innermost element that has not ended, -1 for none */
    gw_error *error;
} reader;

static int is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static int is_name(char c) {
    return c != '\0' && !is_blank(c) && !strchr("<>/=\"'&?!", c);
}

static void skip_blanks(reader *self) {
    while (is_blank(*self->at))
        self->at++;
}

static gw_code refuse(const reader *self, const char *what) {
    size_t line = 1;
    for (const char *c = self->document->text; c < self->at; c++)
        line += *c == '\n';
    return gw_fail(self->error, GW_BAD_INPUT, "%s:%zu: %s", self->name, line, what);
}

/* The five entities of XML, in place; others stay as they stand. */
static void decode_entities(char *text) {
    static const struct {
        const char *name;
        char is;
    } entities[] = {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
    char *to = text;
    for (const char *from = text; *from;) {
        size_t length = 1;
        char c = *from;
        for (size_t i = 0; c == '&' && i < sizeof entities / sizeof *entities; i++)
            if (!strncmp(from, entities[i].name, strlen(entities[i].name))) {
                length = strlen(entities[i].name);
                *to = entities[i].is;
            }
        if (length == 1)
            *to = c;
        to++;
        from += length;
    }
    *to = '\0';
}

static gw_code add_element(reader *self, const char *name) {
    xml_document *d = self->document;
    if (d->element_count >= INT32_MAX)
        return refuse(self, "more than 2^31 elements");
    gw_code code = gw_grow((void **)&d->elements, &d->element_capacity, d->element_count + 1,
                           sizeof *d->elements, "XML elements", self->error);
    if (code != GW_OK)
        return code;
    int32_t index = (int32_t)d->element_count++;
    d->elements[index] = (xml_element){.name = name,
                                       .attribute_first = (uint32_t)d->attribute_count,
                                       .parent = self->open,
                                       .first_child = -1,
                                       .last_child = -1,
                                       .next = -1};
    if (self->open >= 0) {
        xml_element *parent = &d->elements[self->open];
        if (parent->last_child >= 0)
            d->elements[parent->last_child].next = index;
        else
            parent->first_child = index;
        parent->last_child = index;
    }
    self->open = index;
    return GW_OK;
}

/* name = "value"; the reader stands on the name. */
static gw_code read_attribute(reader *self) {
    xml_document *d = self->document;
    char *name = self->at;
    while (is_name(*self->at))
        self->at++;
    char *name_end = self->at;
    skip_blanks(self);
    if (name_end == name || *self->at != '=')
        return refuse(self, "an attribute must be NAME=\"VALUE\"");
    self->at++;
    skip_blanks(self);
    char quote = *self->at;
    char *end = quote == '"' || quote == '\'' ? strchr(self->at + 1, quote) : NULL;
    if (!end)
        return refuse(self, "an attribute's value must stand in quotes");
    gw_code code = gw_grow((void **)&d->attributes, &d->attribute_capacity, d->attribute_count + 1,
                           sizeof *d->attributes, "XML attributes", self->error);
    if (code != GW_OK)
        return code;
    d->attributes[d->attribute_count++] = (xml_attribute){name, self->at + 1};
    d->elements[self->open].attribute_count++;
    self->at = end + 1;
    *name_end = *end = '\0';
    decode_entities((char *)d->attributes[d->attribute_count - 1].value);
    return GW_OK;
}

/* <name attributes> or <name attributes/>; the reader stands after '<'. */
static gw_code read_start(reader *self) {
    char *name = self->at;
    while (is_name(*self->at))
        self->at++;
    char *name_end = self->at;
    if (name_end == name)
        return refuse(self, "'<' without a name after it");
    if (self->open < 0 && self->document->element_count > 0)
        return refuse(self, "a second root element");
    gw_code code = add_element(self, name);
    skip_blanks(self);
    while (code == GW_OK && is_name(*self->at)) {
        code = read_attribute(self);
        skip_blanks(self);
    }
    if (code != GW_OK)
        return code;
    int empty = *self->at == '/';
    self->at += empty;
    if (*self->at != '>')
        return refuse(self, "a tag must end with '>'");
    self->at++;
    *name_end = '\0';
    if (empty)
        self->open = self->document->elements[self->open].parent;
    return GW_OK;
}

/* </name>; the reader stands after "</". */
static gw_code read_end(reader *self) {
    const char *open = self->open >= 0 ? self->document->elements[self->open].name : NULL;
    size_t length = open ? strlen(open) : 0;
    if (!open || strncmp(self->at, open, length) != 0 || is_name(self->at[length]))
        return refuse(self, "an end tag that belongs to no open element");
    self->at += length;
    skip_blanks(self);
    if (*self->at != '>')
        return refuse(self, "a tag must end with '>'");
    self->at++;
    self->open = self->document->elements[self->open].parent;
    return GW_OK;
}

/* Comments, declarations and processing instructions are passed over; the reader stands after '<'. */
static gw_code skip_other(reader *self) {
    const char *ending = !strncmp(self->at, "!--", 3) ? "-->" : *self->at == '?' ? "?>" : ">";
    char *end = strstr(self->at, ending);
    if (!end)
        return refuse(self, "a comment or declaration does not end");
    self->at = end + strlen(ending);
    return GW_OK;
}

static gw_code read_all(reader *self) {
    gw_code code = GW_OK;
    while (code == GW_OK && (self->at = strchr(self->at, '<'))) {
        self->at++;
        if (*self->at == '!' || *self->at == '?')
            code = skip_other(self);
        else if (*self->at == '/') {
            self->at++;
            code = read_end(self);
        } else
            code = read_start(self);
    }
    if (code == GW_OK && (self->open >= 0 || self->document->element_count == 0))
        code = gw_fail(self->error, GW_BAD_INPUT, "%s: the file ends inside an element, or has none",
                       self->name);
    return code;
}

gw_code xml_parse(const char *name, const void *data, size_t size, xml_document *out, gw_error *error) {
    *out = (xml_document){0};
    if (memchr(data, '\0', size))
        return gw_fail(error, GW_BAD_INPUT, "%s: not a text: it contains zero bytes", name);
    gw_code code = gw_allocate((void **)&out->text, size + 1, 1, "XML text", error);
    if (code != GW_OK)
        return code;
    memcpy(out->text, data, size);
    reader self = {.name = name, .document = out, .at = out->text, .open = -1, .error = error};
    code = read_all(&self);
    if (code != GW_OK)
        xml_finish(out);
    return code;
}

void xml_finish(xml_document *document) {
    free(document->text);
    free(document->elements);
    free(document->attributes);
    *document = (xml_document){0};
}

const char *xml_attribute_of(const xml_document *document, int32_t element, const char *name) {
    const xml_element *e = &document->elements[element];
    for (uint32_t i = 0; i < e->attribute_count; i++)
        if (!strcmp(document->attributes[e->attribute_first + i].name, name))
            return document->attributes[e->attribute_first + i].value;
    return NULL;
}

int32_t xml_child(const xml_document *document, int32_t element, int32_t after) {
    return after >= 0 ? document->elements[after].next : document->elements[element].first_child;
}

int xml_is(const xml_document *document, int32_t element, const char *name) {
    return strcmp(document->elements[element].name, name) == 0;
}
