/* `gazewall doctor SITE`: can this wall run, and if not, what is to be done? Main thread. */
#include "wall/console.h"
#include "wall/doctor.h"
#include "wall/options.h"
#include "wall/verbs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct doctor_options {
    gw_error *error;
    const char *site, *agent;
    int quiet;
} doctor_options;

enum { KEY_AGENT = 0x2000, KEY_QUIET };

static const struct argp_option option_table[] = {
    {"agent", KEY_AGENT, "COMMAND", 0,
     "what starts a program on another host, given its name and a command, as ssh does (default: "
     "$GAZEWALL_AGENT, or ssh)",
     0},
    {"quiet", KEY_QUIET, NULL, 0, "print only what is wrong or worth knowing", 0},
    {0},
};

static error_t parse_option(int key, char *value, struct argp_state *state) {
    doctor_options *options = state->input;
    switch (key) {
    case KEY_AGENT:
        return gw_parse_name("--agent", value, &options->agent, options->error) ? EINVAL : 0;
    case KEY_QUIET:
        options->quiet = 1;
        return 0;
    case ARGP_KEY_ARG:
        if (options->site) {
            gw_fail(options->error, GW_BAD_INPUT, "one site at a time: '%s' is a second one after '%s'",
                    value, options->site);
            return EINVAL;
        }
        options->site = value;
        return 0;
    case ARGP_KEY_END:
        if (options->site)
            return 0;
        gw_fail(options->error, GW_BAD_INPUT, "name a site file: gazewall doctor lab.yaml");
        return EINVAL;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp doctor_argp = {
    .options = option_table,
    .parser = parse_option,
    .args_doc = "SITE",
    .doc =
        "Tests every hop that a wall needs, host by host: the name, the way there, the agent that starts "
        "programs, the same gazewall and MPI, the way back, the clock, memory, every GPU and display; then "
        "the ways between the hosts, and the tracker. Each finding is one line: good, mind (it works, but), "
        "or WRONG with what mends it."
        "\vExit codes: 0 nothing is wrong; 2 the site file or a name in it is; 3 a machine, a program or the "
        "way between them is.\n\n"
        "gazewall doctor lab.yaml\n"
        "gazewall doctor lab.yaml --agent 'ssh -p 2222'",
};

int gw_verb_doctor(int argc, char **argv) {
    static gw_site site;
    static gw_hosts hosts;
    gw_error error = {0};
    doctor_options options = {.error = &error};
    int helped = 0;
    gw_code code = gw_arguments_parse(&doctor_argp, argc, argv, &options, &helped, &error);
    if (!code && !helped)
        code = gw_site_load(options.site, &site, &error);
    if (code)
        return gw_console_fail("doctor", &error);
    if (helped)
        return GW_OK;
    const char *agent = options.agent ? options.agent : getenv("GAZEWALL_AGENT");
    gw_doctor doctor = {.site = &site,
                        .hosts = &hosts,
                        .agent = agent && agent[0] ? agent : "ssh -o BatchMode=yes -o ConnectTimeout=5",
                        .quiet = options.quiet};
    gw_hosts_find(&site, &hosts);
    gw_doctor_examine(&doctor);
    if (!options.quiet || doctor.counts[GW_FINDING_WRONG])
        printf("\n%u good, %u to mind, %u wrong\n", doctor.counts[GW_FINDING_GOOD],
               doctor.counts[GW_FINDING_MIND], doctor.counts[GW_FINDING_WRONG]);
    return (int)doctor.code;
}
