/* What the files of the conductor share: wall/conductor.c runs the frames, conductor_source.c says what they
 * are made from, conductor_output.c what they leave behind. */
#ifndef GW_WALL_CONDUCTOR_INTERNAL_H
#define GW_WALL_CONDUCTOR_INTERNAL_H

#include "wall/conductor.h"

/* Where a frame's state and time are kept. */
static inline uint32_t gw_kept(const gw_conductor *conductor, uint32_t frame) {
    return frame % conductor->kept;
}

/* "frame 120, 24.1 a second, slowest tile c1r0 31 ms, ..." */
void gw_conductor_status(const gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame,
                         char text[160]);

/* Reads the track or the states; sets frame_count, first_time and step. */
gw_code gw_conductor_choose_source(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error);
/* Copies --path out of the scene, while rank 0 still has it. */
gw_code gw_conductor_take_path(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error);
gw_code gw_conductor_make_state(gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame,
                                gw_frame_state *state, gw_error *error);

/* The report, with the command as the user gave it. */
gw_code gw_conductor_create_report(gw_conductor *conductor, const struct gw_rank *rank, int argc, char **argv,
                                   gw_error *error);
/* frames.csv in the folder. */
gw_code gw_conductor_open_rows(gw_conductor *conductor, const char *folder, gw_error *error);
/* One row of it; presented and slowest in ms. */
void gw_conductor_write_row(gw_conductor *conductor, uint32_t frame, const gw_counters *sum, double presented,
                            double slowest);

/* Before a frame: takes over the site file if it was changed (conductor_reload.c). A wrong one is told, and
 * the wall goes on as it was. */
gw_code gw_conductor_reload(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, gw_error *error);

/* Before the first frame of a live wall: from here on tiles that were started again can come back. What
 * stands in the way is a warning (conductor_rejoin.c). */
void gw_conductor_open_door(gw_conductor *conductor, struct gw_rank *rank);

/* --- conductor_pictures.c: what becomes of a frame's pixels */

/* Opens the video and makes room for what is drawn over the pictures. */
gw_code gw_conductor_open_pictures(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error);
/* 1 when the frame's pixels are needed. */
int gw_conductor_wants_pixels(const gw_conductor *conductor, const struct gw_rank *rank, int last);
/* Writes and hashes; done[i] and pixels[i] are tile i's, pixels[i] NULL where the frame lacks it. shown[i]:
 * what of it is to be seen, pixels[i] or a copy with what is drawn over it. */
gw_code gw_conductor_show(gw_conductor *conductor, struct gw_rank *rank, const gw_release *release,
                          const gw_done *const *done, const uint8_t *const *pixels, const uint8_t **shown,
                          gw_error *error);
/* Ends the video, well if nothing failed before. */
gw_code gw_conductor_close_pictures(gw_conductor *conductor, gw_code before, gw_error *error);

/* Recorded states, report and summary. GW_TILES_LOST when not all tiles lasted. */
gw_code gw_conductor_finish(gw_conductor *conductor, struct gw_rank *rank, gw_error *error);

#endif
