/* The float environment of a GL device, measured by a small shader: what `inspect --device` and reports
 * state, because bits may only be compared between devices that agree here. */
#ifndef GW_BASE_GL_PROBE_H
#define GW_BASE_GL_PROBE_H

#include "base/gl.h"

typedef struct gw_float_environment {
    int32_t contracts;         /* 1: a*b+c without `precise` is fused into one rounding */
    int32_t precise_holds;     /* 1: a*b+c with `precise` is rounded twice */
    int32_t fma_fused;         /* 1: fma() rounds once */
    int32_t denormals_kept;    /* 1: subnormal results are not flushed to zero */
    int32_t division_exact;    /* 1: a/b was correctly rounded for every pair tried */
    int32_t sqrt_exact;        /* 1: sqrt was correctly rounded for every value tried */
    int32_t infinity_kept;     /* 1: 1/0 is infinity */
    int32_t nan_kept;          /* 1: 0/0 is seen as NaN */
    int32_t minimum_is_number; /* 1: min and max of NaN and a number are the number */
    int32_t
        conversion_saturates; /* 1: float to int beyond its range gives the nearest int; NaN is not asked */
    uint32_t division_wrong, sqrt_wrong; /* of GW_PROBE_SAMPLES */
} gw_float_environment;

enum { GW_PROBE_SAMPLES = 4096 };

gw_code gw_gl_probe_floats(gw_gl *device, gw_float_environment *out, gw_error *error);

#endif
