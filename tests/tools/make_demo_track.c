/* Writes configs/tracks/demo.vrpn anew: make_demo_track FILE. The unit test demo_track compares it bit for
 * bit. */
#include "tests/tools/demo_track.h"

#include <stdio.h>

int main(int argc, char **argv) {
    gw_error error = {0};
    if (argc != 2) {
        fprintf(stderr, "usage: make_demo_track FILE\n");
        return GW_BAD_INPUT;
    }
    gw_code code = demo_write(argv[1], &error);
    if (code != GW_OK)
        fprintf(stderr, "make_demo_track: %s\n", error.text);
    return (int)code;
}
