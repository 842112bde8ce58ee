// Pixels of patches of one rate, an invocation a patch. EDGE_AWARE: patches with silhouettes or creases between their samples are
// listed and left to blend/edge_patches.comp.
//
// variants: RATE=1; RATE=2 CUBIC=1; RATE=3 CUBIC=1 EDGE_AWARE=1 RATE_BLEND=1; RATE=4 CUBIC=1 EDGE_AWARE=1 ACCUMULATE=1
#ifndef RATE
#define RATE 2
#endif
#include "common/frame_block.glsl"
layout(local_size_x = 64) in;
#include "common/small_math.glsl"
#include "blend/store_pixel.glsl"
#include "blend/patch.glsl"
#define SIDE (1 << RATE)
#define PATCHES_ACROSS (RATE < 4 ? 8 >> RATE : 1) // of a region
#define PATCHES (PATCHES_ACROSS * PATCHES_ACROSS)

#ifdef EDGE_AWARE
#include "blend/guides.glsl"
shared uint edge_count, edge_begin;

bool has_edge(ivec2 cell) {
    uint corner = number_of_cell(cell, uint(RATE)), row = cells_per_row(uint(RATE));
    Met a = met_at(corner), b = met_at(corner + 1u), c = met_at(corner + row), d = met_at(corner + row + 1u);
    vec2 like = min(min(min(likeness(a, b), likeness(a, c)), min(likeness(a, d), likeness(b, c))), min(likeness(b, d), likeness(c, d)));
    return min(like.x, like.y) < 1.0;
}

// All invocations of a group, those of patches with edges.
void list_edge(bool edge, ivec2 cell) {
    uint place = 0u;
    if (gl_LocalInvocationIndex == 0u)
        edge_count = 0u;
    barrier();
    if (edge)
        place = atomicAdd(edge_count, 1u);
    barrier();
    if (gl_LocalInvocationIndex == 0u)
        edge_begin = list_begin(EDGES_OF(uint(RATE))) + extend_list(EDGES_OF(uint(RATE)), edge_count, 64u);
    barrier();
    if (edge)
        lists[edge_begin + place] = uint(cell.x) | uint(cell.y) << 16;
}
#endif

void draw(ivec2 pixel, bvec4 drawn) {
    ivec2 place = frame.list.xy - frame.chunk.xy + pixel;
    find_limits();
    for (int x = 0; x < SIDE; ++x) {
        precise float right = (float(x) + 0.5) * (1.0 / float(SIDE));
        Column sharp = column_at(sharp_kernel(right)), soft = sharp;
#ifdef RATE_BLEND
        soft = column_at(soft_kernel(right));
#endif
        bvec2 drawn_here = x < SIDE / 2 ? drawn.xz : drawn.yw;
        for (int y = 0; y < SIDE; ++y) {
            precise float down = (float(y) + 0.5) * (1.0 / float(SIDE));
            vec3 color = color_of(sharp, soft, vec2(right, down));
            if (y < SIDE / 2 ? drawn_here.x : drawn_here.y)
                store_pixel(place + ivec2(x, y), color);
        }
    }
}

void main() {
    uint at = listed_group() * 64u + gl_LocalInvocationIndex, list = REGIONS_OF(uint(RATE));
    bool present = at / uint(PATCHES) < list_length(list);
    ivec2 region = place_of(lists[list_begin(list) + (present ? at / uint(PATCHES) : 0u)]);
    uint which = at % uint(PATCHES);
    ivec2 cell = cell_of_region(region, uint(RATE)) + ivec2(which % uint(PATCHES_ACROSS), which / uint(PATCHES_ACROSS));
    ivec2 pixel = (cell << RATE) + SIDE / 2;
    bvec4 drawn = drawn_quarters(pixel, SIDE / 2, uint(RATE));
    bool wanted = present && any(drawn);
#ifdef EDGE_AWARE
    bool edge = wanted && has_edge(cell);
    list_edge(edge, cell);
    wanted = wanted && !edge;
#endif
    load_cells(cell, uint(RATE));
    draw(pixel, bvec4(wanted && drawn.x, wanted && drawn.y, wanted && drawn.z, wanted && drawn.w));
}
