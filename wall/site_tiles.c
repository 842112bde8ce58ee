/* Measured tiles: from three or four corners with a tape measure to planes. */
#include "wall/site_internal.h"

#include "render/vector3.h"

#include <math.h>
#include <string.h>

static const double degrees = 57.29577951308232;

static gw_code check_angle(gw_site_source *source, const gw_yaml_node *node, const double across[3],
                           const double down[3], gw_error *error) {
    double dot = gw_dot(across, down), lengths = gw_length(across) * gw_length(down);
    double angle = acos(dot / lengths) * degrees;
    if (fabs(dot) > 0.05 * lengths)
        return gw_yaml_fail(
            node, error,
            "key 'corners': the top and left edges meet at %.1f degrees instead of 90; are the corners "
            "in the order top left, top right, bottom left?",
            angle);
    if (fabs(dot) > 0.005 * lengths)
        gw_site_note(
            source, node,
            "key 'corners': the top and left edges meet at %.2f degrees instead of 90; measure again", angle);
    return GW_OK;
}

/* A fourth corner is not needed: it tells how well the others were measured. */
static gw_code check_fourth(gw_site_source *source, const gw_yaml_node *node, double corners[4][3],
                            gw_error *error) {
    double off[3], diagonal[3];
    for (int i = 0; i < 3; i++) {
        off[i] = corners[3][i] - (corners[1][i] + corners[2][i] - corners[0][i]);
        diagonal[i] = corners[1][i] - corners[2][i];
    }
    double error_mm = gw_length(off), length = gw_length(diagonal);
    if (error_mm > 0.05 * length)
        return gw_yaml_fail(node, error,
                            "key 'corners': the fourth corner is %.1f mm from where the first three put it; "
                            "expected top left, top right, bottom left, bottom right of a flat rectangle",
                            error_mm);
    if (error_mm > 0.005 * length)
        gw_site_note(source, node,
                     "key 'corners': the fourth corner is %.1f mm from where the first three put it; measure "
                     "again",
                     error_mm);
    return GW_OK;
}

/* Three or four measured corners, as the panel's picture has them: top left, top right, bottom left, bottom
 * right. */
static gw_code read_corners(gw_site_source *source, const gw_yaml_node *map, const uint32_t pixels[2],
                            gw_plane *out, gw_error *error) {
    const gw_yaml_node *node;
    double corners[4][3], across[3], down[3];
    gw_code code = gw_site_require(map, "corners", &node, error);
    if (!code)
        code = gw_yaml_expect(node, GW_YAML_LIST, "corners", error);
    size_t count = code ? 0 : gw_yaml_count(node);
    if (!code && count != 3 && count != 4)
        code = gw_yaml_fail(node, error,
                            "key 'corners': %zu points; expected three, in mm: top left, top right, bottom "
                            "left (a fourth, bottom right, checks them)",
                            count);
    for (size_t i = 0; i < count && !code; i++)
        code = gw_site_point(gw_yaml_item(node, i), "corners", corners[i], error);
    if (code)
        return code;
    for (int i = 0; i < 3; i++) {
        across[i] = corners[1][i] - corners[0][i];
        down[i] = corners[2][i] - corners[0][i];
    }
    if (!(gw_length(across) >= 1 && gw_length(down) >= 1))
        return gw_yaml_fail(
            node, error,
            "key 'corners': the tile is %g x %g mm; both must be at least 1 mm (are the corners in metres?)",
            gw_length(across), gw_length(down));
    gw_plane_from_corners((const double(*)[3])corners, pixels, out);
    code = check_angle(source, node, across, down, error);
    return code || count < 4 ? code : check_fourth(source, node, corners, error);
}

/* part: {of: [w, h], at: [x, y]}: the corners are those of a panel of w x h pixels, of which the tile drives
 * some. */
static gw_code read_part(const gw_yaml_node *map, gw_tile *tile, uint32_t whole[2], gw_error *error) {
    static const char *const names[] = {"of", "at"};
    const gw_yaml_node *part = gw_yaml_find(map, "part");
    uint32_t at[2] = {0, 0};
    whole[0] = tile->rectangle.width;
    whole[1] = tile->rectangle.height;
    if (!part)
        return GW_OK;
    gw_code code = gw_site_map(part, "part", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_pixels(part, "of", 1, whole, error);
    if (!code)
        code = gw_site_pixels(part, "at", 0, at, error);
    if (!code && (at[0] + tile->rectangle.width > whole[0] || at[1] + tile->rectangle.height > whole[1]))
        code = gw_yaml_fail(part, error, "key 'part': %ux%u px at %u, %u reach beyond the panel's %ux%u px",
                            tile->rectangle.width, tile->rectangle.height, at[0], at[1], whole[0], whole[1]);
    tile->rectangle.x = (int32_t)at[0];
    tile->rectangle.y = (int32_t)at[1];
    return code;
}

static gw_code read_tile(gw_site_source *source, const gw_yaml_node *map, gw_tile *tile, gw_error *error) {
    static const char *const names[] = {"name", "corners", "pixels", "place", "framed", "part", "panel"};
    uint32_t pixels[2] = {0, 0}, whole[2];
    gw_code code = gw_site_map(map, "tiles", names, GW_COUNT(names), error);
    if (!code)
        code = gw_site_name(map, tile->name, error);
    if (!code)
        code = gw_site_pixels_of(source, map, tile->name, pixels, error);
    tile->rectangle = (gw_rectangle){.width = pixels[0], .height = pixels[1]};
    if (!code)
        code = read_part(map, tile, whole, error);
    if (!code)
        code = read_corners(source, map, whole, &tile->plane, error);
    if (!code)
        code = gw_site_pixels(map, "place", 0, tile->picture, error);
    return code || !gw_yaml_find(map, "framed") ? code
                                                : gw_site_pixels(map, "framed", 0, tile->framed, error);
}

/* Where each tile stands in the picture with bezels: said for all of them, or worked out. */
static gw_code read_framed(const gw_site_source *source, const gw_yaml_node *list, const gw_yaml_node *size,
                           gw_layout *out, gw_error *error) {
    uint32_t said = 0;
    for (uint32_t t = 0; t < out->tile_count; t++)
        said += gw_yaml_find(source->tiles[t], "framed") != NULL;
    if (said == 0 && !size) {
        gw_error inner = {0};
        gw_code code = gw_layout_frame(out, &inner);
        return code ? gw_yaml_fail(list, error, "key 'tiles': %s", inner.text) : GW_OK;
    }
    if (said < out->tile_count || !size)
        return gw_yaml_fail(size ? size : list, error,
                            "the picture with bezels needs 'framed_size' and a 'framed' for each tile, or "
                            "none of them; %u of %u tiles have one and 'framed_size' is %s",
                            said, out->tile_count, size ? "given" : "missing");
    gw_code code = gw_site_pixels(source->root, "framed_size", 1, out->framed, error);
    for (uint32_t t = 0; t < out->tile_count && !code; t++) {
        const gw_tile *tile = &out->tiles[t];
        if (tile->framed[0] + tile->rectangle.width > out->framed[0] ||
            tile->framed[1] + tile->rectangle.height > out->framed[1])
            code = gw_yaml_fail(source->tiles[t], error,
                                "key 'framed': tile '%s' reaches beyond the 'framed_size' of %ux%u px",
                                tile->name, out->framed[0], out->framed[1]);
    }
    return code;
}

gw_code gw_site_read_tiles(gw_site_source *source, const gw_yaml_node *list, const gw_yaml_node *size,
                           gw_layout *out, gw_error *error) {
    gw_code code = gw_yaml_expect(list, GW_YAML_LIST, "tiles", error);
    if (code)
        return code;
    size_t count = gw_yaml_count(list);
    if (count < 1 || count > GW_MAXIMUM_TILES)
        return gw_yaml_fail(list, error, "key 'tiles': %zu tiles; a wall has 1 to %d", count,
                            GW_MAXIMUM_TILES);
    for (size_t i = 0; i < count && !code; i++) {
        source->tiles[i] = gw_yaml_item(list, i);
        code = read_tile(source, source->tiles[i], &out->tiles[out->tile_count++], error);
    }
    if (code)
        return code;
    gw_error inner = {0};
    code = gw_layout_measure(out, &inner);
    if (code)
        return gw_yaml_fail(list, error, "key 'tiles': %s", inner.text);
    return read_framed(source, list, size, out, error);
}
