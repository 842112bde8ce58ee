// Functions whose bits must not differ between kernels of one device: a library function may be expanded differently from
// one kernel to the next, these are written out and `precise`.

// Arc tangent of y / x for x, y >= 0, in degrees, 0..90; 0 for (0, 0). Error below 1e-4 degrees: the polynomial
// is Abramowitz and Stegun 4.4.49 on [0, 1], mirrored at 45 degrees.
float angle_degrees(float y, float x) {
    float larger = max(x, y);
    precise float r = larger > 0.0 ? min(x, y) / larger : 0.0;
    precise float r2 = r * r;
    precise float p = -0.0117212 * r2 + 0.05265332;
    p = p * r2 - 0.11643287;
    p = p * r2 + 0.19354346;
    p = p * r2 - 0.33262347;
    p = p * r2 + 0.99997726;
    precise float degrees_ = p * r * 57.29577951308232;
    return y > x ? 90.0 - degrees_ : degrees_;
}

float length_precise(vec3 v) {
    precise float squared = v.x * v.x + v.y * v.y + v.z * v.z;
    return sqrt(squared);
}
