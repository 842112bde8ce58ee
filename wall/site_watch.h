/* Notices that a site file was changed while frames are drawn. By what the file system says of the file, once
 * a frame: that works on every file system, and a missed change is seen at the next look. Rank 0. */
#ifndef GW_WALL_SITE_WATCH_H
#define GW_WALL_SITE_WATCH_H

#include <stdint.h>
#include <sys/stat.h>

typedef struct gw_site_watch {
    const char *path; /* NULL: nothing is watched; borrowed */
    struct stat taken, candidate;
    int64_t since; /* ns, when the candidate was first seen; 0: there is none */
    int64_t gone;  /* ns, when the file was first found to be gone; 0: it is there */
    int told_gone;
} gw_site_watch;

typedef enum gw_site_news {
    GW_SITE_AS_IT_WAS,
    GW_SITE_CHANGED, /* it has another content than before and has not been written to for a while: an editor
                        may still be at it */
    GW_SITE_GONE     /* there is no such file any more, for a while: editors replace it in a moment */
} gw_site_news;

/* path: a file, or anything else, which is not watched (a site inside the program, NULL). */
void gw_site_watch_begin(gw_site_watch *watch, const char *path);

/* What is new, once for every change. now: gw_now_ns(). */
gw_site_news gw_site_watch_look(gw_site_watch *watch, int64_t now);

#endif
