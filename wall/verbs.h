/* The verbs of the command line: one table that main(), --help and the "did you mean" of a mistyped verb
 * read. Each verb gets its own argv, argv[0] being its name, and returns the exit code
 * (docs/command-line.md). */
#ifndef GW_WALL_VERBS_H
#define GW_WALL_VERBS_H

#include <stddef.h>

#define GW_VERSION "0.1.0"

typedef struct gw_verb {
    const char *name;
    const char *summary; /* one line; NULL hides the verb: it is started by the program itself */
    int (*run)(int argc, char **argv);
} gw_verb;

extern const gw_verb gw_verbs[];
extern const size_t gw_verb_count;

int gw_verb_sim(int argc, char **argv);
int gw_verb_wall(int argc, char **argv);
int gw_verb_doctor(int argc, char **argv);
int gw_verb_examine(int argc, char **argv); /* hidden: what doctor asks for on each host */
int gw_verb_rank(int argc,
                 char **argv); /* hidden: one tile's process, started by sim and wall under mpirun */
int gw_verb_launch(int argc, char **argv); /* hidden: ties its own life to the launcher's, becomes mpirun */
int gw_verb_render(int argc, char **argv);
int gw_verb_check(int argc, char **argv);
int gw_verb_inspect(int argc, char **argv);
int gw_verb_replay(int argc, char **argv);
int gw_verb_record(int argc, char **argv);
int gw_verb_calibrate(int argc, char **argv);
int gw_verb_bench(int argc, char **argv);
int gw_verb_settings(int argc, char **argv);
int gw_verb_compare(int argc, char **argv);
int gw_verb_codes(int argc, char **argv);

/* Runs the verb that argv[1] names: the whole program but for main() itself. */
int gw_verbs_run(int argc, char **argv);

#endif
