/* DTrack's datagrams (ART DTrack2 and DTrack3, ASCII output): read into what trackers need of them, and
 * written. One datagram is one frame; lines end in CR LF; a line is an identifier, counts and bracketed
 * blocks. Unknown lines and further numbers in a block are passed over, as the manual asks. Orientations come
 * from the matrix, never from the angles, whose order the manual's own examples do not agree on. Numbers are
 * read and written with a dot whatever the locale is. Positions are millimetres, as sent. Pure functions; any
 * thread. */
#ifndef GW_TRACKING_DTRACK_MESSAGE_H
#define GW_TRACKING_DTRACK_MESSAGE_H

#include <stddef.h>
#include <stdint.h>

enum {
    GW_DTRACK_PORT = 5000,
    GW_DTRACK_BODIES = 64,
    GW_DTRACK_FLYSTICKS = 8,
    GW_DTRACK_BUTTONS = 32, /* of a Flystick; further ones are passed over */
    GW_DTRACK_AXES = 8,
    GW_DTRACK_DATAGRAM = 32768 /* bytes of the longest that is read */
};

typedef struct gw_dtrack_pose {
    int listed;            /* there was a block for it */
    int tracked;           /* and quality and matrix say that it is seen; else the rest means nothing */
    double position[3];    /* mm */
    double orientation[4]; /* unit quaternion x, y, z, w: room axes onto the body's */
} gw_dtrack_pose;

typedef struct gw_dtrack_flystick {
    gw_dtrack_pose pose;
    int button_count, axis_count;
    uint32_t buttons; /* a bit each; valid also where it is not tracked */
    double axes[GW_DTRACK_AXES];
} gw_dtrack_flystick;

typedef struct gw_dtrack_frame {
    int has_frame, has_day_time, has_unix_time;
    uint32_t frame;     /* counts at the synchronisation frequency */
    int64_t day_time;   /* ns since 00:00 UTC (ts) */
    int64_t unix_time;  /* ns since 1970 (ts2) */
    int64_t latency;    /* ns (ts2), or 0 */
    int calibrated;     /* standard bodies that are calibrated (6dcal less old devices), or -1 */
    int body_count;     /* highest body in a block plus one */
    int has_bodies;     /* there was a line of bodies, so one that is not listed is not tracked */
    int flystick_count; /* that are defined */
    gw_dtrack_pose bodies[GW_DTRACK_BODIES];
    gw_dtrack_flystick flysticks[GW_DTRACK_FLYSTICKS];
    uint32_t lines_unknown; /* of other things: markers, hands, status, ... */
    uint32_t malformed;     /* lines or blocks that break the grammar, counts that lie, ids out of range */
    uint32_t not_finite;    /* poses that are none: numbers beyond any room, a matrix that is no rotation */
} gw_dtrack_frame;

/* Always fills *out, with what could be understood. 0: not a single line was. */
int gw_dtrack_read(const uint8_t *data, size_t size, gw_dtrack_frame *out);

/* Writes fr, ts (or ts2 where has_unix_time), 6dcal, 6d and, with Flysticks, 6df2. Returns its bytes, 0 when
 * there is no room. */
size_t gw_dtrack_write(const gw_dtrack_frame *frame, char *text, size_t room);

/* ns since 1970 of a time of day: of the days around `near` the one that is closest, so that midnight between
 * the two does no harm. */
int64_t gw_dtrack_unix_time(int64_t day_time, int64_t near);

/* Matrix and quaternion; the matrix by columns, as DTrack has it. 0: it is no rotation. */
int gw_dtrack_orientation(const double matrix[9], double orientation[4]);
void gw_dtrack_matrix(const double orientation[4], double matrix[9]);

#endif
