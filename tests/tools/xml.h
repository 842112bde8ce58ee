/* A small reader of XML for the scene converter: elements and attributes, no text. Reads untrusted bytes;
 * nothing recurses. Any thread. */
#ifndef GW_TESTS_TOOLS_XML_H
#define GW_TESTS_TOOLS_XML_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct xml_element {
    const char *name;
    uint32_t attribute_first, attribute_count;
    int32_t parent, first_child, last_child, next; /* indices of elements, -1 for none */
} xml_element;

typedef struct xml_attribute {
    const char *name, *value;
} xml_attribute;

/* Element 0 is the root. Names and values point into text. */
typedef struct xml_document {
    char *text;
    xml_element *elements;
    xml_attribute *attributes;
    size_t element_count, element_capacity, attribute_count, attribute_capacity;
} xml_document;

/* name is the file's, for messages. On failure *out is empty. */
gw_code xml_parse(const char *name, const void *data, size_t size, xml_document *out, gw_error *error);
void xml_finish(xml_document *document);

/* The attribute's value, or NULL. */
const char *xml_attribute_of(const xml_document *document, int32_t element, const char *name);

/* The first child of `element` (after = -1) or the next sibling of `after`; -1 after the last. */
int32_t xml_child(const xml_document *document, int32_t element, int32_t after);

int xml_is(const xml_document *document, int32_t element, const char *name);

#endif
