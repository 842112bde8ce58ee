/* What the frame gate is made of: messages, swap skew, bells, what became of a process, faults for tests. */
#include "tests/support/check.h"

#include "base/clock.h"
#include "wall/bell.h"
#include "wall/gate_message.h"
#include "wall/notice.h"
#include "wall/process_state.h"
#include "wall/swap_skew.h"
#include "wall/tile_fault.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static void answers_travel_in_part_and_are_checked(void **state) {
    (void)state;
    static gw_answer answer, got;
    answer = (gw_answer){.kind = GW_ANSWER_DONE, .number = 7, .pixels = 1};
    strcpy(answer.done.text, "why not");
    const size_t size = gw_answer_size(&answer);
    assert_true(size < sizeof answer - 2000);
    memset(&got, 0xff, sizeof got);
    memcpy(&got, &answer, size);
    assert_int_equal(gw_answer_check(&got, size), 1);
    assert_string_equal(got.done.text, "why not");
    /* A text without an end is ended. */
    memset(&got, 'x', sizeof got);
    got.kind = GW_ANSWER_DONE;
    got.pixels = 0;
    assert_int_equal(gw_answer_check(&got, sizeof got), 1);
    assert_int_equal(strlen(got.done.text), sizeof got.done.text - 1);
    /* Every length that is wrong, every kind that is none. */
    const size_t head = offsetof(gw_answer, done);
    for (size_t i = 0; i <= head + offsetof(gw_done, text); i++)
        assert_int_equal(gw_answer_check(&got, i), 0);
    assert_int_equal(gw_answer_check(&got, sizeof got + 1), 0);
    got.pixels = 2;
    assert_int_equal(gw_answer_check(&got, sizeof got), 0);
    got.kind = GW_ANSWER_BEAT;
    assert_int_equal(gw_answer_size(&got), head);
    assert_int_equal(gw_answer_check(&got, head), 1);
    assert_int_equal(gw_answer_check(&got, head + 1), 0);
    got.kind = 0;
    assert_int_equal(gw_answer_check(&got, head), 0);
    static gw_release release = {.kind = GW_RELEASE_FRAME};
    assert_true(sizeof release < 512);
    assert_int_equal(gw_release_check(&release, sizeof release), 1);
    assert_int_equal(gw_release_check(&release, sizeof release - 1), 0);
    release.kind = 9;
    assert_int_equal(gw_release_check(&release, sizeof release), 0);
}

static void swap_skew_counts_frames_of_several_tiles(void **state) {
    (void)state;
    gw_swap_skew skew;
    double median, maximum;
    check_ok(gw_swap_skew_create(4, &skew, &error));
    json_t *none = gw_swap_skew_json(&skew, &median, &maximum);
    assert_true(json_is_null(none));
    gw_swap_skew_note(&skew, 0, 5000000, 0);
    gw_swap_skew_note(&skew, 0, 1000000, 0);
    gw_swap_skew_note(&skew, 0, 2000000, 3000);
    gw_swap_skew_note(&skew, 1, 9000000, 0); /* one tile alone has no skew */
    json_t *one = gw_swap_skew_json(&skew, &median, &maximum);
    assert_int_equal(json_integer_value(json_object_get(one, "frames")), 1);
    assert_true(maximum == 4 && median == 4);
    assert_true(json_real_value(json_object_get(one, "clock_error")) == 0.003);
    /* Only the last frames are kept: number 4 takes the place of 0. */
    gw_swap_skew_note(&skew, 4, 7000000, 0);
    gw_swap_skew_note(&skew, 4, 8000000, 0);
    json_t *last = gw_swap_skew_json(&skew, &median, &maximum);
    assert_true(maximum == 1);
    json_decref(one);
    json_decref(last);
    gw_swap_skew_finish(&skew);
}

static void bells_wake_and_need_nobody(void **state) {
    (void)state;
    const uint64_t nonce = 0x6761746574657374u ^ (uint64_t)getpid();
    gw_bell a, b;
    check_ok(gw_bell_open(nonce, 0, &a, &error));
    check_ok(gw_bell_open(nonce, 1, &b, &error));
    gw_bell_ring(&a, 2); /* nobody there */
    for (int i = 0; i < 1000; i++)
        gw_bell_ring(&a, 1); /* more than fit: never blocks */
    int64_t begin = gw_now_ns();
    gw_bell_wait(&b, 60 * INT64_C(1000000000), NULL, 0);
    assert_true(gw_now_ns() - begin < 30 * INT64_C(1000000000));
    gw_bell again;
    gw_error refused = {0};
    assert_int_equal(gw_bell_open(nonce, 1, &again, &refused), GW_MACHINE);
    gw_bell_close(&a);
    gw_bell_close(&b);
}

static void wait_for_state(const gw_process *process, gw_process_state wanted) {
    for (int i = 0; i < 1000 && gw_process_look(process) != wanted; i++)
        usleep(10000);
    assert_int_equal(gw_process_look(process), wanted);
}

static void processes_are_told_apart(void **state) {
    (void)state;
    pid_t child = fork();
    if (child == 0)
        for (;;)
            pause();
    const gw_process process = gw_process_find(child);
    assert_true(process.start > 0);
    wait_for_state(&process, GW_PROCESS_RUNS);
    kill(child, SIGSTOP);
    wait_for_state(&process, GW_PROCESS_STOPPED);
    kill(child, SIGCONT);
    wait_for_state(&process, GW_PROCESS_RUNS);
    kill(child, SIGKILL);
    wait_for_state(&process, GW_PROCESS_GONE); /* as a zombie already */
    waitpid(child, NULL, 0);
    assert_int_equal(gw_process_look(&process), GW_PROCESS_GONE);
    /* Another process under the same number is not it. */
    const gw_process other = {.number = getpid(), .start = gw_process_find(getpid()).start + 1};
    assert_int_equal(gw_process_look(&other), GW_PROCESS_GONE);
    const gw_process unseen = {.number = getpid()};
    assert_int_equal(gw_process_look(&unseen), GW_PROCESS_UNKNOWN);
}

static void faults_are_parsed(void **state) {
    (void)state;
    gw_tile_fault fault;
    check_ok(gw_tile_fault_parse("slow:12@345", &fault, &error));
    assert_true(fault.kind == GW_FAULT_SLOW && fault.tile == 12 && fault.frame == 345);
    static const char *const wrong[] = {"",          "slow",      "slow:1",  "slow:1@",
                                        "slow:1@2x", "sleep:1@2", "slow:x@2"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        gw_error refused = {0};
        assert_int_equal(gw_tile_fault_parse(wrong[i], &fault, &refused), GW_BAD_INPUT);
    }
    const gw_tile_fault context = {.kind = GW_FAULT_CONTEXT, .tile = 1, .frame = 2};
    gw_error lost = {0};
    check_ok(gw_tile_fault_strike(&context, 1, 1, 1, &error));
    check_ok(gw_tile_fault_strike(&context, 1, 0, 2, &error));
    assert_int_equal(gw_tile_fault_strike(&context, 1, 1, 2, &lost), GW_MACHINE);
}

static void a_notice_is_red_with_letters(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1920, 1080}, {32, 32}, {1, 1}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        gw_image image;
        check_ok(gw_notice_draw(GW_NOTICE_ENDED, sizes[i][0], sizes[i][1], "c0r0", 3,
                                "rank 0 was lost: nothing came from it for 2.0 s", &image, &error));
        size_t white = 0, red = 0, count = (size_t)sizes[i][0] * sizes[i][1];
        for (size_t k = 0; k < count; k++) {
            white += image.rgba[4 * k + 1] == 255;
            red += image.rgba[4 * k] == 160 && image.rgba[4 * k + 1] == 0;
        }
        assert_int_equal(white + red, count);
        assert_true(red > 0 && (white > 0 || count == 1));
        gw_image_finish(&image);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(answers_travel_in_part_and_are_checked),
        cmocka_unit_test(swap_skew_counts_frames_of_several_tiles),
        cmocka_unit_test(bells_wake_and_need_nobody),
        cmocka_unit_test(processes_are_told_apart),
        cmocka_unit_test(faults_are_parsed),
        cmocka_unit_test(a_notice_is_red_with_letters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
