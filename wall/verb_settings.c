/* `gazewall settings`: the table of settings, as --set takes them. */
#include "wall/verbs.h"

#include "base/settings.h"
#include "wall/console.h"
#include "wall/options.h"

#include <stdio.h>

static const struct argp settings_argp = {
    .doc = "Lists every setting: name, default, range or choices, unit, what it does and what it trades."};

static void print_row(const gw_setting_row *row, const gw_settings *defaults) {
    char initial[64], range[96];
    gw_setting_text(defaults, row, initial);
    if (row->kind == GW_SETTING_CHOICE)
        snprintf(range, sizeof range, "%s", row->choices);
    else if (row->kind == GW_SETTING_SWITCH)
        snprintf(range, sizeof range, "on|off");
    else
        snprintf(range, sizeof range, "%g to %g%s%s%s%s", row->minimum, row->maximum, row->unit[0] ? " " : "",
                 row->unit, row->choices[0] ? ", " : "", row->choices);
    printf("%s=%s  (%s)\n    %s\n    trades %s; reference: %s\n", row->name, initial, range, row->help,
           row->trades, row->reference);
}

int gw_verb_settings(int argc, char **argv) {
    gw_error error = {0};
    int helped = 0;
    gw_code code = gw_arguments_parse(&settings_argp, argc, argv, NULL, &helped, &error);
    if (code)
        return gw_console_fail("settings", &error);
    if (helped)
        return GW_OK;
    gw_settings defaults;
    gw_settings_init(&defaults);
    static const char *const headings[] = {
        "Octree (change its bytes):", "Frame (travel in the frame state):",
        "Rank 0 (change the eyes, gazes and automatic exposure in the frame state):"};
    for (int stage = GW_SETTING_BUILD; stage <= GW_SETTING_TRACK; stage++) {
        printf("%s%s\n\n", stage ? "\n" : "", headings[stage]);
        for (size_t i = 0; i < gw_setting_count; i++)
            if ((int)gw_setting_rows[i].stage == stage)
                print_row(&gw_setting_rows[i], &defaults);
    }
    return GW_OK;
}
