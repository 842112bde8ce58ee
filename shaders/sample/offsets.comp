// One group: where the samples of each group of blocks begin, how many there are, and what their batches are dispatched with.
#include "common/frame_block.glsl"
#include "sample/scan.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 2) buffer GroupSums { uvec2 group_sums[]; }; // samples, coarse blocks; out: samples before
layout(std430, binding = 3) writeonly buffer List { uint list_words[]; };
layout(std430, binding = 9) writeonly buffer Samples { uint samples[]; };
layout(location = 0) uniform uint group_count;
layout(location = 1) uniform uint batch_count;
layout(location = 2) uniform uint batch_groups; // of 64 samples

void main() {
    uint lane = gl_LocalInvocationIndex, total = 0u, coarse = 0u;
    for (uint first = 0u; first < group_count; first += 64u) {
        uint at = first + lane;
        uvec2 sums = at < group_count ? group_sums[at] : uvec2(0u);
        uint inclusive = group_inclusive_scan(sums.x);
        uint all_samples = scan_values[63];
        barrier();
        group_inclusive_scan(sums.y);
        uint all_coarse = scan_values[63];
        barrier();
        if (at < group_count)
            group_sums[at].x = total + inclusive - sums.x;
        total += all_samples;
        coarse += all_coarse;
    }
    uint groups = (total + 63u) / 64u;
    if (total + lane < groups * 64u)
        samples[total + lane] = GW_NO_SAMPLE;
    for (uint batch = lane; batch < batch_count; batch += 64u) {
        uint before = min(batch * batch_groups, groups), at = GW_LIST_ARGUMENTS + 4u * batch;
        list_words[at] = min(groups - before, batch_groups);
        list_words[at + 1u] = 1u;
        list_words[at + 2u] = 1u;
        list_words[at + 3u] = 0u;
    }
    if (lane == 0u) {
        list_words[0] = total;
        list_words[1] = groups;
        list_words[2] = coarse;
        list_words[3] = 0u;
    }
}
