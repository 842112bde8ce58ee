/* Site files: thirty and more wrong ones with message and line, what is only warned of, generators against
 * corners worked out by hand, printed corners that give the same bits, the examples of the manual, the
 * difference of two sites, the drawing. */
#include "tests/support/check.h"

#include "base/file.h"
#include "render/vector3.h"
#include "tests/fuzz/site_entry.h"
#include "wall/site.h"

#include <math.h>

static gw_site site, other;
static gw_site_notes notes;

static gw_code parse(const char *text, gw_site *out, gw_error *error) {
    return gw_site_parse(text, strlen(text), "wall.yaml", out, &notes, error);
}

#define GRID "grid: {columns: 2, rows: 1, tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
#define LEFT                                                                                                 \
    "tiles:\n"                                                                                               \
    "  - name: left\n"                                                                                       \
    "    corners: [[-400, 300, 0], [0, 300, 0], [-400, 0, 0]]\n"                                             \
    "    pixels: [40, 30]\n"                                                                                 \
    "    place: [0, 0]\n"
#define TILE(name, corners, place)                                                                           \
    "  - {name: " name ", pixels: [40, 30], place: " place ",\n     corners: " corners "}\n"

typedef struct mistake {
    const char *text;
    int line;
    const char *message;
} mistake;

static const mistake mistakes[] = {
    {"", 1, "there is nothing in it"},
    {"version: 1\ngrid: [\n", 3, "not valid YAML"},
    {"- version: 1\n", 1, "expected a map of keys and values, found a list"},
    {GRID, 1, "key 'version' is missing here"},
    {"version: 2\n" GRID, 1, "key 'version': 2 is outside 1 to 1"},
    {"version: 1\n", 1, "one of 'grid', 'curve', 'walls' or 'tiles'; this one has 0"},
    {"version: 1\n" GRID LEFT, 4, "this one has 2 of them"},
    {"version: 1\nversion: 1\n" GRID, 2, "key 'version' is given twice; the first is in line 1"},
    {"version: 1\neyes: [0, 0, 900]\n" GRID, 2, "key 'eyes' is unknown; did you mean 'eye'?"},
    {"version: 1\neye: [0, 0]\n" GRID, 2, "key 'eye': expected 3 numbers, found 2"},
    {"version: 1\neye: [0, 0, 2m]\n" GRID, 2, "key 'eye': item 3: expected a number, found '2m'"},
    {"version: 1\neye: [0, 0, 2e9]\n" GRID, 2, "more than a kilometre away; expected mm"},
    {"version: 1\neye: [0, 0, 1.8]\n" GRID, 2, "the eye at [0, 0, 1.8] is 2 mm in front of tile 'c0r0'"},
    {"version: 1\neye: [0, 0, -1800]\n" GRID, 2, "is 1800 mm behind tile 'c0r0'"},
    {"version: 1\neye_distance: 6.3 cm\n" GRID, 2, "key 'eye_distance': expected a number, found '6.3 cm'"},
    {"version: 1\neye_distance: 630\n" GRID, 2, "key 'eye_distance': 630 is outside 0 to 100"},
    {"version: 1\ngrid:\n  columns: 2\n", 3, "key 'rows' is missing here"},
    {"version: 1\ngrid:\n  columns: 0\n  rows: 1\n", 3, "key 'columns': 0 is outside 1 to 64"},
    {"version: 1\ngrid:\n  columns: 13\n  rows: 5\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n", 3,
     "13x5 tiles is out of range; a wall has 1 to 64 tiles"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 1.2, height: 0.9, pixels: [40, 30]}\n", 5,
     "key 'height': 0.9 is outside 1 to 100000"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 48, height: 27, pixels: [1920, 1080]}\n", 3,
     "48 x 27 mm for 1920x1080 pixels, 0.025 mm each; expected at least 0.04 mm: is it in inches"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 9000, height: 6000, pixels: [60, 40]}\n", 3,
     "150 mm each; expected at most 100 mm"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40]}\n", 5,
     "key 'pixels': 1 values; expected two, across and down"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [20000, "
     "15000]}\n",
     3, "the wall is 40000 px wide; at most 32768"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  bezel: {left: 4mm}\n",
     6, "key 'left': expected a number, found '4mm'"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  bezel: {left: -4}\n",
     6, "key 'left': -4 is outside 0 to 10000"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  gaps: {columns: [5, 6]}\n",
     6, "key 'columns': 2 gaps; 2 columns have 1 gaps between them"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  bezel: {left: 1}\n  gaps: {columns: 5}\n",
     7, "key 'gaps': there is a 'bezel', too; keep one"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  right: [1, 0, 0]\n",
     6, "key 'right' needs 'up' beside it"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  right: [1, 0, 0]\n  up: [0.1, 1, 0]\n",
     7, "keys 'right' and 'up' are at 84.29 degrees instead of 90"},
    {"version: 1\ngrid:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  radius: 900\n",
     6, "key 'radius' is unknown"},
    {"version: 1\ncurve:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n", 3,
     "key 'radius' is missing here"},
    {"version: 1\ncurve:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  radius: 1000\n  angle: 10\n",
     7, "there are 175.0 mm for each tile, whose frame is 400.0 mm wide; expected at least 22.62 degrees"},
    {"version: 1\ncurve:\n  columns: 20\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  radius: 1000\n",
     3, "20 columns at 22.6199 degrees are more than a full circle"},
    {"version: 1\ncurve:\n  columns: 2\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [40, 30]}\n"
     "  radius: 1000\n  angle: 30\n  total_angle: 60\n",
     8, "keys 'angle' and 'total_angle': keep one of them"},
    {"version: 1\nwalls:\n  - {name: a, tile: {width: 400, height: 300, pixels: [40, 30]}}\n", 3,
     "key 'place' is missing here"},
    {"version: 1\nwalls:\n  - {name: a, place: [0, 0], tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
     "  - {name: b, place: [39, 0], centre: [500, 0, 0],\n     tile: {width: 400, height: 300, pixels: [40, "
     "30]}}\n",
     4, "tile 'b' overlaps tile 'a' of line 3 in the picture"},
    {"version: 1\nwalls:\n  - {name: a, place: [0, 0], tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
     "  - {name: b, place: [40, 0], centre: [300, 0, 0],\n     tile: {width: 400, height: 300, pixels: [40, "
     "30]}}\n",
     4, "tile 'b' hangs in tile 'a' of line 3"},
    {"version: 1\nwalls:\n  - {name: a, place: [0, 0], tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
     "  - {name: b, place: [40, 0], centre: [100, 0, 0], right: [0, 0, -1], up: [0, 1, 0],\n"
     "     tile: {width: 400, height: 300, pixels: [40, 30]}}\n",
     4, "tile 'b' hangs in tile 'a' of line 3"},
    {"version: 1\nwalls:\n  - {name: a, place: [0, 0], tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
     "  - {name: a, place: [40, 0], centre: [500, 0, 0],\n     tile: {width: 400, height: 300, pixels: [40, "
     "30]}}\n",
     4, "key 'name': 'a' is a tile in line 3 already"},
    {"version: 1\ntiles: []\n", 2, "0 tiles; a wall has 1 to 64"},
    {"version: 1\ntiles:\n" TILE("'a b'", "[[0, 300, 0], [400, 300, 0], [0, 0, 0]]", "[0, 0]"), 3,
     "key 'name': 'a b' has a character that cannot be here"},
    {"version: 1\ntiles:\n" TILE("a", "[[0, 300, 0], [400, 300, 0]]", "[0, 0]"), 4,
     "key 'corners': 2 points; expected three, in mm: top left, top right, bottom left"},
    {"version: 1\ntiles:\n" TILE("a", "[[0, 0.3, 0], [0.4, 0.3, 0], [0, 0, 0]]", "[0, 0]"), 4,
     "the tile is 0.4 x 0.3 mm; both must be at least 1 mm (are the corners in metres?)"},
    {"version: 1\ntiles:\n" TILE("a", "[[0, 300, 0], [400, 0, 0], [0, 0, 0]]", "[0, 0]"), 4,
     "the top and left edges meet at 53.1 degrees instead of 90"},
    {"version: 1\ntiles:\n" TILE("a", "[[0, 300, 0], [400, 300, 0], [0, 0, 0], [400, 0, 60]]", "[0, 0]"), 4,
     "the fourth corner is 60.0 mm from where the first three put it"},
    {"version: 1\ntiles:\n" TILE("a", "[[0, 300, 0], [400, 300, 0], [0, 0, 0]]", "[-1, 0]"), 3,
     "key 'place': -1 is outside 0 to 32768"},
    {"version: 1\n" LEFT TILE("left", "[[0, 300, 0], [400, 300, 0], [0, 0, 0]]", "[40, 0]"), 7,
     "key 'name': 'left' is a tile in line 3 already"},
    {"version: 1\n" LEFT TILE("right", "[[0, 300, 0], [400, 300, 0], [0, 0, 0]]", "[30, 0]"), 7,
     "tile 'right' overlaps tile 'left' of line 3 in the picture"},
    {"version: 1\n" LEFT TILE("right", "[[400, 300, 0], [1, 300, 0], [400, 0, 0]]", "[40, 0]"), 7,
     "1800 mm behind tile 'right'"},
    {"version: 1\n" LEFT "    framed: [0, 0]\n", 3, "1 of 1 tiles have one and 'framed_size' is missing"},
    {"version: 1\nframed_size: [60, 30]\n" LEFT "    framed: [30, 0]\n", 4,
     "tile 'left' reaches beyond the 'framed_size' of 60x30 px"},
    {"version: 1\n" LEFT "    part: {of: [60, 30], at: [30, 0]}\n", 7,
     "40x30 px at 30, 0 reach beyond the panel's 60x30 px"},
    {"version: 1\npanel: {gama: 2.2}\n" GRID, 2, "key 'gama' is unknown; did you mean 'gamma'?"},
    {"version: 1\nhosts: [{name: a, tiles: [c0r0], panel: {pixels: [40, 30]}}]\n" GRID, 2,
     "key 'pixels' is unknown"},
    {"version: 1\npanels: {c0r0: {pixels: [40, 0]}}\n" GRID, 2, "key 'pixels': 0 is outside 1 to 32768"},
    {"version: 1\npanel: {gamma: 22}\n" GRID, 2, "key 'gamma': 22 is outside 1 to 4"},
    {"version: 1\npanel: {white: [1, 1, 255]}\n" GRID, 2, "key 'white': 255 is outside 0.1 to 1"},
    {"version: 1\npanel: {brightness: 80%}\n" GRID, 2, "key 'brightness': expected a number, found '80%'"},
    {"version: 1\npanel: {display: DP-1}\n" GRID, 2, "key 'display': 'DP-1' is no X display"},
    {"version: 1\npanel: {stereo: sidebyside}\n" GRID, 2,
     "key 'stereo': 'sidebyside' is unknown; did you mean side-by-side"},
    {"version: 1\npanel: {stereo: top-bottom}\ngrid: {columns: 1, rows: 1,\n"
     "       tile: {width: 400, height: 310, pixels: [40, 31]}}\n",
     2, "key 'stereo': tile 'c0r0' is 31 px high"},
    {"version: 1\npanel: {host: -oProxyCommand=x}\n" GRID, 2,
     "key 'host': '-oProxyCommand=x' has a character"},
    {"version: 1\npanel: {host: -lroot}\n" GRID, 2, "key 'host': '-lroot' is no host"},
    {"version: 1\npanel: {gpu: first}\n" GRID, 2, "key 'gpu': expected a whole number, found 'first'"},
    {"version: 1\npanels:\n  c0r0: {gpu: 0}\n  c2r0: {gpu: 1}\n" GRID, 4,
     "key 'panels': no tile is called 'c2r0'; did you mean 'c0r0'?"},
    {"version: 1\npanel: {display: ':0', monitor: DP-1}\n" GRID, 2,
     "tiles 'c1r0' and 'c0r0' (line 2) are both a full screen on monitor DP-1 of display :0"},
    {"version: 1\nhosts:\n  - {name: a, tiles: [c0r0]}\n  - {name: b, tiles: [c*]}\n" GRID, 4,
     "tile 'c0r0' has a host already, in line 3"},
    {"version: 1\nhosts:\n  - {name: a, tiles: [c9*]}\n" GRID, 3, "no tile is called 'c9*'"},
    {"version: 1\nhosts: {a: [c0r0]}\n" GRID, 2, "key 'hosts': expected a list, found a map"},
    {"version: 1\ntimes: {death: 0.5, frame: 1}\n" GRID, 2, "'death' must be greater than 'frame'"},
    {"version: 1\ntimes: {refresh: 60 Hz}\n" GRID, 2, "key 'refresh': expected a number, found '60 Hz'"},
    {"version: 1\nnetwork: {address: node1}\n" GRID, 2, "key 'address': 'node1' is no address"},
    {"version: 1\nnetwork: {port: 80}\n" GRID, 2, "key 'port'"},
    {"version: 1\ntimes: {restarts: 61}\n" GRID, 2, "key 'restarts'"},
    {"version: 1\ntimes: {restarts: 1.5}\n" GRID, 2, "key 'restarts'"},
    {"version: 1\nnetwork: {address: 10.0.0.256}\n" GRID, 2, "'10.0.0.256' is no address"},
    {"version: 1\nnavigation: {speed: 2}\n" GRID, 2, "key 'speed' is unknown"},
    {"version: 1\ntracker: ''\n" GRID, 2, "key 'tracker': 0 characters; expected 1 to 255"},
};

static void wrong_sites_are_refused_with_their_line(void **state) {
    (void)state;
    enum { COUNT = sizeof mistakes / sizeof *mistakes };
    assert_true(COUNT >= 30);
    for (size_t i = 0; i < COUNT; i++) {
        gw_error error = {0};
        char start[32];
        snprintf(start, sizeof start, "wall.yaml:%d: ", mistakes[i].line);
        if (parse(mistakes[i].text, &site, &error) != GW_BAD_INPUT)
            fail_msg("accepted, but \"%s\" was expected:\n%s", mistakes[i].message, mistakes[i].text);
        if (strncmp(error.text, start, strlen(start)) != 0 || !strstr(error.text, mistakes[i].message))
            fail_msg("\"%s\", expected \"%s%s\" for\n%s", error.text, start, mistakes[i].message,
                     mistakes[i].text);
    }
}

static const mistake oddities[] = {
    {"version: 1\ngrid:\n  columns: 1\n  rows: 1\n  tile: {width: 400, height: 310, pixels: [40, 30]}\n", 3,
     "not square by 3.2 %; measure the lit area alone"},
    {"version: 1\npanels: {c1r0: {pixels: [80, 30]}}\n" GRID, 3, "tile 'c1r0' has pixels of 5 x 10 mm"},
    {"version: 1\ngrid:\n  columns: 1\n  rows: 1\n  tile: {width: 400, height: 300, pixels: [30, 40]}\n", 3,
     "are width and height of its pixels exchanged?"},
    {"version: 1\ngrid:\n  columns: 1\n  rows: 1\n  tile: {width: 120, height: 68, pixels: [1920, 1080]}\n",
     3, "0.0625 mm, a telephone's; is its size in centimetres?"},
    {"version: 1\ntiles:\n" TILE("a", "[[0, 300, 0], [400, 304, 0], [0, 0, 0]]", "[0, 0]"), 4,
     "meet at 90.57 degrees instead of 90; measure again"},
    {"version: 1\ntiles:\n" TILE("a", "[[0, 300, 0], [400, 300, 0], [0, 0, 0], [400, 0, 5]]", "[0, 0]"), 4,
     "the fourth corner is 5.0 mm from where"},
    {"version: 1\n" LEFT TILE("right", "[[-4, 300, 0], [396, 300, 0], [-4, 0, 0]]", "[40, 0]"), 7,
     "'right' reaches some millimetres into tile 'left' of line 3"},
    {"version: 1\n" LEFT TILE("right", "[[-900, 300, 0], [-500, 300, 0], [-900, 0, 0]]", "[40, 0]"), 7,
     "'right' is right of 'left' in the picture, but hangs on its other side"},
    {"version: 1\npanel: {display: ':0'}\n" GRID, 2, "windows of tiles 'c0r0' and 'c1r0' hide each other"},
    {"version: 1\npanel: {monitor: DP-1}\n" GRID, 2, "tile 'c0r0' has a monitor, but no display"},
    {"version: 1\npanels: {c0r0: {gpu: 1, display: ':0'}}\n" GRID, 2, "has a gpu and a display"},
    {"version: 1\npanels: {c0r0: {stereo: left}}\n" GRID, 2,
     "is for the left eye, but no tile for the other"},
    {"version: 1\nhosts: [{name: a, tiles: [c1r0]}]\n" GRID, 3, "tile 'c0r0' has no host and runs where"},
    {"version: 1\ntimes: {frame: 0.01}\n" GRID, 2, "less than one period of 60 Hz"},
    {"version: 1\neye_distance: 6.3\n" GRID, 2, "6.3 mm are less than any grown-up's"},
    {"version: 1\neye_distance: 0\npanel: {stereo: anaglyph}\n" GRID, 2, "stereo will have no depth"},
};

static void odd_sites_are_read_with_a_warning(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof oddities / sizeof *oddities; i++) {
        check_ok(parse(oddities[i].text, &site, &error));
        int found = 0;
        for (uint32_t n = 0; n < notes.count; n++)
            found |=
                notes.notes[n].line == oddities[i].line && strstr(notes.notes[n].text, oddities[i].message);
        if (!found)
            fail_msg("%u notes, first \"%d: %s\", expected \"%d: %s\" for\n%s", notes.count,
                     notes.notes[0].line, notes.notes[0].text, oddities[i].line, oddities[i].message,
                     oddities[i].text);
    }
}

/* More oddities than the list holds are counted. */
static void the_list_of_warnings_is_bounded(void **state) {
    char text[16384];
    int length = snprintf(text, sizeof text, "version: 1\ntiles:\n");
    (void)state;
    for (int i = 0; i < 40; i++)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           "- {name: t%d, pixels: [40, 30], place: [%d, 0],\n"
                           "   corners: [[%d, 330, 0], [%d, 330, 0], [%d, 0, 0]]}\n",
                           i, i * 40, i * 400, i * 400 + 400, i * 400);
    check_ok(parse(text, &site, &error));
    assert_int_equal(notes.count, GW_MAXIMUM_NOTES);
    assert_int_equal(notes.left_out, 40 - GW_MAXIMUM_NOTES);
}

static void assert_corners(const gw_tile *tile, double x0, double y0, double z0, double x3, double y3,
                           double z3) {
    const double wanted[2][3] = {{x0, y0, z0}, {x3, y3, z3}};
    double corners[4][3];
    gw_tile_corners(tile, corners);
    for (int i = 0; i < 3; i++)
        if (fabs(corners[0][i] - wanted[0][i]) > 1e-6 || fabs(corners[3][i] - wanted[1][i]) > 1e-6)
            fail_msg("tile %s: (%g, %g, %g) to (%g, %g, %g)", tile->name, corners[0][0], corners[0][1],
                     corners[0][2], corners[3][0], corners[3][1], corners[3][2]);
}

/* Writes the site as corners and reads that: the same bits. */
static void assert_same_again(const gw_site *before) {
    char *text;
    size_t size;
    static gw_site_changes changes;
    check_ok(gw_site_write(before, &text, &size, &error));
    check_ok(gw_site_parse(text, size, "again.yaml", &other, &notes, &error));
    if (memcmp(&before->layout, &other.layout, sizeof other.layout) != 0)
        fail_msg("the layout has other bits after it was written and read:\n%s", text);
    check_ok(gw_site_compare(before, &other, &changes, &error));
    assert_int_equal(changes.count, 0);
    free(text);
}

static void gaps_are_set_pair_by_pair(void **state) {
    (void)state;
    check_ok(parse("version: 1\ngrid: {columns: 3, rows: 2, centre: [0, 1000, 50],\n"
                   "       tile: {width: 400, height: 300, pixels: [40, 30]},\n"
                   "       gaps: {columns: [20, 40], rows: 10}}\n",
                   &site, &error));
    assert_corners(&site.layout.tiles[0], -630, 1305, 50, -230, 1005, 50);
    assert_corners(&site.layout.tiles[4], -210, 995, 50, 190, 695, 50);
    assert_corners(&site.layout.tiles[5], 230, 995, 50, 630, 695, 50);
    assert_int_equal(site.layout.framed[0], 126);
    assert_int_equal(site.layout.tiles[5].framed[0], 86);
    assert_int_equal(site.layout.tiles[5].framed[1], 31);
}

/* Columns are tangents: their middles lie on the circle, and the frames of neighbours share an edge. */
static void a_curve_is_a_polygon_round_its_axis(void **state) {
    (void)state;
    check_ok(parse("version: 1\neye: [0, 0, 900]\ncurve: {columns: 3, rows: 1, radius: 1000,\n"
                   "  tile: {width: 400, height: 300, pixels: [40, 30]}, bezel: {left: 10, right: 10}}\n",
                   &site, &error));
    double ends[3][4][3], middle[3], gap[3];
    for (int t = 0; t < 3; t++) {
        gw_tile_corners(&site.layout.tiles[t], ends[t]);
        for (int i = 0; i < 3; i++)
            middle[i] = 0.5 * (ends[t][1][i] + ends[t][2][i]);
        assert_true(fabs(hypot(middle[0], middle[2] - 1000) - 1000) < 1e-9 && fabs(middle[1]) < 1e-9);
    }
    /* Two bezels of 10 mm that meet at an angle: the gap is the base of that triangle. */
    for (int i = 0; i < 3; i++)
        gap[i] = ends[1][0][i] - ends[0][1][i];
    assert_true(fabs(gw_length(gap) - 20 * cos(atan(210.0 / 1000))) < 1e-9);
    assert_corners(&site.layout.tiles[1], -200, 150, 0, 200, -150, 0);
    assert_int_equal(site.layout.tiles[1].framed[0], 1 + 42);
    assert_int_equal(site.layout.framed[0], 126);
}

/* Each row leans by the same angle more than the one below, and its frame touches that one's. */
static void rows_lean_to_the_viewer(void **state) {
    (void)state;
    check_ok(parse("version: 1\neye: [0, 0, 900]\ncurve: {columns: 1, rows: 3, radius: 1000, lean: 30,\n"
                   "  tile: {width: 400, height: 300, pixels: [40, 30]}}\n",
                   &site, &error));
    assert_corners(&site.layout.tiles[1], -200, 150, 0, 200, -150, 0);
    double high = 300 * cos(0.5235987755982988), deep = 150;
    assert_corners(&site.layout.tiles[0], -200, 150 + high, deep, 200, 150, 0);
    assert_corners(&site.layout.tiles[2], -200, -150, 0, 200, -150 - high, deep);
}

static void faces_of_a_cave_share_their_edges(void **state) {
    (void)state;
    check_ok(gw_site_load("configs/sites/cave-corner.yaml", &site, &error));
    assert_corners(&site.layout.tiles[0], -1250, 2500, 1250, -1250, 0, -1250);
    assert_corners(&site.layout.tiles[1], -1250, 2500, -1250, 1250, 0, -1250);
    assert_corners(&site.layout.tiles[2], -1250, 0, -1250, 1250, 0, 1250);
    assert_string_equal(site.layout.tiles[2].name, "floor");
}

/* Measured panels at an angle, 12 mm apart: from the front they are too narrow for their pixels; they are
 * shown beside each other with the gap. Flat ones stand where they hang. */
static void bent_panels_are_shown_unrolled(void **state) {
    (void)state;
    check_ok(parse("version: 1\ntiles:\n" TILE(
                       "left", "[[-752.4, 300, 200], [-406, 300, 0], [-752.4, 0, 200]]", "[0, 0]")
                       TILE("middle", "[[-394, 300, 0], [6, 300, 0], [-394, 0, 0]]", "[40, 0]")
                           TILE("right", "[[18, 300, 0], [418, 300, 0], [18, 0, 0]]", "[80, 0]"),
                   &site, &error));
    assert_int_equal(site.layout.tiles[1].framed[0], 41);
    assert_int_equal(site.layout.tiles[2].framed[0], 82);
    check_ok(parse("version: 1\n" LEFT TILE("right", "[[25, 360, 0], [425, 360, 0], [25, 60, 0]]", "[40, 0]"),
                   &site, &error));
    assert_int_equal(site.layout.tiles[0].framed[1], 6);
    assert_int_equal(site.layout.tiles[1].framed[0], 43); /* 42.5 */
    assert_int_equal(site.layout.tiles[1].framed[1], 0);
}

/* In the picture with bezels, a wall that needs more pixels than it has moves those behind it. */
static void walls_make_room_for_bezels(void **state) {
    (void)state;
    check_ok(parse("version: 1\nwalls:\n"
                   "- {name: right, place: [80, 0], centre: [900, 0, 0],\n"
                   "   tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
                   "- {name: left, columns: 2, place: [0, 0], bezel: {left: 20, right: 20},\n"
                   "   tile: {width: 400, height: 300, pixels: [40, 30]}}\n",
                   &site, &error));
    assert_string_equal(site.layout.tiles[1].name, "left-c0r0");
    assert_int_equal(site.layout.tiles[1].framed[0], 2);
    assert_int_equal(site.layout.tiles[2].framed[0], 46);
    assert_int_equal(site.layout.tiles[0].framed[0], 88);
    assert_int_equal(site.layout.framed[0], 128);
    assert_int_equal(site.layout.picture[0], 120);
}

/* One panel of a grid has four times the pixels: its area stays, the pictures make room. */
static void a_panel_may_have_pixels_of_its_own(void **state) {
    (void)state;
    check_ok(parse("version: 1\npanel: {pixels: [40, 30]}\npanels: {c0r1: {pixels: [80, 60]}}\n"
                   "grid: {columns: 2, rows: 3, tile: {width: 400, height: 300}, bezel: {left: 20}}\n",
                   &site, &error));
    const gw_tile *tiles = site.layout.tiles;
    assert_int_equal(notes.count, 0);
    assert_int_equal(tiles[2].rectangle.width, 80);
    assert_int_equal(tiles[3].rectangle.width, 40);
    assert_corners(&tiles[2], -400, 150, 0, 0, -150, 0);
    assert_corners(&tiles[3], 20, 150, 0, 420, -150, 0);
    assert_int_equal(tiles[1].picture[0], 80);
    assert_int_equal(tiles[2].picture[1], 30);
    assert_int_equal(tiles[4].picture[1], 90);
    assert_int_equal(tiles[0].framed[0], 2);
    assert_int_equal(tiles[3].framed[0], 2 + 80 + 2);
    assert_int_equal(site.layout.framed[0], 124);
    assert_int_equal(site.layout.picture[1], 120);
    assert_same_again(&site);
    /* Measured tiles, too. */
    check_ok(parse("version: 1\npanels: {left: {pixels: [80, 60]}}\n" LEFT, &site, &error));
    assert_int_equal(site.layout.picture[0], 80);
}

static void the_door_of_the_gate_is_read_and_written(void **state) {
    (void)state;
    check_ok(parse("version: 1\ntimes: {restarts: 0}\nnetwork: {address: 10.0.0.1, port: 7000}\n" LEFT, &site,
                   &error));
    assert_true(site.times.restarts == 0 && site.port == 7000);
    assert_same_again(&site);
    check_ok(parse("version: 1\nnetwork: {port: 1024}\n" LEFT, &site, &error));
    assert_true(site.times.restarts == 3 && site.port == 1024 && !site.address[0]);
    assert_same_again(&site);
}

/* Without more ado, two tiles in one place are a mistake; a left and a right eye's are not. */
static void a_pair_of_eyes_may_share_a_place(void **state) {
    const char *text = "version: 1\nwalls:\n"
                       "- {name: l, place: [0, 0], panel: {stereo: left},\n"
                       "   tile: {width: 400, height: 300, pixels: [40, 30]}}\n"
                       "- {name: r, place: [0, 0], panel: {stereo: right},\n"
                       "   tile: {width: 400, height: 300, pixels: [40, 30]}}\n";
    (void)state;
    check_ok(parse(text, &site, &error));
    assert_int_equal(notes.count, 0);
    assert_int_equal(site.panels[1].stereo, GW_STEREO_RIGHT);
}

static const char *const shipped[] = {"desktop",   "2x2",        "3x2-bezels",
                                      "35-panels", "curved-5x1", "cave-corner"};

static void printed_corners_give_the_same_bits(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof shipped / sizeof *shipped; i++) {
        check_ok(gw_site_load(shipped[i], &site, &error)); /* from inside the program */
        assert_same_again(&site);
    }
    check_fails(gw_site_load("7x5", &site, &error), GW_BAD_INPUT,
                "7x5: there is no such file, nor a site of this program; those are: 2x2, 35-panels, ");
    check_fails(gw_site_load("./7x5", &site, &error), GW_BAD_INPUT, "./7x5: cannot be opened");
    /* Sizes and angles of no round number. */
    uint32_t seed = 1, refused = 0;
    for (int round = 0; round < 300; round++) {
        double r[6];
        char text[512];
        for (int i = 0; i < 6; i++) {
            seed = seed * 1664525u + 1013904223u;
            r[i] = (seed >> 8) / 16777216.0;
        }
        snprintf(text, sizeof text,
                 "version: 1\neye: [%.17g, 0, 1500]\n%s: {columns: %d, rows: %d,\n"
                 "tile: {width: %.17g, height: %.17g, pixels: [%d, %d]}, centre: [%.17g, %.17g, 0]%s}\n",
                 r[0], round % 3 ? "grid" : "curve", 1 + (int)(r[1] * 5), 1 + (int)(r[2] * 5),
                 200 + r[3] * 300, 200 + r[4] * 300, 300 + (int)(r[5] * 700), 300 + (int)(r[0] * 700),
                 r[1] * 1e4 - 5e3, r[2] * 100,
                 round % 3 == 0   ? ", radius: 2000.5, lean: 3.3"
                 : round % 3 == 1 ? ", bezel: {left: 3.3, top: 0.7}"
                                  : "");
        gw_error error = {0};
        if (parse(text, &site, &error) == GW_OK) /* some have the eye behind a panel */
            assert_same_again(&site);
        else
            refused++;
    }
    assert_true(refused < 100);
}

/* Every example of the manual is a site, and loads without a warning but for hosts left out. */
static void load_examples(const char *path, size_t least) {
    gw_bytes bytes;
    size_t examples = 0;
    check_ok(gw_file_read(path, 1 << 20, &bytes, &error));
    for (char *at = (char *)bytes.data; (at = strstr(at, "\n```yaml\nversion:"));) {
        at += strlen("\n```yaml\n");
        char *end = strstr(at, "\n```");
        assert_non_null(end);
        check_ok(gw_site_parse(at, (size_t)(end + 1 - at), path, &site, &notes, &error));
        if (notes.count)
            fail_msg("%s: line %d of an example: %s", path, notes.notes[0].line, notes.notes[0].text);
        examples++;
        at = end;
    }
    gw_bytes_finish(&bytes);
    assert_true(examples >= least);
}

static void examples_of_the_manual_load(void **state) {
    (void)state;
    load_examples("docs/sites.md", 6);
    load_examples("docs/measure-your-wall.md", 2);
}

static void differences_are_told_and_sorted(void **state) {
    static gw_site_changes changes;
    char all[16384] = "";
    (void)state;
    const char *head = "version: 1\n", *grid = "grid: {columns: 2, rows: 1, bezel: {left: 2},\n"
                                               "       tile: {width: 400, height: 300, pixels: [40, 30]}}\n";
    char text[1024];
    snprintf(text, sizeof text, "%s%s", head, grid);
    check_ok(parse(text, &site, &error));
    check_ok(gw_site_compare(&site, &site, &changes, &error));
    assert_int_equal(changes.count, 0);
    /* Taken over: eyes, stereo, light, geometry. */
    check_ok(parse("version: 1\neye: [0, 100, 1800]\neye_distance: 60\n"
                   "panel: {gamma: 2.2, white: [1, 1, 0.9], stereo: anaglyph}\n"
                   "grid: {columns: 2, rows: 1, bezel: {left: 12},\n"
                   "       tile: {width: 400, height: 300, pixels: [40, 30]}}\n",
                   &other, &error));
    check_ok(gw_site_compare(&site, &other, &changes, &error));
    assert_int_equal(changes.restarts, 0);
    for (uint32_t i = 0; i < changes.count; i++)
        strcat(strcat(all, changes.changes[i].text), "\n");
    const char *const told[] = {"eye [0, 0, 1800] -> [0, 100, 1800]\n",
                                "eye_distance 63 -> 60\n",
                                "picture with bezels 80x30 -> 82x30 px\n",
                                "tile 'c1r0': corners moved by 10, 10, 10 and 10 mm\n",
                                "tile 'c0r0': stereo mono -> anaglyph\n",
                                "tile 'c1r0': gamma 0 -> 2.2\n",
                                "tile 'c1r0': white [1, 1, 1] -> [1, 1, 0.9]\n"};
    for (size_t i = 0; i < sizeof told / sizeof *told; i++)
        if (!strstr(all, told[i]))
            fail_msg("\"%s\" is not in:\n%s", told[i], all);
    /* Not while frames are drawn. */
    static const char *const others[][2] = {
        {"hosts: [{name: a, tiles: ['*']}]\n", "tile 'c0r0': host none -> a: cannot be changed"},
        {"panel: {display: ':1'}\n", "tile 'c0r0': display none -> :1"},
        {"times: {refresh: 50}\n", "times: refresh 60 -> 50"},
        {"network: {address: 10.0.0.1}\n", "address none -> 10.0.0.1"},
        {"network: {port: 7000}\n", "network: port 0 -> 7000"},
        {"times: {restarts: 0}\n", "times: restarts 3 -> 0"},
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        snprintf(text, sizeof text, "%s%s%s", head, others[i][0], grid);
        check_ok(parse(text, &other, &error));
        check_fails(gw_site_compare(&site, &other, &changes, &error), GW_BAD_INPUT, others[i][1]);
        assert_true(changes.restarts >= 1);
    }
    check_ok(parse("version: 1\ngrid: {columns: 2, rows: 1, bezel: {left: 2},\n"
                   "       tile: {width: 400, height: 300, pixels: [80, 60]}}\n",
                   &other, &error));
    check_fails(gw_site_compare(&site, &other, &changes, &error), GW_BAD_INPUT, "picture 80x30 -> 160x60 px");
    check_ok(parse("version: 1\n" LEFT, &other, &error));
    check_fails(gw_site_compare(&site, &other, &changes, &error), GW_BAD_INPUT, "tiles 2 -> 1");
}

/* The drawing names every tile in every view in which it can be seen, and is well-formed as far as counting
 * goes. */
static void the_drawing_shows_every_tile(void **state) {
    char *svg;
    size_t size;
    (void)state;
    for (size_t i = 0; i < sizeof shipped / sizeof *shipped; i++) {
        check_ok(gw_site_load(shipped[i], &site, &error));
        check_ok(gw_site_draw(&site, "<a> & b", &svg, &size, &error));
        assert_non_null(strstr(svg, "&lt;a> &amp; b"));
        assert_null(strstr(svg, "nan"));
        assert_non_null(strstr(svg, "Front"));
        assert_non_null(strstr(svg, "Top"));
        assert_non_null(strstr(svg, "Bird's-eye"));
        assert_non_null(strstr(svg, " mm</text>"));
        for (uint32_t t = 0; t < site.layout.tile_count; t++) {
            char name[64];
            snprintf(name, sizeof name, ">%s</text>", site.layout.tiles[t].name);
            if (!strstr(svg, name))
                fail_msg("%s: tile %s is not named", shipped[i], site.layout.tiles[t].name);
        }
        assert_string_equal(svg + size - 7, "</svg>\n");
        free(svg);
    }
    /* What cannot be seen is not named: the floor from the front. */
    check_ok(gw_site_load("cave-corner", &site, &error));
    check_ok(gw_site_draw(&site, "", &svg, &size, &error));
    char *top = strstr(svg, ">Top"), *floor = strstr(svg, ">floor<");
    assert_true(top != NULL && floor > top);
    free(svg);
}

/* The entry of the fuzzer on mutations of a good site. */
static void hostile_sites_do_no_harm(void **state) {
    static const char *const seeds[] = {"configs/sites/curved-5x1.yaml", "configs/sites/cave-corner.yaml"};
    (void)state;
    uint32_t random = 7;
    for (size_t i = 0; i < 2; i++) {
        gw_bytes bytes;
        check_ok(gw_file_read(seeds[i], 1 << 20, &bytes, &error));
        for (int round = 0; round < 3000; round++) {
            uint8_t *copy = malloc(bytes.size);
            assert_non_null(copy);
            memcpy(copy, bytes.data, bytes.size);
            for (int change = 0; change <= round % 4; change++) {
                static const char letters[] = "0123456789.-,:[]{} \n'\"e\xff";
                random = random * 1664525u + 1013904223u;
                copy[(random >> 8) % bytes.size] = (uint8_t)letters[(random >> 3) % (sizeof letters - 1)];
            }
            fuzz_site(copy, bytes.size);
            free(copy);
        }
        gw_bytes_finish(&bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_sites_are_refused_with_their_line),
        cmocka_unit_test(odd_sites_are_read_with_a_warning),
        cmocka_unit_test(the_list_of_warnings_is_bounded),
        cmocka_unit_test(gaps_are_set_pair_by_pair),
        cmocka_unit_test(a_curve_is_a_polygon_round_its_axis),
        cmocka_unit_test(rows_lean_to_the_viewer),
        cmocka_unit_test(faces_of_a_cave_share_their_edges),
        cmocka_unit_test(bent_panels_are_shown_unrolled),
        cmocka_unit_test(walls_make_room_for_bezels),
        cmocka_unit_test(a_panel_may_have_pixels_of_its_own),
        cmocka_unit_test(the_door_of_the_gate_is_read_and_written),
        cmocka_unit_test(a_pair_of_eyes_may_share_a_place),
        cmocka_unit_test(printed_corners_give_the_same_bits),
        cmocka_unit_test(examples_of_the_manual_load),
        cmocka_unit_test(differences_are_told_and_sorted),
        cmocka_unit_test(the_drawing_shows_every_tile),
        cmocka_unit_test(hostile_sites_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
