/* Programs that are kept from run to run as binaries. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/gl.h"
#include "base/sealed_file.h"

#include <dirent.h>
#include <unistd.h>

static char folder[512];

/* What the driver's cache on disk is named by; Mesa's software offers binaries only with one. */
static int make_folder(void **state) {
    char drivers[512];
    (void)state;
    scratch_path(folder, "program-binaries");
    scratch_path(drivers, "program-binaries-driver");
    check_ok(gw_make_directories(drivers, &error));
    check_ok(gw_make_directories(folder, &error));
    setenv("MESA_SHADER_CACHE_DIR", drivers, 1);
    setenv("MESA_SHADER_CACHE_DISABLE", "false", 1);
    return 0;
}

/* Calls back for every binary in the folder, and counts them. */
static int each_binary(void (*visit)(const char *path)) {
    DIR *open = opendir(folder);
    int count = 0;
    assert_non_null(open);
    for (const struct dirent *entry; (entry = readdir(open));) {
        char path[1024];
        if (!gw_path_has_extension(entry->d_name, ".gwp"))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        count++;
        if (visit)
            visit(path);
    }
    closedir(open);
    return count;
}

static void delete_one(const char *path) {
    assert_int_equal(unlink(path), 0);
}

static void cut_one(const char *path) {
    gw_bytes file;
    check_ok(gw_file_read(path, 1 << 26, &file, &error));
    check_ok(gw_file_write(path, file.data, file.size / 2, &error));
    gw_bytes_finish(&file);
}

static void alter_one(const char *path) {
    gw_bytes file;
    check_ok(gw_file_read(path, 1 << 26, &file, &error));
    file.data[file.size / 2] ^= 1;
    check_ok(gw_file_write(path, file.data, file.size, &error));
    gw_bytes_finish(&file);
}

/* Well sealed, under its own key, and nonsense to the driver; of a format that there is, and of one that
 * there is not. */
static GLint format;
static void replace_one(const char *path) {
    uint32_t words[64] = {(uint32_t)format, 0x1234567};
    unsigned long long high, low;
    assert_int_equal(sscanf(strrchr(path, '/'), "/program-%16llx%16llx.gwp", &high, &low), 2);
    check_ok(gw_sealed_write(path, (gw_hash){high, low}, words, sizeof words, &error));
}

static gw_gl *open_device(int always) {
    gw_gl *device = NULL;
    check_ok(gw_gl_create(&(gw_gl_options){.binaries = folder, .binaries_always = always}, &device, &error));
    return device;
}

static gw_gl_program_counts make_three(gw_gl **device) {
    static const char *const names[] = {"sample/offsets.comp", "sample/scatter.comp"};
    GLuint program;
    for (size_t i = 0; i < 2; ++i)
        check_ok(gw_gl_program(*device, names[i], NULL, &program, &error));
    check_ok(gw_gl_draw_program(*device, "build/voxelise", NULL, &program, &error));
    check_ok(gw_gl_keep_programs(*device, &error));
    const gw_gl_program_counts counts = gw_gl_program_counts_of(*device);
    gw_gl_destroy(device);
    return counts;
}

static void binaries_spare_compilation(void **state) {
    (void)state;
    each_binary(delete_one);
    gw_gl *device = open_device(1);
    if (gw_gl_limits_of(device)->program_binary_formats == 0) {
        gw_gl_destroy(&device);
        print_message("# the driver offers no program binaries\n");
        skip();
    }
    glGetIntegerv(GL_PROGRAM_BINARY_FORMATS, &format); /* Mesa and NVIDIA have one */
    gw_gl_program_counts counts = make_three(&device);
    assert_int_equal(counts.compiled, 3);
    assert_int_equal(counts.read, 0);
    assert_int_equal(each_binary(NULL), 3);
    device = open_device(1);
    counts = make_three(&device);
    assert_int_equal(counts.compiled, 0);
    assert_int_equal(counts.read, 3);
}

/* Compiled anew without an error, and kept in the place of what was refused. */
static void bad_binaries_are_replaced(void **state) {
    static void (*const ways[])(const char *) = {cut_one, alter_one, replace_one, replace_one};
    (void)state;
    if (!format)
        skip();
    const GLint offered = format;
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; ++i) {
        format = i == 3 ? offered + 1 : offered;
        assert_int_equal(each_binary(ways[i]), 3);
        gw_gl *device = open_device(1);
        gw_gl_program_counts counts = make_three(&device);
        assert_int_equal(counts.refused, 3);
        assert_int_equal(counts.compiled, 3);
        device = open_device(1);
        counts = make_three(&device);
        assert_int_equal(counts.read, 3);
    }
    format = offered;
}

/* On software GL they would spare milliseconds of seconds. */
static void software_keeps_none_unless_told(void **state) {
    (void)state;
    each_binary(delete_one);
    gw_gl *device = open_device(0);
    const int software = gw_gl_limits_of(device)->software;
    const gw_gl_program_counts counts = make_three(&device);
    assert_int_equal(counts.compiled, 3);
    if (software)
        assert_int_equal(each_binary(NULL), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(binaries_spare_compilation),
        cmocka_unit_test(bad_binaries_are_replaced),
        cmocka_unit_test(software_keeps_none_unless_told),
    };
    return cmocka_run_group_tests(tests, make_folder, NULL);
}
