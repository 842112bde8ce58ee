/* The site: the wall as built. Where its tiles hang (wall/layout.h), which machine, GPU and display drives
 * each panel, what the panels are like, how long what is waited for. From a site file (docs/sites.md) or made
 * up for a wall that is simulated. A plain value without pointers, so that rank 0 can send it to every rank
 * as bytes. Any thread. */
#ifndef GW_WALL_SITE_H
#define GW_WALL_SITE_H

#include "base/log.h"
#include "base/status.h"
#include "tracking/setup.h"
#include "wall/layout.h"

#include <stdint.h>
#include <stdio.h>

/* How a panel shows two eyes (docs/sites.md). */
typedef enum gw_stereo {
    GW_STEREO_MONO,
    GW_STEREO_SIDE_BY_SIDE, /* left half, right half */
    GW_STEREO_TOP_BOTTOM,
    GW_STEREO_ANAGLYPH,      /* red for the left eye, cyan for the right */
    GW_STEREO_ROW_INTERLACE, /* rows 0, 2, ... of the wall for the left eye */
    GW_STEREO_LEFT,          /* one of two tiles that hang in one place: this one is for the left eye */
    GW_STEREO_RIGHT,
    GW_STEREO_COUNT
} gw_stereo;

extern const char *const gw_stereo_names[GW_STEREO_COUNT]; /* as site files write them */

/* What drives a tile, and what its panel does with light. */
typedef struct gw_panel {
    char host[64];     /* name or address as ssh takes it; "": the machine of the launcher */
    char display[64];  /* X display, as ":0.1"; "": none, the tile is drawn headless */
    char monitor[32];  /* connector, as "DP-1", for a full screen; "": a window */
    int32_t gpu;       /* index of the EGL device for headless tiles; -1: the first that serves */
    int32_t window[2]; /* px, top left corner of the window on its display; of the tile's size */
    uint32_t stereo;   /* gw_stereo */
    double gamma;      /* exponent of the panel, 1 to 4; 0: sRGB as it comes out of the renderer */
    double white[3];   /* gains of red, green and blue, 0.1 to 1 */
    double brightness; /* gain of all three, 0.1 to 1 */
} gw_panel;

/* Where the wall's own network traffic and its times are agreed on. */
typedef struct gw_site_times {
    double load;     /* s, until all ranks must be ready */
    double frame;    /* s, after which a frame goes without a late tile; 0: 3 periods of `refresh` */
    double death;    /* s without a word after which a tile is lost */
    double refresh;  /* Hz, of the panels */
    double restarts; /* how often a minute a lost tile of a live wall is started again, whole; 0: never */
} gw_site_times;

typedef struct gw_site {
    gw_layout layout;
    gw_panel panels[GW_MAXIMUM_TILES]; /* panel i is tile i's */
    gw_site_times times;
    char address[64];  /* of the interface on which rank 0 takes tiles that come back; "": loopback */
    uint16_t port;     /* TCP, there; 0: any that is free */
    char tracker[256]; /* the one source that key `tracker` names, with the usual setup; "": it does not */
    gw_tracker_setup trackers; /* sources of head and gaze when the command line names none: that one, or
                                  those of key `trackers`; no source: none */
    double eye_distance;       /* mm between a viewer's eyes, for stereo; 0 to 100 */
    double fly_speed;          /* m/s of the scene, of navigation by keys; 0: none */
} gw_site;

/* One machine, headless, mono panels that show sRGB as it is. Leaves layout alone. */
void gw_site_defaults(gw_site *site);

/* What is probably not meant, but can be run: the line of the file and a sentence for each. */
enum { GW_MAXIMUM_NOTES = 32 };
typedef struct gw_site_notes {
    uint32_t count, left_out; /* listed; beyond the list's end */
    struct {
        int line;
        char text[256];
    } notes[GW_MAXIMUM_NOTES];
} gw_site_notes;

/* Reads a site file (docs/sites.md); a plain name without such a file is looked for among the sites inside
 * the program (configs/sites/NAME.yaml). GW_BAD_INPUT "FILE:LINE: ..." for what cannot be run. */
gw_code gw_site_load(const char *path, gw_site *out, gw_error *error);
gw_code gw_site_load_noting(const char *path, gw_site *out, gw_site_notes *notes, gw_error *error);
/* The same from memory; name stands for the path in messages. */
gw_code gw_site_parse(const char *text, size_t size, const char *name, gw_site *out, gw_site_notes *notes,
                      gw_error *error);

/* Writes the notes to a log, one line each: "FILE:LINE: ...". */
void gw_site_warn(const char *path, const gw_site_notes *notes, const gw_log *log);

/* The site as YAML with measured `tiles`, which reads back as the same bits; free() it. */
gw_code gw_site_write(const gw_site *site, char **text, size_t *size, gw_error *error);

/* Unit, axes, turn and shift of a tracker as a site file has them, to be pasted into one. */
void gw_site_put_room(FILE *out, const gw_room *room, const char *indent);

/* Top view, front and bird's-eye view as SVG with a scale in mm; title stands above. free() it. */
gw_code gw_site_draw(const gw_site *site, const char *title, char **svg, size_t *size, gw_error *error);

/* What differs between two sites, key by key and tile by tile. While frames are drawn, geometry, eyes, stereo
 * and what panels do with light can be taken over ("live"); which tiles there are, their pixels, who draws
 * them, times and network cannot. */
enum { GW_MAXIMUM_CHANGES = 64 };
typedef struct gw_site_changes {
    uint32_t count, left_out; /* listed; beyond the list's end */
    uint32_t restarts;        /* how many of all need one */
    struct {
        int restart;
        char text[224]; /* "tile 'c0r0': gamma 2.2 -> 2.4" */
    } changes[GW_MAXIMUM_CHANGES];
} gw_site_changes;

/* GW_BAD_INPUT, naming the first change that needs a restart, if there is one; *out is filled in any case. */
gw_code gw_site_compare(const gw_site *before, const gw_site *after, gw_site_changes *out, gw_error *error);

#endif
