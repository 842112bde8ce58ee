#include "tracking/player.h"

#include "base/memory.h"
#include "tracking/track.h"

#include <stdlib.h>
#include <string.h>

enum { KNOWN_SENSORS = 1024 }; /* of all senders; the first events of more are taken in their turn */

struct gw_player {
    const gw_recorded_event *events; /* borrowed */
    size_t count, next;
    uint8_t *is_first; /* [count]: given at the beginning */
    int8_t sources[GW_RECORDING_SENDERS];
    int64_t delay, time;
    int begun;
};

/* --- which events are the first of their sensor */

typedef struct channel {
    uint32_t sender;
    gw_tracking_event_kind kind;
    int32_t sensor;
} channel;

static int is_known(channel *known, uint32_t *count, const gw_recorded_event *event) {
    for (uint32_t i = 0; i < *count; i++)
        if (known[i].sender == event->sender && known[i].kind == event->event.kind &&
            known[i].sensor == event->event.sensor)
            return 1;
    if (*count == KNOWN_SENSORS)
        return 1;
    known[(*count)++] = (channel){event->sender, event->event.kind, event->event.sensor};
    return 0;
}

static void find_first(gw_player *player) {
    channel known[KNOWN_SENSORS];
    uint32_t count = 0;
    for (size_t i = 0; i < player->count; i++) {
        const gw_tracking_event *event = &player->events[i].event;
        const int told =
            (event->kind == GW_EVENT_POSE || event->kind == GW_EVENT_GAZE) && event->quality >= 0;
        player->is_first[i] = told && !is_known(known, &count, &player->events[i]);
    }
}

/* --- whose devices they are */

/* The device of a source: NAME of NAME@HOST, vrpn:NAME@HOST and the like; else all of it. */
static int is_device_of(const char *spec, const char *sender) {
    const char *colon = strchr(spec, ':'), *at = strchr(spec, '@');
    const char *name = colon && at && colon < at ? colon + 1 : spec;
    const size_t length = at ? (size_t)(at - name) : strlen(name);
    return !strcmp(spec, sender) || (strlen(sender) == length && !strncmp(name, sender, length));
}

/* The site's sources by the names of the recording's devices; 0 when none is of the site. */
static int match_site(const gw_tracker_setup *site, const gw_recording *recording, int8_t *sources) {
    int found = 0;
    for (uint32_t sender = 0; sender < recording->sender_count; sender++) {
        sources[sender] = -1;
        for (uint32_t i = 0; i < site->source_count; i++)
            if (is_device_of(site->sources[i].spec, recording->senders[sender])) {
                sources[sender] = (int8_t)i;
                found = 1;
            }
    }
    return found;
}

gw_code gw_player_setup(const gw_recording *recording, const gw_tracker_setup *site, gw_tracker_setup *out,
                        int8_t sources[GW_RECORDING_SENDERS], int *is_site, gw_error *error) {
    uint32_t sender = 0;
    *is_site = site && match_site(site, recording, sources);
    if (*is_site) {
        *out = *site;
        return GW_OK;
    }
    gw_code code = gw_track_sender(recording, &sender, error);
    for (uint32_t i = 0; i < recording->sender_count; i++)
        sources[i] = !code && i == sender ? 0 : -1;
    if (!code)
        gw_tracker_setup_default(recording->senders[sender], out);
    return code;
}

/* --- opening */

gw_code gw_player_open(const gw_recording *recording, const int8_t *sources, int64_t delay, gw_player **out,
                       gw_error *error) {
    void *memory = NULL, *first = NULL;
    *out = NULL;
    gw_code code = gw_allocate(&memory, 1, sizeof(gw_player), "player", error);
    if (!code)
        code = gw_allocate(&first, recording->count, 1, "player", error);
    gw_player *player = memory;
    if (code) {
        free(player);
        return code;
    }
    player->events = recording->events;
    player->count = recording->count;
    player->delay = delay;
    player->is_first = first;
    memcpy(player->sources, sources, recording->sender_count * sizeof *sources);
    find_first(player);
    *out = player;
    return GW_OK;
}

void gw_player_track_setup(gw_tracker_setup *out) {
    gw_tracker_setup_default("track", out);
    gw_room_default(1, &out->sources[0].room);
}

void gw_player_close(gw_player **player) {
    if (!*player)
        return;
    free((*player)->is_first);
    free(*player);
    *player = NULL;
}

/* --- playing */

/* Later on its way, by as much as it says that it took. */
static void give(const gw_player *player, gw_tracker *tracker, size_t i) {
    gw_tracking_event event = player->events[i].event;
    event.arrival += player->delay;
    event.latency += player->delay;
    const int source = player->sources[player->events[i].sender];
    if (source >= 0)
        gw_tracker_take(tracker, source, &event);
}

static void begin(gw_player *player, gw_tracker *tracker) {
    gw_tracker_reset(tracker);
    for (size_t i = 0; i < player->count; i++)
        if (player->is_first[i])
            give(player, tracker, i);
    player->next = 0;
    player->begun = 1;
}

void gw_player_feed(gw_player *player, gw_tracker *tracker, int64_t time) {
    if (!player->begun || time < player->time)
        begin(player, tracker);
    player->time = time;
    for (; player->next < player->count; player->next++) {
        if (player->events[player->next].event.arrival + player->delay > time)
            return;
        if (!player->is_first[player->next])
            give(player, tracker, player->next);
    }
}
