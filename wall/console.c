#include "wall/console.h"

#include "base/clock.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { LIVE_INTERVAL_MS = 100, PLAIN_INTERVAL_MS = 5000 };

static void clear_live(gw_console *console) {
    if (console->live)
        fputs("\r\033[K", stderr);
    console->live = 0;
}

static void show_line(void *context, gw_log_level level, const char *text) {
    gw_console *console = context;
    clear_live(console);
    const char *mark = level == GW_LOG_ERROR ? "error: " : level == GW_LOG_WARNING ? "warning: " : "";
    fprintf(stderr, "gazewall %s: %s%s\n", console->verb, mark, text);
}

static void show_progress(void *context, const char *what, double fraction) {
    gw_console *console = context;
    int64_t now = gw_now_ns();
    int64_t interval = (console->terminal ? LIVE_INTERVAL_MS : PLAIN_INTERVAL_MS) * INT64_C(1000000);
    if (console->quiet || now - console->last_shown < interval)
        return;
    console->last_shown = now;
    char share[16] = "";
    if (fraction >= 0)
        snprintf(share, sizeof share, ": %.0f %%", 100.0 * fraction);
    if (console->terminal) {
        fprintf(stderr, "\r\033[K%s%s", what, share);
        fflush(stderr);
        console->live = 1;
    } else {
        fprintf(stderr, "gazewall %s: %s%s\n", console->verb, what, share);
    }
}

void gw_console_init(gw_console *console, const char *verb, gw_log_level threshold, int quiet) {
    memset(console, 0, sizeof *console);
    console->verb = verb;
    console->quiet = quiet;
    console->terminal = isatty(STDERR_FILENO);
    /* Work that is over within the first interval shows no progress at all. */
    console->last_shown = gw_now_ns();
    console->log = (gw_log){.threshold = quiet ? GW_LOG_ERROR : threshold,
                            .context = console,
                            .line = show_line,
                            .progress = show_progress};
}

void gw_console_finish(gw_console *console) {
    clear_live(console);
    fflush(stderr);
}

int gw_console_fail(const char *verb, const gw_error *error) {
    if (isatty(STDERR_FILENO))
        fputs("\r\033[K", stderr);
    fprintf(stderr, "gazewall%s%s: %s\n", verb ? " " : "", verb ? verb : "", error->text);
    return (int)error->code;
}
