#include "wall/frame_code.h"

#include "wall/overlay_text.h"

#include <math.h>
#include <stddef.h>

enum { BITS = 8, INNER_COLUMNS = 4, CELLS = 12 };

/* The inner cells, row by row: white, black, white, parity, then the Gray code. */
enum { CELL_WHITE, CELL_BLACK, CELL_WHITE_TOO, CELL_PARITY, CELL_GRAY };

gw_code_place gw_frame_code_place(uint32_t width, uint32_t height) {
    /* 24 cells to the shorter side: 45 px on a panel of 1080 rows, seen by any camera that sees the wall. */
    const uint32_t shorter = width < height ? width : height, cell = shorter / 24 > 2 ? shorter / 24 : 2;
    const uint32_t wide = (GW_CODE_COLUMNS + 1) * cell, high = (GW_CODE_ROWS + 1) * cell;
    return (gw_code_place){
        .x = width > wide ? width - wide : 0, .y = height > high ? height - high : 0, .cell = cell};
}

static uint32_t gray_of(uint32_t number) {
    return number ^ number >> 1;
}

static uint32_t number_of(uint32_t gray) {
    for (uint32_t shift = 1; shift < BITS; shift *= 2)
        gray ^= gray >> shift;
    return gray;
}

static int cell_is_white(uint32_t frame, int cell) {
    switch (cell) {
    case CELL_WHITE:
    case CELL_WHITE_TOO:
        return 1;
    case CELL_BLACK:
        return 0;
    case CELL_PARITY:
        return (int)(frame & 1);
    default:
        return (int)(gray_of(frame % GW_CODE_PERIOD) >> (BITS - 1 - (cell - CELL_GRAY)) & 1);
    }
}

void gw_frame_code_draw(gw_image *tile, uint32_t frame) {
    static const uint8_t colors[2][4] = {{0, 0, 0, 255}, {255, 255, 255, 255}};
    const gw_code_place at = gw_frame_code_place(tile->width, tile->height);
    const int64_t x = at.x, y = at.y, cell = at.cell;
    gw_box_draw(tile, x - cell / 2, y - cell / 2, cell * (GW_CODE_COLUMNS + 1), cell * (GW_CODE_ROWS + 1),
                colors[0]);
    gw_box_draw(tile, x, y, cell * GW_CODE_COLUMNS, cell * GW_CODE_ROWS, colors[1]);
    for (int i = 0; i < CELLS; i++)
        gw_box_draw(tile, x + cell * (1 + i % INNER_COLUMNS), y + cell * (1 + i / INNER_COLUMNS), cell, cell,
                    colors[cell_is_white(frame, i)]);
}

/* Mean of the middle half of a cell, 0 to 255; negative when it is not in the picture. */
static double cell_light(const gw_image *picture, double x, double y, double wide, double high) {
    const double left = floor(x + wide / 4), right = fmax(left + 1, floor(x + wide * 3 / 4));
    const double top = floor(y + high / 4), bottom = fmax(top + 1, floor(y + high * 3 / 4));
    if (!(left >= 0 && top >= 0 && right <= picture->width && bottom <= picture->height))
        return -1;
    double sum = 0;
    for (size_t row = (size_t)top; row < (size_t)bottom; row++)
        for (size_t column = (size_t)left; column < (size_t)right; column++) {
            const uint8_t *pixel = picture->rgba + (row * picture->width + column) * 4;
            sum += 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
        }
    return sum / ((bottom - top) * (right - left));
}

/* The inner cells between 0, black, and 1, white. 0 when what should be white and black is not. */
static int read_cells(const gw_image *picture, double x, double y, double wide, double high,
                      double cells[CELLS]) {
    const double least_contrast = 32;
    for (int i = 0; i < CELLS; i++)
        cells[i] = cell_light(picture, x + wide * (1 + i % INNER_COLUMNS), y + high * (1 + i / INNER_COLUMNS),
                              wide, high);
    const double white = fmin(cells[CELL_WHITE], cells[CELL_WHITE_TOO]), black = cells[CELL_BLACK];
    if (black < 0 || white - black < least_contrast)
        return 0;
    for (int i = 0; i < CELLS; i++) {
        if (cells[i] < 0)
            return 0;
        cells[i] = (cells[i] - black) / (white - black);
    }
    /* The ring, one cell on each side. */
    for (int side = 0; side < 4; side++) {
        const double column = side == 0 ? 0 : side == 1 ? GW_CODE_COLUMNS - 1 : 2;
        const double row = side == 2 ? 0 : side == 3 ? GW_CODE_ROWS - 1 : 2;
        if ((cell_light(picture, x + wide * column, y + high * row, wide, high) - black) / (white - black) <
            0.7)
            return 0;
    }
    return 1;
}

gw_code_reading gw_frame_code_read(const gw_image *picture, const double rectangle[4], uint32_t width,
                                   uint32_t height, uint32_t *frame) {
    const gw_code_place at = gw_frame_code_place(width, height);
    const double scale[2] = {rectangle[2] / width, rectangle[3] / height};
    double cells[CELLS];
    *frame = 0;
    if (!read_cells(picture, rectangle[0] + at.x * scale[0], rectangle[1] + at.y * scale[1],
                    at.cell * scale[0], at.cell * scale[1], cells))
        return GW_CODE_NONE;
    uint32_t gray = 0, unclear = 0;
    for (int i = CELL_PARITY; i < CELLS; i++)
        unclear += cells[i] > 0.3 && cells[i] < 0.7;
    if (unclear > 0)
        return unclear <= 2 ? GW_CODE_CHANGED : GW_CODE_NONE;
    for (int i = 0; i < BITS; i++)
        gray = gray << 1 | (cells[CELL_GRAY + i] > 0.5);
    const uint32_t number = number_of(gray);
    if ((number & 1) != (cells[CELL_PARITY] > 0.5))
        return GW_CODE_NONE;
    *frame = number;
    return GW_CODE_READ;
}
