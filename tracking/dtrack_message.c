#include "tracking/dtrack_message.h"

#include "tracking/decimal.h"
#include "tracking/quaternion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int64_t DAY = INT64_C(86400) * 1000000000;
static const double FARTHEST = 1e9; /* mm; beyond it a number is no place in a room */

/* --- orientation */

int gw_dtrack_orientation(const double b[9], double q[4]) {
    /* Columns of a rotation have length 1 and a right-handed order; 6 decimals keep that within 1e-5. */
    const double x = b[0] * b[0] + b[1] * b[1] + b[2] * b[2], y = b[3] * b[3] + b[4] * b[4] + b[5] * b[5],
                 z = b[6] * b[6] + b[7] * b[7] + b[8] * b[8];
    const double determinant = b[0] * (b[4] * b[8] - b[5] * b[7]) - b[3] * (b[1] * b[8] - b[2] * b[7]) +
                               b[6] * (b[1] * b[5] - b[2] * b[4]);
    if (!(fabs(x - 1) < 0.02 && fabs(y - 1) < 0.02 && fabs(z - 1) < 0.02 && fabs(determinant - 1) < 0.02))
        return 0;
    /* Of the four forms the one whose root is largest. */
    const double trace = b[0] + b[4] + b[8];
    if (trace >= b[0] && trace >= b[4] && trace >= b[8]) {
        q[0] = b[5] - b[7];
        q[1] = b[6] - b[2];
        q[2] = b[1] - b[3];
        q[3] = 1 + trace;
    } else if (b[0] >= b[4] && b[0] >= b[8]) {
        q[0] = 1 + b[0] - b[4] - b[8];
        q[1] = b[1] + b[3];
        q[2] = b[2] + b[6];
        q[3] = b[5] - b[7];
    } else if (b[4] >= b[8]) {
        q[0] = b[1] + b[3];
        q[1] = 1 + b[4] - b[0] - b[8];
        q[2] = b[5] + b[7];
        q[3] = b[6] - b[2];
    } else {
        q[0] = b[2] + b[6];
        q[1] = b[5] + b[7];
        q[2] = 1 + b[8] - b[0] - b[4];
        q[3] = b[1] - b[3];
    }
    for (int i = 0; q[3] < 0 && i < 4; i++)
        q[i] = -q[i]; /* the same turn */
    return gw_turn_normalise(q);
}

void gw_dtrack_matrix(const double q[4], double matrix[9]) {
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int column = 0; column < 3; column++)
        gw_turn_vector(q, axes[column], matrix + 3 * column);
}

int64_t gw_dtrack_unix_time(int64_t day_time, int64_t near) {
    const int64_t day = near / DAY;
    int64_t best = INT64_MIN;
    for (int64_t d = day - 1; d <= day + 1; d++) {
        const int64_t time = d * DAY + day_time;
        if (best == INT64_MIN || llabs(time - near) < llabs(best - near))
            best = time;
    }
    return best;
}

/* --- reading */

typedef struct text_line {
    const char *at, *end;
} text_line;

static void skip_blanks(text_line *line) {
    while (line->at < line->end && (*line->at == ' ' || *line->at == '\t'))
        line->at++;
}

static int take_number(text_line *line, double *out) {
    skip_blanks(line);
    const char *before = line->at;
    if (!gw_decimal_read(&line->at, line->end, out))
        return 0;
    if (line->at == line->end || *line->at == ' ' || *line->at == '\t' || *line->at == '[' ||
        *line->at == ']')
        return 1;
    line->at = before; /* "1,5" and "1x" are no numbers */
    return 0;
}

static int take_count(text_line *line, uint32_t *out) {
    double value;
    if (!take_number(line, &value) || !(value >= 0 && value <= UINT32_MAX) || value != floor(value))
        return 0;
    *out = (uint32_t)value;
    return 1;
}

/* "[" numbers "]": the first `room` of them, and how many there are. -1: it is no block. */
static int take_block(text_line *line, double *numbers, int room) {
    double passed;
    int count = 0;
    skip_blanks(line);
    if (line->at == line->end || *line->at != '[')
        return -1;
    line->at++;
    for (;; count++) {
        skip_blanks(line);
        if (line->at < line->end && *line->at == ']')
            break;
        if (!take_number(line, count < room ? &numbers[count] : &passed))
            return -1;
    }
    line->at++;
    return count;
}

/* The blocks with position and matrix, after the one that says who and how well. -1: they break the grammar.
 */
static int take_pose(text_line *line, int tracked, gw_dtrack_pose *out, gw_dtrack_frame *frame) {
    double place[3], matrix[9];
    int zero = 1;
    if (take_block(line, place, 3) < 3 || take_block(line, matrix, 9) < 9)
        return -1;
    for (int i = 0; i < 9; i++)
        zero &= matrix[i] == 0;
    memset(out, 0, sizeof *out);
    out->listed = 1;
    if (!tracked || zero)
        return 0;
    for (int i = 0; i < 3; i++)
        if (!(fabs(place[i]) <= FARTHEST))
            tracked = 0;
    if (!tracked || !gw_dtrack_orientation(matrix, out->orientation)) {
        frame->not_finite++;
        return 0;
    }
    memcpy(out->position, place, sizeof place);
    out->tracked = 1;
    return 0;
}

static int is_id(double value, int limit) {
    return value >= 0 && value < limit && value == floor(value);
}

/* 6d: [id qu]; 6di: [id state drift]. */
static int take_body(text_line *line, int hybrid, gw_dtrack_frame *frame) {
    double head[2];
    gw_dtrack_pose pose;
    if (take_block(line, head, 2) < 2)
        return -1;
    const int tracked = hybrid ? head[1] > 0 : head[1] >= 0;
    if (take_pose(line, tracked, &pose, frame))
        return -1;
    if (!is_id(head[0], GW_DTRACK_BODIES)) {
        frame->malformed++;
        return 0;
    }
    const int id = (int)head[0];
    frame->bodies[id] = pose;
    frame->body_count = id >= frame->body_count ? id + 1 : frame->body_count;
    return 0;
}

static int take_bodies(text_line *line, int hybrid, gw_dtrack_frame *frame) {
    uint32_t count;
    if (!take_count(line, &count))
        return -1;
    frame->has_bodies = 1;
    for (uint32_t i = 0; i < count; i++)
        if (take_body(line, hybrid, frame))
            return -1;
    return 0;
}

/* The last block: buttons, 32 to a number, then axes. */
static int take_controls(text_line *line, double buttons, double axes, gw_dtrack_flystick *out) {
    double numbers[GW_DTRACK_AXES + 4];
    const int words = (int)((buttons + 31) / 32), room = (int)(sizeof numbers / sizeof numbers[0]);
    const int count = take_block(line, numbers, room);
    if (count < words + (int)axes)
        return -1;
    for (int i = 0; i < words && i < room; i++)
        if (!(numbers[i] >= INT32_MIN && numbers[i] <= UINT32_MAX))
            return -1;
    out->button_count = (int)fmin(buttons, GW_DTRACK_BUTTONS);
    out->buttons = words > 0 ? (uint32_t)(int64_t)numbers[0] : 0;
    if (out->button_count < 32)
        out->buttons &= (1u << out->button_count) - 1;
    for (int i = 0; i < (int)axes && i < GW_DTRACK_AXES && words + i < room; i++)
        out->axes[out->axis_count++] = numbers[words + i];
    return 0;
}

/* 6df2: [id qu buttons axes][place][matrix][controls]; the old 6df: [id qu mask][place and angles][matrix].
 */
static int take_flystick(text_line *line, int old, gw_dtrack_frame *frame) {
    double head[4] = {0};
    gw_dtrack_flystick made;
    memset(&made, 0, sizeof made);
    if (take_block(line, head, 4) < (old ? 3 : 4) || take_pose(line, head[1] >= 0, &made.pose, frame))
        return -1;
    if (old) {
        made.button_count = 8;
        made.buttons = head[2] >= 0 && head[2] <= 255 ? (uint32_t)head[2] : 0;
        made.axis_count = 2; /* its hat, which the vendor's readers take for a joystick */
        made.axes[0] = made.buttons & 0x20 ? -1 : made.buttons & 0x80 ? 1 : 0;
        made.axes[1] = made.buttons & 0x10 ? -1 : made.buttons & 0x40 ? 1 : 0;
    } else if (!is_id(head[2], 129) || !is_id(head[3], 129) || take_controls(line, head[2], head[3], &made))
        return -1;
    if (is_id(head[0], GW_DTRACK_FLYSTICKS))
        frame->flysticks[(int)head[0]] = made;
    else
        frame->malformed++;
    return 0;
}

static int take_flysticks(text_line *line, int old, gw_dtrack_frame *frame) {
    uint32_t defined, count;
    if (!take_count(line, &defined))
        return -1;
    count = defined;
    if (!old && !take_count(line, &count))
        return -1;
    if (defined > GW_DTRACK_FLYSTICKS)
        frame->malformed++;
    frame->flystick_count = (int)fmin(defined, GW_DTRACK_FLYSTICKS);
    for (uint32_t i = 0; i < count; i++)
        if (take_flystick(line, old, frame))
            return -1;
    return 0;
}

static int take_times(text_line *line, int of_day, gw_dtrack_frame *frame) {
    double seconds, microseconds, latency;
    if (!take_number(line, &seconds) || !(seconds >= 0))
        return -1;
    if (of_day) {
        if (!(seconds < 86401))
            return -1;
        frame->day_time = llround(seconds * 1e9);
        frame->has_day_time = 1;
        return 0;
    }
    if (!take_number(line, &microseconds) || !take_number(line, &latency) || !(seconds < 4e9) ||
        !(microseconds >= 0 && microseconds < 1e6) || !(latency >= 0 && latency < 1e7))
        return -1;
    frame->unix_time = (int64_t)seconds * 1000000000 + (int64_t)microseconds * 1000;
    frame->latency = (int64_t)latency * 1000;
    frame->has_unix_time = 1;
    return 0;
}

/* What older controllers count among the calibrated bodies although it is none. */
typedef struct calibrated {
    int told;
    uint32_t count, others;
} calibrated;

static int take_line(text_line *line, gw_dtrack_frame *frame, calibrated *bodies) {
    char word[8] = "";
    size_t length = 0;
    uint32_t count;
    skip_blanks(line);
    while (line->at < line->end && *line->at != ' ' && *line->at != '\t' && *line->at != '[')
        if (length++ < sizeof word - 1)
            word[length - 1] = *line->at++;
        else
            line->at++;
    if (strcmp(word, "fr") == 0) {
        frame->has_frame = take_count(line, &frame->frame);
        return frame->has_frame ? 0 : -1;
    }
    if (strcmp(word, "ts") == 0 || strcmp(word, "ts2") == 0)
        return take_times(line, word[2] == '\0', frame);
    if (strcmp(word, "6dcal") == 0) {
        bodies->told = take_count(line, &bodies->count);
        return bodies->told ? 0 : -1;
    }
    if (strcmp(word, "6d") == 0 || strcmp(word, "6di") == 0)
        return take_bodies(line, word[2] == 'i', frame);
    if (strcmp(word, "6df") == 0 || strcmp(word, "6df2") == 0) {
        const int old = word[3] == '\0', failed = take_flysticks(line, old, frame);
        bodies->others += old ? (uint32_t)frame->flystick_count : 0;
        return failed;
    }
    if (strcmp(word, "6dmt") == 0 && take_count(line, &count))
        bodies->others += count;
    frame->lines_unknown++;
    return 0;
}

int gw_dtrack_read(const uint8_t *data, size_t size, gw_dtrack_frame *out) {
    const char *at = (const char *)data, *end = at + size;
    calibrated bodies = {0};
    uint32_t lines = 0, wrong = 0;
    memset(out, 0, sizeof *out);
    while (at < end) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        text_line line = {.at = at, .end = stop ? stop : end};
        at = stop ? stop + 1 : end;
        if (line.end > line.at && line.end[-1] == '\r')
            line.end--;
        if (line.end == line.at || (line.end == line.at + 1 && *line.at == '\0'))
            continue; /* some senders end the datagram with a zero */
        lines++;
        if (take_line(&line, out, &bodies))
            wrong++;
    }
    out->malformed += wrong;
    out->calibrated = bodies.told && bodies.count >= bodies.others && bodies.count <= 1024
                          ? (int)(bodies.count - bodies.others)
                          : -1;
    return lines > wrong + out->lines_unknown;
}

/* --- writing */

typedef struct text_end {
    char *text;
    size_t used, room;
    int full;
} text_end;

static void put(text_end *to, const char *text, size_t size) {
    if (to->full || size > to->room - to->used) {
        to->full = 1;
        return;
    }
    memcpy(to->text + to->used, text, size);
    to->used += size;
}

static void put_text(text_end *to, const char *text) {
    put(to, text, strlen(text));
}

static void put_number(text_end *to, double value, int decimals, const char *after) {
    char text[32];
    put(to, text, gw_decimal_write(value, decimals, text));
    put_text(to, after);
}

/* The angles of R = Rx(eta) Ry(theta) Rz(phi), degrees: for readers who want them. */
static void put_angles(text_end *to, const double b[9]) {
    const double degrees = 57.295779513082320877;
    put_number(to, degrees * atan2(-b[7], b[8]), 4, " ");
    put_number(to, degrees * asin(fmax(-1, fmin(1, b[6]))), 4, " ");
    put_number(to, degrees * atan2(-b[3], b[0]), 4, "]");
}

static void put_pose(text_end *to, const gw_dtrack_pose *pose, int angles) {
    double matrix[9] = {0};
    if (pose->tracked)
        gw_dtrack_matrix(pose->orientation, matrix);
    put_text(to, "[");
    for (int i = 0; i < 3; i++)
        put_number(to, pose->tracked ? pose->position[i] : 0, 3, i < 2 || angles ? " " : "]");
    if (angles)
        put_angles(to, matrix);
    put_text(to, "[");
    for (int i = 0; i < 9; i++)
        put_number(to, matrix[i], 6, i < 8 ? " " : "]");
}

static void put_bodies(text_end *to, const gw_dtrack_frame *frame) {
    int count = 0;
    for (int i = 0; i < frame->body_count; i++)
        count += frame->bodies[i].tracked;
    put_text(to, "6d ");
    put_number(to, count, 0, count > 0 ? " " : "");
    for (int i = 0; i < frame->body_count; i++) {
        if (!frame->bodies[i].tracked)
            continue;
        put_text(to, "[");
        put_number(to, i, 0, " 1.000]");
        put_pose(to, &frame->bodies[i], 1);
        put_text(to, --count > 0 ? " " : "");
    }
    put_text(to, "\r\n");
}

static void put_flysticks(text_end *to, const gw_dtrack_frame *frame) {
    put_text(to, "6df2 ");
    put_number(to, frame->flystick_count, 0, " ");
    put_number(to, frame->flystick_count, 0, "");
    for (int i = 0; i < frame->flystick_count; i++) {
        const gw_dtrack_flystick *f = &frame->flysticks[i];
        put_text(to, " [");
        put_number(to, i, 0, f->pose.tracked ? " 1.000 " : " -1.000 ");
        put_number(to, f->button_count, 0, " ");
        put_number(to, f->axis_count, 0, "]");
        put_pose(to, &f->pose, 0);
        put_text(to, "[");
        if (f->button_count > 0)
            put_number(to, f->buttons, 0, f->axis_count > 0 ? " " : "");
        for (int k = 0; k < f->axis_count; k++)
            put_number(to, f->axes[k], 2, k + 1 < f->axis_count ? " " : "");
        put_text(to, "]");
    }
    put_text(to, "\r\n");
}

size_t gw_dtrack_write(const gw_dtrack_frame *frame, char *text, size_t room) {
    text_end to = {.text = text, .room = room};
    put_text(&to, "fr ");
    put_number(&to, frame->frame, 0, "\r\n");
    if (frame->has_unix_time) {
        put_text(&to, "ts2 ");
        put_number(&to, (double)(frame->unix_time / 1000000000), 0, " ");
        put_number(&to, (double)(frame->unix_time % 1000000000 / 1000), 0, " ");
        put_number(&to, (double)(frame->latency / 1000), 0, "\r\n");
    } else if (frame->has_day_time) {
        put_text(&to, "ts ");
        put_number(&to, (double)frame->day_time * 1e-9, 6, "\r\n");
    }
    put_text(&to, "6dcal ");
    put_number(&to, frame->body_count, 0, "\r\n");
    put_bodies(&to, frame);
    if (frame->flystick_count > 0)
        put_flysticks(&to, frame);
    return to.full ? 0 : to.used;
}
