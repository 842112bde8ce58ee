/* A tile's rays come from the wall's pixel, not from its own corner: a tile of one pixel has that pixel's
 * bits. Counted from the tile's corner the same rays round otherwise, and pixels at edges change with the
 * split. */
#include "tests/support/check.h"

#include "tests/support/meshes.h"
#include "tests/support/renders.h"

#include <math.h>

enum { SIDE = 128, PIXELS = SIDE * SIDE };

static const double eye[3] = {0.013, 0.02, 1.37}, target[3] = {0.013, 0.02, 0}, fov = 41;

/* Strips on a wall that is seen straight on, whose sides go through the middles of pixels: rounding decides
 * every one. */
static gw_scene *make_scene(void) {
    gw_mesh mesh = {0};
    const double pitch = 2 * tan(fov / 360 * 3.14159265358979) * eye[2] / SIDE;
    for (int i = 0; i < SIDE; i += 2) {
        const double corner[3] = {eye[0] + (i + 0.5 - SIDE / 2) * pitch, -0.7, 0}, u[3] = {pitch, 0, 0},
                     v[3] = {0, 1.5, 0};
        gw_mesh_add_grid(&mesh, corner, u, v, 1, 1);
    }
    return gw_mesh_take(&mesh);
}

/* The picture whole, and in tiles of a side with one of the other size where it does not divide it; pixels
 * that differ. */
static size_t split_differs(const char *shaders, uint32_t tile) {
    gw_stage stage;
    gw_camera camera;
    check_ok(gw_stage_open(&stage, make_scene(), shaders,
                           (const char *const[]){"octree_depth=7", "tau=0", NULL}, &error));
    gw_camera_look(&camera, &stage, eye, target, fov, SIDE);
    gw_renderer *renderer = gw_stage_renderer(&stage);
    uint8_t *whole = gw_camera_take(&camera, renderer, NULL), part[SIDE * SIDE * 4];
    size_t different = 0;
    for (uint32_t y = 0; y < SIDE; y += tile)
        for (uint32_t x = 0; x < SIDE; x += tile) {
            const gw_rectangle at = {(int32_t)x, (int32_t)y, x + tile > SIDE ? SIDE - x : tile,
                                     y + tile > SIDE ? SIDE - y : tile};
            check_ok(gw_renderer_frame(renderer, &camera.placement, &camera.plane, &at, &camera.state, part,
                                       NULL, &error));
            for (uint32_t j = 0; j < at.height; ++j)
                for (uint32_t i = 0; i < at.width; ++i)
                    different +=
                        memcmp(part + (j * at.width + i) * 4, whole + ((y + j) * SIDE + x + i) * 4, 4) != 0;
        }
    free(whole);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return different;
}

static void rays_do_not_know_their_tile(void **state) {
    (void)state;
    assert_int_equal(split_differs(NULL, 37), 0);
}

static void rays_from_a_tiles_corner_differ(void **state) {
    (void)state;
    char folder[512];
    size_t different =
        split_differs(gw_naive_shaders(folder, "corner", "trace/pixel.glsl", "RAYS_FROM_THE_TILE"), 37);
    print_message("rays counted from the tile's corner: %zu of %d pixels differ\n", different, PIXELS);
    assert_true(different > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_do_not_know_their_tile),
        cmocka_unit_test(rays_from_a_tiles_corner_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
