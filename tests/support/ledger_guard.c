#include "tests/support/ledger_guard.h"

#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const gw_guard_names[GW_GUARD_NUMBERS] = {
    "rays",  "steps",  "node_loads", "triangle_tests", "voxels",    "further_rays", "hit_mismatch",
    "depth", "normal", "rms",        "flip",           "seen_flip", "bias"};

/* Differences below these are those of rounding. */
static const double floors[GW_GUARD_NUMBERS] = {0, 0, 0, 0, 0, 0, 5e-4, 1e-2, 5e-2, 1e-4, 2e-4, 2e-4, 1e-4};

gw_guard_row gw_guard_row_of(const char *knob, double value, const gw_counters *c, const gw_metrics *errors) {
    const double *e = errors->values;
    gw_guard_row row = {.value = value,
                        .numbers = {(double)c->rays, (double)c->steps, (double)c->node_loads,
                                    (double)c->triangle_tests, (double)c->voxels,
                                    (double)gw_secondary_rays(c), e[GW_METRIC_HIT_MISMATCH],
                                    e[GW_METRIC_DEPTH_MEAN], e[GW_METRIC_NORMAL_MEAN],
                                    gw_metric_badness(GW_METRIC_PSNR, e[GW_METRIC_PSNR]), e[GW_METRIC_FLIP],
                                    e[GW_METRIC_SEEN_FLIP], e[GW_METRIC_BIAS]}};
    snprintf(row.knob, sizeof row.knob, "%s", knob);
    for (int i = 0; i < GW_GUARD_NUMBERS; i++) /* what nobody sees is no error */
        row.numbers[i] = isnan(row.numbers[i]) ? 0 : row.numbers[i];
    return row;
}

/* --- the file --------------------------------------------------------------------------------------------
 */

static int take_row(const char *line, gw_guard_row *out) {
    const size_t length = strcspn(line, ",");
    char *end = NULL;
    if (length == 0 || length >= sizeof out->knob || line[length] != ',')
        return 0;
    snprintf(out->knob, sizeof out->knob, "%.*s", (int)length, line);
    const char *at = line + length;
    for (int i = -1; i < GW_GUARD_NUMBERS; i++) {
        if (*at != ',')
            return 0;
        const double number = strtod(at + 1, &end);
        if (end == at + 1 || !isfinite(number))
            return 0;
        *(i < 0 ? &out->value : &out->numbers[i]) = number;
        at = end;
    }
    return *at == '\0';
}

gw_code gw_guard_load(const char *path, gw_guard_table *out, gw_error *error) {
    gw_bytes bytes = {0};
    gw_code code = gw_file_read(path, 1 << 20, &bytes, error);
    char *text = code ? NULL : calloc(bytes.size + 1, 1);
    out->count = 0;
    if (!code && !text)
        code = gw_fail(error, GW_MACHINE, "memory is out while reading %s", path);
    if (!code)
        memcpy(text, bytes.data, bytes.size);
    int number = 0, named = 0;
    char *rest = NULL;
    for (char *line = text ? strtok_r(text, "\n", &rest) : NULL; line && !code;
         line = strtok_r(NULL, "\n", &rest)) {
        number++;
        if (line[0] == '#')
            continue;
        if (!named++)
            continue;
        if (out->count == GW_GUARD_ROWS || !take_row(line, &out->rows[out->count]))
            code = gw_fail(error, GW_BAD_INPUT, "%s, line %d: not a knob, its value and %d numbers", path,
                           number, GW_GUARD_NUMBERS);
        out->count++;
    }
    free(text);
    gw_bytes_finish(&bytes);
    return code;
}

void gw_guard_write(FILE *file, const gw_guard_table *table, const char *remark) {
    fprintf(file, "# %s\nknob,value", remark);
    for (int i = 0; i < GW_GUARD_NUMBERS; i++)
        fprintf(file, ",%s", gw_guard_names[i]);
    for (size_t r = 0; r < table->count; r++) {
        fprintf(file, "\n%s,%g", table->rows[r].knob, table->rows[r].value);
        for (int i = 0; i < GW_GUARD_NUMBERS; i++)
            fprintf(file, i < GW_GUARD_WORK ? ",%.0f" : ",%.6g", table->rows[r].numbers[i]);
    }
    fputc('\n', file);
}

/* --- verdicts --------------------------------------------------------------------------------------------
 */

static int same_place(const gw_guard_row *a, const gw_guard_row *b) {
    return !strcmp(a->knob, b->knob) && a->value == b->value;
}

size_t gw_guard_compare(const gw_guard_table *recorded, const gw_guard_table *measured,
                        char text[GW_GUARD_TEXT]) {
    size_t faults = 0;
    text[0] = '\0';
    if (recorded->count != measured->count) {
        snprintf(text, GW_GUARD_TEXT, "%zu rows are recorded, %zu were measured", recorded->count,
                 measured->count);
        return measured->count + recorded->count;
    }
    for (size_t r = 0; r < recorded->count; r++)
        for (int i = 0; i < GW_GUARD_NUMBERS; i++) {
            const gw_guard_row *was = &recorded->rows[r], *is = &measured->rows[r];
            const double before = was->numbers[i], now = is->numbers[i];
            if (same_place(was, is) && fabs(now - before) <= 0.01 * fabs(before) + floors[i])
                continue;
            if (!faults++)
                snprintf(text, GW_GUARD_TEXT, "%s=%g: %s is %.6g, recorded %s=%g has %.6g: %s", is->knob,
                         is->value, gw_guard_names[i], now, was->knob, was->value, before,
                         fabs(now) > fabs(before) ? "worse" : "better, record it");
        }
    return faults;
}

static double work_of(const gw_guard_row *row) {
    return row->numbers[2] + row->numbers[3] + row->numbers[4]; /* node loads, tests, voxels */
}

static int is_reached(const gw_guard_row *point, const gw_guard_table *by) {
    for (size_t i = 0; i < by->count; i++) {
        const gw_guard_row *row = &by->rows[i];
        if (!strcmp(row->knob, point->knob) && work_of(row) <= 1.01 * work_of(point) &&
            row->numbers[GW_GUARD_FLIP] <= 1.01 * point->numbers[GW_GUARD_FLIP] + floors[GW_GUARD_FLIP])
            return 1;
    }
    return 0;
}

size_t gw_guard_fronts(const gw_guard_table *recorded, const gw_guard_table *measured,
                       char text[GW_GUARD_TEXT]) {
    size_t faults = 0;
    const char *last = "";
    text[0] = '\0';
    for (size_t i = 0; i < recorded->count; i++) {
        const gw_guard_row *row = &recorded->rows[i];
        if (!strcmp(row->knob, last) || is_reached(row, measured))
            continue;
        last = row->knob;
        if (!faults++)
            snprintf(text, GW_GUARD_TEXT,
                     "the front of %s is worse: nothing reaches the work of %.0f with FLIP %.4f of value %g",
                     row->knob, work_of(row), row->numbers[GW_GUARD_FLIP], row->value);
    }
    return faults;
}

size_t gw_guard_monotone(const gw_guard_table *measured, char text[GW_GUARD_TEXT]) {
    size_t faults = 0;
    text[0] = '\0';
    for (size_t i = 1; i < measured->count; i++) {
        const gw_guard_row *finer = &measured->rows[i - 1], *row = &measured->rows[i];
        if (strcmp(finer->knob, row->knob) ||
            row->numbers[GW_GUARD_FLIP] >= 0.95 * finer->numbers[GW_GUARD_FLIP] - floors[GW_GUARD_FLIP])
            continue;
        if (!faults++)
            snprintf(text, GW_GUARD_TEXT,
                     "the error of %s falls from %.4f at %g to %.4f at %g, which is coarser", row->knob,
                     finer->numbers[GW_GUARD_FLIP], finer->value, row->numbers[GW_GUARD_FLIP], row->value);
    }
    return faults;
}
