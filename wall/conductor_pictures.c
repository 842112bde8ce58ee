/* What becomes of the pixels of a frame: pictures with their side-cars, a video, a hash. */
#include "wall/conductor_internal.h"

#include "base/file.h"
#include "base/image.h"
#include "base/memory.h"
#include "wall/frame_code.h"
#include "wall/interrupt.h"
#include "wall/overlay_text.h"
#include "wall/picture.h"
#include "wall/rank.h"
#include "wall/report.h"
#include "wall/side_car.h"
#include "wall/tile_picture.h"
#include "wall/verbs.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

gw_code gw_conductor_open_pictures(gw_conductor *conductor, const struct gw_rank *rank, gw_error *error) {
    const gw_picture_options *options = &rank->options.pictures;
    const gw_layout *layout = &rank->site.layout;
    const double usual_rate = 30;
    gw_code code = GW_OK;
    if (options->overlay)
        code = gw_allocate((void **)&conductor->lanes, layout->tile_count, sizeof *conductor->lanes,
                           "overlay", error);
    for (uint32_t i = 0; i < layout->tile_count && options->codes && !code; i++) {
        const gw_rectangle *r = &layout->tiles[i].rectangle;
        code = gw_allocate((void **)&conductor->shown[i], (size_t)r->width * r->height, 4, "shown pixels",
                           error);
    }
    if (code || !options->video)
        return code;
    const double step = (double)conductor->step * 1e-9;
    const double rate = options->rate > 0                                        ? options->rate
                        : rank->options.step > 0 && step > 1.0 / 240 && step < 1 ? 1 / step
                                                                                 : usual_rate;
    return gw_video_open(options->video, layout->picture[0], layout->picture[1], rate, &conductor->video,
                         error);
}

int gw_conductor_wants_pixels(const gw_conductor *conductor, const struct gw_rank *rank, int last) {
    return !rank->options.gate_only &&
           (last || rank->options.out || conductor->video || gw_pilot_wants_pixels(conductor->pilot));
}

/* --- what is shown
 * ---------------------------------------------------------------------------------------------- */

static gw_missed missed_by(const gw_conductor *conductor, uint32_t tile) {
    if (tile == 0)
        return (gw_missed){0};
    const gw_gate_tile *seen = gw_gate_tile_of(conductor->gate, tile);
    return (gw_missed){.late = seen->late, .skipped = seen->skipped, .lost = seen->lost};
}

/* Overlay and frame code over copies of the tiles' pixels. shown[i] is NULL where pixels[i] is. */
static void decorate(gw_conductor *conductor, const struct gw_rank *rank, const gw_frame_state *state,
                     const gw_done *const *done, const uint8_t *const *pixels, const uint8_t **shown) {
    const gw_picture_options *options = &rank->options.pictures;
    for (uint32_t i = 0; i < rank->site.layout.tile_count; i++) {
        const gw_rectangle *r = &rank->site.layout.tiles[i].rectangle;
        shown[i] = pixels[i];
        if (!options->codes || !pixels[i])
            continue;
        gw_image image = {.width = r->width, .height = r->height, .rgba = conductor->shown[i]};
        memcpy(image.rgba, pixels[i], (size_t)r->width * r->height * 4);
        if (options->overlay) {
            const gw_missed missed = missed_by(conductor, i);
            gw_lanes_note(&conductor->lanes[i], done[i]->lanes);
            gw_rank_overlay(rank, i, state, done[i], &conductor->lanes[i], &missed, &image);
        }
        gw_frame_code_draw(&image, state->frame);
        shown[i] = conductor->shown[i];
    }
}

/* A frame of a video that lacks tiles names them. */
static void name_missing(const gw_layout *layout, uint32_t frame, const uint8_t *const *pixels,
                         gw_image *image) {
    static const uint8_t ground[4] = {96, 0, 16, 255}, ink[4] = {255, 255, 255, 255};
    char text[1024];
    size_t length = (size_t)snprintf(text, sizeof text, "frame %" PRIu32 " is incomplete: it lacks", frame);
    for (uint32_t i = 0; i < layout->tile_count && length < sizeof text - 40; i++)
        if (!pixels[i])
            length += (size_t)snprintf(text + length, sizeof text - length, " %s", layout->tiles[i].name);
    const uint32_t scale = image->height / 360 + 1;
    gw_box_draw(image, 0, 0, image->width, (GW_TEXT_LINE + 4) * (int64_t)scale, ground);
    gw_text_draw(image, 3 * (int64_t)scale, 3 * (int64_t)scale, scale, ink, text);
}

/* --- files
 * ------------------------------------------------------------------------------------------------------ */

static gw_code write_picture(const char *folder, const char *name, const gw_image *image, const char *comment,
                             gw_error *error) {
    char *path = gw_path_join(folder, name);
    gw_interrupt_hold();
    gw_code code = path ? gw_image_write_png(path, image, comment, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    gw_interrupt_release();
    free(path);
    return code;
}

static gw_code write_side_car(const gw_conductor *conductor, const struct gw_rank *rank, const char *name,
                              const gw_frame_state *state, const uint8_t *const *pixels, gw_error *error) {
    const gw_sim_options *options = &rank->options;
    int missing[GW_MAXIMUM_TILES];
    for (uint32_t i = 0; i < rank->site.layout.tile_count; i++)
        missing[i] = !pixels[i];
    const json_t *scene = json_object_get(conductor->report, "scene");
    const gw_side_car_picture picture = {.site = &rank->site,
                                         .settings = &options->draw.settings,
                                         .state = state,
                                         .pattern = options->pictures.pattern,
                                         .force_effects = options->draw.force_effects,
                                         .forbid_effects = options->draw.forbid_effects,
                                         .scene = options->draw.scene,
                                         .animation = options->draw.animation,
                                         .scene_hash = json_string_value(json_object_get(scene, "hash")),
                                         .image = conductor->picture_hash,
                                         .missing = missing,
                                         .overlay = options->pictures.overlay,
                                         .codes = options->pictures.codes};
    char *path = gw_path_join(options->out, name);
    gw_interrupt_hold();
    gw_code code = path ? gw_side_car_write(path, &picture, error)
                        : gw_fail(error, GW_MACHINE, "memory is out while naming a picture");
    gw_interrupt_release();
    free(path);
    return code;
}

/* wall-NNNN.png, wall-bezels-NNNN.png and wall-NNNN.json, and the plain names for the last frame; a frame
 * that lacks a tile says so in its name and never gets a plain one. */
static gw_code write_files(gw_conductor *conductor, const struct gw_rank *rank, const gw_release *release,
                           const uint8_t *const *pixels, const gw_image images[2], gw_error *error) {
    static const char *const stems[2] = {"wall", "wall-bezels"};
    const uint32_t frame = release->state.frame;
    const char *folder = rank->options.out, *mark = conductor->missing ? "-incomplete" : "";
    char name[64], comment[128];
    gw_code code = GW_OK;
    /* Not a word about the split: every split of a wall gives the same file. */
    snprintf(comment, sizeof comment, "Gazewall " GW_VERSION ", frame %" PRIu32 "%s", frame,
             conductor->missing ? ", incomplete" : "");
    for (int plain = 0; plain <= (int)release->last && !code; plain++) {
        char number[16] = "";
        if (!plain)
            snprintf(number, sizeof number, "-%04" PRIu32, frame);
        for (int framed = 0; framed < 2 && !code; framed++) {
            snprintf(name, sizeof name, "%s%s%s.png", stems[framed], number, mark);
            code = write_picture(folder, name, &images[framed], comment, error);
        }
        snprintf(name, sizeof name, "wall%s%s.json", number, mark);
        if (!code)
            code = write_side_car(conductor, rank, name, &release->state, pixels, error);
    }
    return code;
}

/* --- a frame
 * ---------------------------------------------------------------------------------------------------- */

/* Of the tiles' own pixels, whatever is drawn over what is shown. */
static gw_code take_hash(gw_conductor *conductor, const struct gw_rank *rank, int last,
                         const uint8_t *const *pixels, gw_error *error) {
    gw_image image = {0};
    gw_code code = gw_picture_assemble(&rank->site.layout, pixels, 0, &image, error);
    if (!code)
        conductor->picture_hash = gw_image_hash(&image);
    if (!code && last) {
        char name[64];
        snprintf(name, sizeof name, "wall%s.png", conductor->missing ? "-incomplete" : "");
        char *path = rank->options.out ? gw_path_join(rank->options.out, name) : NULL;
        gw_report_image(conductor->report, path, &image);
        free(path);
    }
    gw_image_finish(&image);
    return code;
}

/* With --remake: whether it is the same picture. */
static void compare(const gw_conductor *conductor, struct gw_rank *rank) {
    const gw_sim_options *options = &rank->options;
    char hash[33];
    gw_hash_text(conductor->picture_hash, hash);
    if (!strcmp(hash, options->remade.image_hash))
        gw_log_write(&rank->line.log, GW_LOG_INFO, "the picture of %s was made again, bit for bit",
                     options->pictures.remake);
    else
        gw_log_write(&rank->line.log, GW_LOG_WARNING,
                     "the picture differs from the one of %s, which had hash %s: that was made on another "
                     "device, by another driver or version, or lacked tiles",
                     options->pictures.remake, options->remade.image_hash);
}

gw_code gw_conductor_show(gw_conductor *conductor, struct gw_rank *rank, const gw_release *release,
                          const gw_done *const *done, const uint8_t *const *pixels, const uint8_t **shown,
                          gw_error *error) {
    const int last = release->last != 0;
    memcpy(shown, pixels, rank->site.layout.tile_count * sizeof *shown);
    if (!release->pixels)
        return GW_OK;
    const gw_layout *layout = &rank->site.layout;
    gw_image images[2] = {{0}, {0}};
    gw_code code = last || rank->options.out ? take_hash(conductor, rank, last, pixels, error) : GW_OK;
    if (!code && last && rank->options.pictures.remake)
        compare(conductor, rank);
    decorate(conductor, rank, &release->state, done, pixels, shown);
    if (!code && (rank->options.out || conductor->video))
        code = gw_picture_assemble(layout, shown, 0, &images[0], error);
    if (!code && rank->options.out)
        code = gw_picture_assemble(layout, shown, 1, &images[1], error);
    if (!code && rank->options.out)
        code = write_files(conductor, rank, release, pixels, images, error);
    if (!code && rank->options.out)
        code = gw_tile_write_others(rank, release, shown, error);
    if (!code && conductor->video) {
        if (conductor->missing)
            name_missing(layout, release->state.frame, pixels, &images[0]);
        code = gw_video_frame(conductor->video, &images[0], error);
    }
    gw_image_finish(&images[0]);
    gw_image_finish(&images[1]);
    return code;
}

gw_code gw_conductor_close_pictures(gw_conductor *conductor, gw_code before, gw_error *error) {
    gw_code code = GW_OK;
    if (before)
        gw_video_abandon(&conductor->video);
    else
        code = gw_video_close(&conductor->video, error);
    free(conductor->lanes);
    conductor->lanes = NULL;
    for (uint32_t i = 0; i < GW_MAXIMUM_TILES; i++) {
        free(conductor->shown[i]);
        conductor->shown[i] = NULL;
    }
    return code;
}
