/* What a site's tiles look like in space: sizes that cannot be millimetres, tiles in each other's way, an eye
 * behind a panel, a picture whose order is not the wall's. */
#include "wall/site_internal.h"

#include "render/vector3.h"

#include <math.h>
#include <string.h>

/* Pixels of panels and projections: from a telephone's to an LED wall's seen from a square. */
static const double least_pitch = 0.04, least_usual_pitch = 0.09, greatest_pitch = 100; /* mm */
/* The rays of a tile are made from eye to plane: nearer, they run along it. */
static const double least_eye_distance = 50; /* mm */
/* How far measured panels may reach into each other: more is a mistake, less is noted. */
static const double allowed_overlap = 5, noted_overlap = 1; /* mm, of each */

/* A lit area as a flat box: middle, unit axes (right, up, front), half sizes in mm. */
typedef struct lit_box {
    double middle[3], axes[3][3], half[3];
} lit_box;

static void box_of(const gw_tile *tile, lit_box *out) {
    double corners[4][3];
    gw_tile_corners(tile, corners);
    for (int i = 0; i < 3; i++) {
        out->middle[i] = 0.5 * (corners[1][i] + corners[2][i]);
        out->axes[0][i] = corners[1][i] - corners[0][i];
        out->axes[1][i] = corners[0][i] - corners[2][i];
    }
    out->half[0] = 0.5 * gw_length(out->axes[0]);
    out->half[1] = 0.5 * gw_length(out->axes[1]);
    out->half[2] = 0;
    gw_normalise(out->axes[0], 0);
    gw_normalise(out->axes[1], 0);
    gw_cross(out->axes[0], out->axes[1], out->axes[2]);
    gw_normalise(out->axes[2], 0);
}

static int apart_along(const lit_box *a, const lit_box *b, const double axis[3]) {
    double between = 0, reach = 0;
    for (int i = 0; i < 3; i++) {
        between += (b->middle[i] - a->middle[i]) * axis[i];
        reach += a->half[i] * fabs(gw_dot(a->axes[i], axis)) + b->half[i] * fabs(gw_dot(b->axes[i], axis));
    }
    return fabs(between) > reach;
}

/* Separating axes of two boxes (Gottschalk, Lin, Manocha: OBBTree, SIGGRAPH 1996), after `margin` mm are
 * taken off each side of both, and with some thickness so that panels lying on each other meet. */
static int collide(lit_box a, lit_box b, double margin) {
    for (int i = 0; i < 2; i++) {
        a.half[i] = fmax(0, a.half[i] - fmin(margin, 0.04 * a.half[i]));
        b.half[i] = fmax(0, b.half[i] - fmin(margin, 0.04 * b.half[i]));
    }
    a.half[2] = b.half[2] = 0.4 * margin;
    for (int i = 0; i < 3; i++)
        if (apart_along(&a, &b, a.axes[i]) || apart_along(&a, &b, b.axes[i]))
            return 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double axis[3];
            gw_cross(a.axes[i], b.axes[j], axis);
            if (gw_length(axis) > 1e-6 && apart_along(&a, &b, axis))
                return 0;
        }
    return 1;
}

/* Two tiles in one place, one for each eye. */
static int is_stereo_pair(const gw_site *site, uint32_t a, uint32_t b) {
    uint32_t first = site->panels[a].stereo, second = site->panels[b].stereo;
    return (first == GW_STEREO_LEFT && second == GW_STEREO_RIGHT) ||
           (first == GW_STEREO_RIGHT && second == GW_STEREO_LEFT);
}

static gw_code check_pitch(gw_site_source *source, const gw_tile *tile, const gw_yaml_node *node,
                           gw_error *error) {
    double width = gw_length(tile->plane.step_x), height = gw_length(tile->plane.step_y);
    double least = fmin(width, height), ratio = width / height;
    const uint32_t pixels[2] = {tile->rectangle.width, tile->rectangle.height};
    double size[2] = {width * pixels[0], height * pixels[1]};
    if (least < least_pitch)
        return gw_yaml_fail(
            node, error,
            "tile '%s' has %g x %g mm for %ux%u pixels, %.2g mm each; expected at least %g mm: "
            "is it in %s?",
            tile->name, size[0], size[1], pixels[0], pixels[1], least, least_pitch,
            least < 0.01 ? "metres" : "inches or centimetres");
    if (fmax(width, height) > greatest_pitch)
        return gw_yaml_fail(
            node, error,
            "tile '%s' has %g x %g mm for %ux%u pixels, %.4g mm each; expected at most %g mm: "
            "all lengths are in mm",
            tile->name, size[0], size[1], pixels[0], pixels[1], fmax(width, height), greatest_pitch);
    if (least < least_usual_pitch)
        gw_site_note(source, node,
                     "tile '%s' has pixels of %.3g mm, a telephone's; is its size in centimetres?",
                     tile->name, least);
    if (fabs(ratio - 1) > 0.02) {
        double turned = (size[0] / pixels[1]) / (size[1] / pixels[0]);
        gw_site_note(source, node, "tile '%s' has pixels of %.4g x %.4g mm, not square by %.1f %%; %s",
                     tile->name, width, height, 100 * fabs(ratio - 1),
                     fabs(turned - 1) < 0.05 ? "are width and height of its pixels exchanged?"
                                             : "measure the lit area alone, without its frame");
    }
    return GW_OK;
}

static gw_code check_eye(const gw_site_source *source, const gw_layout *layout, const lit_box *boxes,
                         gw_error *error) {
    const gw_yaml_node *said = gw_yaml_find(source->root, "eye");
    double distances[GW_MAXIMUM_TILES];
    uint32_t behind = 0, first = layout->tile_count;
    for (uint32_t t = 0; t < layout->tile_count; t++) {
        distances[t] = 0;
        for (int i = 0; i < 3; i++)
            distances[t] += (layout->eye[i] - boxes[t].middle[i]) * boxes[t].axes[2][i];
        behind += distances[t] < 0;
        if (distances[t] < least_eye_distance && first == layout->tile_count)
            first = t;
    }
    if (first == layout->tile_count)
        return GW_OK;
    /* An eye behind all tiles is wrong itself; behind one, that one's corners are. */
    const gw_yaml_node *node =
        said && (behind == layout->tile_count || distances[first] >= 0) ? said : source->tiles[first];
    return gw_yaml_fail(
        node, error,
        "the eye at [%g, %g, %g] is %.0f mm %s tile '%s'; expected at least %.0f mm in front of every "
        "tile's plane (correct 'eye', or the order of the tile's corners)",
        layout->eye[0], layout->eye[1], layout->eye[2], fabs(distances[first]),
        distances[first] < 0 ? "behind" : "in front of", layout->tiles[first].name, least_eye_distance);
}

static int overlap_in_picture(const gw_tile *a, const gw_tile *b) {
    return a->picture[0] < b->picture[0] + b->rectangle.width &&
           b->picture[0] < a->picture[0] + a->rectangle.width &&
           a->picture[1] < b->picture[1] + b->rectangle.height &&
           b->picture[1] < a->picture[1] + a->rectangle.height;
}

/* Neighbours in the picture must be so on the wall: b stands after a along `axis`. */
static void check_order(gw_site_source *source, const gw_layout *layout, const lit_box *boxes, uint32_t a,
                        uint32_t b) {
    const gw_tile *first = &layout->tiles[a], *next = &layout->tiles[b];
    const uint32_t sizes[2] = {first->rectangle.width, first->rectangle.height};
    for (int axis = 0; axis < 2; axis++) {
        if (first->picture[axis] + sizes[axis] != next->picture[axis] ||
            first->picture[1 - axis] != next->picture[1 - axis])
            continue;
        double along = 0;
        for (int i = 0; i < 3; i++)
            along += (boxes[b].middle[i] - boxes[a].middle[i]) *
                     (boxes[a].axes[axis][i] + boxes[b].axes[axis][i]) * (axis ? -1 : 1);
        if (along < 0)
            gw_site_note(source, source->tiles[b],
                         "tile '%s' is %s '%s' in the picture, but hangs on its other side; are their places "
                         "exchanged?",
                         next->name, axis ? "below" : "right of", first->name);
    }
}

static gw_code check_pair(gw_site_source *source, const gw_site *site, const lit_box *boxes, uint32_t a,
                          uint32_t b, gw_error *error) {
    const gw_tile *first = &site->layout.tiles[a], *second = &site->layout.tiles[b];
    const gw_yaml_node *node = source->tiles[b];
    int line = gw_yaml_node_line(source->tiles[a]);
    if (!strcmp(first->name, second->name))
        return gw_yaml_fail(node, error, "key 'name': '%s' is a tile in line %d already", second->name, line);
    check_order(source, &site->layout, boxes, a, b);
    check_order(source, &site->layout, boxes, b, a);
    if (is_stereo_pair(site, a, b))
        return GW_OK;
    if (overlap_in_picture(first, second))
        return gw_yaml_fail(node, error,
                            "tile '%s' overlaps tile '%s' of line %d in the picture; correct 'place' or "
                            "'pixels'",
                            second->name, first->name, line);
    if (collide(boxes[a], boxes[b], allowed_overlap))
        return gw_yaml_fail(
            node, error,
            "tile '%s' hangs in tile '%s' of line %d: their lit areas meet by more than %g mm; "
            "correct the corners (two tiles for one pair of eyes are stereo: left and right)",
            second->name, first->name, line, 2 * allowed_overlap);
    if (collide(boxes[a], boxes[b], noted_overlap))
        gw_site_note(source, node,
                     "tile '%s' reaches some millimetres into tile '%s' of line %d; measure again",
                     second->name, first->name, line);
    return GW_OK;
}

gw_code gw_site_check_space(gw_site_source *source, const gw_site *site, gw_error *error) {
    const gw_layout *layout = &site->layout;
    lit_box boxes[GW_MAXIMUM_TILES];
    gw_code code = GW_OK;
    for (uint32_t t = 0; t < layout->tile_count && !code; t++) {
        box_of(&layout->tiles[t], &boxes[t]);
        const gw_rectangle *size = &layout->tiles[t].rectangle,
                           *last = &layout->tiles[t ? t - 1 : 0].rectangle;
        /* Tiles of one generator are alike, but for those with pixels of their own. */
        if (t == 0 || source->tiles[t] != source->tiles[t - 1] || size->width != last->width ||
            size->height != last->height)
            code = check_pitch(source, &layout->tiles[t], source->tiles[t], error);
    }
    for (uint32_t b = 0; b < layout->tile_count && !code; b++)
        for (uint32_t a = 0; a < b && !code; a++)
            code = check_pair(source, site, boxes, a, b, error);
    return code ? code : check_eye(source, layout, boxes, error);
}
