/* A scripted path: a viewer that walks and looks along the keys of a YAML file, over and over
 * (docs/tracks.md). Sensor 0 is the head, which points where it looks, sensor 1 the gaze. Keys are in
 * millimetres of wall space; events are metres, as those of all sources without a unit of their own. */
#include "tracking/source_internal.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/yaml.h"
#include "tracking/quaternion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SECOND = 1e9, FARTHEST = 1e6, LONGEST = 86400;
enum { KEYS = 10000, CATCH_UP = 1000 };

typedef struct path_key {
    double time, position[3], look_at[3]; /* s, mm */
} path_key;

typedef struct path_source {
    gw_source base;
    size_t count;
    path_key *keys;
    double rate;               /* poses a second */
    int64_t start, unix_start; /* ns of pose 0; start 0: not yet */
    int64_t next;              /* number of the next pose */
} path_source;

static int64_t time_of(const path_source *p, int64_t number) {
    return (int64_t)llround((double)number * SECOND / p->rate);
}

static void at(const path_source *p, double time, double position[3], double look_at[3]) {
    const double length = p->keys[p->count - 1].time;
    const double moment = length > 0 ? fmod(time, length) : 0;
    size_t after = 0;
    while (after < p->count - 1 && p->keys[after].time <= moment)
        after++;
    const path_key *b = &p->keys[after], *a = after ? b - 1 : b;
    const double share = b->time > a->time ? fmin(1, fmax(0, (moment - a->time) / (b->time - a->time))) : 0;
    for (int i = 0; i < 3; i++) {
        position[i] = a->position[i] + share * (b->position[i] - a->position[i]);
        look_at[i] = a->look_at[i] + share * (b->look_at[i] - a->look_at[i]);
    }
}

static void emit(path_source *p, int64_t number) {
    double position[3], look_at[3], direction[3], length = 0;
    const int64_t passed = time_of(p, number);
    at(p, (double)passed / SECOND, position, look_at);
    for (int i = 0; i < 3; i++) {
        direction[i] = look_at[i] - position[i];
        length += direction[i] * direction[i];
    }
    length = sqrt(length);
    const int looks = length > 1; /* mm; nearer, nothing says where to */
    for (int i = 0; looks && i < 3; i++)
        direction[i] /= length;
    for (int sensor = 0; sensor < 2; sensor++) {
        gw_tracking_event event = {.kind = GW_EVENT_POSE,
                                   .sensor = sensor,
                                   .arrival = p->start + passed,
                                   .device_time = p->unix_start + passed,
                                   .quality = sensor == 0 || looks ? 1 : -1};
        event.of.pose.orientation[3] = 1;
        for (int i = 0; i < 3; i++)
            event.of.pose.position[i] = position[i] / 1000;
        if (looks)
            gw_turn_onto(direction, event.of.pose.orientation);
        gw_source_emit_pose(&p->base, &event);
    }
    p->base.counters.packets++;
}

static void poll_path(gw_source *source, int64_t now) {
    path_source *p = (path_source *)source;
    if (!p->start) {
        p->start = now;
        p->unix_start = gw_unix_ns();
        gw_source_emit_link(source, 1, now);
    }
    const int64_t due = (int64_t)floor((double)(now - p->start) * p->rate / SECOND);
    if (due - p->next > CATCH_UP) { /* nobody asked for long */
        for (int sensor = 0; sensor < 2; sensor++)
            source->counters.sensors[sensor].lost += (uint64_t)(due - CATCH_UP - p->next);
        p->next = due - CATCH_UP;
    }
    while (p->start + time_of(p, p->next) <= now)
        emit(p, p->next++);
}

static int64_t next(const gw_source *source) {
    const path_source *p = (const path_source *)source;
    return p->start ? p->start + time_of(p, p->next) : 0;
}

static void close_path(gw_source *source) {
    free(((path_source *)source)->keys);
    free(source);
}

/* --- the file */

static gw_code read_key(const gw_yaml_node *node, const path_key *before, path_key *out, gw_error *error) {
    static const char *const names[] = {"time", "position", "look_at"};
    gw_code code = gw_yaml_expect(node, GW_YAML_MAP, "keys", error);
    if (!code)
        code = gw_yaml_check_keys(node, names, 3, error);
    const gw_yaml_node *parts[3];
    for (int i = 0; i < 3 && !code; i++) {
        parts[i] = gw_yaml_find(node, names[i]);
        if (!parts[i])
            code = gw_yaml_fail(node, error, "a key of a path needs '%s'", names[i]);
    }
    if (!code)
        code = gw_yaml_number(parts[0], names[0], 0, LONGEST, &out->time, error);
    if (!code)
        code = gw_yaml_numbers(parts[1], names[1], 3, out->position, error);
    if (!code)
        code = gw_yaml_numbers(parts[2], names[2], 3, out->look_at, error);
    for (int i = 0; i < 3 && !code; i++)
        if (fabs(out->position[i]) > FARTHEST || fabs(out->look_at[i]) > FARTHEST)
            code = gw_yaml_fail(node, error, "positions are millimetres, -1e6 to 1e6");
    if (!code && before && !(out->time > before->time))
        code = gw_yaml_fail(node, error, "times must rise: %g s follows %g s", out->time, before->time);
    if (!code && !before && out->time != 0)
        code = gw_yaml_fail(node, error, "the first key's time must be 0, not %g s", out->time);
    return code;
}

static gw_code read_keys(path_source *p, const gw_yaml_node *list, gw_error *error) {
    const size_t count = gw_yaml_count(list);
    if (count == 0 || count > KEYS)
        return gw_yaml_fail(list, error, "a path has 1 to %d keys, not %zu", KEYS, count);
    gw_code code = gw_allocate((void **)&p->keys, count, sizeof *p->keys, "keys of a path", error);
    for (size_t i = 0; i < count && !code; i++)
        code = read_key(gw_yaml_item(list, i), i ? &p->keys[i - 1] : NULL, &p->keys[i], error);
    p->count = count;
    return code;
}

static gw_code read_path(path_source *p, const gw_yaml *file, gw_error *error) {
    static const char *const names[] = {"version", "rate", "keys"};
    const gw_yaml_node *root = gw_yaml_root(file);
    long version = 0;
    gw_code code = gw_yaml_expect(root, GW_YAML_MAP, "path", error);
    if (!code)
        code = gw_yaml_check_keys(root, names, 3, error);
    const gw_yaml_node *told = code ? NULL : gw_yaml_find(root, "version"),
                       *rate = code ? NULL : gw_yaml_find(root, "rate"),
                       *keys = code ? NULL : gw_yaml_find(root, "keys");
    if (!code && (!told || !keys))
        code = gw_yaml_fail(root, error, "a path needs 'version: 1' and 'keys'");
    if (!code)
        code = gw_yaml_integer(told, "version", 1, 1, &version, error);
    p->rate = 60;
    if (!code && rate)
        code = gw_yaml_number(rate, "rate", 1, 1000, &p->rate, error);
    if (!code)
        code = gw_yaml_expect(keys, GW_YAML_LIST, "keys", error);
    return code ? code : read_keys(p, keys, error);
}

gw_code gw_path_source_open(const gw_source *like, const char *path, gw_source **out, gw_error *error) {
    void *memory = NULL;
    gw_yaml *file = NULL;
    gw_code code = gw_yaml_load(path, &file, error);
    if (!code)
        code = gw_allocate(&memory, 1, sizeof(path_source), "scripted path", error);
    path_source *p = memory;
    if (!code) {
        p->base = *like;
        p->base.poll = poll_path;
        p->base.next = next;
        p->base.close = close_path;
        p->base.status.standing = GW_SOURCE_SILENT;
        code = read_path(p, file, error);
    }
    gw_yaml_destroy(&file);
    if (code && p)
        close_path(&p->base);
    else if (!code)
        *out = &p->base;
    return code;
}
