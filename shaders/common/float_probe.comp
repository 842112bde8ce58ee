// Does each operation of which the device's rounding is asked, once per row; base/gl_probe.c judges the results.
// The first four rows are facts, the others pairs for division and square root.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer probe_input {
    vec4 input_rows[];
};
layout(std430, binding = 1) writeonly buffer probe_output {
    vec4 output_rows[];
};

const uint fact_rows = 4u;

void main()
{
    uint row = gl_GlobalInvocationID.x;
    if (row >= uint(input_rows.length())) {
        return;
    }
    vec4 value = input_rows[row];
    if (row >= fact_rows) {
        output_rows[row] = vec4(value.x / value.y, sqrt(value.x), 0.0, 0.0);
        return;
    }
    float plain = value.x * value.y + value.z;
    precise float careful = value.x * value.y + value.z;
    float fused = fma(value.x, value.y, value.z);
    float quotient = value.x / value.y;
    if (row == 0u) {
        output_rows[row] = vec4(plain, careful, fused, 0.0);
    } else if (row == 1u) {
        output_rows[row] = vec4(0.0, 0.0, 0.0, value.x * value.y);
    } else if (row == 2u) {
        bool saturates = int(value.z) == 0x7fffffff && int(value.w) == -0x7fffffff - 1;
        output_rows[row] = vec4(quotient, saturates ? 1.0 : 0.0, 0.0, 0.0);
    } else {
        output_rows[row] = vec4(min(quotient, value.z), isnan(quotient) ? 1.0 : 0.0, max(quotient, value.z), 0.0);
    }
}
