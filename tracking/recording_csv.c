/* Recordings as CSV (docs/tracks.md lists the columns): reading, and the rows that the writer writes. Numbers
 * have a dot whatever the user's locale; quotes as in RFC 4180. Any thread. */
#include "tracking/recording_csv.h"

#include "base/suggest.h"
#include "tracking/recording_builder.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_LIMIT = 4096 };

typedef struct reader {
    gw_recording_builder *builder;
    uint64_t line;                   /* from 1 */
    int columns[GW_CSV_COLUMNS + 1]; /* meaning of each column of the file */
    int column_count;
    char *cells[GW_CSV_COLUMNS]; /* of the row, by meaning; NULL or "": empty */
    char text[LINE_LIMIT + 1];
} reader;

static gw_code fail_cell(const reader *r, gw_csv_column column, const char *wanted, gw_error *error) {
    const char *cell = r->cells[column];
    return gw_fail(error, GW_BAD_INPUT, "%s:%llu: column %s: '%.40s' is not %s", r->builder->recording->name,
                   (unsigned long long)r->line, gw_csv_columns[column], cell != NULL ? cell : "", wanted);
}

/* Splits the line in place. GW_BAD_INPUT when it has more cells than columns or a quote stays open. */
static gw_code split(reader *r, char **cells, int limit, int *count, gw_error *error) {
    const char *name = r->builder->recording->name;
    char *from = r->text, *to = r->text;
    for (*count = 0;; ++*count) {
        if (*count == limit)
            return gw_fail(error, GW_BAD_INPUT, "%s:%llu: more than %d columns", name,
                           (unsigned long long)r->line, limit);
        cells[*count] = to;
        int quoted = *from == '"';
        from += quoted;
        while (*from != '\0' && (quoted || *from != ',')) {
            if (quoted && *from == '"') {
                if (from[1] != '"') {
                    quoted = 0;
                    from++;
                    continue;
                }
                from++;
            }
            *to++ = *from++;
        }
        if (quoted)
            return gw_fail(error, GW_BAD_INPUT, "%s:%llu: a quote is not closed", name,
                           (unsigned long long)r->line);
        const int last = *from == '\0';
        *to++ = '\0';
        from++;
        if (last) {
            ++*count;
            return GW_OK;
        }
    }
}

static gw_code read_head(reader *r, gw_error *error) {
    const char *name = r->builder->recording->name;
    char *cells[GW_CSV_COLUMNS + 1];
    gw_code code = split(r, cells, GW_CSV_COLUMNS, &r->column_count, error);
    int seen[GW_CSV_COLUMNS] = {0};
    for (int i = 0; i < r->column_count && code == GW_OK; i++) {
        int column = 0;
        while (column < GW_CSV_COLUMNS && strcmp(cells[i], gw_csv_columns[column]) != 0)
            column++;
        if (column == GW_CSV_COLUMNS) {
            const char *near = gw_suggest(cells[i], gw_csv_columns, GW_CSV_COLUMNS);
            code = gw_fail(error, GW_BAD_INPUT,
                           "%s:%llu: neither a VRPN log nor CSV with known columns: '%.40s'%s%s%s", name,
                           (unsigned long long)r->line, cells[i], near ? "; did you mean '" : "",
                           near ? near : "", near ? "'?" : " (docs/tracks.md lists them)");
        } else if (seen[column]++) {
            code = gw_fail(error, GW_BAD_INPUT, "%s:%llu: column %s is there twice", name,
                           (unsigned long long)r->line, cells[i]);
        }
        r->columns[i] = column;
    }
    if (code == GW_OK && !seen[GW_CSV_ARRIVAL])
        code = gw_fail(error, GW_BAD_INPUT, "%s:%llu: there is no column arrival_s", name,
                       (unsigned long long)r->line);
    return code;
}

static int is_empty(const reader *r, gw_csv_column column) {
    return r->cells[column] == NULL || r->cells[column][0] == '\0';
}

/* Seconds with up to 9 decimals into nanoseconds, exactly. */
static gw_code read_time(const reader *r, gw_csv_column column, int64_t *out, gw_error *error) {
    enum { MOST_DIGITS = 10 };
    const char *at = r->cells[column];
    const int negative = at != NULL && *at == '-';
    int64_t value = 0, unit = 100000000;
    int digits = 0;
    if (at == NULL)
        at = "";
    for (at += negative; *at >= '0' && *at <= '9'; at++, digits++)
        if (digits < MOST_DIGITS)
            value = value * 10 + (*at - '0');
    int good = digits > 0 && digits <= MOST_DIGITS && value < 2147483648;
    value = good ? value * 1000000000 : 0;
    if (*at == '.')
        for (at++; *at >= '0' && *at <= '9'; at++, unit /= 10)
            value += unit * (*at - '0');
    if (!good || *at != '\0')
        return fail_cell(r, column, "a time in seconds like 1000.016667", error);
    *out = negative ? -value : value;
    return GW_OK;
}

static gw_code read_number(const reader *r, gw_csv_column column, double *out, gw_error *error) {
    char *end = NULL;
    if (!is_empty(r, column) &&
        strspn(r->cells[column], "0123456789+-.eE") == strlen(r->cells[column])) /* no nan, no 0x */
        *out = strtod(r->cells[column], &end);
    return end != NULL && *end == '\0' ? GW_OK : fail_cell(r, column, "a number like -0.25", error);
}

static gw_code read_numbers(const reader *r, gw_csv_column first, int count, double *out, gw_error *error) {
    gw_code code = GW_OK;
    for (int i = 0; i < count && code == GW_OK; i++)
        code = read_number(r, (gw_csv_column)((int)first + i), &out[i], error);
    return code;
}

static gw_code read_flag(const reader *r, int *out, gw_error *error) {
    const char *cell = is_empty(r, GW_CSV_VALUE) ? "" : r->cells[GW_CSV_VALUE];
    *out = strcmp(cell, "1") == 0;
    return *out || strcmp(cell, "0") == 0 ? GW_OK : fail_cell(r, GW_CSV_VALUE, "0 or 1", error);
}

static gw_code read_gaze(const reader *r, gw_tracking_event *event, gw_error *error) {
    const char *frame = is_empty(r, GW_CSV_FRAME) ? "device" : r->cells[GW_CSV_FRAME];
    event->of.gaze.frame = strcmp(frame, "head") == 0 ? GW_GAZE_IN_HEAD : GW_GAZE_IN_DEVICE;
    if (event->of.gaze.frame == GW_GAZE_IN_DEVICE && strcmp(frame, "device") != 0)
        return fail_cell(r, GW_CSV_FRAME, "device or head", error);
    event->of.gaze.openness = 1.0;
    event->of.gaze.has_origin = !is_empty(r, GW_CSV_X) || !is_empty(r, GW_CSV_Y) || !is_empty(r, GW_CSV_Z);
    gw_code code = GW_OK;
    if (!is_empty(r, GW_CSV_OPENNESS))
        code = read_number(r, GW_CSV_OPENNESS, &event->of.gaze.openness, error);
    if (code == GW_OK && event->of.gaze.has_origin)
        code = read_numbers(r, GW_CSV_X, 3, event->of.gaze.origin, error);
    if (code == GW_OK && event->quality >= 0.0)
        code = read_numbers(r, GW_CSV_DX, 3, event->of.gaze.direction, error);
    return code;
}

static gw_code read_values(const reader *r, gw_tracking_event *event, gw_error *error) {
    switch (event->kind) {
    case GW_EVENT_POSE:
        if (event->quality < 0.0)
            return GW_OK; /* the numbers mean nothing */
        gw_code code = read_numbers(r, GW_CSV_X, 3, event->of.pose.position, error);
        return code ? code : read_numbers(r, GW_CSV_QX, 4, event->of.pose.orientation, error);
    case GW_EVENT_GAZE:
        return read_gaze(r, event, error);
    case GW_EVENT_BUTTON:
        return read_flag(r, &event->of.button.pressed, error);
    case GW_EVENT_ANALOG:
        return read_number(r, GW_CSV_VALUE, &event->of.analog.value, error);
    default:
        return read_flag(r, &event->of.link.up, error);
    }
}

static gw_code read_clocks(const reader *r, gw_tracking_event *event, gw_error *error) {
    event->device_time = GW_NO_TIME;
    event->quality = 1.0;
    gw_code code = GW_OK;
    if (!is_empty(r, GW_CSV_DEVICE))
        code = read_time(r, GW_CSV_DEVICE, &event->device_time, error);
    if (code == GW_OK && !is_empty(r, GW_CSV_LATENCY))
        code = read_time(r, GW_CSV_LATENCY, &event->latency, error);
    if (code == GW_OK && !is_empty(r, GW_CSV_QUALITY))
        code = read_number(r, GW_CSV_QUALITY, &event->quality, error);
    if (code == GW_OK && !gw_clocks_are_good(event->device_time, event->latency, event->quality))
        return gw_fail(error, GW_BAD_INPUT,
                       "%s:%llu: a latency is 0 to 1000 s, a quality -1 to 1 (below 0: not tracked)",
                       r->builder->recording->name, (unsigned long long)r->line);
    return code;
}

static gw_code read_sensor(const reader *r, int32_t *out, gw_error *error) {
    if (is_empty(r, GW_CSV_SENSOR))
        return GW_OK;
    char *end;
    const char *cell = r->cells[GW_CSV_SENSOR];
    const long value = strtol(cell, &end, 10);
    *out = (int32_t)value;
    return *cell >= '0' && *cell <= '9' && *end == '\0' && value <= INT32_MAX
               ? GW_OK
               : fail_cell(r, GW_CSV_SENSOR, "a number of a sensor", error);
}

static gw_code read_kind(const reader *r, gw_tracking_event_kind *out, gw_error *error) {
    if (is_empty(r, GW_CSV_KIND))
        return GW_OK;
    for (int kind = 0; kind < 5; kind++)
        if (strcmp(r->cells[GW_CSV_KIND], gw_csv_kinds[kind]) == 0) {
            *out = (gw_tracking_event_kind)kind;
            return GW_OK;
        }
    return fail_cell(r, GW_CSV_KIND, "pose, gaze, button, analog or link", error);
}

static gw_code read_row(reader *r, gw_error *error) {
    char *cells[GW_CSV_COLUMNS];
    int count = 0;
    int64_t time = 0;
    gw_tracking_event event = {.kind = GW_EVENT_POSE};
    gw_code code = split(r, cells, r->column_count, &count, error);
    memset(r->cells, 0, sizeof r->cells);
    for (int i = 0; i < count && code == GW_OK; i++)
        r->cells[r->columns[i]] = cells[i];
    if (code == GW_OK)
        code = read_time(r, GW_CSV_ARRIVAL, &time, error);
    if (code == GW_OK)
        code = read_kind(r, &event.kind, error);
    if (code == GW_OK)
        code = read_sensor(r, &event.sensor, error);
    if (code == GW_OK)
        code = read_clocks(r, &event, error);
    if (code == GW_OK)
        code = read_values(r, &event, error);
    if (code != GW_OK)
        return code;
    if (!gw_event_settle(&event))
        return gw_fail(error, GW_BAD_INPUT,
                       "%s:%llu: not a place and a direction: numbers beyond any room, a zero quaternion or "
                       "direction, or an openness outside 0 to 1",
                       r->builder->recording->name, (unsigned long long)r->line);
    const char *name = is_empty(r, GW_CSV_SENDER) ? "Tracker0" : r->cells[GW_CSV_SENDER];
    if (strlen(name) >= GW_SENDER_NAME)
        return fail_cell(r, GW_CSV_SENDER, "a name of at most 95 characters", error);
    const int32_t sender = gw_builder_sender(r->builder, name, error);
    if (sender == -2)
        return GW_MACHINE;
    if (sender < 0)
        return gw_fail(error, GW_BAD_INPUT, "%s:%llu: more than %d senders", r->builder->recording->name,
                       (unsigned long long)r->line, GW_RECORDING_SENDERS);
    r->builder->recording->counters.used++;
    return gw_builder_event(r->builder, (uint32_t)sender, time, &event, error);
}

/* Copies the next line without its end into r->text. 1: there is one; 0: the end; -1 with the error when it
 * is too long or has a zero byte. *whole is 0 for a last line without a line feed. */
static int next_line(reader *r, size_t *size, int *whole, gw_error *error) {
    const uint8_t *bytes;
    size_t there = gw_byte_stream_peek(r->builder->stream, LINE_LIMIT, &bytes);
    if (there == 0)
        return 0;
    r->line++;
    const uint8_t *end = memchr(bytes, '\n', there);
    *whole = end != NULL;
    *size = end != NULL ? (size_t)(end - bytes) + 1 : there;
    size_t length = *size - (end != NULL);
    length -= length > 0 && bytes[length - 1] == '\r';
    if ((end == NULL && there == LINE_LIMIT) || memchr(bytes, '\0', length) != NULL) {
        gw_fail(error, GW_BAD_INPUT,
                "%s:%llu: neither a VRPN log nor CSV: a line of more than %d characters or "
                "with a zero byte",
                r->builder->recording->name, (unsigned long long)r->line, LINE_LIMIT - 1);
        return -1;
    }
    memcpy(r->text, bytes, length);
    r->text[length] = '\0';
    return 1;
}

/* What the last line of a file that was cut says of it. */
static void note_damage(const reader *r, const char *why) {
    gw_recording_damage *damage = &r->builder->recording->damage;
    *damage = (gw_recording_damage){
        .found = 1, .offset = gw_byte_stream_offset(r->builder->stream), .record = r->line};
    snprintf(damage->text, sizeof damage->text, "%s", why);
}

static gw_code read_lines(reader *r, gw_error *error) {
    gw_recording_counters *counters = &r->builder->recording->counters;
    gw_byte_stream *stream = r->builder->stream;
    size_t size;
    int whole, got;
    while ((got = next_line(r, &size, &whole, error)) > 0) {
        gw_code code = GW_OK;
        if (r->text[0] == '#') {
            counters->texts++;
            counters->records++;
            code = gw_builder_note(r->builder, r->text + 1 + (r->text[1] == ' '), LINE_LIMIT, error);
        } else if (r->text[0] != '\0' && r->column_count == 0) {
            code = read_head(r, error);
        } else if (r->text[0] != '\0') {
            code = read_row(r, error);
            counters->records += code == GW_OK;
        }
        if (code == GW_BAD_INPUT && !whole && r->column_count > 0) {
            const char *problem = gw_byte_stream_problem(stream);
            note_damage(r, problem != NULL ? problem : "a whole line was expected: the file is cut off");
            return GW_OK;
        }
        if (code != GW_OK)
            return code;
        gw_byte_stream_take(stream, size);
    }
    if (got < 0)
        return GW_BAD_INPUT;
    const char *problem = gw_byte_stream_problem(stream);
    if (r->column_count == 0)
        return gw_fail(error, GW_BAD_INPUT, "%s: neither a VRPN log nor CSV: %s", r->builder->recording->name,
                       problem != NULL ? problem : "there is no line of columns");
    r->line++;
    if (problem != NULL)
        note_damage(r, problem);
    return GW_OK;
}

gw_code gw_recording_read_csv(gw_recording_builder *builder, gw_error *error) {
    reader *r = calloc(1, sizeof *r);
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0), before = (locale_t)0;
    gw_code code = GW_MACHINE;
    if (r == NULL || plain == (locale_t)0) {
        gw_fail(error, GW_MACHINE, "out of memory for reading CSV");
    } else {
        r->builder = builder;
        before = uselocale(plain);
        code = read_lines(r, error);
        uselocale(before);
    }
    if (plain != (locale_t)0)
        freelocale(plain);
    free(r);
    return code;
}

size_t gw_csv_put_head(char row[GW_CSV_ROW]) {
    size_t size = 0;
    for (int column = 0; column < GW_CSV_COLUMNS; column++)
        size += (size_t)snprintf(row + size, GW_CSV_ROW - size, "%s%s", column > 0 ? "," : "",
                                 gw_csv_columns[column]);
    row[size++] = '\n';
    return size;
}

/* Nanoseconds as seconds, exactly. */
static size_t put_time(char *to, size_t room, int64_t time) {
    const uint64_t size = time < 0 ? 0 - (uint64_t)time : (uint64_t)time;
    return (size_t)snprintf(to, room, "%s%llu.%09llu,", time < 0 ? "-" : "",
                            (unsigned long long)(size / 1000000000), (unsigned long long)(size % 1000000000));
}

static size_t put_sender(char *to, const char *sender) {
    char *at = to;
    const int quoted = strpbrk(sender, ",\"") != NULL || sender[0] == '#';
    if (quoted)
        *at++ = '"';
    for (; *sender != '\0'; sender++) {
        if (*sender == '"')
            *at++ = '"';
        *at++ = (unsigned char)*sender < ' ' ? ' ' : *sender;
    }
    if (quoted)
        *at++ = '"';
    *at++ = ',';
    return (size_t)(at - to);
}

/* Shortest text that reads back as the same bits is not in C: 17 digits always do. */
static size_t put_numbers(char *to, size_t room, const double *values, int count) {
    size_t size = 0;
    for (int i = 0; i < count; i++)
        size += values != NULL ? (size_t)snprintf(to + size, room - size, "%.17g,", values[i])
                               : (size_t)snprintf(to + size, room - size, ",");
    return size;
}

size_t gw_csv_put_event(char row[GW_CSV_ROW], const char *sender, int64_t time,
                        const gw_tracking_event *event) {
    const int tracked = event->quality >= 0.0;
    const int pose = event->kind == GW_EVENT_POSE && tracked, gaze = event->kind == GW_EVENT_GAZE;
    size_t size = put_time(row, GW_CSV_ROW, time);
    size += put_sender(row + size, sender);
    size += (size_t)snprintf(row + size, GW_CSV_ROW - size, "%s,%ld,", gw_csv_kinds[event->kind],
                             (long)event->sensor);
    if (event->device_time == GW_NO_TIME)
        row[size++] = ',';
    else
        size += put_time(row + size, GW_CSV_ROW - size, event->device_time);
    size += put_time(row + size, GW_CSV_ROW - size, event->latency);
    size += put_numbers(row + size, GW_CSV_ROW - size, &event->quality, 1);
    const double *place = pose                                ? event->of.pose.position
                          : gaze && event->of.gaze.has_origin ? event->of.gaze.origin
                                                              : NULL;
    size += put_numbers(row + size, GW_CSV_ROW - size, place, 3);
    size += put_numbers(row + size, GW_CSV_ROW - size, pose ? event->of.pose.orientation : NULL, 4);
    size += put_numbers(row + size, GW_CSV_ROW - size, gaze && tracked ? event->of.gaze.direction : NULL, 3);
    size += put_numbers(row + size, GW_CSV_ROW - size, gaze ? &event->of.gaze.openness : NULL, 1);
    const char *frame = !gaze ? "" : event->of.gaze.frame == GW_GAZE_IN_HEAD ? "head" : "device";
    size += (size_t)snprintf(row + size, GW_CSV_ROW - size, "%s,", frame);
    if (event->kind == GW_EVENT_ANALOG)
        size += (size_t)snprintf(row + size, GW_CSV_ROW - size, "%.17g", event->of.analog.value);
    else if (event->kind == GW_EVENT_BUTTON || event->kind == GW_EVENT_LINK)
        row[size++] =
            (event->kind == GW_EVENT_BUTTON ? event->of.button.pressed : event->of.link.up) ? '1' : '0';
    row[size++] = '\n';
    return size;
}
