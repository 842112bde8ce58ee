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
} gw_site_watch;

/* path: a file, or anything else, which is not watched (a site inside the program, NULL). */
void gw_site_watch_begin(gw_site_watch *watch, const char *path);

/* 1, once for every change, when the file has another content than before and has not been written to for a
 * while: an editor may still be at it. now: gw_now_ns(). */
int gw_site_watch_changed(gw_site_watch *watch, int64_t now);

#endif
