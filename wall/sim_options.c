#include "wall/sim_options.h"

#include "base/suggest.h"
#include "tracking/server.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

gw_code gw_choose_gaze(gw_gaze_choice *choice, gw_gaze_choice wanted, gw_error *error) {
    if (*choice != GW_GAZE_FROM_TRACK && *choice != wanted)
        return gw_fail(error, GW_BAD_INPUT,
                       "--gaze says where somebody looks, --no-gaze that nobody does; leave out one of them");
    *choice = wanted;
    return GW_OK;
}

gw_site_times gw_sim_times(const gw_sim_options *options, const gw_site *site) {
    gw_site_times times = site->times;
    if (options->load_deadline > 0)
        times.load = options->load_deadline;
    if (options->death_deadline > 0)
        times.death = options->death_deadline;
    if (options->frame_deadline > 0)
        times.frame = options->frame_deadline;
    if (options->restarts >= 0)
        times.restarts = (double)options->restarts;
    return times;
}

uint32_t gw_sim_restarts(const gw_sim_options *options, const gw_site *site) {
    return options->live ? (uint32_t)gw_sim_times(options, site).restarts : 0;
}

enum {
    KEY_TILES = 0x2000,
    KEY_SIZE,
    KEY_COLUMNS,
    KEY_ROWS,
    KEY_SITE,
    KEY_WALL_WIDTH,
    KEY_BEZEL,
    KEY_STEREO,
    KEY_EYE_DISTANCE,
    KEY_TRACK,
    KEY_SERVE,
    KEY_PATH,
    KEY_STATES,
    KEY_SAVE_STATES,
    KEY_OUT,
    KEY_FRAMES,
    KEY_STEP,
    KEY_GAZE,
    KEY_NO_GAZE,
    KEY_STILL,
    KEY_BUDGET,
    KEY_BUDGET_RAYS,
    KEY_LOAD_DEADLINE,
    KEY_FRAME_DEADLINE,
    KEY_DEATH_DEADLINE,
    KEY_LIVE,
    KEY_GATE_ONLY,
    KEY_TILE_FAULT,
    KEY_BUILDERS,
    KEY_BUILDER_FAULT,
    KEY_MACHINES,
    KEY_AGENT,
    KEY_DRY_RUN,
    KEY_VERB,
    KEY_LINK,
    KEY_REJOIN,
    KEY_RESTARTS,
    KEY_WINDOW,
    KEY_TILE_WINDOWS,
    KEY_HEADLESS,
    KEY_INPUT
};

static const struct argp_option sim_options[] = {
    {NULL, 0, NULL, 0, "The wall:", 1},
    {"tiles", KEY_TILES, "CxR", 0, "columns x rows of tiles, one rank each; default 2x2, at most 64 tiles",
     1},
    {"size", KEY_SIZE, "WxH", 0,
     "the whole wall in px, default 960x540; splits that do not divide it give unequal tiles", 1},
    {"columns", KEY_COLUMNS, "W,W,...", 0, "px, an uneven split: the width of each column of tiles", 1},
    {"rows", KEY_ROWS, "H,H,...", 0, "px, the height of each row of tiles", 1},
    {"wall-width", KEY_WALL_WIDTH, "MM", 0,
     "10 to 1e6 mm, default 2000: width of the wall's pixels together; the untracked viewer stands 0.9 of it "
     "away",
     1},
    {"bezel", KEY_BEZEL, "MM", 0, "0 to 1000 mm, default 0: bezel of every tile on every side", 1},
    {"site", KEY_SITE, "FILE", 0,
     "a site file (docs/sites.md) or one inside the program, as 3x2-bezels, instead of all of the above", 1},
    {"stereo", KEY_STEREO, "MODE", 0,
     "two eyes on every tile: side-by-side, top-bottom, anaglyph (red and cyan), row-interlace; or one of "
     "them: left, "
     "right; default: mono, or as the site says",
     1},
    {"eye-distance", KEY_EYE_DISTANCE, "MM", 0,
     "0 to 100 mm between a viewer's eyes along the head, default 63, or as the site says: for stereo", 1},
    {NULL, 0, NULL, 0, "Who looks where:", 2},
    {"track", KEY_TRACK, "FILE|SOURCE", 0,
     "recording of head and gaze, or a live source: NAME@HOST[:PORT] of VRPN, dtrack:PORT, gaze:PORT, "
     "path:FILE "
     "(docs/tracks.md); default: the site's trackers, else the embedded demo track",
     2},
    {"gaze", KEY_GAZE, "X,Y", 0, "px of the wall: no track, the untracked viewer looks there", 2},
    {"no-gaze", KEY_NO_GAZE, NULL, 0, "no track, nobody's gaze is known: sharp everywhere", 2},
    {"path", KEY_PATH, "NAME", 0,
     "the scene moves past the wall along a camera path of it, by name or number from 0; without --step the "
     "frames spread "
     "over it",
     2},
    {"frames", KEY_FRAMES, "N", 0, "1 to 1000000, default 1 (or all of --states)", 2},
    {"step", KEY_STEP, "SECONDS", 0,
     "0 to 3600 s from frame to frame; default: the frames spread over the track", 2},
    {"states", KEY_STATES, "FILE", 0, "repeat recorded frame states instead of a track", 2},
    {"save-states", KEY_SAVE_STATES, "FILE", 0, "record the frame states, one per frame", 2},
    {"serve", KEY_SERVE, "PROTOCOL", 0,
     "eyes and gazes of every frame for other programs: vrpn[:PORT] (device Tracker0; default 3883), "
     "dtrack[:[ADDRESS:]PORT] or gaze:[ADDRESS:]PORT",
     2},
    {"still", KEY_STILL, "MM,DEGREES", 0,
     "0,0 to 100,10, default 0,0: with 'accumulate', eyes and gazes that moved less since the view's first "
     "sample "
     "stand still",
     2},
    {"budget", KEY_BUDGET, "MS", 0,
     "0.1 to 60000 ms: strain sharpness outside the gaze so that no tile takes longer for a frame", 2},
    {"budget-rays", KEY_BUDGET_RAYS, "N", 0,
     "1 to 1e12: the same by rays of a frame of the whole wall; equal runs decide alike", 2},
    {NULL, 0, NULL, 0, "Results:", 3},
    {"out", KEY_OUT, "FOLDER", 0,
     "write pictures of the wall with and without bezels and of every tile, and frames.csv; made if missing",
     3},
    {NULL, 0, NULL, 0, "What is seen while it runs (docs/windows.md):", 5},
    {"window", KEY_WINDOW, NULL, 0,
     "the whole wall in one window: the gaze follows the mouse, keys and mouse fly; runs until it is closed, "
     "or for --frames N",
     5},
    {"tile-windows", KEY_TILE_WINDOWS, NULL, 0,
     "every tile in a window of its own: where the site file says, else side by side as they hang", 5},
    {"headless", KEY_HEADLESS, NULL, 0, "no window, whatever the site file says; the default of sim", 5},
    {"input", KEY_INPUT, "FILE", 0,
     "steer by recorded keys and pointer moves (docs/windows.md), with or without a window", 5},
    {NULL, 0, NULL, 0, "Patience:", 12},
    {"live", KEY_LIVE, NULL, 0,
     "frames go on without tiles that are late, as 'gazewall wall' does without --out and --states; "
     "otherwise every "
     "frame waits until all tiles have it or are lost",
     12},
    {"load-deadline", KEY_LOAD_DEADLINE, "SECONDS", 0,
     "1 to 86400 s, default the site's or 600: all ranks must be ready by then", 12},
    {"frame-deadline", KEY_FRAME_DEADLINE, "SECONDS", 0,
     "with --live, 0.001 to 3600 s: how long a frame waits for a late tile once rank 0's is drawn; default "
     "the "
     "site's, or 3 periods of its refresh rate, or 2 median tiles where those take longer",
     12},
    {"death-deadline", KEY_DEATH_DEADLINE, "SECONDS", 0,
     "0.1 to 3600 s: a tile silent for so long is lost; default the site's or 2 with --live, otherwise 20 "
     "median "
     "frames, at least 10 s",
     12},
    {"restarts", KEY_RESTARTS, "N", 0,
     "with --live, 0 to 60, default the site's or 3: how often a minute a tile whose process ended is "
     "started again",
     12},
    {"gate-only", KEY_GATE_ONLY, NULL, 0, "nothing is loaded or drawn: what the frame gate alone costs", 12},
    {"tile-fault", KEY_TILE_FAULT, "KIND:TILE@FRAME", 0,
     "to try what a wall does: tile TILE has a fault at that frame: kill, die (again and again), stop, hang, "
     "slow "
     "(from then on) or context; up to 8 times (docs/gate.md)",
     12},
    {NULL, 0, NULL, 0, "Who works:", 4},
    {"builders", KEY_BUILDERS, "N", 0,
     "1 to 64: ranks that build the octree together, each a part of its cells, or 'auto' (default): one of "
     "every "
     "machine; the octree's bytes are the same for any number",
     4},
    {"agent", KEY_AGENT, "COMMAND", 0,
     "wall: what starts a program on another host, given its name and a command, as ssh does (default: "
     "$GAZEWALL_AGENT, or ssh)",
     4},
    {"dry-run", KEY_DRY_RUN, NULL, 0, "print the mpirun command and start nothing", 4},
    {"verb", KEY_VERB, "VERB", OPTION_HIDDEN, NULL, 0},
    {"builder-fault", KEY_BUILDER_FAULT, "KIND:RANK", OPTION_HIDDEN, NULL, 0},
    {"machines", KEY_MACHINES, "N", OPTION_HIDDEN, NULL, 0},
    {"link", KEY_LINK, "NAME", OPTION_HIDDEN, NULL, 0},
    {"rejoin", KEY_REJOIN, "PLACE", OPTION_HIDDEN, NULL, 0},
    {0}};

static gw_code parse_stereo(const char *argument, gw_wall_options *wall, gw_error *error) {
    wall->stereo_given = 1;
    for (int i = 0; i < GW_STEREO_COUNT; i++)
        if (!strcmp(argument, gw_stereo_names[i])) {
            wall->stereo = (gw_stereo)i;
            return GW_OK;
        }
    const char *near = gw_suggest(argument, gw_stereo_names, GW_STEREO_COUNT);
    return gw_fail(error, GW_BAD_INPUT,
                   "--stereo '%.40s' is unknown%s%s; it must be mono, side-by-side, top-bottom, anaglyph, "
                   "row-interlace, left or right",
                   argument, near ? "; did you mean " : "", near ? near : "");
}

static gw_code parse_wall(int key, const char *argument, gw_wall_options *wall, gw_error *error) {
    switch (key) {
    case KEY_TILES:
        wall->tiles_given = 1;
        return gw_parse_pair("--tiles", argument, GW_MAXIMUM_TILES, wall->tiles, error);
    case KEY_SIZE:
        wall->size_given = 1;
        return gw_parse_pair("--size", argument, GW_MAXIMUM_WALL_SIDE, wall->size, error);
    case KEY_COLUMNS:
        return gw_parse_integers("--columns", argument, GW_MAXIMUM_TILES, GW_MAXIMUM_WALL_SIDE, wall->widths,
                                 &wall->width_count, error);
    case KEY_ROWS:
        return gw_parse_integers("--rows", argument, GW_MAXIMUM_TILES, GW_MAXIMUM_WALL_SIDE, wall->heights,
                                 &wall->height_count, error);
    case KEY_WALL_WIDTH:
        wall->wall_width_given = 1;
        return gw_parse_number("--wall-width", argument, 10, 1e6, &wall->wall_width, error);
    case KEY_BEZEL:
        return gw_parse_number("--bezel", argument, 0, 1000, &wall->bezel, error);
    case KEY_STEREO:
        return parse_stereo(argument, wall, error);
    case KEY_EYE_DISTANCE:
        return gw_parse_number("--eye-distance", argument, 0, 100, &wall->eye_distance, error);
    default:
        wall->site = argument;
        return GW_OK;
    }
}

static gw_code parse_builders(int key, const char *argument, gw_sim_options *options, gw_error *error) {
    int64_t integer = 0;
    if (key == KEY_BUILDERS) {
        gw_code code = strcmp(argument, "auto") ? gw_parse_integer("--builders", argument, 1,
                                                                   GW_OCTREE_MAXIMUM_PARTS, &integer, error)
                                                : GW_OK;
        options->builders = (uint32_t)integer;
        return code;
    }
    options->fault = strncmp(argument, "foreign:", 8) == 0 ? GW_BUILDER_FOREIGN : GW_BUILDER_FAILING;
    const char *rank = strchr(argument, ':');
    gw_code code =
        gw_parse_integer("--builder-fault", rank ? rank + 1 : "", 0, GW_MAXIMUM_TILES, &integer, error);
    options->fault_rank = (int)integer;
    return code;
}

static gw_code parse_frames(int key, const char *argument, gw_sim_options *options, gw_error *error) {
    int64_t integer = 0;
    gw_code code = GW_OK;
    switch (key) {
    case KEY_FRAMES:
        code = gw_parse_integer("--frames", argument, 1, 1000000, &integer, error);
        options->frames = (uint32_t)integer;
        return code;
    case KEY_MACHINES:
        code = gw_parse_integer("--machines", argument, 1, GW_MAXIMUM_TILES, &integer, error);
        options->machines = (int)integer;
        return code;
    case KEY_STEP:
        return gw_parse_number("--step", argument, 0, 3600, &options->step, error);
    case KEY_GAZE:
        code = gw_choose_gaze(&options->gaze, GW_GAZE_AT_PIXEL, error);
        return code ? code : gw_parse_numbers("--gaze", argument, 2, options->gaze_pixel, error);
    case KEY_STILL:
        code = gw_parse_numbers("--still", argument, 2, options->still, error);
        if (!code && !(options->still[0] >= 0 && options->still[0] <= 100 && options->still[1] >= 0 &&
                       options->still[1] <= 10))
            code =
                gw_fail(error, GW_BAD_INPUT,
                        "--still '%s' is out of range; it must be MM,DEGREES from 0,0 to 100,10", argument);
        return code;
    case KEY_BUDGET:
        return gw_parse_number("--budget", argument, 0.1, 60000, &options->budget_ms, error);
    case KEY_BUDGET_RAYS:
        return gw_parse_number("--budget-rays", argument, 1, 1e12, &options->budget_rays, error);
    case KEY_RESTARTS:
        return gw_parse_integer("--restarts", argument, 0, 60, &options->restarts, error);
    case KEY_LOAD_DEADLINE:
        return gw_parse_number("--load-deadline", argument, 1, 86400, &options->load_deadline, error);
    case KEY_DEATH_DEADLINE:
        return gw_parse_number("--death-deadline", argument, 0.1, 3600, &options->death_deadline, error);
    case KEY_TILE_FAULT:
        if (options->tile_fault_count == GW_MAXIMUM_FAULTS)
            return gw_fail(error, GW_BAD_INPUT, "--tile-fault is given more than %d times",
                           GW_MAXIMUM_FAULTS);
        return gw_tile_fault_parse(argument, &options->tile_faults[options->tile_fault_count++], error);
    default:
        return gw_parse_number("--frame-deadline", argument, 0.001, 3600, &options->frame_deadline, error);
    }
}

/* Of --window, --tile-windows and --headless one at most. */
static gw_code choose_windows(int key, gw_sim_options *options, gw_error *error) {
    const gw_windows asked = key == KEY_WINDOW         ? GW_WINDOWS_WALL
                             : key == KEY_TILE_WINDOWS ? GW_WINDOWS_TILES
                                                       : GW_WINDOWS_NONE;
    const int said = options->headless || options->windows != GW_WINDOWS_NONE;
    if (said && (asked != options->windows || options->headless != (key == KEY_HEADLESS)))
        return gw_fail(error, GW_BAD_INPUT,
                       "--window, --tile-windows and --headless exclude each other; leave all but one out");
    options->windows = asked;
    options->headless = key == KEY_HEADLESS;
    return GW_OK;
}

static error_t parse_sim(int key, char *argument, struct argp_state *state) {
    gw_sim_options *options = state->input;
    gw_error *error = options->draw.error;
    gw_code code = GW_OK;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->draw;
        state->child_inputs[1] = &options->pictures;
        break;
    case KEY_TILES:
    case KEY_SIZE:
    case KEY_COLUMNS:
    case KEY_ROWS:
    case KEY_WALL_WIDTH:
    case KEY_BEZEL:
    case KEY_STEREO:
    case KEY_EYE_DISTANCE:
    case KEY_SITE:
        code = parse_wall(key, argument, &options->wall, error);
        break;
    case KEY_FRAMES:
    case KEY_MACHINES:
    case KEY_STEP:
    case KEY_GAZE:
    case KEY_STILL:
    case KEY_BUDGET:
    case KEY_BUDGET_RAYS:
    case KEY_RESTARTS:
    case KEY_LOAD_DEADLINE:
    case KEY_FRAME_DEADLINE:
    case KEY_DEATH_DEADLINE:
    case KEY_TILE_FAULT:
        code = parse_frames(key, argument, options, error);
        break;
    case KEY_LIVE:
        options->live = 1;
        break;
    case KEY_GATE_ONLY:
        options->gate_only = 1;
        break;
    case KEY_BUILDERS:
    case KEY_BUILDER_FAULT:
        code = parse_builders(key, argument, options, error);
        break;
    case KEY_NO_GAZE:
        code = gw_choose_gaze(&options->gaze, GW_GAZE_NONE, error);
        break;
    case KEY_WINDOW:
    case KEY_TILE_WINDOWS:
    case KEY_HEADLESS:
        code = choose_windows(key, options, error);
        break;
    case KEY_INPUT:
        options->input = argument;
        break;
    case KEY_TRACK:
        options->track = argument;
        break;
    case KEY_SERVE:
        options->serve = argument;
        code = gw_server_check(argument, error);
        break;
    case KEY_PATH:
        options->path = argument;
        break;
    case KEY_STATES:
        options->states = argument;
        break;
    case KEY_SAVE_STATES:
        code = gw_parse_name("--save-states", argument, &options->save_states, error);
        break;
    case KEY_OUT:
        code = gw_parse_name("--out", argument, &options->out, error);
        break;
    case KEY_AGENT:
        code = gw_parse_name("--agent", argument, &options->agent, error);
        break;
    case KEY_DRY_RUN:
        options->dry_run = 1;
        break;
    case KEY_VERB:
        options->cluster = !strcmp(argument, "wall");
        break;
    case KEY_LINK:
        options->link = argument;
        break;
    case KEY_REJOIN:
        options->rejoin = argument;
        break;
    case ARGP_KEY_ARG:
        code = gw_stray_argument(argument, error);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return code ? EINVAL : 0;
}

static const struct argp_child children[] = {
    {&gw_draw_argp, 0, NULL, 0}, {&gw_picture_argp, 0, NULL, 0}, {0}};

static const struct argp sim_argp = {
    .options = sim_options,
    .parser = parse_sim,
    .children = children,
    .doc = "The wall on one machine: starts one MPI rank per tile under mpirun, shares one octree among "
           "them, draws the "
           "frames in lock-step and assembles the pictures.\v"
           "Examples:\n"
           "  gazewall sim --out pictures\n"
           "  gazewall sim --window\n"
           "  gazewall sim --scene dragon.glb --tiles 3x1 --size 1536x512 --frames 8 --out pictures\n"
           "  gazewall sim --site configs/sites/3x2-bezels.yaml --gaze 480,180 --out pictures\n"};

static const struct argp wall_argp = {
    .options = sim_options,
    .parser = parse_sim,
    .children = children,
    .doc =
        "The wall on its hosts: starts one MPI rank per tile of --site on the machine that drives it, shares "
        "one octree among them and draws frames until it is ended: Ctrl-C, or --frames N.\v"
        "Examples:\n"
        "  gazewall doctor lab.yaml\n"
        "  gazewall wall --site lab.yaml --scene dragon.glb --dry-run\n"
        "  gazewall wall --site lab.yaml --scene dragon.glb --report report.json\n"};

static gw_code check_wall(gw_sim_options *options, gw_error *error) {
    const char *agent = getenv("GAZEWALL_AGENT");
    if (!options->cluster)
        return options->agent ? gw_fail(error, GW_BAD_INPUT,
                                        "--agent is for gazewall wall; sim starts nothing on other hosts")
                              : GW_OK;
    if (!options->wall.site)
        return gw_fail(error, GW_BAD_INPUT,
                       "gazewall wall needs --site FILE, which says what hangs where (docs/sites.md); "
                       "gazewall sim tries a wall out on this machine");
    if (options->save_states && !options->frames && !options->states)
        return gw_fail(error, GW_BAD_INPUT,
                       "--save-states needs --frames: a wall without an end has states without an end");
    if (!options->agent && agent && agent[0])
        options->agent = agent;
    return GW_OK;
}

int gw_sim_is_steered(const gw_sim_options *options) {
    return options->windows == GW_WINDOWS_WALL || options->input;
}

int gw_sim_runs_free(const gw_sim_options *options) {
    return gw_sim_is_steered(options) || (options->cluster && !options->frames && !options->states);
}

gw_code gw_sim_options_parse(int argc, char **argv, gw_sim_options *out, int *helped, gw_error *error) {
    memset(out, 0, sizeof *out);
    gw_draw_options_init(&out->draw, error);
    out->draw.keeps = 1;
    out->pictures.error = error;
    gw_wall_options_init(&out->wall, 2, 2);
    out->step = -1;
    out->restarts = -1;
    out->cluster = !strcmp(argv[0], "wall");
    gw_code code = gw_arguments_parse(out->cluster ? &wall_argp : &sim_argp, argc, argv, out, helped, error);
    if (code || *helped)
        return code;
    if ((code = check_wall(out, error)))
        return code;
    if (out->cluster && !out->headless && out->windows == GW_WINDOWS_NONE)
        out->windows = GW_WINDOWS_SITE;
    /* A wall that somebody stands before goes on; pictures and repeated states are to be whole. */
    out->live |= out->cluster && !out->out && !out->states;
    if (out->track && (out->gaze != GW_GAZE_FROM_TRACK || out->states))
        return gw_fail(error, GW_BAD_INPUT, "--track goes with neither --gaze, --no-gaze nor --states");
    if (out->frame_deadline > 0 && !out->live)
        return gw_fail(error, GW_BAD_INPUT,
                       "--frame-deadline goes with --live: without it every frame waits for all tiles; "
                       "--death-deadline says when a silent one is lost");
    if (out->restarts > 0 && !out->live)
        return gw_fail(error, GW_BAD_INPUT,
                       "--restarts goes with --live: otherwise a tile that was lost stays lost");
    if (out->gate_only && (out->out || out->save_states))
        return gw_fail(error, GW_BAD_INPUT, "--gate-only draws nothing; leave out --out and --save-states");
    if (out->budget_ms > 0 && out->budget_rays > 0)
        return gw_fail(error, GW_BAD_INPUT, "--budget and --budget-rays are two budgets; leave out one");
    if (out->states && (out->budget_ms > 0 || out->budget_rays > 0))
        return gw_fail(
            error, GW_BAD_INPUT,
            "--states holds what a budget decided in every frame; leave out --budget and --budget-rays");
    if (out->draw.settings.accumulate <= 1 && (out->still[0] > 0 || out->still[1] > 0))
        return gw_fail(
            error, GW_BAD_INPUT,
            "--still says what stands still while samples add up, and none do; give --set accumulate=N, too");
    if (out->states && (code = gw_draw_options_decide_frames(&out->draw, error)))
        return code;
    if (out->states && (out->still[0] > 0 || out->still[1] > 0))
        return gw_fail(error, GW_BAD_INPUT, "--states holds what stood still; leave out --still");
    if (out->pictures.pattern && (out->draw.scene || out->path))
        return gw_fail(error, GW_BAD_INPUT,
                       "--pattern is drawn instead of a scene; leave out --scene and --path");
    if (out->pictures.pattern && (out->budget_ms > 0 || out->budget_rays > 0))
        return gw_fail(error, GW_BAD_INPUT, "--pattern traces no rays; leave out --budget and --budget-rays");
    if (out->pictures.rate > 0 && !out->pictures.video)
        return gw_fail(error, GW_BAD_INPUT, "--fps is the pace of a video; give --video FILE, too");
    if (out->states && out->wall.eye_distance >= 0)
        return gw_fail(error, GW_BAD_INPUT, "--states holds where both eyes are; leave out --eye-distance");
    if (out->states && out->path)
        return gw_fail(error, GW_BAD_INPUT, "--states holds where every frame stands; leave out --path");
    if (out->pictures.pattern && (out->windows == GW_WINDOWS_WALL || out->input))
        return gw_fail(
            error, GW_BAD_INPUT,
            "--pattern has nothing to fly through; leave out --window and --input, or take --tile-windows");
    if (out->states && out->input)
        return gw_fail(error, GW_BAD_INPUT, "--states holds where every frame stands; leave out --input");
    if (out->draw.choose_gpu && out->windows == GW_WINDOWS_TILES)
        return gw_fail(error, GW_BAD_INPUT,
                       "tiles with windows are drawn by the GPU of their display; leave out --gpu");
    if (out->states && out->gaze != GW_GAZE_FROM_TRACK)
        return gw_fail(error, GW_BAD_INPUT,
                       "--states holds the gaze of every frame; leave out --gaze and --no-gaze");
    return out->pictures.remake ? gw_sim_options_remake(out, error) : GW_OK;
}
