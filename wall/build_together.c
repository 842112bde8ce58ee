#include "wall/build_together.h"

#include "base/hash.h"
#include "base/memory.h"
#include "wall/mpi_wait.h"

#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_BYTES = 8 << 20, TAG_PART = 700, TAG_BYTES };

/* What a rank offers. */
typedef struct offer {
    gw_hash driver;
    int32_t machine;
    char renderer[100]; /* for the log */
} offer;

/* What rank 0 decides. */
typedef struct plan {
    uint32_t part_count; /* 0: nobody builds */
    int32_t ranks[GW_OCTREE_MAXIMUM_PARTS];
} plan;

/* How a builder's work went. */
typedef struct outcome {
    int32_t code;
    uint64_t size;
    char text[400];
} outcome;

static offer make_offer(const gw_gl *device, const gw_together_options *options, int rank) {
    const gw_gl_limits *limits = gw_gl_limits_of(device);
    offer own = {.machine = options->machine};
    own.driver = gw_hash_bytes(own.driver, limits->vendor, strlen(limits->vendor));
    own.driver = gw_hash_bytes(own.driver, limits->renderer, strlen(limits->renderer));
    own.driver = gw_hash_bytes(own.driver, limits->version, strlen(limits->version));
    snprintf(own.renderer, sizeof own.renderer, "%.90s", limits->renderer);
    if (options->fault == GW_BUILDER_FOREIGN && options->fault_rank == rank) {
        own.driver.low ^= 1;
        own.renderer[0] = '?';
    }
    return own;
}

static int has_builder(const plan *p, const offer *offers, int32_t machine) {
    for (uint32_t i = 0; i < p->part_count; i++)
        if (offers[p->ranks[i]].machine == machine)
            return 1;
    return 0;
}

/* Rank 0 always builds. */
static void choose(const offer *offers, int rank_count, const gw_together_options *options, plan *out) {
    uint32_t most = options->builders ? options->builders : GW_OCTREE_MAXIMUM_PARTS;
    for (int rank = 0; rank < rank_count && out->part_count < most; rank++) {
        if (out->part_count == GW_OCTREE_MAXIMUM_PARTS)
            break;
        if (!options->builders && has_builder(out, offers, offers[rank].machine))
            continue;
        if (gw_hash_equal(offers[rank].driver, offers[0].driver))
            out->ranks[out->part_count++] = rank;
        else
            gw_log_write(options->log, GW_LOG_WARNING,
                         "rank %d has another driver (%s): it builds no part of the octree", rank,
                         offers[rank].renderer);
    }
}

/* Every rank learns the plan. */
static gw_code agree(const gw_gl *device, const gw_together_options *options, int needed, plan *out,
                     gw_error *error) {
    int rank = 0, rank_count = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &rank_count);
    offer own = make_offer(device, options, rank);
    offer *offers = NULL;
    MPI_Request request;
    gw_code code = GW_OK;
    if (rank == 0)
        code = gw_allocate((void **)&offers, (size_t)rank_count, sizeof *offers, "builders", error);
    if (!code)
        code = gw_mpi_check(MPI_Igather(&own, (int)sizeof own, MPI_BYTE, offers, (int)sizeof own, MPI_BYTE, 0,
                                        MPI_COMM_WORLD, &request),
                            "finding builders", error);
    if (!code)
        code = gw_mpi_wait(&request, options->deadline, "waiting for all ranks to offer help", error);
    memset(out, 0, sizeof *out);
    if (!code && rank == 0 && needed)
        choose(offers, rank_count, options, out);
    free(offers);
    if (!code)
        code = gw_mpi_check(MPI_Ibcast(out, (int)sizeof *out, MPI_BYTE, 0, MPI_COMM_WORLD, &request),
                            "dividing the octree", error);
    return code ? code : gw_mpi_wait(&request, options->deadline, "waiting for the octree's division", error);
}

static gw_code wait_all(gw_code begun, MPI_Request *request, const gw_together_options *options,
                        const char *what, gw_error *error) {
    return begun ? begun : gw_mpi_wait(request, options->deadline, what, error);
}

/* A builder that is not rank 0: makes its part and sends it. A failure is told, not returned: rank 0 does the
 * work instead. */
static gw_code make_and_send(gw_gl *device, const gw_scene *scene, const gw_together_options *options,
                             const gw_octree_division *division, uint32_t part, int rank, gw_error *error) {
    static const char what[] = "sending a part of the octree";
    gw_octree_part made = {0};
    gw_error failure = {0};
    gw_octree_options how = {.settings = options->settings, .log = options->log};
    outcome result = {0};
    MPI_Request request;
    if (options->fault == GW_BUILDER_FAILING && options->fault_rank == rank)
        result.code = gw_fail(&failure, GW_MACHINE, "a failure made on purpose");
    else
        result.code = gw_octree_build_part(device, scene, &how, division, part, &made, &failure);
    result.size = made.size;
    snprintf(result.text, sizeof result.text, "%.390s", failure.text);
    gw_code code = gw_mpi_check(
        MPI_Isend(&result, (int)sizeof result, MPI_BYTE, 0, TAG_PART, MPI_COMM_WORLD, &request), what, error);
    code = wait_all(code, &request, options, what, error);
    for (size_t at = 0; !code && at < made.size; at += CHUNK_BYTES) {
        int size = made.size - at < CHUNK_BYTES ? (int)(made.size - at) : CHUNK_BYTES;
        code = gw_mpi_check(
            MPI_Isend((uint8_t *)made.data + at, size, MPI_BYTE, 0, TAG_BYTES, MPI_COMM_WORLD, &request),
            what, error);
        code = wait_all(code, &request, options, what, error);
    }
    free(made.data);
    return code;
}

static gw_code receive(int rank, const gw_together_options *options, outcome *result, gw_octree_part *out,
                       gw_error *error) {
    static const char what[] = "waiting for a part of the octree";
    MPI_Request request;
    gw_code code = gw_mpi_check(
        MPI_Irecv(result, (int)sizeof *result, MPI_BYTE, rank, TAG_PART, MPI_COMM_WORLD, &request), what,
        error);
    code = wait_all(code, &request, options, what, error);
    if (!code && result->size > 0)
        code = gw_allocate(&out->data, (size_t)result->size, 1, "a part of the octree", error);
    if (!code)
        out->size = (size_t)result->size;
    for (size_t at = 0; !code && at < out->size; at += CHUNK_BYTES) {
        int size = out->size - at < CHUNK_BYTES ? (int)(out->size - at) : CHUNK_BYTES;
        code = gw_mpi_check(
            MPI_Irecv((uint8_t *)out->data + at, size, MPI_BYTE, rank, TAG_BYTES, MPI_COMM_WORLD, &request),
            what, error);
        code = wait_all(code, &request, options, what, error);
    }
    return code ? gw_context(error, "rank %d", rank) : GW_OK;
}

/* Rank 0: its own part, then the others', then all of them joined. */
static gw_code collect(gw_gl *device, const gw_scene *scene, const gw_together_options *options,
                       const gw_octree_division *division, const plan *p, gw_octree_part *parts,
                       gw_together *who, gw_error *error) {
    gw_octree_options how = {.settings = options->settings, .log = options->log};
    gw_code code = GW_OK;
    for (uint32_t i = 0; !code && i < p->part_count; i++) {
        outcome result = {0};
        who->ranks[i] = p->ranks[i];
        if (i > 0)
            code = receive(p->ranks[i], options, &result, &parts[i], error);
        if (!code && result.code) {
            result.text[sizeof result.text - 1] = '\0';
            gw_log_write(options->log, GW_LOG_WARNING, "rank %d cannot build (%s): rank 0 builds its part",
                         p->ranks[i], result.text);
            who->ranks[i] = 0;
        }
        if (!code && (i == 0 || result.code))
            code = gw_octree_build_part(device, scene, &how, division, i, &parts[i], error);
        if (!code)
            who->overlap_tests[i] = gw_octree_part_statistics(&parts[i]).overlap_tests;
    }
    return code;
}

static gw_code build_alone(gw_gl *device, const gw_scene *scene, const gw_together_options *options,
                           gw_octree **octree, gw_together *who, gw_error *error) {
    gw_octree_options how = {.settings = options->settings, .log = options->log};
    gw_code code = gw_octree_build(device, scene, &how, octree, error);
    if (!code)
        who->overlap_tests[0] = (*octree)->statistics.overlap_tests;
    return code;
}

static gw_code build_and_join(gw_gl *device, const gw_scene *scene, const gw_together_options *options,
                              const gw_octree_division *division, const plan *p, gw_octree **octree,
                              gw_together *who, gw_error *error) {
    gw_octree_options how = {.settings = options->settings, .log = options->log};
    gw_octree_part *parts = NULL;
    gw_code code = gw_allocate((void **)&parts, p->part_count, sizeof *parts, "parts of the octree", error);
    if (!code)
        code = collect(device, scene, options, division, p, parts, who, error);
    int fit = !code && gw_octree_parts_fit(device, scene, &how, parts, p->part_count);
    if (fit)
        code = gw_octree_join(device, scene, &how, division, parts, octree, error);
    for (uint32_t i = 0; parts && i < p->part_count; i++)
        free(parts[i].data);
    free(parts);
    if (code || fit)
        return code;
    gw_log_write(options->log, GW_LOG_INFO,
                 "the parts of the octree are more than the memory budget: rank 0 builds it within that");
    *who = (gw_together){.part_count = 1, .ranks = {0}};
    return build_alone(device, scene, options, octree, who, error);
}

gw_code gw_build_together(gw_gl *device, const gw_scene *scene, const gw_together_options *options,
                          int needed, gw_octree **octree, gw_together *who, gw_error *error) {
    int rank = 0;
    plan p;
    gw_octree_division division;
    memset(who, 0, sizeof *who);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    gw_code code = agree(device, options, needed, &p, error);
    if (code || p.part_count == 0)
        return code;
    who->part_count = p.part_count;
    if (p.part_count == 1)
        return rank == 0 ? build_alone(device, scene, options, octree, who, error) : GW_OK;
    uint32_t part = 0;
    while (part < p.part_count && p.ranks[part] != rank)
        part++;
    if (part == p.part_count)
        return GW_OK;
    code = gw_octree_divide(scene, options->settings, p.part_count, &division, error);
    if (code)
        return code;
    who->split_level = division.level;
    return rank == 0 ? build_and_join(device, scene, options, &division, &p, octree, who, error)
                     : make_and_send(device, scene, options, &division, part, rank, error);
}
