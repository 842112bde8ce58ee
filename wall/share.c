#include "wall/share.h"

#include "wall/interrupt.h"
#include "wall/mpi_wait.h"

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
    return gw_mpi_check(
        MPI_Comm_split(MPI_COMM_WORLD, share->is_leader ? 0 : MPI_UNDEFINED, 0, &share->leaders),
        "finding the first rank of each machine", error);
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
static gw_code make_segment(gw_share *share, char name[NAME_BYTES], gw_error *error) {
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
    int failed = posix_fallocate(file, 0, (off_t)share->size);
    if (!failed) {
        share->block = mmap(NULL, share->size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        failed = share->block == MAP_FAILED ? errno : 0;
    }
    close(file);
    if (!failed)
        return GW_OK;
    share->block = NULL;
    return gw_fail(
        error, GW_MACHINE,
        "%s has no room for the scene and octree (%.0f MiB): %s; make it larger or lower octree_depth", path,
        (double)share->size / 1048576.0, strerror(failed));
}

static gw_code open_segment(gw_share *share, const char *name, gw_error *error) {
    int file = shm_open(name, O_RDONLY, 0);
    if (file < 0)
        return gw_fail(error, GW_MACHINE, "the shared segment %s could not be opened: %s", name,
                       strerror(errno));
    share->block = mmap(NULL, share->size, PROT_READ, MAP_SHARED, file, 0);
    int failed = share->block == MAP_FAILED ? errno : 0;
    close(file);
    if (!failed)
        return GW_OK;
    share->block = NULL;
    return gw_fail(error, GW_MACHINE, "the shared segment %s could not be mapped: %s", name,
                   strerror(failed));
}

/* Leaders: the bytes go from rank 0 to the first rank of every other machine, in chunks. */
static gw_code fill_segment(gw_share *share, const gw_scene *scene, const gw_octree *octree, int64_t deadline,
                            gw_error *error) {
    if (scene)
        gw_pack(scene, octree, share->block);
    int leader_count = 0;
    MPI_Comm_size(share->leaders, &leader_count);
    for (size_t offset = 0; leader_count > 1 && offset < share->size; offset += CHUNK_BYTES) {
        size_t left = share->size - offset;
        gw_code code =
            spread_bytes((uint8_t *)share->block + offset, left < CHUNK_BYTES ? (int)left : CHUNK_BYTES,
                         share->leaders, deadline, "sending the octree to other machines", error);
        if (code)
            return code;
    }
    if (mprotect(share->block, share->size, PROT_READ))
        return gw_fail(error, GW_MACHINE, "the shared segment could not be made read-only: %s",
                       strerror(errno));
    return GW_OK;
}

gw_code gw_share_spread(gw_share *share, const gw_scene *scene, const gw_octree *octree, int64_t deadline,
                        gw_error *error) {
    uint64_t size = scene ? gw_pack_size(scene, octree) : 0;
    char name[NAME_BYTES] = "";
    gw_code code = spread_bytes(&size, (int)sizeof size, MPI_COMM_WORLD, deadline,
                                "waiting for the scene and octree", error);
    if (code)
        return code;
    share->size = (size_t)size;
    if (share->is_leader) {
        gw_share_sweep();
        code = make_segment(share, name, error);
        if (!code)
            code = fill_segment(share, scene, octree, deadline, error);
        if (code) { /* the others wait for a name that never comes: the launcher ends them */
            remove_segment(name);
            return code;
        }
    }
    code = spread_bytes(name, NAME_BYTES, share->machine, deadline, "waiting for the shared segment", error);
    if (!code && !share->is_leader)
        code = open_segment(share, name, error);
    MPI_Request request;
    if (!code)
        code = gw_mpi_check(MPI_Ibarrier(share->machine, &request), "mapping the shared segment", error);
    if (!code)
        code = gw_mpi_wait(&request, deadline, "mapping the shared segment", error);
    if (share->is_leader)
        remove_segment(name);
    return code ? code : gw_unpack(share->block, share->size, &share->contents, error);
}

void gw_share_finish(gw_share *share) {
    gw_unpacked_finish(&share->contents);
    if (share->block)
        munmap(share->block, share->size);
    share->block = NULL;
}
