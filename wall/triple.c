#include "wall/triple.h"

#include "render/acuity_filter.h"
#include "render/frame_block.h"
#include "render/metrics.h"
#include "wall/heat.h"
#include "wall/picture.h"

#include <math.h>
#include <stdlib.h>

enum { PARTS = 4 };
static const char *const part_names[PARTS] = {"exact", "approximate", "difference", "seen"};

typedef struct triple {
    const gw_triple_view *view;
    const gw_image *parts[PARTS];
    gw_image exact, difference, seen;
    double pixels_per_degree, flip, seen_flip;
    int gazed;
} triple;

gw_frame_state gw_exact_state(const gw_frame_state *state) {
    gw_frame_state exact = *state;
    exact.tau = exact.tau_inside = 0;
    exact.geometry = GW_GEOMETRY_HYBRID;
    exact.gaze_count = 0;
    exact.debug = GW_DEBUG_NONE;
    exact.samples = 4; /* log2 */
    exact.accumulate = 1;
    exact.epoch = 0;
    return exact;
}

static gw_code compare_seen(triple *t, gw_error *error) {
    const gw_triple_view *view = t->view;
    gw_image filtered[2] = {{0}, {0}};
    gw_frame_block block;
    gw_code code = gw_frame_block_fill(view->scene, view->octree, view->placement, view->plane, view->state,
                                       &block, NULL, error);
    for (int i = 0; i < 2 && !code; i++)
        code = gw_acuity_filter(t->parts[i], &block, &filtered[i], error);
    if (!code)
        code =
            gw_heat_picture(&filtered[0], &filtered[1], t->pixels_per_degree, &t->seen, &t->seen_flip, error);
    gw_image_finish(&filtered[0]);
    gw_image_finish(&filtered[1]);
    return code;
}

static gw_code write_part(const char *folder, const char *name, const gw_image *image, gw_error *error) {
    char *path = gw_picture_path(folder, "%s.png", name);
    gw_code code = path ? gw_image_write_png(path, image, NULL, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    free(path);
    return code;
}

static gw_code write_parts(const triple *t, const char *folder, gw_error *error) {
    const int count = t->gazed ? PARTS : PARTS - 1;
    const uint32_t width = t->exact.width;
    gw_image all = {0};
    gw_code code = gw_image_create(width * (uint32_t)count, t->exact.height, &all, error);
    for (int i = 0; i < count && !code; i++) {
        gw_image_place(&all, t->parts[i], (int64_t)i * width, 0);
        code = write_part(folder, part_names[i], t->parts[i], error);
    }
    if (!code)
        code = write_part(folder, "triple", &all, error);
    gw_image_finish(&all);
    return code;
}

gw_code gw_triple_write(const gw_triple_view *view, const gw_image *approximate, const char *folder,
                        json_t **numbers, gw_error *error) {
    triple t = {.view = view, .gazed = view->state->gaze_count > 0};
    const gw_frame_state state = gw_exact_state(view->state);
    const gw_rectangle all = {.width = approximate->width, .height = approximate->height};
    t.pixels_per_degree =
        gw_pixels_per_degree(view->plane, view->state->eye, approximate->width, approximate->height);
    t.parts[0] = &t.exact;
    t.parts[1] = approximate;
    t.parts[2] = &t.difference;
    t.parts[3] = &t.seen;
    gw_code code = gw_image_create(all.width, all.height, &t.exact, error);
    if (!code)
        code = gw_renderer_frame(view->renderer, view->placement, view->plane, &all, &state, t.exact.rgba,
                                 NULL, error);
    if (!code)
        code = gw_heat_picture(&t.exact, approximate, t.pixels_per_degree, &t.difference, &t.flip, error);
    if (!code && t.gazed)
        code = compare_seen(&t, error);
    if (!code)
        code = write_parts(&t, folder, error);
    if (!code)
        *numbers = json_pack("{s:f, s:o, s:f, s:i}", "flip", t.flip, "seen_flip",
                             t.gazed ? json_real(t.seen_flip) : json_null(), "pixels_per_degree",
                             t.pixels_per_degree, "rays", GW_TRIPLE_RAYS);
    gw_image_finish(&t.exact);
    gw_image_finish(&t.difference);
    gw_image_finish(&t.seen);
    return code;
}
