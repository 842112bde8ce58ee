#include "base/settings.h"

#include "base/suggest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GW_ROW_ENTRY(field, kind_, default_, minimum_, maximum_, choices_, stage_, unit_, trades_,           \
                     reference_, help_)                                                                      \
    {.name = #field,                                                                                         \
     .kind = GW_SETTING_##kind_,                                                                             \
     .stage = GW_SETTING_##stage_,                                                                           \
     .initial = default_,                                                                                    \
     .minimum = minimum_,                                                                                    \
     .maximum = maximum_,                                                                                    \
     .choices = choices_,                                                                                    \
     .unit = unit_,                                                                                          \
     .trades = trades_,                                                                                      \
     .reference = reference_,                                                                                \
     .help = help_,                                                                                          \
     .offset = offsetof(gw_settings, field)},

const gw_setting_row gw_setting_rows[] = {GW_SETTINGS_TABLE(GW_ROW_ENTRY)};
const size_t gw_setting_count = sizeof gw_setting_rows / sizeof gw_setting_rows[0];

enum { ROWS = sizeof gw_setting_rows / sizeof gw_setting_rows[0] };

void gw_setting_store(gw_settings *settings, const gw_setting_row *row, double value) {
    char *field = (char *)settings + row->offset;
    if (row->kind == GW_SETTING_REAL) {
        memcpy(field, &value, sizeof value);
    } else {
        int32_t whole = (int32_t)value;
        memcpy(field, &whole, sizeof whole);
    }
}

void gw_settings_init(gw_settings *settings) {
    memset(settings, 0, sizeof *settings);
    for (size_t i = 0; i < ROWS; i++) {
        gw_setting_store(settings, &gw_setting_rows[i], gw_setting_rows[i].initial);
    }
}

double gw_setting_value(const gw_settings *settings, const gw_setting_row *row) {
    const char *field = (const char *)settings + row->offset;
    if (row->kind == GW_SETTING_REAL) {
        double value;
        memcpy(&value, field, sizeof value);
        return value;
    }
    int32_t whole;
    memcpy(&whole, field, sizeof whole);
    return whole;
}

/* Start and length of choice `index` in "a|b|c"; NULL beyond the last. */
static const char *choice_at(const char *choices, int index, size_t *length) {
    for (; index > 0; index--) {
        choices = strchr(choices, '|');
        if (!choices) {
            return NULL;
        }
        choices++;
    }
    *length = strcspn(choices, "|");
    return choices;
}

void gw_setting_text(const gw_settings *settings, const gw_setting_row *row, char text[64]) {
    double value = gw_setting_value(settings, row);
    size_t length = 0;
    const char *choice;
    switch (row->kind) {
    case GW_SETTING_SWITCH:
        snprintf(text, 64, "%s", value != 0 ? "on" : "off");
        break;
    case GW_SETTING_CHOICE:
        choice = choice_at(row->choices, (int)value, &length);
        snprintf(text, 64, "%.*s", choice ? (int)length : 1, choice ? choice : "?");
        break;
    case GW_SETTING_INTEGER:
    case GW_SETTING_REAL:
        if (isinf(value)) {
            snprintf(text, 64, "%s", row->choices);
            break;
        }
        if (value == floor(value) && fabs(value) < 1e15) {
            snprintf(text, 64, "%.0f", value);
            break;
        }
        /* The shortest decimal that reads back as the same value. */
        for (int digits = 1; digits <= 17; digits++) {
            snprintf(text, 64, "%.*g", digits, value);
            if (strtod(text, NULL) == value) {
                break;
            }
        }
        break;
    }
}

static int parse_switch(const char *text, double *value) {
    static const char *const words[2][4] = {{"off", "0", "false", "no"}, {"on", "1", "true", "yes"}};
    for (int on = 0; on < 2; on++) {
        for (int i = 0; i < 4; i++) {
            if (strcmp(text, words[on][i]) == 0) {
                *value = on;
                return 1;
            }
        }
    }
    return 0;
}

static int parse_choice(const char *choices, const char *text, double *value) {
    size_t length = 0;
    for (int i = 0;; i++) {
        const char *choice = choice_at(choices, i, &length);
        if (!choice) {
            return 0;
        }
        if (strlen(text) == length && memcmp(choice, text, length) == 0) {
            *value = i;
            return 1;
        }
    }
}

static gw_code assign_number(const gw_setting_row *row, const char *text, double *value, gw_error *error) {
    if (row->choices[0] && strcmp(text, row->choices) == 0) {
        *value = GW_SETTING_AUTO;
        return GW_OK;
    }
    /* Plain decimals only: strtod alone would take hexadecimal, infinities and leading blanks. */
    int plain = text[0] != '\0' && strspn(text, "0123456789+-.eE") == strlen(text);
    char *end = NULL;
    *value = plain ? strtod(text, &end) : 0;
    if (!plain || *end != '\0') {
        return gw_fail(error, GW_BAD_INPUT, "setting '%s': '%s' is not a number%s%s", row->name, text,
                       row->choices[0] ? " nor " : "", row->choices);
    }
    if (row->kind == GW_SETTING_INTEGER && *value != floor(*value)) {
        return gw_fail(error, GW_BAD_INPUT, "setting '%s': '%s' is not a whole number", row->name, text);
    }
    if (!(*value >= row->minimum && *value <= row->maximum)) {
        return gw_fail(error, GW_BAD_INPUT, "setting '%s': %s is outside %g to %g%s%s", row->name, text,
                       row->minimum, row->maximum, row->unit[0] ? " " : "", row->unit);
    }
    return GW_OK;
}

static gw_code fail_unknown(const char *name, gw_error *error) {
    const char *names[ROWS];
    for (size_t i = 0; i < ROWS; i++) {
        names[i] = gw_setting_rows[i].name;
    }
    const char *nearest = gw_suggest(name, names, ROWS);
    if (nearest) {
        return gw_fail(error, GW_BAD_INPUT, "unknown setting '%s'; did you mean '%s'?", name, nearest);
    }
    return gw_fail(error, GW_BAD_INPUT, "unknown setting '%s'; docs/settings.md lists them all", name);
}

gw_code gw_settings_assign(gw_settings *settings, const char *assignment, gw_error *error) {
    const char *equals = strchr(assignment, '=');
    size_t length = equals ? (size_t)(equals - assignment) : 0;
    char name[64];
    if (length == 0 || length >= sizeof name) {
        return gw_fail(error, GW_BAD_INPUT, "setting '%s': expected name=value", assignment);
    }
    memcpy(name, assignment, length);
    name[length] = '\0';
    const gw_setting_row *row = NULL;
    for (size_t i = 0; i < ROWS && !row; i++) {
        row = strcmp(name, gw_setting_rows[i].name) == 0 ? &gw_setting_rows[i] : NULL;
    }
    if (!row) {
        return fail_unknown(name, error);
    }
    const char *text = equals + 1;
    double value = 0;
    if (row->kind == GW_SETTING_SWITCH) {
        if (!parse_switch(text, &value)) {
            return gw_fail(error, GW_BAD_INPUT, "setting '%s': '%s' is neither on nor off", name, text);
        }
    } else if (row->kind == GW_SETTING_CHOICE) {
        if (!parse_choice(row->choices, text, &value)) {
            return gw_fail(error, GW_BAD_INPUT, "setting '%s': '%s' is not one of %s", name, text,
                           row->choices);
        }
    } else {
        gw_code code = assign_number(row, text, &value, error);
        if (code) {
            return code;
        }
    }
    gw_setting_store(settings, row, value);
    return GW_OK;
}
