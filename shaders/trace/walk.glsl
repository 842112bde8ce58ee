// What both traversals are made of. Kernels include it before the conditional include of one of them: an include is
// resolved once, wherever it stands first.
#include "trace/triangle.glsl"
#include "trace/grid.glsl"
#include "trace/accepted_error.glsl"
#include "trace/budget.glsl"
#include "trace/list.glsl"
