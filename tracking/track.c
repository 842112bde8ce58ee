#include "tracking/track.h"

#include "base/embedded.h"
#include "base/file.h"
#include "base/suggest.h"
#include "tracking/quaternion.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The wall in front of which the demo track was recorded, mm. */
static const double RECORDED_WIDTH = 2000.0, RECORDED_HEIGHT = 1125.0;

static int is_of_viewer(const gw_tracking_event *event) {
    if (event->quality < 0.0)
        return 0;
    return (event->kind == GW_EVENT_POSE && event->sensor < GW_TRACK_SENSORS) ||
           (event->kind == GW_EVENT_GAZE && event->sensor < GW_TRACK_VIEWERS);
}

static gw_code fail_empty(const gw_recording *recording, gw_error *error) {
    const gw_recording_counters *c = &recording->counters;
    char senders[256] = "none", damage[320];
    size_t used = 0;
    for (uint32_t i = 0; i < recording->sender_count && used < sizeof senders; i++)
        used += (size_t)snprintf(senders + used, sizeof senders - used, "%s%s", used > 0 ? ", " : "",
                                 recording->senders[i]);
    gw_recording_damage_text(recording, damage, sizeof damage);
    return gw_fail(error, GW_BAD_INPUT,
                   "%s: no usable pose of a head (sensor 0, 2, 4 or 6) or a gaze (sensor 1, 3, 5 or 7, or a "
                   "gaze record of viewer 0 to 3) in %" PRIu64 " records (%" PRIu64 " poses, %" PRIu64
                   " gazes, %" PRIu64 " not finite, %" PRIu64 " of unknown senders, %" PRIu64
                   " of other types; senders: %s)%s%s; record it again, or let a site file say whose sensors "
                   "these are",
                   recording->name, c->records, c->poses, c->gazes, c->not_finite, c->unknown_sender,
                   c->other_type + c->unknown_type, senders, damage[0] != '\0' ? "; " : "", damage);
}

gw_code gw_track_sender(const gw_recording *recording, uint32_t *out, gw_error *error) {
    for (size_t i = 0; i < recording->count; i++)
        if (is_of_viewer(&recording->events[i].event)) {
            *out = recording->events[i].sender;
            return GW_OK;
        }
    return fail_empty(recording, error);
}

/* Eye and wall point are scaled alike, so the line between them is: the point stays the corresponding one. */
static void fit(gw_tracking_event *event, const double scale[3]) {
    const double ahead[3] = {0.0, 0.0, -1.0};
    double direction[3], length = 0.0;
    for (int axis = 0; axis < 3; axis++)
        event->of.pose.position[axis] = event->of.pose.position[axis] * 1000.0 * scale[axis];
    if (event->sensor != GW_SENSOR_GAZE)
        return;
    gw_turn_vector(event->of.pose.orientation, ahead, direction);
    for (int axis = 0; axis < 3; axis++) {
        direction[axis] *= scale[axis];
        length += direction[axis] * direction[axis];
    }
    for (int axis = 0; axis < 3; axis++)
        direction[axis] /= sqrt(length);
    gw_turn_onto(direction, event->of.pose.orientation);
}

/* --- those that are in this program */

static const char FOLDER[] = "configs/tracks/", DEMO[] = "demo";
enum { SHIPPED = 16 };

static int is_track(const gw_embedded_file *file) {
    return strncmp(file->name, FOLDER, sizeof FOLDER - 1) == 0;
}

/* walking of configs/tracks/walking.vrpn.gz. */
static int has_name(const gw_embedded_file *file, const char *name) {
    const char *own = file->name + sizeof FOLDER - 1;
    return is_track(file) && strcspn(own, ".") == strlen(name) && strncmp(own, name, strlen(name)) == 0;
}

static const gw_embedded_file *find_shipped(const char *name) {
    for (size_t i = 0; i < gw_embedded_count; i++)
        if (has_name(&gw_embedded_files[i], name))
            return &gw_embedded_files[i];
    return NULL;
}

int gw_track_is_shipped(const char *name) {
    return find_shipped(name) != NULL && !gw_file_exists(name);
}

int gw_track_suggest(const char *name, char out[GW_TRACK_NAME]) {
    char names[SHIPPED][GW_TRACK_NAME];
    const char *known[SHIPPED];
    size_t count = 0;
    for (size_t i = 0; i < gw_embedded_count && count < SHIPPED; i++)
        if (is_track(&gw_embedded_files[i])) {
            const char *own = gw_embedded_files[i].name + sizeof FOLDER - 1;
            snprintf(names[count], GW_TRACK_NAME, "%.*s", (int)strcspn(own, "."), own);
            known[count] = names[count];
            count++;
        }
    const char *near = gw_suggest(name, known, count);
    if (near != NULL)
        snprintf(out, GW_TRACK_NAME, "%s", near);
    return near != NULL;
}

static gw_code parse_shipped(const gw_embedded_file *file, const char *name, gw_recording **out,
                             gw_error *error) {
    *out = NULL;
    if (file == NULL)
        return gw_fail(error, GW_MACHINE, "track %s: it is not in this program; build it again", name);
    return gw_recording_parse(file->data, file->size, name, out, error);
}

gw_code gw_track_load(const char *path, gw_recording **out, gw_error *error) {
    if (gw_track_is_shipped(path))
        return parse_shipped(find_shipped(path), path, out, error);
    char near[GW_TRACK_NAME];
    gw_code code = gw_recording_load(path, out, error);
    if (code != GW_OK && !gw_file_exists(path) && gw_track_suggest(path, near))
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: there is no such file; did you mean '%s', a track of this program?", path, near);
    return code;
}

gw_code gw_track_demo(double width, double height, gw_recording **out, gw_error *error) {
    *out = NULL;
    if (!(width > 0.0 && height > 0.0 && isfinite(width) && isfinite(height)))
        return gw_fail(error, GW_BAD_INPUT, "demo track: a wall of %g x %g mm has no area", width, height);
    gw_code code = parse_shipped(find_shipped(DEMO), DEMO, out, error);
    if (code != GW_OK)
        return code;
    double scale[3] = {width / RECORDED_WIDTH, height / RECORDED_HEIGHT, 0.0};
    scale[2] = sqrt(scale[0] * scale[1]);
    for (size_t i = 0; i < (*out)->count; i++)
        fit(&(*out)->events[i].event, scale);
    return GW_OK;
}
