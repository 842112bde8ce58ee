/* See ledger.h: points are kept as lines of JSON, one for each, written at once. A line that was cut when the
 * machine stopped is passed over, and its point measured again. */
#include "wall/ledger.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/version.h"
#include "wall/interrupt.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILE_LIMIT = 256 << 20, SHADER_LIMIT = 1 << 20 };

static const struct {
    const char *name;
    size_t offset;
} counters[] = {
#define COUNTER(field)                                                                                       \
    { #field, offsetof(gw_counters, field) }
    COUNTER(rays),           COUNTER(steps),      COUNTER(node_loads),    COUNTER(triangle_tests),
    COUNTER(voxels),         COUNTER(voxel_rays), COUNTER(shadow_rays),   COUNTER(mirror_rays),
    COUNTER(refracted_rays), COUNTER(nan_pixels), COUNTER(step_cap_hits), COUNTER(resumed),
#undef COUNTER
};
enum { COUNTERS = sizeof counters / sizeof *counters };

static const struct {
    const char *name;
    size_t offset;
} sizes[] = {{"octree_bytes", offsetof(gw_ledger_point, octree_bytes)},
             {"nodes", offsetof(gw_ledger_point, nodes)},
             {"pairs", offsetof(gw_ledger_point, pairs)}};
enum { SIZES = sizeof sizes / sizeof *sizes };

/* --- keys */

gw_code gw_ledger_hash_shaders(const char *folder, gw_hash *hash, gw_error *error) {
    *hash = (gw_hash){0};
    for (size_t i = 0; i < gw_embedded_count; i++) {
        const gw_embedded_file *file = &gw_embedded_files[i];
        if (strncmp(file->name, "shaders/", 8))
            continue;
        if (!folder) {
            *hash = gw_hash_bytes(*hash, file->data, file->size);
            continue;
        }
        gw_bytes bytes = {0};
        char *path = gw_path_join(folder, file->name + 8);
        gw_code code = path ? gw_file_read(path, SHADER_LIMIT, &bytes, error)
                            : gw_fail(error, GW_MACHINE, "memory is out while naming shaders");
        if (!code)
            *hash = gw_hash_bytes(*hash, bytes.data, bytes.size);
        gw_bytes_finish(&bytes);
        free(path);
        if (code)
            return code;
    }
    return GW_OK;
}

static gw_hash hash_frame(gw_hash hash, const gw_ledger_frame *frame) {
    for (size_t i = 0; i < gw_setting_count; i++) {
        char text[64] = {0};
        gw_setting_text(&frame->settings, &gw_setting_rows[i], text);
        hash = gw_hash_bytes(hash, gw_setting_rows[i].name, strlen(gw_setting_rows[i].name));
        hash = gw_hash_bytes(hash, text, sizeof text);
    }
    hash = gw_hash_bytes(hash, &frame->age, sizeof frame->age);
    hash = gw_hash_bytes(hash, &frame->exact, sizeof frame->exact);
    return gw_hash_bytes(hash, &frame->moment, sizeof frame->moment);
}

void gw_ledger_frame_key(const gw_ledger *ledger, const gw_ledger_frame *frame, char key[33]) {
    gw_hash_text(hash_frame(ledger->identity, frame), key);
}

void gw_ledger_key(const gw_ledger *ledger, const gw_ledger_question *question, char key[33]) {
    gw_hash hash = gw_hash_bytes(ledger->identity, &ledger->moments, sizeof ledger->moments);
    hash = hash_frame(hash_frame(hash, &question->frame), &question->exact);
    gw_hash_text(question->own ? hash_frame(hash, question->own) : hash, key);
}

/* --- points as JSON */

json_t *gw_ledger_pack(const gw_ledger_point *point) {
    json_t *object = json_object(), *errors = json_object(), *work = json_object(), *costs = json_object();
    for (size_t i = 0; i < GW_METRIC_COUNT; i++)
        if (isfinite(point->errors.values[i]))
            json_object_set_new(errors, gw_metric_table[i].name, json_real(point->errors.values[i]));
    for (size_t i = 0; i < COUNTERS; i++) {
        const uint64_t *value =
            (const uint64_t *)(const void *)((const char *)&point->counters + counters[i].offset);
        json_object_set_new(work, counters[i].name, json_integer((json_int_t)*value));
    }
    for (size_t i = 0; i < GW_LEDGER_COSTS; i++)
        json_object_set_new(costs, gw_ledger_cost_names[i], json_real(point->costs[i]));
    json_object_set_new(object, "key", json_string(point->key));
    json_object_set_new(object, "errors", errors);
    json_object_set_new(object, "counters", work);
    json_object_set_new(object, "costs", costs);
    if (isfinite(point->own))
        json_object_set_new(object, "own_flip", json_real(point->own));
    json_object_set_new(object, "spread_ms", json_real(point->spread_ms));
    json_object_set_new(object, "predicted_error", json_real(point->predicted));
    json_object_set_new(object, "predicted_worst", json_real(point->worst));
    for (size_t i = 0; i < SIZES; i++) {
        const uint64_t *value = (const uint64_t *)(const void *)((const char *)point + sizes[i].offset);
        json_object_set_new(object, sizes[i].name, json_integer((json_int_t)*value));
    }
    return object;
}

static uint64_t natural(const json_t *object, const char *name) {
    const json_int_t value = json_integer_value(json_object_get(object, name));
    return value > 0 ? (uint64_t)value : 0;
}

int gw_ledger_take(const json_t *object, gw_ledger_point *out) {
    const char *key = json_string_value(json_object_get(object, "key"));
    const json_t *errors = json_object_get(object, "errors"), *work = json_object_get(object, "counters"),
                 *costs = json_object_get(object, "costs");
    if (!key || strlen(key) != sizeof out->key - 1 || !json_is_object(errors) || !json_is_object(work) ||
        !json_is_object(costs))
        return 0;
    *out = (gw_ledger_point){0};
    memcpy(out->key, key, sizeof out->key);
    for (size_t i = 0; i < GW_METRIC_COUNT; i++) {
        const json_t *value = json_object_get(errors, gw_metric_table[i].name);
        out->errors.values[i] = json_is_number(value) ? json_number_value(value) : (double)NAN;
    }
    for (size_t i = 0; i < COUNTERS; i++) {
        uint64_t *value = (uint64_t *)(void *)((char *)&out->counters + counters[i].offset);
        *value = natural(work, counters[i].name);
    }
    for (size_t i = 0; i < GW_LEDGER_COSTS; i++)
        out->costs[i] = json_number_value(json_object_get(costs, gw_ledger_cost_names[i]));
    const json_t *own = json_object_get(object, "own_flip");
    out->own = json_is_number(own) ? json_number_value(own) : (double)NAN;
    out->spread_ms = json_number_value(json_object_get(object, "spread_ms"));
    out->predicted = json_number_value(json_object_get(object, "predicted_error"));
    out->worst = json_number_value(json_object_get(object, "predicted_worst"));
    for (size_t i = 0; i < SIZES; i++) {
        uint64_t *value = (uint64_t *)(void *)((char *)out + sizes[i].offset);
        *value = natural(object, sizes[i].name);
    }
    return 1;
}

/* --- the file */

static char *store_path(const gw_ledger *ledger) {
    return ledger->folder ? gw_path_join(ledger->folder, "points.jsonl") : NULL;
}

const gw_ledger_point *gw_ledger_find(const gw_ledger *ledger, const char *key) {
    for (size_t i = 0; i < ledger->known_count; i++)
        if (!strcmp(ledger->known[i].key, key))
            return &ledger->known[i];
    return NULL;
}

static gw_code remember(gw_ledger *ledger, const gw_ledger_point *point, gw_error *error) {
    gw_code code = gw_grow((void **)&ledger->known, &ledger->known_capacity, ledger->known_count + 1,
                           sizeof *point, "points", error);
    if (!code)
        ledger->known[ledger->known_count++] = *point;
    return code;
}

gw_code gw_ledger_load(gw_ledger *ledger, gw_error *error) {
    gw_bytes bytes = {0};
    char *path = store_path(ledger);
    if (!path || !gw_file_exists(path)) {
        free(path);
        return GW_OK;
    }
    gw_code code = gw_file_read(path, FILE_LIMIT, &bytes, error);
    const char *at = (const char *)bytes.data, *end = at ? at + bytes.size : at;
    ledger->torn = !code && bytes.size && end[-1] != '\n';
    while (!code && at < end) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        const size_t length = (size_t)((stop ? stop : end) - at);
        json_t *object = json_loadb(at, length, 0, NULL);
        gw_ledger_point point;
        if (object && gw_ledger_take(object, &point) && !gw_ledger_find(ledger, point.key))
            code = remember(ledger, &point, error);
        json_decref(object);
        at += length + 1;
    }
    gw_bytes_finish(&bytes);
    free(path);
    return code;
}

/* One write, so that what comes between two lines finds the file whole. */
static gw_code append(const char *path, const char *line, size_t size, gw_error *error) {
    const int file = open(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
    const ssize_t written = file < 0 ? -1 : write(file, line, size);
    const int failed = written == (ssize_t)size ? 0 : written < 0 ? errno : ENOSPC;
    if (file >= 0)
        close(file);
    return failed ? gw_fail(error, GW_NO_OUTPUT, "%s could not be written: %s", path, strerror(failed))
                  : GW_OK;
}

gw_code gw_ledger_keep(gw_ledger *ledger, const gw_ledger_point *point, gw_error *error) {
    gw_code code = remember(ledger, point, error);
    char *path = store_path(ledger);
    if (code || !path) {
        free(path);
        return code;
    }
    json_t *object = gw_ledger_pack(point);
    char *text = object ? json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(17)) : NULL, *line = NULL;
    const int size = text ? asprintf(&line, "%s%s\n", ledger->torn ? "\n" : "", text) : -1;
    gw_interrupt_hold();
    code = size < 0 ? gw_fail(error, GW_MACHINE, "memory is out while keeping a point")
                    : append(path, line, (size_t)size, error);
    gw_interrupt_release();
    ledger->torn = 0;
    if (size >= 0)
        free(line);
    free(text);
    json_decref(object);
    free(path);
    return code;
}
