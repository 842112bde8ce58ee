/* What is in a recording, as text and as JSON. */
#include "wall/replay.h"

#include "tracking/track.h"
#include "wall/report.h"

#include <inttypes.h>
#include <stdio.h>

static const char *const kinds[] = {"pose", "gaze", "button", "analog", "link"};

/* What docs/tracks.md takes a sensor for, when nobody says otherwise. */
static void role_of(const gw_recording_channel *c, char *out, size_t size) {
    out[0] = '\0';
    if (c->kind == GW_EVENT_POSE && c->sensor < GW_TRACK_SENSORS)
        snprintf(out, size, " (%s of viewer %d)", c->sensor % 2 == GW_SENSOR_HEAD ? "head" : "gaze",
                 (int)c->sensor / 2);
}

static void print_clock(const gw_recording *recording, const gw_recording_channel *c) {
    if (!c->has_clock) {
        puts("             no clock of the device");
        return;
    }
    if (recording->counters.stamps == 0 && !recording->is_csv) {
        printf("             one clock, of the records; %" PRIu64 " duplicates, %" PRIu64 " reordered\n",
               c->duplicates, c->reordered);
        return;
    }
    printf("             clock of the device: %+.6f s", c->clock_offset);
    if (c->has_drift)
        printf(", drift %+.1f ppm, 95 %% arrive within %.3f ms", c->clock_drift * 1e6, c->clock_spread * 1e3);
    if (c->clock_steps > 0)
        printf(", %" PRIu64 " steps", c->clock_steps);
    printf("; %" PRIu64 " duplicates, %" PRIu64 " reordered\n", c->duplicates, c->reordered);
}

static void print_sensor(const gw_recording *recording, const gw_recording_channel *c) {
    char role[64];
    const int pose = c->kind == GW_EVENT_POSE;
    role_of(c, role, sizeof role);
    printf("%s %s %d%s: %" PRIu64 " %s from %.3f to %.3f s", recording->senders[c->sender],
           pose ? "sensor" : "gaze of viewer", (int)c->sensor, role, c->events, pose ? "poses" : "gazes",
           (double)c->first * 1e-9, (double)c->last * 1e-9);
    if (c->last > c->first)
        printf(
            ", %.1f Hz\n             intervals: median %.2f, 95 %% %.2f, longest %.1f ms at %.3f s; jitter "
            "%.2f ms; %" PRIu64 " gaps, %.3f s in all",
            c->rate, (double)c->interval_median * 1e-6, (double)c->interval_95 * 1e-6,
            (double)c->interval_longest * 1e-6, (double)c->longest_at * 1e-9, (double)c->jitter * 1e-6,
            c->gaps, (double)c->absent * 1e-9);
    puts("");
    if (pose && c->untracked < c->events)
        printf("             x %.3f to %.3f, y %.3f to %.3f, z %.3f to %.3f\n", c->low[0], c->high[0],
               c->low[1], c->high[1], c->low[2], c->high[2]);
    printf("             fastest %.2f %s at %.3f s; %" PRIu64 " jumps; %" PRIu64 " not tracked\n",
           c->speed_largest, pose ? "per s" : "degrees/s", (double)c->speed_largest_at * 1e-9, c->jumps,
           c->untracked);
    print_clock(recording, c);
}

static void print_channel(const gw_recording *recording, const gw_recording_channel *c) {
    const char *name = recording->senders[c->sender];
    if (c->kind == GW_EVENT_POSE || c->kind == GW_EVENT_GAZE)
        print_sensor(recording, c);
    else if (c->kind == GW_EVENT_BUTTON)
        printf("%s button %d: %" PRIu64 " changes, pressed %" PRIu64 " times\n", name, (int)c->sensor,
               c->events, c->presses);
    else if (c->kind == GW_EVENT_ANALOG)
        printf("%s axis %d: %" PRIu64 " values from %g to %g\n", name, (int)c->sensor, c->events,
               c->value_low, c->value_high);
    else
        printf("%s link: %" PRIu64 " changes\n", name, c->events);
}

static void print_counters(const gw_recording_counters *c) {
    const struct {
        const char *text;
        uint64_t count;
    } rows[] = {{"of other types", c->other_type},         {"of unknown types", c->unknown_type},
                {"of unknown senders", c->unknown_sender}, {"of wrong size or name", c->bad_payload},
                {"of bad sensors", c->bad_sensor},         {"not finite", c->not_finite}};
    printf("records      %" PRIu64 ": %" PRIu64 " of events, %" PRIu64 " stamps, %" PRIu64
           " descriptions, %" PRIu64 " texts, %" PRIu64 " skipped\n",
           c->records, c->used, c->stamps, c->descriptions, c->texts,
           c->records - c->used - c->stamps - c->texts - c->descriptions);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].count > 0)
            printf("             %" PRIu64 " %s\n", rows[i].count, rows[i].text);
    if (c->out_of_order > 0)
        printf("             %" PRIu64 " with an earlier time than the one before\n", c->out_of_order);
    if (c->clock_steps > 0)
        printf("             %" PRIu64 " steps of the recording's clock\n", c->clock_steps);
}

void gw_replay_print(const gw_recording *recording, const gw_recording_statistics *statistics,
                     const char *suspected) {
    char damage[512];
    gw_recording_damage_text(recording, damage, sizeof damage);
    printf("track        %s (%s%s)\nduration     %.3f s from Unix second %.3f\n", recording->name,
           recording->is_csv ? "CSV" : "VRPN log", recording->is_gzip ? ", gzip" : "",
           (double)recording->duration * 1e-9, (double)recording->start * 1e-9);
    for (uint32_t i = 0; i < recording->note_count; i++)
        printf("note         %s\n", recording->notes[i]);
    for (uint32_t i = 0; i < statistics->channel_count; i++)
        print_channel(recording, &statistics->channels[i]);
    if (statistics->left_out > 0)
        printf("             %" PRIu64 " events of further sensors\n", statistics->left_out);
    print_counters(&recording->counters);
    if (damage[0] != '\0')
        printf("damaged      %s\n", damage);
    if (suspected[0] != '\0')
        printf("unit         %s\n", suspected);
}

static json_t *count(uint64_t value) {
    return json_integer((json_int_t)value);
}

/* Text that may hold any bytes: what is not UTF-8 becomes null. */
static json_t *text_or_null(const char *text) {
    json_t *string = json_string(text);
    return string ? string : json_null();
}

static json_t *sensor_json(const gw_recording_channel *c) {
    const int pose = c->kind == GW_EVENT_POSE;
    return json_pack(
        "{s:o, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:o, s:f, s:f, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:f, "
        "s:f, "
        "s:o, s:o, s:o}",
        "untracked", count(c->untracked), "first_s", (double)c->first * 1e-9, "last_s",
        (double)c->last * 1e-9, "rate_hz", c->rate, "interval_median_ms", (double)c->interval_median * 1e-6,
        "interval_95_ms", (double)c->interval_95 * 1e-6, "interval_longest_ms",
        (double)c->interval_longest * 1e-6, "longest_at_s", (double)c->longest_at * 1e-9, "gaps",
        count(c->gaps), "absent_s", (double)c->absent * 1e-9, "jitter_ms", (double)c->jitter * 1e-6,
        "duplicates", count(c->duplicates), "reordered", count(c->reordered), "clock_steps",
        count(c->clock_steps), "clock_offset_s", c->has_clock ? json_real(c->clock_offset) : json_null(),
        "clock_drift_ppm", c->has_drift ? json_real(c->clock_drift * 1e6) : json_null(), "clock_spread_ms",
        c->has_drift ? json_real(c->clock_spread * 1e3) : json_null(), "jumps", count(c->jumps),
        "speed_largest", c->speed_largest, "speed_largest_at_s", (double)c->speed_largest_at * 1e-9,
        "speed_unit", json_string(pose ? "unit/s" : "degree/s"), "low",
        pose ? json_pack("[f,f,f]", c->low[0], c->low[1], c->low[2]) : json_null(), "high",
        pose ? json_pack("[f,f,f]", c->high[0], c->high[1], c->high[2]) : json_null());
}

static json_t *channel_json(const gw_recording *recording, const gw_recording_channel *c) {
    json_t *out;
    if (c->kind == GW_EVENT_POSE || c->kind == GW_EVENT_GAZE)
        out = sensor_json(c);
    else if (c->kind == GW_EVENT_BUTTON)
        out = json_pack("{s:o}", "presses", count(c->presses));
    else if (c->kind == GW_EVENT_ANALOG)
        out = json_pack("{s:f, s:f}", "low", c->value_low, "high", c->value_high);
    else
        out = json_object();
    json_object_set_new(out, "sender", text_or_null(recording->senders[c->sender]));
    json_object_set_new(out, "kind", json_string(kinds[c->kind]));
    json_object_set_new(out, "sensor", json_integer(c->sensor));
    json_object_set_new(out, "events", count(c->events));
    return out;
}

void gw_replay_report(json_t *report, const gw_recording *recording,
                      const gw_recording_statistics *statistics, const char *suspected) {
    json_t *sensors = json_array();
    for (uint32_t i = 0; i < statistics->channel_count; i++)
        json_array_append_new(sensors, channel_json(recording, &statistics->channels[i]));
    gw_report_recording(report, recording, NULL);
    json_t *tracking = json_object_get(report, "tracking");
    json_object_set_new(tracking, "sensors", sensors);
    json_object_set_new(tracking, "suspected_unit", suspected[0] ? text_or_null(suspected) : json_null());
}
