// Stage 5: every tile's list is empty (by a shader: glClearNamedBufferData is 60 times slower on NVIDIA).
#include "shared/limits.h"
#include "shared/grid.glsl"

layout(local_size_x = THREADS) in;

layout(std430, binding = 0) writeonly buffer Ranges { uint ranges[]; };
uniform uint count;

void main() {
  if (thread_index() < count) ranges[thread_index()] = 0u;
}
