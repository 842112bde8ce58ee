// Cells: for each rate above 0 a grid over the list's blocks of squares as wide as that rate's, with what stands for each: the mean of
// the square's rays where the block has that rate, else of the samples there (blend/mixed_cells.comp). Only cells that a
// patch reads are ever written. Rates follow each other in the arrays, rows in a rate.
//
// A patch is the square of pixels between the centres of four neighbouring cells, as wide as they are. All its pixels are made of
// the same sixteen cells.

// Number of the first cell of a rate, and cells of a row.
uint first_cell(uint rate) {
    uint blocks = uint(frame.list.w);
    return rate == 1u ? 0u : rate == 2u ? 16u * blocks : rate == 3u ? 20u * blocks : 21u * blocks;
}

uint cells_per_row(uint rate) {
    return (uint(frame.list.z) << 3) >> rate;
}

uint number_of_cell(ivec2 cell, uint rate) {
    return first_cell(rate) + uint(cell.y) * cells_per_row(rate) + uint(cell.x);
}

#ifdef WRITE_CELLS
layout(std430, binding = 22) writeonly buffer Cell_colors { vec4 cell_colors[]; }; // w: softness, 0 to 1
#ifdef EDGE_AWARE
layout(std430, binding = 23) writeonly buffer Cell_points { vec4 cell_points[]; }; // what the sample met, from the eye, ray units; w: its t, or 0
layout(std430, binding = 24) writeonly buffer Cell_marks { uvec2 cell_marks[]; };  // its id, its normal as packSnorm4x8
#endif
#ifdef RATE_BLEND
#include "sample/spacing.glsl"
#endif

// How far the sharpness at the middle of a cell has fallen from that of its rate to that of the next: 0 to 1.
float softness_of_cell(ivec2 cell, uint rate) {
#ifdef RATE_BLEND
    vec2 centre = vec2(frame.list.xy + (cell << rate)) + 0.5 * float(1u << rate);
    precise float octaves = log2(max(spacing_at(centre), 1e-6)) - float(rate);
    return rate < frame.sampling.y ? clamp(2.0 * octaves - 1.0, 0.0, 1.0) : 0.0;
#else
    return 0.0;
#endif
}

// pixel, rate: first pixel (from the list's) and rate of the sample whose guide it is.
void write_cell(ivec2 cell, uint rate, vec3 color, uvec4 guide, ivec2 pixel, uint sample_rate) {
    uint at = number_of_cell(cell, rate);
    cell_colors[at] = vec4(color, softness_of_cell(cell, rate));
#ifdef EDGE_AWARE
    vec2 centre = vec2(frame.list.xy + pixel) + 0.5 * float(1u << sample_rate);
    precise vec3 direction = frame.corner.xyz + frame.step_x.xyz * centre.x + frame.step_y.xyz * centre.y;
    bool met = guide.x != GW_NO_TRIANGLE;
    float t = uintBitsToFloat(guide.y);
    precise vec3 point = direction * t;
    cell_points[at] = met ? vec4(point, t) : vec4(0.0);
    cell_marks[at] = uvec2(guide.x, met ? guide.z : 0u);
#endif
}
#else
layout(binding = 14) uniform samplerBuffer cell_colors;
#define CELL_COLOR(number) texelFetch(cell_colors, int(number))
#ifdef EDGE_AWARE
layout(binding = 15) uniform samplerBuffer cell_points;
layout(binding = 16) uniform usamplerBuffer cell_marks;
#define CELL_POINT(number) texelFetch(cell_points, int(number))
#define CELL_MARK(number) texelFetch(cell_marks, int(number)).xy
#endif
#endif
