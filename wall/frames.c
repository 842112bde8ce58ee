#include "wall/frames.h"

#include "base/file.h"
#include "base/memory.h"
#include "tracking/gaze_model.h"
#include "tracking/quaternion.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { STATES_VERSION = 1 };
static const size_t largest_recording = (size_t)1 << 30;

/* The knobs of a state by name: writer and reader share these tables. */
typedef struct float_field {
    const char *name;
    size_t offset;
    double minimum, maximum;
} float_field;

static const float_field float_fields[] = {
    {"tau", offsetof(gw_frame_state, tau), 0, 64},
    {"tau_inside", offsetof(gw_frame_state, tau_inside), 0, 64},
    {"gaze_margin", offsetof(gw_frame_state, gaze_margin), 0, 90},
    {"gaze_blend", offsetof(gw_frame_state, gaze_blend), 0, 90},
    {"gaze_growth", offsetof(gw_frame_state, gaze_growth), 0, 1000},
    {"gaze_latency", offsetof(gw_frame_state, gaze_latency), 0, 1000},
    {"gaze_growth_limit", offsetof(gw_frame_state, gaze_growth_limit), 0, 90},
    {"acuity_slope", offsetof(gw_frame_state, acuity_slope), 0, 1},
    {"voxel_slab", offsetof(gw_frame_state, voxel_slab), 0, 0.25},
    {"voxel_flatness", offsetof(gw_frame_state, voxel_flatness), 0, 1.2},
    {"fold_agreement", offsetof(gw_frame_state, fold_agreement), 0, 1},
    {"least_remainder", offsetof(gw_frame_state, least_remainder), 0, 0.25},
    {"separated_tau", offsetof(gw_frame_state, separated_tau), 0, 1},
    {"strain", offsetof(gw_frame_state, strain), 1, GW_MAXIMUM_STRAIN},
    {"gaze_footprint", offsetof(gw_frame_state, gaze_footprint), 0, 4},
    {"shadow_tau", offsetof(gw_frame_state, shadow_tau), 0, 16},
    {"seed_distance", offsetof(gw_frame_state, seed_distance), 1, 1000000},
    {"mirror_roughness", offsetof(gw_frame_state, mirror_roughness), 0, 0.25},
    {"least_throughput", offsetof(gw_frame_state, least_throughput), 0, 1},
    {"scene_scale", offsetof(gw_frame_state, scene_scale), 0, 1e12},
    {"edge_depth", offsetof(gw_frame_state, edge_depth), 0.01, 1},
    {"edge_normal", offsetof(gw_frame_state, edge_normal), 1, 180},
    {"occlusion_distance", offsetof(gw_frame_state, occlusion_distance), 0.001, 2},
    {"exposure", offsetof(gw_frame_state, exposure), -24, 24},
    {"emissive_faintest", offsetof(gw_frame_state, emissive_faintest), 0, 1e9},
    {"emissive_least", offsetof(gw_frame_state, emissive_least), 0, 1},
};

typedef struct byte_field {
    const char *name;
    size_t offset;
    int maximum;
} byte_field;

static const byte_field byte_fields[] = {
    {"geometry", offsetof(gw_frame_state, geometry), GW_GEOMETRY_VOXELS},
    {"level_blend", offsetof(gw_frame_state, level_blend), 1},
    {"leaf_blend", offsetof(gw_frame_state, leaf_blend), 1},
    {"texture_filter", offsetof(gw_frame_state, texture_filter), GW_FILTER_TRILINEAR},
    {"sample_block", offsetof(gw_frame_state, sample_block), 4},
    {"reconstruction", offsetof(gw_frame_state, reconstruction), GW_RECONSTRUCTION_EDGE_AWARE},
    {"gaze_rule", offsetof(gw_frame_state, gaze_rule), GW_GAZE_SEED},
    {"rate_blend", offsetof(gw_frame_state, rate_blend), 1},
    {"coarse_samples", offsetof(gw_frame_state, coarse_samples), 3},
    {"samples", offsetof(gw_frame_state, samples), 4},
    {"triangle_precision", offsetof(gw_frame_state, triangle_precision), GW_PRECISION_ORDERED},
    {"cones", offsetof(gw_frame_state, cones), GW_MAXIMUM_CONES},
    {"diffuse_bounce", offsetof(gw_frame_state, diffuse_bounce), GW_BOUNCE_ALL},
    {"tone", offsetof(gw_frame_state, tone), GW_TONE_FILMIC},
    {"dither", offsetof(gw_frame_state, dither), 1},
    {"metering", offsetof(gw_frame_state, metering), 1},
    {"debug", offsetof(gw_frame_state, debug), GW_DEBUG_VIEWS - 1},
    {"near_light", offsetof(gw_frame_state, near_light), UINT8_MAX},
    {"shadow_samples", offsetof(gw_frame_state, shadow_samples), 2},
    {"environment_lights", offsetof(gw_frame_state, environment_lights), 64},
    {"emissive_lights", offsetof(gw_frame_state, emissive_lights), 64},
    {"bounces", offsetof(gw_frame_state, bounces), 8},
    {"glossy_roughness", offsetof(gw_frame_state, glossy_roughness), UINT8_MAX},
};

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* --- making
 * ---------------------------------------------------------------------------------------------------- */

void gw_frame_begin(gw_frame_state *state, uint32_t frame, const gw_settings *settings, uint32_t seed,
                    gw_debug_view debug) {
    memset(state, 0, sizeof *state);
    state->frame = frame;
    state->seed = seed;
    gw_frame_state_apply(state, settings);
    state->debug = (uint8_t)debug;
}

/* A gaze from eye along direction (any length but 0); up is wall space's y, or -z for a gaze straight up or
 * down, made perpendicular to the direction. */
static void add_gaze(gw_frame_state *state, const double eye[3], const double direction[3],
                     const gw_settings *settings, double age, double confidence, double widening) {
    double length =
        sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    if (!(length > 0))
        return;
    gw_gaze *gaze = &state->gazes[state->gaze_count++];
    double unit[3], up[3] = {0, 1, 0};
    for (int i = 0; i < 3; i++)
        unit[i] = direction[i] / length;
    if (fabs(unit[1]) > 0.99) {
        up[1] = 0;
        up[2] = -1;
    }
    double along = up[0] * unit[0] + up[1] * unit[1] + up[2] * unit[2], norm = 0;
    for (int i = 0; i < 3; i++) {
        up[i] -= along * unit[i];
        norm += up[i] * up[i];
    }
    norm = sqrt(norm);
    for (int i = 0; i < 3; i++) {
        gaze->eye[i] = (float)eye[i];
        gaze->direction[i] = (float)unit[i];
        gaze->up[i] = (float)(up[i] / norm);
    }
    gaze->half_width = (float)fmin(settings->gaze_half_width + widening, 90);
    gaze->half_height = (float)fmin(settings->gaze_half_height + widening, 90);
    gaze->age = (float)age;
    gaze->confidence = (float)confidence;
}

void gw_frame_look(gw_frame_state *state, const gw_tracker_view *view, const gw_settings *settings) {
    _Static_assert((int)GW_TRACK_VIEWERS <= (int)GW_MAXIMUM_VIEWERS, "a gaze for each viewer");
    memcpy(state->eye, view->viewers[0].eye, sizeof state->eye);
    for (uint32_t i = 0; i < GW_TRACK_VIEWERS; i++) {
        const gw_viewer_view *viewer = &view->viewers[i];
        const double widening =
            viewer->gaze_widening + gw_gaze_widening(viewer->gaze_error, settings->gaze_margin);
        if (viewer->has_gaze && viewer->confidence > 0)
            add_gaze(state, viewer->gaze_origin, viewer->gaze_direction, settings,
                     (double)viewer->gaze_age * 1e-9, viewer->confidence, widening);
    }
}

void gw_frame_stare(gw_frame_state *state, const double eye[3], const double *target,
                    const gw_settings *settings) {
    memcpy(state->eye, eye, sizeof state->eye);
    if (!target)
        return;
    double direction[3] = {target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
    add_gaze(state, eye, direction, settings, 0, 1, 0);
}

void gw_frame_part_eyes(gw_frame_state *state, const gw_tracker_view *view, double distance) {
    double right[3] = {1, 0, 0};
    if (view)
        gw_turn_vector(view->viewers[0].head, right, right);
    for (int i = 0; i < 3; i++)
        state->eye_offset[i] = (float)(0.5 * distance * right[i]);
}

static int gaze_is_near(const gw_gaze *a, const gw_gaze *b, double distance, double angle) {
    double apart = 0, along = 0, across = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double move = (double)a->eye[i] - (double)b->eye[i];
        const double turn = (double)a->direction[j] * (double)b->direction[k] -
                            (double)a->direction[k] * (double)b->direction[j];
        apart += move * move;
        across += turn * turn;
        along += (double)a->direction[i] * (double)b->direction[i];
    }
    return sqrt(apart) <= distance && atan2(sqrt(across), along) <= angle * (3.14159265358979323846 / 180);
}

void gw_frame_hold(gw_frame_state *state, const gw_frame_state *before, double distance, double angle) {
    if (!before || before->gaze_count != state->gaze_count)
        return;
    int near = 1;
    for (int side = -1; side <= 1; side++) {
        double apart = 0;
        for (int i = 0; i < 3; i++) {
            const double move = state->eye[i] - before->eye[i] +
                                side * ((double)state->eye_offset[i] - (double)before->eye_offset[i]);
            apart += move * move;
        }
        near = near && sqrt(apart) <= distance;
    }
    for (uint32_t i = 0; i < state->gaze_count && near; i++)
        near = gaze_is_near(&state->gazes[i], &before->gazes[i], distance, angle);
    if (!near)
        return;
    memcpy(state->eye, before->eye, sizeof state->eye);
    memcpy(state->eye_offset, before->eye_offset, sizeof state->eye_offset);
    for (uint32_t i = 0; i < state->gaze_count; i++) {
        gw_gaze *gaze = &state->gazes[i];
        const float age = gaze->age, confidence = gaze->confidence;
        *gaze = before->gazes[i];
        gaze->age = age;
        gaze->confidence = confidence;
    }
}

void gw_frame_accumulate(gw_frame_state *state, const gw_frame_state *before, int scene_moves) {
    const uint16_t most = state->accumulate;
    if (most <= 1)
        return;
    state->accumulate = 1;
    state->epoch = before ? before->epoch : 1;
    if (!before)
        return;
    const gw_frame_state now = gw_frame_state_view(state, scene_moves),
                         then = gw_frame_state_view(before, scene_moves);
    if (memcmp(&now, &then, sizeof now) != 0)
        state->epoch++;
    else
        state->accumulate = before->accumulate < most ? (uint16_t)(before->accumulate + 1) : most;
}

/* --- writing
 * --------------------------------------------------------------------------------------------------- */

static json_t *pack_doubles(const double *values, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_real(values[i]));
    return list;
}

static json_t *pack_floats(const float *values, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_real((double)values[i]));
    return list;
}

static json_t *pack_gaze(const gw_gaze *gaze) {
    return json_pack("{s:o, s:o, s:o, s:f, s:f, s:f, s:f}", "eye", pack_floats(gaze->eye, 3), "direction",
                     pack_floats(gaze->direction, 3), "up", pack_floats(gaze->up, 3), "half_width",
                     (double)gaze->half_width, "half_height", (double)gaze->half_height, "age",
                     (double)gaze->age, "confidence", (double)gaze->confidence);
}

json_t *gw_state_pack(const gw_frame_state *state) {
    json_t *gazes = json_array();
    for (uint32_t i = 0; i < state->gaze_count; i++)
        json_array_append_new(gazes, pack_gaze(&state->gazes[i]));
    json_t *object = json_pack("{s:I, s:I, s:o, s:o, s:I, s:I, s:i, s:i}", "frame", (json_int_t)state->frame,
                               "time", (json_int_t)state->time, "eye", pack_doubles(state->eye, 3), "gazes",
                               gazes, "seed", (json_int_t)state->seed, "epoch", (json_int_t)state->epoch,
                               "accumulate", (int)state->accumulate, "light_least", (int)state->light_least);
    json_object_set_new(object, "stand", pack_floats(state->stand, 3));
    json_object_set_new(object, "look_at", pack_floats(state->look_at, 3));
    json_object_set_new(object, "eye_offset", pack_floats(state->eye_offset, 3));
    for (size_t i = 0; i < COUNT(float_fields); i++) {
        float value;
        memcpy(&value, (const char *)state + float_fields[i].offset, sizeof value);
        json_object_set_new(object, float_fields[i].name, json_real((double)value));
    }
    for (size_t i = 0; i < COUNT(byte_fields); i++)
        json_object_set_new(object, byte_fields[i].name,
                            json_integer(*((const uint8_t *)state + byte_fields[i].offset)));
    return object;
}

gw_code gw_states_save(const char *path, const gw_frame_state *states, size_t count, gw_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return gw_fail(error, GW_MACHINE, "memory is out while writing %zu frame states", count);
    fprintf(stream, "{\"gazewall_states\": %d}\n", STATES_VERSION);
    int failed = 0;
    for (size_t i = 0; i < count && !failed; i++) {
        json_t *object = gw_state_pack(&states[i]);
        failed = !object || json_dumpf(object, stream, JSON_COMPACT | JSON_REAL_PRECISION(17)) ||
                 fputc('\n', stream) == EOF;
        json_decref(object);
    }
    failed |= fclose(stream) != 0;
    gw_code code = failed
                       ? gw_fail(error, GW_MACHINE, "frame states could not be put into words: memory is out")
                       : gw_file_write(path, text, size, error);
    free(text);
    return code;
}

/* --- reading
 * --------------------------------------------------------------------------------------------------- */

/* Where in the recording we are, for messages. */
typedef struct place {
    const char *path;
    size_t line;
    gw_error *error;
} place;

static int take_number(const place *at, const json_t *object, const char *key, double minimum, double maximum,
                       double *out) {
    const json_t *value = json_object_get(object, key);
    *out = json_number_value(value);
    if (json_is_number(value) && *out >= minimum && *out <= maximum)
        return 1;
    gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: '%s' is missing or not a number from %g to %g", at->path,
            at->line, key, minimum, maximum);
    return 0;
}

static int take_float(const place *at, const json_t *object, const char *key, double maximum, float *out) {
    double value;
    int good = take_number(at, object, key, 0, maximum, &value);
    *out = (float)value;
    return good;
}

static int take_point(const place *at, const json_t *object, const char *key, double out[3]) {
    const json_t *list = json_object_get(object, key);
    int good = json_is_array(list) && json_array_size(list) == 3;
    for (size_t i = 0; i < 3 && good; i++) {
        const json_t *value = json_array_get(list, i);
        out[i] = json_number_value(value);
        good = json_is_number(value) && fabs(out[i]) <= 1e9;
    }
    if (!good)
        gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: '%s' is missing or not three numbers within 1e9", at->path,
                at->line, key);
    return good;
}

static int take_float_point(const place *at, const json_t *object, const char *key, float out[3]) {
    double point[3] = {0, 0, 0};
    int good = take_point(at, object, key, point);
    for (int i = 0; i < 3; i++)
        out[i] = (float)point[i];
    return good;
}

static int take_unit(const place *at, const json_t *object, const char *key, float out[3]) {
    if (!take_float_point(at, object, key, out))
        return 0;
    double square = (double)out[0] * out[0] + (double)out[1] * out[1] + (double)out[2] * out[2];
    if (fabs(square - 1) < 1e-3)
        return 1;
    gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: '%s' has length %g, not 1", at->path, at->line, key,
            sqrt(square));
    return 0;
}

static int take_gazes(const place *at, const json_t *object, gw_frame_state *state) {
    const json_t *list = json_object_get(object, "gazes");
    if (!json_is_array(list) || json_array_size(list) > GW_MAXIMUM_VIEWERS) {
        gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: 'gazes' is missing or not a list of at most %d", at->path,
                at->line, GW_MAXIMUM_VIEWERS);
        return 0;
    }
    state->gaze_count = (uint32_t)json_array_size(list);
    for (uint32_t i = 0; i < state->gaze_count; i++) {
        const json_t *item = json_array_get(list, i);
        gw_gaze *gaze = &state->gazes[i];
        if (!take_float_point(at, item, "eye", gaze->eye) ||
            !take_unit(at, item, "direction", gaze->direction) || !take_unit(at, item, "up", gaze->up) ||
            !take_float(at, item, "half_width", 90, &gaze->half_width) ||
            !take_float(at, item, "half_height", 90, &gaze->half_height) ||
            !take_float(at, item, "age", 1e9, &gaze->age) ||
            !take_float(at, item, "confidence", 1, &gaze->confidence))
            return 0;
    }
    return 1;
}

static int take_knobs(const place *at, const json_t *object, gw_frame_state *state) {
    for (size_t i = 0; i < COUNT(float_fields); i++) {
        double number;
        if (!take_number(at, object, float_fields[i].name, float_fields[i].minimum, float_fields[i].maximum,
                         &number))
            return 0;
        const float value = (float)number;
        memcpy((char *)state + float_fields[i].offset, &value, sizeof value);
    }
    for (size_t i = 0; i < COUNT(byte_fields); i++) {
        double value;
        if (!take_number(at, object, byte_fields[i].name, 0, byte_fields[i].maximum, &value))
            return 0;
        *((uint8_t *)state + byte_fields[i].offset) = (uint8_t)value;
    }
    return 1;
}

static int take_state(const place *at, const json_t *object, gw_frame_state *state) {
    double frame = 0, time = 0, seed = 0, epoch = 0, accumulate = 0, light_least = 0;
    memset(state, 0, sizeof *state);
    if (!take_number(at, object, "frame", 0, UINT32_MAX, &frame) ||
        !take_number(at, object, "time", 0, 9e18, &time) ||
        !take_number(at, object, "seed", 0, UINT32_MAX, &seed) ||
        !take_number(at, object, "epoch", 0, UINT32_MAX, &epoch) ||
        !take_number(at, object, "accumulate", 1, GW_MAXIMUM_ACCUMULATION, &accumulate) ||
        !take_point(at, object, "eye", state->eye) || !take_gazes(at, object, state) ||
        !take_knobs(at, object, state) || !take_float_point(at, object, "stand", state->stand) ||
        !take_float_point(at, object, "look_at", state->look_at))
        return 0;
    /* Recordings from before it lack it: lights end nowhere. */
    if (json_object_get(object, "light_least") &&
        !take_number(at, object, "light_least", 0, UINT16_MAX, &light_least))
        return 0;
    /* Recordings from before stereo lack it: one eye. */
    if (json_object_get(object, "eye_offset") &&
        !take_float_point(at, object, "eye_offset", state->eye_offset))
        return 0;
    state->frame = (uint32_t)frame;
    state->seed = (uint32_t)seed;
    state->epoch = (uint32_t)epoch;
    state->accumulate = (uint16_t)accumulate;
    state->light_least = (uint16_t)light_least;
    /* The time is an integer of more digits than a double holds. */
    state->time = (int64_t)json_integer_value(json_object_get(object, "time"));
    return 1;
}

gw_code gw_state_take(const json_t *object, const char *path, size_t line, gw_frame_state *out,
                      gw_error *error) {
    const place at = {.path = path, .line = line, .error = error};
    return take_state(&at, object, out) ? GW_OK : GW_BAD_INPUT;
}

static gw_code read_line(const place *at, const char *line, size_t length, gw_states *out, size_t *capacity) {
    json_error_t where;
    json_t *object = json_loadb(line, length, JSON_REJECT_DUPLICATES, &where);
    gw_code code = GW_OK;
    if (!json_is_object(object)) {
        code =
            gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: not a JSON object: %s", at->path, at->line, where.text);
    } else if (at->line == 1) {
        if (json_integer_value(json_object_get(object, "gazewall_states")) != STATES_VERSION)
            code = gw_fail(
                at->error, GW_BAD_INPUT,
                "%s:1: no recording of frame states: the first line must be {\"gazewall_states\": %d}",
                at->path, STATES_VERSION);
    } else if (out->count == GW_MAXIMUM_STATES) {
        code = gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: more than %d frame states", at->path, at->line,
                       GW_MAXIMUM_STATES);
    } else {
        code = gw_grow((void **)&out->states, capacity, out->count + 1, sizeof *out->states, "frame states",
                       at->error);
        if (!code && take_state(at, object, &out->states[out->count]))
            out->count++;
        else if (!code)
            code = GW_BAD_INPUT;
    }
    json_decref(object);
    return code;
}

gw_code gw_states_load(const char *path, gw_states *out, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_bytes bytes = {0};
    gw_code code = gw_file_read(path, largest_recording, &bytes, error);
    size_t capacity = 0;
    place at = {.path = path, .line = 0, .error = error};
    const char *cursor = (const char *)bytes.data, *end = cursor ? cursor + bytes.size : NULL;
    while (!code && cursor < end) {
        const char *stop = memchr(cursor, '\n', (size_t)(end - cursor));
        size_t length = stop ? (size_t)(stop - cursor) : (size_t)(end - cursor);
        at.line++;
        if (length > 0)
            code = read_line(&at, cursor, length, out, &capacity);
        cursor += length + 1;
    }
    if (!code && out->count == 0)
        code = gw_fail(error, GW_BAD_INPUT, "%s has no frame state in it", path);
    gw_bytes_finish(&bytes);
    if (code)
        gw_states_finish(out);
    return code;
}

void gw_states_finish(gw_states *states) {
    free(states->states);
    memset(states, 0, sizeof *states);
}
