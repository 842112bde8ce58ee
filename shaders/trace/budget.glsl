// Counting the iterations of all loops of one invocation. Software GL ends every loop after 65,535 iterations of a group
// of lanes, without a word; a ray that has used LOOP_BUDGET of its own iterations is suspended and goes on in a further
// dispatch, so the end is never reached. A loop that ended although its condition still held is counted as a cap hit.
#ifndef LOOP_BUDGET
#define LOOP_BUDGET 4000u
#endif
uint iterations;

#ifdef COUNT
uvec4 work; // steps, node loads, triangle tests, voxels
#define COUNT_STEP() ++work.x
#define COUNT_NODE(loaded) work.y += uint(loaded)
#define COUNT_TEST() ++work.z
#define COUNT_VOXEL() ++work.w
#else
#define COUNT_STEP()
#define COUNT_NODE(loaded)
#define COUNT_TEST()
#define COUNT_VOXEL()
#endif
