// Values of a whole frame. Values that differ by page or order group are uniforms.
#include "shared/types.h"
layout(std140, binding = 0) uniform Frame { FrameParameters frame; };
