/* `gazewall sim`: the wall on one machine; `gazewall wall`: on the hosts of its site. */
#include "wall/verbs.h"

#include "base/file.h"
#include "base/window.h"
#include "wall/console.h"
#include "wall/launcher.h"
#include "wall/mpirun_command.h"
#include "wall/sim_options.h"
#include "wall/video.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

/* A word of the command line holds as much everywhere. */
enum { PROFILE_LIMIT = 64 << 10 };

/* What cannot be written in the end is told before anything is loaded. */
static gw_code check_places(const gw_sim_options *options, gw_error *error) {
    gw_code code = options->out ? gw_make_directories(options->out, error) : GW_OK;
    if (!code && options->out && access(options->out, W_OK))
        code = gw_fail(error, GW_NO_OUTPUT, "%s: nothing can be written there: %s", options->out,
                       strerror(errno));
    if (!code)
        code = gw_file_writable(options->draw.report, error);
    if (!code)
        code = gw_video_check(options->pictures.video, error);
    return code ? code : gw_file_writable(options->save_states, error);
}

/* A display that is not there is told before anything is started. Tiles on displays of their own tell it
 * themselves. */
static gw_code check_windows(const gw_sim_options *options, const gw_site *site, gw_error *error) {
    int wanted = options->windows == GW_WINDOWS_WALL;
    for (uint32_t i = 0; i < site->layout.tile_count && options->windows == GW_WINDOWS_TILES; i++)
        wanted |= !site->panels[i].display[0];
    return wanted ? gw_window_possible(error) : GW_OK;
}

/* Profiles that are files here go to every rank with the command. */
static gw_code carry_profiles(const gw_draw_options *draw, gw_words *out, gw_error *error) {
    gw_code code = GW_OK;
    for (size_t i = 0; i < draw->profile_count && !code; i++) {
        gw_bytes bytes = {0};
        if (!gw_file_exists(draw->profiles[i]))
            continue;
        code = gw_file_read(draw->profiles[i], PROFILE_LIMIT, &bytes, error);
        if (!code)
            gw_words_add(out, "--profile-text=%s\n%.*s", draw->profiles[i], (int)bytes.size,
                         (const char *)bytes.data);
        gw_bytes_finish(&bytes);
    }
    return !code && out->failed ? gw_fail(error, GW_MACHINE, "memory is out while reading a profile") : code;
}

static gw_code run(gw_sim_options *options, int argc, char **argv, gw_words *carried, gw_error *error) {
    static gw_site site;
    static gw_site_notes notes;
    static gw_hosts hosts;
    gw_console console;
    gw_code code = gw_wall_site_noting(&options->wall, &site, &notes, error);
    if (code)
        return code;
    if (options->cluster)
        gw_hosts_find(&site, &hosts);
    else
        gw_hosts_simulate(&site, &hosts);
    code = carry_profiles(&options->draw, carried, error);
    if (code)
        return code;
    gw_console_init(&console, argv[0], options->draw.level, options->draw.quiet);
    gw_site_warn(options->wall.site, &notes, &console.log);
    const gw_launch_plan plan = {.site = &site,
                                 .hosts = &hosts,
                                 .console = &console,
                                 .load_deadline = gw_sim_times(options, &site).load,
                                 .verb = argv[0],
                                 .agent = options->agent,
                                 .carried = carried,
                                 .argc = argc,
                                 .argv = argv};
    if (options->dry_run)
        return gw_launch_show(&plan, error);
    const gw_host *first = &hosts.host[hosts.of_tile[0]];
    if (first->here)
        code = check_places(options, error);
    else
        gw_log_write(&console.log, GW_LOG_INFO,
                     "files are read and written on %s, which draws the first tile", first->name);
    if (!code && first->here)
        code = check_windows(options, &site, error);
    return code ? code : gw_launch(&plan, error);
}

static int run_verb(int argc, char **argv) {
    static gw_sim_options options;
    gw_error error = {0};
    int helped = 0;
    gw_words carried = {0};
    gw_code code = gw_sim_options_parse(argc, argv, &options, &helped, &error);
    if (!code && !helped)
        code = run(&options, argc, argv, &carried, &error);
    gw_words_finish(&carried);
    return code ? gw_console_fail(argv[0], &error) : GW_OK;
}

int gw_verb_sim(int argc, char **argv) {
    return run_verb(argc, argv);
}

int gw_verb_wall(int argc, char **argv) {
    return run_verb(argc, argv);
}
