// Declared once for C and GLSL: every structure that both sides see. Only 16-byte rows (vec4, uvec4, ivec4), so that
// std140, std430 and C agree; a unit test checks the C sizes against the driver's.
// C code includes this through build/gpu_types.h, which defines GW_HOST; GLSL includes it as it stands.
#ifndef GW_SHARED_H
#define GW_SHARED_H
#ifdef GW_HOST
#define GW_STRUCT_BEGIN(name) typedef struct name {
#define GW_STRUCT_END(name) } name;
#else
#define GW_STRUCT_BEGIN(name) struct name {
#define GW_STRUCT_END(name) };
#endif

#define GW_MAXIMUM_VIEWERS 4
#define GW_NO_TRIANGLE 0xffffffffu

// The tangent of a vertex that its file gives (build/tangent.h): x and y of an octahedral direction from -1 to 1 as 0 to twice
// GW_TANGENT_LARGEST in GW_TANGENT_BITS each, and two flags. 0: there is none.
#define GW_TANGENT_BITS 15
#define GW_TANGENT_LARGEST 16383
#define GW_TANGENT_LEFT 0x40000000u // the map's upward axis is -cross(normal, tangent)
#define GW_TANGENT_GIVEN 0x80000000u

// Octree node, 8 bytes (uvec2).
//   x  inner: index of its first child; siblings are packed in child order, found by popcount of the valid mask.
//      leaf:  a triangle id (kind GW_LEAF_SINGLE), the first index of its list in the reference array (GW_LEAF_LIST), or the
//             first of its boxes (GW_LEAF_DENSE).
//   y  bits 0-7 valid mask (children that exist), bits 8-15 leaf mask (children that are leaves), bits 16-31 flags.
// Child i of a cell is at +x for bit 0, +y for bit 1, +z for bit 2. The payload has the same index as the node.
#define GW_NODE_VALID(y) ((y) & 0xffu)
#define GW_NODE_LEAVES(y) (((y) >> 8) & 0xffu)
#define GW_NODE_FLAGS(y) ((y) >> 16)
#define GW_NODE_KIND(y) (((y) >> 16) & 0xfu)
#define GW_KIND_INNER 0u
#define GW_LEAF_LIST 1u
#define GW_LEAF_SINGLE 2u
#define GW_LEAF_DENSE 3u
// Entry of the root grid, a node of its own (render/root_grid.h): kind and link as in the node, or kind inner with the mask of the
// node; scale of the cell, log2 of its side in finest cells, in bits 24-31. An empty cell: an inner one without children,
// one scale above it.
#define GW_GRID_ENTRY_SCALE(y) ((y) >> 24)
#define GW_GRID_ENTRY_SCALE_SHIFT 24
// In the renderer's copy of a node, never in the grid's: something in the cell lets light through.
#define GW_NODE_SHEER 0x80000000u
// Reference array: triangle ids; the last of a list carries this bit. Entry 0 is reserved.
#define GW_REFERENCE_LAST 0x80000000u
#define GW_REFERENCE_ID 0x7fffffffu

// Boxes over the list of a dense leaf, 32 bytes each (two uvec4): a binary tree in depth-first order.
//   0  xyz: least corner, as float bits. w: with triangles: the first of their references; without: the box that comes next
//      when the ray misses this one, 0 when none does.
//   1  xyz: greatest corner. w: triangles of this box (0: it holds boxes) and GW_BOX_LAST where none comes after them.
#define GW_BOX_TRIANGLES(w) ((w) & 7u)
#define GW_BOX_LAST 0x80000000u
#define GW_BOX_MOST_TRIANGLES 4u
// Payload of a node, 12 bytes (uvec3): what the cell looks like as one voxel.
//   x  bits 0-9, 10-19, 20-29: red, green, blue, sRGB-encoded to 10 bits; bit 30: two-sided (opposed normals met);
//      bit 31: separated (the surface lies apart from its mean plane: several sheets, or a volume of small things).
//   y  bits 0-11, 12-23: octahedral unit normal, 2047 for 0; of two-sided and separated voxels bits 0-8, 9-17: the same, 255
//      for 0, 18-20: how far a separated one's surface lies from its mean plane (root mean square), 0.1 sides and 0.05 for
//      each step, 21-23: how much more of a two-sided one faces one way than the other, in 1/7. All 24 set
//      (GW_PAYLOAD_NO_NORMAL): no normal, use the ray's. Bits 24-31: length of the mean normal in 1/255 (1: flat, 0: all
//      ways). Agreement GW_PAYLOAD_SOLID of a two-sided voxel is kept for octrees of payload_rule = seed: a solid voxel,
//      whose area is its optical thickness (16: opaque).
//   z  bits 0-11: area of the surface in the cell over the cell's face area, at most 16: area = 16 (code / 4095)^2, so that
//      small things keep their digits; bits 12-19: where the surface lies along its normal, from the cell's centre, in
//      1/144 of the cell's side, 128 for the centre; bits 20-25: perceptual roughness, the mean by reflectance, in 1/63;
//      bits 26-31: metalness in 1/63.
// Emission of a node, 4 bytes (uint), only in octrees of scenes in which something emits light: mean emitted radiance of the
// cell's surface with a shared exponent, as GL's RGB9_E5: value = mantissa (9 bits each) * 2^(bits 27-31 - 24).
#define GW_PAYLOAD_TWO_SIDED 0x40000000u
#define GW_PAYLOAD_SEPARATED 0x80000000u
#define GW_PAYLOAD_NO_NORMAL 0xffffffu
#define GW_PAYLOAD_HAS_NORMAL(y) (((y) & 0xffffffu) != GW_PAYLOAD_NO_NORMAL)
#define GW_PAYLOAD_SOLID 252u
#define GW_PAYLOAD_SPREAD_CODE(y) (((y) >> 18) & 7u)
#define GW_PAYLOAD_ONE_SIDED_CODE(y) (((y) >> 21) & 7u)
#define GW_PAYLOAD_AREA_CODE(z) ((z) & 0xfffu)
#define GW_PAYLOAD_OFFSET_CODE(z) (((z) >> 12) & 0xffu)
#define GW_PAYLOAD_ROUGHNESS_CODE(z) (((z) >> 20) & 0x3fu)
#define GW_PAYLOAD_METALNESS_CODE(z) ((z) >> 26)
#define GW_PAYLOAD_AREA_MOST 16.0
#define GW_PAYLOAD_OFFSET_STEPS 144.0

#endif
