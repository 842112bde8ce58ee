#include "build/octree_picture.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MARGIN = 16, SWATCH = 28, LEGEND = 64, DIGIT_WIDTH = 3, DIGIT_HEIGHT = 5, DIGIT_SCALE = 3 };
enum { OUTLINED_FROM = 4 }; /* px: smaller cells have no outline, it would be all that is seen */

/* The part of the root cell that one panel shows: its corner and the cube's units a pixel. */
typedef struct panel {
    gw_image *image;
    uint32_t x, width, height; /* px; x of the left column */
    int right, up, depth;      /* axes */
    double low[2], step;       /* root units: left and lower end, side of a pixel */
    double far, range;         /* root units along the depth axis: the scene's far end, its extent */
    const gw_octree *octree;
    uint32_t deepest;
} panel;

/* A cell with its node. */
typedef struct place {
    uint32_t node, level, cell[3];
} place;

static void put(panel *p, int64_t x, int64_t y, const uint8_t color[3]) {
    if (x < 0 || y < 0 || x >= p->width || y >= p->height)
        return;
    uint8_t *pixel = p->image->rgba + ((size_t)y * p->image->width + p->x + (size_t)x) * 4;
    memcpy(pixel, color, 3);
}

/* From violet (the root) over green to yellow: anchors of the viridis map (Smith and van der Walt 2015). */
static void color_of_level(uint32_t level, uint32_t deepest, double brightness, uint8_t out[3]) {
    static const double anchors[5][3] = {
        {84, 18, 104}, {59, 92, 150}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
    const double at = deepest ? 4.0 * level / deepest : 4.0;
    const int first = at >= 4.0 ? 3 : (int)at;
    for (int i = 0; i < 3; i++) {
        const double value = anchors[first][i] + (at - first) * (anchors[first + 1][i] - anchors[first][i]);
        out[i] = (uint8_t)lround(value * brightness);
    }
}

/* The pixel in which a cell border lies, from the panel's left or lower end. */
static int64_t border_pixel(const panel *p, int up, uint32_t border, uint32_t level) {
    return (int64_t)floor((border * ldexp(2, -(int)level) - 1 - p->low[up]) / p->step);
}

/* The square of a cell in the panel: left, top, right, bottom px, the last two outside; never less than a
 * pixel. */
static void square_of(const panel *p, const place *at, int64_t square[4]) {
    square[0] = border_pixel(p, 0, at->cell[p->right], at->level);
    square[1] = p->height - border_pixel(p, 1, at->cell[p->up] + 1, at->level);
    square[2] = border_pixel(p, 0, at->cell[p->right] + 1, at->level);
    square[3] = p->height - border_pixel(p, 1, at->cell[p->up], at->level);
    square[2] += square[2] == square[0];
    square[1] -= square[1] == square[3];
}

static void paint_cell(panel *p, const place *at, int filled, double brightness) {
    int64_t s[4];
    uint8_t inside[3], outline[3];
    square_of(p, at, s);
    if (s[2] <= 0 || s[3] <= 0 || s[0] >= p->width || s[1] >= p->height)
        return;
    color_of_level(at->level, p->deepest, brightness, inside);
    color_of_level(at->level, p->deepest, brightness * (filled ? 0.55 : 0.35), outline);
    const int outlined = s[2] - s[0] >= OUTLINED_FROM;
    for (int64_t y = s[1] < 0 ? 0 : s[1]; y < s[3] && y < p->height; y++)
        for (int64_t x = s[0] < 0 ? 0 : s[0]; x < s[2] && x < p->width; x++) {
            const int edge = x == s[0] || y == s[3] - 1;
            if (outlined && edge)
                put(p, x, y, outline);
            else if (filled)
                put(p, x, y, inside);
        }
}

static int is_leaf(const panel *p, const place *at) {
    return GW_NODE_KIND(p->octree->nodes[at->node].bits) != GW_KIND_INNER;
}

/* Child `octant` of an inner cell; 0 when it does not exist (its place is filled in all the same). */
static int child_of(const panel *p, const place *at, uint32_t octant, place *out) {
    const gw_node node = p->octree->nodes[at->node];
    const uint32_t valid = GW_NODE_VALID(node.bits);
    out->level = at->level + 1;
    for (uint32_t i = 0; i < 3; i++)
        out->cell[i] = at->cell[i] * 2 + (octant >> i & 1u);
    out->node = node.link + (uint32_t)__builtin_popcount(valid & ((1u << octant) - 1u));
    return (int)(valid >> octant & 1u);
}

/* --- the cut
 * -------------------------------------------------------------------------------------------------------- */

/* Cells that the plane at `slice` (a cell coordinate of the deepest level) passes through. */
static void paint_cut(panel *p, const place *at, uint32_t slice) {
    if (is_leaf(p, at)) {
        paint_cell(p, at, 1, 1.0);
        return;
    }
    const uint32_t side = slice >> (p->deepest - at->level - 1) & 1u;
    for (uint32_t octant = 0; octant < 8; octant++) {
        place child;
        if ((octant >> p->depth & 1u) != side)
            continue;
        if (child_of(p, at, octant, &child))
            paint_cut(p, &child, slice);
        else
            paint_cell(p, &child, 0, 1.0);
    }
}

static void count_leaves(const panel *p, const place *at, uint64_t *counts) {
    if (is_leaf(p, at)) {
        const uint32_t shift = p->deepest - at->level;
        counts[at->cell[p->depth] << shift | (1u << shift) >> 1]++;
        return;
    }
    for (uint32_t octant = 0; octant < 8; octant++) {
        place child;
        if (child_of(p, at, octant, &child))
            count_leaves(p, &child, counts);
    }
}

/* Half of the leaves lie on each side of it, so the cut shows something. */
static gw_code middle_slice(const panel *p, uint32_t *out, gw_error *error) {
    const place root = {0};
    const size_t slices = (size_t)1 << p->deepest;
    uint64_t *counts = NULL, all = 0, below = 0;
    gw_code code = gw_allocate((void **)&counts, slices, sizeof *counts, "slices of the octree", error);
    if (code != GW_OK)
        return code;
    count_leaves(p, &root, counts);
    for (size_t i = 0; i < slices; i++)
        all += counts[i];
    for (*out = 0; *out + 1 < slices && 2 * (below + counts[*out]) < all; ++*out)
        below += counts[*out];
    free(counts);
    return GW_OK;
}

/* --- the view
 * -------------------------------------------------------------------------------------------------------- */

/* Far children first, so that near ones cover them. */
static void paint_view(panel *p, const place *at) {
    if (is_leaf(p, at)) {
        const double front = (at->cell[p->depth] + 1) * ldexp(2, -(int)at->level) - 1;
        const double near = fmin(1, fmax(0, (front - p->far) / p->range));
        paint_cell(p, at, 1, 0.35 + 0.65 * near);
        return;
    }
    for (uint32_t side = 0; side < 2; side++)
        for (uint32_t octant = 0; octant < 8; octant++) {
            place child;
            if ((octant >> p->depth & 1u) == side && child_of(p, at, octant, &child))
                paint_view(p, &child);
        }
}

/* --- the legend
 * -------------------------------------------------------------------------------------------------------- */

static void paint_digit(panel *p, int64_t x, int64_t y, uint32_t digit) {
    /* Rows of three bits, top row first. */
    static const uint16_t glyphs[10] = {075557, 026227, 071747, 071717, 055711,
                                        074717, 074757, 071111, 075757, 075717};
    static const uint8_t white[3] = {230, 230, 230};
    for (int row = 0; row < DIGIT_HEIGHT * DIGIT_SCALE; row++)
        for (int column = 0; column < DIGIT_WIDTH * DIGIT_SCALE; column++) {
            const int bit = (DIGIT_HEIGHT - 1 - row / DIGIT_SCALE) * 3 + 2 - column / DIGIT_SCALE;
            if (glyphs[digit] >> bit & 1)
                put(p, x + column, y + row, white);
        }
}

/* A swatch and a number for every level that has leaves. */
static void paint_legend(panel *p) {
    int64_t y = 0;
    for (uint32_t level = 0; level <= p->deepest; level++) {
        uint8_t color[3];
        int leaves = 0;
        for (uint32_t i = p->octree->level_begin[level]; i < p->octree->level_begin[level + 1]; i++)
            leaves |= GW_NODE_KIND(p->octree->nodes[i].bits) != GW_KIND_INNER;
        if (!leaves)
            continue;
        color_of_level(level, p->deepest, 1.0, color);
        for (int64_t row = 0; row < SWATCH - 4; row++)
            for (int64_t column = 0; column < SWATCH - 4; column++)
                put(p, column, y + row, color);
        const int64_t x = SWATCH + 2, line = y + 4;
        if (level >= 10)
            paint_digit(p, x, line, level / 10);
        paint_digit(p, x + (DIGIT_WIDTH + 1) * DIGIT_SCALE, line, level % 10);
        y += SWATCH;
    }
}

/* --- the picture
 * -------------------------------------------------------------------------------------------------------- */

static uint32_t clamp_side(double pixels) {
    return pixels < 8 ? 8 : (uint32_t)ceil(pixels);
}

gw_code gw_octree_picture(const gw_scene *scene, const gw_octree *octree, int axis, uint32_t side,
                          gw_image *out, gw_error *error) {
    static const int rights[3] = {2, 0, 0}, ups[3] = {1, 2, 1};
    const place root = {0};
    panel p = {.image = out,
               .right = rights[axis],
               .up = ups[axis],
               .depth = axis,
               .octree = octree,
               .deepest = octree->statistics.deepest};
    double extent[3], longest = 0;
    uint32_t slice = 0;
    for (int i = 0; i < 3; i++) {
        extent[i] = ldexp(scene->bounds[1][i] - scene->bounds[0][i], -scene->exponent);
        longest = fmax(longest, extent[i]);
    }
    p.step = longest / side;
    p.far = -0.5 * extent[axis];
    p.range = fmax(extent[axis], p.step);
    p.low[0] = -0.5 * extent[p.right];
    p.low[1] = -0.5 * extent[p.up];
    p.width = clamp_side(extent[p.right] / p.step);
    p.height = clamp_side(extent[p.up] / p.step);
    const uint32_t high =
        p.height > SWATCH * (GW_OCTREE_MAXIMUM_DEPTH + 1) ? p.height : SWATCH * (GW_OCTREE_MAXIMUM_DEPTH + 1);
    gw_code code = gw_image_create(2 * (p.width + MARGIN) + LEGEND, high, out, error);
    if (code == GW_OK)
        code = middle_slice(&p, &slice, error);
    if (code != GW_OK) {
        gw_image_finish(out);
        return code;
    }
    for (size_t i = 3; i < (size_t)out->width * out->height * 4; i += 4)
        out->rgba[i] = 255;
    paint_cut(&p, &root, slice);
    p.x = p.width + MARGIN;
    paint_view(&p, &root);
    p.x = 2 * (p.width + MARGIN);
    p.width = LEGEND;
    p.height = high;
    paint_legend(&p);
    return GW_OK;
}
