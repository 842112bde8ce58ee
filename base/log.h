/* The log: lines and progress go to a sink that wall/ owns; lower layers only hold a pointer to it.
 *
 * A gw_log is passed down explicitly (there is no global log); NULL is a valid log that drops everything.
 * One thread at a time per log. */
#ifndef GW_BASE_LOG_H
#define GW_BASE_LOG_H

typedef enum gw_log_level { GW_LOG_ERROR, GW_LOG_WARNING, GW_LOG_INFO, GW_LOG_DEBUG } gw_log_level;

typedef struct gw_log {
    gw_log_level threshold; /* lines above this level are dropped before formatting */
    void *context;          /* owned by the sink's owner */
    /* One finished line without newline. */
    void (*line)(void *context, gw_log_level level, const char *text);
    /* Progress of long work: what is done ("building octree"), fraction 0..1, or below 0 when no end is
     * known. May be NULL. Called at any rate; the sink decides how often to show it. */
    void (*progress)(void *context, const char *what, double fraction);
} gw_log;

void gw_log_write(const gw_log *log, gw_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void gw_log_progress(const gw_log *log, const char *what, double fraction);

/* "error", "warning", "info", "debug"; gw_log_level_parse returns 0 and leaves *level alone for other words.
 */
const char *gw_log_level_name(gw_log_level level);
int gw_log_level_parse(const char *word, gw_log_level *level);

#endif
