// What share of a fragment reflects as a perfect mirror: all of a triangle or nothing; of a voxel as much as it holds of smooth
// metal. Needs shade/surface.glsl before it.
float mirror_share(uint id) {
    bool voxel = (id & GW_FRAGMENT_VOXEL) != 0u;
    int material = int(texelFetch(faces, int(voxel ? 0u : id)).w) * 3;
    float metalness = uintBitsToFloat(texelFetch(materials, material + 1).w);
    float roughness = uintBitsToFloat(texelFetch(materials, material + 2).w);
    float share = metalness >= 1.0 && roughness <= frame.secondary.y ? 1.0 : 0.0;
#ifdef LOD
    uvec3 payload = PAYLOAD(voxel ? id & ~GW_FRAGMENT_VOXEL : 0u);
    float rough = float(GW_PAYLOAD_ROUGHNESS_CODE(payload.z)) * (1.0 / 63.0);
    float smooth_metal = float(GW_PAYLOAD_METALNESS_CODE(payload.z)) * (1.0 / 63.0);
    bool mirrors = rough <= frame.secondary.y + 0.5 / 63.0 && GW_PAYLOAD_HAS_NORMAL(payload.y);
    share = voxel ? (mirrors ? smooth_metal : 0.0) : share;
#ifdef DULL_VOXELS
    share = voxel ? 0.0 : share; // the naive variant, for the test that shows why
#endif
#endif
    return share;
}
