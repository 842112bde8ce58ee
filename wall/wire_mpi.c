#include "wall/wire_mpi.h"

#include "base/memory.h"
#include "wall/mpi_wait.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

enum { TAG_MESSAGE = 1, TAG_BLOCK, CHUNK_BYTES = 4 << 20 };

typedef struct mpi_wire {
    gw_wire wire;
    int rank;
    MPI_Request sending, receiving, block;
    size_t block_done; /* bytes of the block in work that went before the chunk in work */
    uint8_t outgoing[GW_WIRE_MESSAGE], incoming[GW_WIRE_MESSAGE];
} mpi_wire;

static gw_wire_result test(MPI_Request *request, MPI_Status *status) {
    int done = 0;
    if (MPI_Test(request, &done, status) != MPI_SUCCESS)
        return GW_WIRE_BROKEN;
    return done ? GW_WIRE_DONE : GW_WIRE_NOT_YET;
}

static gw_wire_result send_message(gw_wire *wire, const void *message, size_t size) {
    mpi_wire *w = (mpi_wire *)wire;
    gw_wire_result before = test(&w->sending, MPI_STATUS_IGNORE);
    if (before != GW_WIRE_DONE)
        return before;
    memcpy(w->outgoing, message, size);
    return MPI_Isend(w->outgoing, (int)size, MPI_BYTE, w->rank, TAG_MESSAGE, MPI_COMM_WORLD, &w->sending) ==
                   MPI_SUCCESS
               ? GW_WIRE_DONE
               : GW_WIRE_BROKEN;
}

static gw_wire_result receive_message(gw_wire *wire, void *message, size_t *size) {
    mpi_wire *w = (mpi_wire *)wire;
    MPI_Status status;
    int bytes = 0;
    /* What was sent goes on its way only while somebody asks. */
    if (w->sending != MPI_REQUEST_NULL && test(&w->sending, MPI_STATUS_IGNORE) == GW_WIRE_BROKEN)
        return GW_WIRE_BROKEN;
    if (w->receiving == MPI_REQUEST_NULL && MPI_Irecv(w->incoming, GW_WIRE_MESSAGE, MPI_BYTE, w->rank,
                                                      TAG_MESSAGE, MPI_COMM_WORLD, &w->receiving))
        return GW_WIRE_BROKEN;
    gw_wire_result result = test(&w->receiving, &status);
    if (result != GW_WIRE_DONE)
        return result;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    *size = (size_t)bytes;
    memcpy(message, w->incoming, *size);
    return GW_WIRE_DONE;
}

/* The next chunk of a block once the one before has gone; direction is given by `receive`. */
static gw_wire_result move_block(mpi_wire *w, void *block, size_t size, int receive) {
    for (;;) {
        int begun = w->block != MPI_REQUEST_NULL;
        gw_wire_result result = begun ? test(&w->block, MPI_STATUS_IGNORE) : GW_WIRE_DONE;
        if (result != GW_WIRE_DONE)
            return result;
        size_t left = size - w->block_done, chunk = left < CHUNK_BYTES ? left : CHUNK_BYTES;
        if (begun) {
            w->block_done += chunk;
            left -= chunk;
            chunk = left < CHUNK_BYTES ? left : CHUNK_BYTES;
        }
        if (!left) {
            w->block_done = 0;
            return GW_WIRE_DONE;
        }
        uint8_t *at = (uint8_t *)block + w->block_done;
        int failed = receive
                         ? MPI_Irecv(at, (int)chunk, MPI_BYTE, w->rank, TAG_BLOCK, MPI_COMM_WORLD, &w->block)
                         : MPI_Isend(at, (int)chunk, MPI_BYTE, w->rank, TAG_BLOCK, MPI_COMM_WORLD, &w->block);
        if (failed)
            return GW_WIRE_BROKEN;
    }
}

static gw_wire_result send_block(gw_wire *wire, const void *block, size_t size) {
    return move_block((mpi_wire *)wire, (void *)(uintptr_t)block, size, 0);
}

static gw_wire_result receive_block(gw_wire *wire, void *block, size_t size) {
    return move_block((mpi_wire *)wire, block, size, 1);
}

static int is_sent(gw_wire *wire) {
    return test(&((mpi_wire *)wire)->sending, MPI_STATUS_IGNORE) != GW_WIRE_NOT_YET;
}

static void close_wire(gw_wire *wire) {
    const mpi_wire *w = (const mpi_wire *)wire;
    /* A posted receive, or what a dead rank never took, stays MPI's until the process ends. */
    if (w->sending == MPI_REQUEST_NULL && w->receiving == MPI_REQUEST_NULL && w->block == MPI_REQUEST_NULL)
        free(wire);
}

gw_code gw_wire_mpi(int rank, gw_wire **out, gw_error *error) {
    mpi_wire *w = NULL;
    gw_code code = gw_allocate((void **)&w, 1, sizeof *w, "line to a rank", error);
    if (code)
        return code;
    w->wire = (gw_wire){.send = send_message,
                        .receive = receive_message,
                        .send_block = send_block,
                        .receive_block = receive_block,
                        .is_sent = is_sent,
                        .close = close_wire,
                        .descriptor = -1};
    w->rank = rank;
    w->sending = w->receiving = w->block = MPI_REQUEST_NULL;
    *out = &w->wire;
    return GW_OK;
}

gw_code gw_ranks_meet(const gw_share *share, gw_acquaintance *everybody, uint64_t *nonce, int64_t deadline,
                      gw_error *error) {
    gw_acquaintance own = {.process = getpid(), .machine = share->leader};
    MPI_Request request;
    if (everybody && getrandom(nonce, sizeof *nonce, 0) != (ssize_t)sizeof *nonce)
        return gw_fail(error, GW_MACHINE, "the kernel gives no random numbers: %s", strerror(errno));
    gw_code code = gw_mpi_check(MPI_Ibcast(nonce, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD, &request),
                                "meeting the ranks", error);
    if (!code)
        code = gw_mpi_wait(&request, deadline, "meeting the ranks", error);
    if (!code)
        code = gw_mpi_check(MPI_Igather(&own, (int)sizeof own, MPI_BYTE, everybody, (int)sizeof own, MPI_BYTE,
                                        0, MPI_COMM_WORLD, &request),
                            "meeting the ranks", error);
    return code ? code : gw_mpi_wait(&request, deadline, "meeting the ranks", error);
}
