#include "wall/mpirun_sweep.h"

#include <ftw.h>
#include <glob.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *place) {
    (void)status;
    (void)kind;
    (void)place;
    (void)remove(path);
    return 0;
}

static void remove_tree(const char *path) {
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

static void remove_folder(const char *path) {
    (void)rmdir(path);
}

static void remove_segment(const char *path) {
    (void)unlink(path);
}

static void for_each(const char *pattern, void (*act)(const char *path)) {
    glob_t found;
    if (glob(pattern, GLOB_NOSORT, NULL, &found))
        return;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        struct stat status;
        if (!lstat(found.gl_pathv[i], &status) && status.st_uid == geteuid())
            act(found.gl_pathv[i]);
    }
    globfree(&found);
}

void gw_mpirun_sweep(pid_t mpirun, uint32_t job) {
    char pattern[4096];
    const unsigned user = (unsigned)geteuid();
    const char *folder = getenv("TMPDIR");
    snprintf(pattern, sizeof pattern, "%s/ompi.*.%u/pid.%ld", folder && *folder ? folder : "/tmp", user,
             (long)mpirun);
    for_each(pattern, remove_tree);
    /* The folder of all runs of this user, if this was the last: rmdir() leaves one that is not empty. */
    snprintf(pattern, sizeof pattern, "%s/ompi.*.%u", folder && *folder ? folder : "/tmp", user);
    for_each(pattern, remove_folder);
    if (!job)
        return;
    snprintf(pattern, sizeof pattern, "/dev/shm/vader_segment.*.%u.%" PRIx32 ".*", user, job);
    for_each(pattern, remove_segment);
}
