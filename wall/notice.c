#include "wall/notice.h"

#include "base/memory.h"
#include "wall/overlay_text.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Breaks lines of at most `columns` letters at blanks. */
static void break_lines(char *text, uint32_t columns) {
    uint32_t used = 0;
    char *blank = NULL;
    for (char *at = text; *at; at++) {
        if (*at == '\n') {
            used = 0;
            blank = NULL;
            continue;
        }
        if (*at == ' ')
            blank = at;
        if (++used > columns && blank) {
            *blank = '\n';
            used = (uint32_t)(at - blank);
            blank = NULL;
        }
    }
}

gw_code gw_notice_draw(gw_notice_kind kind, uint32_t width, uint32_t height, const char *tile, int rank,
                       const char *reason, gw_image *out, gw_error *error) {
    static const uint8_t paper[][4] =
        {[GW_NOTICE_WAITS] = {48, 56, 64, 255}, [GW_NOTICE_ENDED] = {160, 0, 0, 255}},
                         white[4] = {255, 255, 255, 255};
    char host[64] = "unknown", text[1024];
    gethostname(host, sizeof host - 1);
    snprintf(text, sizeof text, "tile %s\nhost %s\nrank %d\n%s", tile, host, rank, reason);
    *out = (gw_image){.width = width, .height = height};
    gw_code code = gw_allocate((void **)&out->rgba, (size_t)width * height, 4, "notice", error);
    if (code)
        return code;
    uint32_t scale = width / (40 * GW_TEXT_ADVANCE);
    scale = scale ? scale : 1;
    const uint32_t columns = width / (scale * GW_TEXT_ADVANCE);
    break_lines(text, columns > 2 ? columns - 2 : 1);
    gw_box_draw(out, 0, 0, width, height, paper[kind]);
    gw_text_draw(out, (int64_t)scale * GW_TEXT_ADVANCE, (int64_t)scale * GW_TEXT_LINE / 2, scale, white,
                 text);
    return GW_OK;
}
