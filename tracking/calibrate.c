#include "tracking/calibrate.h"

#include "tracking/quaternion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double DEGREES = 57.29577951308232;

/* Below this, residuals are no smaller in truth: what a tape measure and a sensor held by hand can do. */
static const double LEAST_ERROR = 0.3; /* mm */
/* Of an F test with 3 or 1 and some ten degrees of freedom: about 1 in 50 is refused wrongly. */
static const double SNAP_F = 4;
static const double SNAP_TURN = 1, SNAP_UNIT = 0.01; /* degrees and relative: beyond, nothing is snapped */
/* A point is bad that is this many standard errors, and mm, from where the others put it. */
static const double BAD_ERRORS = 6, BAD_DISTANCE = 10;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Eigenvalues and -vectors (columns of v) of a symmetric matrix, by Jacobi's rotations (Golub and Van Loan,
 * 8.5): for a matrix of 4 they are small within six sweeps. */
static void jacobi(int n, double a[4][4], double v[4][4]) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            v[i][j] = i == j;
    for (int sweep = 0; sweep < 30; sweep++)
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                if (a[p][q] == 0)
                    continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                const double c = 1 / sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < n; k++) {
                    const double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (int k = 0; k < n; k++) {
                    const double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                    const double z = v[k][p], w = v[k][q];
                    v[k][p] = c * z - s * w;
                    v[k][q] = s * z + c * w;
                }
            }
}

/* A set of points, and their sums. */
typedef struct problem {
    const gw_calibration_point *points;
    uint32_t count, used;
    uint64_t skipped;      /* bit i: not point i */
    double middle[2][3];   /* of device and wall */
    double products[3][3]; /* sum of device times wall, about the middles */
    double squares[2];     /* sums of squares of device and wall, about the middles */
} problem;

static int is_skipped(const problem *p, uint32_t i) {
    return (int)(p->skipped >> i & 1);
}

static void gather(problem *p) {
    memset(p->middle, 0, sizeof p->middle);
    memset(p->products, 0, sizeof p->products);
    p->squares[0] = p->squares[1] = 0;
    p->used = 0;
    for (uint32_t i = 0; i < p->count; i++)
        p->used += !is_skipped(p, i);
    for (uint32_t i = 0; i < p->count; i++)
        for (int k = 0; k < 3 && !is_skipped(p, i); k++) {
            p->middle[0][k] += p->points[i].device[k] / p->used;
            p->middle[1][k] += p->points[i].wall[k] / p->used;
        }
    for (uint32_t i = 0; i < p->count; i++) {
        double d[3], w[3];
        if (is_skipped(p, i))
            continue;
        for (int k = 0; k < 3; k++) {
            d[k] = p->points[i].device[k] - p->middle[0][k];
            w[k] = p->points[i].wall[k] - p->middle[1][k];
        }
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                p->products[a][b] += d[a] * w[b];
        p->squares[0] += dot(d, d);
        p->squares[1] += dot(w, w);
    }
}

/* A solution: wall = unit * orthogonal(device) + shift, orthogonal = turn after map. */
typedef struct solution {
    gw_room room;
    double squares; /* sum of squared residuals, mm2 */
} solution;

/* The rotation that turns device vectors, mapped by `map`, onto wall vectors best. */
static void best_turn(const problem *p, const gw_axis_map *map, double out[4]) {
    double s[3][3], a[4][4], v[4][4];
    for (int i = 0; i < 3; i++)
        for (int b = 0; b < 3; b++)
            s[i][b] = map->sign[i] * p->products[map->from[i]][b];
    a[0][0] = s[0][0] + s[1][1] + s[2][2];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        a[0][i + 1] = a[i + 1][0] = s[j][k] - s[k][j];
        a[i + 1][i + 1] = 2 * s[i][i] - a[0][0];
        a[i + 1][j + 1] = a[j + 1][i + 1] = s[i][j] + s[j][i];
    }
    jacobi(4, a, v);
    int greatest = 0;
    for (int i = 1; i < 4; i++)
        if (a[i][i] > a[greatest][greatest])
            greatest = i;
    for (int i = 0; i < 3; i++)
        out[i] = v[i + 1][greatest];
    out[3] = v[0][greatest];
    if (out[3] < 0)
        for (int i = 0; i < 4; i++)
            out[i] = -out[i];
    gw_turn_normalise(out);
}

/* Shift, and the unit unless it is given (above 0), for the room's axes and turn; then the residuals. */
static void finish(const problem *p, double unit, solution *out) {
    double gain = 0, at[3];
    for (int a = 0; a < 3; a++) {
        double turned[3];
        gw_room_direction(&out->room, (const double[3]){a == 0, a == 1, a == 2}, turned);
        gain += dot(turned, p->products[a]);
    }
    out->room.unit = unit > 0 ? unit : gain / p->squares[0];
    memset(out->room.shift, 0, sizeof out->room.shift);
    gw_room_position(&out->room, p->middle[0], at);
    for (int k = 0; k < 3; k++)
        out->room.shift[k] = p->middle[1][k] - at[k];
    out->squares = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        if (is_skipped(p, i))
            continue;
        gw_room_position(&out->room, p->points[i].device, at);
        for (int k = 0; k < 3; k++)
            out->squares += (at[k] - p->points[i].wall[k]) * (at[k] - p->points[i].wall[k]);
    }
}

/* The axis map of that hand next to turn and map together: what is left to turn is least. */
static void split(const gw_room *room, gw_room *out) {
    double best = -4, columns[3][3];
    const int hand = gw_axis_map_hand(&room->axes);
    for (int a = 0; a < 3; a++)
        gw_room_direction(room, (const double[3]){a == 0, a == 1, a == 2}, columns[a]);
    *out = *room;
    for (int m = 0; m < GW_AXIS_MAPS; m++) {
        const gw_axis_map map = gw_axis_map_at(m);
        double trace = 0;
        for (int i = 0; i < 3; i++)
            trace += map.sign[i] * columns[map.from[i]][i];
        if (gw_axis_map_hand(&map) == hand && trace > best) {
            best = trace;
            out->axes = map;
        }
    }
    /* turn = (turn of the room) (its map) (new map)', whose two maps make a rotation: turns of the axes. */
    double axes[3][3], q[4];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            axes[i][k] = out->axes.sign[i] * columns[out->axes.from[i]][k];
    gw_turn_of_axes(axes, q);
    memcpy(out->turn, q, sizeof q);
}

static void solve(const problem *p, int hand, solution *out) {
    gw_room first;
    gw_room_default(1, &first);
    if (hand < 0)
        for (int i = 0; i < 3; i++)
            first.axes.sign[i] = -1;
    best_turn(p, &first.axes, first.turn);
    split(&first, &out->room);
    finish(p, 0, out);
}

/* The unit variance of a residual's coordinate, mm2, no smaller than anyone can measure. */
static double variance(const problem *p, const solution *s) {
    const double freedom = 3.0 * p->used - 7;
    return fmax(LEAST_ERROR * LEAST_ERROR, freedom > 0 ? s->squares / freedom : 0);
}

/* The better hand; *known: 0 where the points cannot tell. */
static void solve_hands(const problem *p, solution *out, int *known) {
    solution left;
    solve(p, 1, out);
    solve(p, -1, &left);
    const solution *better = left.squares < out->squares ? &left : out;
    *known = fabs(left.squares - out->squares) > 25 * variance(p, better);
    if (*known && better == &left)
        *out = left;
}

/* Deviations along the set's own axes, the greatest first; vectors may be NULL. */
static void deviations(const problem *p, int wall, double out[3]) {
    double a[4][4] = {{0}}, v[4][4];
    for (uint32_t i = 0; i < p->count; i++) {
        const double *at = wall ? p->points[i].wall : p->points[i].device;
        for (int j = 0; j < 3 && !is_skipped(p, i); j++)
            for (int k = 0; k < 3; k++)
                a[j][k] += (at[j] - p->middle[wall][j]) * (at[k] - p->middle[wall][k]) / p->used;
    }
    jacobi(3, a, v);
    for (int i = 0; i < 3; i++) {
        out[i] = sqrt(fmax(0, a[i][i]));
        for (int k = i; k > 0 && out[k] > out[k - 1]; k--) {
            const double swap = out[k];
            out[k] = out[k - 1];
            out[k - 1] = swap;
        }
    }
}

static gw_code check_count(uint32_t count, gw_error *error) {
    if (count < 3)
        return gw_fail(
            error, GW_BAD_INPUT,
            "%u points; at least 3 that are not on one line are needed, 4 that are not in one plane "
            "to tell a left-handed device, 6 to find a bad one",
            count);
    if (count > GW_CALIBRATION_POINTS)
        return gw_fail(error, GW_BAD_INPUT, "%u points; at most %d can be used", count,
                       GW_CALIBRATION_POINTS);
    return GW_OK;
}

static gw_code check_points(const problem *p, gw_error *error) {
    double wall[3], device[3];
    deviations(p, 1, wall);
    deviations(p, 0, device);
    if (!(wall[0] > 50))
        return gw_fail(
            error, GW_BAD_INPUT,
            "the marks are within %.3g mm of each other; spread them over the room (are they in mm?)",
            2 * wall[0]);
    if (!(device[0] > 1e-9))
        return gw_fail(error, GW_BAD_INPUT,
                       "the device reported the same position at all marks; is it another sensor?");
    if (!(wall[1] > 0.02 * wall[0] && wall[1] > 20))
        return gw_fail(
            error, GW_BAD_INPUT,
            "the marks are on one line (%.0f mm long, %.1f mm wide): the turn about it is open; put one "
            "beside it",
            2 * wall[0], 2 * wall[1]);
    if (!(device[1] > 0.01 * device[0]))
        return gw_fail(
            error, GW_BAD_INPUT,
            "the device's positions are on one line, but the marks are not; which mark was measured "
            "where?");
    return GW_OK;
}

static double distance(const gw_room *room, const gw_calibration_point *point) {
    double at[3];
    gw_room_position(room, point->device, at);
    for (int k = 0; k < 3; k++)
        at[k] -= point->wall[k];
    return sqrt(dot(at, at));
}

/* The solution without point i, too; 0 where the rest cannot be solved. */
static int solve_without(const problem *p, uint32_t i, problem *rest, solution *out) {
    double wide[3];
    int known;
    *rest = *p;
    rest->skipped |= UINT64_C(1) << i;
    gather(rest);
    deviations(rest, 1, wide);
    if (rest->used < 3 || wide[1] < 20)
        return 0;
    solve_hands(rest, out, &known);
    return 1;
}

/* The point without which the rest fits best is bad, if it is far from where they put it; else -1. */
static int32_t find_bad(const problem *p) {
    double least = INFINITY, away = 0, error = 0;
    int32_t suspect = -1;
    for (uint32_t i = 0; i < p->count; i++) {
        problem rest;
        solution without;
        if (!solve_without(p, i, &rest, &without) || rest.used < 5 || without.squares >= least)
            continue;
        least = without.squares;
        away = distance(&without.room, &p->points[i]);
        error = sqrt(3 * variance(&rest, &without));
        suspect = (int32_t)i;
    }
    return away > BAD_DISTANCE && away > BAD_ERRORS * error ? suspect : -1;
}

/* Degrees of the turn that is left. */
static double angle_of(const double q[4]) {
    return 2 * DEGREES * atan2(sqrt(dot(q, q)), fabs(q[3]));
}

/* Takes `candidate` for *best if the points do not speak against it: `fewer` unknowns were given up. */
static int accept(const problem *p, const solution *candidate, int fewer, solution *best) {
    if (candidate->squares - best->squares > SNAP_F * fewer * variance(p, best))
        return 0;
    *best = *candidate;
    return 1;
}

static void snap_all(const problem *p, solution *best, gw_calibration *out) {
    static const double usual[] = {1000, 1, 10, 25.4, 304.8};
    solution pure = *best;
    double unit = 0;
    memcpy(pure.room.turn, (const double[4]){0, 0, 0, 1}, sizeof pure.room.turn);
    finish(p, 0, &pure);
    if (out->measured_turn <= SNAP_TURN)
        out->turn_snapped = accept(p, &pure, 3, best);
    for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
        if (fabs(best->room.unit / usual[i] - 1) <= SNAP_UNIT)
            unit = usual[i];
    solution round = *best;
    if (unit > 0) {
        finish(p, unit, &round);
        out->unit_snapped = accept(p, &round, 1, best);
    }
}

gw_code gw_calibrate(const gw_calibration_point *points, uint32_t count, int snap, gw_calibration *out,
                     gw_error *error) {
    problem p = {.points = points, .count = count};
    solution best;
    memset(out, 0, sizeof *out);
    gw_code code = check_count(count, error);
    if (!code) {
        gather(&p);
        code = check_points(&p, error);
    }
    if (code)
        return code;
    solve_hands(&p, &best, &out->hand_known);
    out->left_out = find_bad(&p);
    if (out->left_out >= 0) { /* its error may have hidden the hand */
        p.skipped = UINT64_C(1) << out->left_out;
        gather(&p);
        solve_hands(&p, &best, &out->hand_known);
    }
    if (!(best.room.unit > 0))
        return gw_fail(
            error, GW_BAD_INPUT,
            "no unit above 0 fits; the device's positions have nothing to do with the marks: which was "
            "measured where?");
    deviations(&p, 1, out->spread);
    out->measured_unit = best.room.unit;
    out->measured_turn = angle_of(best.room.turn);
    if (snap)
        snap_all(&p, &best, out);
    out->room = best.room;
    out->rms = sqrt(best.squares / p.used);
    out->expected = sqrt(3 * variance(&p, &best) / p.used);
    out->expected_turn = DEGREES * sqrt(variance(&p, &best) / p.used) / hypot(out->spread[1], out->spread[2]);
    for (uint32_t i = 0; i < count; i++) {
        problem rest;
        solution without;
        out->residuals[i] = distance(&best.room, &points[i]);
        out->alone[i] = solve_without(&p, i, &rest, &without) ? distance(&without.room, &points[i]) : -1;
    }
    return GW_OK;
}

void gw_mark_of(double (*samples)[3], uint32_t count, gw_mark *out) {
    double squares = 0;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < count; i++) {
        if (!isfinite(samples[i][0] + samples[i][1] + samples[i][2]))
            continue;
        out->count++;
        for (int k = 0; k < 3; k++) /* running means: nothing cancels */
            out->mean[k] += (samples[i][k] - out->mean[k]) / out->count;
    }
    for (uint32_t i = 0; i < count; i++) {
        double away[3];
        for (int k = 0; k < 3; k++)
            away[k] = samples[i][k] - out->mean[k];
        const double square = dot(away, away);
        if (!isfinite(square))
            continue;
        squares += square;
        out->farthest = fmax(out->farthest, sqrt(square));
    }
    out->spread = out->count ? sqrt(squares / out->count) : 0;
}

/* --- gaze
 * ----------------------------------------------------------------------------------------------------- */

/* Degrees right and up from the way to the target to the gaze; their length is the angle between both. */
static int gaze_error(const gw_gaze_sample *sample, double out[2]) {
    double way[3], look[3], right[3], up[3];
    for (int i = 0; i < 3; i++)
        way[i] = sample->target[i] - sample->eye[i];
    const double far = sqrt(dot(way, way)), length = sqrt(dot(sample->direction, sample->direction));
    if (!(far > 1e-6 && far < 1e9 && length > 1e-6 && length < 1e9))
        return 0;
    for (int i = 0; i < 3; i++) {
        way[i] /= far;
        look[i] = sample->direction[i] / length;
    }
    /* Right is across the way and wall space's y; of a gaze straight up or down, along x. */
    const double flat = sqrt(way[0] * way[0] + way[2] * way[2]);
    right[0] = flat > 1e-3 ? -way[2] / flat : 1;
    right[1] = 0;
    right[2] = flat > 1e-3 ? way[0] / flat : 0;
    up[0] = right[1] * way[2] - right[2] * way[1];
    up[1] = right[2] * way[0] - right[0] * way[2];
    up[2] = right[0] * way[1] - right[1] * way[0];
    const double x = dot(look, right), y = dot(look, up), across = sqrt(x * x + y * y);
    const double angle = DEGREES * atan2(across, dot(look, way));
    out[0] = across > 0 ? angle * x / across : angle;
    out[1] = across > 0 ? angle * y / across : 0;
    return 1;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int gw_gaze_check_of(const gw_gaze_sample *samples, uint32_t count, gw_gaze_check *out) {
    memset(out, 0, sizeof *out);
    double *sizes = malloc((count + !count) * sizeof *sizes), squares[2] = {0, 0}, error[2];
    if (!sizes)
        return 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!gaze_error(&samples[i], error)) {
            out->dropped++;
            continue;
        }
        sizes[out->used++] = sqrt(error[0] * error[0] + error[1] * error[1]);
        for (int k = 0; k < 2; k++) { /* Welford 1962 */
            const double before = error[k] - out->bias[k];
            out->bias[k] += before / out->used;
            squares[k] += before * (error[k] - out->bias[k]);
        }
    }
    if (out->used) {
        qsort(sizes, out->used, sizeof *sizes, by_size);
        out->median = sizes[(out->used - 1) / 2];
        out->most = sizes[(uint32_t)ceil(0.95 * out->used) - 1];
    }
    for (int k = 0; k < 2 && out->used > 1; k++)
        out->spread[k] = sqrt(squares[k] / (out->used - 1));
    free(sizes);
    return out->used > 0;
}
