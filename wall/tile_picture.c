#include "wall/tile_picture.h"

#include "base/image.h"
#include "wall/interrupt.h"
#include "wall/picture.h"
#include "wall/verbs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int gw_tile_writes_itself(const gw_rank *rank, uint32_t tile) {
    const gw_panel *panels = rank->site.panels;
    return !rank->options.cluster || !strcmp(panels[tile].host, panels[0].host);
}

static gw_code write_picture(const gw_rank *rank, uint32_t tile, const uint8_t *pixels, const char *path,
                             gw_error *error) {
    const gw_layout *layout = &rank->site.layout;
    const gw_rectangle *rectangle = &layout->tiles[tile].rectangle;
    /* The encoder only reads them. */
    const gw_image image = {
        .width = rectangle->width, .height = rectangle->height, .rgba = (uint8_t *)(uintptr_t)pixels};
    char comment[128];
    snprintf(comment, sizeof comment, "Gazewall " GW_VERSION ", tile %s of %" PRIu32,
             layout->tiles[tile].name, layout->tile_count);
    gw_interrupt_hold();
    gw_code code = path ? gw_image_write_png(path, &image, comment, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    gw_interrupt_release();
    return code;
}

gw_code gw_tile_write_pictures(const gw_rank *rank, uint32_t tile, const uint8_t *pixels,
                               const gw_release *release, gw_error *error) {
    const char *name = rank->site.layout.tiles[tile].name;
    char *path = gw_picture_path(rank->options.out, "tile-%s-%04" PRIu32 ".png", name, release->state.frame);
    gw_code code = write_picture(rank, tile, pixels, path, error);
    free(path);
    if (code || !release->last)
        return code;
    path = gw_picture_path(rank->options.out, "tile-%s.png", name);
    code = write_picture(rank, tile, pixels, path, error);
    free(path);
    return code;
}

gw_code gw_tile_write_others(const gw_rank *rank, const gw_release *release, const uint8_t *const *pixels,
                             gw_error *error) {
    gw_code code = GW_OK;
    for (uint32_t i = 1; i < rank->site.layout.tile_count && !code; i++)
        if (pixels[i] && !gw_tile_writes_itself(rank, i))
            code = gw_tile_write_pictures(rank, i, pixels[i], release, error);
    return code;
}
