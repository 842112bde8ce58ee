/* `gazewall sim`: the wall on one machine. */
#include "wall/verbs.h"

#include "base/file.h"
#include "wall/console.h"
#include "wall/launcher.h"
#include "wall/sim_options.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

/* What cannot be written in the end is told before anything is loaded. */
static gw_code check_places(const gw_sim_options *options, gw_error *error) {
    gw_code code = options->out ? gw_make_directories(options->out, error) : GW_OK;
    if (!code && options->out && access(options->out, W_OK))
        code = gw_fail(error, GW_NO_OUTPUT, "%s: nothing can be written there: %s", options->out,
                       strerror(errno));
    if (!code)
        code = gw_file_writable(options->draw.report, error);
    return code ? code : gw_file_writable(options->save_states, error);
}

int gw_verb_sim(int argc, char **argv) {
    static gw_sim_options options;
    static gw_site site;
    gw_console console;
    gw_error error = {0};
    int helped = 0;
    gw_code code = gw_sim_options_parse(argc, argv, &options, &helped, &error);
    if (helped && !code)
        return GW_OK;
    if (!code)
        code = gw_wall_site(&options.wall, &site, &error);
    if (!code)
        code = check_places(&options, &error);
    if (code)
        return gw_console_fail("sim", &error);
    gw_console_init(&console, "sim", options.draw.level, options.draw.quiet);
    const gw_launch_plan plan = {.layout = &site.layout,
                                 .console = &console,
                                 .load_deadline = options.load_deadline,
                                 .argc = argc,
                                 .argv = argv};
    return gw_launch(&plan, &error) ? gw_console_fail("sim", &error) : GW_OK;
}
