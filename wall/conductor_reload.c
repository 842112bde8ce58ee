/* A site file that is changed while frames are drawn: read, compared, told, and taken over from a frame on.
 */
#include "wall/conductor_internal.h"

#include "base/clock.h"
#include "wall/rank.h"

#include <inttypes.h>
#include <string.h>

static void tell_changes(const struct gw_rank *rank, const gw_site_changes *changes, uint32_t frame) {
    for (uint32_t i = 0; i < changes->count; i++)
        gw_log_write(&rank->line.log, GW_LOG_INFO, "from frame %" PRIu32 " on: %s", frame,
                     changes->changes[i].text);
    if (changes->left_out)
        gw_log_write(&rank->line.log, GW_LOG_INFO, "from frame %" PRIu32 " on: and %" PRIu32 " changes more",
                     frame, changes->left_out);
}

gw_code gw_conductor_reload(gw_conductor *conductor, struct gw_rank *rank, uint32_t frame, gw_error *error) {
    static gw_site site;
    static gw_site_changes changes;
    gw_error wrong = {0};
    const gw_site_news news = gw_site_watch_look(&conductor->watch, gw_now_ns());
    if (news == GW_SITE_GONE)
        gw_log_write(&rank->line.log, GW_LOG_WARNING,
                     "%s: there is no such file any more; the wall goes on as it was",
                     rank->options.wall.site);
    if (news != GW_SITE_CHANGED)
        return GW_OK;
    gw_code code = gw_wall_site(&rank->options.wall, &site, &wrong);
    if (!code)
        code = gw_site_compare(&rank->site, &site, &changes, &wrong);
    if (code) {
        gw_log_write(&rank->line.log, GW_LOG_ERROR, "the wall goes on as it was: %s", wrong.text);
        return GW_OK;
    }
    if (changes.count == 0)
        return GW_OK;
    tell_changes(rank, &changes, frame);
    conductor->reloads++;
    gw_tracked_take_site(conductor->tracked, &site);
    code = gw_gate_take_site(conductor->gate, &site, conductor->reloads, error);
    return code ? code : gw_rank_take_site(rank, &site, conductor->reloads, error);
}
