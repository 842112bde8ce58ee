#include "base/settings_page.h"

#include "base/settings.h"

#include <stdio.h>
#include <stdlib.h>

static const char introduction[] = "# Settings\n"
                                   "\n"
                                   "Everything that can change a pixel or the octree is one row here; "
                                   "`base/settings.h` holds the table, and this page\n"
                                   "is written from it by `make docs`. Any command that draws takes `--set "
                                   "name=value`, as often as needed. Switches\n"
                                   "take `on` and `off`. Every report states all values under `settings`.\n";

static void write_range(FILE *page, const gw_setting_row *row) {
    if (row->kind == GW_SETTING_SWITCH) {
        fprintf(page, "on, off");
    } else if (row->kind == GW_SETTING_CHOICE) {
        for (const char *c = row->choices; *c; c++) {
            if (*c == '|') {
                fprintf(page, ", ");
            } else {
                fputc(*c, page);
            }
        }
    } else {
        fprintf(page, "%g to %g%s%s", row->minimum, row->maximum, row->choices[0] ? ", " : "", row->choices);
    }
}

static void write_stage(FILE *page, const gw_settings *defaults, gw_setting_stage stage) {
    fprintf(page, "| name | default | range | unit | meaning | trades | measured against |\n"
                  "|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < gw_setting_count; i++) {
        const gw_setting_row *row = &gw_setting_rows[i];
        if (row->stage != stage) {
            continue;
        }
        char text[64];
        gw_setting_text(defaults, row, text);
        fprintf(page, "| `%s` | %s | ", row->name, text);
        write_range(page, row);
        fprintf(page, " | %s | %s | %s | %s |\n", row->unit, row->help, row->trades, row->reference);
    }
}

char *gw_settings_page(void) {
    char *text = NULL;
    size_t size = 0;
    FILE *page = open_memstream(&text, &size);
    if (!page) {
        return NULL;
    }
    gw_settings defaults;
    gw_settings_init(&defaults);
    fprintf(page, "%s\n## Of the octree\n\nA change builds another octree, with another hash.\n\n",
            introduction);
    write_stage(page, &defaults, GW_SETTING_BUILD);
    fprintf(page, "\n## Of a frame\n\nThey travel in the frame state, are recorded with it and repeated by "
                  "replay.\n\n");
    write_stage(page, &defaults, GW_SETTING_FRAME);
    fprintf(
        page,
        "\n## Of what rank 0 decides\n\nThey change what rank 0 puts into the frame state: eyes and gazes "
        "([tracking.md](tracking.md)), and automatic exposure ([rendering.md](rendering.md#tone)). A "
        "recorded frame state holds what came of them.\n\n");
    write_stage(page, &defaults, GW_SETTING_TRACK);
    if (fclose(page) != 0) {
        free(text);
        return NULL;
    }
    return text;
}
