/* Recordings of people who do not exist: heads and gazes that move as people's do, measured as trackers
 * measure them, with every fault that a real line has. For tests, demonstrations and the tuning of filters,
 * where recordings of real people are neither at hand nor anybody's business.
 *
 * The same kind, seed and length give the same bits on every machine. Wall axes, metres: a viewer in front of
 * a wall of 2000 x 1125 mm about the origin. Any thread. */
#ifndef GW_TRACKING_GENERATOR_H
#define GW_TRACKING_GENERATOR_H

#include "tracking/generator_motion.h"
#include "tracking/recording.h"

typedef struct gw_generator_kind {
    const char *name;
    const char *text; /* one line for --help */
} gw_generator_kind;

extern const gw_generator_kind gw_generator_kinds[];
extern const size_t gw_generator_kind_count;

/* Heads are poses of sensors 2 v, gazes are gaze events of viewers v, all of the device "Synthetic0"; a note
 * says that it is synthetic. seconds: 0.1 to 600. GW_BAD_INPUT names an unknown kind. Numbers are cut to
 * binary fractions as coarse as a tracker's, so that they compress; quaternions and directions are of length
 * 1 to 1e-6. */
gw_code gw_generate(const char *kind, uint64_t seed, double seconds, gw_recording **out, gw_error *error);

/* Viewer 0 of such a recording as it is, not as it was measured; for gw_person_finish(). *begun: ns since
 * 1970 of the person's time 0. */
gw_code gw_generated_person(const char *kind, uint64_t seed, double seconds, gw_person *out, int64_t *begun,
                            gw_error *error);

#endif
