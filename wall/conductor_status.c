/* The line that shows how a run goes while it runs. */
#include "wall/conductor_internal.h"
#include "wall/rank.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Frames a second, over the last ones. */
static double pace(const gw_conductor *conductor, uint32_t frame) {
    const uint32_t window = 30, count = frame < window ? frame : window;
    double milliseconds = 0;
    for (uint32_t i = 1; i <= count; i++)
        milliseconds += conductor->milliseconds[gw_kept(conductor, frame - i)];
    return milliseconds > 0 ? 1000 * count / milliseconds : 0;
}

void gw_conductor_status(const gw_conductor *conductor, const struct gw_rank *rank, uint32_t frame,
                         char text[160]) {
    enum { ROOM = 160 };
    if (frame == 0) {
        snprintf(text, ROOM, "drawing the first frame");
        return;
    }
    int length = snprintf(text, ROOM, "frame %" PRIu32 ", %.1f a second, slowest tile %s %.0f ms", frame,
                          pace(conductor, frame), rank->site.layout.tiles[conductor->slowest_tile].name,
                          conductor->slowest_ms);
    if (conductor->seen.places && length < ROOM)
        length +=
            snprintf(text + length, (size_t)(ROOM - length), ", error %.1f times", conductor->seen.worst);
    if (conductor->lost_count && length < ROOM)
        snprintf(text + length, (size_t)(ROOM - length), ", %" PRIu32 " lost", conductor->lost_count);
}
