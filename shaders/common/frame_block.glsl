// The frame block as kernels see it (common/frame.h says what is in it).
#include "common/shared.h"
#include "common/frame.h"
layout(std140, binding = 0) uniform Frame { gw_frame_block frame; };
