// Division and square root that give the same bits on every driver: GL's own are not exactly rounded, and the octree's
// payload must not depend on the device. Three Newton steps take the integer first guess (12 % and 3.4 % off) below float's
// precision; products are kept apart by precise.

// 1/x for normal x > 1e-30; 0 below, so that callers need no branch.
float gw_reciprocal(float x) {
    precise float y = uintBitsToFloat(0x7ef311c3u - floatBitsToUint(x));
    y = y * (2.0 - x * y);
    y = y * (2.0 - x * y);
    y = y * (2.0 - x * y);
    return x > 1e-30 ? y : 0.0;
}

// sqrt(x) for normal x > 1e-30; 0 below.
float gw_square_root(float x) {
    precise float y = uintBitsToFloat(0x5f375a86u - (floatBitsToUint(x) >> 1));
    precise float half_x = 0.5 * x;
    y = y * (1.5 - half_x * y * y);
    y = y * (1.5 - half_x * y * y);
    y = y * (1.5 - half_x * y * y);
    precise float root = x * y;
    return x > 1e-30 ? root : 0.0;
}
