/* Sealed files: contents come back; what is cut, altered or foreign is refused. Octree and scene blocks
 * inside damaged files are refused or harmless. */
#include "tests/support/check.h"

#include "base/file.h"
#include "base/sealed_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SIZE = 3000 };
static const gw_hash key = {17, 4};

static void fill(uint8_t data[SIZE]) {
    for (size_t i = 0; i < SIZE; ++i)
        data[i] = (uint8_t)(i * i / 7);
}

/* Writes the sample to a fresh file. */
static void make_file(char path[512], const char *name) {
    uint8_t data[SIZE];
    fill(data);
    scratch_path(path, name);
    check_ok(gw_sealed_write(path, key, data, SIZE, &error));
}

static void contents_come_back(void **state) {
    char path[512];
    uint8_t data[SIZE];
    gw_sealed back;
    (void)state;
    make_file(path, "sealed-round");
    fill(data);
    check_ok(gw_sealed_read(path, key, &back, &error));
    assert_int_equal(back.size, SIZE);
    assert_int_equal((uintptr_t)back.data % 64, 0);
    assert_memory_equal(back.data, data, SIZE);
    free(back.data);
    check_ok(gw_sealed_write(path, key, data, 0, &error));
    check_ok(gw_sealed_read(path, key, &back, &error));
    assert_int_equal(back.size, 0);
    free(back.data);
}

static void every_flipped_bit_is_refused(void **state) {
    char path[512];
    gw_bytes file;
    gw_sealed back;
    (void)state;
    make_file(path, "sealed-flips");
    check_ok(gw_file_read(path, 1 << 20, &file, &error));
    for (size_t bit = 0; bit < file.size * 8; ++bit) {
        file.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
        check_ok(gw_file_write(path, file.data, file.size, &error));
        file.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
        check_fails(gw_sealed_read(path, key, &back, &error), GW_BAD_INPUT, "is refused");
        assert_null(back.data);
    }
    gw_bytes_finish(&file);
}

static void every_cut_is_refused(void **state) {
    char path[512];
    gw_bytes file;
    gw_sealed back;
    (void)state;
    make_file(path, "sealed-cuts");
    check_ok(gw_file_read(path, 1 << 20, &file, &error));
    for (size_t length = 0; length < file.size; ++length) {
        check_ok(gw_file_write(path, file.data, length, &error));
        check_fails(gw_sealed_read(path, key, &back, &error), GW_BAD_INPUT, "is refused");
    }
    gw_bytes_finish(&file);
}

/* Seals the damaged bytes again, as somebody who wants to do harm would. */
static void reseal(gw_bytes *file, const char *path) {
    gw_hash sum = gw_hash_bytes((gw_hash){0, 0}, file->data, file->size - 16);
    memcpy(file->data + file->size - 16, &sum.high, 8);
    memcpy(file->data + file->size - 8, &sum.low, 8);
    check_ok(gw_file_write(path, file->data, file->size, &error));
}

/* With a right checksum: other contents of the same size, or a reason; never a read outside. */
static void resealed_damage_is_harmless(void **state) {
    char path[512];
    gw_bytes file;
    int refused = 0;
    (void)state;
    make_file(path, "sealed-lies");
    check_ok(gw_file_read(path, 1 << 20, &file, &error));
    for (size_t i = 0; i < file.size - 16; ++i) {
        gw_sealed back;
        gw_error error = {0};
        file.data[i] ^= 0x41;
        reseal(&file, path);
        if (gw_sealed_read(path, key, &back, &error) == GW_OK)
            assert_true(back.size <= SIZE);
        else
            refused++;
        free(back.data);
        file.data[i] ^= 0x41;
    }
    assert_true(refused > 48);
    gw_bytes_finish(&file);
}

static void a_wrong_key_is_refused(void **state) {
    char path[512];
    gw_sealed back;
    const gw_hash other = {17, 5};
    (void)state;
    make_file(path, "sealed-key");
    check_fails(gw_sealed_read(path, other, &back, &error), GW_BAD_INPUT, "another scene");
}

/* Programs that write the same file at once: whoever reads meanwhile finds a whole one. */
static void writers_at_once_do_no_harm(void **state) {
    enum { WRITERS = 4, ROUNDS = 50 };
    char path[512];
    uint8_t data[SIZE];
    pid_t writers[WRITERS];
    (void)state;
    make_file(path, "sealed-race");
    fill(data);
    for (int w = 0; w < WRITERS; ++w) {
        writers[w] = fork();
        assert_true(writers[w] >= 0);
        for (int i = 0; writers[w] == 0 && i < ROUNDS; ++i) {
            gw_error error = {0};
            if (gw_sealed_write(path, key, data, SIZE, &error))
                _exit(1);
        }
        if (writers[w] == 0)
            _exit(0);
    }
    for (int i = 0; i < ROUNDS; ++i) {
        gw_sealed back;
        check_ok(gw_sealed_read(path, key, &back, &error));
        assert_memory_equal(back.data, data, SIZE);
        free(back.data);
    }
    for (int w = 0; w < WRITERS; ++w) {
        int status = 1;
        waitpid(writers[w], &status, 0);
        assert_int_equal(status, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contents_come_back),     cmocka_unit_test(every_flipped_bit_is_refused),
        cmocka_unit_test(every_cut_is_refused),   cmocka_unit_test(resealed_damage_is_harmless),
        cmocka_unit_test(a_wrong_key_is_refused), cmocka_unit_test(writers_at_once_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
