/* Recording live trackers into a file, for `gazewall record`. Main thread. */
#ifndef GW_WALL_RECORD_LIVE_H
#define GW_WALL_RECORD_LIVE_H

#include "base/log.h"
#include "tracking/reader.h"

typedef struct gw_record_wishes {
    const char *sources[GW_READER_SOURCES];
    int source_count;
    const char *track;     /* the file */
    const char *bind;      /* numeric address of the interface; NULL: all */
    double seconds;        /* 0: until it is ended */
    int consent_gaze;      /* 0: nothing of where somebody looked is written */
    uint64_t gaze_sensors; /* bit n: poses of sensor n (below 64) are gazes */
    int overwrite, quiet;
    const gw_log *log;
} gw_record_wishes;

/* The source's name in the file: of a VRPN source the device, else the protocol; of one that is there already
 * with a number behind it. */
void gw_record_name(const char *spec, const char *const *others, int other_count, char *out, size_t size);

/* Until it is over or Ctrl-C ends it; the file is whole then, and *interrupted the signal's number or 0. What
 * was recorded stays whatever happens. GW_MACHINE when nothing came at all. */
gw_code gw_record_live(const gw_record_wishes *wishes, int *interrupted, gw_error *error);

#endif
