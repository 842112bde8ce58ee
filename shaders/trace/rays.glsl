// The frame of a kernel that traces any rays through the octree, for oracles and benches. A kernel includes it before its
// traversal and trace/rays_main.glsl after it.
layout(local_size_x = 64) in;
#include "common/shared.h"
#include "common/frame.h"
uniform uint group_base;
layout(std430, binding = 3) buffer Totals { uint totals[]; };
layout(std430, binding = 4) readonly buffer Queue { uint queue[]; };
layout(std430, binding = 5) writeonly buffer NextQueue { uint next_queue[]; };
#ifdef COUNT
layout(std430, binding = 6) buffer Work { uvec4 work_of[]; };
#endif
layout(location = 0) uniform uint ray_count; // or the length of the queue
#include "trace/ray_buffer.glsl"
