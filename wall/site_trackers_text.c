/* The trackers of a site as text, and how those of two sites differ. */
#include "wall/site_internal.h"

#include <stdio.h>
#include <string.h>

static void put_gaze(FILE *out, const gw_tracker_setup *setup, const gw_tracker_viewer *viewer) {
    const int sensor = viewer->gaze == GW_GAZE_KIND_SENSOR || viewer->gaze == GW_GAZE_KIND_ANY;
    const int events = viewer->gaze == GW_GAZE_KIND_EVENTS || viewer->gaze == GW_GAZE_KIND_ANY;
    fputs(", gaze: ", out);
    if (sensor)
        fprintf(out, "sensor %d%s", viewer->gaze_sensor, events ? " or " : "");
    if (events)
        fprintf(out, "events %d", viewer->gaze_viewer);
    if (!sensor && !events)
        fputs(viewer->gaze == GW_GAZE_KIND_HEAD ? "head" : "none", out);
    if (viewer->gaze_source != viewer->source)
        fprintf(out, ", gaze_from: \"%s\"", setup->sources[viewer->gaze_source].spec);
}

static void put_viewer(FILE *out, const gw_tracker_setup *setup, const gw_tracker_viewer *viewer) {
    if (viewer->head_sensor < 0)
        fputs("      - {head: none", out);
    else
        fprintf(out, "      - {head: %d", viewer->head_sensor);
    fputs(", head_turn: ", out);
    gw_site_put_numbers(out, viewer->head_turn, 4);
    fputs(", eye_offset: ", out);
    gw_site_put_numbers(out, viewer->eye_offset, 3);
    put_gaze(out, setup, viewer);
    if (viewer->gaze_error >= 0) {
        fputs(", gaze_error: ", out);
        gw_site_put_number(out, viewer->gaze_error);
    }
    fputs("}\n", out);
}

void gw_site_put_room(FILE *out, const gw_room *room, const char *indent) {
    char axes[GW_AXIS_TEXT];
    const char *unit = gw_room_unit_name(room->unit);
    gw_axis_map_write(&room->axes, axes);
    fprintf(out, "%sunit: %s", indent, unit ? unit : "");
    if (!unit)
        gw_site_put_number(out, room->unit);
    fprintf(out, "\n%saxes: %s\n%sturn: ", indent, axes, indent);
    gw_site_put_numbers(out, room->turn, 4);
    fprintf(out, "\n%sshift: ", indent);
    gw_site_put_numbers(out, room->shift, 3);
    fputs("\n", out);
}

static void put_navigation(FILE *out, const gw_tracker_navigation *navigation) {
    const struct {
        const char *key;
        int32_t number;
    } channels[] = {
        {"forward", navigation->forward}, {"turn", navigation->turn}, {"reset", navigation->reset}};
    const char *comma = "    navigation: {";
    for (size_t i = 0; i < GW_COUNT(channels); i++)
        if (channels[i].number >= 0) {
            fprintf(out, "%s%s: %d", comma, channels[i].key, channels[i].number);
            comma = ", ";
        }
    if (comma[0] == ',')
        fputs("}\n", out);
}

static void put_tracker(FILE *out, const gw_tracker_setup *setup, uint32_t index) {
    const gw_tracker_source *source = &setup->sources[index];
    const char *heading = "    viewers:\n";
    fprintf(out, "  - source: \"%s\"\n", source->spec);
    if (source->bind[0])
        fprintf(out, "    bind: \"%s\"\n", source->bind);
    gw_site_put_room(out, &source->room, "    ");
    for (uint32_t v = 0; v < setup->viewer_count; v++)
        if (setup->viewers[v].source == (int32_t)index) {
            fputs(heading, out);
            put_viewer(out, setup, &setup->viewers[v]);
            heading = "";
        }
    if (setup->navigation.source == (int32_t)index)
        put_navigation(out, &setup->navigation);
}

void gw_site_put_trackers(FILE *out, const gw_site *site) {
    if (site->tracker[0])
        fprintf(out, "tracker: \"%s\"\n", site->tracker);
    else if (site->trackers.source_count > 0)
        fputs("trackers:\n", out);
    for (uint32_t s = 0; s < site->trackers.source_count && !site->tracker[0]; s++)
        put_tracker(out, &site->trackers, s);
}

static void vector(gw_site_changes *out, const char *where, const char *key, const double *before,
                   const double *after, int count) {
    char text[2][96] = {"", ""};
    if (!memcmp(before, after, (size_t)count * sizeof *before))
        return;
    for (int i = 0; i < count; i++) {
        snprintf(text[0] + strlen(text[0]), sizeof text[0] - strlen(text[0]), "%s%g", i ? ", " : "",
                 before[i]);
        snprintf(text[1] + strlen(text[1]), sizeof text[1] - strlen(text[1]), "%s%g", i ? ", " : "",
                 after[i]);
    }
    gw_site_change(out, 0, "%s: %s [%s] -> [%s]", where, key, text[0], text[1]);
}

static void number(gw_site_changes *out, int restart, const char *where, const char *key, double before,
                   double after) {
    if (before != after)
        gw_site_change(out, restart, "%s: %s %g -> %g", where, key, before, after);
}

static void compare_source(gw_site_changes *out, uint32_t index, const gw_tracker_source *before,
                           const gw_tracker_source *after) {
    char where[32], axes[2][GW_AXIS_TEXT];
    snprintf(where, sizeof where, "tracker %u", index + 1);
    if (strcmp(before->spec, after->spec) != 0)
        gw_site_change(out, 1, "%s: source %.80s -> %.80s", where, before->spec, after->spec);
    if (strcmp(before->bind, after->bind) != 0)
        gw_site_change(out, 1, "%s: bind %s -> %s", where, before->bind[0] ? before->bind : "all",
                       after->bind[0] ? after->bind : "all");
    number(out, 0, where, "unit", before->room.unit, after->room.unit);
    gw_axis_map_write(&before->room.axes, axes[0]);
    gw_axis_map_write(&after->room.axes, axes[1]);
    if (strcmp(axes[0], axes[1]) != 0)
        gw_site_change(out, 0, "%s: axes %s -> %s", where, axes[0], axes[1]);
    vector(out, where, "turn", before->room.turn, after->room.turn, 4);
    vector(out, where, "shift", before->room.shift, after->room.shift, 3);
}

static void compare_viewer(gw_site_changes *out, uint32_t index, const gw_tracker_viewer *before,
                           const gw_tracker_viewer *after) {
    static const char *const gazes[GW_GAZE_KINDS] = {"none", "head", "sensor", "events", "sensor or events"};
    char where[32];
    snprintf(where, sizeof where, "viewer %u", index + 1);
    number(out, 1, where, "tracker", before->source, after->source);
    number(out, 1, where, "head", before->head_sensor, after->head_sensor);
    vector(out, where, "head_turn", before->head_turn, after->head_turn, 4);
    vector(out, where, "eye_offset", before->eye_offset, after->eye_offset, 3);
    if (before->gaze != after->gaze)
        gw_site_change(out, 1, "%s: gaze %s -> %s", where, gazes[before->gaze], gazes[after->gaze]);
    number(out, 1, where, "gaze sensor", before->gaze_sensor, after->gaze_sensor);
    number(out, 1, where, "gaze events", before->gaze_viewer, after->gaze_viewer);
    number(out, 1, where, "gaze_from", before->gaze_source, after->gaze_source);
    number(out, 0, where, "gaze_error", gw_tracker_gaze_error(before), gw_tracker_gaze_error(after));
}

/* Where a device stands, and where eyes are behind sensors, can be taken over; what is listened to, and whose
 * the sensors are, cannot. */
void gw_site_compare_trackers(gw_site_changes *out, const gw_site *before, const gw_site *after) {
    const gw_tracker_setup *from = &before->trackers, *to = &after->trackers;
    number(out, 1, "trackers", "sources", from->source_count, to->source_count);
    number(out, 1, "trackers", "viewers", from->viewer_count, to->viewer_count);
    for (uint32_t s = 0; s < from->source_count && s < to->source_count; s++)
        compare_source(out, s, &from->sources[s], &to->sources[s]);
    for (uint32_t v = 0; v < from->viewer_count && v < to->viewer_count; v++)
        compare_viewer(out, v, &from->viewers[v], &to->viewers[v]);
    number(out, 1, "trackers", "navigation: tracker", from->navigation.source, to->navigation.source);
    number(out, 1, "trackers", "navigation: forward", from->navigation.forward, to->navigation.forward);
    number(out, 1, "trackers", "navigation: turn", from->navigation.turn, to->navigation.turn);
    number(out, 1, "trackers", "navigation: reset", from->navigation.reset, to->navigation.reset);
}
