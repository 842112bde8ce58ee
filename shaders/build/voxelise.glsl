// What the stages of the rasterised voxeliser share (Weier et al. 2014, section 3; bench only): each triangle is drawn along
// the axis that its normal is nearest to, so that no projection is thinner than it has to be.
layout(location = 0) uniform uint triangle_first; // of this slice
layout(location = 1) uniform uint resolution;     // voxels along a side; up to 1024

// Coordinates with the dominant axis last.
vec3 turn(vec3 v, int axis) {
    return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v;
}

uvec3 turn_back(uvec3 v, int axis) {
    return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v;
}
