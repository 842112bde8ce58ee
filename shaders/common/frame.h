// What the renderer hands to its kernels, declared once for C (render/frame_block.h) and GLSL. Only 16-byte rows, so
// that std140 and C agree. Needs common/shared.h before it.
#ifndef GW_FRAME_H
#define GW_FRAME_H

#ifdef GW_HOST
#define GW_VEC4(name) float name[4]
#define GW_IVEC4(name) int32_t name[4]
#define GW_UVEC4(name) uint32_t name[4]
#else
#define GW_VEC4(name) vec4 name
#define GW_IVEC4(name) ivec4 name
#define GW_UVEC4(name) uvec4 name
#endif

// One viewer's gaze in ray units (rebased space times ray_scale, axes of rebased space).
GW_STRUCT_BEGIN(gw_viewer)
GW_VEC4(eye);     // viewer's eye minus rendering eye; w: half-width of the ellipsoid, deg, age included
GW_VEC4(right);   // unit; w: half-height, deg
GW_VEC4(up);      // unit; w: tangent of the half-width
GW_VEC4(forward); // unit, along the gaze; w: tangent of the half-height
GW_STRUCT_END(gw_viewer)

// One frame of one plane; chunk and slots change per dispatch.
// Ray units: directions are (pixel - eye) in rebased space times a power of two that brings the plane near distance 1.
GW_STRUCT_BEGIN(gw_frame_block)
GW_VEC4(eye);        // rebased; w: metres of scene per rebased unit
GW_VEC4(corner);     // plane's corner minus eye, ray units; w: width of a sample in pixels where a pixel has several
GW_VEC4(step_x);     // ray units per pixel; w: 1 / seed_distance, in ray units
GW_VEC4(step_y);     // w: separated_tau
GW_VEC4(accuracy);   // tau, tau_inside, gaze_blend deg, gaze_margin deg
GW_VEC4(acuity);     // slope, smallest period deg, voxel_slab, voxel_flatness
GW_VEC4(background); // linear radiance; w: least_remainder
GW_VEC4(ambient);    // linear irradiance; w: fold_agreement
GW_VEC4(environment); // turns by which it is rotated, texels per radian, 1 where there is one, glossy_roughness or 0
GW_VEC4(environment_mean); // irradiance over pi, mean over all directions, of what no light stands for; w: radiance from which on
                           // lights stand for what surfaces emit, 0: they do not
GW_VEC4(secondary);  // shadow_tau, mirror_roughness, near_light, least_throughput
GW_UVEC4(media);      // that the eye is in (shade/media.glsl), 0, 0
GW_IVEC4(window);    // rectangle: x and y of its first pixel, x and y past its last
GW_IVEC4(chunk);     // first block's x and y (pixels, multiples of 8), blocks per row, number of blocks
GW_IVEC4(list);      // grid of blocks that samples are listed for, chunk and rim: as chunk, x and y multiples of 16
GW_UVEC4(counts);    // viewers, directional lights, lights with a place, rays of a sharp pixel
GW_UVEC4(level_begin[4]); // first node of each octree level, 16 entries; unused ones are 0xffffffff
GW_VEC4(accumulation); // xy: this sample's ray in its square, in sides of it from its centre; z: 1 / samples with this one;
                       // w: 1 when samples have been added before
GW_UVEC4(sampling);  // rays of a coarse square, log2 of the largest square, number of cones, what they are for: GW_CONES_
GW_VEC4(cones[6]);   // xyz: unit direction about the normal, z along it; w: rebased length up to which anything counts
GW_VEC4(tone);       // gain of the exposure; 1: the filmic curve; 1: dithered; 1: this sample's light is counted
GW_VEC4(gazing);     // gaze_footprint, edge_depth, cosines of edge_normal and of half of it
GW_VEC4(coarse_places[4]); // of up to 8 rays in their square, in sides of it, as below
GW_VEC4(sample_places[8]); // of up to 16 rays in their pixel, from its centre, px: xy of an even one, zw of an odd one
gw_viewer viewers[GW_MAXIMUM_VIEWERS];
GW_STRUCT_END(gw_frame_block)

// Material, 3 texels of a buffer texture. words: base-colour texture or GW_NO_TEXTURE; flags; bits of the alpha cutoff;
// bits of roughness.
#define GW_NO_TEXTURE 0xffffffffu
#define GW_MATERIAL_MASK 1u
#define GW_MATERIAL_BLEND 2u
GW_STRUCT_BEGIN(gw_gpu_material)
GW_VEC4(base_color); // linear, alpha last
GW_VEC4(emissive);   // linear radiance; w: metalness
GW_UVEC4(words);
GW_STRUCT_END(gw_gpu_material)
// What a material has beyond gw_gpu_material, GW_EXTENSION_ROWS texels of a buffer texture that exists only for scenes in which some
// material has anything, or where an effect that reads it is forced in. Same number as the material.
GW_STRUCT_BEGIN(gw_gpu_extension)
GW_UVEC4(maps[3]);     // texture words, or GW_NO_TEXTURE: normal, metallic-roughness, occlusion, emissive; transmission, clearcoat,
                       // its roughness, its normal; sheen colour, sheen roughness, specular, specular colour
GW_VEC4(factors);      // normal scale, occlusion strength; where there is a metallic-roughness map: roughness, metalness
GW_VEC4(emissive);     // linear radiance where there is an emissive map; w: 1 for unlit
GW_VEC4(specular);     // reflectance of its dielectric part at 0 degrees before `specular`, may be over 1; w: specular, that at 90
GW_VEC4(transmission); // transmission, index of refraction, thickness (rebased), 0
GW_VEC4(attenuation);  // absorption per rebased unit of length inside, 1e30 for black; w: 0
GW_VEC4(coat);         // clearcoat, its roughness, scale of its normal map, 0
GW_VEC4(sheen);        // sheen colour; w: its roughness
GW_VEC4(to_uv[24]);    // of the twelve maps in this order, two rows each: uv of the picture is the row times (u, v, 1); w: set of u, v
GW_STRUCT_END(gw_gpu_extension)
#define GW_EXTENSION_MAP_COUNT 12
#define GW_EXTENSION_ROWS 34
#define GW_EXTENSION_MAPS 0
#define GW_EXTENSION_FACTORS 3
#define GW_EXTENSION_EMISSIVE 4
#define GW_EXTENSION_SPECULAR 5
#define GW_EXTENSION_TRANSMISSION 6
#define GW_EXTENSION_ATTENUATION 7
#define GW_EXTENSION_COAT 8
#define GW_EXTENSION_SHEEN 9
#define GW_EXTENSION_TO_UV 10
// A material's texture word: class (bits 0-3), layer (4-19), wrap of u (20-21) and v (22-23) as gw_wrap, shown as squares (24).
#define GW_TEXTURE_CLASS(word) ((word) & 0xfu)
#define GW_TEXTURE_LAYER(word) (((word) >> 4) & 0xffffu)
#define GW_TEXTURE_WRAP_U(word) (((word) >> 20) & 3u)
#define GW_TEXTURE_WRAP_V(word) (((word) >> 22) & 3u)
#define GW_TEXTURE_SQUARES(word) (((word) & 0x1000000u) != 0u)
#define GW_MAXIMUM_TEXTURE_CLASSES 4
#define GW_MAXIMUM_DATA_CLASSES 2

// Of an environment blurred for surfaces: layers, and columns of each.
#define GW_ENVIRONMENT_LAYERS 5
#define GW_ENVIRONMENT_WIDTH 64

// Light, GW_LIGHT_ROWS texels.
#define GW_LIGHT_ROWS 5
// More would not be gone through: with the 8 fragments of a ray 57,344 iterations, of 65,535 that some drivers allow an invocation.
#define GW_MOST_LIGHTS 7168
GW_STRUCT_BEGIN(gw_gpu_light)
GW_VEC4(vector); // unit direction towards the light, or position in rebased space; w: 1 for one taken from the environment
GW_VEC4(color);  // irradiance (at 1 m); w: 1 / range^2, 1/m^2, 0: no end
GW_VEC4(axis);   // unit direction in which a spot shines, or a rectangle's side, rebased; w: radius of a sphere, rebased, or 1 - cos of
                 // a disc's half-angle; 0: hard shadows
GW_VEC4(shape);  // scale and offset of the cosine in a cone; which part of its light this row is, of how many
GW_VEC4(side);   // a rectangle's other side, rebased; w: 1 for a rectangle, GW_LIGHT_EMISSIVE for emissive triangles, whose xy are
                 // the bits of their first slot's place (texels of this buffer) and of the number of slots
GW_STRUCT_END(gw_gpu_light)
#define GW_LIGHT_EMISSIVE 2.0

// A part of an emissive triangle (render/emissive_lights.h), GW_EMISSIVE_ROWS texels behind the lights. words: triangle;
// GW_EMITS_BOTH_WAYS or 0; bits of where its part of the triangle begins, 0..1 of the area from the first corner on, and of how much it is.
#define GW_EMISSIVE_ROWS 2
#define GW_EMITS_BOTH_WAYS 1u
GW_STRUCT_BEGIN(gw_emissive_slot)
GW_UVEC4(words);
GW_VEC4(light); // irradiance at 1 m if all of its light came from here, turned to there; w: area that this takes, rebased
GW_STRUCT_END(gw_emissive_slot)

// First word of a triangle's first fourth component, in the renderer's copy.
#define GW_TRIANGLE_ALPHA 1u    // its material masks or blends: what it covers is decided where it is hit
#define GW_TRIANGLE_BOUNDARY 2u // it bounds a medium
#define GW_TRIANGLE_SHEER 4u    // it lets light through
// Numbers of media, a material's plus 1, have 16 bits.
#define GW_MOST_MEDIA 65535u

// Sparse samples (shaders/sample). A sample: pixel relative to the list's first, x in bits 0-11, y in 12-23; log2 of its side in
// bits 24-26; which of its pixel's rays it is in bits 27-30. A block of 8 x 8 pixels: slot of its first sample in bits 0-27, log2
// of their side in bits 28-30, bit 31: its pixels blend samples of blocks round it, two
// blocks away (one where they have a ray each, four where they are squares of 16). A block's samples stand in Morton order, the
// rays of one pixel together. A square of 16 pixels is a sample of its first block; the other three blocks have none.
#define GW_NO_SAMPLE 0xffffffffu
#define GW_SAMPLE_X(word) ((word) & 0xfffu)
#define GW_SAMPLE_Y(word) (((word) >> 12) & 0xfffu)
#define GW_SAMPLE_RATE(word) (((word) >> 24) & 7u)
#define GW_SAMPLE_WHICH(word) (((word) >> 27) & 0xfu)
#define GW_BLOCK_FIRST(word) ((word) & 0x0fffffffu)
#define GW_BLOCK_RATE(word) (((word) >> 28) & 7u)
#define GW_BLOCK_REACHES 0x80000000u
// Blocks of the list's grid that are scanned by one work group stand in squares of 8 x 8; the grid is whole squares.
#define GW_LIST_SQUARE 8
// Words that the list leaves behind: samples, groups of 64 of them, blocks of the chunk with fewer rays than pixels, 0; from
// GW_LIST_ARGUMENTS on, 4 words a batch: the arguments of its dispatch.
#define GW_LIST_ARGUMENTS 4u

// What one ray met, 3 words: triangle id, or node index with GW_FRAGMENT_VOXEL; t; weight 0..1.
#define GW_FRAGMENT_VOXEL 0x80000000u
#define GW_FRAGMENT_WORDS 3u
// A hit under way is a triangle id with this bit when the ray meets its back: of triangles at one distance the front comes
// first, then the lowest id, so that faces doubled with opposite winding show the side that was made for the viewer.
#define GW_HIT_BACK 0x80000000u
/* What --debug bounds reports: reads beyond an end, then the least index of a node, a reference, a triangle, a payload, a box. */
#define GW_RANGE_WORDS 6
// What a sample met, for edge-aware reconstruction (uvec4): id, as of a fragment, of what weighs most along the ray, or
// GW_NO_TRIANGLE; bits of its t; its normal, packSnorm4x8; bits of its weight. Of rays of pixels, for those who measure: the
// normal on an octahedron, packSnorm2x16; bits of the share of the ray that met something.

// Status of a ray: fragments written by the last dispatch (bits 0-7) and flags.
#define GW_STATUS_COUNT(status) ((status) & 0xffu)
#define GW_STATUS_SUSPENDED 0x100u   // another dispatch goes on with this ray
#define GW_STATUS_PROVISIONAL 0x200u // the last fragment's weight is its opacity before alpha
#define GW_STATUS_OUTSIDE 0x400u     // no pixel of the rectangle

// A suspended ray's state (trace/state.glsl), in words; shading needs to know where its transmittance and group opacity are.
#define GW_STATE_WORDS 16u
#define GW_STATE_TRANSMITTANCE 8u
// More of them for shadow rays through what lets light through.
#define GW_TINT_STATE_WORDS 9u
// Visibilities of fragments are float bits, 0 to 1, or with GW_SERVED the place where another's stand. With TRANSMISSION the second half
// of the buffer holds their colours, 10 bits a channel.
#define GW_SERVED 0x80000000u
#define GW_NO_PLACE 0xffffffffu
#define GW_KEPT_WORDS 3u

// A secondary ray, rows of 16 bytes: origin and footprint there; unit direction and growth of the footprint per unit; tau, below
// 0 for padding, the distance up to which only triangles count, the largest share of a pixel that depends on it, 0 if it may not ask
// for more, and for cones the length up to which anything counts, below 0 if what they meet need not be lit; with TRANSMISSION the
// media that it is in (shade/media.glsl), the triangle that it comes through or GW_NO_TRIANGLE; with GLOSSY what its pixel draws lobes
// by, GW_GLOSSY_RAY and GW_UNLIT_RAY. All as the bits of words.
#define GW_GLOSSY_RAY 0x80000000u // what of it meets nothing is asked elsewhere
#define GW_UNLIT_RAY 0x40000000u  // lights bring where it comes from what of the environment they stand for
#define GW_LOBE_SEED 0x3fffffffu
#define GW_SECONDARY_ROWS 4u
// Which rays a fragment asks for: the number of the first in bits 0-27, a bit of GW_RAY_ for each kind in bits 28-31; its rays
// are numbered kind by kind. What they bring stands by number: radiance, and what of the ray met nothing.
#define GW_ASKED_WORD(first, kinds) ((first) | ((kinds) << 28))
#define GW_ASKED_FIRST(word) ((word) & 0x0fffffffu)
#define GW_ASKED_KINDS(word) ((word) >> 28)
// With DIFFUSE another row behind it: what of a cone's radiance is light from everywhere that what it met reflects, and
// what share of light that falls on it a cone's hits reflect all ways.
#define GW_BROUGHT_ROWS_DIFFUSE 2
#define GW_RAY_REFLECTED 1u
#define GW_RAY_REFRACTED 2u
#define GW_RAY_COAT 4u // of a clearcoat that is no mirror; never beside refracted ones
#define GW_RAY_CONES 8u // as many as the frame has
#define GW_CONES_OCCLUDE 1u
#define GW_CONES_LIGHT 2u
#define GW_CONES_ALL 4u // with the bounces behind the first
// A request: the fragment in bits 0-25, which of its rays in bits 26-31.
#define GW_REQUEST(fragment, which) ((fragment) | ((which) << 26))
#define GW_REQUEST_FRAGMENT(word) ((word) & 0x03ffffffu)
#define GW_REQUEST_WHICH(word) ((word) >> 26)
#define GW_RAYS_OF_FRAGMENT 2u // at most
#define GW_MOST_BOUNCES 8

// Counts of a picture's light (blend/tone.glsl): a bin is a quarter of an octave, by the float's exponent and its first two bits
// after the point. The first one begins at 2^-20 and holds all that is darker, the last one what is brighter than 2^12.
#define GW_LUMINANCE_BINS 128
#define GW_LUMINANCE_FIRST ((127 - 20) << 2)

// Totals of one chunk: cap hits, NaN pixels, length of the queue, shadow or secondary rays; with COUNT: the most iterations that a
// ray took in one dispatch, and behind the totals the frame's fragments of each material.
#define GW_TOTAL_ITERATIONS 4
#define GW_TOTAL_REFRACTED 5 // secondary rays that go through something
#define GW_TOTAL_CONES 6     // secondary rays that are cones
#define GW_TOTAL_GLOSSY 7 // that what is no mirror reflects
#define GW_TOTAL_COARSE_SHADOWS 8 // shadow rays that may meet voxels, where they are listed apart
#define GW_TOTAL_WORDS 9
#endif
