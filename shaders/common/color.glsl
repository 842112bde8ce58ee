// sRGB transfer functions (IEC 61966-2-1), on linear values 0..1.
vec3 srgb_encode(vec3 linear) {
    vec3 c = clamp(linear, 0.0, 1.0);
    precise vec3 curved = 1.055 * pow(max(c, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
    return mix(curved, c * 12.92, lessThan(c, vec3(0.0031308)));
}

vec3 srgb_decode(vec3 encoded) {
    precise vec3 curved = pow((max(encoded, vec3(0.04045)) + 0.055) / 1.055, vec3(2.4));
    return mix(curved, encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}
