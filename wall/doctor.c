#include "wall/doctor.h"

#include "base/memory.h"
#include "wall/link.h"
#include "wall/reach.h"

#include <errno.h>
#include <inttypes.h>
#include <mpi.h>
#include <netdb.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { SSH_PORT = 22, REACH_MS = 3000, ANSWER_MS = 10000, DEVICE_MS = 60000, CLOCK_ROUNDS = 7 };

static const double enough_memory = 1024.0 * 1024 * 1024, enough_segments = 256.0 * 1024 * 1024,
                    mebibyte = 1024.0 * 1024;

void gw_doctor_find(gw_doctor *doctor, gw_finding finding, gw_code code, const char *where,
                    const char *format, ...) {
    static const char *const marks[] = {"good", "mind", "WRONG"};
    doctor->counts[finding]++;
    if (finding == GW_FINDING_WRONG && doctor->code == GW_OK)
        doctor->code = code;
    if (doctor->quiet && finding == GW_FINDING_GOOD)
        return;
    printf("%-5s  %-12s  ", marks[finding], where);
    va_list arguments;
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    putchar('\n');
    fflush(stdout);
}

#define GOOD(where, ...) gw_doctor_find(d, GW_FINDING_GOOD, GW_OK, where, __VA_ARGS__)
#define MIND(where, ...) gw_doctor_find(d, GW_FINDING_MIND, GW_OK, where, __VA_ARGS__)
#define WRONG(code, where, ...) gw_doctor_find(d, GW_FINDING_WRONG, code, where, __VA_ARGS__)

/* --- this machine
 * ----------------------------------------------------------------------------------------- */

static void examine_mpirun(gw_doctor *d) {
    char line[256] = "", all[256];
    FILE *mpirun = popen("mpirun --enable-recovery --version 2>&1", "re");
    if (mpirun) {
        if (!fgets(line, sizeof line, mpirun))
            line[0] = '\0';
        while (fgets(all, sizeof all, mpirun))
            ;
        pclose(mpirun);
    }
    line[strcspn(line, "\n")] = '\0';
    if (strstr(line, "unknown option") || strstr(line, "unrecognized"))
        WRONG(GW_MACHINE, "mpirun",
              "it does not know --enable-recovery (%s): one dead tile would end all; install Open MPI 4.1",
              line);
    else if (!strstr(line, "Open MPI"))
        WRONG(GW_MACHINE, "mpirun", "it cannot be started (%s); install openmpi-bin", line);
    else
        GOOD("mpirun", "%s, knows --enable-recovery", line);
}

/* --- the way to a host
 * ------------------------------------------------------------------------------------ */

static int is_ssh(const char *agent) {
    const char *end = agent + strcspn(agent, " "), *name = end;
    while (name > agent && name[-1] != '/')
        name--;
    return end - name == 3 && !strncmp(name, "ssh", 3);
}

/* 1 when it is worth while to go on. */
static int examine_way(gw_doctor *d, const gw_host *h) {
    if (h->resolve_failed) {
        WRONG(GW_BAD_INPUT, h->name,
              "its name does not resolve: %s; correct it in the site file, or add it to "
              "/etc/hosts or the name server",
              gai_strerror(h->resolve_failed));
        return 0;
    }
    GOOD(h->name, "its name resolves to %s", h->address);
    gw_reach reach = h->route_failed ? GW_REACH_NO_ROUTE : gw_reach_tcp(h->address, SSH_PORT, REACH_MS, NULL);
    int failed = h->route_failed ? h->route_failed : errno;
    switch (reach) {
    case GW_REACHED:
        GOOD(h->name, "port %d answers", SSH_PORT);
        return 1;
    case GW_REACH_REFUSED:
        if (is_ssh(d->agent)) {
            WRONG(GW_MACHINE, h->name,
                  "port %d is closed: it is there, but runs no ssh server; install openssh-server on it",
                  SSH_PORT);
            return 0;
        }
        GOOD(h->name, "it is there (port %d is closed, and '%s' does not need it)", SSH_PORT, d->agent);
        return 1;
    case GW_REACH_TIMED_OUT:
        WRONG(GW_MACHINE, h->name,
              "no answer from %s in %d s: is it switched on, or does a firewall drop port %d?", h->address,
              REACH_MS / 1000, SSH_PORT);
        return 0;
    case GW_REACH_NO_ROUTE:
        WRONG(GW_MACHINE, h->name, "no way to %s: %s; see to cable, switch and network mask", h->address,
              strerror(failed));
        return 0;
    default:
        WRONG(GW_MACHINE, h->name, "%s cannot be asked: %s", h->address, strerror(failed));
        return 0;
    }
}

/* --- on a host
 * -------------------------------------------------------------------------------------------- */

static const char *text_of(const json_t *answer, const char *key) {
    const char *text = json_string_value(json_object_get(answer, key));
    return text ? text : "?";
}

static double number_of(const json_t *answer, const char *key) {
    return json_number_value(json_object_get(answer, key));
}

static void examine_program(gw_doctor *d, const gw_host *h, const json_t *facts) {
    char own[33];
    gw_error error = {0};
    if (gw_program_hash(own, &error))
        WRONG(GW_MACHINE, h->name, "%s", error.text);
    else if (strcmp(own, text_of(facts, "program")))
        WRONG(GW_MACHINE, h->name,
              "another program: the executable there has hash %s, here %s; install the same gazewall on both",
              text_of(facts, "program"), own);
    else
        GOOD(h->name, "the same program, hash %s", own);
}

static void examine_mpi(gw_doctor *d, const gw_host *h, const json_t *facts) {
    char own[MPI_MAX_LIBRARY_VERSION_STRING] = "";
    int length = 0;
    MPI_Get_library_version(own, &length);
    own[strcspn(own, ",\n")] = '\0';
    if (!json_is_true(json_object_get(facts, "orted")))
        WRONG(GW_MACHINE, h->name,
              "there is no 'orted' in its PATH: install openmpi-bin, or set PATH for shells without login "
              "there");
    else if (strcmp(own, text_of(facts, "mpi")))
        WRONG(GW_MACHINE, h->name, "another MPI: %s there, %s here; install the same on both",
              text_of(facts, "mpi"), own);
    else
        GOOD(h->name, "the same MPI, %s", own);
}

static void examine_memory(gw_doctor *d, const gw_host *h, const json_t *facts) {
    double memory = number_of(facts, "memory"), segments = number_of(facts, "segments");
    if (memory < enough_memory)
        MIND(h->name, "only %.0f MiB of memory are free", memory / mebibyte);
    else
        GOOD(h->name, "%.0f MiB of memory are free", memory / mebibyte);
    if (segments < enough_segments)
        MIND(h->name,
             "/dev/shm has room for %.0f MiB only; scene and octree must fit: "
             "'mount -o remount,size=50%% /dev/shm'",
             segments / mebibyte);
    else
        GOOD(h->name, "/dev/shm has room for %.0f MiB", segments / mebibyte);
}

static int64_t clock_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* The offset by the fastest of some rounds: the answer was made within its time (Cristian 1989). */
static void examine_clock(gw_doctor *d, const gw_host *h, gw_examiner *e) {
    int64_t best = INT64_MAX, offset = 0;
    for (int i = 0; i < CLOCK_ROUNDS; i++) {
        gw_error error = {0};
        json_t *answer;
        int64_t before = clock_now();
        if (gw_examiner_ask(e, "clock", ANSWER_MS, &answer, &error)) {
            WRONG(GW_MACHINE, h->name, "its clock: %s", error.text);
            return;
        }
        int64_t after = clock_now();
        int64_t there = (int64_t)json_integer_value(json_object_get(answer, "ns"));
        json_decref(answer);
        if (after - before < best) {
            best = after - before;
            offset = there - (before + (after - before) / 2);
        }
    }
    double ms = 1e-6 * (double)offset, doubt = 0.5e-6 * (double)best;
    if (ms > 100 + doubt || ms < -100 - doubt)
        MIND(h->name, "its clock is %+.0f ms off, give or take %.1f ms; let chrony or ntpd set both clocks",
             ms, doubt);
    else
        GOOD(h->name, "its clock is %+.1f ms off, give or take %.1f ms", ms, doubt);
}

/* 1 when there is one. */
static int examine_way_back(gw_doctor *d, const gw_host *h, const gw_link_listener *listener,
                            gw_examiner *e) {
    char request[128], address[96];
    gw_error error = {0};
    json_t *answer = NULL;
    /* tcp:ADDRESS:PORT */
    snprintf(address, sizeof address, "%s", listener->network_name + 4);
    char *port = strrchr(address, ':');
    if (!port)
        return 0;
    *port++ = '\0';
    snprintf(request, sizeof request, "back %s %s", address, port);
    const int failed = gw_examiner_ask(e, request, ANSWER_MS, &answer, &error) != GW_OK;
    if (failed)
        WRONG(GW_MACHINE, h->name,
              "from there this machine is not reached at %s port %s: %s; let ports 1024 to 65535 of this "
              "network "
              "through the firewall of this machine",
              address, port, error.text);
    else
        GOOD(h->name, "it reaches this machine at %s", address);
    json_decref(answer);
    return !failed;
}

/* --- what draws
 * ------------------------------------------------------------------------------------------- */

static void tell_device(gw_doctor *d, const gw_host *h, const char *what, gw_code code, json_t *answer,
                        const gw_error *error) {
    if (code)
        WRONG(GW_MACHINE, h->name, "%s: %s", what, error->text);
    else if (json_is_true(json_object_get(answer, "software")))
        MIND(h->name, "%s: %s: no GPU, the processor draws; OpenGL %s", what, text_of(answer, "renderer"),
             text_of(answer, "version"));
    else
        GOOD(h->name, "%s: %s, OpenGL %s, blocks of %.0f MiB", what, text_of(answer, "renderer"),
             text_of(answer, "version"), number_of(answer, "block") / mebibyte);
    json_decref(answer);
}

/* 1 when an earlier tile of the host is drawn by the same GPU without display. */
static int gpu_is_known(const gw_doctor *d, uint32_t tile) {
    const gw_panel *panels = d->site->panels;
    for (uint32_t i = 0; i < tile; i++)
        if (d->hosts->of_tile[i] == d->hosts->of_tile[tile] && !panels[i].display[0] &&
            panels[i].gpu == panels[tile].gpu)
            return 1;
    return 0;
}

static void examine_panel(gw_doctor *d, const gw_host *h, uint32_t tile, gw_examiner *e) {
    const gw_panel *panel = &d->site->panels[tile];
    const gw_tile *t = &d->site->layout.tiles[tile];
    char request[256], what[192];
    gw_error error = {0};
    json_t *answer = NULL;
    if (!panel->display[0] && gpu_is_known(d, tile))
        return;
    if (panel->display[0]) {
        snprintf(request, sizeof request, "display %s %s %" PRId32 " %" PRId32 " %" PRIu32 " %" PRIu32,
                 panel->display, panel->monitor[0] ? panel->monitor : "-", panel->window[0], panel->window[1],
                 t->rectangle.width, t->rectangle.height);
        snprintf(what, sizeof what, "tile %s on display %s", t->name, panel->display);
    } else {
        snprintf(request, sizeof request, "gpu %" PRId32, panel->gpu);
        if (panel->gpu < 0)
            snprintf(what, sizeof what, "first GPU");
        else
            snprintf(what, sizeof what, "GPU %" PRId32, panel->gpu);
    }
    gw_code code = gw_examiner_ask(e, request, DEVICE_MS, &answer, &error);
    tell_device(d, h, what, code, answer, &error);
}

/* 1 when the ways from and to the host are worth a look. */
static int examine_inside(gw_doctor *d, const gw_host *h, const gw_link_listener *listener, gw_examiner *e) {
    gw_error error = {0};
    json_t *facts = NULL;
    int reaches = 1;
    if (gw_examiner_ask(e, "facts", ANSWER_MS, &facts, &error)) {
        WRONG(GW_MACHINE, h->name, "%s", error.text);
        return 0;
    }
    if (!h->here) {
        examine_program(d, h, facts);
        examine_mpi(d, h, facts);
        reaches = examine_way_back(d, h, listener, e);
        examine_clock(d, h, e);
    }
    examine_memory(d, h, facts);
    json_decref(facts);
    for (uint32_t i = 0; i < d->site->layout.tile_count; i++)
        if (&d->hosts->host[d->hosts->of_tile[i]] == h)
            examine_panel(d, h, i, e);
    return reaches;
}

/* An examiner that goes on answering; NULL when the host cannot be asked further. */
static gw_examiner *examine_host(gw_doctor *d, const gw_host *h, const gw_link_listener *listener,
                                 const char *program) {
    gw_examiner *examiner = NULL;
    gw_error error = {0};
    if (!h->here && !examine_way(d, h))
        return NULL;
    gw_code code = gw_allocate((void **)&examiner, 1, sizeof *examiner, "talk with a host", &error);
    if (!code)
        code = gw_examiner_start(h, d->agent, program, examiner, &error);
    if (code) {
        WRONG(code, h->name, "%s", error.text);
        free(examiner);
        return NULL;
    }
    if (!h->here)
        GOOD(h->name, "'%s' starts programs there", d->agent);
    if (examine_inside(d, h, listener, examiner))
        return examiner;
    gw_examiner_stop(examiner);
    free(examiner);
    return NULL;
}

static void examine_hosts(gw_doctor *d, const gw_link_listener *listener) {
    gw_examiner *examiners[GW_MAXIMUM_TILES] = {NULL};
    char program[4096];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    for (uint32_t i = 0; i < d->hosts->count; i++)
        examiners[i] = examine_host(d, &d->hosts->host[i], listener, program);
    gw_doctor_ways(d, examiners);
    for (uint32_t i = 0; i < d->hosts->count; i++)
        if (examiners[i]) {
            gw_examiner_stop(examiners[i]);
            free(examiners[i]);
        }
}

void gw_doctor_examine(gw_doctor *d) {
    gw_error error = {0};
    gw_link_listener listener = {.local = -1, .network = -1};
    examine_mpirun(d);
    if (d->hosts->listen[0] && gw_link_listen(d->hosts->listen, &listener, &error))
        WRONG(error.code, "launcher", "%s", error.text);
    else
        examine_hosts(d, &listener);
    gw_link_close(&listener);
    gw_doctor_tracker(d);
}
