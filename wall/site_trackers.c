/* The keys `tracker` and `trackers` of a site file: where head and gaze come from, and how that stands in the
 * room. */
#include "wall/site_internal.h"

#include "tracking/quaternion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char spec_characters[] = "-._:/@+,=%~[] ";

/* Where in the document things were said. */
typedef struct places {
    const gw_yaml_node *viewers[GW_TRACK_VIEWERS], *froms[GW_TRACK_VIEWERS];
} places;

/* metres, millimetres, ..., or how many millimetres the unit has. */
static gw_code read_unit(const gw_yaml_node *map, double *out, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "unit");
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_SCALAR, "unit", error);
    if (code)
        return code;
    const char *text = gw_yaml_text(node);
    const double known = gw_room_unit(text);
    char *end;
    strtod(text, &end);
    if (known == 0 && (end == text || *end))
        return gw_yaml_fail(
            node, error,
            "key 'unit': '%.40s' is unknown; expected m, mm, cm, inch, ft, or how many mm the "
            "source's unit has",
            text);
    if (known == 0)
        return gw_yaml_number(node, "unit", 0.001, 100000, out, error);
    *out = known;
    return GW_OK;
}

static gw_code read_axes(const gw_yaml_node *map, gw_axis_map *out, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "axes");
    gw_error inner = {0};
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_SCALAR, "axes", error);
    if (!code && gw_axis_map_parse(gw_yaml_text(node), out, &inner))
        code = gw_yaml_fail(node, error, "key 'axes': %s", inner.text);
    return code;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Where the device's axes, renamed by the axis map, point in wall space. */
static gw_code read_axis_vectors(const gw_yaml_node *node, const char *key, double out[4], gw_error *error) {
    double axes[3][3];
    for (size_t i = 0; i < 3; i++) {
        gw_code code = gw_yaml_numbers(gw_yaml_item(node, i), key, 3, axes[i], error);
        if (code)
            return code;
        const double length = sqrt(dot(axes[i], axes[i]));
        if (!(fabs(length - 1) <= 0.01))
            return gw_yaml_fail(gw_yaml_item(node, i), error,
                                "key '%s': axis %zu has the length %g; expected unit vectors", key, i + 1,
                                length);
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const double cosine = dot(axes[i], axes[j]);
        if (!(fabs(cosine) <= 0.01))
            return gw_yaml_fail(node, error,
                                "key '%s': axes %d and %d are at %.1f degrees instead of 90; measure again",
                                key, i + 1, j + 1, acos(fmax(-1, fmin(1, cosine))) * 57.29577951308232);
    }
    const double volume = axes[0][0] * (axes[1][1] * axes[2][2] - axes[1][2] * axes[2][1]) -
                          axes[0][1] * (axes[1][0] * axes[2][2] - axes[1][2] * axes[2][0]) +
                          axes[0][2] * (axes[1][0] * axes[2][1] - axes[1][1] * axes[2][0]);
    if (volume < 0)
        return gw_yaml_fail(
            node, error,
            "key '%s': the three axes are left-handed, which no turn is; give the hand of the "
            "device in 'axes', as 'x y -z'",
            key);
    gw_turn_of_axes(axes, out);
    return GW_OK;
}

/* A quaternion, or three axis vectors. One that is read from what was written keeps its bits. */
static gw_code read_turn(const gw_yaml_node *map, const char *key, double out[4], gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_LIST, key, error);
    if (code)
        return code;
    const size_t count = gw_yaml_count(node);
    const int vectors = count == 3 && gw_yaml_node_kind(gw_yaml_item(node, 0)) == GW_YAML_LIST;
    if (vectors)
        return read_axis_vectors(node, key, out, error);
    if (count != 4)
        return gw_yaml_fail(node, error,
                            "key '%s': %zu values; expected a quaternion [x, y, z, w], or three axis vectors "
                            "[[...], [...], [...]]%s",
                            key, count,
                            count == 3 ? " (not three angles: nobody agrees on their order)" : "");
    double q[4];
    code = gw_yaml_numbers(node, key, 4, q, error);
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!code && !(fabs(length - 1) <= 0.01))
        code =
            gw_yaml_fail(node, error, "key '%s': the quaternion has the length %g; expected 1", key, length);
    if (code)
        return code;
    if (fabs(length - 1) > 1e-12)
        gw_turn_normalise(q);
    memcpy(out, q, sizeof q);
    return GW_OK;
}

static gw_code bad_gaze(const gw_yaml_node *node, gw_error *error) {
    return gw_yaml_fail(
        node, error,
        "key 'gaze': '%.40s' is unknown; expected head, none, 'sensor N', 'events N' or 'sensor N "
        "or events M'",
        gw_yaml_text(node));
}

/* "sensor N", "events N", or both with an "or" between them. */
static gw_code read_gaze(const gw_yaml_node *map, gw_tracker_viewer *out, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, "gaze");
    out->gaze = GW_GAZE_KIND_HEAD;
    out->gaze_sensor = out->gaze_viewer = -1;
    if (!node)
        return GW_OK;
    gw_code code = gw_yaml_expect(node, GW_YAML_SCALAR, "gaze", error);
    if (code)
        return code;
    const char *text = gw_yaml_text(node);
    if (!strcmp(text, "none"))
        out->gaze = GW_GAZE_KIND_NONE;
    if (!strcmp(text, "none") || !strcmp(text, "head"))
        return GW_OK;
    int sensor = -1, events = -1, end = 0;
    if (sscanf(text, "sensor %9d or events %9d%n", &sensor, &events, &end) == 2 && !text[end]) {
        out->gaze = GW_GAZE_KIND_ANY;
    } else if (sscanf(text, "sensor %9d%n", &sensor, &end) == 1 && !text[end]) {
        out->gaze = GW_GAZE_KIND_SENSOR;
        events = -1;
    } else if (sscanf(text, "events %9d%n", &events, &end) == 1 && !text[end]) {
        out->gaze = GW_GAZE_KIND_EVENTS;
        sensor = -1;
    } else {
        return bad_gaze(node, error);
    }
    if ((out->gaze != GW_GAZE_KIND_EVENTS && sensor < 0) || (out->gaze != GW_GAZE_KIND_SENSOR && events < 0))
        return bad_gaze(node, error);
    if (sensor > GW_HIGHEST_SENSOR || events > GW_HIGHEST_SENSOR)
        return gw_yaml_fail(node, error, "key 'gaze': %d is too high; expected 0 to %d",
                            sensor > events ? sensor : events, GW_HIGHEST_SENSOR);
    out->gaze_sensor = sensor;
    out->gaze_viewer = events;
    return GW_OK;
}

static gw_code read_head(const gw_yaml_node *map, int32_t *out, gw_error *error) {
    const gw_yaml_node *node;
    long sensor = -1;
    gw_code code = gw_site_require(map, "head", &node, error);
    if (!code && !(gw_yaml_node_kind(node) == GW_YAML_SCALAR && !strcmp(gw_yaml_text(node), "none")))
        code = gw_yaml_integer(node, "head", 0, GW_HIGHEST_SENSOR, &sensor, error);
    *out = (int32_t)sensor;
    return code;
}

static gw_code read_viewer(gw_site_source *source, const gw_yaml_node *map, gw_tracker_viewer *out,
                           gw_error *error) {
    static const char *const names[] = {"head", "head_turn", "eye_offset", "gaze", "gaze_from", "gaze_error"};
    const gw_yaml_node *offset = gw_yaml_find(map, "eye_offset");
    gw_tracker_viewer_default(0, out);
    gw_code code = gw_site_map(map, "viewers", names, GW_COUNT(names), error);
    if (!code)
        code = read_head(map, &out->head_sensor, error);
    if (!code)
        code = read_turn(map, "head_turn", out->head_turn, error);
    if (!code && offset)
        code = gw_site_point(offset, "eye_offset", out->eye_offset, error);
    const double away = sqrt(dot(out->eye_offset, out->eye_offset));
    if (!code && away > 1000)
        code = gw_yaml_fail(
            offset, error,
            "key 'eye_offset': the eyes are %.0f mm from the head's sensor; expected at most 1000", away);
    if (!code && away > 350)
        gw_site_note(source, offset, "key 'eye_offset': the eyes are %.0f mm from the head's sensor", away);
    if (!code && away > 0 && away < 2)
        gw_site_note(source, offset, "key 'eye_offset': %g mm is next to nothing; is it in metres?", away);
    if (!code)
        code = read_gaze(map, out, error);
    if (!code)
        code = gw_site_number(map, "gaze_error", 0, 45, &out->gaze_error, error);
    if (!code && out->gaze == GW_GAZE_KIND_HEAD && out->head_sensor < 0)
        code = gw_yaml_fail(map, error, "a viewer without a head has no gaze from it; give 'head' or 'gaze'");
    return code;
}

static gw_code read_viewers(gw_site_source *source, places *at, const gw_yaml_node *list, uint32_t tracker,
                            gw_tracker_setup *out, gw_error *error) {
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "viewers", error);
    for (size_t i = 0; i < gw_yaml_count(list) && !code; i++) {
        const gw_yaml_node *map = gw_yaml_item(list, i);
        const uint32_t v = out->viewer_count;
        if (v == GW_TRACK_VIEWERS)
            return gw_yaml_fail(map, error, "key 'viewers': one more than the %d that a wall can have",
                                GW_TRACK_VIEWERS);
        code = read_viewer(source, map, &out->viewers[v], error);
        out->viewers[v].source = out->viewers[v].gaze_source = (int32_t)tracker;
        at->viewers[v] = map;
        at->froms[v] = gw_yaml_find(map, "gaze_from");
        out->viewer_count++;
    }
    return code;
}

static gw_code read_channel(const gw_yaml_node *map, const char *key, int32_t *out, gw_error *error) {
    const gw_yaml_node *node = gw_yaml_find(map, key);
    long number = -1;
    gw_code code = node ? gw_yaml_integer(node, key, 0, GW_HIGHEST_SENSOR, &number, error) : GW_OK;
    *out = (int32_t)number;
    return code;
}

static gw_code read_navigation(const gw_yaml_node *map, uint32_t tracker, gw_tracker_navigation *out,
                               gw_error *error) {
    static const char *const names[] = {"forward", "turn", "reset"};
    if (out->forward >= 0 || out->turn >= 0 || out->reset >= 0)
        return gw_yaml_fail(map, error, "key 'navigation': another tracker navigates already; keep one");
    gw_code code = gw_site_map(map, "navigation", names, GW_COUNT(names), error);
    out->source = (int32_t)tracker;
    if (!code)
        code = read_channel(map, "forward", &out->forward, error);
    if (!code)
        code = read_channel(map, "turn", &out->turn, error);
    return code ? code : read_channel(map, "reset", &out->reset, error);
}

/* A shift that is not zero, but smaller than anybody measures. */
static void note_shift(gw_site_source *source, const gw_yaml_node *node, const double shift[3]) {
    const double away = sqrt(dot(shift, shift));
    if (away > 0 && away < 20)
        gw_site_note(source, node, "key 'shift': %.3g mm from wall space's origin; is it in metres?", away);
    if (away > 50000)
        gw_site_note(source, node, "key 'shift': %.0f m from wall space's origin; expected mm", away / 1000);
}

static gw_code read_address(const gw_yaml_node *map, gw_tracker_source *out, gw_error *error) {
    const gw_yaml_node *node;
    gw_code code = gw_site_require(map, "source", &node, error);
    if (!code)
        code = gw_site_text(map, "source", spec_characters, sizeof out->spec, out->spec, error);
    return code ? code : gw_site_address(map, "bind", out->bind, error);
}

static gw_code read_tracker(gw_site_source *source, places *at, const gw_yaml_node *map,
                            gw_tracker_setup *out, gw_error *error) {
    static const char *const names[] = {"source", "bind",  "unit",    "axes",
                                        "turn",   "shift", "viewers", "navigation"};
    const uint32_t index = out->source_count;
    gw_tracker_source *tracker = &out->sources[index];
    gw_code code = gw_site_map(map, "trackers", names, GW_COUNT(names), error);
    if (!code)
        code = read_address(map, tracker, error);
    gw_room_default(gw_tracker_source_unit(tracker->spec), &tracker->room);
    if (!code)
        code = read_unit(map, &tracker->room.unit, error);
    if (!code)
        code = read_axes(map, &tracker->room.axes, error);
    if (!code)
        code = read_turn(map, "turn", tracker->room.turn, error);
    const gw_yaml_node *shift = gw_yaml_find(map, "shift"), *viewers = gw_yaml_find(map, "viewers"),
                       *navigation = gw_yaml_find(map, "navigation");
    if (!code && shift)
        code = gw_site_point(shift, "shift", tracker->room.shift, error);
    if (!code && shift)
        note_shift(source, shift, tracker->room.shift);
    if (!code && viewers)
        code = read_viewers(source, at, viewers, index, out, error);
    if (!code && navigation)
        code = read_navigation(navigation, index, &out->navigation, error);
    for (uint32_t other = 0; other < index && !code; other++)
        if (!strcmp(out->sources[other].spec, tracker->spec))
            code = gw_yaml_fail(map, error,
                                "key 'source': '%.80s' is tracker %u already; put all its viewers there",
                                tracker->spec, other + 1);
    out->source_count++;
    return code;
}

/* Gazes that another tracker of the list reports. */
static gw_code find_gaze_sources(const places *at, gw_tracker_setup *out, gw_error *error) {
    for (uint32_t v = 0; v < out->viewer_count; v++) {
        const gw_yaml_node *from = at->froms[v];
        if (!from)
            continue;
        gw_code code = gw_yaml_expect(from, GW_YAML_SCALAR, "gaze_from", error);
        if (code)
            return code;
        int32_t found = -1;
        for (uint32_t s = 0; s < out->source_count; s++)
            if (!strcmp(out->sources[s].spec, gw_yaml_text(from)))
                found = (int32_t)s;
        if (found < 0)
            return gw_yaml_fail(from, error,
                                "key 'gaze_from': no tracker of this site has the source '%.80s'",
                                gw_yaml_text(from));
        if (out->viewers[v].gaze == GW_GAZE_KIND_HEAD || out->viewers[v].gaze == GW_GAZE_KIND_NONE)
            return gw_yaml_fail(from, error,
                                "key 'gaze_from' goes with a 'gaze' of 'sensor N' or 'events N' there");
        out->viewers[v].gaze_source = found;
    }
    return GW_OK;
}

/* The sensor is taken by an earlier viewer, as head or gaze: whose, and what for. */
static const char *taken(const gw_tracker_setup *setup, uint32_t before, int32_t source, int32_t sensor,
                         uint32_t *whose) {
    for (*whose = 0; *whose < before; ++*whose) {
        const gw_tracker_viewer *viewer = &setup->viewers[*whose];
        if (viewer->source == source && viewer->head_sensor == sensor)
            return "head";
        if (viewer->gaze_source == source && viewer->gaze_sensor == sensor)
            return "gaze";
    }
    return NULL;
}

static gw_code check_sensors(const places *at, const gw_tracker_setup *setup, gw_error *error) {
    for (uint32_t v = 0; v < setup->viewer_count; v++) {
        const gw_tracker_viewer *viewer = &setup->viewers[v];
        const struct {
            const char *key;
            int32_t source, sensor;
        } uses[] = {{"head", viewer->source, viewer->head_sensor},
                    {"gaze", viewer->gaze_source, viewer->gaze_sensor}};
        uint32_t whose = 0;
        for (int i = 0; i < 2; i++) {
            const char *what =
                uses[i].sensor < 0 ? NULL : taken(setup, v, uses[i].source, uses[i].sensor, &whose);
            if (what)
                return gw_yaml_fail(at->viewers[v], error,
                                    "key '%s': sensor %d is the %s of the viewer of line %d already",
                                    uses[i].key, uses[i].sensor, what, gw_yaml_node_line(at->viewers[whose]));
        }
        if (viewer->head_sensor >= 0 && viewer->source == viewer->gaze_source &&
            viewer->head_sensor == viewer->gaze_sensor)
            return gw_yaml_fail(
                at->viewers[v], error,
                "key 'gaze': sensor %d is this viewer's head; 'gaze: head' takes the gaze from it",
                viewer->head_sensor);
        for (whose = 0; whose < v; whose++)
            if (viewer->gaze_viewer >= 0 && setup->viewers[whose].gaze_viewer == viewer->gaze_viewer &&
                setup->viewers[whose].gaze_source == viewer->gaze_source)
                return gw_yaml_fail(at->viewers[v], error,
                                    "key 'gaze': events %d are those of the viewer of line %d already",
                                    viewer->gaze_viewer, gw_yaml_node_line(at->viewers[whose]));
    }
    return GW_OK;
}

static gw_code read_list(gw_site_source *source, const gw_yaml_node *list, gw_tracker_setup *out,
                         gw_error *error) {
    places at = {{0}, {0}};
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "trackers", error);
    const size_t count = gw_yaml_count(list);
    if (!code && (count < 1 || count > GW_TRACKER_SOURCES))
        code = gw_yaml_fail(list, error, "key 'trackers': %zu of them; expected 1 to %d", count,
                            GW_TRACKER_SOURCES);
    for (size_t i = 0; i < count && !code; i++)
        code = read_tracker(source, &at, gw_yaml_item(list, i), out, error);
    if (!code && out->viewer_count == 0 && count > 1)
        code =
            gw_yaml_fail(list, error,
                         "key 'trackers': several, and none says which sensors are whose; give 'viewers', as "
                         "[{head: 0}]");
    if (!code)
        code = find_gaze_sources(&at, out, error);
    if (!code)
        code = check_sensors(&at, out, error);
    if (!code && out->viewer_count == 0) {
        gw_tracker_setup usual;
        gw_tracker_setup_default("", &usual);
        out->viewer_count = usual.viewer_count;
        memcpy(out->viewers, usual.viewers, sizeof out->viewers);
    }
    return code;
}

gw_code gw_site_read_trackers(gw_site_source *source, gw_site *out, gw_error *error) {
    const gw_yaml_node *one = gw_yaml_find(source->root, "tracker"),
                       *list = gw_yaml_find(source->root, "trackers");
    if (one && list)
        return gw_yaml_fail(one, error, "key 'tracker': there are 'trackers', too, in line %d; keep one",
                            gw_yaml_node_line(list));
    if (list)
        return read_list(source, list, &out->trackers, error);
    gw_code code =
        gw_site_text(source->root, "tracker", spec_characters, sizeof out->tracker, out->tracker, error);
    if (!code && one)
        gw_tracker_setup_default(out->tracker, &out->trackers);
    return code;
}
