/* The GL device: limits, buffers, dispatch in slices, programs and their errors, the float environment. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/gl.h"
#include "base/gl_probe.h"

static gw_gl *device;
static int driver_messages;

static void on_line(void *context, gw_log_level level, const char *text) {
    (void)context;
    (void)level;
    driver_messages += strncmp(text, "GL: ", 4) == 0;
}

static const gw_log log_of_test = {.threshold = GW_LOG_DEBUG, .line = on_line};

static void put(const char *name, const char *text) {
    char path[512];
    gw_error error = {0};
    scratch_path(path, "shaders");
    assert_int_equal(gw_make_directories(path, &error), GW_OK);
    char *file = gw_path_join(path, name);
    assert_int_equal(gw_file_write(file, text, strlen(text), &error), GW_OK);
    free(file);
}

static int open_device(void **state) {
    (void)state;
    char folder[512];
    gw_gl_options options = {
        .shader_folder = scratch_path(folder, "shaders"), .debug = 1, .log = &log_of_test};
    gw_error error = {0};
    if (gw_gl_create(&options, &device, &error)) {
        print_error("%s\n", error.text);
        return -1;
    }
    return 0;
}

static int close_device(void **state) {
    (void)state;
    gw_gl_destroy(&device);
    gw_gl_destroy(&device);
    return device ? -1 : 0;
}

static void limits_are_at_least_what_the_standard_promises(void **state) {
    (void)state;
    const gw_gl_limits *limits = gw_gl_limits_of(device);
    assert_true(limits->vendor[0] && limits->renderer[0] && limits->version[0]);
    assert_true(limits->storage_block_bytes >= 1 << 24);
    assert_true(limits->texture_buffer_texels >= 65536);
    assert_true(limits->work_groups[0] >= 65535 && limits->work_groups[1] >= 65535 &&
                limits->work_groups[2] >= 65535);
    assert_true(limits->work_group_invocations >= 1024);
    assert_true(limits->shared_bytes >= 32768);
    assert_true(limits->storage_blocks >= 8 && limits->texture_units >= 16);
    assert_true(limits->texture_side >= 16384 && limits->texture_layers >= 2048);
    print_message("# %s: block %lld bytes, %lld texels, %d blocks, %d units, software %d\n", limits->renderer,
                  (long long)limits->storage_block_bytes, (long long)limits->texture_buffer_texels,
                  limits->storage_blocks, limits->texture_units, limits->software);
}

static void buffers_keep_their_bytes(void **state) {
    (void)state;
    static const size_t sizes[] = {1, 15, 16, 17, 4096, 100003};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        uint8_t *before = malloc(sizes[i]), *after = malloc(sizes[i]);
        for (size_t j = 0; j < sizes[i]; j++) {
            before[j] = (uint8_t)(j * 37 + 1);
        }
        gw_gl_buffer buffer;
        check_ok(gw_gl_buffer_create(device, "bytes", sizes[i], before, 0, &buffer, &error));
        check_ok(gw_gl_buffer_read(&buffer, 0, sizes[i], after, &error));
        assert_memory_equal(before, after, sizes[i]);
        before[sizes[i] / 2] = 0;
        check_ok(gw_gl_buffer_write(&buffer, sizes[i] / 2, 1, before + sizes[i] / 2, &error));
        check_ok(gw_gl_buffer_read(&buffer, 0, sizes[i], after, &error));
        assert_memory_equal(before, after, sizes[i]);
        check_fails(gw_gl_buffer_read(&buffer, 1, sizes[i], after, &error), GW_MACHINE, "buffer 'bytes'");
        check_fails(gw_gl_buffer_write(&buffer, SIZE_MAX, 2, after, &error), GW_MACHINE, "is outside");
        gw_gl_buffer_finish(&buffer);
        gw_gl_buffer_finish(&buffer);
        free(before);
        free(after);
    }
}

static void fresh_buffers_are_zero(void **state) {
    (void)state;
    /* Dirty memory first, so that zeros are not luck. */
    enum { SIZE = 1 << 20 };
    uint8_t *bytes = malloc(SIZE);
    gw_gl_buffer buffer;
    for (int round = 0; round < 4; round++) {
        memset(bytes, 0xee, SIZE);
        check_ok(gw_gl_buffer_create(device, "dirty", SIZE, bytes, 0, &buffer, &error));
        gw_gl_buffer_finish(&buffer);
        check_ok(gw_gl_buffer_create(device, "fresh", SIZE, NULL, 0, &buffer, &error));
        check_ok(gw_gl_buffer_read(&buffer, 0, SIZE, bytes, &error));
        for (size_t i = 0; i < SIZE; i++) {
            assert_int_equal(bytes[i], 0);
        }
        gw_gl_buffer_finish(&buffer);
    }
    free(bytes);
    check_ok(gw_gl_buffer_create(device, "nothing", 0, NULL, 0, &buffer, &error));
    assert_int_equal(buffer.size, 16);
    gw_gl_buffer_finish(&buffer);
}

static void buffers_beyond_the_limit_are_refused_with_numbers(void **state) {
    (void)state;
    const gw_gl_limits *limits = gw_gl_limits_of(device);
    char part[128];
    gw_gl_buffer buffer;
    size_t size = (size_t)limits->storage_block_bytes + 1;
    snprintf(part, sizeof part,
             "buffer 'nodes' needs %.1f MiB, the driver's limit for a storage block is %.1f MiB",
             (double)size / 1048576.0, (double)limits->storage_block_bytes / 1048576.0);
    check_fails(gw_gl_buffer_create(device, "nodes", size, NULL, 0, &buffer, &error), GW_MACHINE, part);
    assert_int_equal(buffer.id, 0);
    size = ((size_t)limits->texture_buffer_texels + 1) * 4;
    check_fails(gw_gl_buffer_create(device, "list", size, NULL, GL_R32UI, &buffer, &error), GW_MACHINE,
                "limit for a buffer texture");
    check_fails(gw_gl_buffer_create(device, "odd", 64, NULL, GL_DEPTH_COMPONENT24, &buffer, &error),
                GW_MACHINE, "buffer 'odd': format");
}

static void every_group_of_a_sliced_dispatch_runs_once(void **state) {
    (void)state;
    put("slices.comp", "layout(local_size_x = 1) in;\n"
                       "layout(std430, binding = 0) buffer hits { uint hit[]; };\n"
                       "uniform uint group_base;\n"
                       "void main() { atomicAdd(hit[group_base + gl_WorkGroupID.x], 1u); }\n");
    enum { GROUPS = 2 * 65535 + 77 };
    GLuint program = 0;
    gw_gl_buffer buffer;
    check_ok(gw_gl_program(device, "slices.comp", NULL, &program, &error));
    check_ok(gw_gl_buffer_create(device, "hits", (GROUPS + 1) * 4, NULL, 0, &buffer, &error));
    gw_gl_buffer_bind(&buffer, 0);
    check_ok(gw_gl_dispatch(device, program, GROUPS, &error));
    check_ok(gw_gl_dispatch(device, program, 0, &error));
    uint32_t *hits = malloc((GROUPS + 1) * 4);
    check_ok(gw_gl_buffer_read(&buffer, 0, (GROUPS + 1) * 4, hits, &error));
    for (uint32_t i = 0; i < GROUPS; i++) {
        assert_int_equal(hits[i], 1);
    }
    assert_int_equal(hits[GROUPS], 0);
    free(hits);
    gw_gl_buffer_finish(&buffer);
}

static void too_many_groups_without_a_base_are_refused(void **state) {
    (void)state;
    put("no_base.comp", "layout(local_size_x = 1) in;\n"
                        "layout(std430, binding = 0) buffer hits { uint hit[]; };\n"
                        "void main() { hit[0] = 1u; }\n");
    GLuint program = 0;
    check_ok(gw_gl_program(device, "no_base.comp", NULL, &program, &error));
    check_fails(gw_gl_dispatch(device, program, 70000, &error), GW_MACHINE,
                "program 'no_base.comp': 70000 work groups are more than 65535");
}

static void a_program_is_compiled_once_per_defines(void **state) {
    (void)state;
    put("value.comp", "layout(local_size_x = 1) in;\n"
                      "layout(std430, binding = 0) buffer values { uint value; };\n"
                      "uniform uint addend;\n"
                      "void main() { value = uint(VALUE) + addend; }\n");
    GLuint first = 0, again = 0, other = 0;
    check_ok(gw_gl_program(device, "value.comp", "#define VALUE 7\n", &first, &error));
    check_ok(gw_gl_program(device, "value.comp", "#define VALUE 7\n", &again, &error));
    check_ok(gw_gl_program(device, "value.comp", "#define VALUE 8\n", &other, &error));
    assert_int_equal(first, again);
    assert_int_not_equal(first, other);
    GLint addend = -1;
    check_ok(gw_gl_uniform(other, "addend", &addend, &error));
    assert_true(addend >= 0);
    check_fails(gw_gl_uniform(other, "missing", &addend, &error), GW_MACHINE,
                "program 'value.comp' has no uniform 'missing'");
    gw_gl_buffer buffer;
    check_ok(gw_gl_buffer_create(device, "value", 4, NULL, 0, &buffer, &error));
    gw_gl_buffer_bind(&buffer, 0);
    check_ok(gw_gl_uniform(other, "addend", &addend, &error));
    glProgramUniform1ui(other, addend, 100);
    check_ok(gw_gl_dispatch(device, other, 1, &error));
    check_ok(gw_gl_finish(device, &error));
    uint32_t value = 0;
    check_ok(gw_gl_buffer_read(&buffer, 0, 4, &value, &error));
    assert_int_equal(value, 108);
    gw_gl_buffer_finish(&buffer);
}

static void a_buffer_texture_shows_the_whole_buffer(void **state) {
    (void)state;
    put("fetch.comp", "layout(local_size_x = 1) in;\n"
                      "layout(binding = 3) uniform usamplerBuffer texels;\n"
                      "layout(std430, binding = 0) buffer sums { uint sum; };\n"
                      "void main() { sum = uint(textureSize(texels)) * 1000u + texelFetch(texels, 2).y; }\n");
    const uint32_t words[8] = {0, 1, 2, 3, 4, 55, 6, 7};
    gw_gl_buffer texels, sum;
    GLuint program = 0;
    check_ok(gw_gl_program(device, "fetch.comp", NULL, &program, &error));
    check_ok(gw_gl_buffer_create(device, "texels", sizeof words, words, GL_RG32UI, &texels, &error));
    check_ok(gw_gl_buffer_create(device, "sum", 4, NULL, 0, &sum, &error));
    gw_gl_texture_bind(&texels, 3);
    gw_gl_buffer_bind(&sum, 0);
    check_ok(gw_gl_dispatch(device, program, 1, &error));
    uint32_t value = 0;
    check_ok(gw_gl_buffer_read(&sum, 0, 4, &value, &error));
    assert_int_equal(value, 4055);
    gw_gl_buffer_finish(&texels);
    gw_gl_buffer_finish(&sum);
}

/* Storage comes back, larger than asked for and full of what was there: neither may be seen. */
static void the_pool_gives_clean_buffers_of_their_size(void **state) {
    (void)state;
    enum { SIZE = 100000, SMALLER = 98316 };
    put("size.comp", "layout(local_size_x = 1) in;\n"
                     "layout(binding = 3) uniform usamplerBuffer texels;\n"
                     "layout(std430, binding = 0) buffer rows { uint row[]; };\n"
                     "void main() { row[0] = uint(row.length()); row[1] = uint(textureSize(texels)); }\n");
    uint8_t *bytes = malloc(SIZE);
    gw_gl_buffer buffer, texels;
    GLuint program = 0;
    assert_non_null(bytes);
    check_ok(gw_gl_program(device, "size.comp", NULL, &program, &error));
    gw_gl_pool_start(device);
    memset(bytes, 0xee, SIZE);
    check_ok(gw_gl_buffer_create(device, "dirty", SIZE, bytes, 0, &buffer, &error));
    check_ok(gw_gl_buffer_create(device, "dirty too", SIZE, bytes, GL_R32UI, &texels, &error));
    gw_gl_buffer_finish(&buffer);
    gw_gl_buffer_finish(&texels);
    const gw_gl_pool_counts before = gw_gl_pool_counts_of(device);
    assert_true(before.idle_bytes >= 2 * SIZE && before.idle_bytes <= 5 * SIZE / 2);
    check_ok(gw_gl_buffer_create(device, "clean", SMALLER, NULL, 0, &buffer, &error));
    check_ok(gw_gl_buffer_create(device, "clean too", SMALLER, NULL, GL_R32UI, &texels, &error));
    const gw_gl_pool_counts after = gw_gl_pool_counts_of(device);
    assert_int_equal(after.made, before.made);
    assert_int_equal(after.reused, before.reused + 2);
    assert_int_equal(after.idle_bytes, 0);
    check_ok(gw_gl_buffer_read(&buffer, 0, SMALLER, bytes, &error));
    for (size_t i = 0; i < SMALLER; i++)
        assert_int_equal(bytes[i], 0);
    check_fails(gw_gl_buffer_read(&buffer, SMALLER, 1, bytes, &error), GW_MACHINE, "is outside");
    gw_gl_buffer_bind(&buffer, 0);
    gw_gl_texture_bind(&texels, 3);
    check_ok(gw_gl_dispatch(device, program, 1, &error));
    uint32_t counts[2];
    check_ok(gw_gl_buffer_read(&buffer, 0, sizeof counts, counts, &error));
    assert_int_equal(counts[0], (SMALLER + 15) / 16 * 4); /* whole granules of 16 bytes */
    assert_int_equal(counts[1], (SMALLER + 15) / 16 * 4);
    gw_gl_buffer other; /* far smaller: the large storage is not wasted on it */
    gw_gl_buffer_finish(&texels);
    check_ok(gw_gl_buffer_create(device, "small", 64, NULL, 0, &other, &error));
    assert_int_equal(gw_gl_pool_counts_of(device).idle_bytes, before.idle_bytes / 2);
    gw_gl_buffer_finish(&other);
    gw_gl_pool_stop(device);
    assert_int_equal(gw_gl_pool_counts_of(device).idle_bytes, 0);
    gw_gl_buffer_finish(&buffer);
    assert_int_equal(gw_gl_pool_counts_of(device).idle_bytes, 0);
    free(bytes);
}

static void compile_errors_name_file_and_line(void **state) {
    (void)state;
    put("broken.comp", "layout(local_size_x = 1) in;\n#include \"broken.glsl\"\nvoid main() { wrong(); }\n");
    put("broken.glsl", "\n\nvoid wrong() { int x = undeclared_thing; }\n");
    GLuint program = 0;
    check_fails(gw_gl_program(device, "broken.comp", NULL, &program, &error), GW_MACHINE,
                "shaders/broken.comp does not compile");
    check_fails(gw_gl_program(device, "broken.comp", NULL, &program, &error), GW_MACHINE,
                "shaders/broken.glsl:3");
    check_fails(gw_gl_program(device, "broken.comp", NULL, &program, &error), GW_MACHINE, "undeclared_thing");
    assert_int_equal(program, 0);
    put("after.comp",
        "layout(local_size_x = 1) in;\n#include \"fine.glsl\"\n\nvoid main() { second_mistake(); }\n");
    put("fine.glsl", "int fine;\n\n\n\n\n");
    check_fails(gw_gl_program(device, "after.comp", NULL, &program, &error), GW_MACHINE,
                "shaders/after.comp:4");
    char text[16384] =
        "layout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer b { int out_word; };\n"
        "void main() {\nint unset;\n";
    for (int i = 0; i < 100; i++) {
        strcat(text, "out_word += unset; // of which the driver warns each time\n");
    }
    strcat(text, "third_mistake();\n}\n");
    put("warned.comp", text);
    check_fails(gw_gl_program(device, "warned.comp", NULL, &program, &error), GW_MACHINE,
                "shaders/warned.comp:105");
    check_fails(gw_gl_program(device, "absent.comp", NULL, &program, &error), GW_BAD_INPUT, "absent.comp");
}

static void gl_errors_are_reported_once(void **state) {
    (void)state;
    check_ok(gw_gl_check("a clean place", &error));
    int before = driver_messages;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 100000, 0);
    check_fails(gw_gl_check("a wrong binding", &error), GW_MACHINE,
                "GL error at a wrong binding: invalid value");
    check_ok(gw_gl_check("afterwards", &error));
    assert_true(driver_messages > before);
}

static void two_devices_live_side_by_side(void **state) {
    (void)state;
    gw_gl *second = NULL;
    check_ok(gw_gl_create(NULL, &second, &error));
    gw_float_environment facts;
    check_ok(gw_gl_probe_floats(second, &facts, &error));
    gw_gl_destroy(&second);
    /* The first one is not current any more, but it must still be whole: a new one on the same display proves
     * that the display lives, and takes its place for the tests to come. */
    gw_gl_destroy(&device);
    assert_int_equal(open_device(NULL), 0);
    check_ok(gw_gl_finish(device, &error));
}

/* Facts that the octree and the watertight test rely on; the others are only told. */
static void precise_floats_are_rounded_twice(void **state) {
    (void)state;
    gw_gl *embedded = NULL;
    check_ok(gw_gl_create(NULL, &embedded, &error));
    gw_float_environment facts;
    check_ok(gw_gl_probe_floats(embedded, &facts, &error));
    print_message(
        "# contracts %d, precise holds %d, fma fused %d, denormals kept %d, division wrong %u, sqrt wrong %u "
        "of %d, infinity kept %d, NaN kept %d\n",
        facts.contracts, facts.precise_holds, facts.fma_fused, facts.denormals_kept, facts.division_wrong,
        facts.sqrt_wrong, GW_PROBE_SAMPLES, facts.infinity_kept, facts.nan_kept);
    assert_true(facts.precise_holds);
    assert_true(facts.infinity_kept);
    gw_gl_destroy(&embedded);
}

static GLuint variant_program(uint64_t key, const char *defines) {
    GLuint program = 0;
    gw_gl_variant_begin(device, (gw_hash){7, key});
    check_ok(gw_gl_program(device, "variant.comp", defines, &program, &error));
    gw_gl_variant_end(device);
    return program;
}

static void at_most_eight_variants_are_alive(void **state) {
    (void)state;
    char line[64];
    GLuint kept = 0, shared;
    put("variant.comp", "layout(local_size_x = 1) in;\n"
                        "layout(std430, binding = 0) buffer Out { uint values[]; };\n"
                        "void main() { values[0] = uint(N); }\n");
    check_ok(gw_gl_program(device, "variant.comp", "#define N 100\n", &kept, &error));
    const gw_gl_variant_counts before = gw_gl_variant_counts_of(device);
    assert_int_equal(before.alive, 0);
    shared = variant_program(0, "#define N 50\n");
    for (uint64_t i = 0; i < GW_GL_VARIANTS; ++i) {
        snprintf(line, sizeof line, "#define N %d\n", (int)i);
        variant_program(i, line);
        assert_int_equal(variant_program(i, "#define N 50\n"), shared);
        assert_int_equal(variant_program(i, "#define N 100\n"), kept);
    }
    gw_gl_variant_counts counts = gw_gl_variant_counts_of(device);
    assert_int_equal(counts.alive, GW_GL_VARIANTS);
    assert_int_equal(counts.programs, before.programs + GW_GL_VARIANTS + 1);
    assert_int_equal(counts.deleted, before.deleted);
    /* The first one is used once more, so the second makes room: for its own program, not for the shared one.
     */
    variant_program(0, "#define N 0\n");
    variant_program(99, "#define N 99\n");
    counts = gw_gl_variant_counts_of(device);
    assert_int_equal(counts.alive, GW_GL_VARIANTS);
    assert_int_equal(counts.deleted, before.deleted + 1);
    assert_int_equal(counts.programs, before.programs + GW_GL_VARIANTS + 1);
    variant_program(0, "#define N 0\n");
    variant_program(2, "#define N 2\n");
    assert_int_equal(gw_gl_variant_counts_of(device).deleted, counts.deleted);
    assert_true(glIsProgram(kept) && glIsProgram(shared));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limits_are_at_least_what_the_standard_promises),
        cmocka_unit_test(buffers_keep_their_bytes),
        cmocka_unit_test(fresh_buffers_are_zero),
        cmocka_unit_test(buffers_beyond_the_limit_are_refused_with_numbers),
        cmocka_unit_test(every_group_of_a_sliced_dispatch_runs_once),
        cmocka_unit_test(too_many_groups_without_a_base_are_refused),
        cmocka_unit_test(a_program_is_compiled_once_per_defines),
        cmocka_unit_test(a_buffer_texture_shows_the_whole_buffer),
        cmocka_unit_test(the_pool_gives_clean_buffers_of_their_size),
        cmocka_unit_test(at_most_eight_variants_are_alive),
        cmocka_unit_test(compile_errors_name_file_and_line),
        cmocka_unit_test(gl_errors_are_reported_once),
        cmocka_unit_test(two_devices_live_side_by_side),
        cmocka_unit_test(precise_floats_are_rounded_twice),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
