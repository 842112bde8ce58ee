/* The tracker: what the events of all sources say about where eyes are and look when a frame is seen.
 *
 * Events go in as they arrive; at any moment it says, for each viewer, where the eye is, how the head is
 * turned and where the gaze goes, how old that is, what state the sensors are in and how much to trust them.
 * On the way samples that repeat, come late or are no numbers are left out and counted, device clocks are
 * brought to ours, places and gazes are filtered as the settings want, heads predicted to the presentation,
 * and eyes that are lost led away and back without a jump (docs/tracking.md).
 *
 * What it says is a function of the events, in their order, and of the two times only: a recording gives the
 * same views live, replayed, at any speed, whenever and however often it is asked. One thread at a time. */
#ifndef GW_TRACKING_TRACKER_H
#define GW_TRACKING_TRACKER_H

#include "base/settings.h"
#include "base/status.h"
#include "tracking/event.h"
#include "tracking/sensor_state.h"
#include "tracking/setup.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_tracker_options {
    const gw_settings *settings; /* those of stage TRACK are read when the tracker is made */
    double neutral_eye[3];       /* mm: of who is not tracked, and where lost eyes glide to */
    /* 1: a viewer's first sample is where it always was (recordings); 0: it comes from the neutral eye. */
    int adopt_first;
} gw_tracker_options;

/* What became of the events; nothing is left out in silence. samples + untracked + ... = those given. */
typedef struct gw_tracker_counters {
    uint64_t samples;     /* used: of heads and gazes; a sample for two viewers counts twice */
    uint64_t untracked;   /* the device said that it does not see the sensor, or that the eye is closed */
    uint64_t duplicated;  /* told once before */
    uint64_t reordered;   /* taken before one that came earlier */
    uint64_t not_finite;  /* no numbers, no length, or beyond any room */
    uint64_t headless;    /* gazes relative to a head that was never seen */
    uint64_t unassigned;  /* nobody's by the setup, or nothing for us */
    uint64_t clock_steps; /* device clocks found to be set anew */
    uint64_t losses;      /* sensors that were lost and came back */
    uint64_t saccades;
} gw_tracker_counters;

typedef struct gw_viewer_view {
    int has_head, has_gaze; /* tracked at some time; else the neutral eye, and no gaze */
    gw_sensor_phase head_state, gaze_state;
    double eye[3];  /* mm: filtered, predicted, held or gliding */
    double head[4]; /* unit quaternion x, y, z, w: head axes (x right, y up, looking along -z) to wall */
    double gaze_origin[3];    /* mm */
    double gaze_direction[3]; /* unit */
    double gaze_widening;     /* deg: for a saccade that goes on */
    double gaze_error;        /* deg: of this kind of gaze, as the setup says */
    double quality;           /* 0 to 1, as the device said it of the newest head sample */
    double confidence;        /* 0 to 1, of the gaze: falls when head or gaze is lost */
    int in_saccade;
    int64_t head_age, gaze_age;         /* ns from when the newest sample was taken to the presentation */
    int64_t head_arrival, gaze_arrival; /* ns from when it was taken to when it arrived */
    int64_t head_wait, gaze_wait;       /* ns from its arrival to now */
    int64_t head_delay, gaze_delay;     /* ns, group delay of the filter */
    int64_t predicted;                  /* ns by which the head was predicted */
} gw_viewer_view;

typedef struct gw_tracker_view {
    gw_viewer_view viewers[GW_TRACK_VIEWERS];
} gw_tracker_view;

/* What the device that navigates asks for (gw_tracker_setup.navigation). */
typedef struct gw_wand {
    double forward, turn; /* -1 to 1: ahead, to the right; 0 near the middle, and when the device is lost */
    uint64_t resets;      /* how often the button was pressed */
} gw_wand;

typedef struct gw_tracker gw_tracker;

gw_code gw_tracker_create(const gw_tracker_setup *setup, const gw_tracker_options *options, gw_tracker **out,
                          gw_error *error);
void gw_tracker_destroy(gw_tracker **tracker);
/* Forgets all events. */
void gw_tracker_reset(gw_tracker *tracker);
/* From here on lost eyes glide to another place. */
void gw_tracker_set_neutral(gw_tracker *tracker, const double eye[3]);

/* An event of source number `source` of the setup. Events of one source come in the order of their arrival.
 */
void gw_tracker_take(gw_tracker *tracker, int source, const gw_tracking_event *event);
/* All viewers, from the events taken so far, for a frame that is made at `now` and seen at `presentation`
 * (ns, the clock of the arrivals). */
void gw_tracker_at(const gw_tracker *tracker, int64_t now, int64_t presentation, gw_tracker_view *out);

/* The newest gaze samples of a viewer, of the last 0.3 s at most and since the last saccade, as they came,
 * each from where the eye was then; the oldest first. Of who has only a head, where that points. How many. */
enum { GW_RECENT_GAZES = 64 };
typedef struct gw_gaze_ray {
    double from[3], direction[3]; /* mm; unit */
} gw_gaze_ray;
uint32_t gw_tracker_recent_gazes(const gw_tracker *tracker, uint32_t viewer, int64_t now,
                                 gw_gaze_ray out[GW_RECENT_GAZES]);

void gw_tracker_wand(const gw_tracker *tracker, gw_wand *out);

/* Takes over where sources stand in the room (unit, axes, turn, shift) and how sensors sit on heads and how
 * sure gazes are; which sources and sensors there are stays. */
void gw_tracker_set_rooms(gw_tracker *tracker, const gw_tracker_setup *setup);
/* Whether heads of a source are where heads can be: 1 and a sentence if not (gw_room_suspect). */
int gw_tracker_suspect(const gw_tracker *tracker, int source, char *text, size_t size);

const gw_tracker_counters *gw_tracker_count(const gw_tracker *tracker);

#endif
