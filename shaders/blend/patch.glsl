// A patch: which of its pixels are drawn by its rate, and its colours.
#include "blend/cells.glsl"
#include "blend/lists.glsl"
layout(std430, binding = 10) readonly buffer Blocks { uint blocks[]; };

vec4 near_cells[16]; // rows from the top; w: softness

void load_cells(ivec2 cell, uint rate) {
    uint corner = number_of_cell(cell - 1, rate), row = cells_per_row(rate);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            near_cells[4 * j + i] = CELL_COLOR(corner + uint(j) * row + uint(i));
}

// Whether the block's pixels are made of cells of this rate.
bool is_drawn(ivec2 block, uint rate) {
    return in_chunk(block) && GW_BLOCK_RATE(blocks[block.y * frame.list.z + block.x]) == rate;
}

// Of the four quarters of a patch; pixel: its first, from the list's. No quarter lies in two blocks.
bvec4 drawn_quarters(ivec2 pixel, int half_side, uint rate) {
    ivec2 near = pixel >> 3, far = (pixel + half_side) >> 3;
    return bvec4(is_drawn(near, rate), is_drawn(ivec2(far.x, near.y), rate), is_drawn(ivec2(near.x, far.y), rate),
                 is_drawn(far, rate));
}

// Weights of four cells in a row for a place a share of the way from the second to the third: one at a cell and nothing at the
// others.
vec4 sharp_kernel(float x) {
#ifdef CUBIC
    // Catmull and Rom 1974.
    precise vec4 weights = 0.5 * vec4(x * (x * (2.0 - x) - 1.0), x * x * (3.0 * x - 5.0) + 2.0, x * (1.0 + x * (4.0 - 3.0 * x)),
                                      x * x * (x - 1.0));
    return weights;
#else
    return vec4(0.0, 1.0 - x, x, 0.0);
#endif
}

// B-spline: about as sharp as the next rate.
vec4 soft_kernel(float x) {
    float y = 1.0 - x;
    precise vec4 weights = vec4(y * y * y, x * x * (3.0 * x - 6.0) + 4.0, y * y * (3.0 * y - 6.0) + 4.0, x * x * x) * (1.0 / 6.0);
    return weights;
}

vec3 weighted(vec4 weights, vec3 a, vec3 b, vec3 c, vec3 d) {
    precise vec3 sum = weights.x * a + weights.y * b;
    sum += weights.z * c + weights.w * d;
    return sum;
}

// The four rows of cells at a column of the patch.
struct Column {
    vec3 rows[4];
};

Column column_at(vec4 kernel) {
    Column column;
    for (int j = 0; j < 4; ++j)
        column.rows[j] = weighted(kernel, near_cells[4 * j].rgb, near_cells[4 * j + 1].rgb, near_cells[4 * j + 2].rgb,
                                  near_cells[4 * j + 3].rgb);
    return column;
}

vec3 color_in(Column column, vec4 kernel) {
    return weighted(kernel, column.rows[0], column.rows[1], column.rows[2], column.rows[3]);
}

// Cubics overshoot: what comes out lies between the samples, so that no edge gets a bright or a dark fringe.
vec3 least, most;
void find_limits() {
    least = most = near_cells[0].rgb;
    for (int k = 1; k < 16; ++k) {
        least = min(least, near_cells[k].rgb);
        most = max(most, near_cells[k].rgb);
    }
}

// Softness at a place of the patch.
float softness_at(vec2 share) {
    precise float above = mix(near_cells[5].w, near_cells[6].w, share.x), below = mix(near_cells[9].w, near_cells[10].w, share.x);
    precise float softness = mix(above, below, share.y);
    return softness;
}

// A pixel of the patch from the sharp and the soft column that it lies in.
vec3 color_of(Column sharp, Column soft, vec2 share) {
    vec3 color = color_in(sharp, sharp_kernel(share.y));
#ifdef CUBIC
    color = clamp(color, least, most);
#endif
#ifdef RATE_BLEND
    float softness = softness_at(share);
    precise vec3 mixed = color * (1.0 - softness) + color_in(soft, soft_kernel(share.y)) * softness;
    color = mixed;
#endif
    return color;
}
