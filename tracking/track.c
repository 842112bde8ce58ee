#include "tracking/track.h"

#include "base/memory.h"
#include "tracking/quaternion.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double POSITION_LIMIT = 1e9;    /* mm; beyond it a value is no place in a room */
static const int64_t STEP_BACK = 1000000000; /* ns; further back, the clock was set */

typedef struct maker {
    const gw_recording *recording;
    double unit;
    int32_t sender; /* -1: the first that reports something usable */
    size_t capacity;
    int64_t newest[GW_TRACK_SENSORS]; /* device time of the sensor's newest report */
    double heads[GW_TRACK_VIEWERS][4];
    gw_track *track;
} maker;

/* The shortest turn from (0,0,-1) onto a unit direction. */
static void turn_onto(const double direction[3], double q[4]) {
    const double straight_back[4] = {0, 1, 0, 0}; /* every half turn will do */
    q[0] = direction[1];                          /* (0,0,-1) x direction */
    q[1] = -direction[0];
    q[2] = 0.0;
    q[3] = 1.0 - direction[2];
    if (direction[2] > 1.0 - 1e-12 || !gw_turn_normalise(q))
        memcpy(q, straight_back, sizeof straight_back);
}

/* A pose or a gaze as a report; 0 when it is neither, or of a sensor that no viewer has. */
static int report_of(const maker *m, const gw_tracking_event *event, gw_pose_report *out) {
    *out = (gw_pose_report){.time = event->arrival, .sensor = event->sensor};
    const double *at = event->of.pose.position;
    if (event->kind == GW_EVENT_GAZE) {
        if (event->sensor >= GW_TRACK_VIEWERS)
            return 0;
        double direction[3];
        memcpy(direction, event->of.gaze.direction, sizeof direction);
        if (event->of.gaze.frame == GW_GAZE_IN_HEAD)
            gw_turn_vector(m->heads[event->sensor], direction, direction);
        turn_onto(direction, out->orientation);
        at = event->of.gaze.origin;
        out->sensor = 2 * event->sensor + GW_SENSOR_GAZE;
    } else {
        memcpy(out->orientation, event->of.pose.orientation, sizeof out->orientation);
    }
    for (int i = 0; i < 3; i++)
        out->position[i] = at[i] * m->unit;
    return out->sensor < GW_TRACK_SENSORS;
}

static int is_late(maker *m, const gw_tracking_event *event, int32_t sensor) {
    if (event->device_time == GW_NO_TIME)
        return 0;
    const int64_t behind = m->newest[sensor] - event->device_time;
    if (m->newest[sensor] != GW_NO_TIME && behind > 0 && behind < STEP_BACK)
        return 1;
    m->newest[sensor] = event->device_time;
    return 0;
}

static gw_code take(maker *m, const gw_recorded_event *recorded, gw_error *error) {
    gw_track *track = m->track;
    gw_track_counters *counters = &track->counters;
    const gw_tracking_event *event = &recorded->event;
    gw_pose_report report;
    if (event->kind != GW_EVENT_POSE && event->kind != GW_EVENT_GAZE) {
        counters->other_kind++;
    } else if (m->sender >= 0 && (uint32_t)m->sender != recorded->sender) {
        counters->other_sender++;
    } else if (!report_of(m, event, &report)) {
        counters->other_sensor++;
    } else if (event->quality < 0.0) {
        counters->untracked++;
    } else if (!(fabs(report.position[0]) <= POSITION_LIMIT && fabs(report.position[1]) <= POSITION_LIMIT &&
                 fabs(report.position[2]) <= POSITION_LIMIT)) {
        counters->too_far++;
    } else if (is_late(m, event, report.sensor)) {
        counters->reordered++;
    } else {
        void *memory = track->reports;
        gw_code code =
            gw_grow(&memory, &m->capacity, track->report_count + 1, sizeof report, "pose reports", error);
        track->reports = memory;
        if (code != GW_OK)
            return code;
        if (report.sensor % 2 == GW_SENSOR_HEAD)
            memcpy(m->heads[report.sensor / 2], report.orientation, sizeof report.orientation);
        m->sender = (int32_t)recorded->sender;
        track->reports[track->report_count++] = report;
        counters->poses++;
    }
    return GW_OK;
}

/* Lists each sensor's reports. */
static gw_code arrange(gw_track *track, gw_error *error) {
    track->duration = track->reports[track->report_count - 1].time;
    for (size_t i = 0; i < track->report_count; i++)
        track->sensor_count[track->reports[i].sensor]++;
    for (int sensor = 0; sensor < GW_TRACK_SENSORS; sensor++) {
        void *memory = NULL;
        gw_code code =
            gw_allocate(&memory, track->sensor_count[sensor], sizeof(size_t), "a sensor's reports", error);
        if (code != GW_OK)
            return code;
        track->sensor_reports[sensor] = memory;
        size_t *next = memory;
        for (size_t i = 0; i < track->report_count; i++)
            if (track->reports[i].sensor == sensor)
                *next++ = i;
    }
    return GW_OK;
}

static gw_code fail_empty(const maker *m, const char *wanted, gw_error *error) {
    const gw_recording *recording = m->recording;
    const gw_track_counters *c = &m->track->counters;
    char senders[256] = "none";
    size_t used = 0;
    for (uint32_t i = 0; i < recording->sender_count && used < sizeof senders; i++)
        used += (size_t)snprintf(senders + used, sizeof senders - used, "%s%s", used > 0 ? ", " : "",
                                 recording->senders[i]);
    return gw_fail(error, GW_BAD_INPUT,
                   "%s: no usable pose of a head (sensor 0, 2, 4 or 6) or a gaze (sensor 1, 3, 5 or 7)%s%s "
                   "in %" PRIu64 " records (%" PRIu64 " of other sensors, %" PRIu64 " not tracked, %" PRIu64
                   " not finite, %" PRIu64 " of other senders, %" PRIu64
                   " of other kinds and types; senders: %s)%s%s; record it again or name another sender",
                   recording->name, wanted != NULL ? " of sender " : "", wanted != NULL ? wanted : "",
                   recording->counters.records, c->other_sensor, c->untracked,
                   recording->counters.not_finite + c->too_far,
                   c->other_sender + recording->counters.unknown_sender,
                   c->other_kind + recording->counters.other_type + recording->counters.unknown_type, senders,
                   m->track->damage[0] != '\0' ? "; " : "", m->track->damage);
}

static gw_code fill(maker *m, const gw_track_options *options, gw_error *error) {
    const gw_recording *recording = m->recording;
    gw_track *track = m->track;
    const char *wanted = options != NULL ? options->sender : NULL;
    const gw_log *log = options != NULL ? options->log : NULL;
    gw_code code = GW_OK;
    track->name = gw_copy_text(recording->name);
    if (track->name == NULL)
        return gw_fail(error, GW_MACHINE, "%s: out of memory for the track's name", recording->name);
    track->counters.file = recording->counters;
    gw_recording_damage_text(recording, track->damage, sizeof track->damage);
    m->sender = wanted != NULL ? gw_recording_sender(recording, wanted) : -1;
    for (int i = 0; i < GW_TRACK_SENSORS; i++)
        m->newest[i] = GW_NO_TIME;
    for (int i = 0; i < GW_TRACK_VIEWERS; i++)
        m->heads[i][3] = 1.0;
    for (size_t i = 0; i < recording->count && code == GW_OK && (wanted == NULL || m->sender >= 0); i++)
        code = take(m, &recording->events[i], error);
    if (code == GW_OK && track->report_count == 0)
        return fail_empty(m, wanted, error);
    if (code == GW_OK)
        code = arrange(track, error);
    if (code != GW_OK)
        return gw_context(error, "%s", recording->name);
    memcpy(track->sender, recording->senders[m->sender], sizeof track->sender);
    if (track->damage[0] != '\0')
        gw_log_write(log, GW_LOG_WARNING, "%s: %s; what is before it is used: %.3f s", track->name,
                     track->damage, (double)track->duration * 1e-9);
    gw_log_write(log, GW_LOG_INFO, "track %s: %" PRIu64 " poses of %s in %.3f s", track->name,
                 track->counters.poses, track->sender, (double)track->duration * 1e-9);
    return GW_OK;
}

gw_code gw_track_of(const gw_recording *recording, const gw_track_options *options, gw_track **out,
                    gw_error *error) {
    *out = NULL;
    maker m = {.recording = recording};
    m.unit = options != NULL && options->unit != 0.0 ? options->unit : 1000.0;
    if (!(m.unit > 0.0 && isfinite(m.unit)))
        return gw_fail(error, GW_BAD_INPUT, "%s: the unit must be more than 0 mm, not %g", recording->name,
                       m.unit);
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof *m.track, "track", error);
    if (code != GW_OK)
        return code;
    m.track = memory;
    code = fill(&m, options, error);
    if (code == GW_OK)
        *out = m.track;
    else
        gw_track_destroy(&m.track);
    return code;
}

gw_code gw_track_parse(const void *data, size_t size, const char *name, const gw_track_options *options,
                       gw_track **out, gw_error *error) {
    gw_recording *recording = NULL;
    *out = NULL;
    gw_code code = gw_recording_parse(data, size, name, &recording, error);
    if (code == GW_OK)
        code = gw_track_of(recording, options, out, error);
    gw_recording_destroy(&recording);
    return code;
}

gw_code gw_track_load(const char *path, const gw_track_options *options, gw_track **out, gw_error *error) {
    gw_recording *recording = NULL;
    *out = NULL;
    gw_code code = gw_recording_load(path, &recording, error);
    if (code == GW_OK)
        code = gw_track_of(recording, options, out, error);
    gw_recording_destroy(&recording);
    return code;
}

void gw_track_destroy(gw_track **track) {
    if (track == NULL || *track == NULL)
        return;
    for (int sensor = 0; sensor < GW_TRACK_SENSORS; sensor++)
        free((*track)->sensor_reports[sensor]);
    free((*track)->reports);
    free((*track)->name);
    free(*track);
    *track = NULL;
}
