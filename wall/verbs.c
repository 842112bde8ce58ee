#include "wall/verbs.h"

#include "base/status.h"
#include "base/suggest.h"
#include "build/import.h"
#include "wall/console.h"
#include "wall/interrupt.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

const gw_verb gw_verbs[] = {
    {"sim", "the wall on one machine: one MPI rank per tile, assembled pictures, report", gw_verb_sim},
    {"wall", "the wall on the hosts of its site, until it is ended", gw_verb_wall},
    {"doctor", "tests every hop of a site: names, ways, programs, GPUs, displays, clocks, tracker",
     gw_verb_doctor},
    {"render", "one picture, one process, no MPI: for scripts and tests", gw_verb_render},
    {"check", "is a site file the wall as it hangs? verdict, table, drawing", gw_verb_check},
    {"inspect", "what is in a scene, its octree, or this machine's GL device", gw_verb_inspect},
    {"replay", "what is in a recording of head and gaze trackers, or plays it to other programs",
     gw_verb_replay},
    {"record", "trackers into a file, or people made by formula", gw_verb_record},
    {"calibrate", "where a tracker stands, in which unit and axes, from measured points; errors of gazes",
     gw_verb_calibrate},
    {"bench", "measures: build time, bytes, rays against Embree, modes, layouts (see its --help)",
     gw_verb_bench},
    {"compare", "how far a picture is from another, or a recorded run from the exact one, by every metric",
     gw_verb_compare},
    {"codes", "reads the tiles' frame codes from a picture of the wall", gw_verb_codes},
    {"settings", "the table of settings that --set takes", gw_verb_settings},
    {"rank", NULL, gw_verb_rank},
    {"examine", NULL, gw_verb_examine},
    {"launch", NULL, gw_verb_launch},
    {"import-child", NULL, gw_import_child},
};
const size_t gw_verb_count = sizeof gw_verbs / sizeof gw_verbs[0];

static void print_help(void) {
    puts("Gazewall " GW_VERSION ": a tiled display wall, ray-traced sharp where the viewer looks.\n"
         "\n"
         "Usage: gazewall VERB [OPTION...]      gazewall VERB --help tells all about a verb\n");
    for (size_t i = 0; i < gw_verb_count; i++)
        if (gw_verbs[i].summary)
            printf("  %-10s %s\n", gw_verbs[i].name, gw_verbs[i].summary);
    puts("\n"
         "Try these:\n"
         "  gazewall sim --tiles 2x2 --size 960x540 --frames 4 --out out/demo\n"
         "      the embedded demo scene on four tiles, the gaze crossing their borders\n"
         "  gazewall sim --scene model.glb --site configs/sites/3x2-bezels.yaml --out pictures\n"
         "      a model of your own on a wall with bezels\n"
         "  gazewall check 3x2-bezels --draw wall.svg\n"
         "      what a site file says of its wall, with a drawing\n"
         "  gazewall render --debug levels --out levels.png\n"
         "      red what was triangles, green to blue what was voxels\n"
         "  gazewall inspect model.obj\n"
         "      triangles, what was dropped and why, materials, octree figures\n"
         "\n"
         "Exit codes: 0 ok, 1 finished but tiles were lost, 2 bad input or usage, 3 the machine cannot,\n"
         "4 ended early, 5 output could not be written, 130 and 143 interrupted.");
}

static const gw_verb *find_verb(const char *name) {
    for (size_t i = 0; i < gw_verb_count; i++)
        if (!strcmp(gw_verbs[i].name, name))
            return &gw_verbs[i];
    return NULL;
}

static int unknown_verb(const char *name) {
    const char *names[sizeof gw_verbs / sizeof gw_verbs[0]];
    size_t count = 0;
    for (size_t i = 0; i < gw_verb_count; i++)
        if (gw_verbs[i].summary)
            names[count++] = gw_verbs[i].name;
    const char *near = gw_suggest(name, names, count);
    gw_error error = {0};
    if (near)
        gw_fail(&error, GW_BAD_INPUT, "unknown verb '%s'; did you mean '%s'?", name, near);
    else
        gw_fail(&error, GW_BAD_INPUT, "unknown verb '%s'; gazewall --help lists them", name);
    return gw_console_fail(NULL, &error);
}

int gw_verbs_run(int argc, char **argv) {
    int code = GW_OK;
    if (argc < 2 || !strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "help")) {
        print_help();
    } else if (!strcmp(argv[1], "--version")) {
        puts("gazewall " GW_VERSION);
    } else {
        const gw_verb *verb = find_verb(argv[1]);
        if (!verb)
            return unknown_verb(argv[1]);
        /* The reader of model files is the importer's: it sets up its own limits and signals. */
        if (verb->run != gw_import_child)
            gw_interrupt_install();
        code = verb->run(argc - 1, argv + 1);
    }
    const int unwritten = fflush(stdout) ? errno : ferror(stdout) ? EIO : 0;
    if (unwritten && code == GW_OK) {
        gw_error error = {0};
        code = gw_fail(&error, GW_NO_OUTPUT, "standard output could not be written: %s", strerror(unwritten));
        /* Who reads on through 'head' has seen enough, and wants no word about it. */
        if (unwritten != EPIPE)
            gw_console_fail(NULL, &error);
    }
    return code;
}
