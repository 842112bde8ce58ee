// How wide a cell may be that stands for its contents along the ray. With WIDE_RAYS its footprint need not begin at 0.
// Needs trace/grid.glsl before it.
float lod_slope; // grid units of accepted error per unit of t
#ifdef WIDE_RAYS
float lod_start; // and at t = 0
float lod_clear; // t up to which nothing but triangles is accepted
#endif

// The most that it can be in the root cube.
float most_accepted_error() {
#ifdef WIDE_RAYS
    return max(lod_start + max(lod_slope, 0.0) * root_exit, 0.0);
#else
    return lod_slope * root_exit;
#endif
}

// At the entry of the ray's cell, in grid units.
float accepted_error() {
#ifdef WIDE_RAYS
    precise float accepted = lod_start + lod_slope * cell_entry;
    return cell_entry < lod_clear ? 0.0 : max(accepted, 0.0);
#else
    return lod_slope * cell_entry;
#endif
}
