// What materials have beyond gw_gpu_material.
layout(binding = 17) uniform usamplerBuffer extensions; // gw_gpu_extension

vec4 extension_row(uint material, int row) {
    return uintBitsToFloat(texelFetch(extensions, int(material) * GW_EXTENSION_ROWS + row));
}
