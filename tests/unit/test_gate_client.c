/* A tile's end of the frame gate, on a line that the test plays. */
#include "tests/support/check.h"

#include "wall/gate_client.h"

#include <string.h>

/* A line to rank 0 over which `coming` comes, one message at each look, and on which blocks of pixels take
 * `looks` looks. */
typedef struct {
    gw_wire wire; /* first: the gate client knows only this */
    gw_release coming[4];
    uint32_t count, next, looks;
} played_line;

static gw_wire_result take_message(gw_wire *wire, const void *message, size_t size) {
    (void)wire, (void)message, (void)size;
    return GW_WIRE_DONE;
}

static gw_wire_result give_message(gw_wire *wire, void *message, size_t *size) {
    played_line *line = (played_line *)wire;
    if (line->next == line->count)
        return GW_WIRE_NOT_YET;
    *size = sizeof(gw_release);
    memcpy(message, &line->coming[line->next++], sizeof(gw_release));
    return GW_WIRE_DONE;
}

static gw_wire_result take_block(gw_wire *wire, const void *block, size_t size) {
    played_line *line = (played_line *)wire;
    (void)block, (void)size;
    if (line->looks == 0)
        return GW_WIRE_DONE;
    line->looks--;
    return GW_WIRE_NOT_YET;
}

static gw_wire_result give_block(gw_wire *wire, void *block, size_t size) {
    (void)wire, (void)block, (void)size;
    return GW_WIRE_NOT_YET;
}

static int is_sent(gw_wire *wire) {
    (void)wire;
    return 1;
}

static void close_line(gw_wire *wire) {
    (void)wire;
}

static played_line play(void) {
    return (played_line){.wire = {.send = take_message,
                                  .receive = give_message,
                                  .send_block = take_block,
                                  .receive_block = give_block,
                                  .is_sent = is_sent,
                                  .close = close_line,
                                  .descriptor = -1}};
}

/* Rank 0 has the last frame's pixels, and quits, before the tile has seen that they are sent. */
static void the_end_overtakes_pixels(void **state) {
    (void)state;
    played_line line = play();
    line.coming[0] = (gw_release){.kind = GW_RELEASE_QUIT, .number = 1};
    line.count = 1;
    line.looks = 3;
    gw_gate_client client = {0};
    gw_gate_client_join(&client, &line.wire, 1, 0);
    static gw_done done;
    static const uint8_t pixels[16];
    check_ok(gw_gate_client_answer(&client, &done, pixels, sizeof pixels, &error));
    assert_int_equal(line.looks, 0);
    gw_release release;
    check_ok(gw_gate_client_wait(&client, &release, &error));
    assert_int_equal(release.kind, GW_RELEASE_QUIT);
    gw_gate_client_leave(&client);
    gw_gate_client_close(&client);
}

/* Rank 0 said that it would be heard again within 30 ms, and is not. */
static void silence_beyond_what_was_said_is_a_loss(void **state) {
    (void)state;
    played_line line = play();
    line.coming[0] = (gw_release){.kind = GW_RELEASE_PONG, .silence_ms = 30};
    line.count = 1;
    gw_gate_client client = {0};
    gw_gate_client_join(&client, &line.wire, 1, 0);
    gw_release release;
    gw_error lost = {0};
    assert_int_equal(gw_gate_client_wait(&client, &release, &lost), GW_ENDED_EARLY);
    assert_non_null(strstr(lost.text, "rank 0 was lost: nothing came from it"));
    gw_gate_client_close(&client);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_end_overtakes_pixels),
        cmocka_unit_test(silence_beyond_what_was_said_is_a_loss),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
