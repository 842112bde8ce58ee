/* Site files: YAML to site. The format is docs/sites.md; every key not listed here is an error. */
#include "wall/site_internal.h"

#include "base/embedded.h"
#include "base/file.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

gw_code gw_site_map(const gw_yaml_node *node, const char *key, const char *const *names, size_t count,
                    gw_error *error) {
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, key, error);
    return code ? code : gw_yaml_check_keys(node, names, count, error);
}

gw_code gw_site_require(const gw_yaml_node *map, const char *key, const gw_yaml_node **out, gw_error *error) {
    *out = gw_yaml_find(map, key);
    return *out ? GW_OK : gw_yaml_fail(map, error, "key '%s' is missing here", key);
}

gw_code gw_site_number(const gw_yaml_node *map, const char *key, double minimum, double maximum, double *out,
                       gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    return node ? gw_yaml_number(node, key, minimum, maximum, out, error) : GW_OK;
}

gw_code gw_site_pixels(const gw_yaml_node *map, const char *key, uint32_t minimum, uint32_t out[2],
                       gw_error *error) {
    const gw_yaml_node *node;
    gw_code code = gw_site_require(map, key, &node, error);
    if (!code)
        code = gw_yaml_expect(node, GW_YAML_LIST, key, error);
    if (!code && gw_yaml_count(node) != 2)
        code = gw_yaml_fail(node, error, "key '%s': %zu values; expected two, across and down, in pixels",
                            key, gw_yaml_count(node));
    for (size_t i = 0; i < 2 && !code; i++) {
        long value = 0;
        code = gw_yaml_integer(gw_yaml_item(node, i), key, minimum, GW_MAXIMUM_WALL_SIDE, &value, error);
        out[i] = (uint32_t)value;
    }
    return code;
}

gw_code gw_site_point(const gw_yaml_node *node, const char *key, double out[3], gw_error *error) {
    gw_code code = gw_yaml_numbers(node, key, 3, out, error);
    for (int i = 0; i < 3 && !code; i++)
        if (!(fabs(out[i]) <= 1e6))
            code = gw_yaml_fail(node, error, "key '%s': %g is more than a kilometre away; expected mm", key,
                                out[i]);
    return code;
}

gw_code gw_site_name(const gw_yaml_node *map, char out[32], gw_error *error) {
    const gw_yaml_node *node;
    gw_code code = gw_site_require(map, "name", &node, error);
    return code ? code : gw_site_text(map, "name", "-_", 32, out, error);
}

gw_code gw_site_text(const gw_yaml_node *map, const char *key, const char *others, size_t size, char *out,
                     gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_SCALAR, key, error);
    if (code)
        return code;
    const char *text = gw_yaml_text(node);
    size_t length = strlen(text);
    if (length < 1 || length >= size)
        return gw_yaml_fail(node, error, "key '%s': %zu characters; expected 1 to %zu", key, length,
                            size - 1);
    for (size_t i = 0; i < length; i++)
        if (!isalnum((unsigned char)text[i]) && !strchr(others, text[i]))
            return gw_yaml_fail(node, error,
                                "key '%s': '%.60s' has a character that cannot be here; expected letters, "
                                "digits and any of %s",
                                key, text, others);
    memcpy(out, text, length + 1);
    return GW_OK;
}

static gw_code read_layout(gw_site_source *source, gw_layout *out, gw_error *error) {
    static const char *const kinds[] = {"grid", "curve", "walls", "tiles"};
    const gw_yaml_node *eye = gw_yaml_find(source->root, "eye"), *nodes[GW_COUNT(kinds)];
    size_t count = 0, kind = 0;
    memcpy(out->eye, (const double[3]){0, 0, 1800}, sizeof out->eye);
    gw_code code = eye ? gw_site_point(eye, "eye", out->eye, error) : GW_OK;
    if (code)
        return code;
    for (size_t i = 0; i < GW_COUNT(kinds); i++)
        if ((nodes[i] = gw_yaml_find(source->root, kinds[i]))) {
            kind = i;
            count++;
        }
    if (count != 1)
        return gw_yaml_fail(count ? nodes[kind] : source->root, error,
                            "a site has one of 'grid', 'curve', 'walls' or 'tiles'; this one has %zu of them",
                            count);
    const gw_yaml_node *size = gw_yaml_find(source->root, "framed_size");
    if (kind == 3)
        return gw_site_read_tiles(source, nodes[kind], size, out, error);
    if (size)
        return gw_yaml_fail(size, error, "key 'framed_size' goes with 'tiles' only");
    return gw_site_generate(source, kinds[kind], nodes[kind], out, error);
}

/* A whole number, if the key is there; else *out stays. */
static gw_code read_whole(const gw_yaml_node *map, const char *key, long least, long most, long *out,
                          gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    return node ? gw_yaml_integer(node, key, least, most, out, error) : GW_OK;
}

static gw_code read_times(const gw_yaml_node *root, gw_site_times *out, gw_error *error) {
    static const char *const names[] = {"load", "frame", "death", "refresh", "restarts"};
    const gw_yaml_node *map = gw_yaml_find(root, "times");
    long restarts = (long)out->restarts;
    if (!map)
        return GW_OK;
    gw_code code = gw_site_map(map, "times", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_number(map, "load", 1, 86400, &out->load, error);
    if (!code)
        code = gw_site_number(map, "frame", 0.001, 60, &out->frame, error);
    if (!code)
        code = gw_site_number(map, "death", 0.2, 600, &out->death, error);
    if (!code)
        code = gw_site_number(map, "refresh", 1, 1000, &out->refresh, error);
    if (!code)
        code = read_whole(map, "restarts", 0, 60, &restarts, error);
    out->restarts = (double)restarts;
    if (!code && out->death <= out->frame)
        return gw_yaml_fail(map, error,
                            "key 'times': a tile would be lost after %g s, before it is late after %g s; "
                            "'death' must be greater than 'frame'",
                            out->death, out->frame);
    return code;
}

gw_code gw_site_address(const gw_yaml_node *map, const char *key, char out[64], gw_error *error) {
    struct in6_addr bytes;
    gw_code code = gw_site_text(map, key, ".:", 64, out, error);
    if (!code && out[0] && inet_pton(AF_INET, out, &bytes) != 1 && inet_pton(AF_INET6, out, &bytes) != 1)
        return gw_yaml_fail(gw_yaml_find(map, key), error,
                            "key '%s': '%s' is no address; expected one of this machine's own, as 10.0.0.1",
                            key, out);
    return code;
}

static gw_code read_network(const gw_yaml_node *root, gw_site *site, gw_error *error) {
    static const char *const names[] = {"address", "port"};
    long port = 0;
    const gw_yaml_node *map = gw_yaml_find(root, "network");
    if (!map)
        return GW_OK;
    gw_code code = gw_site_map(map, "network", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_address(map, "address", site->address, error);
    if (!code)
        code = read_whole(map, "port", 1024, 65535, &port, error);
    site->port = (uint16_t)port;
    return code;
}

static gw_code read_viewer(const gw_yaml_node *root, gw_site *out, gw_error *error) {
    static const char *const names[] = {"fly_speed"};
    const gw_yaml_node *map = gw_yaml_find(root, "navigation");
    gw_code code = gw_site_number(root, "eye_distance", 0, 100, &out->eye_distance, error);
    if (!code && map)
        code = gw_site_map(map, "navigation", names, GW_COUNT(names), error);
    return code || !map ? code : gw_site_number(map, "fly_speed", 0, 1e6, &out->fly_speed, error);
}

static gw_code read_site(gw_site_source *source, gw_site *out, gw_error *error) {
    static const char *const names[] = {"version", "eye",   "eye_distance", "tracker", "navigation", "times",
                                        "network", "panel", "panels",       "hosts",   "grid",       "curve",
                                        "walls",   "tiles", "framed_size",  "trackers"};
    const gw_yaml_node *node, *root = source->root;
    long version = 0;
    gw_code code = gw_site_map(root, "site", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_require(root, "version", &node, error);
    if (!code)
        code = gw_yaml_integer(node, "version", 1, 1, &version, error);
    if (!code)
        code = read_layout(source, &out->layout, error);
    if (!code)
        code = gw_site_read_panels(source, out, error);
    if (!code)
        code = read_times(root, &out->times, error);
    if (!code)
        code = read_network(root, out, error);
    if (!code)
        code = read_viewer(root, out, error);
    if (!code)
        code = gw_site_read_trackers(source, out, error);
    return code ? code : gw_site_check(source, out, error);
}

static gw_code read_document(const gw_yaml *document, gw_site *out, gw_site_notes *notes, gw_error *error) {
    gw_site_source source = {.root = gw_yaml_root(document), .notes = notes};
    memset(out, 0, sizeof *out);
    gw_site_defaults(out);
    return read_site(&source, out, error);
}

gw_code gw_site_parse(const char *text, size_t size, const char *name, gw_site *out, gw_site_notes *notes,
                      gw_error *error) {
    gw_yaml *document = NULL;
    memset(notes, 0, sizeof *notes);
    gw_code code = gw_yaml_parse(text, size, name, &document, error);
    if (!code)
        code = read_document(document, out, notes, error);
    gw_yaml_destroy(&document);
    return code;
}

/* --- sites inside the program: configs/sites/NAME.yaml by its name alone */

static const char SITES[] = "configs/sites/";
enum { SITE_NAME = 64 };

static const gw_embedded_file *find_embedded(const char *path) {
    char name[sizeof SITES + SITE_NAME + 8];
    if (gw_file_exists(path) || strlen(path) > SITE_NAME)
        return NULL;
    snprintf(name, sizeof name, "%s%s.yaml", SITES, path);
    return gw_embedded_find(name);
}

/* A bare word that is no file was meant as one of these. */
static gw_code no_such_site(const char *word, gw_error *error) {
    char names[512] = "";
    size_t used = 0;
    for (size_t i = 0; i < gw_embedded_count && used + SITE_NAME < sizeof names; i++) {
        const char *own = gw_embedded_files[i].name + sizeof SITES - 1;
        if (!strncmp(gw_embedded_files[i].name, SITES, sizeof SITES - 1))
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%.*s", used ? ", " : "",
                                     (int)strcspn(own, "."), own);
    }
    return gw_fail(error, GW_BAD_INPUT,
                   "%s: there is no such file, nor a site of this program; those are: %s", word, names);
}

gw_code gw_site_load_noting(const char *path, gw_site *out, gw_site_notes *notes, gw_error *error) {
    const gw_embedded_file *embedded = find_embedded(path);
    if (embedded)
        return gw_site_parse((const char *)embedded->data, embedded->size, path, out, notes, error);
    if (!gw_file_exists(path) && !strpbrk(path, "/."))
        return no_such_site(path, error);
    gw_yaml *document = NULL;
    memset(notes, 0, sizeof *notes);
    gw_code code = gw_yaml_load(path, &document, error);
    if (!code)
        code = read_document(document, out, notes, error);
    gw_yaml_destroy(&document);
    return code;
}

gw_code gw_site_load(const char *path, gw_site *out, gw_error *error) {
    gw_site_notes notes;
    return gw_site_load_noting(path, out, &notes, error);
}
