#include "wall/calibrate_file.h"

#include "base/memory.h"
#include "base/yaml.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static gw_code read_version(const gw_yaml_node *root, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(root, "version");
    long version = 0;
    return node ? gw_yaml_integer(node, "version", 1, 1, &version, error)
                : gw_yaml_fail(root, error, "key 'version' is missing here; it is 1");
}

/* Three numbers of a key that must be there, none beyond `most`. */
static gw_code read_point(const gw_yaml_node *map, const char *key, double most, double out[3],
                          gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    if (!node)
        return gw_yaml_fail(map, error, "key '%s' is missing here", key);
    gw_code code = gw_yaml_numbers(node, key, 3, out, error);
    for (int i = 0; i < 3 && !code; i++)
        if (!(fabs(out[i]) <= most))
            code = gw_yaml_fail(node, error, "key '%s': %g is beyond any room", key, out[i]);
    return code;
}

/* --- marks
 * ---------------------------------------------------------------------------------------------------- */

static gw_code read_name(const gw_yaml_node *map, uint32_t index, char out[32], gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "name");
    snprintf(out, 32, "%u", index + 1);
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_SCALAR, "name", error);
    if (code)
        return code;
    const char *text = gw_yaml_text(node);
    int good = text[0] && strlen(text) < 32;
    for (const char *c = text; *c && good; c++)
        good = isprint((unsigned char)*c);
    if (!good)
        return gw_yaml_fail(node, error, "key 'name': expected 1 to 31 plain characters");
    snprintf(out, 32, "%s", text);
    return GW_OK;
}

static gw_code read_times(const gw_yaml_node *node, double out[2], gw_error *error) {
    gw_code code = gw_yaml_numbers(node, "time", 2, out, error);
    if (!code && !(out[0] >= 0 && out[1] > out[0] && out[1] <= 1e6))
        code = gw_yaml_fail(
            node, error,
            "key 'time': %g to %g s; expected when the sensor was held at the mark, from and to, "
            "in seconds of the recording",
            out[0], out[1]);
    return code;
}

static gw_code read_mark(const gw_yaml_node *map, gw_marks *out, gw_error *error) {
    static const char *const names[] = {"name", "wall", "device", "time"};
    const uint32_t index = out->count;
    gw_calibration_point *point = &out->points[index];
    gw_code code = gw_yaml_expect(map, GW_YAML_MAP, "points", error);
    if (!code)
        code = gw_yaml_check_keys(map, names, COUNT(names), error);
    if (!code)
        code = read_name(map, index, point->name, error);
    if (!code)
        code = read_point(map, "wall", 1e6, point->wall, error);
    const gw_yaml_node *device = code ? NULL : gw_yaml_find(map, "device"),
                       *time = code ? NULL : gw_yaml_find(map, "time");
    if (device && time)
        return gw_yaml_fail(time, error, "key 'time': the mark has a 'device', too; keep one");
    out->known[index] = device != NULL;
    out->timed[index] = time != NULL;
    if (device)
        code = read_point(map, "device", 1e9, point->device, error);
    if (time)
        code = read_times(time, out->times[index], error);
    for (uint32_t other = 0; other < index && !code; other++)
        if (!strcmp(out->points[other].name, point->name))
            code = gw_yaml_fail(map, error, "key 'name': '%s' is a mark already", point->name);
    out->count++;
    return code;
}

static gw_code read_source(const gw_yaml_node *root, gw_marks *out, gw_error *error) {
    const gw_yaml_node *source = gw_yaml_find(root, "source"), *sensor = gw_yaml_find(root, "sensor");
    long number = 0;
    gw_code code = source ? gw_yaml_expect(source, GW_YAML_SCALAR, "source", error) : GW_OK;
    if (!code && source && strlen(gw_yaml_text(source)) >= sizeof out->source)
        code =
            gw_yaml_fail(source, error, "key 'source': longer than %zu characters", sizeof out->source - 1);
    if (!code && source)
        snprintf(out->source, sizeof out->source, "%s", gw_yaml_text(source));
    if (!code && sensor)
        code = gw_yaml_integer(sensor, "sensor", 0, 999, &number, error);
    out->sensor = (int32_t)number;
    return code;
}

static gw_code read_marks(const gw_yaml *document, gw_marks *out, gw_error *error) {
    static const char *const names[] = {"version", "source", "sensor", "points"};
    const gw_yaml_node *root = gw_yaml_root(document);
    gw_code code = gw_yaml_expect(root, GW_YAML_MAP, "marks", error);
    if (!code)
        code = gw_yaml_check_keys(root, names, COUNT(names), error);
    if (!code)
        code = read_version(root, error);
    if (!code)
        code = read_source(root, out, error);
    const gw_yaml_node *list = code ? NULL : gw_yaml_find(root, "points");
    if (!code && !list)
        code = gw_yaml_fail(root, error, "key 'points' is missing here");
    if (!code)
        code = gw_yaml_expect(list, GW_YAML_LIST, "points", error);
    if (!code && gw_yaml_count(list) > GW_CALIBRATION_POINTS)
        code = gw_yaml_fail(list, error, "key 'points': %zu of them; at most %d can be used",
                            gw_yaml_count(list), GW_CALIBRATION_POINTS);
    for (size_t i = 0; !code && i < gw_yaml_count(list); i++)
        code = read_mark(gw_yaml_item(list, i), out, error);
    return code;
}

gw_code gw_marks_parse(const char *text, size_t size, const char *name, gw_marks *out, gw_error *error) {
    gw_yaml *document = NULL;
    memset(out, 0, sizeof *out);
    gw_code code = gw_yaml_parse(text, size, name, &document, error);
    if (!code)
        code = read_marks(document, out, error);
    gw_yaml_destroy(&document);
    return code;
}

gw_code gw_marks_load(const char *path, gw_marks *out, gw_error *error) {
    gw_yaml *document = NULL;
    memset(out, 0, sizeof *out);
    gw_code code = gw_yaml_load(path, &document, error);
    if (!code)
        code = read_marks(document, out, error);
    gw_yaml_destroy(&document);
    return code;
}

/* --- gazes
 * ---------------------------------------------------------------------------------------------------- */

gw_code gw_gazes_add(gw_gazes *gazes, uint32_t viewer, const gw_gaze_sample *sample, gw_error *error) {
    const size_t count = gazes->count[viewer];
    gw_code code = gw_grow((void **)&gazes->samples[viewer], &gazes->capacity[viewer], count + 1,
                           sizeof *sample, "gazes", error);
    if (!code)
        gazes->samples[viewer][gazes->count[viewer]++] = *sample;
    return code;
}

void gw_gazes_finish(gw_gazes *gazes) {
    for (int v = 0; v < GW_TRACK_VIEWERS; v++)
        free(gazes->samples[v]);
    memset(gazes, 0, sizeof *gazes);
}

static gw_code read_gaze(const gw_yaml_node *map, gw_gazes *out, gw_error *error) {
    static const char *const names[] = {"viewer", "target", "eye", "directions"};
    gw_gaze_sample sample = {{0}, {0}, {0}};
    const gw_yaml_node *number, *list;
    long viewer = 1;
    gw_code code = gw_yaml_expect(map, GW_YAML_MAP, "gazes", error);
    if (!code)
        code = gw_yaml_check_keys(map, names, COUNT(names), error);
    if (!code && (number = gw_yaml_find(map, "viewer")))
        code = gw_yaml_integer(number, "viewer", 1, GW_TRACK_VIEWERS, &viewer, error);
    if (!code)
        code = read_point(map, "target", 1e6, sample.target, error);
    if (!code)
        code = read_point(map, "eye", 1e6, sample.eye, error);
    if (code)
        return code;
    if (!(list = gw_yaml_find(map, "directions")))
        return gw_yaml_fail(map, error, "key 'directions' is missing here");
    code = gw_yaml_expect(list, GW_YAML_LIST, "directions", error);
    out->targets[viewer - 1]++;
    for (size_t i = 0; !code && i < gw_yaml_count(list); i++) {
        code = gw_yaml_numbers(gw_yaml_item(list, i), "directions", 3, sample.direction, error);
        if (!code)
            code = gw_gazes_add(out, (uint32_t)viewer - 1, &sample, error);
    }
    return code;
}

static gw_code read_gazes(const gw_yaml *document, gw_gazes *out, gw_error *error) {
    static const char *const names[] = {"version", "gazes"};
    const gw_yaml_node *root = gw_yaml_root(document);
    gw_code code = gw_yaml_expect(root, GW_YAML_MAP, "gazes", error);
    if (!code)
        code = gw_yaml_check_keys(root, names, COUNT(names), error);
    if (!code)
        code = read_version(root, error);
    const gw_yaml_node *list = code ? NULL : gw_yaml_find(root, "gazes");
    if (!code && !list)
        code = gw_yaml_fail(root, error, "key 'gazes' is missing here");
    if (!code)
        code = gw_yaml_expect(list, GW_YAML_LIST, "gazes", error);
    for (size_t i = 0; !code && i < gw_yaml_count(list); i++)
        code = read_gaze(gw_yaml_item(list, i), out, error);
    return code;
}

static gw_code take_gazes(gw_yaml *document, gw_gazes *out, gw_error *error) {
    gw_code code = read_gazes(document, out, error);
    if (code)
        gw_gazes_finish(out);
    return code;
}

gw_code gw_gazes_parse(const char *text, size_t size, const char *name, gw_gazes *out, gw_error *error) {
    gw_yaml *document = NULL;
    memset(out, 0, sizeof *out);
    gw_code code = gw_yaml_parse(text, size, name, &document, error);
    if (!code)
        code = take_gazes(document, out, error);
    gw_yaml_destroy(&document);
    return code;
}

gw_code gw_gazes_load(const char *path, gw_gazes *out, gw_error *error) {
    gw_yaml *document = NULL;
    memset(out, 0, sizeof *out);
    gw_code code = gw_yaml_load(path, &document, error);
    if (!code)
        code = take_gazes(document, out, error);
    gw_yaml_destroy(&document);
    return code;
}
