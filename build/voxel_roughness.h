/* How rough a surface looks in voxels, which have no normal map: what its map bends is spread into the
 * highlight (Toksvig, Mipmapping Normal Maps, 2005). Any thread. */
#ifndef GW_BUILD_VOXEL_ROUGHNESS_H
#define GW_BUILD_VOXEL_ROUGHNESS_H

#include "build/scene.h"

/* Perceptual roughness, 0..1, of a material with its normal map's spread in it; the same bits on every
 * machine. */
float gw_voxel_roughness(const gw_scene *scene, uint32_t material);

#endif
