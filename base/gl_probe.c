#include "base/gl_probe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows of the shader's input and output: see shaders/common/float_probe.comp. */
typedef struct probe_row {
    float a, b, c, d;
} probe_row;

enum { GROUP = 64, FACT_ROWS = 4 };

static uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static float as_float(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Rows 0 to 3 are the facts, the rest pairs for division and square root. Inputs come from a buffer, so that
 * no compiler can fold them. */
static void make_input(probe_row *rows) {
    float one_up = 1.0f + 0x1p-23f;
    rows[0] = (probe_row){one_up, one_up, -(one_up * one_up), 0.0f}; /* once: 2^-46, twice: 0 */
    rows[1] = (probe_row){0x1p-126f, 0.5f, 0.0f, 0.0f};              /* a subnormal product */
    rows[2] = (probe_row){1.0f, 0.0f, 3e9f, -3e9f};                  /* 1/0; beyond an int */
    rows[3] = (probe_row){0.0f, 0.0f, 1.0f, 0.0f};                   /* 0/0; a number beside it */
    uint32_t state = 12345;
    for (int i = FACT_ROWS; i < FACT_ROWS + GW_PROBE_SAMPLES; i++) {
        uint32_t a = next_random(&state), b = next_random(&state);
        rows[i] = (probe_row){as_float(0x3f800000u | (a & 0x7fffffu)),
                              as_float(0x3f800000u | (b & 0x7fffffu)), 0, 0};
    }
}

static void judge(const probe_row *in, const probe_row *out, gw_float_environment *facts) {
    *facts = (gw_float_environment){0};
    facts->contracts = out[0].a != 0.0f;
    facts->precise_holds = out[0].b == 0.0f;
    facts->fma_fused = out[0].c != 0.0f;
    facts->denormals_kept = out[1].d == 0x1p-127f;
    facts->infinity_kept = isinf(out[2].a) != 0;
    facts->nan_kept = out[3].b == 1.0f;
    facts->minimum_is_number = out[3].a == 1.0f && out[3].c == 1.0f;
    facts->conversion_saturates = out[2].b == 1.0f;
    for (int i = FACT_ROWS; i < FACT_ROWS + GW_PROBE_SAMPLES; i++) {
        facts->division_wrong += out[i].a != in[i].a / in[i].b;
        facts->sqrt_wrong += out[i].b != sqrtf(in[i].a);
    }
    facts->division_exact = facts->division_wrong == 0;
    facts->sqrt_exact = facts->sqrt_wrong == 0;
}

gw_code gw_gl_probe_floats(gw_gl *device, gw_float_environment *out, gw_error *error) {
    enum { ROWS = FACT_ROWS + GW_PROBE_SAMPLES };
    const size_t size = ROWS * sizeof(probe_row);
    probe_row *rows = malloc(2 * size);
    if (!rows) {
        return gw_fail(error, GW_MACHINE, "not enough memory to probe the float environment");
    }
    make_input(rows);
    gw_gl_buffer input = {0}, output = {0};
    GLuint program = 0;
    gw_code code = gw_gl_program(device, "common/float_probe.comp", NULL, &program, error);
    if (!code) {
        code = gw_gl_buffer_create(device, "float probe input", size, rows, 0, &input, error);
    }
    if (!code) {
        code = gw_gl_buffer_create(device, "float probe output", size, NULL, 0, &output, error);
    }
    if (!code) {
        gw_gl_buffer_bind(&input, 0);
        gw_gl_buffer_bind(&output, 1);
        code = gw_gl_dispatch(device, program, (ROWS + GROUP - 1) / GROUP, error);
    }
    if (!code) {
        code = gw_gl_buffer_read(&output, 0, size, rows + ROWS, error);
    }
    if (!code) {
        judge(rows, rows + ROWS, out);
    }
    gw_gl_buffer_finish(&input);
    gw_gl_buffer_finish(&output);
    free(rows);
    return code;
}
