#include "wall/base64.h"

void gw_base64_write(FILE *file, const uint8_t *data, size_t size) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const uint32_t bits = (uint32_t)data[i] << 16 | (left > 1 ? (uint32_t)data[i + 1] << 8 : 0) |
                              (left > 2 ? (uint32_t)data[i + 2] : 0);
        for (size_t k = 0; k < 4; k++)
            fputc(k <= left ? letters[bits >> (18 - 6 * k) & 63] : '=', file);
    }
}
