#include "wall/gate.h"

#include "base/clock.h"
#include "base/memory.h"
#include "wall/mpi_wait.h"

#include <mpi.h>
#include <stdlib.h>
#include <string.h>

enum { TAG_RELEASE = 1, TAG_DONE, TAG_PIXELS, TAG_LEFT };
enum { CHUNK_BYTES = 4 << 20, QUIT_PATIENCE_MS = 2000 };

/* What rank 0 waits for from a tile. */
typedef enum stage { EXPECT_NOTHING, EXPECT_DONE, EXPECT_PIXELS, EXPECT_LEFT } stage;

typedef struct member {
    gw_gate_tile tile;
    stage stage;
    int rank;
    MPI_Request sending, receiving;
    gw_release release; /* stays untouched while it is being sent */
    gw_done incoming;
    size_t pixel_bytes, received;
    int64_t heard; /* ns, when something last came from it */
} member;

struct gw_gate {
    uint32_t count; /* tiles of the layout; member 0 is not used */
    member *members;
};

gw_code gw_gate_create(const gw_layout *layout, gw_gate **out, gw_error *error) {
    gw_gate *gate = NULL;
    gw_code code = gw_allocate((void **)&gate, 1, sizeof *gate, "frame gate", error);
    if (code)
        return code;
    gate->count = layout->tile_count;
    code = gw_allocate((void **)&gate->members, gate->count, sizeof *gate->members, "frame gate", error);
    for (uint32_t i = 1; i < gate->count && !code; i++) {
        member *m = &gate->members[i];
        const gw_rectangle *rectangle = &layout->tiles[i].rectangle;
        m->rank = (int)i;
        m->sending = m->receiving = MPI_REQUEST_NULL;
        m->pixel_bytes = (size_t)rectangle->width * rectangle->height * 4;
        code = gw_allocate((void **)&m->tile.pixels, m->pixel_bytes, 1, "pixels of a tile", error);
    }
    if (code)
        gw_gate_destroy(&gate);
    *out = gate;
    return code;
}

void gw_gate_destroy(gw_gate **gate) {
    if (!*gate)
        return;
    for (uint32_t i = 1; (*gate)->members && i < (*gate)->count; i++)
        free((*gate)->members[i].tile.pixels);
    free((*gate)->members);
    free(*gate);
    *gate = NULL;
}

const gw_gate_tile *gw_gate_tile_of(const gw_gate *gate, uint32_t tile) {
    return &gate->members[tile].tile;
}

static gw_code send_release(member *m, const gw_release *release, gw_error *error) {
    m->release = *release;
    gw_code code = gw_mpi_check(MPI_Isend(&m->release, (int)sizeof m->release, MPI_BYTE, m->rank, TAG_RELEASE,
                                          MPI_COMM_WORLD, &m->sending),
                                "releasing a frame", error);
    if (!code)
        code = gw_mpi_check(MPI_Irecv(&m->incoming, (int)sizeof m->incoming, MPI_BYTE, m->rank,
                                      release->kind == GW_RELEASE_QUIT ? TAG_LEFT : TAG_DONE, MPI_COMM_WORLD,
                                      &m->receiving),
                            "expecting a tile", error);
    m->stage = release->kind == GW_RELEASE_QUIT ? EXPECT_LEFT : EXPECT_DONE;
    m->heard = gw_now_ns();
    return code;
}

gw_code gw_gate_release(gw_gate *gate, const gw_release *release, gw_error *error) {
    gw_code code = GW_OK;
    for (uint32_t i = 1; i < gate->count && !code; i++) {
        member *m = &gate->members[i];
        m->tile.complete = 0;
        if (m->tile.state == GW_TILE_LIVE)
            code = send_release(m, release, error);
    }
    return code;
}

static gw_code expect_pixels(member *m, gw_error *error) {
    size_t left = m->pixel_bytes - m->received;
    m->stage = EXPECT_PIXELS;
    return gw_mpi_check(MPI_Irecv(m->tile.pixels + m->received, left < CHUNK_BYTES ? (int)left : CHUNK_BYTES,
                                  MPI_BYTE, m->rank, TAG_PIXELS, MPI_COMM_WORLD, &m->receiving),
                        "expecting a tile's pixels", error);
}

/* What a tile is waited for has come: go to its next stage. */
static gw_code advance(member *m, gw_error *error) {
    m->heard = gw_now_ns();
    if (m->stage == EXPECT_DONE) {
        m->tile.done = m->incoming;
        m->tile.done.text[sizeof m->tile.done.text - 1] = '\0';
        m->received = 0;
        if (m->release.pixels && m->tile.done.code == GW_OK)
            return expect_pixels(m, error);
    } else if (m->stage == EXPECT_PIXELS) {
        m->received +=
            m->pixel_bytes - m->received < CHUNK_BYTES ? m->pixel_bytes - m->received : CHUNK_BYTES;
        if (m->received < m->pixel_bytes)
            return expect_pixels(m, error);
    }
    m->stage = EXPECT_NOTHING;
    m->tile.complete = 1;
    return GW_OK;
}

/* One look at every tile that is waited for; *waiting counts those, *moved says that something came. */
static gw_code look(gw_gate *gate, uint32_t *waiting, int *moved, gw_error *error) {
    *waiting = 0;
    *moved = 0;
    for (uint32_t i = 1; i < gate->count; i++) {
        member *m = &gate->members[i];
        if (m->tile.state != GW_TILE_LIVE || m->stage == EXPECT_NOTHING)
            continue;
        int received = 0, sent = 0;
        gw_code code =
            gw_mpi_check(MPI_Test(&m->sending, &sent, MPI_STATUS_IGNORE), "releasing a frame", error);
        if (!code && sent)
            code = gw_mpi_check(MPI_Test(&m->receiving, &received, MPI_STATUS_IGNORE), "expecting a tile",
                                error);
        if (!code && received) {
            code = advance(m, error);
            *moved = 1;
        }
        if (code)
            return code;
        *waiting += m->stage != EXPECT_NOTHING;
    }
    return GW_OK;
}

gw_code gw_gate_collect(gw_gate *gate, int64_t patience, uint32_t *lost, gw_error *error) {
    *lost = 0;
    int64_t nap = 0, begin = gw_now_ns();
    for (;;) {
        uint32_t waiting;
        int moved;
        gw_code code = look(gate, &waiting, &moved, error);
        if (code || !waiting)
            return code;
        if (moved) {
            nap = 0;
            continue;
        }
        int64_t now = gw_now_ns();
        for (uint32_t i = 1; i < gate->count; i++) {
            member *m = &gate->members[i];
            /* Not counted from the release: rank 0 drew its own tile meanwhile and listened to nobody. */
            int64_t since = m->heard > begin ? m->heard : begin;
            if (m->tile.state == GW_TILE_LIVE && m->stage != EXPECT_NOTHING && now - since > patience) {
                m->tile.state = GW_TILE_LOST;
                m->tile.lost_frame = m->release.state.frame;
                (*lost)++;
            }
        }
        gw_mpi_nap(&nap);
    }
}

void gw_gate_quit(gw_gate *gate) {
    gw_error ignored = {0};
    gw_release quit = {.kind = GW_RELEASE_QUIT};
    for (uint32_t i = 1; i < gate->count; i++) {
        member *m = &gate->members[i];
        if (m->tile.state == GW_TILE_LIVE) {
            send_release(m, &quit, &ignored);
        } else {
            /* It may only be slow: the word waits for it in its queue. Its last release may still be on its
             * way, so that one's memory is left alone. */
            MPI_Request forgotten;
            static const gw_release last_word = {.kind = GW_RELEASE_QUIT};
            if (MPI_Isend(&last_word, (int)sizeof last_word, MPI_BYTE, m->rank, TAG_RELEASE, MPI_COMM_WORLD,
                          &forgotten) == MPI_SUCCESS)
                MPI_Request_free(&forgotten);
        }
    }
    uint32_t lost;
    gw_gate_collect(gate, QUIT_PATIENCE_MS * INT64_C(1000000), &lost, &ignored);
}

gw_code gw_gate_wait(gw_release *out, int64_t patience, gw_error *error) {
    MPI_Request request;
    gw_code code =
        gw_mpi_check(MPI_Irecv(out, (int)sizeof *out, MPI_BYTE, 0, TAG_RELEASE, MPI_COMM_WORLD, &request),
                     "waiting for rank 0", error);
    return code ? code : gw_mpi_wait(&request, gw_now_ns() + patience, "waiting for rank 0", error);
}

static gw_code send_patiently(const void *data, int size, int tag, gw_error *error) {
    MPI_Request request;
    gw_code code = gw_mpi_check(MPI_Isend(data, size, MPI_BYTE, 0, tag, MPI_COMM_WORLD, &request),
                                "answering rank 0", error);
    return code ? code : gw_mpi_wait(&request, 0, "answering rank 0", error);
}

gw_code gw_gate_answer(const gw_done *done, const uint8_t *pixels, size_t size, gw_error *error) {
    gw_code code = send_patiently(done, (int)sizeof *done, TAG_DONE, error);
    for (size_t offset = 0; pixels && offset < size && !code; offset += CHUNK_BYTES) {
        size_t left = size - offset;
        code =
            send_patiently(pixels + offset, left < CHUNK_BYTES ? (int)left : CHUNK_BYTES, TAG_PIXELS, error);
    }
    return code;
}

void gw_gate_leave(void) {
    gw_error ignored = {0};
    gw_done left = {0};
    send_patiently(&left, (int)sizeof left, TAG_LEFT, &ignored);
}
