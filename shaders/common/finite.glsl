// Whether all components are numbers below 1e30 in size, told by their bits: compilers may turn a comparison round as if there
// were no not-a-number, and then it passes.
bool finite(vec3 v) {
    return all(lessThan(floatBitsToUint(v) & 0x7fffffffu, uvec3(0x7149f2cau)));
}
