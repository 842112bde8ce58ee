#include "wall/rank_device.h"

#include "wall/rank.h"
#include "wall/wall_view_panels.h"

#include <stdlib.h>

static const gw_panel *own_panel(const struct gw_rank *rank) {
    return &rank->site.panels[rank->number];
}

static int has_tile_window(const struct gw_rank *rank) {
    const gw_windows windows = rank->options.windows;
    return windows == GW_WINDOWS_TILES || (windows == GW_WINDOWS_SITE && own_panel(rank)->display[0]);
}

int gw_rank_has_window(const struct gw_rank *rank) {
    return has_tile_window(rank) || (rank->options.windows == GW_WINDOWS_WALL && rank->number == 0);
}

/* Tiles for which nothing is said stand side by side as they hang, bezels and all. */
static gw_window_options tile_window(const struct gw_rank *rank) {
    const gw_tile *tile = &rank->site.layout.tiles[rank->number];
    const gw_panel *panel = own_panel(rank);
    const int told = panel->display[0] != '\0';
    return (gw_window_options){
        .title = tile->name,
        .monitor = panel->monitor,
        .position = {told ? panel->window[0] : (int32_t)tile->framed[0],
                     told ? panel->window[1] : (int32_t)tile->framed[1]},
        .size = {tile->rectangle.width, tile->rectangle.height},
        .placed = 1,
        .wait = 1,
        .log = &rank->line.log,
    };
}

static gw_window_options wall_window(const struct gw_rank *rank) {
    const uint32_t *size = rank->site.layout.framed;
    return (gw_window_options){.title = "Gazewall",
                               .size = {size[0], size[1] + gw_status_height(1)},
                               .resizable = 1,
                               .wait = 1,
                               .log = &rank->line.log};
}

gw_code gw_rank_open_device(struct gw_rank *rank, gw_error *error) {
    const gw_draw_options *draw = &rank->options.draw;
    const gw_panel *panel = own_panel(rank);
    const int of_tile = has_tile_window(rank);
    const gw_window_options window = of_tile ? tile_window(rank) : wall_window(rank);
    if (rank->model.device)
        return GW_OK;
    char *cache = gw_cache_folder(draw);
    const gw_gl_options device = {.shader_folder = draw->shaders,
                                  .binaries = cache,
                                  .log = &rank->line.log,
                                  .window = gw_rank_has_window(rank) ? &window : NULL,
                                  .choose_gpu = draw->choose_gpu || panel->gpu >= 0,
                                  .gpu = draw->choose_gpu ? draw->gpu : panel->gpu};
    gw_code code = GW_OK;
    /* GLFW reads the display from the environment; nothing else in this process does. */
    if (of_tile && panel->display[0] && setenv("DISPLAY", panel->display, 1))
        code = gw_fail(error, GW_MACHINE, "not enough memory for the name of a display");
    if (!code)
        code = gw_gl_create(&device, &rank->model.device, error);
    free(cache);
    return code;
}

void gw_rank_attend(struct gw_rank *rank) {
    gw_window *window = rank->model.device ? gw_gl_window(rank->model.device) : NULL;
    if (window)
        gw_window_attend(window);
}
