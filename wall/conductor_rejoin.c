/* The door by which tiles that were started again come back. */
#include "wall/conductor_internal.h"

#include "wall/rank.h"

#include <stdlib.h>

/* NULL, or why none is started again although it should be. */
static const char *hindrance(const struct gw_rank *rank, const char *address) {
    char *cache = gw_cache_folder(&rank->options.draw);
    const int cached = cache != NULL || !gw_rank_needs_scene(rank);
    free(cache);
    if (!cached)
        return "there is no cache from which they could be";
    return address[0] ? NULL : "this machine's address is not known; give the site file 'network: address'";
}

void gw_conductor_open_door(gw_conductor *conductor, struct gw_rank *rank) {
    static char program[33];
    const uint32_t restarts = gw_sim_restarts(&rank->options, &rank->site);
    const gw_share *share = &rank->share;
    const char *secret = getenv(GW_LINK_SECRET);
    const char *address = rank->site.address[0] ? rank->site.address : rank->line.door;
    gw_error error = {0};
    /* Started by hand there is nobody who would start one again. */
    if (!restarts || !secret || rank->line.line.socket < 0 || rank->size < 2)
        return;
    const char *why = hindrance(rank, address);
    const gw_door_options options = {.address = address,
                                     .port = rank->site.port,
                                     .secret = secret,
                                     .program = program,
                                     .keys = {share->scene_segment.key, share->octree_segment.key,
                                              share->scene.scene.hash, share->octree.hash},
                                     .patience =
                                         (int64_t)(gw_sim_times(&rank->options, &rank->site).load * 1e9),
                                     .log = &rank->line.log};
    if (!why && (gw_program_hash(program, &error) ||
                 gw_gate_open_door(conductor->gate, &options, &rank->site, &error)))
        why = error.text;
    const gw_door *door = gw_gate_door(conductor->gate);
    if (why)
        gw_log_write(&rank->line.log, GW_LOG_WARNING, "tiles that are lost will not be started again: %s",
                     why);
    if (!door)
        return;
    gw_link_send(&rank->line, GW_LINK_DOOR, (int32_t)restarts, gw_door_name(door));
    gw_log_write(&rank->line.log, GW_LOG_DEBUG, "tiles that are started again come in at %s",
                 gw_door_name(door));
}
