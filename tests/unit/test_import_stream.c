/* The bytes between the import child and its parent, friendly and hostile. */
#include "tests/support/check.h"

#include "tests/fuzz/import_entry.h"
#include "tests/support/meshes.h"
#include "tests/support/models.h"

static void carries_everything(void **state) {
    (void)state;
    size_t size = 0;
    gw_source_model *sent = test_model(), *parsed = NULL;
    uint8_t *bytes = test_stream(sent, &size);
    assert_int_equal(gw_model_stream_size(bytes), size);
    check_ok(gw_model_stream_read(bytes, size, &parsed, &error));
    const gw_scene *a = sent->scene, *b = parsed->scene;
    assert_int_equal(b->vertex_count, 4);
    assert_int_equal(b->triangle_count, 2);
    assert_memory_equal(sent->world, parsed->world, 4 * 24);
    assert_memory_equal(a->normals, b->normals, 4 * 12);
    assert_memory_equal(a->texcoords, b->texcoords, 4 * 8);
    assert_memory_equal(a->second_texcoords, b->second_texcoords, 4 * 8);
    assert_memory_equal(a->tangents, b->tangents, 4 * sizeof *a->tangents);
    assert_memory_equal(a->extensions, b->extensions, 2 * sizeof *a->extensions);
    assert_memory_equal(a->colors, b->colors, 4 * 4);
    assert_memory_equal(a->triangles, b->triangles, 2 * 12);
    assert_memory_equal(a->material_of, b->material_of, 2 * 4);
    assert_memory_equal(a->materials, b->materials, 2 * sizeof *a->materials);
    assert_memory_equal(sent->material_sources, parsed->material_sources, 2 * sizeof *sent->material_sources);
    assert_int_equal(parsed->source_count, 2);
    assert_string_equal(parsed->sources[0].path, "wood.png");
    assert_string_equal(parsed->sources[1].alpha_path, "mask.png");
    assert_memory_equal(parsed->sources[1].bytes, sent->sources[1].bytes, 8);
    assert_int_equal(parsed->sources[1].raw_width, 2);
    assert_int_equal(parsed->sources[1].wrap_u, GW_WRAP_CLAMP);
    assert_int_equal(parsed->sources[1].wrap_v, GW_WRAP_MIRROR);
    assert_int_equal(b->lights[0].kind, GW_LIGHT_POINT);
    assert_true(b->lights[0].vector[2] == 3.0 && b->lights[0].color[2] == 6.0f);
    assert_string_equal(b->viewpoints[0].name, "door");
    assert_true(b->viewpoints[0].eye[2] == 5.0 && b->viewpoints[0].fov == 40.0);
    assert_int_equal(b->dropped.not_triangle, 5);
    assert_string_equal(b->notes[0], "a note");
    free(bytes);
    gw_source_model_destroy(&sent);
    gw_source_model_destroy(&parsed);
}

static void refuses_every_cut(void **state) {
    (void)state;
    size_t size = 0;
    gw_source_model *model = test_model();
    uint8_t *bytes = test_stream(model, &size);
    for (size_t cut = 0; cut < size; cut++) {
        gw_source_model *parsed = NULL;
        uint8_t *copy = malloc(cut + 1); /* its own block, so that a sanitizer sees a byte too far */
        assert_non_null(copy);
        memcpy(copy, bytes, cut);
        check_fails(gw_model_stream_read(copy, cut, &parsed, &error), GW_BAD_INPUT, "importer's answer");
        if (cut >= GW_MODEL_STREAM_HEADER) { /* the same with a header that agrees with the cut */
            const uint64_t told = cut;
            memcpy(copy + 16, &told, sizeof told);
            check_fails(gw_model_stream_read(copy, cut, &parsed, &error), GW_BAD_INPUT, "importer's answer");
        }
        assert_null(parsed);
        free(copy);
    }
    free(bytes);
    gw_source_model_destroy(&model);
}

/* Words of the stream by their place: vertices, triangles, flags; the first is right behind the header. */
static void refuses_counts_beyond_the_bytes(void **state) {
    (void)state;
    static const uint32_t counts[] = {0x7fffffff, 0xffffffff, 0x10000000, 1000};
    size_t size = 0;
    gw_source_model *model = test_model();
    uint8_t *bytes = test_stream(model, &size);
    for (size_t word = 0; word < 2; word++)
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            gw_source_model *parsed = NULL;
            uint8_t *copy = test_copy(bytes, size);
            memcpy(copy + GW_MODEL_STREAM_HEADER + word * 4, &counts[i], 4);
            check_fails(gw_model_stream_read(copy, size, &parsed, &error), GW_BAD_INPUT, "damaged at byte");
            free(copy);
        }
    free(bytes);
    gw_source_model_destroy(&model);
}

static void refuses_materials_without_sense(void **state) {
    (void)state;
    static const float bad[] = {-0.5f, 1.5f, NAN, INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        size_t size = 0;
        gw_source_model *model = test_model(), *parsed = NULL;
        model->scene->materials[1].roughness = bad[i];
        uint8_t *bytes = test_stream(model, &size);
        check_fails(gw_model_stream_read(bytes, size, &parsed, &error), GW_BAD_INPUT,
                    "a number is out of range");
        free(bytes);
        gw_source_model_destroy(&model);
    }
    size_t size = 0;
    gw_source_model *model = test_model(), *parsed = NULL;
    model->material_sources[0].maps[GW_MAP_BASE_COLOR] = 2;
    uint8_t *bytes = test_stream(model, &size);
    check_fails(gw_model_stream_read(bytes, size, &parsed, &error), GW_BAD_INPUT,
                "texture that is not there");
    free(bytes);
    gw_source_model_destroy(&model);
}

static void refuses_extensions_without_sense(void **state) {
    (void)state;
    size_t size = 0;
    gw_source_model *model = test_model(), *parsed = NULL;
    model->scene->extensions[1].ior = 0.5f;
    uint8_t *bytes = test_stream(model, &size);
    check_fails(gw_model_stream_read(bytes, size, &parsed, &error), GW_BAD_INPUT, "a material's extension");
    free(bytes);
    gw_source_model_destroy(&model);
}

/* Bytes changed, inserted and cut out, with the header kept in agreement so that the mutations reach the
 * sections. */
static void survives_mutations(void **state) {
    (void)state;
    enum { RUNS = 30000 };
    uint64_t random = 20240607;
    size_t size = 0;
    gw_source_model *model = test_model();
    uint8_t *bytes = test_stream(model, &size);
    uint8_t *copy = malloc(size * 2);
    assert_non_null(copy);
    print_message("seed %llu, %d runs\n", (unsigned long long)random, RUNS);
    for (int run = 0; run < RUNS; run++) {
        size_t length = size;
        memcpy(copy, bytes, size);
        const int changes = 1 + (int)(gw_test_random(&random) * 4.0);
        for (int i = 0; i < changes; i++) {
            const size_t at = GW_MODEL_STREAM_HEADER +
                              (size_t)(gw_test_random(&random) * (double)(length - GW_MODEL_STREAM_HEADER));
            const double kind = gw_test_random(&random);
            if (kind < 0.8)
                copy[at] = (uint8_t)(gw_test_random(&random) * 256.0);
            else if (kind < 0.9 && length > size / 2)
                memmove(copy + at, copy + at + 1, --length - at);
            else if (length < size * 2 - 1)
                memmove(copy + at + 1, copy + at, length++ - at);
        }
        const uint64_t told = length;
        memcpy(copy + 16, &told, sizeof told);
        fuzz_model_stream(copy, length);
    }
    free(copy);
    free(bytes);
    gw_source_model_destroy(&model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(carries_everything),
        cmocka_unit_test(refuses_every_cut),
        cmocka_unit_test(refuses_counts_beyond_the_bytes),
        cmocka_unit_test(refuses_materials_without_sense),
        cmocka_unit_test(refuses_extensions_without_sense),
        cmocka_unit_test(survives_mutations),
    };
    return cmocka_run_group_tests_name("import_stream", tests, NULL, NULL);
}
