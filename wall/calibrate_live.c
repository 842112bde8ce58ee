#include "wall/calibrate_live.h"

#include "base/clock.h"
#include "tracking/gaze_model.h"
#include "tracking/reader.h"
#include "wall/fixations.h"

#include <poll.h>
#include <string.h>
#include <unistd.h>

enum { TRIES = 3, LEAST_SAMPLES = 5, BATCH = 64, WAIT_MS = 100 };
static const double WANDERING = 4; /* degrees: a gaze that rests keeps within far less */

typedef struct live {
    gw_reader *reader;
    const gw_live_options *options;
    void (*take)(struct live *live, const gw_reader_event *event); /* an event while sampling, or NULL */
    /* Of marks: */
    int32_t sensor;
    uint32_t count;
    double samples[GW_MARK_SAMPLES][3];
    uint64_t others; /* bit s: poses of sensor s came */
    /* Of gazes: */
    const gw_tracker_setup *setup;
    gw_head heads[GW_TRACK_VIEWERS];
    int has_head[GW_TRACK_VIEWERS];
    double target[3];
    gw_gazes *gazes;
    gw_code code;
    gw_error *error;
} live;

static void drain(live *l, int sampling) {
    static gw_reader_event events[BATCH];
    for (size_t count; (count = gw_reader_take(l->reader, events, BATCH)) > 0;)
        for (size_t i = 0; i < count; i++)
            if (sampling || l->setup) /* heads are followed all the time */
                l->take(l, &events[i]);
}

/* Until there is something to read in `file`, or to take from the reader, or it is `until` (ns). */
static int wait_for(const live *l, FILE *file, int64_t until) {
    struct pollfd polled[2] = {{gw_reader_descriptor(l->reader), POLLIN, 0}, {-1, POLLIN, 0}};
    int64_t left = (until - gw_now_ns()) / 1000000;
    if (file)
        polled[1].fd = fileno(file);
    poll(polled, 2, (int)(left < 0 ? 0 : left > WAIT_MS ? WAIT_MS : left));
    return file && polled[1].revents;
}

/* Enter is pressed. The file is not buffered, so that poll() and it agree. */
static gw_code wait_for_enter(live *l, gw_error *error) {
    fflush(l->options->talk);
    for (;;) {
        drain(l, 0);
        if (!wait_for(l, l->options->answers, INT64_MAX))
            continue;
        char letter = 0;
        const ssize_t got = read(fileno(l->options->answers), &letter, 1);
        if (got <= 0)
            return gw_fail(error, GW_BAD_INPUT,
                           "standard input ended; a person who presses Enter is needed at each mark");
        if (letter == '\n')
            return GW_OK;
    }
}

/* What comes in the next seconds; gazes go into `gazes`. What came before counts no more. */
static void sample(live *l, gw_gazes *gazes) {
    drain(l, 0);
    l->gazes = gazes;
    const int64_t until = gw_now_ns() + (int64_t)(l->options->seconds * 1e9);
    do {
        wait_for(l, NULL, until);
        drain(l, 1);
    } while (gw_now_ns() < until);
    l->gazes = NULL;
}

/* --- marks
 * ---------------------------------------------------------------------------------------------------- */

static void take_position(live *l, const gw_reader_event *event) {
    const gw_tracking_event *of = &event->event;
    if (of->kind != GW_EVENT_POSE || of->quality < 0)
        return;
    if (of->sensor != l->sensor)
        l->others |= of->sensor >= 0 && of->sensor < 64 ? UINT64_C(1) << of->sensor : 0;
    else if (l->count < GW_MARK_SAMPLES)
        memcpy(l->samples[l->count++], of->of.pose.position, sizeof l->samples[0]);
}

static void tell_silence(const live *l) {
    fprintf(l->options->talk, "  %u samples of sensor %d came in %g s; ", l->count, l->sensor,
            l->options->seconds);
    if (!l->others)
        fputs("no other sensor was heard of. Is the source reached, the sensor seen?\n", l->options->talk);
    else
        fputs("heard of:", l->options->talk);
    for (int s = 0; s < 64 && l->others; s++)
        if (l->others >> s & 1)
            fprintf(l->options->talk, " %d", s);
    fputs(l->others ? ". --sensor N takes another\n" : "", l->options->talk);
}

/* One mark, as often as it takes. unit: mm per unit of the device, as far as its protocol says. */
static gw_code take_mark(live *l, gw_marks *marks, uint32_t index, double unit, gw_error *error) {
    const gw_calibration_point *point = &marks->points[index];
    gw_mark *mark = &marks->samples[index];
    for (int attempt = 0; attempt < TRIES; attempt++) {
        fprintf(l->options->talk,
                "mark %u of %u, '%s' at [%g, %g, %g]: hold sensor %d there and press Enter\n", index + 1,
                marks->count, point->name, point->wall[0], point->wall[1], point->wall[2], l->sensor);
        gw_code code = wait_for_enter(l, error);
        if (code)
            return code;
        l->count = 0;
        sample(l, NULL);
        gw_mark_of(l->samples, l->count, mark);
        if (mark->count < LEAST_SAMPLES) {
            tell_silence(l);
            continue;
        }
        fprintf(l->options->talk, "  %u samples, spread %.2f mm\n", mark->count, mark->spread * unit);
        if (mark->spread * unit <= l->options->still || attempt + 1 == TRIES)
            break;
        fprintf(l->options->talk, "  it moved by up to %.0f mm; hold it still, once more\n",
                mark->farthest * unit);
    }
    if (mark->count < LEAST_SAMPLES)
        return gw_fail(
            error, GW_MACHINE,
            "sensor %d was not heard of at mark '%s'; `gazewall doctor SITE` tests the way to a tracker",
            l->sensor, point->name);
    memcpy(marks->points[index].device, mark->mean, sizeof mark->mean);
    marks->known[index] = 1;
    return GW_OK;
}

gw_code gw_marks_take_live(gw_marks *marks, const char *source, const char *bind,
                           const gw_live_options *options, gw_error *error) {
    static live l;
    const gw_reader_source sources[] = {{source, bind}};
    l = (live){.options = options, .take = take_position, .sensor = marks->sensor};
    gw_code code = gw_reader_open(sources, 1, options->log, &l.reader, error);
    for (uint32_t i = 0; i < marks->count && !code; i++)
        if (!marks->known[i])
            code = take_mark(&l, marks, i, gw_tracker_source_unit(source), error);
    gw_reader_close(&l.reader);
    return code;
}

/* --- gazes
 * ---------------------------------------------------------------------------------------------------- */

static void add_gaze(live *l, uint32_t viewer, const double eye[3], const double direction[3]) {
    gw_gaze_sample one;
    memcpy(one.target, l->target, sizeof one.target);
    memcpy(one.eye, eye, sizeof one.eye);
    memcpy(one.direction, direction, sizeof one.direction);
    if (!l->code && l->gazes)
        l->code = gw_gazes_add(l->gazes, viewer, &one, l->error);
}

/* A pose that is a viewer's head, its gaze, or both. */
static void take_pose(live *l, int32_t source, const gw_tracking_event *event) {
    for (uint32_t v = 0; v < l->setup->viewer_count; v++) {
        const gw_tracker_viewer *viewer = &l->setup->viewers[v];
        const double *position = event->of.pose.position, *orientation = event->of.pose.orientation;
        double direction[3], at[3], turned[4];
        if (viewer->source == source && viewer->head_sensor == event->sensor) {
            gw_head_of_pose(l->setup, v, position, orientation, &l->heads[v]);
            l->has_head[v] = 1;
            gw_gaze_along(l->heads[v].orientation, direction);
            if (viewer->gaze == GW_GAZE_KIND_HEAD)
                add_gaze(l, v, l->heads[v].eye, direction);
        }
        if (viewer->gaze_source == source && viewer->gaze_sensor == event->sensor) {
            gw_room_pose(&l->setup->sources[source].room, position, orientation, at, turned);
            gw_gaze_along(turned, direction);
            add_gaze(l, v, l->has_head[v] ? l->heads[v].eye : at, direction);
        }
    }
}

static void take_gaze(live *l, const gw_reader_event *event) {
    const gw_tracking_event *of = &event->event;
    if (of->kind == GW_EVENT_POSE && of->quality >= 0)
        take_pose(l, event->source, of);
    for (uint32_t v = 0; v < l->setup->viewer_count && gw_gaze_is_open(of); v++) {
        const gw_tracker_viewer *viewer = &l->setup->viewers[v];
        gw_gaze_line line;
        if (viewer->gaze_source == event->source && viewer->gaze_viewer == of->sensor &&
            gw_gaze_of_event(of, &l->setup->sources[event->source].room, l->has_head[v] ? &l->heads[v] : NULL,
                             &line))
            add_gaze(l, v, line.origin, line.direction);
    }
}

/* Target 0 to 8, row by row: at a tenth, the half and nine tenths of the wall's picture. */
static gw_code find_target(const gw_layout *layout, int index, double pixel[2], double out[3],
                           gw_error *error) {
    static const double places[] = {0.1, 0.5, 0.9};
    pixel[0] = places[index % 3] * layout->picture[0];
    pixel[1] = places[index / 3] * layout->picture[1];
    return gw_layout_point(layout, pixel, out, error);
}

/* Whether a viewer's gazes from `first` on rest, as far as they meet the wall; tells how surely. */
static int rests(const live *l, const gw_layout *layout, const gw_gazes *gazes, uint32_t viewer,
                 size_t first) {
    static gw_wall_rectangle walls[GW_MAXIMUM_TILES];
    gw_gaze_spot spots[GW_FIXATION_SPOTS];
    gw_fixation found;
    const uint32_t tiles = gw_layout_rectangles(layout, walls);
    size_t count = gazes->count[viewer] - first,
           from = count > GW_FIXATION_SPOTS ? count - GW_FIXATION_SPOTS : 0;
    if (count == 0)
        return 1;
    const gw_gaze_sample *samples = gazes->samples[viewer] + first + from;
    count -= from;
    for (size_t i = 0; i < count; i++)
        spots[i].is_open =
            gw_gaze_meets(walls, tiles, samples[i].eye, samples[i].direction, spots[i].point) >= 0;
    if (!gw_fixation_of(spots, (uint32_t)count, samples[count - 1].eye, &found)) {
        fprintf(l->options->talk, "  viewer %u looks beside the wall\n", viewer + 1);
        return 1;
    }
    fprintf(l->options->talk, "  viewer %u at [%.0f, %.0f, %.0f], 95 of 100 within %.2f x %.2f degrees\n",
            viewer + 1, found.point[0], found.point[1], found.point[2], found.half_angles[0],
            found.half_angles[1]);
    return found.half_angles[0] <= WANDERING;
}

/* One target, as often as it takes for all gazes to rest, at most TRIES times. */
static gw_code take_target(live *l, const gw_layout *layout, int index, gw_gazes *out, gw_error *error) {
    double pixel[2];
    size_t before[GW_TRACK_VIEWERS];
    int resting = 0, heard = 0;
    memcpy(before, out->count, sizeof before);
    gw_code code = find_target(layout, index, pixel, l->target, error);
    for (int attempt = 0; attempt < TRIES && !code && !(resting && heard); attempt++) {
        memcpy(out->count, before, sizeof before);
        fprintf(l->options->talk,
                "target %d of 9, pixel %.0f,%.0f at [%.0f, %.0f, %.0f]: look at it and press Enter\n",
                index + 1, pixel[0], pixel[1], l->target[0], l->target[1], l->target[2]);
        code = wait_for_enter(l, error);
        if (code)
            break;
        sample(l, out);
        code = l->code;
        resting = 1;
        heard = 0;
        for (uint32_t v = 0; v < GW_TRACK_VIEWERS && !code; v++) {
            resting &= rests(l, layout, out, v, before[v]);
            heard |= out->count[v] > before[v];
        }
        if (!heard)
            fputs("  no viewer's gaze is heard of\n", l->options->talk);
        else if (!resting)
            fputs("  that wanders; look at the target until the next one is asked for\n", l->options->talk);
    }
    if (!code && !heard)
        code = gw_fail(error, GW_MACHINE,
                       "no viewer's gaze was heard of; `gazewall doctor SITE` tests the way to trackers");
    for (int v = 0; v < GW_TRACK_VIEWERS; v++)
        out->targets[v] += out->count[v] > before[v];
    return code;
}

gw_code gw_gazes_take_live(const gw_site *site, const gw_live_options *options, gw_gazes *out,
                           gw_error *error) {
    static live l;
    gw_reader_source sources[GW_TRACKER_SOURCES];
    const gw_tracker_setup *setup = &site->trackers;
    memset(out, 0, sizeof *out);
    if (setup->source_count == 0)
        return gw_fail(error, GW_BAD_INPUT, "the site has no 'trackers' whose gazes could be checked");
    for (uint32_t s = 0; s < setup->source_count; s++)
        sources[s] = (gw_reader_source){setup->sources[s].spec, setup->sources[s].bind};
    l = (live){.options = options, .take = take_gaze, .setup = setup, .error = error};
    gw_code code = gw_reader_open(sources, (int)setup->source_count, options->log, &l.reader, error);
    for (int i = 0; i < 9 && !code; i++)
        code = take_target(&l, &site->layout, i, out, error);
    gw_reader_close(&l.reader);
    return code;
}
