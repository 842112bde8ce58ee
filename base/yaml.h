/* YAML files as a tree with line numbers (libyaml), and typed access whose errors name file, line, key, value
 * and what was expected. One thread at a time per document. */
#ifndef GW_BASE_YAML_H
#define GW_BASE_YAML_H

#include "base/status.h"

#include <stddef.h>

typedef struct gw_yaml gw_yaml; /* a document; owns all its nodes */
typedef struct gw_yaml_node gw_yaml_node;
typedef enum gw_yaml_kind { GW_YAML_SCALAR, GW_YAML_LIST, GW_YAML_MAP } gw_yaml_kind;

/* Reads one document of at most 1 MiB, nesting at most 64, no aliases, no repeated keys. */
gw_code gw_yaml_load(const char *path, gw_yaml **out, gw_error *error);
/* The same from memory; name stands for the path in messages. */
gw_code gw_yaml_parse(const char *text, size_t size, const char *name, gw_yaml **out, gw_error *error);
void gw_yaml_destroy(gw_yaml **document);

const gw_yaml_node *gw_yaml_root(const gw_yaml *document);
gw_yaml_kind gw_yaml_node_kind(const gw_yaml_node *node);
int gw_yaml_node_line(const gw_yaml_node *node); /* 1-based */
size_t gw_yaml_count(const gw_yaml_node *node);  /* items of a list, pairs of a map, else 0 */
const gw_yaml_node *gw_yaml_item(const gw_yaml_node *list, size_t index);
const char *gw_yaml_key(const gw_yaml_node *map, size_t index);
const gw_yaml_node *gw_yaml_value(const gw_yaml_node *map, size_t index);
const gw_yaml_node *gw_yaml_find(const gw_yaml_node *map, const char *key); /* NULL when absent */
const char *gw_yaml_text(const gw_yaml_node *node);                         /* scalar's text, else NULL */

/* Checks; each failure is GW_BAD_INPUT "FILE:LINE: key 'k': ...". key is what messages call the node. */
gw_code gw_yaml_expect(const gw_yaml_node *node, gw_yaml_kind kind, const char *key, gw_error *error);
/* Every key of the map must be among names; an unknown one is an error that names the nearest known one. */
gw_code gw_yaml_check_keys(const gw_yaml_node *map, const char *const *names, size_t count, gw_error *error);
gw_code gw_yaml_number(const gw_yaml_node *node, const char *key, double minimum, double maximum, double *out,
                       gw_error *error);
gw_code gw_yaml_integer(const gw_yaml_node *node, const char *key, long minimum, long maximum, long *out,
                        gw_error *error);
gw_code gw_yaml_boolean(const gw_yaml_node *node, const char *key, int *out, gw_error *error);
/* A list of exactly count finite numbers. */
gw_code gw_yaml_numbers(const gw_yaml_node *node, const char *key, size_t count, double *out,
                        gw_error *error);
/* A general error at a node: "FILE:LINE: text". */
gw_code gw_yaml_fail(const gw_yaml_node *node, gw_error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
