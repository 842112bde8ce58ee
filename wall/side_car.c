#include "wall/side_car.h"

#include "base/file.h"
#include "wall/frames.h"
#include "wall/report.h"
#include "wall/verbs.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VERSION = 1, MOST_BYTES = 4 << 20, MOST_TEXT = 4096 };

/* --- writing
 * --------------------------------------------------------------------------------------------------- */

static json_t *pack_numbers(const double *values, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_real(values[i]));
    return list;
}

static json_t *pack_pair(const uint32_t values[2]) {
    return json_pack("[I, I]", (json_int_t)values[0], (json_int_t)values[1]);
}

static json_t *pack_tile(const gw_tile *tile, uint32_t stereo) {
    const gw_rectangle *r = &tile->rectangle;
    return json_pack("{s:s, s:o, s:o, s:o, s:[I, I, I, I], s:o, s:o, s:s}", "name", tile->name, "corner",
                     pack_numbers(tile->plane.corner, 3), "step_x", pack_numbers(tile->plane.step_x, 3),
                     "step_y", pack_numbers(tile->plane.step_y, 3), "rectangle", (json_int_t)r->x,
                     (json_int_t)r->y, (json_int_t)r->width, (json_int_t)r->height, "picture",
                     pack_pair(tile->picture), "framed", pack_pair(tile->framed), "stereo",
                     gw_stereo_names[stereo]);
}

static json_t *pack_site(const gw_site *site) {
    const gw_layout *layout = &site->layout;
    json_t *tiles = json_array();
    for (uint32_t i = 0; i < layout->tile_count; i++)
        json_array_append_new(tiles, pack_tile(&layout->tiles[i], site->panels[i].stereo));
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "picture", pack_pair(layout->picture), "framed",
                     pack_pair(layout->framed), "size", pack_numbers(layout->size, 2), "centre",
                     pack_numbers(layout->centre, 3), "eye", pack_numbers(layout->eye, 3), "tiles", tiles);
}

static json_t *pack_settings(const gw_settings *settings) {
    json_t *object = json_object();
    for (size_t i = 0; i < gw_setting_count; i++) {
        char text[64];
        gw_setting_text(settings, &gw_setting_rows[i], text);
        json_object_set_new(object, gw_setting_rows[i].name, json_string(text));
    }
    return object;
}

static json_t *text_or_null(const char *text) {
    return text ? json_string(text) : json_null();
}

/* The scene is found from any folder. */
static json_t *pack_path(const char *path) {
    char *whole = path ? realpath(path, NULL) : NULL;
    json_t *out = text_or_null(whole ? whole : path);
    free(whole);
    return out;
}

static json_t *pack_missing(const gw_side_car_picture *p) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < p->site->layout.tile_count; i++)
        if (p->missing[i])
            json_array_append_new(list, json_string(p->site->layout.tiles[i].name));
    return list;
}

gw_code gw_side_car_write(const char *path, const gw_side_car_picture *p, gw_error *error) {
    char hash[33];
    gw_hash_text(p->image, hash);
    json_t *object =
        json_pack("{s:i, s:s, s:{s:s, s:o, s:b, s:b}, s:s, s:{s:o, s:o, s:o}, s:{s:I, s:I}, s:o, s:o, s:o}",
                  "gazewall_picture", VERSION, "version", GW_VERSION, "image", "hash", hash, "missing",
                  pack_missing(p), "overlay", p->overlay, "frame_codes", p->codes, "pattern",
                  gw_pattern_names[p->pattern], "scene", "file", pack_path(p->scene), "hash",
                  text_or_null(p->scene_hash), "animation", text_or_null(p->animation), "effects", "forced",
                  (json_int_t)p->force_effects, "forbidden", (json_int_t)p->forbid_effects, "settings",
                  pack_settings(p->settings), "state", gw_state_pack(p->state), "site", pack_site(p->site));
    char *text = object ? json_dumps(object, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) : NULL;
    json_decref(object);
    if (!text)
        return gw_fail(error, GW_MACHINE,
                       "%s: a side-car could not be put into words: memory is out, or a name is no "
                       "UTF-8",
                       path);
    gw_code code = gw_file_write(path, text, strlen(text), error);
    free(text);
    return code;
}

/* --- reading
 * --------------------------------------------------------------------------------------------------- */

typedef struct reader {
    const char *path;
    gw_error *error;
} reader;

static gw_code fail(const reader *at, const char *key, const char *expected) {
    return gw_fail(at->error, GW_BAD_INPUT, "%s: '%s' is missing or not %s", at->path, key, expected);
}

static gw_code take_integers(const reader *at, const json_t *object, const char *key, size_t count,
                             int64_t least, int64_t most, int64_t *out) {
    const json_t *list = json_object_get(object, key);
    int good = json_is_array(list) && json_array_size(list) == count;
    for (size_t i = 0; i < count && good; i++) {
        const json_t *value = json_array_get(list, i);
        out[i] = json_integer_value(value);
        good = json_is_integer(value) && out[i] >= least && out[i] <= most;
    }
    return good ? GW_OK : fail(at, key, "a list of whole numbers in their range");
}

static gw_code take_pair(const reader *at, const json_t *object, const char *key, uint32_t out[2]) {
    int64_t values[2] = {0, 0};
    gw_code code = take_integers(at, object, key, 2, 0, GW_MAXIMUM_WALL_SIDE, values);
    out[0] = (uint32_t)values[0];
    out[1] = (uint32_t)values[1];
    return code;
}

static gw_code take_reals(const reader *at, const json_t *object, const char *key, size_t count,
                          double *out) {
    const json_t *list = json_object_get(object, key);
    int good = json_is_array(list) && json_array_size(list) == count;
    for (size_t i = 0; i < count && good; i++) {
        const json_t *value = json_array_get(list, i);
        out[i] = json_number_value(value);
        good = json_is_number(value) && fabs(out[i]) <= 1e9;
    }
    return good ? GW_OK : fail(at, key, "a list of numbers within 1e9");
}

/* Text of at most MOST_TEXT bytes; NULL where it is null. */
static gw_code take_text(const reader *at, const json_t *object, const char *key, char **out) {
    const json_t *value = json_object_get(object, key);
    if (json_is_null(value))
        return GW_OK;
    if (!json_is_string(value) || json_string_length(value) > MOST_TEXT ||
        strlen(json_string_value(value)) != json_string_length(value))
        return fail(at, key, "a text or null");
    *out = strdup(json_string_value(value));
    return *out ? GW_OK : gw_fail(at->error, GW_MACHINE, "memory is out while reading %s", at->path);
}

static gw_code take_hash(const reader *at, const json_t *object, char out[33]) {
    const json_t *value = json_object_get(object, "hash");
    if (json_is_null(value))
        return GW_OK;
    const char *text = json_string_value(value);
    if (!text || strlen(text) != 32 || strspn(text, "0123456789abcdef") != 32)
        return fail(at, "hash", "32 hexadecimal digits or null");
    memcpy(out, text, 33);
    return GW_OK;
}

static gw_code take_choice(const reader *at, const json_t *object, const char *key, const char *const *names,
                           uint32_t count, uint32_t *out) {
    const char *text = json_string_value(json_object_get(object, key));
    for (uint32_t i = 0; text && i < count; i++)
        if (!strcmp(text, names[i])) {
            *out = i;
            return GW_OK;
        }
    return fail(at, key, "one of its names");
}

static gw_code take_name(const reader *at, const json_t *object, const gw_layout *layout, char out[32]) {
    const char *text = json_string_value(json_object_get(object, "name"));
    const size_t length = text ? strlen(text) : 0;
    int good = length >= 1 && length <= 31 &&
               strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") == length;
    for (uint32_t i = 0; i < layout->tile_count && good; i++)
        good = strcmp(layout->tiles[i].name, text) != 0;
    if (!good)
        return fail(at, "name", "1 to 31 letters, digits, '-' and '_', each once");
    memcpy(out, text, length + 1);
    return GW_OK;
}

static gw_code take_tile(const reader *at, const json_t *object, gw_site *site) {
    enum { FURTHEST = 1 << 24 };
    gw_layout *layout = &site->layout;
    gw_tile *tile = &layout->tiles[layout->tile_count];
    int64_t r[4] = {0, 0, 0, 0};
    gw_code code = take_name(at, object, layout, tile->name);
    if (!code)
        code = take_reals(at, object, "corner", 3, tile->plane.corner);
    if (!code)
        code = take_reals(at, object, "step_x", 3, tile->plane.step_x);
    if (!code)
        code = take_reals(at, object, "step_y", 3, tile->plane.step_y);
    if (!code)
        code = take_integers(at, object, "rectangle", 4, -FURTHEST, FURTHEST, r);
    if (!code)
        code = take_pair(at, object, "picture", tile->picture);
    if (!code)
        code = take_pair(at, object, "framed", tile->framed);
    if (!code)
        code = take_choice(at, object, "stereo", gw_stereo_names, GW_STEREO_COUNT,
                           &site->panels[layout->tile_count].stereo);
    if (code)
        return code;
    if (r[2] < 1 || r[3] < 1 || r[2] > GW_MAXIMUM_WALL_SIDE || r[3] > GW_MAXIMUM_WALL_SIDE ||
        tile->picture[0] + r[2] > layout->picture[0] || tile->picture[1] + r[3] > layout->picture[1] ||
        tile->framed[0] + r[2] > layout->framed[0] || tile->framed[1] + r[3] > layout->framed[1])
        return fail(at, "rectangle", "inside the wall's pictures");
    tile->rectangle = (gw_rectangle){
        .x = (int32_t)r[0], .y = (int32_t)r[1], .width = (uint32_t)r[2], .height = (uint32_t)r[3]};
    layout->tile_count++;
    return GW_OK;
}

static gw_code take_site(const reader *at, const json_t *object, gw_site *site) {
    gw_layout *layout = &site->layout;
    gw_code code = take_pair(at, object, "picture", layout->picture);
    gw_site_defaults(site);
    if (!code)
        code = take_pair(at, object, "framed", layout->framed);
    if (!code)
        code = take_reals(at, object, "size", 2, layout->size);
    if (!code)
        code = take_reals(at, object, "centre", 3, layout->centre);
    if (!code)
        code = take_reals(at, object, "eye", 3, layout->eye);
    if (code)
        return code;
    const json_t *tiles = json_object_get(object, "tiles");
    const size_t count = json_array_size(tiles);
    if (count < 1 || count > GW_MAXIMUM_TILES || !(layout->size[0] > 0 && layout->size[1] > 0))
        return fail(at, "tiles", "a list of 1 to 64 tiles on a wall of some size");
    for (size_t i = 0; i < count && !code; i++)
        code = take_tile(at, json_array_get(tiles, i), site);
    return code;
}

static gw_code take_settings(const reader *at, const json_t *object, gw_settings *settings) {
    gw_settings_init(settings);
    for (size_t i = 0; i < gw_setting_count; i++) {
        const char *name = gw_setting_rows[i].name;
        const char *value = json_string_value(json_object_get(object, name));
        char assignment[256];
        if (!value || strlen(value) > 64)
            return gw_fail(at->error, GW_BAD_INPUT,
                           "%s: setting '%s' is missing; the picture was made by another version", at->path,
                           name);
        snprintf(assignment, sizeof assignment, "%.150s=%.64s", name, value);
        gw_code code = gw_settings_assign(settings, assignment, at->error);
        if (code)
            return gw_context(at->error, "%s", at->path);
    }
    return GW_OK;
}

static gw_code take_effects(const reader *at, const json_t *object, gw_side_car *out) {
    const json_t *forced = json_object_get(object, "forced"),
                 *forbidden = json_object_get(object, "forbidden");
    const int64_t bits[2] = {json_integer_value(forced), json_integer_value(forbidden)};
    if (!json_is_integer(forced) || !json_is_integer(forbidden) || bits[0] < 0 || bits[1] < 0 ||
        (bits[0] & bits[1]))
        return fail(at, "effects", "two sets of effects, none in both");
    out->force_effects = (gw_features)bits[0];
    out->forbid_effects = (gw_features)bits[1];
    return GW_OK;
}

static gw_code take_all(const reader *at, const json_t *root, gw_side_car *out) {
    const json_t *scene = json_object_get(root, "scene");
    uint32_t pattern = 0;
    if (json_integer_value(json_object_get(root, "gazewall_picture")) != VERSION)
        return gw_fail(at->error, GW_BAD_INPUT,
                       "%s is no side-car of a picture: it lacks \"gazewall_picture\": %d", at->path,
                       VERSION);
    gw_code code = take_hash(at, json_object_get(root, "image"), out->image_hash);
    if (!code)
        code = take_choice(at, root, "pattern", gw_pattern_names, GW_PATTERN_COUNT, &pattern);
    out->pattern = (gw_pattern_kind)pattern;
    if (!code)
        code = take_text(at, scene, "file", &out->scene);
    if (!code)
        code = take_text(at, scene, "animation", &out->animation);
    if (!code)
        code = take_hash(at, scene, out->scene_hash);
    if (!code)
        code = take_effects(at, json_object_get(root, "effects"), out);
    if (!code)
        code = take_settings(at, json_object_get(root, "settings"), &out->settings);
    if (!code)
        code = gw_state_take(json_object_get(root, "state"), at->path, 1, &out->state, at->error);
    return code ? code : take_site(at, json_object_get(root, "site"), &out->site);
}

gw_code gw_side_car_read(const char *path, gw_side_car *out, gw_error *error) {
    const reader at = {path, error};
    gw_bytes bytes = {0};
    json_error_t where;
    memset(out, 0, sizeof *out);
    gw_code code = gw_file_read(path, MOST_BYTES, &bytes, error);
    json_t *root =
        code ? NULL : json_loadb((const char *)bytes.data, bytes.size, JSON_REJECT_DUPLICATES, &where);
    if (!code && !json_is_object(root))
        code = gw_fail(error, GW_BAD_INPUT, "%s:%d: not a JSON object: %s", path, where.line, where.text);
    if (!code)
        code = take_all(&at, root, out);
    json_decref(root);
    gw_bytes_finish(&bytes);
    return code;
}

void gw_side_car_finish(gw_side_car *side_car) {
    free(side_car->scene);
    free(side_car->animation);
    memset(side_car, 0, sizeof *side_car);
}

gw_code gw_side_car_check_scene(const gw_side_car *side_car, const gw_scene *scene, gw_error *error) {
    char hash[33];
    gw_hash_text(scene->hash, hash);
    if (!side_car->scene_hash[0] || !strcmp(hash, side_car->scene_hash))
        return GW_OK;
    return gw_fail(
        error, GW_BAD_INPUT,
        "scene %s is not the one that the picture was made from: its content's hash is %s and was %s; "
        "name the file as it was then with --scene",
        scene->path ? scene->path : "(demo)", hash, side_car->scene_hash);
}
