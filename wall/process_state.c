#include "wall/process_state.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Letter of its state and, in clock ticks since boot, its start: fields 3 and 22 of /proc/N/stat (proc(5)),
 * counted from the end of the name, which may hold anything. 0 when there is no such process, -1 when it
 * cannot be told. */
static int read_state(int64_t number, char *letter, uint64_t *start) {
    char path[64], text[1024];
    snprintf(path, sizeof path, "/proc/%" PRId64 "/stat", number);
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return errno == ENOENT ? 0 : -1;
    ssize_t size = read(file, text, sizeof text - 1);
    close(file);
    if (size <= 0)
        return size < 0 && errno == ESRCH ? 0 : -1;
    text[size] = '\0';
    const char *at = strrchr(text, ')');
    if (!at || at[1] != ' ')
        return -1;
    *letter = at[2];
    at += 2;
    for (int field = 3; field < 22 && at; field++) {
        at = strchr(at, ' ');
        at = at ? at + 1 : NULL;
    }
    *start = at ? strtoull(at, NULL, 10) : 0;
    return *start ? 1 : -1;
}

gw_process gw_process_find(int64_t number) {
    gw_process process = {.number = number};
    char letter;
    if (read_state(number, &letter, &process.start) != 1)
        process.start = 0;
    return process;
}

int64_t gw_process_age(void) {
    const int64_t second = 1000000000;
    struct timespec now;
    char letter;
    uint64_t start = 0;
    if (read_state(getpid(), &letter, &start) != 1 || clock_gettime(CLOCK_BOOTTIME, &now))
        return 0;
    const int64_t tick = second / sysconf(_SC_CLK_TCK),
                  age = now.tv_sec * second + now.tv_nsec - (int64_t)start * tick;
    return age > 0 ? age : 0;
}

gw_process_state gw_process_look(const gw_process *process) {
    char letter = 0;
    uint64_t start = 0;
    if (!process->start)
        return GW_PROCESS_UNKNOWN;
    int seen = read_state(process->number, &letter, &start);
    if (seen < 0)
        return GW_PROCESS_UNKNOWN;
    if (!seen || start != process->start || letter == 'Z' || letter == 'X')
        return GW_PROCESS_GONE;
    return letter == 'T' || letter == 't' ? GW_PROCESS_STOPPED : GW_PROCESS_RUNS;
}
