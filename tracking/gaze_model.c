#include "tracking/gaze_model.h"

#include "base/portable_math.h"
#include "tracking/quaternion.h"

#include <math.h>
#include <string.h>

static const double DEGREES = 180 / GW_PI;
/* 95 of 100 of a normal distribution in a plane are within sqrt(-2 ln 0.05) standard deviations. */
static const double MOST = 2.4477468306808161;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static int normalise(double v[3]) {
    const double length = sqrt(dot(v, v));
    if (!(length > 1e-9 && length < 1e150))
        return 0;
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return 1;
}

/* --- gazes
 * ---------------------------------------------------------------------------------------------------- */

void gw_head_of_pose(const gw_tracker_setup *setup, uint32_t viewer, const double position[3],
                     const double orientation[4], gw_head *out) {
    const gw_tracker_viewer *whose = &setup->viewers[viewer];
    double turned[4];
    gw_room_pose(&setup->sources[whose->source].room, position, orientation, out->sensor, turned);
    gw_tracker_eye(whose, out->sensor, turned, out->eye, out->orientation);
}

void gw_gaze_along(const double orientation[4], double out_direction[3]) {
    gw_turn_vector(orientation, (const double[3]){0, 0, -1}, out_direction);
}

int gw_gaze_is_open(const gw_tracking_event *event) {
    return event->kind == GW_EVENT_GAZE && event->quality >= 0 && event->of.gaze.openness >= GW_GAZE_OPEN;
}

int gw_gaze_of_event(const gw_tracking_event *event, const gw_room *room, const gw_head *head,
                     gw_gaze_line *out) {
    const int in_head = event->of.gaze.frame == GW_GAZE_IN_HEAD;
    if (in_head && !head)
        return 0;
    out->has_origin = head || event->of.gaze.has_origin;
    if (head)
        memcpy(out->origin, head->eye, sizeof out->origin);
    if (in_head) {
        gw_turn_vector(head->orientation, event->of.gaze.direction, out->direction);
        if (event->of.gaze.has_origin) {
            gw_turn_vector(head->orientation, event->of.gaze.origin, out->origin);
            for (int i = 0; i < 3; i++)
                out->origin[i] = head->sensor[i] + room->unit * out->origin[i];
        }
    } else {
        gw_room_direction(room, event->of.gaze.direction, out->direction);
        if (event->of.gaze.has_origin)
            gw_room_position(room, event->of.gaze.origin, out->origin);
    }
    return normalise(out->direction) && out->has_origin;
}

double gw_gaze_widening(double gaze_error, double gaze_margin) {
    return gaze_error > gaze_margin ? gaze_error - gaze_margin : 0;
}

/* --- the wall
 * ------------------------------------------------------------------------------------------------- */

/* Distance along the ray in its direction's lengths; below 0: it does not meet the rectangle. */
static double meeting(const gw_wall_rectangle *wall, const double origin[3], const double direction[3]) {
    double normal[3], away[3], at[3];
    cross(wall->across, wall->down, normal);
    for (int i = 0; i < 3; i++)
        away[i] = wall->corner[i] - origin[i];
    const double t = dot(away, normal) / dot(direction, normal);
    if (!(t > 0 && t < 1e9))
        return -1;
    for (int i = 0; i < 3; i++)
        at[i] = origin[i] + t * direction[i] - wall->corner[i];
    const double u = dot(at, wall->across) / dot(wall->across, wall->across),
                 v = dot(at, wall->down) / dot(wall->down, wall->down);
    return u >= 0 && u <= 1 && v >= 0 && v <= 1 ? t : -1;
}

int32_t gw_gaze_meets(const gw_wall_rectangle *walls, uint32_t count, const double origin[3],
                      const double direction[3], double out_point[3]) {
    int32_t found = -1;
    double nearest = INFINITY;
    for (uint32_t w = 0; w < count; w++) {
        const double t = meeting(&walls[w], origin, direction);
        if (t > 0 && t < nearest) {
            nearest = t;
            found = (int32_t)w;
        }
    }
    for (int i = 0; i < 3 && found >= 0; i++)
        out_point[i] = origin[i] + nearest * direction[i];
    return found;
}

/* --- fixations
 * ------------------------------------------------------------------------------------------------ */

/* Spots as the eye sees them: on the plane at distance 1 across the line of sight. */
typedef struct seen {
    uint32_t count;
    double at[GW_FIXATION_SPOTS][2];
} seen;

typedef struct disk {
    double at[2], square; /* radius, squared; below 0: nothing is in it */
} disk;

static int holds(const disk *d, const double p[2]) {
    const double x = p[0] - d->at[0], y = p[1] - d->at[1];
    return x * x + y * y <= d->square * (1 + 1e-12) + 1e-24;
}

static disk of_two(const double a[2], const double b[2]) {
    const double x = 0.5 * (b[0] - a[0]), y = 0.5 * (b[1] - a[1]);
    return (disk){{a[0] + x, a[1] + y}, x * x + y * y};
}

/* Through three points; of three on a line, the widest pair's. */
static disk of_three(const double a[2], const double b[2], const double c[2]) {
    const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
    const double twice = 2 * (bx * cy - by * cx), bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    if (!(fabs(twice) > 1e-12 * (bb + cc))) {
        const disk pairs[3] = {of_two(a, b), of_two(a, c), of_two(b, c)};
        int widest = 0;
        for (int i = 1; i < 3; i++)
            if (pairs[i].square > pairs[widest].square)
                widest = i;
        return pairs[widest];
    }
    const double x = (cy * bb - by * cc) / twice, y = (bx * cc - cx * bb) / twice;
    return (disk){{a[0] + x, a[1] + y}, x * x + y * y};
}

/* The smallest disk that holds all (Welzl 1991, as nested loops over points in the order given: a point
 * outside the disk so far is on the rim of the one with it). At most 64 points, so order costs nothing. */
static disk smallest_disk(const seen *s) {
    disk d = {{0, 0}, -1};
    for (uint32_t i = 0; i < s->count; i++) {
        if (holds(&d, s->at[i]))
            continue;
        d = of_two(s->at[i], s->at[i]);
        for (uint32_t j = 0; j < i; j++) {
            if (holds(&d, s->at[j]))
                continue;
            d = of_two(s->at[i], s->at[j]);
            for (uint32_t k = 0; k < j; k++)
                if (!holds(&d, s->at[k]))
                    d = of_three(s->at[i], s->at[j], s->at[k]);
        }
    }
    return d;
}

/* Direction from the eye; 0: the spot is none. */
static int sight(const gw_gaze_spot *spot, const double eye[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = spot->point[i] - eye[i];
    return spot->is_open && normalise(out);
}

/* Two unit vectors across `forward` and across each other. */
static void frame_across(const double forward[3], double right[3], double up[3]) {
    const double lead[3] = {0, fabs(forward[1]) < 0.9, fabs(forward[1]) >= 0.9};
    cross(forward, lead, right);
    normalise(right);
    cross(right, forward, up);
}

/* Means, then squares about them, so that nothing cancels. */
static void measure_spread(const seen *s, const double right[3], const double up[3], gw_fixation *out) {
    double mean[2] = {0, 0}, xx = 0, xy = 0, yy = 0;
    for (uint32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 2; k++)
            mean[k] += s->at[i][k] / s->count;
    for (uint32_t i = 0; i < s->count; i++) {
        const double x = s->at[i][0] - mean[0], y = s->at[i][1] - mean[1];
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    const double less = s->count > 1 ? s->count - 1.0 : 1.0;
    const double half = 0.5 * (xx + yy) / less, apart = 0.5 * (xx - yy) / less, both = xy / less;
    const double root = sqrt(apart * apart + both * both);
    out->half_angles[0] = DEGREES * gw_atan2(MOST * sqrt(half + root), 1);
    out->half_angles[1] = DEGREES * gw_atan2(MOST * sqrt(half > root ? half - root : 0), 1);
    const double angle = 0.5 * gw_atan2(both, apart), c = gw_cos(angle), r = gw_sin(angle);
    for (int i = 0; i < 3; i++)
        out->along[i] = c * right[i] + r * up[i];
}

int gw_fixation_of(const gw_gaze_spot *spots, uint32_t count, const double eye[3], gw_fixation *out) {
    seen s = {.count = 0};
    double directions[GW_FIXATION_SPOTS][3], forward[3] = {0, 0, 0}, right[3], up[3];
    memset(out, 0, sizeof *out);
    const uint32_t first = count > GW_FIXATION_SPOTS ? count - GW_FIXATION_SPOTS : 0;
    for (uint32_t i = first; i < count; i++) {
        if (!sight(&spots[i], eye, directions[out->used])) {
            out->dropped++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            out->point[k] += spots[i].point[k];
            forward[k] += directions[out->used][k];
        }
        out->used++;
    }
    if (out->used == 0 || !normalise(forward))
        return 0;
    for (int k = 0; k < 3; k++)
        out->point[k] /= out->used;
    frame_across(forward, right, up);
    for (uint32_t i = 0; i < out->used; i++) {
        const double ahead = fmax(0.05, dot(directions[i], forward)); /* beside or behind: 87 degrees away */
        s.at[i][0] = dot(directions[i], right) / ahead;
        s.at[i][1] = dot(directions[i], up) / ahead;
    }
    s.count = out->used;
    measure_spread(&s, right, up, out);
    out->disk = DEGREES * gw_atan2(sqrt(smallest_disk(&s).square), 1);
    out->is_fixation = out->disk < GW_FIXATION_DISK;
    return 1;
}
