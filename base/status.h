/* Results and error texts, the way every function of Gazewall reports a failure.
 *
 * A function that can fail returns a gw_code and takes a gw_error* last. On failure it fills the error with
 * one plain sentence (what, which file and line, which value, what to do); callers add context on the way up
 * with gw_context(). Nothing below wall/ prints or exits: the text travels up to main(). The codes are the
 * program's exit codes (docs/command-line.md), so whose fault it was is decided where it is known. Any thread
 * may call these; an error object belongs to its caller. */
#ifndef GW_BASE_STATUS_H
#define GW_BASE_STATUS_H

typedef enum gw_code {
    GW_OK = 0,          /* all went well */
    GW_TILES_LOST = 1,  /* finished, but tiles were lost on the way */
    GW_BAD_INPUT = 2,   /* a file, packet or command line is wrong: the user can mend it */
    GW_MACHINE = 3,     /* the machine cannot: GL, MPI, memory, a missing library */
    GW_ENDED_EARLY = 4, /* rank 0 lost, or a rank lost before frame 1 */
    GW_NO_OUTPUT = 5,   /* a result could not be written */
    GW_INTERRUPTED = 130,
    GW_TERMINATED = 143
} gw_code;

/* One error: its code and one sentence without a trailing newline. Zero-initialise before use. */
typedef struct gw_error {
    gw_code code;
    char text[2048]; /* cut with "..." when longer */
} gw_error;

/* Fills *error (may be NULL) and returns code, so that `return gw_fail(...)` reads well. */
gw_code gw_fail(gw_error *error, gw_code code, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Puts "text: " before the error's present text and returns its code. */
gw_code gw_context(gw_error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
