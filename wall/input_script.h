/* Files of recorded input: keys, buttons and pointer moves by frame, for demonstrations that steer themselves
 * and for tests.
 *
 * Lines "FRAME WORD ...", frames never falling; '#' begins a remark:
 *   0 pointer 0.5 0.5     shares of the wall as it hangs, across and down
 *   3 press W             a key: a letter, a digit, or a name such as shift, left, pageup, f1, escape
 *   9 release W
 *   9 button right down   left, right or middle; down or up
 *   12 scroll 2           notches of the wheel
 *   20 resize 800 600     px, of the window, if there is one
 *   99 close
 * Any thread. */
#ifndef GW_WALL_INPUT_SCRIPT_H
#define GW_WALL_INPUT_SCRIPT_H

#include "base/status.h"
#include "base/window.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gw_input_event {
    uint32_t frame;
    int resizes;    /* 1: event.position is the window's new size */
    gw_event event; /* a pointer's position is in shares */
} gw_input_event;

typedef struct gw_input_script {
    gw_input_event *events; /* owned */
    size_t count;
} gw_input_script;

gw_code gw_input_script_load(const char *path, gw_input_script *out, gw_error *error);
/* The same from memory; name stands for the file in messages. */
gw_code gw_input_script_parse(const char *name, const char *text, size_t size, gw_input_script *out,
                              gw_error *error);
/* 1 when an event closes the wall, by 'close' or the key escape. */
int gw_input_script_ends(const gw_input_script *script);
void gw_input_script_finish(gw_input_script *script); /* accepts an empty one */

#endif
