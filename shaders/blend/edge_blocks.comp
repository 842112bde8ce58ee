// Which blocks of the chunk have silhouettes or creases between their samples: only those are made by the edge-aware kernel, which
// changes no pixel of the others. One group looks at one block.
//
// variants:
#define EDGE_AWARE 1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
uniform uint group_base;
#include "common/small_math.glsl"
#include "blend/samples.glsl"
#include "blend/cells.glsl"
#include "blend/guides.glsl"
#include "blend/block_lists.glsl"
shared uint differing; // pairs of neighbouring cells that are not wholly on one surface

// The four cells from this one on: every pixel lies between four such.
bool is_edge(int i) {
    ivec2 at = ivec2(i % cell_count.x, i / cell_count.x);
    if (any(greaterThanEqual(at + 1, cell_count)))
        return false;
    int right = i + 1, down = i + cell_count.x;
    vec2 like = min(min(likeness(i, right), likeness(i, down)), min(likeness(i, down + 1), likeness(right, down)));
    like = min(like, min(likeness(right, down + 1), likeness(down, down + 1)));
    return min(like.x, like.y) < 1.0;
}

void main() {
    uint index = group_base + gl_WorkGroupID.x;
    ivec2 block = frame.chunk.xy - frame.list.xy + place_in_chunk(index);
    uint word = block_of(block);
    int rate = int(GW_BLOCK_RATE(word)), cells = 0;
    if (gl_LocalInvocationIndex == 0u)
        differing = 0u;
    if (rate > 0) {
        place_cells(block, word);
        cells = cell_count.x * cell_count.y;
    }
    for (int i = int(gl_LocalInvocationIndex); i < cells; i += 64)
        fill_guide(i, cell_of(i), rate);
    barrier();
    for (int i = int(gl_LocalInvocationIndex); i < cells; i += 64)
        if (is_edge(i))
            atomicAdd(differing, 1u);
    barrier();
    if (gl_LocalInvocationIndex == 0u)
        list_block(differing > 0u ? 4u : 0u, index);
}
