/* A scene as one block: everything comes back, equal input gives equal bytes, damage is noticed. */
#include "tests/support/check.h"

#include "build/animation.h"
#include "build/pack_scene.h"

#include <math.h>

enum { VERTICES = 5, TRIANGLES = 3 };

typedef struct fixture {
    gw_scene scene;
    float positions[VERTICES][3], normals[VERTICES][3], texcoords[VERTICES][2];
    uint8_t colors[VERTICES][4], red[2 * 3 * 4], blue[4];
    uint32_t triangles[TRIANGLES][3], material_of[TRIANGLES], welded[VERTICES];
    gw_material materials[2];
    gw_texture textures[2];
    gw_light lights[1];
    gw_viewpoint viewpoints[1];
    char path[8];
} fixture;

static void fill_scene(fixture *f) {
    gw_scene *s = &f->scene;
    strcpy(f->path, "made");
    s->path = f->path;
    s->hash = (gw_hash){1, 2};
    s->vertex_count = VERTICES;
    s->triangle_count = TRIANGLES;
    for (int i = 0; i < VERTICES; i++) {
        for (int k = 0; k < 3; k++) {
            f->positions[i][k] = (float)(i * 3 + k) / 16;
            f->normals[i][k] = k == 2;
        }
        f->texcoords[i][0] = (float)i;
        f->welded[i] = (uint32_t)i / 2;
        memset(f->colors[i], i, 4);
    }
    const uint32_t triangles[TRIANGLES][3] = {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}};
    memcpy(f->triangles, triangles, sizeof triangles);
    f->material_of[1] = 1;
    s->positions = f->positions[0];
    s->normals = f->normals[0];
    s->texcoords = f->texcoords[0];
    s->colors = f->colors[0];
    s->welded = f->welded;
    s->welded_count = 3;
    s->triangles = f->triangles;
    s->material_of = f->material_of;
    s->material_count = 2;
    s->materials = f->materials;
    strcpy(f->materials[1].name, "second");
    f->materials[0].base_color_texture = -1;
    f->materials[1].base_color_texture = 1;
    s->texture_count = 2;
    s->textures = f->textures;
    memset(f->red, 200, sizeof f->red);
    memset(f->blue, 50, sizeof f->blue);
    f->textures[0] = (gw_texture){.name = "red", .image = {2, 3, f->red}, .wrap_u = GW_WRAP_CLAMP};
    f->textures[1] = (gw_texture){.name = "blue", .image = {1, 1, f->blue}, .wrap_v = GW_WRAP_MIRROR};
    s->light_count = s->viewpoint_count = 1;
    s->lights = f->lights;
    s->viewpoints = f->viewpoints;
    f->lights[0].vector[1] = -1;
    strcpy(f->viewpoints[0].name, "door");
    s->ambient[1] = 0.25f;
    s->background[2] = 0.5f;
    s->placement.kind = GW_PLACE_VIEWPOINT;
    s->placement.scale = 3;
    s->centre[0] = 1.0 / 3;
    s->exponent = -4;
    s->bounds[1][2] = 7;
}

static fixture *make_fixture(void) {
    fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    fill_scene(f);
    return f;
}

static void *pack(const fixture *f, size_t *size) {
    *size = gw_pack_scene_size(&f->scene);
    assert_true(*size % 64 == 0);
    void *block = aligned_alloc(64, *size);
    assert_non_null(block);
    memset(block, 0xa5, *size);
    gw_pack_scene(&f->scene, block);
    return block;
}

static void everything_comes_back(void **state) {
    (void)state;
    fixture *f = make_fixture();
    size_t size;
    void *block = pack(f, &size);
    gw_unpacked_scene u;
    check_ok(gw_unpack_scene(block, size, &u, &error));
    const gw_scene *s = &u.scene;
    assert_string_equal(s->path, "made");
    assert_memory_equal(&s->hash, &f->scene.hash, sizeof s->hash);
    assert_int_equal(s->vertex_count, VERTICES);
    assert_memory_equal(s->positions, f->positions, sizeof f->positions);
    assert_memory_equal(s->normals, f->normals, sizeof f->normals);
    assert_memory_equal(s->texcoords, f->texcoords, sizeof f->texcoords);
    assert_int_equal(s->welded_count, 3);
    assert_memory_equal(s->welded, f->welded, sizeof f->welded);
    assert_memory_equal(s->colors, f->colors, sizeof f->colors);
    assert_memory_equal(s->triangles, f->triangles, sizeof f->triangles);
    assert_memory_equal(s->material_of, f->material_of, sizeof f->material_of);
    assert_memory_equal(s->materials, f->materials, sizeof f->materials);
    assert_int_equal(s->texture_count, 2);
    assert_string_equal(s->textures[0].name, "red");
    assert_int_equal(s->textures[0].image.height, 3);
    assert_memory_equal(s->textures[0].image.rgba, f->red, sizeof f->red);
    assert_memory_equal(s->textures[1].image.rgba, f->blue, sizeof f->blue);
    assert_int_equal(s->textures[0].wrap_u, GW_WRAP_CLAMP);
    assert_int_equal(s->textures[1].wrap_v, GW_WRAP_MIRROR);
    assert_memory_equal(s->lights, f->lights, sizeof f->lights);
    assert_memory_equal(s->viewpoints, f->viewpoints, sizeof f->viewpoints);
    assert_memory_equal(s->ambient, f->scene.ambient, sizeof s->ambient);
    assert_memory_equal(s->background, f->scene.background, sizeof s->background);
    assert_int_equal(s->placement.kind, GW_PLACE_VIEWPOINT);
    assert_true(s->placement.scale == 3 && s->centre[0] == 1.0 / 3 && s->exponent == -4 &&
                s->bounds[1][2] == 7);
    gw_unpacked_scene_finish(&u);
    free(block);
    free(f);
}

static void no_colors_stay_none(void **state) {
    (void)state;
    fixture *f = make_fixture();
    f->scene.colors = NULL;
    size_t size;
    void *block = pack(f, &size);
    gw_unpacked_scene u;
    check_ok(gw_unpack_scene(block, size, &u, &error));
    assert_null(u.scene.colors);
    gw_unpacked_scene_finish(&u);
    free(block);
    free(f);
}

static void extensions_come_back_or_are_refused(void **state) {
    (void)state;
    fixture *f = make_fixture();
    float second[VERTICES][2] = {{0.25f, 0.5f}, {0.75f, 1}};
    uint32_t tangents[VERTICES] = {5, 0xffffffffu};
    gw_material_extension extensions[2] = {gw_material_extension_none(), gw_material_extension_none()};
    extensions[1].normal.texture = 1;
    extensions[1].normal.coordinate = 1;
    extensions[1].clearcoat = 0.5f;
    f->scene.extensions = extensions;
    f->scene.second_texcoords = second[0];
    f->scene.tangents = tangents;
    size_t size;
    void *block = pack(f, &size);
    gw_unpacked_scene u;
    check_ok(gw_unpack_scene(block, size, &u, &error));
    assert_memory_equal(u.scene.extensions, extensions, sizeof extensions);
    assert_memory_equal(u.scene.second_texcoords, second, sizeof second);
    assert_memory_equal(u.scene.tangents, tangents, sizeof tangents);
    gw_unpacked_scene_finish(&u);
    for (int i = 0; i < 6; i++) {
        gw_material_extension e = extensions[1];
        e.normal.texture = i == 0 ? 2 : 1;
        e.occlusion.coordinate = i == 1 ? 2 : 0;
        e.emissive_map.to_uv[1][2] = i == 2 ? NAN : 0;
        e.ior = i == 3 ? 0.5f : 1.5f;
        e.sheen_color[2] = i == 4 ? 1.5f : 0;
        e.transmission = i == 5 ? NAN : 0;
        f->scene.extensions[1] = e;
        gw_pack_scene(&f->scene, block);
        check_fails(gw_unpack_scene(block, size, &u, &error), GW_BAD_INPUT,
                    i < 3    ? "a map whose picture"
                    : i == 3 ? "an index of refraction"
                    : i == 4 ? "a sheen colour"
                             : "a transmission");
    }
    free(block);
    free(f);
}

/* A joint that moves one vertex along, in the fixture's scene. */
static gw_animation *make_animation(void) {
    static const double positions[VERTICES][3] = {{0}};
    gw_animation *a = NULL;
    check_ok(gw_animation_still(VERTICES, positions[0], NULL, &a, &error));
    a->clips = calloc(1, sizeof *a->clips);
    a->nodes = calloc(1, sizeof *a->nodes);
    a->channels = calloc(1, sizeof *a->channels);
    a->times = calloc(2, sizeof *a->times);
    a->values = calloc(6, sizeof *a->values);
    a->joints = calloc(1, sizeof *a->joints);
    a->bindings = realloc(a->bindings, 2 * sizeof *a->bindings);
    assert_true(a->clips && a->nodes && a->channels && a->times && a->values && a->joints && a->bindings);
    a->clip_count = a->node_count = a->channel_count = a->joint_count = 1;
    a->time_count = a->binding_count = 2;
    a->value_count = 6;
    a->clips[0].duration = 2;
    a->nodes[0] = (gw_motion_node){.parent = -1, .moves = 1, .rotation = {0, 0, 0, 1}, .scale = {1, 1, 1}};
    a->channels[0] = (gw_motion_channel){.curve = GW_CURVE_LINEAR, .key_count = 2};
    a->times[1] = 2;
    a->values[4] = 6;
    for (int i = 0; i < 3; i++)
        a->joints[0].inverse_bind[i][i] = 1;
    a->bindings[1] = (gw_binding){.count = 1, .weights = {1}};
    a->binding_of[3] = 1;
    return a;
}

static void what_moves_comes_back(void **state) {
    (void)state;
    fixture *f = make_fixture();
    f->scene.animation = make_animation();
    size_t size;
    void *block = pack(f, &size);
    gw_unpacked_scene u;
    check_ok(gw_unpack_scene(block, size, &u, &error));
    assert_non_null(u.scene.animation);
    double world[VERTICES][3];
    gw_pose pose;
    check_ok(gw_pose_init(u.scene.animation, &pose, &error));
    gw_pose_at_time(u.scene.animation, 500000000, &pose);
    gw_pose_vertices(u.scene.animation, &pose, world[0], NULL);
    for (int v = 0; v < VERTICES; v++)
        assert_true(world[v][0] == 0 && world[v][1] == (v == 3 ? 1.5 : 0) && world[v][2] == 0);
    const gw_hash none = {0, 0}, sent = gw_animation_hash(none, f->scene.animation),
                  got = gw_animation_hash(none, u.scene.animation);
    assert_memory_equal(&sent, &got, sizeof sent);
    gw_pose_finish(&pose);
    gw_unpacked_scene_finish(&u);
    gw_animation_destroy(&f->scene.animation);
    free(block);
    free(f);
}

/* Each promise of the animation broken in turn: the block is refused. */
static void broken_animations_are_refused(void **state) {
    (void)state;
    enum { BREAKS = 13 };
    for (int i = 0; i < BREAKS; i++) {
        fixture *f = make_fixture();
        gw_animation *a = f->scene.animation = make_animation();
        a->clips[0].duration = i == 0 ? 0 : 2;
        a->nodes[0].parent = i == 1 ? 0 : -1;
        a->nodes[0].scale[1] = i == 2 ? (double)NAN : 1;
        a->channels[0].node = i == 3;
        a->channels[0].key_first = i == 4;
        a->channels[0].value_first = i == 5;
        a->channels[0].path = i == 6 ? 3 : 0;
        a->times[0] = i == 7 ? 3 : 0;
        a->values[2] = i == 8 ? INFINITY : 0;
        a->joints[0].node = i == 9;
        a->bindings[1].joints[0] = i == 10;
        a->bindings[1].weights[0] = i == 11 ? -1 : 1;
        a->binding_of[0] = i == 12 ? 2 : 0;
        size_t size;
        void *block = pack(f, &size);
        gw_unpacked_scene u;
        check_fails(gw_unpack_scene(block, size, &u, &error), GW_BAD_INPUT, "the animation is damaged");
        gw_animation_destroy(&f->scene.animation);
        free(block);
        free(f);
    }
    fixture *f = make_fixture();
    f->scene.animation = make_animation();
    f->scene.animation->vertex_count--;
    size_t size;
    void *block = pack(f, &size);
    gw_unpacked_scene u;
    check_fails(gw_unpack_scene(block, size, &u, &error), GW_BAD_INPUT, "of other vertices");
    gw_animation_destroy(&f->scene.animation);
    free(block);
    free(f);
}

static void equal_input_gives_equal_bytes(void **state) {
    (void)state;
    fixture *a = make_fixture(), *b = make_fixture();
    size_t size_a, size_b;
    void *block_a = pack(a, &size_a), *block_b = pack(b, &size_b);
    assert_int_equal(size_a, size_b);
    assert_memory_equal(block_a, block_b, size_a);
    free(block_a);
    free(block_b);
    free(a);
    free(b);
}

static void damage_is_noticed(void **state) {
    (void)state;
    fixture *f = make_fixture();
    size_t size;
    uint8_t *block = pack(f, &size);
    gw_unpacked_scene u;
    check_fails(gw_unpack_scene(block, size - 64, &u, &error), GW_BAD_INPUT, "damaged");
    check_fails(gw_unpack_scene(block, 16, &u, &error), GW_BAD_INPUT, "cut");
    f->triangles[2][1] = VERTICES;
    gw_pack_scene(&f->scene, block);
    check_fails(gw_unpack_scene(block, size, &u, &error), GW_BAD_INPUT, "a triangle's index");
    f->triangles[2][1] = 0;
    f->welded[4] = 3;
    gw_pack_scene(&f->scene, block);
    check_fails(gw_unpack_scene(block, size, &u, &error), GW_BAD_INPUT, "a welded vertex");
    f->welded[4] = 2;
    f->materials[1].base_color_texture = 2;
    gw_pack_scene(&f->scene, block);
    check_fails(gw_unpack_scene(block, size, &u, &error), GW_BAD_INPUT, "a material's texture");
    free(block);
    free(f);
}

/* Every byte of the head flipped: either an error, or a block that still lies inside itself. Under the
 * address sanitizer this proves that nothing outside is read. */
static void a_flipped_head_is_harmless(void **state) {
    (void)state;
    fixture *f = make_fixture();
    size_t size;
    uint8_t *block = pack(f, &size);
    int refused = 0;
    for (size_t i = 0; i < 1024 && i < size; i++) {
        gw_unpacked_scene u;
        gw_error error = {0};
        block[i] ^= 0x40;
        if (gw_unpack_scene(block, size, &u, &error) == GW_OK)
            gw_unpacked_scene_finish(&u);
        else
            refused++;
        block[i] ^= 0x40;
    }
    assert_true(refused > 100);
    free(block);
    free(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_comes_back),
        cmocka_unit_test(no_colors_stay_none),
        cmocka_unit_test(extensions_come_back_or_are_refused),
        cmocka_unit_test(what_moves_comes_back),
        cmocka_unit_test(broken_animations_are_refused),
        cmocka_unit_test(equal_input_gives_equal_bytes),
        cmocka_unit_test(damage_is_noticed),
        cmocka_unit_test(a_flipped_head_is_harmless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
