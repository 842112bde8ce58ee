#include "wall/site_watch.h"

#include <string.h>

static const int64_t quiet = 50 * INT64_C(1000000);    /* ns without a change, before the file is read */
static const int64_t absent = 2 * INT64_C(1000000000); /* ns without a file, before that is told */

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

static gw_site_news miss(gw_site_watch *watch, int64_t now) {
    watch->since = 0;
    watch->gone = watch->gone ? watch->gone : now;
    if (watch->told_gone || now - watch->gone < absent)
        return GW_SITE_AS_IT_WAS;
    watch->told_gone = 1;
    return GW_SITE_GONE;
}

gw_site_news gw_site_watch_look(gw_site_watch *watch, int64_t now) {
    struct stat seen;
    if (!watch->path)
        return GW_SITE_AS_IT_WAS;
    if (stat(watch->path, &seen))
        return miss(watch, now);
    watch->gone = watch->told_gone = 0;
    if (alike(&seen, &watch->taken)) {
        watch->since = 0;
        return GW_SITE_AS_IT_WAS;
    }
    if (!watch->since || !alike(&seen, &watch->candidate)) {
        watch->candidate = seen;
        watch->since = now;
        return GW_SITE_AS_IT_WAS;
    }
    if (now - watch->since < quiet)
        return GW_SITE_AS_IT_WAS;
    watch->taken = seen;
    watch->since = 0;
    return GW_SITE_CHANGED;
}
