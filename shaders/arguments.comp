// Between stages: the total that a scan left becomes arguments. One invocation.
#include "shared/limits.h"
#include "shared/types.h"

layout(local_size_x = 1) in;

layout(std430, binding = 0) writeonly buffer Arguments { DispatchArguments arguments[]; };
layout(std430, binding = 1) readonly buffer Total { uint total[]; };
layout(std430, binding = 2) buffer FrameCounters { Counters counters; };
#include "count_arguments.glsl"

void main() { set_arguments(total[0]); }
