#include "wall/input_script.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/suggest.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAXIMUM_EVENTS = 1000000, MAXIMUM_LINE = 128, MAXIMUM_WORDS = 6 };
static const size_t largest_file = (size_t)64 << 20;

typedef struct place {
    const char *name;
    size_t line;
    gw_error *error;
} place;

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static gw_code refuse(const place *at, const char *what, const char *word, const char *wanted) {
    return gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: %s '%s'; expected %s", at->name, at->line, what, word,
                   wanted);
}

/* --- words
 * ----------------------------------------------------------------------------------------------------- */

static int read_number(const char *text, double least, double greatest, double *out) {
    char *stop;
    if (isspace((unsigned char)*text) || !*text)
        return 0;
    *out = strtod(text, &stop);
    return !*stop && *out >= least && *out <= greatest;
}

static gw_code read_numbers(const place *at, char **words, size_t count, double least, double greatest,
                            const char *wanted, double *out) {
    for (size_t i = 0; i < count; i++)
        if (!read_number(words[i], least, greatest, &out[i]))
            return refuse(at, "bad number", words[i], wanted);
    return GW_OK;
}

static gw_code read_key(const place *at, const char *word, int32_t *out) {
    static const char *const names[] = {"escape", "enter",    "tab",  "left",  "right",   "up", "down",
                                        "pageup", "pagedown", "home", "shift", "control", "f1"};
    _Static_assert(COUNT(names) == GW_KEY_END - GW_KEY_ESCAPE, "a name for each key");
    if (!word[1] && isgraph((unsigned char)word[0])) {
        *out = toupper((unsigned char)word[0]);
        return GW_OK;
    }
    for (size_t i = 0; i < COUNT(names); i++)
        if (!strcmp(word, names[i])) {
            *out = GW_KEY_ESCAPE + (int32_t)i;
            return GW_OK;
        }
    const char *near = gw_suggest(word, names, COUNT(names));
    return refuse(at, "unknown key", word,
                  near ? near : "a letter, a digit, or a name such as shift or left");
}

static gw_code read_button(const place *at, char **words, gw_event *event) {
    static const char *const names[] = {"left", "right", "middle"};
    for (int32_t i = 0; i < (int32_t)COUNT(names); i++)
        if (!strcmp(words[0], names[i])) {
            event->key = i;
            event->kind = !strcmp(words[1], "down") ? GW_EVENT_BUTTON_DOWN : GW_EVENT_BUTTON_UP;
            return event->kind == GW_EVENT_BUTTON_DOWN || !strcmp(words[1], "up")
                       ? GW_OK
                       : refuse(at, "bad state of a button", words[1], "down or up");
        }
    return refuse(at, "unknown button", words[0], "left, right or middle");
}

/* --- lines
 * ----------------------------------------------------------------------------------------------------- */

static gw_code read_event(const place *at, const char *word, char **words, gw_input_event *out) {
    gw_event *event = &out->event;
    double *numbers = event->position;
    if (!strcmp(word, "press") || !strcmp(word, "release")) {
        event->kind = *word == 'p' ? GW_EVENT_KEY_DOWN : GW_EVENT_KEY_UP;
        return read_key(at, words[0], &event->key);
    }
    if (!strcmp(word, "pointer")) {
        event->kind = GW_EVENT_POINTER;
        return read_numbers(at, words, 2, 0, 1, "shares of the wall, 0 to 1", numbers);
    }
    if (!strcmp(word, "resize")) {
        out->resizes = 1;
        return read_numbers(at, words, 2, 1, 16384, "px, 1 to 16384", numbers);
    }
    if (!strcmp(word, "scroll")) {
        event->kind = GW_EVENT_SCROLL;
        return read_numbers(at, words, 1, -100, 100, "notches, -100 to 100", &numbers[1]);
    }
    if (!strcmp(word, "button"))
        return read_button(at, words, event);
    event->kind = GW_EVENT_CLOSE;
    return GW_OK;
}

static const struct {
    const char *word;
    size_t count; /* words after it */
} kinds[] = {{"press", 1},  {"release", 1}, {"pointer", 2}, {"button", 2},
             {"scroll", 1}, {"resize", 2},  {"close", 0}};

static gw_code read_words(const place *at, char **words, size_t count, uint32_t frame_before,
                          gw_input_event *out) {
    const char *names[COUNT(kinds)];
    double frame;
    if (!read_number(words[0], frame_before, UINT32_MAX, &frame) || frame != floor(frame))
        return refuse(at, "bad frame", words[0], "a whole number, not below the line before");
    out->frame = (uint32_t)frame;
    for (size_t i = 0; i < COUNT(kinds); i++) {
        names[i] = kinds[i].word;
        if (count > 1 && !strcmp(words[1], kinds[i].word))
            return count == kinds[i].count + 2
                       ? read_event(at, words[1], words + 2, out)
                       : gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: '%s' takes %zu value%s, not %zu", at->name,
                                 at->line, words[1], kinds[i].count, kinds[i].count == 1 ? "" : "s",
                                 count - 2);
    }
    const char *word = count > 1 ? words[1] : "", *near = gw_suggest(word, names, COUNT(names));
    return refuse(at, "unknown event", word,
                  near ? near : "press, release, pointer, button, scroll, resize or close");
}

/* Cuts a line into its words; *count is 0 for an empty one. */
static gw_code cut(const place *at, char *line, char **words, size_t *count) {
    char *rest = NULL;
    *count = 0;
    line[strcspn(line, "#")] = '\0';
    for (char *word = strtok_r(line, " \t\r", &rest); word; word = strtok_r(NULL, " \t\r", &rest)) {
        if (*count == MAXIMUM_WORDS)
            return gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: more than %d words", at->name, at->line,
                           MAXIMUM_WORDS);
        words[(*count)++] = word;
    }
    return GW_OK;
}

static gw_code read_line(const place *at, const char *text, size_t length, gw_input_script *out,
                         size_t *capacity) {
    char line[MAXIMUM_LINE], *words[MAXIMUM_WORDS];
    size_t count;
    if (length >= sizeof line || memchr(text, '\0', length))
        return gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: the line is longer than %d bytes or no text",
                       at->name, at->line, MAXIMUM_LINE - 1);
    memcpy(line, text, length);
    line[length] = '\0';
    gw_code code = cut(at, line, words, &count);
    if (code || count == 0)
        return code;
    if (out->count == MAXIMUM_EVENTS)
        return gw_fail(at->error, GW_BAD_INPUT, "%s:%zu: more than %d events", at->name, at->line,
                       MAXIMUM_EVENTS);
    gw_input_event event = {0};
    code = read_words(at, words, count, out->count ? out->events[out->count - 1].frame : 0, &event);
    if (!code)
        code = gw_grow((void **)&out->events, capacity, out->count + 1, sizeof *out->events, "input events",
                       at->error);
    if (!code)
        out->events[out->count++] = event;
    return code;
}

gw_code gw_input_script_parse(const char *name, const char *text, size_t size, gw_input_script *out,
                              gw_error *error) {
    gw_code code = GW_OK;
    size_t capacity = 0;
    place at = {.name = name, .error = error};
    memset(out, 0, sizeof *out);
    for (size_t begin = 0; begin < size && !code;) {
        const char *stop = memchr(text + begin, '\n', size - begin);
        const size_t length = stop ? (size_t)(stop - (text + begin)) : size - begin;
        at.line++;
        code = read_line(&at, text + begin, length, out, &capacity);
        begin += length + 1;
    }
    if (code)
        gw_input_script_finish(out);
    return code;
}

gw_code gw_input_script_load(const char *path, gw_input_script *out, gw_error *error) {
    gw_bytes bytes = {0};
    memset(out, 0, sizeof *out);
    gw_code code = gw_file_read(path, largest_file, &bytes, error);
    if (!code)
        code = gw_input_script_parse(path, (const char *)bytes.data, bytes.size, out, error);
    gw_bytes_finish(&bytes);
    return code;
}

int gw_input_script_ends(const gw_input_script *script) {
    for (size_t i = 0; i < script->count; i++) {
        const gw_event *event = &script->events[i].event;
        if (!script->events[i].resizes && (event->kind == GW_EVENT_CLOSE ||
                                           (event->kind == GW_EVENT_KEY_DOWN && event->key == GW_KEY_ESCAPE)))
            return 1;
    }
    return 0;
}

void gw_input_script_finish(gw_input_script *script) {
    free(script->events);
    memset(script, 0, sizeof *script);
}
