#include "wall/mpirun_command.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int make_room(gw_words *words) {
    if (words->count + 2 <= words->room)
        return 1;
    size_t room = words->room ? 2 * words->room : 64;
    void *more = realloc(words->word, room * sizeof *words->word);
    if (!more)
        return 0;
    words->word = more;
    words->room = room;
    return 1;
}

void gw_words_add(gw_words *words, const char *format, ...) {
    char *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    if (length < 0 || !make_room(words)) {
        words->failed = 1;
        if (length >= 0)
            free(text);
        return;
    }
    words->word[words->count++] = text;
    words->word[words->count] = NULL;
}

void gw_words_finish(gw_words *words) {
    for (size_t i = 0; i < words->count; i++)
        free(words->word[i]);
    free(words->word);
    *words = (gw_words){0};
}

static void add_all(gw_words *out, const char *const *words, size_t count) {
    for (size_t i = 0; i < count; i++)
        gw_words_add(out, "%s", words[i]);
}

#define ADD_ALL(out, words) add_all(out, words, sizeof(words) / sizeof((words)[0]))

static void add_network(const gw_mpirun_plan *plan, gw_words *out) {
    /* Ranks of one machine need no network, and copying through the other process's memory is often forbidden
     * in containers. */
    static const char *const always[] = {"--mca", "btl_vader_single_copy_mechanism", "none", "--mca", "btl"};
    ADD_ALL(out, always);
    gw_words_add(out, plan->hosts->remote ? "self,vader,tcp" : "self,vader");
    if (!plan->hosts->remote)
        return;
    /* Every host is started from here and speaks to here, never by way of another that may die; and a host
     * that is cut off ends what it runs after 25 s instead of some minutes. */
    static const char *const direct[] = {"--mca",
                                         "plm_rsh_no_tree_spawn",
                                         "1", //
                                         "--mca",
                                         "routed",
                                         "direct",
                                         "--mca",
                                         "oob_tcp_keepalive_time",
                                         "10", //
                                         "--mca",
                                         "oob_tcp_keepalive_intvl",
                                         "5", //
                                         "--mca",
                                         "oob_tcp_keepalive_probes",
                                         "3"};
    ADD_ALL(out, direct);
    if (plan->agent) {
        static const char *const agent[] = {"--mca", "plm_rsh_agent"};
        ADD_ALL(out, agent);
        gw_words_add(out, "%s", plan->agent);
    }
    if (plan->hosts->subnet[0]) {
        /* Else MPI tries every interface, those of virtual machines and containers, too. */
        static const char *const names[] = {"btl_tcp_if_include", "oob_tcp_if_include"};
        for (size_t i = 0; i < 2; i++) {
            gw_words_add(out, "--mca");
            gw_words_add(out, "%s", names[i]);
            gw_words_add(out, "%s", plan->hosts->subnet);
        }
    }
    if (plan->listener) {
        gw_words_add(out, "-x");
        gw_words_add(out, GW_LINK_SECRET);
    }
}

static void add_permissions(const gw_mpirun_plan *plan, const gw_log *log, gw_words *out) {
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    uint32_t here = 0;
    for (uint32_t i = 0; i < plan->hosts->count; i++)
        here += plan->hosts->host[i].here ? plan->hosts->host[i].tile_count : 0;
    if ((long)here > processors)
        gw_log_write(log, GW_LOG_INFO, "%" PRIu32 " ranks share %ld processors (mpirun --oversubscribe)",
                     here, processors);
    /* How many processors other hosts have mpirun learns only when it is there; the site decides. */
    if ((long)here > processors || plan->hosts->remote)
        gw_words_add(out, "--oversubscribe");
    if (geteuid() == 0) {
        gw_words_add(out, "--allow-run-as-root");
        gw_log_write(log, GW_LOG_INFO, "started as root (mpirun --allow-run-as-root)");
    }
}

/* The tiles from `first` on that one part of the command can start. */
static uint32_t run_of_tiles(const gw_mpirun_plan *plan, uint32_t first) {
    const gw_panel *panels = plan->site->panels;
    uint32_t next = first + 1;
    while (next < plan->site->layout.tile_count &&
           plan->hosts->of_tile[next] == plan->hosts->of_tile[first] &&
           !strcmp(panels[next].display, panels[first].display))
        next++;
    return next - first;
}

void gw_rank_words(const gw_mpirun_plan *plan, const gw_host *host, const char *rejoin, gw_words *out) {
    const gw_link_listener *listener = plan->listener;
    gw_words_add(out, "%s", plan->program);
    gw_words_add(out, "rank");
    gw_words_add(out, "--verb=%s", plan->verb);
    if (listener)
        gw_words_add(out, "--link=%s", host->here ? listener->local_name : listener->network_name);
    if (rejoin)
        gw_words_add(out, "--rejoin=%s", rejoin);
    for (size_t i = 0; i < plan->carried->count; i++)
        gw_words_add(out, "%s", plan->carried->word[i]);
    for (int i = 1; i < plan->argc; i++)
        if (strcmp(plan->argv[i], "--dry-run") != 0)
            gw_words_add(out, "%s", plan->argv[i]);
}

static void add_part(const gw_mpirun_plan *plan, uint32_t first, uint32_t count, gw_words *out) {
    const gw_host *host = &plan->hosts->host[plan->hosts->of_tile[first]];
    const char *display = plan->site->panels[first].display;
    if (plan->hosts->remote) {
        gw_words_add(out, "-host");
        gw_words_add(out, "%s", host->name);
    }
    if (display[0] && !strcmp(plan->verb, "wall")) {
        gw_words_add(out, "-x");
        gw_words_add(out, "DISPLAY=%s", display);
    }
    gw_words_add(out, "-np");
    gw_words_add(out, "%" PRIu32, count);
    gw_rank_words(plan, host, NULL, out);
}

void gw_mpirun_words(const gw_mpirun_plan *plan, const gw_log *log, gw_words *out) {
    static const char *const head[] = {"mpirun", "--enable-recovery", "--bind-to", "none", "--quiet"};
    ADD_ALL(out, head);
    add_permissions(plan, log, out);
    add_network(plan, out);
    for (uint32_t first = 0; first < plan->site->layout.tile_count;) {
        uint32_t count = run_of_tiles(plan, first);
        if (first)
            gw_words_add(out, ":");
        add_part(plan, first, count, out);
        first += count;
    }
}

static void print_word(FILE *out, const char *word) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+:,./@%";
    if (word[0] && strspn(word, plain) == strlen(word)) {
        fputs(word, out);
        return;
    }
    putc('\'', out);
    for (; *word; word++)
        if (*word == '\'')
            fputs("'\\''", out);
        else
            putc(*word, out);
    putc('\'', out);
}

void gw_words_print(const gw_words *words, FILE *out) {
    for (size_t i = 0; i < words->count; i++) {
        if (i)
            putc(' ', out);
        print_word(out, words->word[i]);
    }
}
