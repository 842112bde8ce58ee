/* Axis maps, units, turn and shift. */
#include "tracking/room.h"

#include "tracking/quaternion.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* The largest room (mm) and the nearest that a head comes to a device's origin for long. */
static const double FAR = 50000, NEAR = 20;
enum { ENOUGH = 10 };

static const struct {
    const char *name;
    double millimetres;
} units[] = {{"m", 1000}, {"mm", 1}, {"cm", 10}, {"inch", 25.4}, {"ft", 304.8}};
enum { UNITS = sizeof units / sizeof *units };

static const struct {
    const char *name, *text;
} frames[] = {{"y-up", "x y z"}, {"z-up", "x z -y"}, {"unity", "x y -z"}, {"unreal", "y z -x"}};
enum { FRAMES = sizeof frames / sizeof *frames };

gw_axis_map gw_axis_map_at(int index) {
    static const int8_t orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    gw_axis_map map;
    for (int i = 0; i < 3; i++) {
        map.from[i] = orders[index / 8][i];
        map.sign[i] = index >> i & 1 ? -1 : 1;
    }
    return map;
}

/* One axis with its sign, from *at on; NULL where there is none. */
static const char *parse_axis(const char *at, int8_t *from, int8_t *sign) {
    at += strspn(at, " ,\t");
    *sign = *at == '-' ? -1 : 1;
    at += *at == '-' || *at == '+';
    const int letter = tolower((unsigned char)*at);
    if (letter < 'x' || letter > 'z')
        return NULL;
    *from = (int8_t)(letter - 'x');
    return at + 1;
}

gw_code gw_axis_map_parse(const char *text, gw_axis_map *out, gw_error *error) {
    for (int i = 0; i < FRAMES; i++)
        if (!strcmp(text, frames[i].name))
            text = frames[i].text;
    gw_axis_map map;
    const char *at = text;
    int seen = 0;
    for (int i = 0; i < 3 && at; i++) {
        at = parse_axis(at, &map.from[i], &map.sign[i]);
        seen |= at ? 1 << map.from[i] : 0;
    }
    if (!at || at[strspn(at, " ,\t")])
        return gw_fail(
            error, GW_BAD_INPUT,
            "'%.40s' is no axis map; expected the device's axis for each of the wall's x (right), y "
            "(up) and z (to the viewer), as 'x -z y', or y-up, z-up, unity, unreal",
            text);
    if (seen != 7)
        return gw_fail(error, GW_BAD_INPUT,
                       "'%.40s' names an axis twice; each of x, y and z belongs there once, as 'x -z y'",
                       text);
    *out = map;
    return GW_OK;
}

void gw_axis_map_write(const gw_axis_map *map, char out[GW_AXIS_TEXT]) {
    for (int i = 0; i < 3; i++) {
        if (i)
            *out++ = ' ';
        if (map->sign[i] < 0)
            *out++ = '-';
        *out++ = (char)('x' + map->from[i]);
    }
    *out = '\0';
}

int gw_axis_map_hand(const gw_axis_map *map) {
    const int even = (map->from[0] + 1) % 3 == map->from[1];
    return (even ? 1 : -1) * map->sign[0] * map->sign[1] * map->sign[2];
}

void gw_axis_map_apply(const gw_axis_map *map, const double in[3], double out[3]) {
    const double v[3] = {in[0], in[1], in[2]};
    for (int i = 0; i < 3; i++)
        out[i] = map->sign[i] * v[map->from[i]];
}

void gw_room_default(double unit, gw_room *out) {
    memset(out, 0, sizeof *out);
    out->unit = unit;
    out->axes = gw_axis_map_at(0);
    out->turn[3] = 1;
}

void gw_room_direction(const gw_room *room, const double direction[3], double out[3]) {
    gw_axis_map_apply(&room->axes, direction, out);
    gw_turn_vector(room->turn, out, out);
}

void gw_room_position(const gw_room *room, const double position[3], double out_mm[3]) {
    gw_room_direction(room, position, out_mm);
    for (int i = 0; i < 3; i++)
        out_mm[i] = room->unit * out_mm[i] + room->shift[i];
}

int gw_room_equal(const gw_room *a, const gw_room *b) {
    return a->unit == b->unit && memcmp(&a->axes, &b->axes, sizeof a->axes) == 0 &&
           memcmp(a->turn, b->turn, sizeof a->turn) == 0 && memcmp(a->shift, b->shift, sizeof a->shift) == 0;
}

void gw_room_pose(const gw_room *room, const double position[3], const double orientation[4],
                  double out_position_mm[3], double out_orientation[4]) {
    double mapped[4];
    const int hand = gw_axis_map_hand(&room->axes);
    gw_axis_map_apply(&room->axes, orientation, mapped);
    for (int i = 0; i < 3; i++)
        mapped[i] *= hand;
    mapped[3] = orientation[3];
    gw_turn_after(room->turn, mapped, out_orientation);
    gw_room_position(room, position, out_position_mm);
}

double gw_room_unit(const char *name) {
    for (int i = 0; i < UNITS; i++)
        if (!strcmp(name, units[i].name))
            return units[i].millimetres;
    return 0;
}

const char *gw_room_unit_name(double unit) {
    for (int i = 0; i < UNITS; i++)
        if (unit == units[i].millimetres)
            return units[i].name;
    return NULL;
}

void gw_room_watch(gw_room_sanity *sanity, const gw_room *room, const double position[3]) {
    const double away =
        room->unit * sqrt(position[0] * position[0] + position[1] * position[1] + position[2] * position[2]);
    sanity->positions++;
    sanity->far += away > FAR;
    sanity->near += away < NEAR;
    if (away > sanity->farthest)
        sanity->farthest = away;
}

int gw_room_suspect(const gw_room_sanity *sanity, const gw_room *room, char *text, size_t size) {
    const int far = sanity->far > sanity->positions / 2, near = sanity->near > sanity->positions / 2;
    if (sanity->positions < ENOUGH || (!far && !near))
        return 0;
    const double raw = sanity->farthest / room->unit; /* in units of the device */
    const char *unit = gw_room_unit_name(room->unit), *better = NULL;
    for (int i = 0; i < UNITS && !better; i++)
        if (raw * units[i].millimetres > 300 && raw * units[i].millimetres < 10000)
            better = units[i].name;
    snprintf(text, size,
             "%llu of %llu positions are %s the device's origin with a unit of %g mm%s%s%s; is it %s?",
             (unsigned long long)(far ? sanity->far : sanity->near), (unsigned long long)sanity->positions,
             far ? "more than 50 m from" : "less than 20 mm from", room->unit, unit ? " (" : "",
             unit ? unit : "", unit ? ")" : "", better ? better : "another one");
    return 1;
}
