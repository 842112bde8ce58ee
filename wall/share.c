#include "wall/share.h"

#include "base/hash.h"
#include "build/pack_octree.h"
#include "wall/interrupt.h"
#include "wall/mpi_wait.h"
#include "wall/share_kept.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHUNK_BYTES = 8 << 20, NAME_BYTES = 64 };
#define SHARED_MEMORY_FOLDER "/dev/shm"
#define SEGMENT_PREFIX "gazewall-"

int gw_share_sweep(void) {
    DIR *folder = opendir(SHARED_MEMORY_FOLDER);
    if (!folder)
        return 0;
    int swept = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        size_t length = strlen(SEGMENT_PREFIX);
        if (strncmp(entry->d_name, SEGMENT_PREFIX, length))
            continue;
        char *end;
        long owner = strtol(entry->d_name + length, &end, 10);
        struct stat status;
        if (*end != '-' || owner <= 1 || fstatat(dirfd(folder), entry->d_name, &status, AT_SYMLINK_NOFOLLOW))
            continue;
        if (status.st_uid == geteuid() && kill((pid_t)owner, 0) && errno == ESRCH)
            swept += !unlinkat(dirfd(folder), entry->d_name, 0);
    }
    closedir(folder);
    return swept;
}

gw_code gw_share_init(gw_share *share, int machines, gw_error *error) {
    memset(share, 0, sizeof *share);
    share->leaders = MPI_COMM_NULL;
    int rank = 0, size = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    int split = machines > 1 ? MPI_Comm_split(MPI_COMM_WORLD, rank * machines / size, 0, &share->machine)
                             : MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL,
                                                   &share->machine);
    gw_code code = gw_mpi_check(split, "finding the ranks of this machine", error);
    if (code)
        return code;
    MPI_Comm_rank(share->machine, &rank);
    share->is_leader = rank == 0;
    code =
        gw_mpi_check(MPI_Comm_split(MPI_COMM_WORLD, share->is_leader ? 0 : MPI_UNDEFINED, 0, &share->leaders),
                     "finding the first rank of each machine", error);
    if (!code && share->is_leader)
        MPI_Comm_size(share->leaders, &share->machine_count);
    MPI_Comm_rank(MPI_COMM_WORLD, &share->leader);
    return code ? code
                : gw_mpi_check(MPI_Bcast(&share->leader, 1, MPI_INT, 0, share->machine),
                               "finding the first rank of this machine", error);
}

static gw_code spread_bytes(void *data, int size, MPI_Comm ranks, int64_t deadline, const char *what,
                            gw_error *error) {
    MPI_Request request;
    gw_code code = gw_mpi_check(MPI_Ibcast(data, size, MPI_BYTE, 0, ranks, &request), what, error);
    return code ? code : gw_mpi_wait(&request, deadline, what, error);
}

/* Takes the segment's name away; mappings of it stay. Nothing happens when it has none. */
static void remove_segment(const char *name) {
    if (name[0])
        shm_unlink(name);
    gw_interrupt_unlink(NULL);
}

/* Makes the segment with all its memory, so that a full /dev/shm is an error here and not a signal later. */
static gw_code make_segment(gw_segment *segment, char name[NAME_BYTES], gw_error *error) {
    uint64_t nonce = 0;
    if (getrandom(&nonce, sizeof nonce, 0) != (ssize_t)sizeof nonce)
        return gw_fail(error, GW_MACHINE, "the kernel gives no random numbers: %s", strerror(errno));
    snprintf(name, NAME_BYTES, "/" SEGMENT_PREFIX "%ld-%016llx", (long)getpid(), (unsigned long long)nonce);
    char path[NAME_BYTES + sizeof SHARED_MEMORY_FOLDER];
    snprintf(path, sizeof path, "%s%s", SHARED_MEMORY_FOLDER, name);

    gw_interrupt_hold();
    int file = shm_open(name, O_RDWR | O_CREAT | O_EXCL, 0600);
    if (file >= 0)
        gw_interrupt_unlink(path);
    gw_interrupt_release();
    if (file < 0) {
        name[0] = '\0';
        return gw_fail(error, GW_MACHINE, "the shared segment %s could not be made: %s", path,
                       strerror(errno));
    }
    int failed = posix_fallocate(file, 0, (off_t)segment->size);
    if (!failed) {
        segment->block = mmap(NULL, segment->size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        failed = segment->block == MAP_FAILED ? errno : 0;
    }
    close(file);
    if (!failed)
        return GW_OK;
    segment->block = NULL;
    return gw_fail(
        error, GW_MACHINE,
        "%s has no room for the scene and octree (%.0f MiB): %s; make it larger or lower octree_depth", path,
        (double)segment->size / 1048576.0, strerror(failed));
}

static gw_code open_segment(gw_segment *segment, const char *name, gw_error *error) {
    int file = shm_open(name, O_RDONLY, 0);
    if (file < 0)
        return gw_fail(error, GW_MACHINE, "the shared segment %s could not be opened: %s", name,
                       strerror(errno));
    segment->block = mmap(NULL, segment->size, PROT_READ, MAP_SHARED, file, 0);
    int failed = segment->block == MAP_FAILED ? errno : 0;
    close(file);
    if (!failed)
        return GW_OK;
    segment->block = NULL;
    return gw_fail(error, GW_MACHINE, "the shared segment %s could not be mapped: %s", name,
                   strerror(failed));
}

/* What rank 0 shares: writes the block's bytes. */
typedef struct source {
    const gw_scene *scene;
    const gw_octree *octree;
} source;

static size_t source_size(const source *from) {
    return from->scene    ? gw_pack_scene_size(from->scene)
           : from->octree ? gw_pack_octree_size(from->octree)
                          : 0;
}

static void write_source(const source *from, void *block) {
    if (from->scene)
        gw_pack_scene(from->scene, block);
    else if (from->octree)
        gw_pack_octree(from->octree, block);
}

/* --- from rank 0 to every machine
 * -------------------------------------------------------------------------------- */

/* Leaders: the bytes go from rank 0 to the first rank of every other machine, in chunks. */
static gw_code send_block(gw_share *share, const gw_segment *segment, const char *what, int64_t deadline,
                          gw_error *error) {
    for (size_t offset = 0; offset < segment->size; offset += CHUNK_BYTES) {
        size_t left = segment->size - offset;
        gw_code code =
            spread_bytes((uint8_t *)segment->block + offset, left < CHUNK_BYTES ? (int)left : CHUNK_BYTES,
                         share->leaders, deadline, what, error);
        if (code)
            return code;
    }
    return GW_OK;
}

/* Several machines: nothing is sent when all have kept the block of an earlier run. */
static gw_code send_if_needed(gw_share *share, const gw_segment *segment, gw_hash key, const char *what,
                              const gw_share_options *options, gw_error *error) {
    int rank = 0, has = 1, all_have = 0;
    MPI_Request request;
    MPI_Comm_rank(share->leaders, &rank);
    gw_code code = spread_bytes(&key, (int)sizeof key, share->leaders, options->deadline, what, error);
    if (!code && rank > 0)
        has = gw_kept_read(options->cache, key, segment->block, segment->size, options->log);
    if (!code)
        code = gw_mpi_check(MPI_Iallreduce(&has, &all_have, 1, MPI_INT, MPI_MIN, share->leaders, &request),
                            what, error);
    if (!code)
        code = gw_mpi_wait(&request, options->deadline, what, error);
    if (!code && all_have)
        gw_log_write(options->log, GW_LOG_INFO, "%s: every machine has kept it", what);
    if (code || all_have)
        return code;
    code = send_block(share, segment, what, options->deadline, error);
    if (!code && rank > 0 && !has)
        gw_kept_write(options->cache, key, segment->block, segment->size, options->cache_limit, options->log);
    return code;
}

static gw_code fill_segment(gw_share *share, gw_segment *segment, const source *from, const char *what,
                            const gw_share_options *options, gw_error *error) {
    write_source(from, segment->block);
    const int first = from->scene || from->octree;
    if (first && (share->machine_count > 1 || options->restarts))
        segment->key = gw_hash_bytes((gw_hash){0, 0}, segment->block, segment->size);
    /* The octree is in the cache of rank 0's machine already. */
    if (from->scene && options->restarts && !gw_kept_has(options->cache, segment->key))
        gw_kept_write(options->cache, segment->key, segment->block, segment->size, options->cache_limit,
                      options->log);
    gw_code code =
        share->machine_count > 1 ? send_if_needed(share, segment, segment->key, what, options, error) : GW_OK;
    if (!code && mprotect(segment->block, segment->size, PROT_READ))
        code =
            gw_fail(error, GW_MACHINE, "the shared segment could not be made read-only: %s", strerror(errno));
    return code;
}

/* One block from rank 0 to a segment of every machine. */
static gw_code spread(gw_share *share, gw_segment *segment, const source *from, const char *what,
                      const gw_share_options *options, gw_error *error) {
    uint64_t size = source_size(from);
    char name[NAME_BYTES] = "";
    gw_code code = spread_bytes(&size, (int)sizeof size, MPI_COMM_WORLD, options->deadline, what, error);
    if (code)
        return code;
    segment->size = (size_t)size;
    if (share->is_leader) {
        gw_share_sweep();
        code = make_segment(segment, name, error);
        if (!code)
            code = fill_segment(share, segment, from, what, options, error);
        if (code) { /* the others wait for a name that never comes: the launcher ends them */
            remove_segment(name);
            return code;
        }
    }
    code = spread_bytes(name, NAME_BYTES, share->machine, options->deadline, what, error);
    if (!code && !share->is_leader)
        code = open_segment(segment, name, error);
    MPI_Request request;
    if (!code)
        code = gw_mpi_check(MPI_Ibarrier(share->machine, &request), what, error);
    if (!code)
        code = gw_mpi_wait(&request, options->deadline, what, error);
    if (share->is_leader)
        remove_segment(name);
    return code;
}

gw_code gw_share_scene(gw_share *share, const gw_scene *scene, const gw_share_options *options,
                       gw_error *error) {
    gw_segment *segment = &share->scene_segment;
    const source from = {.scene = scene};
    gw_code code = spread(share, segment, &from, "waiting for the scene", options, error);
    return code ? code : gw_unpack_scene(segment->block, segment->size, &share->scene, error);
}

gw_code gw_share_octree(gw_share *share, const gw_octree *octree, const gw_share_options *options,
                        gw_error *error) {
    gw_segment *segment = &share->octree_segment;
    const source from = {.octree = octree};
    gw_code code = spread(share, segment, &from, "waiting for the octree", options, error);
    return code ? code : gw_unpack_octree(segment->block, segment->size, &share->octree, error);
}

static void unmap(gw_segment *segment) {
    if (segment->block)
        munmap(segment->block, segment->size);
    *segment = (gw_segment){0};
}

void gw_share_finish(gw_share *share) {
    gw_unpacked_scene_finish(&share->scene);
    unmap(&share->scene_segment);
    unmap(&share->octree_segment);
}
