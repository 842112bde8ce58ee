/* What materials say at a hit: cards side by side in one picture, each with a material of its own, seen
 * straight on from far away. Red light comes from the right, green from above, blue from the left. */
#include "tests/support/check.h"

#include "base/memory.h"
#include "base/srgb.h"
#include "build/tangent.h"
#include "render/features.h"
#include "tests/support/renders.h"

#include <math.h>

enum { COLUMNS = 6, SIDE = 96, CARD = SIDE / COLUMNS, MOST_TEXTURES = 8 };

typedef enum card {
    FLAT,
    DOME,
    DOME_MIRRORED,
    DOME_TURNED,
    DOME_SECOND_SET,
    DOME_RIGHT, /* with tangents of their own: this and the next as their texture coordinates have them, */
    DOME_LEFT,  /* mirrored, */
    DOME_ABOUT, /* and turned half round */
    DOME_INWARD,
    DOME_COAT,
    REPEATED,
    MIRRORED,
    CLAMPED,
    SMOOTH,
    EMISSION,
    VERTEX_COLORS,
    MASKED,
    BLENDED,
    SPECULAR,
    COATED,
    SHEEN,
    RIPPLED_METAL,
    FLAT_METAL,
    FINISH,
    CARDS
} card;

typedef enum picture {
    DOME_MAP,
    COLORS_REPEATED,
    COLORS_MIRRORED,
    COLORS_CLAMPED,
    COLORS_SMOOTH,
    HALF,
    CUT,
    RIPPLES,
    PICTURES
} picture;

static gw_stage stage;
static gw_camera camera;
static gw_renderer *renderer;
static uint8_t *seen;

/* --- the scene --- */

static void texel(gw_image *image, uint32_t x, uint32_t y, int r, int g, int b, int a) {
    uint8_t *to = image->rgba + ((size_t)y * image->width + x) * 4;
    to[0] = (uint8_t)r, to[1] = (uint8_t)g, to[2] = (uint8_t)b, to[3] = (uint8_t)a;
}

/* A pyramid's normals: each quarter of the picture leans to its own edge, green up. */
static void draw_dome(gw_image *image) {
    for (uint32_t y = 0; y < image->height; ++y)
        for (uint32_t x = 0; x < image->width; ++x) {
            const int right = 2 * (int)x + 1 - (int)image->width, down = 2 * (int)y + 1 - (int)image->height;
            const int sideways = abs(right) > abs(down);
            const int r = sideways ? (right > 0 ? 90 : -90) : 0, g = sideways ? 0 : down > 0 ? -90 : 90;
            texel(image, x, y, 128 + r, 128 + g, 218, 255);
        }
}

static void draw(gw_scene *scene, picture which, uint32_t side, gw_wrap wrap, int nearest) {
    gw_texture *texture = &scene->textures[which];
    snprintf(texture->name, sizeof texture->name, "picture %d", (int)which);
    texture->wrap_u = texture->wrap_v = wrap;
    texture->nearest = nearest;
    check_ok(gw_image_create(side, side, &texture->image, &error));
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const int left = x < side / 2;
            if (which == HALF)
                texel(&texture->image, x, y, left ? 255 : 0, left ? 255 : 0, left ? 255 : 0, 255);
            else if (which == CUT)
                texel(&texture->image, x, y, 255, 255, 255, left ? 255 : 0);
            else if (which == RIPPLES)
                texel(&texture->image, x, y, 128 + ((x + y) % 2 ? 64 : -64), 128, 238, 255);
            else
                texel(&texture->image, x, y, left ? 255 : 0, 0, left ? 0 : 255, 255);
        }
    if (which == DOME_MAP)
        draw_dome(&texture->image);
}

static gw_texture_use use_of(picture which) {
    return (gw_texture_use){.texture = (int32_t)which, .to_uv = {{1, 0, 0}, {0, 1, 0}}};
}

static void color(float out[3], float value) {
    out[0] = out[1] = out[2] = value;
}

static void choose_material(gw_material *m, gw_material_extension *e, card which) {
    *m = (gw_material){
        .base_color = {0.3f, 0.3f, 0.3f, 1}, .roughness = 1, .alpha_cutoff = 0.5f, .base_color_texture = -1};
    *e = gw_material_extension_none();
    if (which >= DOME && which <= DOME_INWARD)
        e->normal = use_of(DOME_MAP);
    if (which >= REPEATED && which <= SMOOTH)
        m->base_color_texture = COLORS_REPEATED + (int32_t)(which - REPEATED);
    if ((which >= REPEATED && which <= SMOOTH) || (which >= VERTEX_COLORS && which <= BLENDED)) {
        e->unlit = 1;
        color(m->base_color, 1);
    }
    if (which == EMISSION || (which >= SPECULAR && which <= SHEEN))
        color(m->base_color, 0);
    switch (which) {
    case DOME_TURNED: /* a quarter turn */
        e->normal = (gw_texture_use){.texture = DOME_MAP, .to_uv = {{0, 1, 0}, {-1, 0, 1}}};
        break;
    case DOME_SECOND_SET:
        e->normal.coordinate = 1;
        break;
    case DOME_INWARD:
        e->normal_scale = -1;
        break;
    case DOME_COAT:
        color(m->base_color, 0);
        e->clearcoat = 1;
        e->clearcoat_roughness = 0.7f;
        e->clearcoat_normal = use_of(DOME_MAP);
        break;
    case EMISSION:
        e->emissive_map = use_of(HALF);
        for (int i = 0; i < 3; ++i)
            e->emissive[i] = 0.25f * (float)(i + 1), m->emissive[i] = 0.5f * e->emissive[i];
        break;
    case MASKED:
        m->alpha_mode = GW_ALPHA_MASK;
        m->base_color_texture = CUT;
        break;
    case BLENDED:
        m->alpha_mode = GW_ALPHA_BLEND;
        m->base_color[3] = 0.5f;
        break;
    case SPECULAR:
        e->ior = 1e6f;
        e->specular_map = use_of(HALF);
        break;
    case COATED:
        e->clearcoat = 1;
        e->clearcoat_map = use_of(HALF);
        break;
    case SHEEN:
        color(e->sheen_color, 1);
        e->sheen_roughness = 0.5f;
        e->sheen_color_map = use_of(HALF);
        break;
    case RIPPLED_METAL:
        e->normal = use_of(RIPPLES);
        /* fall through */
    case FLAT_METAL:
        m->metalness = 1;
        m->roughness = 0.15f;
        color(m->base_color, 1);
        break;
    case FINISH: /* black metal on the left */
        e->metallic_roughness = use_of(HALF);
        e->metalness = e->roughness = 1;
        color(m->base_color, 0);
        m->metalness = m->roughness = 0.5f;
        break;
    default:
        break;
    }
}

/* Corner k of a card, counted from the upper left, row by row. */
static void put_corner(gw_scene *scene, double (*world)[3], card which, uint32_t k) {
    const size_t v = (size_t)which * 4 + k;
    const double x = k % 2, y = k / 2;
    const float repeats = which >= REPEATED && which <= CLAMPED ? 2.0f : 1.0f;
    world[v][0] = (int)which % COLUMNS - COLUMNS / 2.0 + x;
    world[v][1] = COLUMNS / 2.0 - (int)which / COLUMNS - y;
    world[v][2] = 0;
    scene->normals[v * 3 + 2] = 1;
    scene->second_texcoords[v * 2] = (float)x;
    scene->second_texcoords[v * 2 + 1] = (float)y;
    if (which != DOME_SECOND_SET) {
        const int mirrored = which == DOME_MIRRORED || which == DOME_LEFT;
        scene->texcoords[v * 2] = repeats * (float)(mirrored ? 1 - x : x);
        scene->texcoords[v * 2 + 1] = repeats * (float)y;
    }
    if (which >= DOME_RIGHT && which <= DOME_ABOUT)
        scene->tangents[v] = gw_tangent_pack((const double[]){which == DOME_RIGHT ? 1 : -1, 0, 0},
                                             which == DOME_LEFT ? -1 : 1);
    memset(scene->colors + v * 4, 255, 4);
    if (which == VERTEX_COLORS) {
        scene->colors[v * 4 + (k % 2 ? 0 : 2)] = 0;
        scene->colors[v * 4 + 1] = 0;
    }
}

static void *array(size_t count, size_t row) {
    void *out = NULL;
    check_ok(gw_allocate(&out, count, row, "test scene", &error));
    return out;
}

static void light_scene(gw_scene *scene) {
    static const double towards[3][3] = {{0.9, 0, -0.45}, {0, 0.9, -0.45}, {-0.9, 0, -0.45}};
    scene->light_count = 3;
    scene->lights = array(3, sizeof *scene->lights);
    for (int i = 0; i < 3; ++i) {
        gw_light *light = &scene->lights[i];
        light->kind = GW_LIGHT_DIRECTIONAL;
        light->color[i] = 1;
        const double size = hypot(0.9, 0.45);
        for (int k = 0; k < 3; ++k)
            light->vector[k] = (k == 2 ? towards[i][k] : -towards[i][k]) / size;
        color(scene->ambient, 1);
    }
    scene->background[2] = 1;
}

static gw_scene *cards(void) {
    gw_scene *scene = array(1, sizeof *scene);
    double(*world)[3] = array((size_t)CARDS * 4, sizeof *world);
    scene->vertex_count = CARDS * 4;
    scene->triangle_count = CARDS * 2;
    scene->material_count = CARDS;
    scene->texture_count = PICTURES;
    scene->normals = array((size_t)CARDS * 4, 3 * sizeof(float));
    scene->texcoords = array((size_t)CARDS * 4, 2 * sizeof(float));
    scene->second_texcoords = array((size_t)CARDS * 4, 2 * sizeof(float));
    scene->colors = array((size_t)CARDS * 4, 4);
    scene->tangents = array((size_t)CARDS * 4, sizeof *scene->tangents);
    scene->triangles = array((size_t)CARDS * 2, sizeof *scene->triangles);
    scene->material_of = array((size_t)CARDS * 2, sizeof *scene->material_of);
    scene->materials = array(CARDS, sizeof *scene->materials);
    scene->extensions = array(CARDS, sizeof *scene->extensions);
    scene->textures = array(PICTURES, sizeof *scene->textures);
    scene->path = array(1, 8);
    for (uint32_t c = 0; c < CARDS; ++c) {
        choose_material(&scene->materials[c], &scene->extensions[c], (card)c);
        for (uint32_t k = 0; k < 4; ++k)
            put_corner(scene, world, (card)c, k);
        for (uint32_t t = 0; t < 2; ++t) {
            static const uint32_t corners[2][3] = {{0, 2, 1}, {1, 2, 3}};
            for (int k = 0; k < 3; ++k)
                scene->triangles[c * 2 + t][k] = c * 4 + corners[t][k];
            scene->material_of[c * 2 + t] = c;
        }
    }
    draw(scene, DOME_MAP, 16, GW_WRAP_REPEAT, 0);
    draw(scene, COLORS_REPEATED, 2, GW_WRAP_REPEAT, 1);
    draw(scene, COLORS_MIRRORED, 2, GW_WRAP_MIRROR, 1);
    draw(scene, COLORS_CLAMPED, 2, GW_WRAP_CLAMP, 1);
    draw(scene, COLORS_SMOOTH, 2, GW_WRAP_CLAMP, 0);
    draw(scene, HALF, 2, GW_WRAP_CLAMP, 1);
    draw(scene, CUT, 2, GW_WRAP_CLAMP, 1);
    draw(scene, RIPPLES, 64, GW_WRAP_REPEAT, 0);
    light_scene(scene);
    check_ok(gw_scene_finish(scene, &world[0][0], &error));
    free(world);
    return scene;
}

static void open_cards(gw_stage *to, const char *shader_folder) {
    static const char *const settings[] = {
        "octree_depth=5", "tau=0", "tau_inside=0", "sample_block=1", "samples=1", "bounces=0", NULL};
    check_ok(gw_stage_open(to, cards(), shader_folder, settings, &error));
    gw_camera_look(&camera, to, (const double[]){0, 0, 200}, (const double[]){0, 0, 0},
                   2.0 * atan(COLUMNS / 2.0 / 200.0) * 57.29577951308232, SIDE);
}

static const gw_renderer_options plain = {.forbid_features = GW_FEATURE_SHADOWS};

static int open_stage(void **state) {
    (void)state;
    open_cards(&stage, NULL);
    renderer = gw_stage_renderer_with(&stage, &plain);
    seen = gw_camera_take(&camera, renderer, NULL);
    return 0;
}

static int close_stage(void **state) {
    (void)state;
    free(seen);
    gw_renderer_destroy(&renderer);
    gw_stage_close(&stage);
    return 0;
}

/* --- what is seen --- */

/* Linear light of a card's pixel. */
static double at(const uint8_t *rgba, card which, int x, int y, int channel) {
    const size_t pixel =
        (size_t)((int)which / COLUMNS * CARD + y) * SIDE + (size_t)((int)which % COLUMNS * CARD + x);
    return (double)gw_srgb_code_to_linear(rgba[pixel * 4 + (size_t)channel]);
}

/* 1: each quarter of the card gets most from the light that it leans to, and the lower one least from above.
 */
static int stands_out(const uint8_t *rgba, card which) {
    const double more = 1.3;
    const int l = CARD / 8, m = CARD / 2, h = CARD - 1 - CARD / 8;
    return at(rgba, which, h, m, 0) > more * at(rgba, which, l, m, 0) &&
           at(rgba, which, l, m, 2) > more * at(rgba, which, h, m, 2) &&
           at(rgba, which, m, l, 1) > more * at(rgba, which, m, h, 1) &&
           at(rgba, which, h, m, 0) > more * at(rgba, which, m, l, 0);
}

static void bumps_are_lit_from_their_side(void **state) {
    (void)state;
    for (int which = DOME; which <= DOME_COAT; ++which)
        if (stands_out(seen, (card)which) != (which != DOME_INWARD && which != DOME_ABOUT))
            fail_msg("card %d: left %.3f %.3f %.3f, right %.3f %.3f %.3f, top %.3f, bottom %.3f", which,
                     at(seen, (card)which, 2, 8, 0), at(seen, (card)which, 2, 8, 1),
                     at(seen, (card)which, 2, 8, 2), at(seen, (card)which, 13, 8, 0),
                     at(seen, (card)which, 13, 8, 1), at(seen, (card)which, 13, 8, 2),
                     at(seen, (card)which, 8, 2, 1), at(seen, (card)which, 8, 13, 1));
    /* Lambert's law on the right quarter, with what little a rough surface mirrors. */
    const double leaning = sqrt(0.5), size = hypot(0.9, 0.45), cosine = leaning * (0.9 + 0.45) / size;
    const double wanted = 0.3 / 3.14159265 * (cosine + 1.0);
    assert_true(fabs(at(seen, DOME, 13, 8, 0) - wanted) < 0.12 * wanted);
    /* Inward, right and left change places. */
    assert_true(at(seen, DOME_INWARD, 2, 8, 0) > 1.3 * at(seen, DOME_INWARD, 13, 8, 0));
    for (int c = 0; c < 3; ++c)
        assert_true(fabs(at(seen, FLAT, 2, 8, c) - at(seen, FLAT, 13, 8, c)) < 1e-6);
}

/* The other convention: green down. */
static void a_flipped_green_channel_shows(void **state) {
    (void)state;
    char folder[512];
    gw_stage naive;
    open_cards(&naive, gw_naive_shaders(folder, "flipped-green", "shade/maps.glsl", "FLIPPED_GREEN"));
    uint8_t *rgba = gw_stage_take(&naive, &camera, &plain, NULL);
    assert_false(stands_out(rgba, DOME) || stands_out(rgba, DOME_MIRRORED) || stands_out(rgba, DOME_COAT));
    free(rgba);
    gw_stage_close(&naive);
}

/* The file's tangents count, not those of the texture coordinates, and so does their side. */
static void tangents_of_the_file_are_followed(void **state) {
    (void)state;
    assert_true((gw_renderer_features(renderer) & GW_FEATURE_TANGENTS) != 0);
    assert_true(at(seen, DOME_ABOUT, 2, 8, 0) > 1.3 * at(seen, DOME_ABOUT, 13, 8, 0));
    assert_true(at(seen, DOME_ABOUT, 8, 13, 1) > 1.3 * at(seen, DOME_ABOUT, 8, 2, 1));
    for (int c = 0; c < 3; ++c)
        assert_true(fabs(at(seen, DOME_RIGHT, 13, 8, c) - at(seen, DOME, 13, 8, c)) < 0.01);
}

static void a_side_that_is_ignored_shows(void **state) {
    (void)state;
    char folder[512];
    gw_stage naive;
    open_cards(&naive, gw_naive_shaders(folder, "one-side", "shade/maps.glsl", "ONE_SIDE"));
    uint8_t *rgba = gw_stage_take(&naive, &camera, &plain, NULL);
    assert_true(stands_out(rgba, DOME_RIGHT) && !stands_out(rgba, DOME_LEFT));
    free(rgba);
    gw_stage_close(&naive);
}

/* Ripples finer than a pixel: their mean is flat, and still they catch the light from the sides. */
static void what_a_footprint_mixes_shines_wider(void **state) {
    (void)state;
    const double rippled = at(seen, RIPPLED_METAL, 8, 8, 0), flat = at(seen, FLAT_METAL, 8, 8, 0);
    print_message("light from the right: %.4f of ripples, %.4f of a flat metal\n", rippled, flat);
    assert_true(rippled > 1.1 * flat);
}

static void samplers_wrap_and_enlarge_as_asked(void **state) {
    (void)state;
    /* Two pictures across: red, blue; then red, blue again, or mirrored, or the last texel. */
    static const int red[3][4] = {{1, 0, 1, 0}, {1, 0, 0, 1}, {1, 0, 0, 0}};
    for (int mode = 0; mode < 3; ++mode)
        for (int quarter = 0; quarter < 4; ++quarter)
            for (int x = quarter * CARD / 4; x < (quarter + 1) * CARD / 4; ++x) {
                const double r = at(seen, (card)(REPEATED + mode), x, 8, 0),
                             b = at(seen, (card)(REPEATED + mode), x, 8, 2);
                if ((r == 1) != (red[mode][quarter] == 1) || (b == 1) != (red[mode][quarter] == 0))
                    fail_msg("mode %d, pixel %d: %.3f red, %.3f blue", mode, x, r, b);
            }
    const double middle = at(seen, SMOOTH, CARD / 2, 8, 0);
    assert_true(middle > 0.3 && middle < 0.6 && at(seen, SMOOTH, 1, 8, 0) == 1 &&
                at(seen, SMOOTH, 14, 8, 0) == 0);
}

static void colours_and_opacity_are_shown(void **state) {
    (void)state;
    const double step = 0.01;
    for (int c = 0; c < 3; ++c) {
        assert_true(fabs(at(seen, EMISSION, 3, 8, c) - 0.25 * (c + 1)) < step);
        assert_true(at(seen, EMISSION, 13, 8, c) < step);
        assert_true(fabs(at(seen, BLENDED, 8, 8, c) - (c == 2 ? 1.0 : 0.5)) < step);
        assert_true(fabs(at(seen, MASKED, 3, 8, c) - 1.0) < step);
        assert_true(fabs(at(seen, MASKED, 13, 8, c) - (c == 2)) < step);
    }
    for (int x = 0; x < CARD; ++x) {
        const double along = (x + 0.5) / CARD;
        assert_true(fabs(at(seen, VERTEX_COLORS, x, 8, 2) - along) < 0.02 ||
                    fabs(at(seen, VERTEX_COLORS, x, 8, 0) - along) < 0.02);
    }
    assert_true(at(seen, VERTEX_COLORS, 1, 8, 1) == 0);
}

/* Each map is white on the left and black on the right. */
static void maps_of_extensions_are_read_at_the_hit(void **state) {
    (void)state;
    static const card cards_of[] = {SPECULAR, COATED, SHEEN};
    for (size_t i = 0; i < sizeof cards_of / sizeof *cards_of; ++i) {
        const double left = at(seen, cards_of[i], 3, 8, 2), right = at(seen, cards_of[i], 13, 8, 2);
        print_message("card %d: %.4f with, %.4f without\n", (int)cards_of[i], left, right);
        assert_true(left > 0.01 && fabs(at(seen, cards_of[i], 6, 3, 2) - left) < 0.02);
        assert_true(right < 0.5 * left);
    }
    /* Black metal reflects nothing, a dielectric under it does. */
    print_message("finish: %.4f of metal, %.4f without\n", at(seen, FINISH, 3, 8, 0),
                  at(seen, FINISH, 13, 8, 0));
    assert_true(at(seen, FINISH, 13, 8, 0) > 2.0 * at(seen, FINISH, 3, 8, 0));
}

/* Voxels of unlit surfaces send their base colour; those of a mapped one shine as wide as the map's normals
 * spread. */
static void voxels_are_unlit_and_rough_as_their_maps(void **state) {
    (void)state;
    gw_camera coarse = camera;
    coarse.state.geometry = GW_GEOMETRY_VOXELS;
    uint8_t *rgba = gw_camera_take(&coarse, renderer, NULL);
    print_message("unlit red: %.4f %.4f %.4f\n", at(rgba, CLAMPED, 6, 2, 0), at(rgba, CLAMPED, 6, 2, 1),
                  at(rgba, CLAMPED, 6, 2, 2));
    print_message("ripples %.4f, flat metal %.4f\n", at(rgba, RIPPLED_METAL, 8, 8, 0),
                  at(rgba, FLAT_METAL, 8, 8, 0));
    assert_true(fabs(at(rgba, CLAMPED, 6, 2, 0) + at(rgba, CLAMPED, 6, 2, 2) - 1.0) < 0.08);
    assert_true(at(rgba, CLAMPED, 6, 2, 1) < 0.05);
    assert_true(at(rgba, RIPPLED_METAL, 8, 8, 0) > 1.1 * at(rgba, FLAT_METAL, 8, 8, 0));
    free(rgba);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bumps_are_lit_from_their_side),
        cmocka_unit_test(tangents_of_the_file_are_followed),
        cmocka_unit_test(what_a_footprint_mixes_shines_wider),
        cmocka_unit_test(samplers_wrap_and_enlarge_as_asked),
        cmocka_unit_test(colours_and_opacity_are_shown),
        cmocka_unit_test(maps_of_extensions_are_read_at_the_hit),
        cmocka_unit_test(voxels_are_unlit_and_rough_as_their_maps),
        cmocka_unit_test(a_flipped_green_channel_shows), /* last: these have devices of their own */
        cmocka_unit_test(a_side_that_is_ignored_shows),
    };
    return cmocka_run_group_tests_name("materials", tests, open_stage, close_stage);
}
