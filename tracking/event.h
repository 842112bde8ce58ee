/* What tracking devices report, whatever their protocol: one event is one thing that one message said, as it
 * was said. Device code (tracking/source.h) makes events and nothing more; axes, units, filters, ages and
 * states are the business of those who take them (tracking/room.h, tracking/tracker.h). A value type; any
 * thread. */
#ifndef GW_TRACKING_EVENT_H
#define GW_TRACKING_EVENT_H

#include <stdint.h>

/* The protocol has no time stamp. */
#define GW_NO_TIME INT64_MIN

typedef enum gw_tracking_event_kind {
    GW_EVENT_POSE,   /* where a sensor is and how it is turned */
    GW_EVENT_GAZE,   /* where one viewer looks */
    GW_EVENT_BUTTON, /* pressed or let go */
    GW_EVENT_ANALOG, /* a joystick's axis or the like */
    GW_EVENT_LINK    /* the source was reached, or lost */
} gw_tracking_event_kind;

/* What the numbers of a gaze are measured in. */
typedef enum gw_gaze_frame {
    GW_GAZE_IN_DEVICE, /* the source's own frame, as its poses */
    GW_GAZE_IN_HEAD    /* the viewer's head: x right, y up, looking along -z; origin from the head sensor */
} gw_gaze_frame;

/* Positions are in the source's unit and frame, orientations unit quaternions x, y, z, w that turn the
 * source's axes onto the sensor's. Everything is finite. */
typedef struct gw_tracking_event {
    gw_tracking_event_kind kind;
    int32_t sensor;  /* of a pose: the device's number; of a gaze: the viewer; button or axis: its number */
    int64_t arrival; /* ns on this machine's monotonic clock (base/clock.h), or of the recording */
    int64_t device_time; /* ns since 1970 on the sender's clock, or GW_NO_TIME */
    int64_t latency;     /* ns that the device says passed before device_time, or 0 */
    /* 0 to 1, or below 0: the device says that this sensor is not tracked (the numbers mean nothing then).
     * Protocols without a quality say 1. Of a gaze: its confidence. */
    double quality;
    union {
        struct {
            double position[3], orientation[4];
        } pose;
        struct {
            gw_gaze_frame frame;
            int has_origin;
            double origin[3], direction[3]; /* direction is a unit vector */
            double openness;                /* of the eyes, 0 to 1; 1 where it is not known */
        } gaze;
        struct {
            int pressed;
        } button;
        struct {
            double value;
        } analog;
        struct {
            int up;
        } link;
    } of;
} gw_tracking_event;

typedef void (*gw_event_sink)(void *context, const gw_tracking_event *event);

#endif
