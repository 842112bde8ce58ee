/* Files: limits, kinds that are refused, atomic writing, paths, and compressed data that lies. */
#include "tests/support/check.h"

#include "base/file.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

static void written_bytes_are_read_back(void **state) {
    (void)state;
    char path[512];
    scratch_path(path, "bytes.bin");
    uint8_t data[200000];
    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = (uint8_t)(i * 31);
    }
    check_ok(gw_file_write(path, data, sizeof data, &error));
    gw_bytes bytes;
    check_ok(gw_file_read(path, sizeof data, &bytes, &error));
    assert_int_equal(bytes.size, sizeof data);
    assert_memory_equal(bytes.data, data, sizeof data);
    assert_int_equal(bytes.data[bytes.size], 0);
    gw_bytes_finish(&bytes);
    assert_null(bytes.data);
    check_fails(gw_file_read(path, sizeof data - 1, &bytes, &error), GW_BAD_INPUT,
                "larger than the limit of 199999");
    unlink(path);
}

static void empty_file_is_read(void **state) {
    (void)state;
    char path[512];
    check_ok(gw_file_write(scratch_path(path, "empty"), "", 0, &error));
    gw_bytes bytes;
    check_ok(gw_file_read(path, 0, &bytes, &error));
    assert_int_equal(bytes.size, 0);
    assert_int_equal(bytes.data[0], 0);
    gw_bytes_finish(&bytes);
    unlink(path);
}

static void a_file_of_unknown_size_obeys_the_limit(void **state) {
    (void)state;
    /* Files of /proc say 0 bytes and then give more. */
    gw_bytes bytes;
    check_fails(gw_file_read("/proc/self/status", 100, &bytes, &error), GW_BAD_INPUT,
                "larger than the limit of 100");
    check_ok(gw_file_read("/proc/self/status", 100000, &bytes, &error));
    assert_true(bytes.size > 100);
    gw_bytes_finish(&bytes);
}

static void other_things_than_files_are_refused(void **state) {
    (void)state;
    char path[512];
    gw_bytes bytes;
    check_fails(gw_file_read("/", 100, &bytes, &error), GW_BAD_INPUT, "/: is a folder");
    check_fails(gw_file_read(scratch_path(path, "missing"), 100, &bytes, &error), GW_BAD_INPUT,
                "No such file");
    scratch_path(path, "fifo");
    unlink(path);
    assert_int_equal(mkfifo(path, 0600), 0);
    check_fails(gw_file_read(path, 100, &bytes, &error), GW_BAD_INPUT, "not a regular file");
    assert_false(gw_file_exists(path));
    unlink(path);
    assert_false(gw_file_exists("/"));
    assert_true(gw_file_exists("/proc/self/status"));
}

static size_t entries(const char *folder) {
    size_t count = 0;
    DIR *open = opendir(folder);
    assert_non_null(open);
    while (readdir(open)) {
        count++;
    }
    closedir(open);
    return count;
}

static void failed_writing_leaves_nothing(void **state) {
    (void)state;
    char folder[512], path[600];
    scratch_path(folder, "write");
    check_ok(gw_make_directories(folder, &error));
    snprintf(path, sizeof path, "%s/target", folder);
    check_ok(gw_make_directories(path, &error));
    size_t before = entries(folder);
    /* A folder cannot be replaced by a file. */
    check_fails(gw_file_write(path, "x", 1, &error), GW_NO_OUTPUT, "target: cannot be written");
    assert_int_equal(entries(folder), before);
    check_fails(gw_file_write("/nowhere/at/all", "x", 1, &error), GW_NO_OUTPUT, "/nowhere/at/all");
    rmdir(path);
    rmdir(folder);
}

static void writing_replaces_and_others_may_read(void **state) {
    (void)state;
    char path[512];
    scratch_path(path, "twice");
    check_ok(gw_file_write(path, "first", 5, &error));
    check_ok(gw_file_write(path, "2nd", 3, &error));
    gw_bytes bytes;
    check_ok(gw_file_read(path, 10, &bytes, &error));
    assert_string_equal((char *)bytes.data, "2nd");
    gw_bytes_finish(&bytes);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0644);
    unlink(path);
}

static void what_is_no_file_is_written_to_and_stays(void **state) {
    (void)state;
    char path[512], text[16] = "";
    struct stat status;
    scratch_path(path, "pipe");
    unlink(path);
    assert_int_equal(mkfifo(path, 0600), 0);
    int reader = open(path, O_RDONLY | O_NONBLOCK);
    assert_true(reader >= 0);
    check_ok(gw_file_writable(path, &error));
    check_ok(gw_file_write(path, "through", 7, &error));
    assert_int_equal(read(reader, text, sizeof text), 7);
    assert_string_equal(text, "through");
    assert_int_equal(lstat(path, &status), 0);
    assert_true(S_ISFIFO(status.st_mode));
    close(reader);
    unlink(path);
}

static void a_link_stays_a_link(void **state) {
    (void)state;
    char path[512], link[512];
    struct stat status;
    check_ok(gw_file_write(scratch_path(path, "linked"), "old", 3, &error));
    scratch_path(link, "link");
    unlink(link);
    assert_int_equal(symlink("linked", link), 0);
    check_ok(gw_file_writable(link, &error));
    check_ok(gw_file_write(link, "new", 3, &error));
    assert_int_equal(lstat(link, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    gw_bytes bytes;
    check_ok(gw_file_read(path, 10, &bytes, &error));
    assert_string_equal((char *)bytes.data, "new");
    gw_bytes_finish(&bytes);
    unlink(link);
    unlink(path);
}

static void places_that_cannot_be_written_are_told_before(void **state) {
    (void)state;
    char path[512], below[600];
    check_ok(gw_file_writable(NULL, &error));
    check_ok(gw_file_writable(scratch_path(path, "to-be"), &error));
    assert_false(gw_file_exists(path));
    check_fails(gw_file_writable("/nowhere/at/all", &error), GW_NO_OUTPUT, "/nowhere/at/all");
    check_fails(gw_file_writable("/", &error), GW_NO_OUTPUT, "Is a directory");
    check_ok(gw_file_write(path, "x", 1, &error));
    check_ok(gw_file_writable(path, &error));
    snprintf(below, sizeof below, "%s/below", path);
    check_fails(gw_file_writable(below, &error), GW_NO_OUTPUT, "Not a directory");
    unlink(path);
}

static void folders_are_made_with_parents(void **state) {
    (void)state;
    char path[512], file[600];
    scratch_path(path, "a/b//c/");
    check_ok(gw_make_directories(path, &error));
    check_ok(gw_make_directories(path, &error));
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_true(S_ISDIR(status.st_mode));
    snprintf(file, sizeof file, "%sfile", path);
    check_ok(gw_file_write(file, "x", 1, &error));
    snprintf(file, sizeof file, "%sfile/d", path);
    check_fails(gw_make_directories(file, &error), GW_NO_OUTPUT, "the folder cannot be made");
    snprintf(file, sizeof file, "%sfile", path);
    unlink(file);
    rmdir(path);
}

static void check_text(char *got, const char *wanted) {
    assert_string_equal(got, wanted);
    free(got);
}

static void paths_are_taken_apart_and_joined(void **state) {
    (void)state;
    check_text(gw_path_join("a", "b"), "a/b");
    check_text(gw_path_join("a/", "b"), "a/b");
    check_text(gw_path_join("", "b"), "b");
    check_text(gw_path_join("a", "/b"), "/b");
    check_text(gw_path_folder("a/b/c"), "a/b");
    check_text(gw_path_folder("/c"), "/");
    check_text(gw_path_folder("c"), ".");
    assert_string_equal(gw_path_name("a/b.c"), "b.c");
    assert_string_equal(gw_path_name("b.c"), "b.c");
    assert_true(gw_path_has_extension("a.PLY.gz", ".ply.gz"));
    assert_false(gw_path_has_extension("a.ply", ".gz"));
    assert_false(gw_path_has_extension(".gz", ".gz"));
}

/* gzip of `count` bytes of value 'A'; returns its size. */
static size_t compress_letters(size_t count, uint8_t *out, size_t room) {
    z_stream stream = {0};
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    uint8_t letters[4096];
    memset(letters, 'A', sizeof letters);
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    while (count > 0) {
        size_t part = count < sizeof letters ? count : sizeof letters;
        stream.next_in = letters;
        stream.avail_in = (uInt)part;
        assert_int_equal(deflate(&stream, Z_NO_FLUSH), Z_OK);
        count -= part;
    }
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    size_t size = stream.total_out;
    deflateEnd(&stream);
    return size;
}

static void gzip_is_expanded_up_to_the_limit(void **state) {
    (void)state;
    static uint8_t packed[1 << 20];
    size_t size = compress_letters(300000, packed, sizeof packed);
    gw_bytes bytes;
    check_ok(gw_gunzip(packed, size, 300000, "letters.gz", &bytes, &error));
    assert_int_equal(bytes.size, 300000);
    assert_int_equal(bytes.data[299999], 'A');
    assert_int_equal(bytes.data[300000], 0);
    gw_bytes_finish(&bytes);
    check_fails(gw_gunzip(packed, size, 299999, "letters.gz", &bytes, &error), GW_BAD_INPUT,
                "limit of 299999 bytes");
    assert_null(bytes.data);
}

static void gzip_of_two_members_is_one_text(void **state) {
    (void)state;
    static uint8_t packed[1 << 16];
    size_t size = compress_letters(1000, packed, sizeof packed);
    size += compress_letters(500, packed + size, sizeof packed - size);
    gw_bytes bytes;
    check_ok(gw_gunzip(packed, size, 5000, "two.gz", &bytes, &error));
    assert_int_equal(bytes.size, 1500);
    gw_bytes_finish(&bytes);
}

static void gzip_bomb_stops_early(void **state) {
    (void)state;
    /* 256 MiB in about 250 KiB; allowed are 64 KiB. */
    static uint8_t packed[1 << 20];
    size_t size = compress_letters((size_t)256 << 20, packed, sizeof packed);
    assert_true(size < (1 << 19));
    gw_bytes bytes;
    check_fails(gw_gunzip(packed, size, 65536, "bomb.gz", &bytes, &error), GW_BAD_INPUT,
                "bomb.gz: expands to more");
}

static void broken_gzip_is_named(void **state) {
    (void)state;
    uint8_t packed[4096];
    size_t size = compress_letters(10000, packed, sizeof packed);
    gw_bytes bytes;
    for (size_t cut = 0; cut < size; cut++) {
        check_fails(gw_gunzip(packed, cut, 20000, "cut.gz", &bytes, &error), GW_BAD_INPUT,
                    "cut.gz: the compressed");
    }
    for (size_t i = 0; i < size; i++) {
        /* Any flipped bit either shows or lies in the header's free fields; it never crashes or passes the
         * limit. */
        packed[i] ^= 0x10;
        gw_error error = {0};
        if (!gw_gunzip(packed, size, 20000, "bent.gz", &bytes, &error)) {
            assert_int_equal(bytes.size, 10000);
            gw_bytes_finish(&bytes);
        }
        packed[i] ^= 0x10;
    }
    check_fails(gw_gunzip("plain text", 10, 100, "text.gz", &bytes, &error), GW_BAD_INPUT, "text.gz");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(written_bytes_are_read_back),
        cmocka_unit_test(empty_file_is_read),
        cmocka_unit_test(a_file_of_unknown_size_obeys_the_limit),
        cmocka_unit_test(other_things_than_files_are_refused),
        cmocka_unit_test(failed_writing_leaves_nothing),
        cmocka_unit_test(writing_replaces_and_others_may_read),
        cmocka_unit_test(what_is_no_file_is_written_to_and_stays),
        cmocka_unit_test(a_link_stays_a_link),
        cmocka_unit_test(places_that_cannot_be_written_are_told_before),
        cmocka_unit_test(folders_are_made_with_parents),
        cmocka_unit_test(paths_are_taken_apart_and_joined),
        cmocka_unit_test(gzip_is_expanded_up_to_the_limit),
        cmocka_unit_test(gzip_of_two_members_is_one_text),
        cmocka_unit_test(gzip_bomb_stops_early),
        cmocka_unit_test(broken_gzip_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
