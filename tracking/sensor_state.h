/* Whether a sensor still reports, and what becomes of an eye when it does not. VRPN and others have no word
 * for a sensor that is lost: it is silent, so silence is measured, against the sensor's own pace.
 *
 *   fresh      heard within two of its sample periods, or a quarter of the hold time
 *   held       silent for longer: the eye stands where it was
 *   lost       silent for longer than max(hold time, 3 sample periods): the eye glides to the neutral place
 *   returned   heard again: the eye glides back to the tracked place
 *
 * Every moment of change follows from the arrivals alone, never from when somebody asks. Values; one thread
 * at a time; the same bits on every machine. */
#ifndef GW_TRACKING_SENSOR_STATE_H
#define GW_TRACKING_SENSOR_STATE_H

#include <stdint.h>

typedef enum gw_sensor_phase {
    GW_SENSOR_ABSENT, /* never heard */
    GW_SENSOR_FRESH,
    GW_SENSOR_HELD,
    GW_SENSOR_LOST,
    GW_SENSOR_RETURNED, /* only of eyes: the glide back is not over */
    GW_SENSOR_PHASES
} gw_sensor_phase;

extern const char *const gw_sensor_phase_names[GW_SENSOR_PHASES];

enum { GW_SENSOR_PERIODS = 15 };

typedef struct gw_sensor_state {
    int heard;
    int64_t arrival, time; /* ns, our clock: of the newest sample, and when it was taken */
    int64_t returned;      /* time of the first sample since it was last silent */
    uint32_t since_return; /* samples after that one */
    int64_t period;        /* ns, median of the last ones; 0: not known yet */
    uint32_t known_periods, next_period;
    int64_t periods[GW_SENSOR_PERIODS]; /* a ring */
    uint32_t losses;                    /* how often it was lost and heard again */
} gw_sensor_state;

/* How long silence is held, ns. Of a sensor that was heard once: 1.5 s, as its period is not known. */
int64_t gw_sensor_hold(const gw_sensor_state *sensor, int64_t hold_time);
/* A sample; time must be later than that of the one before. 1: the sensor had been lost. */
int gw_sensor_take(gw_sensor_state *sensor, int64_t arrival, int64_t time, int64_t hold_time);
/* What its newest sample says does not go with those before: as if it had returned with it. */
void gw_sensor_restart(gw_sensor_state *sensor);
/* Never GW_SENSOR_RETURNED. Before the first arrival it is fresh. */
gw_sensor_phase gw_sensor_phase_at(const gw_sensor_state *sensor, int64_t now, int64_t hold_time);
/* When it was lost, or will be if it stays silent. */
int64_t gw_sensor_lost_at(const gw_sensor_state *sensor, int64_t hold_time);
/* 1 while it is not lost, then falling to 0 in `fade` ns. */
double gw_sensor_confidence(const gw_sensor_state *sensor, int64_t now, int64_t hold_time, int64_t fade);

/* A way that shrinks to nothing at an even speed and then is over: an eye that must not jump from one place
 * to another stands at the other plus what is left of it. */
typedef struct gw_glide {
    double from[3]; /* mm, at `since` */
    int64_t since;  /* ns */
} gw_glide;

/* What is left at a moment, at so many mm a second; 0: nothing. */
int gw_glide_at(const gw_glide *glide, int64_t now, double speed, double out[3]);

#endif
