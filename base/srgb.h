/* The sRGB transfer curve (IEC 61966-2-1) in double, 0..1 both ways. Header only; any thread. */
#ifndef GW_BASE_SRGB_H
#define GW_BASE_SRGB_H

#include <math.h>
#include <stdint.h>

static inline double gw_srgb_to_linear(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

static inline double gw_srgb_from_linear(double linear) {
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

/* Of an 8-bit code. */
static inline double gw_srgb_code_to_linear(uint8_t code) {
    return gw_srgb_to_linear(code / 255.0);
}

/* Nearest 8-bit code; values outside 0..1 are clamped. */
static inline uint8_t gw_srgb_code_from_linear(double linear) {
    return (uint8_t)(fmin(fmax(gw_srgb_from_linear(linear), 0), 1) * 255 + 0.5);
}

#endif
