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
    uint32_t late = 0, lost = 0, returned = 0;
    for (uint32_t i = 1; i < rank->site.layout.tile_count; i++) {
        const gw_gate_tile *tile = gw_gate_tile_of(conductor->gate, i);
        late += tile->state == GW_TILE_LATE;
        lost += tile->state == GW_TILE_LOST;
        returned += tile->state != GW_TILE_LOST && tile->lost > 0;
    }
    const struct {
        uint32_t count;
        const char *what;
    } tiles[] = {{late, "late"}, {lost, "lost"}, {returned, "back again"}};
    for (size_t i = 0; i < sizeof tiles / sizeof tiles[0]; i++)
        if (tiles[i].count && length < ROOM)
            length += snprintf(text + length, (size_t)(ROOM - length), ", %" PRIu32 " %s", tiles[i].count,
                               tiles[i].what);
    const uint64_t compiling = gw_gate_compiling(conductor->gate) | (uint64_t)(conductor->making != 0);
    char names[64];
    gw_layout_names(&rank->site.layout, compiling, names, sizeof names);
    if (compiling && length < ROOM)
        snprintf(text + length, (size_t)(ROOM - length), ", kernels in the making: %s", names);
}
