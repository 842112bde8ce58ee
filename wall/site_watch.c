#include "wall/site_watch.h"

#include <string.h>

static const int64_t quiet = 50 * INT64_C(1000000); /* ns without a change, before the file is read */

static int alike(const struct stat *a, const struct stat *b) {
    return a->st_ino == b->st_ino && a->st_dev == b->st_dev && a->st_size == b->st_size &&
           a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec &&
           a->st_ctim.tv_sec == b->st_ctim.tv_sec && a->st_ctim.tv_nsec == b->st_ctim.tv_nsec;
}

void gw_site_watch_begin(gw_site_watch *watch, const char *path) {
    memset(watch, 0, sizeof *watch);
    if (path && stat(path, &watch->taken) == 0 && S_ISREG(watch->taken.st_mode))
        watch->path = path;
}

int gw_site_watch_changed(gw_site_watch *watch, int64_t now) {
    struct stat seen;
    /* A file that is gone for a moment is being replaced. */
    if (!watch->path || stat(watch->path, &seen) || alike(&seen, &watch->taken)) {
        watch->since = 0;
        return 0;
    }
    if (!watch->since || !alike(&seen, &watch->candidate)) {
        watch->candidate = seen;
        watch->since = now;
        return 0;
    }
    if (now - watch->since < quiet)
        return 0;
    watch->taken = seen;
    watch->since = 0;
    return 1;
}
