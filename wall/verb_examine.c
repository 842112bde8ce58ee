/* `gazewall examine`, hidden: what the doctor asks for on each host (wall/examine.h). A request is a line on
 * standard input, the answer one on standard output: {"error": text} or what was asked for. It ends with its
 * input. */
#include "base/gl.h"
#include "base/window.h"
#include "wall/examine.h"
#include "wall/link.h"
#include "wall/reach.h"
#include "wall/verbs.h"

#include <errno.h>
#include <inttypes.h>
#include <mpi.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

enum { BACK_MS = 3000 };

static json_t *refuse(const char *text) {
    return json_pack("{s:s}", "error", text);
}

static json_int_t available_memory(void) {
    char line[256];
    long long kilobytes = 0;
    FILE *file = fopen("/proc/meminfo", "re");
    while (file && fgets(line, sizeof line, file) && sscanf(line, "MemAvailable: %lld", &kilobytes) != 1)
        ;
    if (file)
        fclose(file);
    return kilobytes * 1024;
}

static json_int_t room_for_segments(void) {
    struct statvfs room;
    return statvfs("/dev/shm", &room) ? -1 : (json_int_t)room.f_bavail * (json_int_t)room.f_frsize;
}

/* 1 when PATH, as this process has it, leads to the command. */
static int is_in_path(const char *command) {
    const char *path = getenv("PATH");
    char copy[8192], *rest = NULL;
    snprintf(copy, sizeof copy, "%s", path ? path : "");
    for (char *folder = strtok_r(copy, ":", &rest); folder; folder = strtok_r(NULL, ":", &rest)) {
        char file[4096];
        if (snprintf(file, sizeof file, "%s/%s", folder, command) < (int)sizeof file && !access(file, X_OK))
            return 1;
    }
    return 0;
}

static json_t *facts(void) {
    gw_error error = {0};
    char program[33], host[64] = "unknown", mpi[MPI_MAX_LIBRARY_VERSION_STRING] = "";
    int length = 0;
    if (gw_program_hash(program, &error))
        return refuse(error.text);
    gethostname(host, sizeof host - 1);
    MPI_Get_library_version(mpi, &length);
    mpi[strcspn(mpi, ",\n")] = '\0';
    return json_pack("{s:s, s:s, s:s, s:b, s:b, s:I, s:I}", "program", program, "host", host, "mpi", mpi,
                     "mpirun", is_in_path("mpirun"), "orted", is_in_path("orted"), "memory",
                     available_memory(), "segments", room_for_segments());
}

static json_t *clock_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return json_pack("{s:I}", "ns", (json_int_t)now.tv_sec * 1000000000 + now.tv_nsec);
}

static json_t *way_back(const char *address, unsigned port) {
    char text[256];
    gw_reach reach = gw_reach_tcp(address, (uint16_t)port, BACK_MS, NULL);
    if (reach == GW_REACHED)
        return json_pack("{s:b}", "reached", 1);
    snprintf(text, sizeof text, "%s (%s)", gw_reach_name(reach), strerror(errno));
    return refuse(text);
}

/* Takes connections until the program ends; what connects is never answered. */
static json_t *listen_at(const char *address) {
    const struct addrinfo hints = {
        .ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_PASSIVE};
    struct addrinfo *found = NULL;
    struct sockaddr_storage name;
    socklen_t size = sizeof name;
    char port[8] = "";
    if (getaddrinfo(address, "0", &hints, &found))
        return refuse("this is no numeric address");
    int made = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    int failed = made < 0 || bind(made, found->ai_addr, found->ai_addrlen) || listen(made, SOMAXCONN) ||
                 getsockname(made, (struct sockaddr *)&name, &size) ||
                 getnameinfo((struct sockaddr *)&name, size, NULL, 0, port, sizeof port, NI_NUMERICSERV);
    json_t *answer = failed ? refuse(strerror(errno)) : json_pack("{s:i}", "port", atoi(port));
    freeaddrinfo(found);
    if (failed && made >= 0)
        close(made);
    return answer;
}

static json_t *describe_device(const gw_gl_options *options) {
    gw_gl *device = NULL;
    gw_error error = {0};
    if (gw_gl_create(options, &device, &error))
        return refuse(error.text);
    const gw_gl_limits *l = gw_gl_limits_of(device);
    json_t *answer = json_pack("{s:s, s:s, s:I, s:b}", "renderer", l->renderer, "version", l->version,
                               "block", (json_int_t)l->storage_block_bytes, "software", l->software);
    gw_gl_destroy(&device);
    return answer ? answer : refuse("the driver's words are no UTF-8");
}

static json_t *gpu(int index) {
    return describe_device(&(gw_gl_options){.choose_gpu = index >= 0, .gpu = index});
}

/* display DISPLAY MONITOR|- X Y WIDTH HEIGHT: opens the tile's window for a moment. */
static json_t *display(char *words) {
    char name[64], monitor[32];
    gw_window_options window = {.title = "Gazewall", .monitor = monitor, .placed = 1};
    if (sscanf(words, "%63s %31s %" SCNd32 " %" SCNd32 " %" SCNu32 " %" SCNu32, name, monitor,
               &window.position[0], &window.position[1], &window.size[0], &window.size[1]) != 6)
        return refuse("the doctor and this program do not understand each other");
    if (!strcmp(monitor, "-"))
        monitor[0] = '\0';
    setenv("DISPLAY", name, 1);
    return describe_device(&(gw_gl_options){.window = &window});
}

static json_t *answer_to(char *request) {
    char address[64];
    unsigned port;
    int index;
    if (!strcmp(request, "facts"))
        return facts();
    if (!strcmp(request, "clock"))
        return clock_now();
    if (sscanf(request, "back %63s %u", address, &port) == 2 && port < 65536)
        return way_back(address, port);
    if (sscanf(request, "listen %63s", address) == 1)
        return listen_at(address);
    if (sscanf(request, "gpu %d", &index) == 1)
        return gpu(index);
    if (!strncmp(request, "display ", 8))
        return display(request + 8);
    return refuse("the doctor and this program do not understand each other");
}

static void say(json_t *answer) {
    if (answer)
        json_dumpf(answer, stdout, JSON_COMPACT);
    putchar('\n');
    fflush(stdout);
    json_decref(answer);
}

int gw_verb_examine(int argc, char **argv) {
    (void)argc;
    (void)argv;
    char request[512];
    say(json_pack("{s:s}", "gazewall", GW_VERSION));
    while (fgets(request, sizeof request, stdin)) {
        request[strcspn(request, "\n")] = '\0';
        say(answer_to(request));
    }
    return GW_OK;
}
