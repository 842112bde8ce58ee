/* libFuzzer: rows of a recording in CSV, behind a good line of columns. */
#include "tests/fuzz/recording_entry.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char head[] =
        "arrival_s,sender,kind,sensor,device_s,latency_s,quality,x,y,z,qx,qy,qz,qw,dx,dy,dz,"
        "openness,frame,value\n";
    const size_t before = sizeof head - 1;
    uint8_t *text = malloc(before + size);
    if (text == NULL)
        return 0;
    memcpy(text, head, before);
    memcpy(text + before, data, size);
    fuzz_recording(text, before + size);
    free(text);
    return 0;
}
