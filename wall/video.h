/* Video: frames go as raw pixels to an ffmpeg of their own, which writes H.264.
 *
 * The file is written without a name, or where the file system cannot do that under a temporary one, and
 * gets its own only when ffmpeg has ended well: never a half file. ffmpeg ends with this process, however
 * that happens. One thread. */
#ifndef GW_WALL_VIDEO_H
#define GW_WALL_VIDEO_H

#include "base/image.h"
#include "base/status.h"

#include <stdint.h>

typedef struct gw_video gw_video;

/* Before long work: GW_MACHINE when ffmpeg is not installed, GW_BAD_INPUT for an ending that is no video's,
 * GW_NO_OUTPUT where nothing can be written. */
gw_code gw_video_check(const char *path, gw_error *error);

/* Frames of width x height px, `rate` a second. */
gw_code gw_video_open(const char *path, uint32_t width, uint32_t height, double rate, gw_video **out,
                      gw_error *error);
/* GW_NO_OUTPUT with ffmpeg's own words when it has given up. */
gw_code gw_video_frame(gw_video *video, const gw_image *image, gw_error *error);
/* Waits for ffmpeg and names the file. Frees the video in any case. */
gw_code gw_video_close(gw_video **video, gw_error *error);
/* Ends ffmpeg and leaves nothing; accepts NULL. */
void gw_video_abandon(gw_video **video);

#endif
