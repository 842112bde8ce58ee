/* Placement of scene space in wall space, the frame block's numbers, and which effects a scene and a frame
 * call for. */
#include "tests/support/check.h"

#include "render/features.h"
#include "render/frame_block.h"
#include "render/view.h"

#include <math.h>

static const double origin[3] = {0, 0, 0};
static const double neutral[3] = {10, 20, 1800};

static gw_scene box_scene(void) {
    gw_scene scene = {.path = (char *)"box", .exponent = 1, .centre = {1, 2, 3}};
    const double low[3] = {-1, 0, -3}, high[3] = {3, 1, 5};
    memcpy(scene.bounds[0], low, sizeof low);
    memcpy(scene.bounds[1], high, sizeof high);
    return scene;
}

static void assert_near(const double got[3], double x, double y, double z) {
    const double wanted[3] = {x, y, z};
    for (int i = 0; i < 3; ++i)
        if (fabs(got[i] - wanted[i]) > 1e-9 * (1.0 + fabs(wanted[i])))
            fail_msg("(%g, %g, %g), expected (%g, %g, %g)", got[0], got[1], got[2], x, y, z);
}

static void a_fitted_scene_stands_behind_the_wall(void **state) {
    (void)state;
    gw_scene scene = box_scene();
    gw_similarity placement;
    const double centre[3] = {100, 200, 300};
    check_ok(gw_place_scene(&scene, 2000, 1000, centre, neutral, &placement, &error));
    /* 4 m wide, 1 m high: the width decides, 95 % of it is used. */
    double wall[3];
    gw_scene_to_wall(&placement, scene.bounds[0], wall);
    assert_near(wall, 100 - 950, 200 - 237.5, 300 - 50 - 8 * 475);
    gw_scene_to_wall(&placement, scene.bounds[1], wall);
    assert_near(wall, 100 + 950, 200 + 237.5, 300 - 50);
}

static void flat_and_empty_scenes_are_fitted_by_what_they_have(void **state) {
    (void)state;
    gw_scene scene = box_scene();
    gw_similarity placement;
    scene.bounds[1][0] = scene.bounds[0][0];
    check_ok(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error));
    assert_true(fabs(placement.scale - 950) < 1e-9);
    scene.bounds[1][1] = scene.bounds[0][1];
    check_ok(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error));
    assert_true(fabs(placement.scale - 250) < 1e-9);
    scene.bounds[1][2] = scene.bounds[0][2];
    check_fails(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error), GW_BAD_INPUT,
                "no extent");
}

static void the_viewpoint_is_where_the_neutral_viewer_stands(void **state) {
    (void)state;
    gw_viewpoint view = {.name = "door", .eye = {1, 2, 3}, .look_at = {5, 2, 3}, .up = {0, 1, 0}, .fov = 40};
    gw_scene scene = box_scene();
    scene.placement = (gw_placement){.kind = GW_PLACE_VIEWPOINT, .scale = 2};
    gw_similarity placement;
    check_fails(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error), GW_BAD_INPUT,
                "viewpoint");
    scene.viewpoints = &view;
    scene.viewpoint_count = 1;
    check_ok(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error));
    double wall[3];
    gw_scene_to_wall(&placement, view.eye, wall);
    assert_near(wall, 10, 20, 1800);
    gw_scene_to_wall(&placement, view.look_at, wall); /* 4 m ahead is 8 m along -z */
    assert_near(wall, 10, 20, 1800 - 8000);
    const double to_the_right[3] = {1, 2, 4};
    gw_scene_to_wall(&placement, to_the_right, wall);
    assert_near(wall, 10 + 2000, 20, 1800);
    view.up[0] = 1;
    view.up[1] = 0;
    check_fails(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error), GW_BAD_INPUT,
                "'door'");
}

static void a_matrix_must_be_a_similarity(void **state) {
    (void)state;
    gw_scene scene = box_scene();
    scene.placement =
        (gw_placement){.kind = GW_PLACE_MATRIX, .matrix = {{0, -500, 0, 7}, {500, 0, 0, 8}, {0, 0, 500, 9}}};
    gw_similarity placement;
    check_ok(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error));
    double wall[3], back[3];
    const double point[3] = {1, 2, 3};
    gw_scene_to_wall(&placement, point, wall);
    assert_near(wall, -1000 + 7, 500 + 8, 1500 + 9);
    gw_wall_to_scene(&placement, wall, back);
    assert_near(back, 1, 2, 3);
    gw_wall_to_rebased(&placement, &scene, wall, back); /* (p - centre) / 2 */
    assert_near(back, 0, 0, 0);
    scene.placement.matrix[2][2] = -500; /* mirrored */
    check_fails(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error), GW_BAD_INPUT,
                "similarity");
    scene.placement.matrix[2][2] = 501; /* not uniform */
    check_fails(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error), GW_BAD_INPUT,
                "similarity");
    scene.placement.matrix[2][2] = NAN;
    check_fails(gw_place_scene(&scene, 2000, 1000, origin, neutral, &placement, &error), GW_BAD_INPUT,
                "similarity");
}

static gw_frame_state looking_state(void) {
    gw_settings settings;
    gw_settings_init(&settings);
    gw_frame_state state = {.eye = {0, 0, 1800}, .gaze_count = 1};
    gw_frame_state_apply(&state, &settings);
    state.gazes[0] = (gw_gaze){.eye = {0, 0, 1800},
                               .direction = {0, 0, -2},
                               .up = {0, 1, 0},
                               .half_width = 8,
                               .half_height = 6,
                               .confidence = 1};
    return state;
}

static void the_frame_block_holds_rays_and_gaze_in_the_same_units(void **state) {
    (void)state;
    gw_scene scene = box_scene();
    gw_octree octree = {.depth = 3, .level_begin = {0, 1, 3, 7, 12}};
    gw_similarity placement = {.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1000};
    gw_plane plane = {{-1000, 500, 0}, {2, 0, 0}, {0, -2, 0}};
    gw_frame_state frame = looking_state();
    frame.gazes[0].age = 0.07f;
    gw_frame_block block;
    uint32_t dropped = 0;
    check_ok(gw_frame_block_fill(&scene, &octree, &placement, &plane, &frame, &block, &dropped, &error));
    assert_int_equal(dropped, 0);
    assert_int_equal(block.counts[0], 1);
    assert_int_equal(block.level_begin[0][3], 7);
    assert_true(block.level_begin[1][0] == UINT32_MAX);
    /* A power of two brings the corner's distance into [1/2, 1). */
    double length = sqrt((double)block.corner[0] * (double)block.corner[0] +
                         (double)block.corner[1] * (double)block.corner[1] +
                         (double)block.corner[2] * (double)block.corner[2]);
    assert_true(length >= 0.5 && length < 1.0);
    assert_true(fabsf(block.step_x[0] / block.corner[0] + 2.0f / 1000.0f) < 1e-7f);
    assert_true(block.eye[3] == 2.0f);
    assert_true(fabsf(block.viewers[0].forward[2] + 1.0f) < 1e-6f &&
                fabsf(block.viewers[0].up[1] - 1.0f) < 1e-6f);
    /* 0.07 s old: 300 deg/s beyond 0.05 s widen the ellipse by 6 degrees. */
    assert_true(fabsf(block.viewers[0].eye[3] - 14.0f) < 1e-3f);
    assert_true(fabsf(block.viewers[0].right[3] - 12.0f) < 1e-3f);
}

static void unusable_gazes_are_left_out_and_counted(void **state) {
    (void)state;
    gw_scene scene = box_scene();
    gw_octree octree = {.depth = 3};
    gw_similarity placement = {.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1000};
    gw_plane plane = {{-1000, 500, 0}, {2, 0, 0}, {0, -2, 0}};
    gw_frame_state frame = looking_state();
    frame.gaze_count = 4;
    for (int i = 1; i < 4; ++i)
        frame.gazes[i] = frame.gazes[0];
    frame.gazes[0].direction[1] = NAN;
    frame.gazes[1].direction[2] = 0;
    frame.gazes[2].confidence = 0;
    frame.gazes[3].up[1] = 0; /* no up: still usable */
    gw_frame_block block;
    uint32_t dropped = 0;
    check_ok(gw_frame_block_fill(&scene, &octree, &placement, &plane, &frame, &block, &dropped, &error));
    assert_int_equal(dropped, 3);
    assert_int_equal(block.counts[0], 1);
    assert_true(fabsf(block.viewers[0].forward[2] + 1.0f) < 1e-6f);
    frame.gaze_count = 9;
    dropped = 0;
    check_ok(gw_frame_block_fill(&scene, &octree, &placement, &plane, &frame, &block, &dropped, &error));
    assert_int_equal(dropped, 8);
}

static void frames_call_for_voxels_only_where_tau_allows_them(void **state) {
    (void)state;
    gw_frame_state frame = looking_state();
    assert_int_equal(gw_features_of_frame(&frame, 1, 0),
                     GW_FEATURE_LOD | GW_FEATURE_GAZE | GW_FEATURE_SPARSE);
    frame.sample_block = 0;
    assert_int_equal(gw_features_of_frame(&frame, 1, 0), GW_FEATURE_LOD | GW_FEATURE_GAZE);
    assert_int_equal(gw_features_of_frame(&frame, 0, 0), 0);
    frame.tau_inside = 0.5f;
    assert_int_equal(gw_features_of_frame(&frame, 0, 0), GW_FEATURE_LOD);
    frame.geometry = GW_GEOMETRY_TRIANGLES;
    assert_int_equal(gw_features_of_frame(&frame, 1, 0), 0);
    assert_int_equal(gw_features_of_frame(&frame, 1, GW_FEATURE_TEXTURES), GW_FEATURE_GAZE);
    frame.geometry = GW_GEOMETRY_VOXELS;
    frame.tau = frame.tau_inside = 0.0f;
    assert_int_equal(gw_features_of_frame(&frame, 0, 0), GW_FEATURE_LOD);
}

static void scenes_call_for_what_their_used_materials_need(void **state) {
    (void)state;
    gw_material materials[3] = {{.base_color_texture = -1},
                                {.base_color_texture = 0, .alpha_mode = GW_ALPHA_MASK},
                                {.base_color_texture = -1, .emissive = {0, 1, 0}}};
    uint32_t material_of[3] = {0, 0, 0};
    float normals[9] = {0};
    gw_light lamp = {.kind = GW_LIGHT_POINT};
    gw_octree octree = {.node_count = 1u << 24};
    gw_texture texture = {.wrap_u = GW_WRAP_REPEAT};
    gw_scene scene = {.vertex_count = 3,
                      .normals = normals,
                      .triangle_count = 3,
                      .material_of = material_of,
                      .material_count = 3,
                      .materials = materials,
                      .texture_count = 1,
                      .textures = &texture};
    assert_int_equal(gw_features_of_scene(&scene, &octree, 0.02f), 0);
    material_of[1] = 1;
    assert_int_equal(gw_features_of_scene(&scene, &octree, 0.02f), GW_FEATURE_TEXTURES | GW_FEATURE_ALPHA);
    texture.nearest = 1;
    assert_int_equal(gw_features_of_scene(&scene, &octree, 0.02f),
                     GW_FEATURE_TEXTURES | GW_FEATURE_ALPHA | GW_FEATURE_SQUARE_TEXELS);
    material_of[1] = 2;
    normals[4] = 1.0f;
    scene.lights = &lamp;
    scene.light_count = 1;
    octree.node_count += 1;
    assert_int_equal(gw_features_of_scene(&scene, &octree, 0.02f),
                     GW_FEATURE_EMISSIVE | GW_FEATURE_SMOOTH_NORMALS | GW_FEATURE_POINT_LIGHTS |
                         GW_FEATURE_SHADOWS | GW_FEATURE_WIDE_NODES);
}

static void every_effect_is_one_row(void **state) {
    (void)state;
    gw_features seen = 0;
    for (size_t i = 0; i < gw_feature_count; ++i) {
        assert_true((seen & gw_feature_rows[i].bit) == 0);
        seen |= gw_feature_rows[i].bit;
        gw_kernel_key key = {.features = gw_feature_rows[i].bit, .depth = 15};
        char text[1024], line[128];
        check_ok(gw_kernel_defines(&key, text, sizeof text, &error));
        snprintf(line, sizeof line, "#define %s 1\n", gw_feature_rows[i].define);
        assert_non_null(strstr(text, line));
        check_fails(gw_kernel_defines(&key, text, 40, &error), GW_MACHINE, "40 bytes");
        gw_features bit = 0;
        check_ok(gw_feature_of_name(gw_feature_rows[i].name, &bit, &error));
        assert_true(bit == gw_feature_rows[i].bit);
        check_fails(gw_feature_of_name(gw_feature_rows[i].define, &bit, &error), GW_BAD_INPUT, "no effect");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fitted_scene_stands_behind_the_wall),
        cmocka_unit_test(flat_and_empty_scenes_are_fitted_by_what_they_have),
        cmocka_unit_test(the_viewpoint_is_where_the_neutral_viewer_stands),
        cmocka_unit_test(a_matrix_must_be_a_similarity),
        cmocka_unit_test(the_frame_block_holds_rays_and_gaze_in_the_same_units),
        cmocka_unit_test(unusable_gazes_are_left_out_and_counted),
        cmocka_unit_test(frames_call_for_voxels_only_where_tau_allows_them),
        cmocka_unit_test(scenes_call_for_what_their_used_materials_need),
        cmocka_unit_test(every_effect_is_one_row),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
