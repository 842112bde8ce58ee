#include "wall/tracked.h"

#include "base/file.h"
#include "base/memory.h"
#include "tracking/player.h"
#include "tracking/source.h"
#include "tracking/track.h"
#include "wall/report.h"
#include "wall/tracked_live.h"

#include <stdlib.h>
#include <string.h>

struct gw_tracked {
    gw_tracker *tracker;
    gw_recording *recording; /* played; NULL: live */
    gw_player *player;       /* NULL: live */
    gw_tracked_live *live;   /* NULL: recorded */
    int64_t duration;
    gw_tracker_setup setup;
    int is_site; /* the setup is the site's */
    const gw_log *log;
    int suspected[GW_TRACKER_SOURCES]; /* a unit that cannot be was told */
    gw_tracker_view view;
    gw_fixations fixations;
};

/* 1 when the text names a source of live events and no file of that name is there. */
static int is_source(const char *track) {
    return !gw_file_exists(track) && gw_source_is(track);
}

/* --- opening */

static gw_code create_tracker(gw_tracked *tracked, const gw_tracked_options *options, gw_error *error) {
    gw_tracker_options how = {.settings = options->settings, .adopt_first = tracked->live == NULL};
    memcpy(how.neutral_eye, options->site->layout.eye, sizeof how.neutral_eye);
    return gw_tracker_create(&tracked->setup, &how, &tracked->tracker, error);
}

static int64_t delay_of(const gw_tracked_options *options) {
    return (int64_t)(options->settings->added_latency * 1e9);
}

static gw_code open_demo(gw_tracked *tracked, const gw_tracked_options *options, json_t *report,
                         gw_error *error) {
    const double *size = options->site->layout.size;
    const int8_t source = 0;
    gw_code code = gw_track_demo(size[0], size[1], &tracked->recording, error);
    if (code)
        return code;
    gw_report_recording(report, tracked->recording, tracked->recording->senders[0]);
    gw_player_track_setup(&tracked->setup);
    tracked->duration = tracked->recording->duration;
    return gw_player_open(tracked->recording, &source, delay_of(options), &tracked->player, error);
}

static gw_code open_recording(gw_tracked *tracked, const gw_tracked_options *options, const char *path,
                              json_t *report, gw_error *error) {
    int8_t sources[GW_RECORDING_SENDERS];
    char damage[320];
    gw_code code = gw_track_load(path, &tracked->recording, error);
    if (code)
        return code;
    tracked->duration = tracked->recording->duration;
    code = gw_player_setup(tracked->recording, &options->site->trackers, &tracked->setup, sources,
                           &tracked->is_site, error);
    if (!code)
        gw_report_recording(report, tracked->recording,
                            tracked->is_site ? NULL : tracked->setup.sources[0].spec);
    gw_recording_damage_text(tracked->recording, damage, sizeof damage);
    if (!code && damage[0])
        gw_log_write(options->log, GW_LOG_WARNING, "%s: %s; what is before it is used: %.3f s", path, damage,
                     (double)tracked->duration * 1e-9);
    return code ? code
                : gw_player_open(tracked->recording, sources, delay_of(options), &tracked->player, error);
}

static gw_code open_live(gw_tracked *tracked, const gw_tracked_options *options, json_t *report,
                         gw_error *error) {
    json_object_set_new(report, "tracking", json_pack("{s:s}", "state", "live"));
    return gw_tracked_live_open(&tracked->setup, delay_of(options), options->log, &tracked->live, error);
}

static gw_code open_source(gw_tracked *tracked, const gw_tracked_options *options, json_t *report,
                           gw_error *error) {
    const gw_tracker_setup *site = &options->site->trackers;
    gw_source *none = NULL;
    char near[GW_TRACK_NAME];
    if (options->track && gw_track_is_shipped(options->track))
        return strcmp(options->track, "demo")
                   ? open_recording(tracked, options, options->track, report, error)
                   : open_demo(tracked, options, report, error);
    if (options->track && !gw_file_exists(options->track) && !gw_source_is(options->track))
        /* Neither: the error names the forms that there are, and the nearest. */
        return gw_track_suggest(options->track, near) ? gw_fail(error, GW_BAD_INPUT,
                                                                "--track '%.80s' is neither a file nor a "
                                                                "tracking source; did you mean '%s', a track "
                                                                "of this program?",
                                                                options->track, near)
                                                      : gw_source_open(options->track, NULL, &none, error);
    if (options->track && !is_source(options->track))
        return open_recording(tracked, options, options->track, report, error);
    if (options->track) {
        gw_tracker_setup_default(options->track, &tracked->setup);
        if (strlen(options->track) >= sizeof tracked->setup.sources[0].spec)
            return gw_fail(error, GW_BAD_INPUT, "--track '%.40s...' is too long for a source",
                           options->track);
        return open_live(tracked, options, report, error);
    }
    if (site->source_count == 0)
        return open_demo(tracked, options, report, error);
    if (site->source_count == 1 && gw_file_exists(site->sources[0].spec))
        return open_recording(tracked, options, site->sources[0].spec, report, error);
    tracked->setup = *site;
    tracked->is_site = 1;
    return open_live(tracked, options, report, error);
}

gw_code gw_tracked_open(const gw_tracked_options *options, json_t *report, gw_tracked **out,
                        gw_error *error) {
    void *memory = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_tracked), "tracking", error);
    *out = memory;
    if (!code)
        (*out)->log = options->log;
    if (!code)
        code = open_source(*out, options, report, error);
    if (!code)
        code = create_tracker(*out, options, error);
    if (code)
        gw_tracked_close(out);
    return code;
}

void gw_tracked_close(gw_tracked **tracked) {
    if (!*tracked)
        return;
    gw_tracked_live_close(&(*tracked)->live);
    gw_player_close(&(*tracked)->player);
    gw_recording_destroy(&(*tracked)->recording);
    gw_tracker_destroy(&(*tracked)->tracker);
    free(*tracked);
    *tracked = NULL;
}

int64_t gw_tracked_duration(const gw_tracked *tracked) {
    return tracked->duration;
}

int gw_tracked_is_live(const gw_tracked *tracked) {
    return tracked->live != NULL;
}

void gw_tracked_take_site(gw_tracked *tracked, const gw_site *site) {
    if (!tracked || !tracked->is_site)
        return;
    gw_tracker_set_rooms(tracked->tracker, &site->trackers);
    memset(tracked->suspected, 0, sizeof tracked->suspected);
}

/* --- frames */

/* Heads that are where no head can be are told once for each source. */
static void tell_suspicions(gw_tracked *tracked) {
    char text[256];
    for (uint32_t s = 0; s < tracked->setup.source_count; s++)
        if (!tracked->suspected[s] && gw_tracker_suspect(tracked->tracker, (int)s, text, sizeof text)) {
            tracked->suspected[s] = 1;
            gw_log_write(tracked->log, GW_LOG_WARNING, "tracker %s: %s", tracked->setup.sources[s].spec,
                         text);
        }
}

const gw_tracker_view *gw_tracked_look(gw_tracked *tracked, int64_t time, int64_t lead,
                                       const gw_layout *layout) {
    int64_t now = time;
    gw_tracker_set_neutral(tracked->tracker, layout->eye);
    if (tracked->live)
        now = gw_tracked_live_feed(tracked->live, tracked->tracker);
    else
        gw_player_feed(tracked->player, tracked->tracker, time);
    gw_tracker_at(tracked->tracker, now, tracked->live ? now + lead : now, &tracked->view);
    gw_fixations_find(tracked->tracker, &tracked->view, now, layout, &tracked->fixations);
    tell_suspicions(tracked);
    return &tracked->view;
}

const gw_fixations *gw_tracked_fixations(const gw_tracked *tracked) {
    return &tracked->fixations;
}

void gw_tracked_wand(const gw_tracked *tracked, gw_wand *out) {
    gw_tracker_wand(tracked->tracker, out);
}

/* --- what there is to tell */

static json_t *count(uint64_t value) {
    return json_integer((json_int_t)value);
}

/* null where nobody knows. */
static json_t *fixation_of(const gw_viewer_fixation *f) {
    return f->known ? json_pack("{s:[f, f, f], s:[f, f], s:b, s:i}", "point_mm", f->point[0], f->point[1],
                                f->point[2], "half_angles_deg", f->half_angles[0], f->half_angles[1], "rests",
                                f->rests, "samples", (int)f->samples)
                    : json_null();
}

static json_t *viewers_of(const gw_tracked *tracked) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < tracked->setup.viewer_count && i < GW_TRACK_VIEWERS; i++) {
        const gw_viewer_view *viewer = &tracked->view.viewers[i];
        if (viewer->has_head || viewer->has_gaze || i == 0)
            json_array_append_new(list, json_pack("{s:i, s:s, s:s, s:f, s:f, s:o}", "viewer", (int)i, "head",
                                                  gw_sensor_phase_names[viewer->head_state], "gaze",
                                                  gw_sensor_phase_names[viewer->gaze_state], "quality",
                                                  viewer->quality, "confidence", viewer->confidence,
                                                  "fixation", fixation_of(&tracked->fixations.viewers[i])));
    }
    return list;
}

static json_t *suspicions_of(const gw_tracked *tracked) {
    json_t *list = json_array();
    char text[256];
    for (uint32_t s = 0; s < tracked->setup.source_count; s++)
        if (gw_tracker_suspect(tracked->tracker, (int)s, text, sizeof text))
            json_array_append_new(
                list, json_pack("{s:s, s:s}", "source", tracked->setup.sources[s].spec, "unit", text));
    return list;
}

void gw_tracked_report(gw_tracked *tracked, json_t *report) {
    json_t *tracking = json_object_get(report, "tracking");
    const gw_tracker_counters *c = gw_tracker_count(tracked->tracker);
    json_object_set_new(tracking, "viewers", viewers_of(tracked));
    json_object_set_new(tracking, "suspected", suspicions_of(tracked));
    json_object_set_new(tracking, "tracker",
                        json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "samples",
                                  count(c->samples), "untracked", count(c->untracked), "duplicated",
                                  count(c->duplicated), "reordered", count(c->reordered), "not_finite",
                                  count(c->not_finite), "headless", count(c->headless), "unassigned",
                                  count(c->unassigned), "clock_steps", count(c->clock_steps), "losses",
                                  count(c->losses), "saccades", count(c->saccades)));
    if (tracked->live)
        json_object_set_new(tracking, "sources", gw_tracked_live_json(tracked->live));
}
