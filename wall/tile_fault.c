#include "wall/tile_fault.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *const kinds[] = {"kill", "stop", "hang", "slow", "context", "die"};
enum { KINDS = sizeof kinds / sizeof *kinds, SLOW_MS = 200 };

gw_code gw_tile_fault_parse(const char *text, gw_tile_fault *out, gw_error *error) {
    char kind[16] = "", rest = 0;
    if (sscanf(text, "%15[a-z]:%" SCNu32 "@%" SCNu32 "%c", kind, &out->tile, &out->frame, &rest) == 3)
        for (int i = 0; i < KINDS; i++)
            if (!strcmp(kind, kinds[i])) {
                out->kind = (gw_tile_fault_kind)i;
                return GW_OK;
            }
    return gw_fail(error, GW_BAD_INPUT,
                   "--tile-fault '%s' is not KIND:TILE@FRAME with kill, die, stop, hang, slow or context",
                   text);
}

gw_code gw_tile_fault_strike(const gw_tile_fault *faults, uint32_t count, uint32_t tile, uint32_t frame,
                             gw_error *error) {
    for (uint32_t i = 0; i < count; i++) {
        const gw_tile_fault *fault = &faults[i];
        if (fault->tile != tile ||
            (fault->kind == GW_FAULT_SLOW || fault->kind == GW_FAULT_DIE ? frame < fault->frame
                                                                         : frame != fault->frame))
            continue;
        switch (fault->kind) {
        case GW_FAULT_KILL:
        case GW_FAULT_DIE:
            raise(SIGKILL);
            break;
        case GW_FAULT_STOP:
            raise(SIGSTOP);
            break;
        case GW_FAULT_HANG:
            for (;;)
                pause();
        case GW_FAULT_SLOW:
            nanosleep(&(struct timespec){.tv_nsec = SLOW_MS * 1000000}, NULL);
            break;
        case GW_FAULT_CONTEXT:
            return gw_fail(error, GW_MACHINE, "the GL context was lost (asked for by --tile-fault)");
        }
    }
    return GW_OK;
}
