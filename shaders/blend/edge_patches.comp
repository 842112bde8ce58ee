// Pixels of patches with silhouettes or creases between their samples, an invocation a patch, of one rate at a time.
//
// variants: CUBIC=1 EDGE_AWARE=1; CUBIC=1 EDGE_AWARE=1 RATE_BLEND=1 ACCUMULATE=1
#define EDGE_AWARE 1
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
layout(location = 0) uniform uint rate;
#include "common/small_math.glsl"
#include "blend/store_pixel.glsl"
#include "blend/patch.glsl"
#include "blend/edges.glsl"

vec3 direction_at(vec2 place) {
    precise vec3 direction = frame.corner.xyz + frame.step_x.xyz * place.x + frame.step_y.xyz * place.y;
    return direction;
}

void draw(ivec2 pixel, bvec4 drawn) {
    int side = 1 << rate;
    float step = 1.0 / float(side);
    ivec2 place = frame.list.xy - frame.chunk.xy + pixel;
    vec2 wall = vec2(frame.list.xy + pixel) + 0.5;
    for (int x = 0; x < side; ++x) {
        precise float right = (float(x) + 0.5) * step;
        Column sharp = column_at(sharp_kernel(right)), soft = sharp;
#ifdef RATE_BLEND
        soft = column_at(soft_kernel(right));
#endif
        bvec2 drawn_here = x < side / 2 ? drawn.xz : drawn.yw;
        for (int y = 0; y < side; ++y) {
            precise float down = (float(y) + 0.5) * step;
            vec3 color = color_of(sharp, soft, vec2(right, down));
            color = cut_at_edges(color, vec2(right, down), direction_at(wall + vec2(x, y)));
            if (y < side / 2 ? drawn_here.x : drawn_here.y)
                store_pixel(place + ivec2(x, y), color);
        }
    }
}

void main() {
    uint at = listed_group() * 64u + gl_LocalInvocationIndex, list = EDGES_OF(rate);
    bool present = at < list_length(list);
    uint entry = lists[list_begin(list) + (present ? at : 0u)];
    ivec2 cell = ivec2(entry & 0xffffu, entry >> 16);
    int half_side = (1 << rate) >> 1;
    ivec2 pixel = (cell << rate) + half_side;
    bvec4 drawn = drawn_quarters(pixel, half_side, rate);
    load_cells(cell, rate);
    find_limits();
    load_edges(cell, rate, direction_at(vec2(frame.list.xy + pixel + half_side)));
    draw(pixel, bvec4(present && drawn.x, present && drawn.y, present && drawn.z, present && drawn.w));
}
