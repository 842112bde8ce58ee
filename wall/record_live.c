#include "wall/record_live.h"

#include "base/clock.h"
#include "base/memory.h"
#include "tracking/recording_writer.h"
#include "tracking/setup.h"
#include "wall/interrupt.h"

#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BATCH = 256, WAIT_MS = 50, CHANNELS = 256, LINKS = 64, SHOWN = 6 };
static const int64_t SECOND = 1000000000;

/* One sensor (or viewer's gaze) of one source. */
typedef struct channel {
    int source;
    gw_tracking_event_kind kind;
    int32_t sensor;
    uint64_t events, shown, withheld; /* shown: how many there were when the progress was told last */
    int64_t first, last, longest;     /* ns; the longest interval */
} channel;

typedef struct recorder {
    const gw_record_wishes *wishes;
    gw_reader *reader;
    gw_recording_writer *writer;
    uint32_t senders[GW_READER_SOURCES];
    char names[GW_READER_SOURCES][GW_SENDER_NAME];
    double scale[GW_READER_SOURCES]; /* metres per unit of the source */
    int64_t begun, told;             /* ns */
    uint64_t written, withheld;
    uint32_t link_count; /* that came before the first of the others */
    gw_reader_event links[LINKS];
    uint32_t channel_count;
    channel channels[CHANNELS];
} recorder;

void gw_record_name(const char *spec, const char *const *others, int other_count, char *out, size_t size) {
    static const char *const prefixes[][2] = {
        {"dtrack:", "DTrack"}, {"gaze:", "Gaze"}, {"path:", "Path"}, {"mouse", "Mouse"}, {"null", "Null"}};
    char base[GW_SENDER_NAME - 8] = "";
    const char *from = spec, *at = strchr(spec, '@');
    int numbered = 0;
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes && !numbered; i++)
        if (strncmp(spec, prefixes[i][0], strlen(prefixes[i][0])) == 0) {
            snprintf(base, sizeof base, "%s", prefixes[i][1]);
            numbered = 1;
        }
    if (!numbered) {
        if (strncmp(from, "vrpn:", 5) == 0)
            from += 5;
        else if (strncmp(from, "vrpn+udp:", 9) == 0)
            from += 9;
        snprintf(base, sizeof base, "%.*s", at != NULL && at > from ? (int)(at - from) : (int)strlen(from),
                 from);
    }
    snprintf(out, size, numbered ? "%s0" : "%s", base);
    for (int number = 1, again = 1; again; number++) {
        again = 0;
        for (int i = 0; i < other_count; i++)
            again |= strcmp(others[i], out) == 0;
        if (again)
            snprintf(out, size, "%s%s%d", base, numbered ? "" : "-", number);
    }
}

static channel *channel_of(recorder *r, int source, const gw_tracking_event *event) {
    for (uint32_t i = 0; i < r->channel_count; i++) {
        channel *c = &r->channels[i];
        if (c->source == source && c->kind == event->kind && c->sensor == event->sensor)
            return c;
    }
    if (r->channel_count == CHANNELS)
        return NULL; /* recorded, only not told one by one */
    channel *c = &r->channels[r->channel_count++];
    *c = (channel){.source = source, .kind = event->kind, .sensor = event->sensor, .first = event->arrival};
    return c;
}

static int is_gaze(const gw_record_wishes *wishes, const gw_tracking_event *event) {
    return event->kind == GW_EVENT_GAZE || (event->kind == GW_EVENT_POSE && event->sensor >= 0 &&
                                            event->sensor < 64 && wishes->gaze_sensors >> event->sensor & 1);
}

/* Where somebody looked, and nobody may know: it is counted, and told once. */
static void withhold(recorder *r, int source, const gw_tracking_event *event, channel *c) {
    r->withheld++;
    if (c == NULL || c->withheld++ > 0)
        return;
    if (event->kind == GW_EVENT_POSE)
        gw_log_write(r->wishes->log, GW_LOG_WARNING,
                     "%s: sensor %ld counts as a gaze and is not recorded; --consent-gaze records it, "
                     "--gaze-sensors none says that it is no gaze",
                     r->names[source], (long)event->sensor);
    else
        gw_log_write(r->wishes->log, GW_LOG_WARNING,
                     "%s: gazes are not recorded without the consent of who is looking: --consent-gaze",
                     r->names[source]);
}

/* With the first event: what was recorded before into the same file is only given up for something. */
static gw_code begin_file(recorder *r, gw_error *error) {
    const gw_record_wishes *wishes = r->wishes;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    /* Arrivals are of the monotonic clock, which nobody sets. */
    const int64_t start = (int64_t)now.tv_sec * SECOND + now.tv_nsec - gw_now_ns();
    gw_code code = gw_recording_writer_open(wishes->track, GW_RECORDING_BY_NAME, start, wishes->overwrite,
                                            &r->writer, error);
    for (int i = 0; i < wishes->source_count && code == GW_OK; i++)
        code = gw_recording_writer_sender(r->writer, r->names[i], &r->senders[i], error);
    if (code == GW_OK)
        code = gw_recording_writer_note(r->writer, r->begun,
                                        wishes->consent_gaze
                                            ? "gazes: recorded, with the consent of who was looking"
                                            : "gazes: not recorded, without consent",
                                        error);
    if (code == GW_OK)
        code = gw_recording_writer_mark_end(r->writer, error);
    for (uint32_t i = 0; i < r->link_count && code == GW_OK; i++)
        code =
            gw_recording_writer_event(r->writer, r->senders[r->links[i].source], &r->links[i].event, error);
    return code;
}

static gw_code take(recorder *r, int source, const gw_tracking_event *came, gw_error *error) {
    gw_tracking_event event = *came;
    channel *c = channel_of(r, source, came);
    if (!r->wishes->consent_gaze && is_gaze(r->wishes, came)) {
        withhold(r, source, came, c);
        return GW_OK;
    }
    for (int i = 0; i < 3; i++) { /* VRPN's logs are in metres */
        if (event.kind == GW_EVENT_POSE)
            event.of.pose.position[i] *= r->scale[source];
        else if (event.kind == GW_EVENT_GAZE)
            event.of.gaze.origin[i] *= r->scale[source];
    }
    if (c != NULL) {
        const int64_t interval = c->events > 0 ? came->arrival - c->last : 0;
        c->longest = interval > c->longest ? interval : c->longest;
        c->last = came->arrival;
        c->events++;
    }
    if (event.kind == GW_EVENT_LINK) {
        gw_log_write(r->wishes->log, GW_LOG_INFO, "%s: %s", r->names[source],
                     event.of.link.up ? "reached" : "lost");
        if (r->writer == NULL && r->link_count < LINKS)
            r->links[r->link_count++] = (gw_reader_event){.source = source, .event = event};
        if (r->writer == NULL)
            return GW_OK;
    } else if (r->written++ == 0) {
        gw_code code = begin_file(r, error);
        if (code != GW_OK)
            return code;
    }
    return gw_recording_writer_event(r->writer, r->senders[source], &event, error);
}

/* Rates of the first sensors since the last time, and who is silent. */
static void tell_progress(recorder *r, int64_t now) {
    char text[512];
    const double passed = (double)(now - r->told) * 1e-9;
    int shown = 0;
    size_t used = (size_t)snprintf(text, sizeof text, "%.0f s, %" PRIu64 " events",
                                   (double)(now - r->begun) * 1e-9, r->written);
    for (uint32_t i = 0; i < r->channel_count && shown < SHOWN; i++) {
        channel *c = &r->channels[i];
        if ((c->kind != GW_EVENT_POSE && c->kind != GW_EVENT_GAZE) || c->events == 0)
            continue;
        const double silent = (double)(now - c->last) * 1e-9;
        used += (size_t)snprintf(text + used, sizeof text - used, "; %.20s %s%ld ", r->names[c->source],
                                 c->kind == GW_EVENT_GAZE ? "gaze " : "", (long)c->sensor);
        if (silent > 1.0)
            used += (size_t)snprintf(text + used, sizeof text - used, "SILENT for %.0f s", silent);
        else
            used += (size_t)snprintf(text + used, sizeof text - used, "%.0f/s",
                                     (double)(c->events - c->shown) / passed);
        shown++;
    }
    if (shown == 0)
        snprintf(text + used, sizeof text - used, "; waiting for the first");
    for (uint32_t i = 0; i < r->channel_count; i++)
        r->channels[i].shown = r->channels[i].events;
    r->told = now;
    gw_log_progress(r->wishes->log, text,
                    r->wishes->seconds > 0.0 ? (double)(now - r->begun) * 1e-9 / r->wishes->seconds : -1.0);
}

static gw_code take_batch(recorder *r, int wait_ms, gw_error *error) {
    gw_reader_event events[BATCH];
    struct pollfd wait = {.fd = gw_reader_descriptor(r->reader), .events = POLLIN};
    poll(&wait, 1, wait_ms);
    gw_code code = GW_OK;
    for (size_t got = BATCH; got == BATCH && code == GW_OK;) {
        got = gw_reader_take(r->reader, events, BATCH);
        for (size_t i = 0; i < got && code == GW_OK; i++)
            code = take(r, events[i].source, &events[i].event, error);
    }
    return code;
}

static gw_code record(recorder *r, int *interrupted, gw_error *error) {
    gw_code code = GW_OK;
    while (code == GW_OK && (*interrupted = gw_interrupt_pending()) == 0) {
        const int64_t now = gw_now_ns();
        if (r->wishes->seconds > 0.0 && now - r->begun >= (int64_t)(r->wishes->seconds * 1e9))
            break;
        code = take_batch(r, WAIT_MS, error);
        if (code == GW_OK && now - r->told >= SECOND) {
            tell_progress(r, now);
            code = r->writer != NULL ? gw_recording_writer_flush(r->writer, error) : GW_OK;
        }
    }
    return code == GW_OK ? take_batch(r, 0, error) : code;
}

static void print_source(recorder *r, int source) {
    gw_source_counters c;
    gw_reader_count(r->reader, source, &c, NULL);
    const gw_sensor_counters sum = gw_source_sum(&c);
    printf("%-12s %s: %" PRIu64 " events in %" PRIu64 " packets; %" PRIu64 " lost, %" PRIu64
           " jumps of their numbers, %" PRIu64 " duplicated, %" PRIu64 " reordered, %" PRIu64
           " malformed, %" PRIu64 " not finite, %" PRIu64 " unknown, %" PRIu64
           " too many at once; reached %" PRIu64 " times\n",
           r->names[source], r->wishes->sources[source], c.events, c.packets, sum.lost, sum.jumps,
           sum.duplicated, sum.reordered, c.malformed, c.not_finite, c.unknown,
           gw_reader_dropped(r->reader, source), c.connections);
}

static void print_summary(recorder *r) {
    static const char *const kinds[] = {"sensor", "gaze of viewer", "button", "axis", "link"};
    printf("%s: %" PRIu64 " events in %.1f s\n", r->wishes->track, r->written,
           (double)(gw_now_ns() - r->begun) * 1e-9);
    for (int i = 0; i < r->wishes->source_count; i++)
        print_source(r, i);
    for (uint32_t i = 0; i < r->channel_count; i++) {
        const channel *c = &r->channels[i];
        const double seconds = (double)(c->last - c->first) * 1e-9;
        if (c->kind == GW_EVENT_LINK)
            continue;
        printf("             %s %s %ld: %" PRIu64 " events", r->names[c->source], kinds[c->kind],
               (long)c->sensor, c->events);
        if (c->events > 1 && seconds > 0.0)
            printf(", %.1f/s, longest interval %.1f ms", (double)(c->events - 1) / seconds,
                   (double)c->longest * 1e-6);
        if (c->withheld > 0)
            printf(", %" PRIu64 " gazes withheld", c->withheld);
        puts("");
    }
    if (!r->wishes->consent_gaze)
        printf("             gazes withheld: %" PRIu64 " (no --consent-gaze)\n", r->withheld);
}

/* Nothing came: how each source stands. */
static gw_code fail_empty(recorder *r, gw_error *error) {
    static const char *const standings[] = {
        "reports",          "silent",          "not reached yet", "its name is not known",
        "refused",          "no answer",       "no route",        "does not greet",
        "another protocol", "another version", "no such device",  "closed the connection"};
    char text[1024] = "";
    size_t used = 0;
    for (int i = 0; i < r->wishes->source_count && used < sizeof text; i++) {
        gw_source_status status;
        gw_reader_count(r->reader, i, NULL, &status);
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s: %s%s%.200s", i > 0 ? "; " : "",
                                 r->wishes->sources[i], standings[status.standing],
                                 status.detail[0] != '\0' ? ", " : "", status.detail);
    }
    if (r->withheld > 0)
        return gw_fail(error, GW_BAD_INPUT,
                       "%s: there were only gazes, %" PRIu64 " of them, and they are not recorded without "
                       "--consent-gaze",
                       r->wishes->track, r->withheld);
    return gw_fail(error, GW_MACHINE, "%s: no event came (%s); gazewall doctor looks into it",
                   r->wishes->track, text);
}

gw_code gw_record_live(const gw_record_wishes *wishes, int *interrupted, gw_error *error) {
    gw_reader_source sources[GW_READER_SOURCES];
    void *memory = NULL;
    *interrupted = 0;
    for (int i = 0; i < wishes->source_count; i++)
        sources[i] = (gw_reader_source){.spec = wishes->sources[i], .bind = wishes->bind};
    gw_code code = gw_allocate(&memory, 1, sizeof(recorder), "recorder", error);
    if (code != GW_OK)
        return code;
    recorder *r = memory;
    r->wishes = wishes;
    const char *others[GW_READER_SOURCES];
    for (int i = 0; i < wishes->source_count; i++) {
        gw_record_name(wishes->sources[i], others, i, r->names[i], sizeof r->names[i]);
        others[i] = r->names[i];
        r->scale[i] = gw_tracker_source_unit(wishes->sources[i]) == 1000.0 ? 1.0 : 0.001;
    }
    gw_interrupt_hold();
    code = gw_recording_writer_check(wishes->track, wishes->overwrite, error);
    if (code == GW_OK)
        code = gw_reader_open(sources, wishes->source_count, wishes->log, &r->reader, error);
    r->begun = r->told = gw_now_ns();
    if (code == GW_OK)
        code = record(r, interrupted, error);
    gw_code closed = gw_recording_writer_close(&r->writer, code == GW_OK ? error : NULL);
    code = code != GW_OK ? code : closed;
    if (code == GW_OK && r->written == 0)
        code = fail_empty(r, error);
    else if (code == GW_OK && !wishes->quiet)
        print_summary(r);
    gw_reader_close(&r->reader);
    free(r);
    return code;
}
