#include "wall/wall_view.h"

#include "base/memory.h"
#include "wall/layout_look.h"
#include "wall/overlay_text.h"
#include "wall/present_image.h"
#include "wall/wall_view_panels.h"

#include <math.h>
#include <stdlib.h>

/* Something drawn on the host and laid over the wall. */
typedef struct panel {
    gw_image image;
    gw_present_image shown;
} panel;

struct gw_wall_view {
    gw_gl *device;
    gw_window *window;
    const gw_layout *layout;
    gw_present_image wall; /* as it hangs */
    panel status, birdseye, help;
    uint32_t size[2];        /* px, of the window's picture */
    gw_present_place placed; /* where the wall is shown in it */
    uint32_t scale;          /* px a dot of the text */
};

static const uint8_t bezel_color[4] = {24, 24, 26, 255}, lost_color[4] = {96, 0, 16, 255};
static const float margin_color[3] = {0.03f, 0.03f, 0.035f};

/* --- where things are
 * -------------------------------------------------------------------------------------------- */

/* The wall as large as fits above the line of status, in the middle. */
static void arrange(gw_wall_view *view) {
    gw_window_size(view->window, view->size);
    view->scale = view->size[1] >= 1600 ? 3 : view->size[1] >= 700 ? 2 : 1;
    const uint32_t status = gw_status_height(view->scale);
    const double room[2] = {view->size[0], view->size[1] > status ? view->size[1] - status : 1};
    double scale = fmin(room[0] / view->wall.size[0], room[1] / view->wall.size[1]);
    /* Between half and double, whole pixels are worth a margin: text and edges stay as they were drawn. */
    scale = scale >= 1 ? floor(scale) : scale;
    view->placed.width = (uint32_t)fmax(1, scale * view->wall.size[0]);
    view->placed.height = (uint32_t)fmax(1, scale * view->wall.size[1]);
    view->placed.x = (int32_t)(0.5 * (room[0] - view->placed.width));
    view->placed.y = (int32_t)(0.5 * (room[1] - view->placed.height));
}

static void place_share(const gw_wall_view *view, const double share[2], double point[2]) {
    point[0] = view->placed.x + share[0] * view->placed.width;
    point[1] = view->placed.y + share[1] * view->placed.height;
}

void gw_wall_view_share(const gw_wall_view *view, const double point[2], double share[2]) {
    share[0] = (point[0] - view->placed.x) / view->placed.width;
    share[1] = (point[1] - view->placed.y) / view->placed.height;
}

/* --- drawing
 * --------------------------------------------------------------------------------------------------- */

static void upload_tiles(const gw_wall_view *view, const gw_wall_view_content *content) {
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    for (uint32_t i = 0; i < view->layout->tile_count; i++) {
        const gw_tile *tile = &view->layout->tiles[i];
        const GLint x = (GLint)tile->framed[0], y = (GLint)tile->framed[1];
        const GLsizei width = (GLsizei)tile->rectangle.width, height = (GLsizei)tile->rectangle.height;
        if (content->pixels[i])
            glTextureSubImage2D(view->wall.texture, 0, x, y, width, height, GL_RGBA, GL_UNSIGNED_BYTE,
                                content->pixels[i]);
        else if (content->lost >> i & 1)
            glClearTexSubImage(view->wall.texture, 0, x, y, 0, width, height, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                               lost_color);
    }
}

/* A square of the back buffer in one colour: enough for dots, and needs no program. */
static void dot(const gw_wall_view *view, const double at[2], int side, float shade) {
    glScissor((GLint)at[0] - side / 2, (GLint)view->size[1] - (GLint)at[1] - (side + 1) / 2, side, side);
    glClearColor(shade, shade, shade, 1);
    glClear(GL_COLOR_BUFFER_BIT);
}

/* Where the wall is sharp: a dotted ring, dark about light, so that it is seen on any picture. */
static void draw_rings(const gw_wall_view *view, const gw_frame_state *state) {
    const int side = 1 + (int)view->scale;
    glEnable(GL_SCISSOR_TEST);
    for (uint32_t i = 0; i < state->gaze_count; i++) {
        gw_ring_point points[GW_RING_POINTS];
        const size_t count = gw_gaze_ring(view->layout, &state->gazes[i], points);
        for (int light = 0; light < 2; light++)
            for (size_t p = 0; p < count; p++) {
                const double share[2] = {points[p].framed[0] / view->wall.size[0],
                                         points[p].framed[1] / view->wall.size[1]};
                double at[2];
                place_share(view, share, at);
                dot(view, at, light ? side : side + 2, light ? 1.0f : 0.0f);
            }
    }
    glDisable(GL_SCISSOR_TEST);
}

/* Makes the panel's picture `width` x `height` px, keeping what it has if it has that size. */
static gw_code size_panel(panel *p, uint32_t width, uint32_t height, gw_error *error) {
    const uint32_t size[2] = {width, height};
    if (p->image.width == width && p->image.height == height)
        return GW_OK;
    gw_image_finish(&p->image);
    gw_present_image_finish(&p->shown);
    gw_code code = gw_image_create(width, height, &p->image, error);
    return code ? code : gw_present_image_create(size, &p->shown, error);
}

static void lay_panel(const gw_wall_view *view, const panel *p, int32_t x, int32_t y) {
    const gw_present_place place = {.x = x, .y = y, .width = p->image.width, .height = p->image.height};
    gw_present_image_write(&p->shown, p->image.rgba);
    gw_present_image_copy(&p->shown, &place, view->size);
}

static gw_code draw_status(gw_wall_view *view, const char *text, gw_error *error) {
    const uint32_t height = gw_status_height(view->scale);
    gw_code code = size_panel(&view->status, view->size[0], height, error);
    if (code)
        return code;
    gw_status_draw(&view->status.image, view->scale, text);
    lay_panel(view, &view->status, 0, (int32_t)view->size[1] - (int32_t)height);
    return GW_OK;
}

/* In the wall's lower right corner. */
static gw_code draw_birdseye(gw_wall_view *view, const gw_frame_state *state, gw_error *error) {
    const uint32_t side = 110 * (view->scale + 1), margin = 8 * view->scale;
    gw_code code = size_panel(&view->birdseye, side * 4 / 3, side, error);
    if (code)
        return code;
    gw_birdseye_draw(&view->birdseye.image, view->scale, view->layout, state);
    lay_panel(view, &view->birdseye, (int32_t)(view->size[0] - side * 4 / 3 - margin),
              (int32_t)(view->size[1] - gw_status_height(view->scale) - side - margin));
    return GW_OK;
}

static gw_code draw_help(gw_wall_view *view, const char *text, gw_error *error) {
    uint32_t width, height;
    gw_text_measure(text, view->scale, &width, &height);
    const uint32_t margin = 8 * view->scale;
    gw_code code = size_panel(&view->help, width + 2 * margin, height + 2 * margin, error);
    if (code)
        return code;
    gw_help_draw(&view->help.image, view->scale, text);
    lay_panel(view, &view->help, (int32_t)margin, (int32_t)margin);
    return GW_OK;
}

/* The texture of the wall as the layout has it now: a changed site may move its tiles. */
static gw_code size_wall(gw_wall_view *view, gw_error *error) {
    const uint32_t *size = view->layout->framed;
    const uint32_t side = (uint32_t)gw_gl_limits_of(view->device)->texture_side;
    if (view->wall.size[0] == size[0] && view->wall.size[1] == size[1])
        return GW_OK;
    if (size[0] > side || size[1] > side)
        return gw_fail(error, GW_MACHINE,
                       "the wall is %ux%u px large with its bezels, more than the %u px of a texture of this "
                       "driver; show its tiles instead (--tile-windows)",
                       size[0], size[1], side);
    gw_present_image_finish(&view->wall);
    gw_code code = gw_present_image_create(size, &view->wall, error);
    if (!code)
        glClearTexImage(view->wall.texture, 0, GL_RGBA, GL_UNSIGNED_BYTE, bezel_color);
    return code;
}

gw_code gw_wall_view_show(gw_wall_view *view, const gw_wall_view_content *content, gw_error *error) {
    gw_code code = size_wall(view, error);
    if (code)
        return code;
    arrange(view);
    upload_tiles(view, content);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glClearColor(margin_color[0], margin_color[1], margin_color[2], 1);
    glClear(GL_COLOR_BUFFER_BIT);
    gw_present_image_copy(&view->wall, &view->placed, view->size);
    if (content->ring)
        draw_rings(view, content->state);
    code = draw_status(view, content->status, error);
    if (!code && content->birdseye)
        code = draw_birdseye(view, content->state, error);
    if (!code && content->help)
        code = draw_help(view, content->help, error);
    if (!code)
        code = gw_gl_check("showing the wall", error);
    gw_window_swap(view->window);
    return code;
}

/* --- opening
 * --------------------------------------------------------------------------------------------------- */

gw_code gw_wall_view_open(gw_gl *device, const gw_layout *layout, gw_wall_view **out, gw_error *error) {
    gw_wall_view *view = NULL;
    gw_code code = gw_allocate((void **)&view, 1, sizeof *view, "view of the wall", error);
    if (code)
        return code;
    view->device = device;
    view->window = gw_gl_window(device);
    view->layout = layout;
    code = size_wall(view, error);
    if (code) {
        gw_wall_view_close(&view);
        return code;
    }
    arrange(view);
    *out = view;
    return GW_OK;
}

static void finish_panel(panel *p) {
    gw_image_finish(&p->image);
    gw_present_image_finish(&p->shown);
}

void gw_wall_view_close(gw_wall_view **view) {
    if (!*view)
        return;
    gw_present_image_finish(&(*view)->wall);
    finish_panel(&(*view)->status);
    finish_panel(&(*view)->birdseye);
    finish_panel(&(*view)->help);
    free(*view);
    *view = NULL;
}
