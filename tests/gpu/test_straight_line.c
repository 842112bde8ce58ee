/* A straight line across the wall is straight for the tracked eye: over bezels, round a curve, round the
 * corners of a CAVE.
 *
 * The line is the rim of a great umbrella of triangles about the eye, rim and eye in one plane: whatever ray
 * the renderer's own kernels make for a pixel, it meets the umbrella if and only if the pixel's centre is on
 * that side of the plane. Where the picture of a tile changes from the one to the other must therefore be
 * within half a pixel of where the plane cuts the tile as it hangs. */
#include "tests/support/check.h"

#include "render/vector3.h"
#include "tests/support/meshes.h"
#include "tests/support/renders.h"
#include "wall/frames.h"
#include "wall/site.h"

#include <math.h>

static gw_stage stage;
static gw_renderer *renderer;

enum { RIBS = 6, ALONG = 24, LINES = 4, SPOTS = 3 };

/* Rim in the plane z = 0, apex on +z, all 40 m from the eye in the origin. */
static int open_umbrella(void **state) {
    gw_mesh mesh = {0};
    uint32_t rim[RIBS], apex = gw_mesh_point(&mesh, 0, 0, 40);
    (void)state;
    for (int i = 0; i < RIBS; i++)
        rim[i] = gw_mesh_point(&mesh, 40 * cos(i * acos(-1) / 3), 40 * sin(i * acos(-1) / 3), 0);
    for (int i = 0; i < RIBS; i++)
        gw_mesh_triangle(&mesh, rim[i], rim[(i + 1) % RIBS], apex);
    check_ok(gw_stage_open(&stage, gw_mesh_take(&mesh), NULL,
                           (const char *const[]){"tau=0", "octree_depth=3", NULL}, &error));
    renderer = gw_stage_renderer(&stage);
    return 0;
}

static int close_umbrella(void **state) {
    (void)state;
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

/* The umbrella about this eye, its side of the plane along `normal`. */
static gw_similarity place(const double eye[3], const double normal[3]) {
    gw_similarity out = {.scale = 1000};
    double axes[3][3], helper[3] = {0, 0, 0};
    memcpy(axes[2], normal, sizeof axes[2]);
    helper[fabs(normal[0]) < 0.6 ? 0 : 1] = 1;
    gw_cross(helper, normal, axes[0]);
    gw_normalise(axes[0], 0);
    gw_cross(axes[2], axes[0], axes[1]);
    for (int i = 0; i < 3; i++) {
        out.translation[i] = eye[i];
        for (int j = 0; j < 3; j++)
            out.rotation[i][j] = axes[j][i];
    }
    return out;
}

/* Where the plane of sight cuts a tile: a + b x + c y = 0 in pixels of its plane. */
typedef struct cut {
    double a, b, c;
} cut;

static cut cut_of(const gw_tile *tile, const double eye[3], const double normal[3]) {
    double to[3];
    for (int i = 0; i < 3; i++)
        to[i] = tile->plane.corner[i] - eye[i];
    return (cut){gw_dot(normal, to), gw_dot(normal, tile->plane.step_x), gw_dot(normal, tile->plane.step_y)};
}

/* The renderer's pixels of a small window: 1 where a ray met the umbrella. */
static void trace(const gw_tile *tile, const gw_rectangle *window, const gw_similarity *placement,
                  const double eye[3], uint8_t met[ALONG * LINES]) {
    static uint8_t rgba[ALONG * LINES * 4];
    gw_frame_state state;
    gw_frame_begin(&state, 0, &stage.settings, 0, GW_DEBUG_LEVELS);
    memcpy(state.eye, eye, sizeof state.eye);
    check_ok(gw_renderer_frame(renderer, placement, &tile->plane, window, &state, rgba, NULL, &error));
    for (uint32_t i = 0; i < window->width * window->height; i++) /* triangles are red, the sky is not */
        met[i] = rgba[4 * i] > rgba[4 * i + 2] + 32;
}

/* The greatest distance, in pixels along a row (or column, if the line is flatter), between where the
 * pictures of `shown` change and where the plane cuts the tile as it hangs. */
static double deviation_at(const gw_tile *hung, const gw_tile *shown, const cut *line, double spot,
                           const gw_similarity *placement, const double eye[3]) {
    const gw_rectangle *all = &hung->rectangle;
    const int steep = fabs(line->b) >= fabs(line->c); /* then along x, row by row */
    const int32_t first[2] = {all->x, all->y};
    const int32_t size[2] = {(int32_t)all->width, (int32_t)all->height};
    const int along = steep ? 0 : 1, over = 1 - along;
    const double slope[2] = {line->b, line->c};
    uint8_t met[ALONG * LINES];
    int32_t at[2];
    at[over] = first[over] + (int32_t)(spot * (size[over] - LINES));
    double crossing = -(line->a + slope[over] * (at[over] + 0.5 * LINES)) / slope[along];
    at[along] = (int32_t)floor(crossing) - ALONG / 2;
    if (at[along] < first[along] || at[along] + ALONG > first[along] + size[along])
        return 0; /* the line leaves the tile here */
    gw_rectangle window = {at[0] + shown->rectangle.x - all->x, at[1] + shown->rectangle.y - all->y,
                           steep ? ALONG : LINES, steep ? LINES : ALONG};
    trace(shown, &window, placement, eye, met);
    double worst = 0;
    for (int row = 0; row < LINES; row++) {
        double wanted = -(line->a + slope[over] * (at[over] + row + 0.5)) / slope[along] - at[along];
        int starts = steep ? met[row * ALONG] : met[row], change = 0, changes = 0;
        for (int i = 1; i < ALONG; i++) {
            int now = steep ? met[row * ALONG + i] : met[i * LINES + row],
                before = steep ? met[row * ALONG + i - 1] : met[(i - 1) * LINES + row];
            changes += now != before;
            change = now != before ? i : change;
        }
        int right_side = starts == (slope[along] < 0); /* the umbrella is where the product is positive */
        worst = fmax(worst, changes == 1 && right_side ? fabs(change - wanted) : ALONG);
    }
    return worst;
}

/* What somebody draws who thinks the panels were one flat picture: each tile at its pixels of it. */
static gw_layout flattened(const gw_layout *layout) {
    gw_layout out = *layout;
    const gw_plane *first = &layout->tiles[0].plane;
    double pitch[2] = {gw_length(first->step_x), gw_length(first->step_y)};
    for (uint32_t t = 0; t < out.tile_count; t++) {
        gw_tile *tile = &out.tiles[t];
        tile->plane = (gw_plane){.step_x = {pitch[0], 0, 0}, .step_y = {0, -pitch[1], 0}};
        tile->plane.corner[0] = layout->centre[0] + pitch[0] * (tile->picture[0] - 0.5 * layout->picture[0]);
        tile->plane.corner[1] = layout->centre[1] - pitch[1] * (tile->picture[1] - 0.5 * layout->picture[1]);
        tile->plane.corner[2] = layout->centre[2];
        tile->rectangle.x = tile->rectangle.y = 0;
    }
    return out;
}

static void point_on(const gw_tile *tile, double x, double y, double out[3]) {
    double corners[4][3];
    gw_tile_corners(tile, corners);
    for (int i = 0; i < 3; i++)
        out[i] = corners[0][i] + x * (corners[1][i] - corners[0][i]) + y * (corners[2][i] - corners[0][i]);
}

/* Lines of sight from tile to tile until each has one; the greatest deviation anywhere on them. */
static double worst_deviation(const gw_layout *hung, const gw_layout *shown, const double eye[3],
                              uint32_t crossed[GW_MAXIMUM_TILES]) {
    double worst = 0;
    memset(crossed, 0, GW_MAXIMUM_TILES * sizeof *crossed);
    for (uint32_t t = 0; t < hung->tile_count; t++) {
        if (crossed[t] >= SPOTS)
            continue;
        double ends[2][3], normal[3];
        point_on(&hung->tiles[t], 0.31, 0.36, ends[0]);
        point_on(&hung->tiles[hung->tile_count - 1 - t], 0.71, 0.68, ends[1]);
        for (int i = 0; i < 3; i++) {
            ends[0][i] -= eye[i];
            ends[1][i] -= eye[i];
        }
        gw_cross(ends[0], ends[1], normal);
        assert_true(gw_normalise(normal, 0));
        const gw_similarity placement = place(eye, normal);
        for (uint32_t k = 0; k < hung->tile_count; k++) {
            const gw_tile *tile = &hung->tiles[k];
            const cut line = cut_of(tile, eye, normal);
            for (int spot = 0; spot < SPOTS; spot++) {
                double found =
                    deviation_at(tile, &shown->tiles[k], &line, (spot + 0.5) / SPOTS, &placement, eye);
                crossed[k] += found > 0;
                worst = fmax(worst, found);
            }
        }
    }
    return worst;
}

static const struct {
    const char *name;
    int gaps; /* or bends: a flat picture cannot be right */
} sites[] = {{"desktop", 0},   {"2x2", 0},        {"3x2-bezels", 1},
             {"35-panels", 1}, {"curved-5x1", 1}, {"cave-corner", 1}};

/* A change between two pixels says where the line is to half a pixel; a hundredth is for single precision. */
static const double straight = 0.51;

static void lines_are_straight_on_every_shipped_site(void **unused) {
    static gw_site site;
    uint32_t crossed[GW_MAXIMUM_TILES];
    (void)unused;
    for (size_t s = 0; s < sizeof sites / sizeof *sites; s++) {
        check_ok(gw_site_load(sites[s].name, &site, &error));
        const gw_layout *layout = &site.layout;
        for (int moved = 0; moved < 2; moved++) { /* the neutral eye, and a tracked one beside it */
            const double eye[3] = {layout->eye[0] + 170 * moved, layout->eye[1] - 90 * moved,
                                   layout->eye[2] - 130 * moved};
            double worst = worst_deviation(layout, layout, eye, crossed);
            uint32_t least = UINT32_MAX;
            for (uint32_t t = 0; t < layout->tile_count; t++)
                least = crossed[t] < least ? crossed[t] : least;
            print_message("# %s: %.3f px at most, each tile at %u places or more\n", sites[s].name, worst,
                          least);
            if (worst > straight)
                fail_msg("%s: a line is off by %.3f px", sites[s].name, worst);
            assert_true(least >= 1);
        }
    }
}

static void one_flat_picture_is_not(void **unused) {
    static gw_site site;
    uint32_t crossed[GW_MAXIMUM_TILES];
    (void)unused;
    for (size_t s = 0; s < sizeof sites / sizeof *sites; s++) {
        check_ok(gw_site_load(sites[s].name, &site, &error));
        const gw_layout naive = flattened(&site.layout);
        double worst = worst_deviation(&site.layout, &naive, site.layout.eye, crossed);
        print_message("# %s drawn as one flat picture: %.3f px\n", sites[s].name, worst);
        assert_true(sites[s].gaps ? worst > 1.5 : worst <= straight);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(lines_are_straight_on_every_shipped_site),
                                       cmocka_unit_test(one_flat_picture_is_not)};
    return cmocka_run_group_tests(tests, open_umbrella, close_umbrella);
}
