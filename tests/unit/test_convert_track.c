/* The converter of SuperTuxKart tracks (tests/tools), on a track made by hand: a fence of two triangles, one
 * invisible wall, a lamp that a library node places, turned and shifted. */
#include "base/file.h"
#include "build/import.h"
#include "tests/support/check.h"
#include "tests/tools/stk_gltf.h"
#include "tests/tools/xml.h"

#include <math.h>

/* Little endian bytes, appended. */
typedef struct maker {
    uint8_t bytes[1024];
    size_t size;
} maker;

static void put(maker *m, const void *data, size_t size) {
    assert_true(m->size + size <= sizeof m->bytes);
    memcpy(m->bytes + m->size, data, size);
    m->size += size;
}

static void put_number(maker *m, uint32_t value, size_t bytes) {
    for (size_t i = 0; i < bytes; i++) {
        uint8_t byte = (uint8_t)(value >> (8 * i));
        put(m, &byte, 1);
    }
}

static void put_text(maker *m, const char *text) {
    put_number(m, (uint32_t)strlen(text), 1);
    put(m, text, strlen(text));
}

enum { HALF_ONE = 0x3c00, NORMAL_Z = 511 << 20 };

static void put_vertex(maker *m, float x, float y, float z, int textured) {
    const float position[3] = {x, y, z};
    put(m, position, sizeof position);
    put_number(m, NORMAL_Z, 4);
    if (x > 0.5f) {
        put_number(m, 0, 1); /* a colour of its own */
        put_number(m, 0x40ff80, 3);
    } else {
        put_number(m, 128, 1);
    }
    if (textured) {
        put_number(m, x > 0.5f ? HALF_ONE : 0, 2);
        put_number(m, y > 0.5f ? HALF_ONE : 0, 2);
    }
}

/* Static, with normals and colours: a unit square at z = 2 with a picture, a triangle without one. */
static maker make_mesh(void) {
    maker m = {.size = 0};
    put(&m, "SP", 2);
    put_number(&m, 1 << 3 | 2, 1);
    put_number(&m, 3, 1);
    for (int i = 0; i < 6; i++)
        put_number(&m, 0, 4);
    put_number(&m, 2, 2);
    put_text(&m, "fence.png");
    put_text(&m, "");
    put_text(&m, "");
    put_text(&m, "");
    put_number(&m, 1, 2);
    put_number(&m, 2, 2);
    put_number(&m, 4, 4);
    put_number(&m, 6, 4);
    put_number(&m, 0, 2);
    put_vertex(&m, 0, 0, 2, 1);
    put_vertex(&m, 1, 0, 2, 1);
    put_vertex(&m, 1, 1, 2, 1);
    put_vertex(&m, 0, 1, 2, 1);
    const uint8_t square[6] = {0, 1, 2, 0, 2, 3};
    put(&m, square, sizeof square);
    put_number(&m, 3, 4);
    put_number(&m, 3, 4);
    put_number(&m, 1, 2);
    put_vertex(&m, 0, 0, 9, 0);
    put_vertex(&m, 1, 0, 9, 0);
    put_vertex(&m, 0, 1, 9, 0);
    const uint8_t triangle[3] = {0, 1, 2};
    put(&m, triangle, sizeof triangle);
    return m;
}

static void test_mesh(void **state) {
    (void)state;
    maker m = make_mesh();
    stk_mesh mesh;
    check_ok(stk_mesh_read("made.spm", m.bytes, m.size, &mesh, &error));
    assert_int_equal(mesh.material_count, 2);
    assert_string_equal(mesh.textures[0], "fence.png");
    assert_string_equal(mesh.textures[1], "");
    assert_int_equal(mesh.buffer_count, 2);
    assert_int_equal(mesh.vertex_count, 7);
    /* Left-handed to right-handed: z negated and the winding turned, so the front stays the front. */
    assert_true(mesh.positions[2][0] == 1.0f && mesh.positions[2][1] == 1.0f &&
                mesh.positions[2][2] == -2.0f);
    assert_true(mesh.normals[0][2] == -1.0f);
    static const uint32_t turned[6] = {0, 2, 1, 0, 3, 2};
    assert_memory_equal(mesh.indices, turned, sizeof turned);
    assert_true(mesh.texcoords[2][0] == 1.0f && mesh.texcoords[2][1] == 1.0f && mesh.texcoords[0][0] == 0.0f);
    static const uint8_t white[4] = {255, 255, 255, 255}, own[4] = {0x80, 0xff, 0x40, 255};
    assert_memory_equal(mesh.colors[0], white, 4);
    assert_memory_equal(mesh.colors[1], own, 4);
    stk_mesh_finish(&mesh);
}

static void test_cut_meshes(void **state) {
    (void)state;
    maker m = make_mesh();
    for (size_t size = 0; size < m.size; size++) {
        uint8_t *copy = malloc(size + 1); /* exact, so that the sanitizer sees a read behind the end */
        stk_mesh mesh;
        assert_non_null(copy);
        memcpy(copy, m.bytes, size);
        check_fails(stk_mesh_read("cut.spm", copy, size, &mesh, &error), GW_BAD_INPUT, "cut.spm");
        free(copy);
    }
}

/* Every byte set to 255 in turn: read or refused, nothing else; counts and indices among them. */
static void test_damaged_meshes(void **state) {
    (void)state;
    maker m = make_mesh();
    int refused = 0;
    for (size_t at = 0; at < m.size; at++) {
        uint8_t *copy = malloc(m.size);
        stk_mesh mesh;
        gw_error error = {0};
        assert_non_null(copy);
        memcpy(copy, m.bytes, m.size);
        copy[at] = 255;
        gw_code code = stk_mesh_read("damaged.spm", copy, m.size, &mesh, &error);
        assert_true(code == GW_OK || code == GW_BAD_INPUT);
        refused += code != GW_OK;
        if (code == GW_OK)
            for (size_t b = 0; b < mesh.buffer_count; b++)
                for (uint32_t i = 0; i < mesh.buffers[b].index_count; i++)
                    assert_true(mesh.indices[mesh.buffers[b].index_first + i] < mesh.buffers[b].vertex_count);
        stk_mesh_finish(&mesh);
        free(copy);
    }
    assert_true(refused > 30);
}

static void test_xml(void **state) {
    (void)state;
    static const char good[] = "<?xml version=\"1.0\"?><!-- a > b --><a x='1 &lt; &quot;2&quot;'>text"
                               "<b/><c y=\"\" z = \"7\"><b/></c></a>\n";
    xml_document d;
    check_ok(xml_parse("good.xml", good, strlen(good), &d, &error));
    assert_string_equal(xml_attribute_of(&d, 0, "x"), "1 < \"2\"");
    int32_t b = xml_child(&d, 0, -1), c = xml_child(&d, 0, b);
    assert_true(xml_is(&d, b, "b") && xml_is(&d, c, "c") && xml_child(&d, 0, c) < 0);
    assert_string_equal(xml_attribute_of(&d, c, "z"), "7");
    assert_null(xml_attribute_of(&d, c, "w"));
    assert_true(xml_child(&d, b, -1) < 0 && xml_child(&d, c, -1) >= 0);
    xml_finish(&d);
    static const char *const bad[] = {
        "",     "text", "<a>", "<a></b>", "<a b></a>", "<a b=c/>",   "<a b=\"/>",   "<a/><b/>",
        "</a>", "<a",   "<",   "<!-- ",   "<a/ >",     "<a><b></a>", "<a b=\"1\"c", "< a/>"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        check_fails(xml_parse("bad.xml", bad[i], strlen(bad[i]), &d, &error), GW_BAD_INPUT, "bad.xml");
}

static void write_text(const char *folder, const char *name, const char *text) {
    char *path = gw_path_join(folder, name);
    char *parent = gw_path_folder(path);
    check_ok(gw_make_directories(parent, &error));
    check_ok(gw_file_write(path, text, strlen(text), &error));
    free(path);
    free(parent);
}

static void write_bytes(const char *folder, const char *name, const void *data, size_t size) {
    char *path = gw_path_join(folder, name);
    check_ok(gw_file_write(path, data, size, &error));
    free(path);
}

/* The game's data folder with one track and one library node. */
static void make_data(const char *data, const char *scene) {
    maker m = make_mesh();
    gw_bytes picture = {0};
    write_text(data, "tracks/small/scene.xml", scene);
    write_text(data, "library/post/node.xml",
               "<scene><lod><group name=\"g\">"
               "<static-object lod_distance=\"90\" model=\"missing.spm\"/>"
               "<static-object lod_distance=\"30\" model=\"post.spm\"/></group></lod>"
               "<object lod_group=\"g\" xyz=\"0 1 0\"/><light xyz=\"0 0 1\" energy=\"2\" color=\"255 0 "
               "0\"/></scene>");
    write_text(data, "textures/materials.xml",
               "<materials><material name=\"fence.png\" shader=\"alphatest\"/></materials>");
    check_ok(gw_file_read("tests/data/mask.png", 1 << 20, &picture, &error));
    write_bytes(data, "textures/fence.png", picture.data, picture.size);
    write_bytes(data, "tracks/small/small.spm", m.bytes, m.size);
    write_bytes(data, "library/post/post.spm", m.bytes, m.size);
    gw_bytes_finish(&picture);
}

static const char whole_scene[] = "<scene><track model=\"small.spm\"><static-object model=\"small.spm\" "
                                  "interaction=\"physics-only\"/></track>"
                                  "<object type=\"sfx-emitter\" xyz=\"1 2 3\"/>"
                                  "<library name=\"post\" xyz=\"10 0 5\" hpr=\"0 90 0\" scale=\"2 2 2\"/>"
                                  "<sun xyz=\"0 100 0\" sun-diffuse=\"255 255 255\"/></scene>";

static void test_track(void **state) {
    (void)state;
    char data[512], out[512], model[600];
    stk_scene track;
    stk_gltf_counts counts;
    make_data(scratch_path(data, "game"), whole_scene);
    scratch_path(out, "converted");
    check_ok(gw_make_directories(out, &error));
    check_ok(stk_scene_read(data, "small", &track, &error));
    assert_int_equal(track.instance_count, 2);
    assert_int_equal(track.light_count, 1);
    /* In the game: (0,0,1) scaled to (0,0,2), a quarter turn about y to (2,0,0), shifted to (12,0,5); z is
     * negated. */
    assert_true(fabs(track.lights[0].position[0] - 12) < 1e-12 &&
                fabs(track.lights[0].position[2] + 5) < 1e-12);
    check_ok(stk_gltf_write(&track, out, "small", &counts, &error));
    assert_int_equal(counts.triangles, 4);
    assert_int_equal(counts.hidden, 2);
    assert_int_equal(counts.materials, 1);
    assert_int_equal(counts.missing, 0);
    stk_scene_finish(&track);

    gw_scene *scene = NULL;
    const char *program = getenv("GAZEWALL");
    gw_import_options options = {.program = program ? program : "out/release/gazewall"};
    snprintf(model, sizeof model, "%s/small.gltf", out);
    check_ok(gw_import(model, &options, &scene, &error));
    assert_int_equal(scene->triangle_count, 4);
    assert_int_equal(scene->texture_count, 1);
    assert_int_equal(scene->light_count, 2);
    assert_int_equal(scene->materials[scene->material_of[0]].alpha_mode, GW_ALPHA_MASK);
    /* The post's square: x from 0..1 to 5 - 0..2 turned, z = 2 to 10 + 4; y from 0..1 to 2..4. */
    static const double low[3] = {0, 0, -5}, high[3] = {14, 4, -2};
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(scene->bounds[0][i] - low[i]) < 1e-5);
        assert_true(fabs(scene->bounds[1][i] - high[i]) < 1e-5);
    }
    gw_scene_destroy(&scene);
}

static void test_bad_tracks(void **state) {
    (void)state;
    static const struct {
        const char *scene, *part;
    } bad[] = {
        {"<scene><object model=\"../small.spm\"/></scene>", "plain name"},
        {"<scene><object model=\"none.spm\"/></scene>", "none.spm"},
        {"<scene><object model=\"small.spm\" xyz=\"1 2\"/></scene>", "three numbers"},
        {"<scene><object model=\"small.spm\" scale=\"1 nan 2\"/></scene>", "three numbers"},
        {"<scene><object lod_group=\"h\"/></scene>", "levels of detail"},
        {"<scene><library name=\"ring\"/></scene>", "deep"},
        {"<scene><library name=\"..\"/></scene>", "plain name"},
        {"<scene><library/></scene>", "plain name"},
    };
    char data[512];
    scratch_path(data, "bad-game");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        stk_scene track;
        make_data(data, bad[i].scene);
        write_text(data, "library/ring/node.xml", "<scene><library name=\"ring\"/></scene>");
        check_fails(stk_scene_read(data, "small", &track, &error), GW_BAD_INPUT, bad[i].part);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh), cmocka_unit_test(test_cut_meshes), cmocka_unit_test(test_damaged_meshes),
        cmocka_unit_test(test_xml),  cmocka_unit_test(test_track),      cmocka_unit_test(test_bad_tracks),
    };
    return cmocka_run_group_tests_name("convert_track", tests, NULL, NULL);
}
