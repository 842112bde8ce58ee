#include "wall/gate_message.h"

#include <string.h>

size_t gw_answer_size(const gw_answer *answer) {
    if (answer->kind != GW_ANSWER_DONE)
        return offsetof(gw_answer, done);
    return offsetof(gw_answer, done) + offsetof(gw_done, text) +
           strnlen(answer->done.text, sizeof answer->done.text - 1) + 1;
}

int gw_answer_check(gw_answer *answer, size_t size) {
    const size_t head = offsetof(gw_answer, done), text = head + offsetof(gw_done, text);
    if (size < head)
        return 0;
    if (answer->kind == GW_ANSWER_BEAT || answer->kind == GW_ANSWER_LEFT)
        return size == head;
    if (answer->kind != GW_ANSWER_DONE || size <= text || size > sizeof *answer || answer->pixels > 1)
        return 0;
    answer->done.text[size - text - 1] = '\0';
    return 1;
}

int gw_release_check(const gw_release *release, size_t size) {
    return size == sizeof *release && release->kind >= GW_RELEASE_FRAME && release->kind <= GW_RELEASE_SITE;
}
