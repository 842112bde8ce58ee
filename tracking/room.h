/* From the numbers of a tracking source to wall space (millimetres, right-handed, x to the right, y up, z
 * from the wall to the viewer). Two of the three named transforms of a tracker; the third, from a sensor to
 * the eye behind it, belongs to a viewer (tracking/setup.h).
 *
 *   axis map and unit:  m = unit * A p      A moves the device's axes to wall axes, with signs
 *   device to room:     wall = turn m turn* + shift
 *
 * A is one of 48 signed permutations, 24 of which turn a left-handed source into a right-handed one. Of an
 * orientation R (source axes onto the sensor's) comes turn A R A', a rotation whatever A's hand: the sensor's
 * own axes are renamed as the device's are. For a quaternion (u, w) that is (det(A) A u, w): a rotation by t
 * about n, seen in a mirror, is one by -t about the mirrored n. So left-handed sources are handled, not
 * refused. Values; any thread; the same bits on every machine. */
#ifndef GW_TRACKING_ROOM_H
#define GW_TRACKING_ROOM_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* Wall axis i is sign[i] times device axis from[i]. */
typedef struct gw_axis_map {
    int8_t from[3]; /* 0 to 2, each once */
    int8_t sign[3]; /* 1 or -1 */
} gw_axis_map;

enum { GW_AXIS_MAPS = 48, GW_AXIS_TEXT = 12 };

/* By number, 0 ("x y z") to GW_AXIS_MAPS - 1. */
gw_axis_map gw_axis_map_at(int index);
/* "x -z y": wall x is device x, wall y is minus device z, wall z is device y. Or the name of a usual frame:
 * y-up ("x y z", as here), z-up ("x z -y"), unity ("x y -z", left-handed), unreal ("y z -x", left-handed). */
gw_code gw_axis_map_parse(const char *text, gw_axis_map *out, gw_error *error);
void gw_axis_map_write(const gw_axis_map *map, char out[GW_AXIS_TEXT]);
int gw_axis_map_hand(const gw_axis_map *map); /* 1: the device is right-handed; -1: left-handed */
void gw_axis_map_apply(const gw_axis_map *map, const double in[3], double out[3]);

typedef struct gw_room {
    double unit;      /* mm per unit of the device, above 0 */
    gw_axis_map axes; /* device axes to wall axes */
    double turn[4];   /* unit quaternion x, y, z, w: device to room, after the axis map */
    double shift[3];  /* mm: where the device's origin is in wall space */
} gw_room;

/* Wall axes and origin. */
void gw_room_default(double unit, gw_room *out);

int gw_room_equal(const gw_room *a, const gw_room *b);

/* A pose of a sensor. out may be the inputs. */
void gw_room_pose(const gw_room *room, const double position[3], const double orientation[4],
                  double out_position_mm[3], double out_orientation[4]);
void gw_room_position(const gw_room *room, const double position[3], double out_mm[3]);
void gw_room_direction(const gw_room *room, const double direction[3], double out[3]);

/* The millimetres of a usual unit (m, mm, cm, inch, ft), or 0; and its name, or NULL, for so many mm. */
double gw_room_unit(const char *name);
const char *gw_room_unit_name(double unit);

/* Whether positions can be those of heads: a head 1700 metres away has been told in millimetres. */
typedef struct gw_room_sanity {
    uint64_t positions, far, near;
    double farthest; /* mm from the device's origin */
} gw_room_sanity;

void gw_room_watch(gw_room_sanity *sanity, const gw_room *room, const double position[3]); /* device units */
/* 1 and a sentence, once enough positions (10) say that the unit is probably another; else 0. */
int gw_room_suspect(const gw_room_sanity *sanity, const gw_room *room, char *text, size_t size);

#endif
