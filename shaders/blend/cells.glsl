// The grid cells that a block's pixels read: columns and rows of at most 11, on the grid of the block's rate.
#define MOST_CELLS 11
#define CELL_COUNT (MOST_CELLS * MOST_CELLS)
ivec2 first_cell, cell_count;
ivec2 least_cell, most_cell;

// First pixel of a block of the chunk, from the chunk's.
ivec2 place_in_chunk(uint index) {
    uint per_row = uint(frame.chunk.z);
    return 8 * ivec2(index % per_row, index / per_row);
}

ivec2 cell_before(ivec2 pixel, int rate) {
    return rate == 0 ? pixel : (pixel - (1 << rate >> 1)) >> rate; // its centre is not right of, not below the pixel's
}

// block: its first pixel; word: its rate and place in the list.
void place_cells(ivec2 block, uint word) {
    int rate = int(GW_BLOCK_RATE(word));
    first_cell = cell_before(block, rate) - 1;
    cell_count = cell_before(block + 7, rate) + 3 - first_cell;
    // Blocks that reach nothing know only their own samples.
    bool reaches = (word & GW_BLOCK_REACHES) != 0u;
    least_cell = reaches ? first_cell : block;
    most_cell = reaches ? first_cell + cell_count : block + 7;
}

ivec2 cell_of(int i) {
    return clamp(first_cell + ivec2(i % cell_count.x, i / cell_count.x), least_cell, most_cell);
}
